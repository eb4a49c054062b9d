#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline::test {

/// Message of the InputError or UsageError that `run` throws.
inline std::string errorOf(const std::function<void()>& run) {
  try {
    run();
  } catch (const InputError& error) {
    return error.what();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace lodeline::test
