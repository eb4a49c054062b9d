#include "lodeline/problem/marginalization/marginalizer.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>

#include "lodeline/problem/marginalization/keyframe_policy.h"
#include "lodeline/problem/marginalization/landmark_host.h"
#include "lodeline/problem/prior_terms.h"

namespace lodeline {
namespace {

/// Schur complement: eliminates the rows in `gone` from the system (h, g) and keeps those in `kept`.
void schurComplement(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const std::vector<int>& gone,
                     const std::vector<int>& kept, Eigen::MatrixXd* h_kept, Eigen::VectorXd* g_kept) {
  const Eigen::MatrixXd h_gone = h(gone, gone);
  // Jacobi scaling makes the factorization insensitive to the mix of units.
  const Eigen::VectorXd scale = h_gone.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factorized(scale.asDiagonal() * h_gone * scale.asDiagonal());
  const Eigen::MatrixXd coupling = scale.asDiagonal() * h(gone, kept);
  const Eigen::MatrixXd solved = factorized.solve(coupling);
  *h_kept = h(kept, kept) - coupling.transpose() * solved;
  *g_kept = g(kept) - solved.transpose() * (scale.asDiagonal() * g(gone));
}

/// Upper triangular J and e with J^T J = h and J^T e = g. Directions without information in h (numerically)
/// are held by a jitter far below any real information.
void factorize(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, Prior* prior) {
  const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-12).cwiseSqrt();
  const Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * h * scale.cwiseInverse().asDiagonal();
  Eigen::LLT<Eigen::MatrixXd> llt;
  double jitter = 1e-14;
  for (; jitter < 1.0; jitter *= 10.0) {
    llt.compute(scaled + jitter * Eigen::MatrixXd::Identity(h.rows(), h.cols()));
    if (llt.info() == Eigen::Success) break;
  }
  prior->sqrt_information = Eigen::MatrixXd(llt.matrixU()) * scale.asDiagonal();
  prior->offset = llt.matrixL().solve(scale.cwiseInverse().asDiagonal() * g);
  prior->information = h;
  prior->information.diagonal() += jitter * scale.cwiseAbs2();
}

/// Information (h, g) after the coordinates `row` to `row + size` have changed by an unknown step with a
/// variance of `variance` each: P + E Q E^T in place of P = h^-1. The matrix inversion lemma avoids the
/// inverse of h. The estimate h^-1 g does not change.
void addNoise(int row, int size, double variance, Eigen::MatrixXd* h, Eigen::VectorXd* g) {
  Eigen::MatrixXd inner = h->block(row, row, size, size);
  inner.diagonal().array() += 1.0 / variance;
  const Eigen::LLT<Eigen::MatrixXd> factorized(inner);
  const Eigen::MatrixXd rows = h->middleRows(row, size);
  const Eigen::VectorXd gradient = g->segment(row, size);
  *g -= rows.transpose() * factorized.solve(gradient);
  *h -= rows.transpose() * factorized.solve(rows);
}

/// The linearization point of the block at `value`, set to its present value where it has none.
Eigen::VectorXd linearizationPoint(Window& window, const double* value) {
  for (const auto& frame : window.frames()) {
    if (value == frame->pose.data()) {
      if (!frame->first_pose) frame->first_pose = frame->pose;
      return Eigen::Map<const Eigen::VectorXd>(frame->first_pose->data(), kPoseSize);
    }
    if (value == frame->motion.data()) {
      if (!frame->first_motion) frame->first_motion = frame->motion;
      return Eigen::Map<const Eigen::VectorXd>(frame->first_motion->data(), kMotionSize);
    }
  }
  for (const auto& state : window.globals()) {
    if (value != state->value.data()) continue;
    if (!state->first) state->first = state->value;
    return Eigen::Map<const Eigen::VectorXd>(state->first->data(), static_cast<int>(state->first->size()));
  }
  return {};
}

/// Applies to (h, g) the random walk over `elapsed_s` and the sudden variance of the parameter blocks in the
/// prior.
void letGlobalsWalk(const Window& window, const Prior& prior, double elapsed_s, Eigen::MatrixXd* h,
                    Eigen::VectorXd* g) {
  int row = 0;
  for (const Prior::Block& block : prior.blocks) {
    for (const auto& state : window.globals()) {
      if (state->value.data() != block.value) continue;
      const double variance = state->walk_per_sqrt_s * state->walk_per_sqrt_s * elapsed_s +
                              std::exchange(state->sudden_variance, 0.0);
      if (variance > 0.0) addNoise(row, block.tangentSize(), variance, h, g);
    }
    row += block.tangentSize();
  }
}

/// Derivative of the prior's linearization points (poses and velocities of frames) by a rotation of
/// everything about gravity, per rad.
Eigen::VectorXd turnAboutGravity(const Window& window, const Prior& prior) {
  Eigen::VectorXd turn = Eigen::VectorXd::Zero(prior.tangentSize());
  int row = 0;
  for (const Prior::Block& block : prior.blocks) {
    for (const auto& frame : window.frames()) {
      const bool is_pose = block.value == frame->pose.data();
      if (!is_pose && block.value != frame->motion.data()) continue;
      turn.segment<3>(row) = Vec3::UnitZ().cross(block.linearization_point.head<3>());
      if (is_pose) turn[row + 5] = 1.0;
    }
    row += block.tangentSize();
  }
  return turn;
}

/// The newest of the old keyframes except the last `after`. Keyframes with motion do not count, because they
/// are recent.
FrameId lastBeforeCut(const Window& window, int after) {
  std::vector<FrameId> old;
  for (const auto& frame : window.frames()) {
    if (frame->is_keyframe && !frame->has_motion) old.push_back(frame->id);
  }
  const auto last = static_cast<std::ptrdiff_t>(old.size()) - 1 - after;
  return old[static_cast<size_t>(std::max<std::ptrdiff_t>(last, 0))];
}

/// Weight of each yaw in a common rotation of all poses: s with s . turnAboutGravity() = 1.
Eigen::VectorXd yawShares(const Prior& prior) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(prior.tangentSize());
  int row = 0;
  for (const Prior::Block& block : prior.blocks) {
    if (block.isPose()) shares[row + 5] = 1.0;
    row += block.tangentSize();
  }
  return shares / std::max(shares.sum(), 1.0);
}

}  // namespace

void Marginalizer::marginalizeToSize(Window& window, const WindowOptions& wanted) {
  while (window.recentCount() > wanted.recent_frames) marginalizeOldestFrame(window, wanted);
  while (window.poseOnlyCount() > wanted.keyframes) removeOldestKeyframe(window, wanted.split_at_keyframe);
}

void Marginalizer::resetLinearizationPoints(Window& window) {
  if (prior_.empty()) return;
  const auto difference = [&] {
    std::vector<const double*> values;
    for (const Prior::Block& block : prior_.blocks) values.push_back(block.value);
    return prior_.difference(values.data());
  };
  const Eigen::VectorXd residual = prior_.sqrt_information * difference() + prior_.offset;
  const Eigen::VectorXd turn_before = turnAboutGravity(window, prior_);
  for (const auto& frame : window.frames()) {
    frame->first_pose.reset();
    frame->first_motion.reset();
    for (Prior::Block& block : prior_.blocks) {
      if (block.value == frame->pose.data() || block.value == frame->motion.data())
        block.linearization_point =
            Eigen::Map<const Eigen::VectorXd>(block.value, block.linearization_point.size());
    }
  }
  // After a change of relative positions, a rotation about gravity is another direction than before, and the
  // prior would have information on it. The following correction keeps the prior's information on the
  // rotation as it was.
  const Eigen::VectorXd turn_after = turnAboutGravity(window, prior_);
  const Eigen::MatrixXd root = prior_.sqrt_information + prior_.sqrt_information *
                                                             (turn_before - turn_after) *
                                                             yawShares(prior_).transpose();
  const Eigen::HouseholderQR<Eigen::MatrixXd> triangular(root);
  prior_.sqrt_information = triangular.matrixQR().triangularView<Eigen::Upper>();
  prior_.information.resize(0, 0);
  prior_.offset = triangular.householderQ().transpose() * (residual - root * difference());
  window.placeInterpolated();
}

void Marginalizer::forget(Window& window, ParameterBlock& state) {
  NormalEquations system;
  PriorTerms(prior_).addTo(&system);
  if (system.find(state.value.data())) eliminate(window, system, {state.value.data()});
  state.first.reset();
}

void Marginalizer::marginalizeOldestFrame(Window& window, const WindowOptions& wanted) {
  Frame& oldest = *window.oldestRecent();
  Frame& next = *window.after(oldest);
  const double elapsed_s = (next.time - oldest.time).seconds();
  NormalEquations system;
  PriorTerms(prior_).addTo(&system);
  system.add(factors_.inertial(window, oldest, next));
  addSensors(window, oldest, next, &system);
  next.from_previous.reset();
  if (oldest.is_keyframe) {
    eliminate(window, system, {oldest.motion.data()}, elapsed_s);
    oldest.has_motion = false;
  } else {
    eliminate(window, system, {oldest.motion.data(), oldest.pose.data()}, elapsed_s);
    if (const auto between = keyframesAbout(window, oldest, wanted)) {
      window.interpolate(oldest, *between->before, *between->after);
    } else {
      window.remove(oldest.id);
    }
  }
}

void Marginalizer::addMeasurements(Window& window, Frame* before, Frame& frame,
                                   NormalEquations* system) const {
  const auto isConcerned = [&](const Measurement& measurement) {
    return measurement.isRelative() == (before != nullptr);
  };
  for (const auto& measurement : frame.measurements) {
    if (!isConcerned(*measurement)) continue;
    measurement->fixLinearizationPoints(window);
    for (const Factor& factor :
         measurement->factors({factors_, window, before, frame, MeasurementContext::Scope::Prior}))
      system->add(factor);
  }
  frame.measurements.removeIf(isConcerned);
}

void Marginalizer::addSensors(Window& window, Frame& oldest, Frame& next, NormalEquations* system) const {
  addMeasurements(window, &oldest, next, system);
  addMeasurements(window, nullptr, oldest, system);
  if (const auto factor = factors_.rest(oldest)) system->add(*factor);
  oldest.rest_sigma_m_per_s.reset();
}

void Marginalizer::removeOldestKeyframe(Window& window, int split_at_keyframe) {
  Frame& oldest = *window.frames().front();
  const Frame* newest_keyframe = window.newestKeyframe();
  const FrameId cut = lastBeforeCut(window, split_at_keyframe);
  NormalEquations system;
  PriorTerms(prior_).addTo(&system);
  for (auto& [id, track] : window.tracks()) {
    if (!track.landmark || !track.seenIn(oldest.id)) continue;
    if (track.seenIn(newest_keyframe->id)) {
      if (std::optional<FeatureTrack> older = splitTrack(window, track, cut, factors_)) {
        system.addEliminated(factors_.landmark(window, *older));
      } else if (track.landmark->host == oldest.id) {
        moveToNewHost(window, track, oldest.id, factors_);
      }
    } else {
      system.addEliminated(factors_.landmark(window, track));
      if (const auto point = mapPointOf(window, id, track, factors_)) map_points_.push_back(*point);
      track.landmark.reset();
      track.observations.clear();
    }
  }
  window.removeEmptyTracks();
  if (system.find(oldest.pose.data())) eliminate(window, system, {oldest.pose.data()});
  window.remove(oldest.id);
}

void Marginalizer::eliminate(Window& window, const NormalEquations& system,
                             const std::vector<const double*>& eliminated, double elapsed_s) {
  std::vector<int> gone;
  std::vector<int> kept;
  Prior next;
  Eigen::VectorXd from_first(system.size());  // current value minus linearization point of the kept rows
  int kept_size = 0;
  for (const NormalEquations::Block& block : system.blocks()) {
    const bool goes = std::find(eliminated.begin(), eliminated.end(), block.value) != eliminated.end();
    std::vector<int>& rows = goes ? gone : kept;
    for (int i = 0; i < block.tangentSize(); ++i) rows.push_back(block.offset + i);
    if (goes) continue;
    Prior single;
    single.blocks.push_back({block.value, linearizationPoint(window, block.value)});
    const double* value = block.value;
    from_first.segment(kept_size, block.tangentSize()) = single.difference(&value);
    kept_size += block.tangentSize();
    next.blocks.push_back(single.blocks.front());
  }
  Eigen::MatrixXd h_kept;
  Eigen::VectorXd g_kept;
  schurComplement(system.hessian(), system.gradient(), gone, kept, &h_kept, &g_kept);
  // The system's gradient belongs to the current values; the prior needs it at the linearization points.
  g_kept -= h_kept * from_first.head(kept_size);
  window.placeInterpolated();
  letGlobalsWalk(window, next, elapsed_s, &h_kept, &g_kept);
  factorize(h_kept, g_kept, &next);
  prior_ = std::move(next);
}

}  // namespace lodeline
