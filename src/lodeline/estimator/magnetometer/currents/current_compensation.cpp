#include "lodeline/estimator/magnetometer/currents/current_compensation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kLongestCurrentGap_s = 1.0;  // between current readings over which they are interpolated
constexpr double kLongestUse_s = 10.0;  // after a current reading that readings of the magnetometer need it
constexpr double kToReport_s = 3.0;     // without currents before that is reported

std::vector<Vec3> fieldsInBody(const Rig& rig) {
  std::vector<Vec3> fields_B;
  if (!rig.currents || !rig.magnetometer) return fields_B;
  const MagnetometerCalibration& magnetometer = *rig.magnetometer;
  for (const Vec3& field_T_per_A : rig.currents->fields_T_per_A) {
    fields_B.push_back(magnetometer.body_from_magnetometer.rotation *
                       (magnetometer.iron_correction * field_T_per_A));
  }
  return fields_B;
}

std::vector<std::string> channelsOf(const Rig& rig) {
  return rig.currents && rig.magnetometer ? rig.currents->channels : std::vector<std::string>();
}

std::vector<double> numbers(const Vec3& vector) { return {vector.x(), vector.y(), vector.z()}; }

}  // namespace

const char* toString(CurrentStatus status) {
  switch (status) {
    case CurrentStatus::NoData:
      return "no data";
    case CurrentStatus::Missing:
      return "missing";
    case CurrentStatus::Compensated:
      return "compensated";
    case CurrentStatus::Held:
      return "held";
    case CurrentStatus::Learned:
      return "learned";
    case CurrentStatus::Refused:
      return "refused";
  }
  return "unknown";
}

CurrentCompensation::CurrentCompensation(const Rig& rig, Diagnostics* diagnostics)
    : diagnostics_(diagnostics),
      channels_(channelsOf(rig)),
      fields_B_(fieldsInBody(rig)),
      field_sigma_T_per_A_(rig.currents ? rig.currents->field_sigma_T_per_A : 0.0),
      track_(channels_.size(), kLongestCurrentGap_s),
      monitor_(channels_.size(), field_sigma_T_per_A_),
      shown_fields_B_(fields_B_.empty() ? std::vector<Vec3>(channels_.size(), Vec3::Zero()) : fields_B_) {
  if (!fields_B_.empty() && fields_B_.size() != channels_.size()) {
    throw InputError(
        fmt::format("current0: {} channels but {} fields (fields_T_per_A); each channel needs one",
                    channels_.size(), fields_B_.size()));
  }
}

void CurrentCompensation::add(std::span<const CurrentSample> samples) {
  for (const CurrentSample& sample : samples) {
    if (track_.add(sample)) continue;
    diagnostics_->report(
        Severity::Warning, "current_invalid",
        fmt::format("currents: reading at {} ns is left out: {} values for {} channels, a value that is no "
                    "number, or not later than the one before",
                    sample.time.nanoseconds(), sample.currents_A.size(), channels_.size()));
  }
  // Without readings of the magnetometer nothing else forgets them.
  if (!samples.empty()) track_.forgetBefore(samples.back().time - Duration::fromSeconds(kLongestUse_s));
}

CurrentCompensation::Known CurrentCompensation::withCurrents(std::span<const FieldSample> samples, Time now) {
  Known measured, held;
  const auto none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(channels_.size()));
  measured.currents = held.currents = {none, none};
  if (track_.empty()) {
    status_ = CurrentStatus::NoData;
    if (!samples.empty()) reportMissing(now);
    measured.samples.assign(samples.begin(), samples.end());
    return measured;
  }
  const auto put = [](const FieldSample& sample, const CurrentsAt& currents, Known* known) {
    known->samples.push_back(sample);
    known->currents.currents_A += currents.currents_A;
    known->currents.sigmas_A += currents.sigmas_A;
  };
  for (const FieldSample& sample : samples) {
    const std::optional<CurrentsAt> currents = track_.at(sample.time);
    if (currents) put(sample, *currents, currents->isMeasured() ? &measured : &held);
  }
  Known& known = measured.samples.empty() ? held : measured;
  status_ = is_refused_         ? CurrentStatus::Refused
            : fields_B_.empty() ? CurrentStatus::Learned
                                : CurrentStatus::Compensated;
  if (known.samples.empty()) {
    status_ = CurrentStatus::Missing;
    if (!samples.empty()) reportMissing(now);
    return known;
  }
  if (!known.currents.isMeasured()) status_ = CurrentStatus::Held;
  missing_since_.reset();
  const double share = 1.0 / static_cast<double>(known.samples.size());
  known.currents.currents_A *= share;
  known.currents.sigmas_A *= share;
  track_.forgetBefore(known.samples.front().time);
  return known;
}

void CurrentCompensation::reportMissing(Time now) {
  if (!missing_since_) missing_since_ = now;
  if (is_missing_reported_ || (now - *missing_since_).seconds() < kToReport_s) return;
  is_missing_reported_ = true;
  diagnostics_->report(
      Severity::Warning, "current_missing",
      fmt::format("currents: none from {} ns on; {}", missing_since_->nanoseconds(),
                  track_.empty() ? "the magnetometer is used without compensation until they come"
                                 : "the magnetometer is not used until they return"));
}

std::vector<ParameterBlock> CurrentCompensation::states() const {
  std::vector<ParameterBlock> blocks;
  for (size_t i = 0; areStates() && i < channels_.size(); ++i) {
    ParameterBlock block{CurrentStates::nameOf(i), numbers(calibrated_B(i)), std::nullopt, 0.0, true};
    if (isCalibrated()) {
      for (const double value : block.value) block.priors.push_back({value, field_sigma_T_per_A_});
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

std::vector<BatchState> CurrentCompensation::batchStates(const Window& window) const {
  std::vector<BatchState> states;
  const CurrentStates now(window, channels_.size());
  for (size_t i = 0; i < now.blocks.size(); ++i) {
    BatchState state{CurrentStates::nameOf(i)};
    state.sigma = kUnknownSigma_T_per_A;
    state.value = numbers(fields_B_.empty() ? Vec3::Zero() : fields_B_[i]);
    state.priors = now.blocks[i]->priors;
    states.push_back(std::move(state));
  }
  return states;
}

Vec3 CurrentCompensation::field_B(const CurrentsAt& currents, const Window* window) const {
  Vec3 sum_B = Vec3::Zero();
  const CurrentStates fields(window, channels_.size());
  for (size_t i = 0; i < channels_.size(); ++i) {
    const bool is_state = i < fields.blocks.size();
    sum_B +=
        currents.currents_A[static_cast<Eigen::Index>(i)] * (is_state ? fields.field_B(i) : calibrated_B(i));
  }
  return sum_B;
}

double CurrentCompensation::fieldVariance_T2(const CurrentsAt& currents, const Window& window,
                                             const JointCovariance& known) const {
  const CurrentStates states(window, channels_.size());
  double variance_T2 = 0.0;
  for (size_t i = 0; i < channels_.size(); ++i) {
    const double current_A = currents.currents_A[static_cast<Eigen::Index>(i)];
    if (i >= states.blocks.size() || !known.knows(states.blocks[i]->value.data())) {
      variance_T2 += std::pow(sigma_T_per_A() * current_A, 2);
      continue;
    }
    for (size_t j = 0; j < states.blocks.size(); ++j) {
      if (!known.knows(states.blocks[j]->value.data())) continue;
      variance_T2 += current_A * currents.currents_A[static_cast<Eigen::Index>(j)] / 3.0 *
                     known.between(states.blocks[i]->value.data(), states.blocks[j]->value.data()).trace();
    }
  }
  return std::max(0.0, variance_T2);
}

double CurrentCompensation::noiseVariance_T2(const CurrentsAt& currents) const {
  double variance_T2 = 0.0;
  for (size_t i = 0; i < channels_.size(); ++i) {
    const double usual_T_per_A = std::hypot(shown_fields_B_[i].norm(), sigma_T_per_A());
    variance_T2 += std::pow(usual_T_per_A * currents.sigmas_A[static_cast<Eigen::Index>(i)], 2);
    if (!areStates())
      variance_T2 += std::pow(sigma_T_per_A() * currents.currents_A[static_cast<Eigen::Index>(i)], 2);
  }
  return variance_T2;
}

bool CurrentCompensation::check(Time time, const CurrentsAt& currents, const Vec3& difference_B,
                                double white_variance_T2, Window& window) {
  if (!isCalibrated() || status_ == CurrentStatus::NoData) return false;
  monitor_.add(time, currents.currents_A, difference_B - field_B(currents, nullptr), white_variance_T2);
  if (!monitor_.isContradicted()) return false;
  diagnostics_->report(
      Severity::Warning, "current_compensation_wrong",
      fmt::format(
          "cables moved: do not use the calibration of the currents' fields. Up to {} ns it leaves {:.2f} uT "
          "of the changes that currents make; from then on the fields are estimated in the dive. Repeat "
          "the still test (`lodeline calibrate magnetometer --currents`)",
          time.nanoseconds(), 1e6 * monitor_.leftField_T()));
  is_refused_ = true;
  status_ = CurrentStatus::Refused;
  for (ParameterBlock* state : CurrentStates(window, channels_.size()).blocks) state->priors.clear();
  return true;
}

void CurrentCompensation::describe(const CurrentsAt& currents, const Window& window,
                                   const JointCovariance& known) {
  shown_field_B_ = field_B(currents, &window);
  shown_sigma_T_ = std::sqrt(fieldVariance_T2(currents, window, known));
  const CurrentStates states(window, channels_.size());
  for (size_t i = 0; i < channels_.size(); ++i)
    shown_fields_B_[i] = i < states.blocks.size() ? states.field_B(i) : calibrated_B(i);
}

std::vector<std::pair<std::string, std::string>> CurrentCompensation::columns() const {
  std::vector<std::pair<std::string, std::string>> columns = {{"currents", toString(status_)}};
  const auto put = [&](const std::string& name, const char* unit, const Vec3& vector) {
    for (int axis = 0; axis < 3; ++axis)
      columns.emplace_back(fmt::format("{}_{} [{}]", name, "xyz"[axis], unit),
                           fmt::format("{:.9g}", vector[axis]));
  };
  put("current_field", "T", shown_field_B_);
  columns.emplace_back("current_field_sigma [T]", fmt::format("{:.9g}", shown_sigma_T_));
  for (size_t i = 0; i < channels_.size(); ++i) put("current_" + channels_[i], "T/A", shown_fields_B_[i]);
  return columns;
}

}  // namespace lodeline
