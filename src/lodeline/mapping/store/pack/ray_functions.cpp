#include "lodeline/mapping/store/pack/ray_functions.h"

namespace lodeline {
namespace {

/// Equal origins, as of a camera without a port.
constexpr double kSameOrigin_m = 1e-6;

/// The polynomial of the lowest degree that fits. A lens needs the third degree; behind a flat port, an
/// origin is off the lens by the third and higher powers of the angle.
std::optional<BearingPolynomial> fittingPolynomial(const std::vector<Vec3>& bearings,
                                                   const Eigen::MatrixXd& values, double tolerance) {
  for (const int degree : {3, 4, 5, 7}) {
    if (auto polynomial = BearingPolynomial::fit(bearings, values, degree, tolerance)) return polynomial;
  }
  return std::nullopt;
}

void writeFunction(const std::optional<BearingPolynomial>& polynomial, const Eigen::MatrixXd& values,
                   ByteWriter* writer) {
  writer->integer<uint8_t>(polynomial ? 1 : 0);
  if (polynomial) {
    polynomial->write(writer);
    return;
  }
  for (long row = 0; row < values.rows(); ++row) {
    for (long i = 0; i < values.cols(); ++i) writer->real32(values(row, i));
  }
}

void readFunction(ByteReader* reader, int dimension, size_t count,
                  std::optional<BearingPolynomial>* polynomial, Eigen::MatrixXd* values) {
  const auto form = reader->integer<uint8_t>();
  if (form > 1) throw InputError("a function of rays has an unknown form");
  if (form == 1) {
    *polynomial = BearingPolynomial::read(reader, dimension);
    return;
  }
  if (reader->left() < count * sizeof(float) * static_cast<size_t>(dimension))
    throw InputError("the data ends too early");
  values->resize(dimension, static_cast<long>(count));
  for (int row = 0; row < dimension; ++row) {
    for (double& value : values->row(row)) value = reader->real32();
  }
  if (!values->allFinite()) throw InputError("a pixel or an origin is not finite");
}

}  // namespace

RayFunctions::RayFunctions(const std::vector<const BodyRay*>& rays) {
  std::vector<Vec3> bearings;
  pixels_.resize(2, static_cast<long>(rays.size()));
  origins_.resize(3, static_cast<long>(rays.size()));
  for (size_t i = 0; i < rays.size(); ++i) {
    bearings.push_back(rays[i]->bearing_B);
    pixels_.col(static_cast<long>(i)) = rays[i]->pixel;
    origins_.col(static_cast<long>(i)) = rays[i]->origin_B;
  }
  pixel_ = fittingPolynomial(bearings, pixels_, kPixelTolerance_px);
  if (rays.empty()) return;
  if ((origins_.colwise() - origins_.col(0)).cwiseAbs().maxCoeff() < kSameOrigin_m)
    origin_ = BearingPolynomial::constant(origins_.col(0));
  else
    origin_ = fittingPolynomial(bearings, origins_, kOriginTolerance_m);
}

Vec2 RayFunctions::pixel(size_t number, const Vec3& bearing_B) const {
  return pixel_ ? Vec2((*pixel_)(bearing_B)) : Vec2(pixels_.col(static_cast<long>(number)));
}

Vec3 RayFunctions::origin_B(size_t number, const Vec3& bearing_B) const {
  return origin_ ? Vec3((*origin_)(bearing_B))
                 : Vec3(origins_.col(static_cast<long>(number)).cast<float>().cast<double>());
}

Vec3 RayFunctions::predictedBearing(size_t number, const Vec3& point_B) const {
  // The origin depends on the bearing a little, the bearing on the origin.
  Vec3 bearing = origin_ ? origin_->axis() : Vec3::UnitZ();
  for (int i = 0; i < 2; ++i) bearing = (point_B - origin_B(number, bearing)).normalized();
  return bearing;
}

void RayFunctions::write(ByteWriter* writer) const {
  writeFunction(pixel_, pixels_, writer);
  writeFunction(origin_, origins_, writer);
}

RayFunctions RayFunctions::read(ByteReader* reader, size_t count) {
  RayFunctions functions;
  readFunction(reader, 2, count, &functions.pixel_, &functions.pixels_);
  readFunction(reader, 3, count, &functions.origin_, &functions.origins_);
  return functions;
}

}  // namespace lodeline
