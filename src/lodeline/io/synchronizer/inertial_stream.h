#pragma once

#include <memory>
#include <utility>

#include "lodeline/io/streams/inertial_screen.h"
#include "lodeline/io/streams/ordered_stream.h"

namespace lodeline {

/// The inertial stream for all computations: in order of time, and screened.
inline InertialScreen inertialStream(OrderedStream<ImuSample> stream, const InertialScreenOptions& options,
                                     Diagnostics* diagnostics) {
  const auto ordered = std::make_shared<OrderedStream<ImuSample>>(std::move(stream));
  return InertialScreen(
      [ordered]() -> std::optional<ImuSample> {
        if (ordered->peek() == nullptr) return std::nullopt;
        return ordered->pop();
      },
      options, diagnostics);
}

}  // namespace lodeline
