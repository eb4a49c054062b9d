#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {
namespace {

/// Sigma of a held file, in units of the prior's sigmas: small compared with the information of images.
constexpr double kHeld = 1e-3;
/// Logarithms of the Bayes factors at which files are held, and freed.
constexpr double kBegin = 4.0, kEnd = 0.0;
/// The same thresholds for every single parameter.
constexpr double kLeastBegin = -0.5, kLeastEnd = -1.5;

using StatesWithSigmas = std::vector<std::pair<ParameterBlock*, Eigen::VectorXd>>;

/// States that the test covers: rotations of secondary cameras (the first coordinates of their extrinsics),
/// then the intrinsics of all cameras. Empty where the intrinsics are not estimated.
StatesWithSigmas judgedStates(const Window& window, const CameraCalibrationOptions& options) {
  StatesWithSigmas judged;
  const CameraStates states = cameraStates(window);
  if (!options.trust_confirmed_files || states.intrinsics.empty()) return judged;
  for (ParameterBlock* secondary : states.secondary)
    judged.emplace_back(secondary, stereoRotationSigmas(options));
  for (ParameterBlock* lens : states.intrinsics) judged.emplace_back(lens, intrinsicsSigmas(options));
  return judged;
}

/// Deviations from the files in units of the prior's sigmas, stacked.
struct Deviations {
  Eigen::VectorXd seen;
  Eigen::MatrixXd covariance;
};

std::optional<Deviations> deviationsOf(const StatesWithSigmas& judged, const JointCovariance& covariance) {
  Eigen::Index size = 0;
  for (const auto& [state, sigmas] : judged) {
    if (!covariance.knows(state->value.data())) return std::nullopt;
    size += sigmas.size();
  }
  Deviations deviations{Eigen::VectorXd(size), Eigen::MatrixXd(size, size)};
  Eigen::Index row = 0;
  for (const auto& [state, sigmas] : judged) {
    const double* value = state->value.data();
    deviations.seen.segment(row, sigmas.size()) =
        Eigen::Map<const Eigen::VectorXd>(value, sigmas.size()).cwiseQuotient(sigmas);
    Eigen::Index column = 0;
    for (const auto& [other, other_sigmas] : judged) {
      deviations.covariance.block(row, column, sigmas.size(), other_sigmas.size()) =
          covariance.between(value, other->value.data())
              .topLeftCorner(sigmas.size(), other_sigmas.size())
              .cwiseQuotient(sigmas * other_sigmas.transpose());
      column += other_sigmas.size();
    }
    row += sigmas.size();
  }
  return deviations;
}

/// The deviations without the prior of held files.
Deviations withoutPrior(const Deviations& believed) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(believed.covariance);
  const Eigen::ArrayXd variance = parts.eigenvalues().array().max(1e-18);
  // The variance in any direction is at most that of the prior.
  const Eigen::ArrayXd information = (variance.inverse() - 1.0 / (kHeld * kHeld)).max(1.0);
  const auto inAllDirections = [&](const Eigen::ArrayXd& scale) -> Eigen::MatrixXd {
    return parts.eigenvectors() * scale.matrix().asDiagonal() * parts.eigenvectors().transpose();
  };
  return {inAllDirections((variance * information).inverse()) * believed.seen,
          inAllDirections(information.inverse())};
}

/// Evidence of the mean intrinsics of all cameras, which are the last coordinates.
double evidenceForIntrinsics(const Deviations& deviations, Eigen::Index lenses) {
  const double share = 1.0 / static_cast<double>(lenses);
  const Eigen::Index size = deviations.seen.size();
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(kIntrinsicsSize, size);
  for (Eigen::Index k = 1; k <= lenses; ++k)
    mean.middleCols<kIntrinsicsSize>(size - kIntrinsicsSize * k).diagonal().setConstant(share);
  return evidenceForFile(mean * deviations.seen, mean * deviations.covariance * mean.transpose(), share);
}

/// Smallest evidence of any single parameter and of any difference between a camera's intrinsics and those of
/// the first camera. The test is on single parameters, because in a joint test the correct ones would
/// outweigh a wrong one.
double leastEvidence(const Deviations& deviations, Eigen::Index lenses) {
  const Eigen::Index size = deviations.seen.size();
  const Eigen::Index first_lens = size - kIntrinsicsSize * lenses;
  double least = std::numeric_limits<double>::infinity();
  const auto ask = [&](const Eigen::RowVectorXd& of) {
    least = std::min(least, evidenceForFile(of * deviations.seen, of * deviations.covariance * of.transpose(),
                                            of.squaredNorm()));
  };
  for (Eigen::Index i = 0; i < size; ++i) {
    Eigen::RowVectorXd of = Eigen::RowVectorXd::Unit(size, i);
    ask(of);
    if (i < first_lens + kIntrinsicsSize) continue;
    of[first_lens + (i - first_lens) % kIntrinsicsSize] = -1.0;
    ask(of);
  }
  return least;
}

}  // namespace

double evidenceForFile(const Eigen::VectorXd& seen, const Eigen::MatrixXd& covariance,
                       double prior_variance) {
  constexpr double kBlur = kFileTolerance * kFileTolerance;
  Eigen::MatrixXd after = covariance;
  after.diagonal().array() += kBlur;
  const Eigen::LLT<Eigen::MatrixXd> root(after);
  const Eigen::VectorXd whitened = root.matrixL().solve(seen);
  const double log_after = -0.5 * whitened.squaredNorm() - root.matrixLLT().diagonal().array().log().sum();
  const double log_before = -0.5 * static_cast<double>(seen.size()) * std::log(prior_variance + kBlur);
  return log_after - log_before;
}

void IntrinsicsModelSelection::remember(const JointCovariance& covariance, Window& window) {
  const StatesWithSigmas judged = judgedStates(window, options_);
  if (judged.empty()) return;
  for (const auto& [state, sigmas] : judged) state->is_correlation_wanted = true;
  std::optional<Deviations> deviations = deviationsOf(judged, covariance);
  if (!deviations) return;
  if (trusts_) deviations = withoutPrior(*deviations);
  const auto count = static_cast<Eigen::Index>(cameraStates(window).intrinsics.size());
  const double lenses = evidenceForIntrinsics(*deviations, count);
  const double least = leastEvidence(*deviations, count);
  trusts_ = trusts_ ? lenses > kEnd && least > kLeastEnd : lenses > kBegin && least > kLeastBegin;
  believeInFiles(window, options_, trusts_);
}

void believeInFiles(const Window& window, const CameraCalibrationOptions& options, bool is_believed) {
  for (const auto& [state, sigmas] : judgedStates(window, options)) {
    state->priors.clear();
    if (!is_believed) continue;
    state->priors.assign(state->value.size(), {0.0, std::numeric_limits<double>::infinity()});
    for (Eigen::Index i = 0; i < sigmas.size(); ++i)
      state->priors[static_cast<size_t>(i)].sigma = kHeld * sigmas[i];
  }
}

std::vector<std::pair<const double*, Eigen::MatrixXd>> removedFileInformation(
    const Window& window, const CameraCalibrationOptions& options) {
  constexpr double kRemoved = 1.0 / (kHeld * kHeld) - 1.0 / (kFileTolerance * kFileTolerance);
  std::vector<std::pair<const double*, Eigen::MatrixXd>> removed;
  for (const auto& [state, sigmas] : judgedStates(window, options)) {
    if (state->priors.empty()) continue;
    Eigen::VectorXd information = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(state->value.size()));
    information.head(sigmas.size()) = kRemoved * sigmas.cwiseAbs2().cwiseInverse();
    removed.emplace_back(state->value.data(), Eigen::MatrixXd(information.asDiagonal()));
  }
  return removed;
}

}  // namespace lodeline
