#include "simulation/shared/spline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodeline {
namespace {

constexpr int kDegree = 5;

// Non-zero basis functions of one degree at the fraction u of a knot span, from those of the degree below.
void raiseDegree(int degree, double u, std::array<double, kDegree + 1>& basis) {
  double saved = 0.0;
  for (int r = 0; r < degree; ++r) {
    const double share = basis[r] / degree;
    basis[r] = saved + (r + 1 - u) * share;
    saved = (u + degree - r - 1) * share;
  }
  basis[degree] = saved;
}

}  // namespace

Jet& Jet::operator+=(const Jet& other) {
  value += other.value;
  rate += other.rate;
  acceleration += other.acceleration;
  return *this;
}

Jet product(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.acceleration * b.value + 2.0 * a.rate * b.rate + a.value * b.acceleration};
}

Jet modulatedSine(const Jet& a, const Jet& phase) {
  const double s = std::sin(phase.value);
  const double c = std::cos(phase.value);
  return {a.value * s, a.rate * s + a.value * c * phase.rate,
          a.acceleration * s + 2.0 * a.rate * c * phase.rate +
              a.value * (c * phase.acceleration - s * phase.rate * phase.rate)};
}

Spline::Spline(double begin_s, double end_s, double spacing_s, const std::function<double(double)>& control)
    : begin_s_(begin_s), spacing_s_(spacing_s) {
  const int spans = static_cast<int>(std::ceil((end_s - begin_s) / spacing_s)) + 1;
  // At the start of span i, the weights are symmetric about control point i + 2.
  for (int k = 0; k < spans + kDegree; ++k) {
    control_.push_back(control(begin_s + (k - 0.5 * (kDegree - 1)) * spacing_s));
  }
}

Jet Spline::at(double time_s) const {
  const double position = (time_s - begin_s_) / spacing_s_;
  const int last = static_cast<int>(control_.size()) - kDegree - 1;
  const int span = std::clamp(static_cast<int>(std::floor(position)), 0, last);
  const double u = position - span;
  const double* c = control_.data() + span;

  std::array<double, kDegree + 1> basis{1.0};
  Jet jet;
  for (int degree = 1; degree <= kDegree; ++degree) {
    raiseDegree(degree, u, basis);
    if (degree == kDegree - 2) {
      for (int j = 0; j <= degree; ++j) jet.acceleration += basis[j] * (c[j + 2] - 2.0 * c[j + 1] + c[j]);
    } else if (degree == kDegree - 1) {
      for (int j = 0; j <= degree; ++j) jet.rate += basis[j] * (c[j + 1] - c[j]);
    }
  }
  for (int j = 0; j <= kDegree; ++j) jet.value += basis[j] * c[j];
  jet.rate /= spacing_s_;
  jet.acceleration /= spacing_s_ * spacing_s_;
  return jet;
}

}  // namespace lodeline
