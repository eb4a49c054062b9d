#include "lodeline/batch/batch_problem.h"

#include <algorithm>
#include <cmath>

#include "lodeline/batch/batch_structure.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"
#include "lodeline/estimator/uncertainty/reported_covariance.h"
#include "lodeline/problem/robust_loss.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/window_terms.h"

namespace lodeline {
namespace {

constexpr double kSensorLoss = 3.0;  // width of the Cauchy loss, standard deviations

}  // namespace

BatchProblem::BatchProblem(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                           const LoopClosures& loops, double loosening)
    : options_(options),
      factors_(rig, options_),
      loss_(std::make_shared<ceres::CauchyLoss>(kSensorLoss)),
      visual_(window_, factors_),
      loosening_(loosening) {
  for (const CameraCalibration& camera : rig.cameras) cameras_.push_back(makeCamera(camera));
  addStates(rig, record, loops.initial_poses);
  addTracks(record, loops.observations);
  addGlobals(record);
  addStartPrior(record);
  addLenses(rig, record.globals());
  believeInFilesAsBefore(record);
  addImuAxes(record.globals());
  resetLinearizationPoints();
  renewLandmarks();
}

size_t BatchProblem::landmarks() const {
  return static_cast<size_t>(std::count_if(window_.tracks().begin(), window_.tracks().end(),
                                           [](const auto& entry) { return entry.second.landmark; }));
}

size_t BatchProblem::observations() const {
  size_t count = 0;
  for (const auto& [id, track] : window_.tracks()) count += track.landmark ? track.observations.size() : 0;
  return count;
}

double* BatchProblem::nodeOf(const Chain& chain, size_t state) {
  const auto after = std::upper_bound(chain.begin(), chain.end(), state,
                                      [](size_t k, const Node& node) { return k < node.first; });
  return std::prev(after)->state->value.data();
}

const double* BatchProblem::walkingValue(std::string_view name, size_t state) const {
  for (const Chain& chain : chains_) {
    if (chain.front().state->name == name) return nodeOf(chain, state);
  }
  return nullptr;
}

std::vector<Factor> BatchProblem::motionFactors() {
  std::vector<Factor> terms;
  for (const Prior& prior : priors_) terms.push_back(factors_.prior(prior));
  for (Factor& term : collectGlobalTerms(window_, factors_)) terms.push_back(std::move(term));
  for (size_t k = 0; k < states(); ++k) {
    Frame& frame = *window_.frames()[k];
    if (k > 0) terms.push_back(factors_.inertial(window_, *window_.frames()[k - 1], frame));
    addSensorFactors(k, false, &terms);
  }
  return terms;
}

void BatchProblem::forEachFactor(const std::function<void(const Factor&)>& visit) {
  for (const Factor& factor : motionFactors()) visit(factor);
  for (const Factor& factor : landmark_factors_) visit(factor);
}

void BatchProblem::renewLandmarkFactors() {
  landmark_factors_.clear();
  for (size_t k = 0; k < states(); ++k) addSensorFactors(k, true, &landmark_factors_);
}

void BatchProblem::addSensorFactors(size_t k, bool on_landmarks, std::vector<Factor>* terms) {
  Frame& frame = *window_.frames()[k];
  Frame* before = k > 0 ? window_.frames()[k - 1].get() : nullptr;
  for (const auto& measurement : frame.measurements) {
    if (measurement->containsLandmarks() != on_landmarks) continue;
    for (Factor& factor :
         measurement->factors({factors_, window_, before, frame, MeasurementContext::Scope::Batch})) {
      for (double*& block : factor.blocks) {
        for (const Chain& chain : chains_) {
          if (block == chain.front().state->value.data()) block = nodeOf(chain, k);
        }
      }
      if (!factor.loss) factor.loss = loss_;
      terms->push_back(std::move(factor));
    }
  }
}

double BatchProblem::cost() {
  std::vector<double> residual;
  double sum = visual_.cost();
  forEachFactor([&](const Factor& factor) { sum += costOf(factor, residual); });
  return sum;
}

void BatchProblem::scatter(const NormalEquations& local, BlockSkylineCholesky* hessian,
                           Eigen::VectorXd* gradient) const {
  const auto h = local.lowerTriangle();
  const Eigen::VectorXd g = local.gradient();
  std::vector<int> rows;
  for (const NormalEquations::Block& a : local.blocks()) {
    const int row = rows.emplace_back(rowOf(a.value));
    gradient->segment(hessian->offset(row), a.tangentSize()) += g.segment(a.offset, a.tangentSize());
    for (size_t i = 0; i < rows.size(); ++i) {
      const NormalEquations::Block& b = local.blocks()[i];
      // Blocks of states without a common term are zero.
      if (!hessian->contains(std::max(rows[i], row), std::min(rows[i], row))) continue;
      const auto product = h.block(a.offset, b.offset, a.tangentSize(), b.tangentSize());
      if (rows[i] == row) {
        hessian->block(row, row) += product.selfadjointView<Eigen::Lower>().toDenseMatrix();
      } else if (rows[i] < row) {
        hessian->block(row, rows[i]) += product;
      } else {
        hessian->block(rows[i], row) += product.transpose();
      }
    }
  }
}

void BatchProblem::linearize(BlockSkylineCholesky* hessian, Eigen::VectorXd* gradient) {
  hessian->setZero();
  gradient->setZero(hessian->size());
  forEachFactor([&](const Factor& factor) {
    NormalEquations local;
    local.add(factor);
    scatter(local, hessian, gradient);
  });
  visual_.linearize([&](const NormalEquations& local) { scatter(local, hessian, gradient); });
}

void BatchProblem::subtractRemoved(BlockSkylineCholesky* hessian) const {
  const int first_motion = rowOf(state(0).motion.data());
  hessian->block(first_motion, first_motion).diagonal().tail<3>().array() -= removedBiasInformation(options_);
  for (const auto& [state, removed] : removedCalibration(window_, options_, factors_))
    hessian->block(rowOf(state), rowOf(state)) -= removed;
}

void BatchProblem::step(const Eigen::VectorXd& step) {
  std::vector<int> offsets(1, 0);
  for (const int size : sizes_) offsets.push_back(offsets.back() + size);
  const auto stepOf = [&](const double* value, int size) {
    return step.segment(offsets[static_cast<size_t>(rowOf(value))], size);
  };
  visual_.step([&](const NormalEquations& local) {
    Eigen::VectorXd local_step(local.size());
    for (const NormalEquations::Block& block : local.blocks())
      local_step.segment(block.offset, block.tangentSize()) = stepOf(block.value, block.tangentSize());
    return local_step;
  });
  for (const auto& frame : window_.frames()) {
    const Eigen::Matrix<double, 6, 1> moved = stepOf(frame->pose.data(), kPoseTangentSize);
    poseToBlock(perturbed(frame->worldFromBody(), moved), frame->pose.data());
    Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>>(frame->motion.data()) +=
        stepOf(frame->motion.data(), kMotionSize);
  }
  for (const auto& global : window_.globals()) {
    const int size = global->tangentSize();
    Eigen::Map<Eigen::VectorXd>(global->value.data(), size) += stepOf(global->value.data(), size);
  }
}

template <typename Visit>
void BatchProblem::forEachValue(const Visit& visit) {
  for (const auto& frame : window_.frames()) {
    visit(frame->pose.data(), kPoseSize);
    visit(frame->motion.data(), kMotionSize);
  }
  for (const auto& global : window_.globals())
    visit(global->value.data(), static_cast<int>(global->value.size()));
  for (auto& [id, track] : window_.tracks()) {
    if (track.landmark) visit(track.landmark->parameters.data(), kLandmarkSize);
  }
}

std::vector<double> BatchProblem::values() {
  std::vector<double> values;
  forEachValue([&](const double* value, int size) { values.insert(values.end(), value, value + size); });
  return values;
}

void BatchProblem::setValues(const std::vector<double>& values) {
  const double* next = values.data();
  forEachValue([&](double* value, int size) {
    std::copy_n(next, size, value);
    next += size;
  });
}

void BatchProblem::resetLinearizationPoints() {
  Frame* before = nullptr;
  for (const auto& frame : window_.frames()) {
    frame->updateImageMotion();
    if (before &&
        frame->from_previous->needsRepropagation(before->gyroscopeBias(), before->accelerometerBias()))
      frame->from_previous->repropagate(before->gyroscopeBias(), before->accelerometerBias());
    before = frame.get();
  }
}

double BatchProblem::renewLandmarks() {
  window_.tracks() = all_tracks_;
  if (!links_.empty()) joined_ = joinLandmarks(window_, factors_, options_.landmark, links_, loosening_);
  if (rows_.empty() || !links_.empty()) orderBlocks();
  double placed = 0.0, removed = 0.0;
  std::vector<ObservationError> errors, loosened;
  for (auto& [id, track] : window_.tracks()) {
    placeLandmark(window_, factors_, options_.landmark, &track);
    if (!track.landmark) continue;
    placed += static_cast<double>(track.observations.size());
    // Errors relative to a loosened sigma do not show the accuracy of the images.
    std::vector<ObservationError>& to = isLoosened(id) ? loosened : errors;
    removed += removeContradictions(window_, factors_, options_.landmark, id, &track, &to);
  }
  adaptRobustLosses(window_, errors, options_.solver);
  visual_.arrange();
  renewLandmarkFactors();
  return placed > 0.0 ? removed / placed : 0.0;
}

TimeCorrelatedErrors BatchProblem::timeCorrelatedErrors() {
  constexpr double kBelieved = 2.0;  // in widths of the loss: larger residuals have little weight
  TimeCorrelatedErrors lasting;
  for (auto& [id, track] : window_.tracks()) {
    if (!track.landmark || isLoosened(id)) continue;
    const std::vector<Vec2> errors = residualsOf(factors_.landmark(window_, track));
    std::vector<std::vector<Vec2>> by_camera(cameras_.size());
    const auto finish = [&] {
      for (std::vector<Vec2>& of_camera : by_camera) {
        lasting.add(of_camera);
        of_camera.clear();
      }
    };
    for (size_t i = 0; i < errors.size(); ++i) {
      const Observation& observation = track.observations[i];
      // Another pass: its errors are not those of the pass before.
      if (i > 0 && observation.frame - track.observations[i - 1].frame > static_cast<FrameId>(kLongestTrack))
        finish();
      if (errors[i].norm() < kBelieved * factors_.robustScale(*window_.find(observation.frame)))
        by_camera[static_cast<size_t>(observation.camera)].push_back(errors[i]);
    }
    finish();
  }
  return lasting;
}

void BatchProblem::weighObservations(double variance) {
  for (auto& [id, track] : window_.tracks()) track.weight /= variance;
  renewLandmarkFactors();
}

Eigen::Matrix<double, 15, 15> BatchProblem::covarianceOf(size_t index,
                                                         const BlockSkylineCholesky& inverse) const {
  const int pose = rowOf(state(index).pose.data()), motion = rowOf(state(index).motion.data());
  Eigen::Matrix<double, 15, 15> covariance;
  covariance.topLeftCorner<6, 6>() = inverse.block(pose, pose);
  covariance.bottomLeftCorner<9, 6>() = inverse.block(motion, pose);
  covariance.topRightCorner<6, 9>() = covariance.bottomLeftCorner<9, 6>().transpose();
  covariance.bottomRightCorner<9, 9>() = inverse.block(motion, motion);
  return 0.5 * (covariance + covariance.transpose());
}

std::vector<Vec3> BatchProblem::portSigmas(const BlockSkylineCholesky& inverse) const {
  std::vector<Vec3> sigmas;
  for (const ParameterBlock* port : cameraStates(window_).ports) {
    sigmas.emplace_back(Vec3::Zero());
    if (!port) continue;
    const int row = rowOf(port->value.data());
    sigmas.back() = inverse.block(row, row).diagonal().cwiseSqrt();
  }
  return sigmas;
}

AzimuthCovariance BatchProblem::azimuth(size_t index, const BlockSkylineCholesky& inverse) const {
  const ParameterBlock* field = window_.findGlobal(MagnetometerStates::kField);
  if (field == nullptr) return {};
  const int row = rowOf(field->value.data());
  Eigen::Matrix<double, 15, 3> state_field;
  state_field << inverse.block(row, rowOf(state(index).pose.data())).transpose(),
      inverse.block(row, rowOf(state(index).motion.data())).transpose();
  return azimuthCovariance(MagnetometerStates(window_).field_W(), inverse.block(row, row), state_field);
}

}  // namespace lodeline
