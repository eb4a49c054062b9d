#include "lodeline/estimator/unmodelled_errors.h"

#include <algorithm>

namespace lodeline {

double unmodelledDensitySigma(const EstimatorOptions& options) {
  if (!options.camera_calibration.enabled) return 0.0;
  // Who was told the density better than that learns nothing of it from images.
  return std::min(options.depth.least_density_sigma, options.depth.density_ratio_sigma);
}

void addUnmodelledErrors(const EstimatorOptions& options, const EstimateSources& sources,
                         const Vec3& position_W, Eigen::Matrix<double, 15, 15>* covariance) {
  if (!options.camera_calibration.enabled) return;
  if (!sources.is_scale_given) {
    const Vec3 by_scale = kOneCameraScaleSigma * position_W;
    covariance->topLeftCorner<3, 3>() += by_scale * by_scale.transpose();
  }
  if (sources.has_depth) {
    const double height_sigma_m = unmodelledDensitySigma(options) * position_W.z();
    (*covariance)(2, 2) += height_sigma_m * height_sigma_m;
  }
}

}  // namespace lodeline
