#include "lodeline/magnetometer/earth_field/harmonic_field.h"

#include <cmath>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kReferenceRadius_m = 6371200.0;
/// The derivatives need one degree more than the potential.
constexpr int kTerms = kMagneticModelDegree + 2;

/// Solid harmonics (a/r)^(n+1) P_nm(sin(phi)) times cos(m lambda) and sin(m lambda), not normalized.
struct SolidHarmonics {
  double cosine[kTerms][kTerms] = {};
  double sine[kTerms][kTerms] = {};

  explicit SolidHarmonics(const Vec3& geocentric_m) {
    const double r2_m2 = geocentric_m.squaredNorm();
    const Vec3 u = kReferenceRadius_m / r2_m2 * geocentric_m;
    const double shrinkage = kReferenceRadius_m * kReferenceRadius_m / r2_m2;
    cosine[0][0] = kReferenceRadius_m / std::sqrt(r2_m2);
    for (int m = 0; m < kTerms; ++m) {
      if (m > 0) {
        const double c = cosine[m - 1][m - 1], s = sine[m - 1][m - 1];
        cosine[m][m] = (2 * m - 1) * (u.x() * c - u.y() * s);
        sine[m][m] = (2 * m - 1) * (u.x() * s + u.y() * c);
      }
      raiseDegree(m, u.z(), shrinkage, cosine);
      raiseDegree(m, u.z(), shrinkage, sine);
    }
  }

 private:
  static void raiseDegree(int m, double u_z, double shrinkage, double (&values)[kTerms][kTerms]) {
    for (int n = m + 1; n < kTerms; ++n) {
      const double before = n > m + 1 ? values[n - 2][m] : 0.0;
      values[n][m] = ((2 * n - 1) * u_z * values[n - 1][m] - (n + m - 1) * shrinkage * before) / (n - m);
    }
  }
};

/// Factor from the plain to the Schmidt semi-normalized Legendre function.
double schmidtFactor(int degree, int order) {
  double square = order > 0 ? 2.0 : 1.0;
  for (int k = degree - order + 1; k <= degree + order; ++k) square /= k;
  return std::sqrt(square);
}

/// a grad of the term c cosine[n][m] + s sine[n][m].
Vec3 gradient(const SolidHarmonics& f, int n, int m, double c, double s) {
  // The sine of order zero is zero, whatever its coefficient.
  if (m == 0) return -c * Vec3(f.cosine[n + 1][1], f.sine[n + 1][1], (n + 1) * f.cosine[n + 1][0]);
  const double z = -(n - m + 1) * (c * f.cosine[n + 1][m] + s * f.sine[n + 1][m]);
  const double x_up = -c * f.cosine[n + 1][m + 1] - s * f.sine[n + 1][m + 1];
  const double y_up = -c * f.sine[n + 1][m + 1] + s * f.cosine[n + 1][m + 1];
  const double weight = (n - m + 2) * (n - m + 1);
  const double x_down = c * f.cosine[n + 1][m - 1] + s * f.sine[n + 1][m - 1];
  const double y_down = -c * f.sine[n + 1][m - 1] + s * f.cosine[n + 1][m - 1];
  return Vec3(0.5 * (x_up + weight * x_down), 0.5 * (y_up + weight * y_down), z);
}

}  // namespace

Vec3 harmonicField(const CoefficientTable& table, double GaussCoefficient::*g, double GaussCoefficient::*h,
                   const Vec3& geocentric_m) {
  const SolidHarmonics harmonics(geocentric_m);
  Vec3 field = Vec3::Zero();
  for (const GaussCoefficient& term : table) {
    const double factor = schmidtFactor(term.degree, term.order);
    field -= gradient(harmonics, term.degree, term.order, factor * term.*g, factor * term.*h);
  }
  return field;
}

Vec3 geocentricPosition(const GeodeticPosition& position) {
  constexpr double kSemiMajorAxis_m = 6378137.0, kFlattening = 1.0 / 298.257223563;
  constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);
  const Vec3 up = geocentricFromEnu(position).col(2);
  const double normal_m = kSemiMajorAxis_m / std::sqrt(1.0 - kEccentricity2 * up.z() * up.z());
  const Vec3 on_ellipsoid_m(normal_m * up.x(), normal_m * up.y(), (1.0 - kEccentricity2) * normal_m * up.z());
  return on_ellipsoid_m + position.height_m * up;
}

Mat3 geocentricFromEnu(const GeodeticPosition& position) {
  const double latitude = position.latitude_deg * kDegree, longitude = position.longitude_deg * kDegree;
  const Vec3 east(-std::sin(longitude), std::cos(longitude), 0.0);
  const Vec3 up(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                std::sin(latitude));
  Mat3 rotation;
  rotation << east, up.cross(east), up;
  return rotation;
}

}  // namespace lodeline
