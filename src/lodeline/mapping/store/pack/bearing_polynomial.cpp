#include "lodeline/mapping/store/pack/bearing_polynomial.h"

#include <Eigen/QR>
#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

long monomialCount(int degree) { return (degree + 1) * (degree + 2) / 2; }

Eigen::VectorXd monomialsOf(const Vec3& bearing, const Vec3& axis, int degree) {
  const Vec2 across = tangentBasis(axis).transpose() * bearing;
  const double sine = across.norm();
  const double angle_rad = std::atan2(sine, axis.dot(bearing));
  const Vec2 place = sine > 1e-12 ? Vec2(across * (angle_rad / sine)) : Vec2(Vec2::Zero());
  Eigen::VectorXd monomials(monomialCount(degree));
  long next = 0;
  for (int total = 0; total <= degree; ++total) {
    for (int power = 0; power <= total; ++power)
      monomials[next++] = std::pow(place.x(), total - power) * std::pow(place.y(), power);
  }
  return monomials;
}

Eigen::MatrixXd inFloat(const Eigen::MatrixXd& matrix) { return matrix.cast<float>().cast<double>(); }

}  // namespace

std::optional<BearingPolynomial> BearingPolynomial::fit(const std::vector<Vec3>& bearings,
                                                        const Eigen::MatrixXd& values, int degree,
                                                        double tolerance) {
  const auto count = static_cast<long>(bearings.size());
  if (count < 2 * monomialCount(degree)) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& bearing : bearings) sum += bearing;
  // Bearings to all sides have no axis.
  if (sum.norm() < 0.1 * static_cast<double>(count)) return std::nullopt;
  BearingPolynomial polynomial;
  polynomial.degree_ = degree;
  polynomial.axis_ = inFloat(sum.normalized());
  Eigen::MatrixXd design(count, monomialCount(degree));
  for (long i = 0; i < count; ++i)
    design.row(i) = monomialsOf(bearings[static_cast<size_t>(i)], polynomial.axis_, degree).transpose();
  polynomial.coefficients_ = inFloat(design.colPivHouseholderQr().solve(values.transpose()).transpose());
  const Eigen::MatrixXd fitted = polynomial.coefficients_ * design.transpose();
  if (!fitted.allFinite() || (fitted - values).cwiseAbs().maxCoeff() > tolerance) return std::nullopt;
  return polynomial;
}

BearingPolynomial BearingPolynomial::constant(const Eigen::VectorXd& value) {
  BearingPolynomial polynomial;
  polynomial.coefficients_ = inFloat(value);
  return polynomial;
}

Eigen::VectorXd BearingPolynomial::operator()(const Vec3& bearing) const {
  return coefficients_ * monomialsOf(bearing, axis_, degree_);
}

void BearingPolynomial::write(ByteWriter* writer) const {
  writer->integer(static_cast<uint8_t>(degree_));
  for (const double coordinate : axis_) writer->real32(coordinate);
  for (long row = 0; row < coefficients_.rows(); ++row) {
    for (const double coefficient : coefficients_.row(row)) writer->real32(coefficient);
  }
}

BearingPolynomial BearingPolynomial::read(ByteReader* reader, int dimension) {
  BearingPolynomial polynomial;
  polynomial.degree_ = reader->integer<uint8_t>();
  if (polynomial.degree_ > kMostDegree) throw InputError("a polynomial has an unknown degree");
  for (double& coordinate : polynomial.axis_) coordinate = reader->real32();
  if (!polynomial.axis_.allFinite() || std::abs(polynomial.axis_.norm() - 1.0) > 1e-5)
    throw InputError("an axis is no unit vector");
  polynomial.coefficients_.resize(dimension, monomialCount(polynomial.degree_));
  for (long row = 0; row < dimension; ++row) {
    for (double& coefficient : polynomial.coefficients_.row(row)) coefficient = reader->real32();
  }
  if (!polynomial.coefficients_.allFinite()) throw InputError("a coefficient is not finite");
  return polynomial;
}

}  // namespace lodeline
