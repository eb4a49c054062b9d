#pragma once

#include <functional>
#include <vector>

namespace lodeline {

/// Value of a scalar function of time at one instant with its first two derivatives (per s, per s^2).
struct Jet {
  double value = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;

  Jet& operator+=(const Jet& other);
};

/// a(t) * b(t).
Jet product(const Jet& a, const Jet& b);

/// a(t) * sin(phase(t)), with derivatives by the chain rule.
Jet modulatedSine(const Jet& amplitude, const Jet& phase);

/// A uniform B-spline of degree 5: four times continuously differentiable, its derivatives exact. Piegl &
/// Tiller, "The NURBS Book", 2nd ed., algorithms A2.2 and A3.1.
class Spline {
 public:
  /// Control points c(t_k) at t_k = `begin_s` + k * `spacing_s`, as many as `at` needs on [begin_s, end_s].
  /// The spline is c smoothed with a standard deviation of 0.7 knot spacings.
  Spline(double begin_s, double end_s, double spacing_s, const std::function<double(double)>& control);

  Jet at(double time_s) const;

 private:
  double begin_s_;
  double spacing_s_;
  std::vector<double> control_;
};

}  // namespace lodeline
