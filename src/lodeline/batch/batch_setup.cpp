// Setup of a BatchProblem from the record of a forward run.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/batch/batch_problem.h"
#include "lodeline/batch/loops/initial_correction.h"
#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {
namespace {

constexpr double kNode_s = 60.0;  // time for which a walking offset counts as constant

/// Difference of a random walk between begin and end, as a quadratic term.
Prior walkBetween(ParameterBlock* begin, ParameterBlock* end, double sigma) {
  Prior prior;
  const auto size = static_cast<Eigen::Index>(begin->value.size());
  for (ParameterBlock* state : {begin, end})
    prior.blocks.push_back({state->value.data(), Eigen::VectorXd::Zero(size)});
  prior.sqrt_information = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  prior.sqrt_information.topLeftCorner(size, size).diagonal().setConstant(1.0 / sigma);
  prior.sqrt_information.topRightCorner(size, size).diagonal().setConstant(-1.0 / sigma);
  prior.offset = Eigen::VectorXd::Zero(2 * size);
  return prior;
}

/// Removes a block that is not correlated with others from a prior.
void remove(const std::string& name, Prior* prior, std::vector<std::string>* names) {
  Prior rest;
  std::vector<std::string> rest_names;
  std::vector<int> kept;
  int row = 0;
  for (size_t i = 0; i < names->size(); ++i) {
    const Prior::Block& block = prior->blocks[i];
    if ((*names)[i] != name) {
      rest.blocks.push_back(block);
      rest_names.push_back((*names)[i]);
      for (int k = 0; k < block.tangentSize(); ++k) kept.push_back(row + k);
    }
    row += block.tangentSize();
  }
  rest.sqrt_information = prior->sqrt_information(kept, kept).eval();
  rest.offset = prior->offset(kept).eval();
  *prior = std::move(rest);
  *names = std::move(rest_names);
}

}  // namespace

void BatchProblem::addStates(const Rig& rig, const EstimatorLog& record,
                             const std::vector<InitialPose>& initial_poses) {
  const InitialCorrection correction(record.frames(), initial_poses);
  for (const RecordedState& recorded : record.states()) {
    auto frame = std::make_unique<Frame>();
    frame->id = static_cast<FrameId>(states());
    frame->setState(correction.apply(recorded.state));
    frame->is_keyframe = true;  // any state may host landmarks
    frame->gyroscope_B = recorded.gyroscope_B;
    frame->measurements = recorded.measurements;
    if (!window_.empty()) {
      const Frame& before = window_.newest();
      frame->from_previous = std::make_unique<Preintegration>(
          record.imuBetween(before.time, frame->time), before.gyroscopeBias(), before.accelerometerBias(),
          rig.imu, options_.preintegration);
      if (const InertialDoubt doubt = record.doubtBetween(before.time, frame->time); doubt.any())
        frame->from_previous->setDoubt(doubt);
    }
    window_.add(std::move(frame));
  }
}

void BatchProblem::addTracks(const EstimatorLog& record, const std::vector<LoopObservation>& loops) {
  struct Piece {
    TrackId id;
    size_t first;
  };
  std::unordered_map<TrackId, Piece> pieces;
  TrackId next = 0;
  std::vector<Time> times;
  for (const RecordedState& recorded : record.states()) times.push_back(recorded.state.time);
  LoopLinker linker(std::move(times));
  for (size_t k = 0; k < states(); ++k) {
    for (const FeatureObservation& seen : record.states()[k].observations) {
      const auto [entry, is_new] = pieces.try_emplace(seen.track, Piece{next, k});
      if (!is_new && k - entry->second.first >= kLongestTrack) entry->second = {next, k};
      if (entry->second.id == next) ++next;
      Observation observation;
      observation.frame = static_cast<FrameId>(k);
      observation.camera = seen.camera;
      observation.measurement = DirectionMeasurement::fromRay(*cameras_[static_cast<size_t>(seen.camera)],
                                                              {seen.origin_C, seen.bearing_C}, seen.sigma_px);
      all_tracks_[entry->second.id].observations.push_back(observation);
      if (!loops.empty()) linker.add(seen.track, entry->second.id, k);
    }
  }
  if (!loops.empty()) links_ = linker.link(loops, cameras_, &all_tracks_);
  // A single observation is of use where a link joins it.
  if (links_.empty()) removeShortTracks(all_tracks_, 2);
}

ParameterBlock* BatchProblem::addGlobal(const EstimatorLog& record, const std::string& name,
                                        const std::string& as) {
  const auto found = record.globals().find(name);
  if (found == record.globals().end()) return nullptr;
  return &window_.add({as, found->second, std::nullopt, 0.0, false});
}

void BatchProblem::addKnowledge(ParameterBlock* state, const BatchState& of) {
  Prior& prior = priors_.emplace_back();
  const auto size = static_cast<Eigen::Index>(state->value.size());
  const std::vector<double> initial = state->value;
  if (!of.value.empty()) state->value = of.value;
  prior.append(state->value.data(), static_cast<int>(size), Eigen::VectorXd::Constant(size, of.sigma));
  std::copy(initial.begin(), initial.end(), state->value.begin());
}

void BatchProblem::addGlobals(const EstimatorLog& record) {
  for (const RecordedSensorState& recorded : record.sensorStates()) {
    const BatchState& state = recorded.state;
    if (state.walk_per_sqrt_s) {
      Chain chain = makeChain(record, recorded);
      if (chain.empty()) continue;
      addWalk(chain, *state.walk_per_sqrt_s);
      for (const Node& node : chain) {
        if (state.is_added_late && !node.continues) addKnowledge(node.state, state);
      }
      chains_.push_back(std::move(chain));
    } else if (ParameterBlock* global = addGlobal(record, state.name, state.name)) {
      if (state.is_added_late) addKnowledge(global, state);
      global->priors = state.priors;
    }
  }
}

BatchProblem::Chain BatchProblem::makeChain(const EstimatorLog& record, const RecordedSensorState& recorded) {
  const std::string& name = recorded.state.name;
  Chain chain;
  int epoch = 0;
  for (size_t k = 0; k < states(); ++k) {
    const std::vector<int>& restarts = record.states()[k].restarts;
    const int now = recorded.state.restarts && !restarts.empty() ? restarts[recorded.sensor] : 0;
    const bool is_new = chain.empty() || now != epoch;
    if (!is_new && (state(k).time - state(chain.back().first).time).seconds() < kNode_s) continue;
    // The first keeps the plain name, which the factors use.
    const std::string as = chain.empty() ? name : name + "@" + std::to_string(chain.size());
    ParameterBlock* node = addGlobal(record, name, as);
    if (node == nullptr) return {};
    chain.push_back({k, node, !is_new});
    epoch = now;
  }
  return chain;
}

void BatchProblem::addWalk(const Chain& chain, double walk_per_sqrt_s) {
  for (size_t i = 1; i < chain.size(); ++i) {
    if (!chain[i].continues) continue;
    const double elapsed_s = (state(chain[i].first).time - state(chain[i - 1].first).time).seconds();
    const double sigma = std::max(walk_per_sqrt_s * std::sqrt(elapsed_s), 1e-12);
    priors_.push_back(walkBetween(chain[i - 1].state, chain[i].state, sigma));
  }
}

void BatchProblem::addStartPrior(const EstimatorLog& record) {
  const EstimatorLog::StartPrior& start = record.startPrior();
  const GlobalValues& globals = record.globals();
  Prior prior = start.prior;
  std::vector<std::string> names = start.names;
  for (const RecordedSensorState& recorded : record.sensorStates()) {
    if (recorded.state.is_start_replaced) remove(recorded.state.name, &prior, &names);
  }
  Frame& first = *window_.frames().front();
  std::vector<const double*> known;
  for (size_t i = 0; i < prior.blocks.size(); ++i) {
    const std::string& name = names[i];
    double* value = nullptr;
    if (name == "pose") value = first.pose.data();
    if (name == "motion") value = first.motion.data();
    if (value == nullptr) {
      ParameterBlock* state = window_.findGlobal(name);
      // The cameras' extrinsics are not in a chain and are not yet in the window.
      if (state == nullptr) {
        const Eigen::VectorXd& at = prior.blocks[i].linearization_point;
        state = &window_.add({name, {at.data(), at.data() + at.size()}, std::nullopt, 0.0, false});
        const auto end = globals.find(name);
        if (end != globals.end()) state->value = end->second;
      }
      value = state->value.data();
    }
    prior.blocks[i].value = value;
    known.push_back(value);
  }
  priors_.push_back(std::move(prior));
  // A sensor with its first reading after the start has states that the start's prior does not contain.
  for (const RecordedSensorState& recorded : record.sensorStates()) {
    ParameterBlock* state = window_.findGlobal(recorded.state.name);
    if (state == nullptr || recorded.state.is_added_late) continue;
    if (std::find(known.begin(), known.end(), state->value.data()) == known.end())
      addKnowledge(state, recorded.state);
  }
}

void BatchProblem::addLenses(const Rig& rig, const GlobalValues& globals) {
  CameraCalibrationOptions held = options_.camera_calibration;
  held.port_tilt_sigma = 0.0;
  const Eigen::VectorXd by_file = intrinsicsSigmas(held);
  held.focal_length_sigma = held.principal_point_sigma_px = held.radial_sigma = held.tangential_sigma = 0.0;
  Prior prior, of_ports;
  addIntrinsicsStates(window_, prior, static_cast<int>(cameras_.size()), held);
  if (prior.empty()) return;
  addPortStates(window_, of_ports, rig, options_.camera_calibration);
  const CameraStates states = cameraStates(window_);
  for (size_t camera = 0; camera < states.intrinsics.size(); ++camera) {
    ParameterBlock& lens = *states.intrinsics[camera];
    const auto end = globals.find(lens.name);
    if (end != globals.end()) lens.value = end->second;
    const auto size = static_cast<Eigen::Index>(lens.value.size());
    if (states.portOf(static_cast<int>(camera))) {
      std::fill(lens.value.end() - 2, lens.value.end(), 0.0);
      const auto row = size * static_cast<Eigen::Index>(camera);
      prior.sqrt_information.diagonal().segment(row, size) = by_file.cwiseInverse();
    } else {
      prior.blocks[camera].linearization_point = Eigen::Map<const Eigen::VectorXd>(lens.value.data(), size);
    }
  }
  priors_.push_back(std::move(prior));
  if (!of_ports.empty()) priors_.push_back(std::move(of_ports));
}

void BatchProblem::believeInFilesAsBefore(const EstimatorLog& record) {
  const auto& corrections = record.frames().back().camera_corrections;
  if (corrections) believeInFiles(window_, options_.camera_calibration, corrections->are_files_held);
}

void BatchProblem::addImuAxes(const GlobalValues& globals) {
  addInertialStates(window_, options_.imu_axes);
  const ImuAxesStates axes(window_);
  for (ParameterBlock* state : {axes.gyroscope, axes.accelerometer}) {
    if (!state) continue;
    const auto end = globals.find(state->name);
    if (end != globals.end()) state->value = end->second;
  }
}

}  // namespace lodeline
