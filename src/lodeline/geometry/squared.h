#pragma once

namespace lodeline {

inline double squared(double x) { return x * x; }

}  // namespace lodeline
