#include "lodeline/estimator/robust_scale.h"

#include <algorithm>
#include <utility>

namespace lodeline {

std::optional<double> robustScale(std::vector<double> errors_sigmas, const SolverOptions& options) {
  constexpr size_t kEnough = 20;
  // Images without noise must not end in a loss that rejects everything.
  constexpr double kLeast_sigmas = 0.05;
  if (errors_sigmas.size() < kEnough) return std::nullopt;
  const auto median = errors_sigmas.begin() + static_cast<std::ptrdiff_t>(errors_sigmas.size() / 2);
  std::nth_element(errors_sigmas.begin(), median, errors_sigmas.end());
  const double wanted = std::max(options.robust_scale_medians * *median, kLeast_sigmas);
  return std::min(wanted, options.robust_scale_sigmas);
}

void adaptRobustScales(Window& window, FrameErrors errors_sigmas, const SolverOptions& options) {
  for (auto& [id, errors] : errors_sigmas) {
    const auto scale = robustScale(std::move(errors), options);
    if (scale) window.find(id)->robust_scale_sigmas = *scale;
  }
}

}  // namespace lodeline
