#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/recording.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Opens a recording from its start, with its findings in the given diagnostics.
using RecordingOpener = std::function<std::unique_ptr<RecordedSource>(Diagnostics*)>;

/// Settings of the odometry, by the keys of docs/reference/settings.md. The defaults suit all recordings.
class OdometrySettings {
 public:
  OdometrySettings();
  ~OdometrySettings();
  OdometrySettings(OdometrySettings&&) noexcept;
  OdometrySettings& operator=(OdometrySettings&&) noexcept;

  /// Reads a YAML configuration. Throws UsageError for an unknown key or a wrong value.
  void load(const std::filesystem::path& file);
  /// Sets one key; `value` in YAML syntax: "3", "true", "[1, 2]". Throws UsageError.
  void set(const std::string& key, const std::string& value);
  /// Writes all values as a configuration.
  void write(std::ostream& stream) const;

  /// Checks the first seconds of a recording, as `lodeline run` does before a run. Corrects units of the
  /// readings and clock offsets that it finds there. `name`: of the recording, for the findings.
  void adaptTo(const RecordingOpener& open, const std::string& name, Diagnostics* diagnostics);

  /// Options for openEuroc() by `source.cameras`.
  EurocOptions recording() const;

  struct Values;
  const Values& values() const { return *values_; }

 private:
  std::unique_ptr<Values> values_;
};

/// Estimates the state of a rig at every image of its first camera, from a recording (openEuroc(), openBag())
/// or from live readings (LiveSource):
///
///     Odometry odometry(source.get(), {}, &diagnostics);
///     while (const auto estimate = odometry.next()) use(estimate->state, estimate->covariance);
class Odometry {
 public:
  /// `source` and `diagnostics` must outlive the odometry. Throws InputError and UsageError.
  Odometry(RecordedSource* source, const OdometrySettings& settings, Diagnostics* diagnostics);
  ~Odometry();
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;

  /// The estimate at the next image; nothing at the end of the source. Waits for a live source. Estimates
  /// are in order of time and never revised. Throws InputError.
  std::optional<FrameEstimate> next();

  /// Landmarks that left the window since the last call, in order; at the end also those still in it.
  std::vector<MapPoint> takeLandmarks();

  /// Keeps what refine() needs; call it before the first next(). Two states of the solution are at most about
  /// `state_interval_s` apart; with 0 every image is a state. Memory then grows with the recording.
  void keepForRefinement(double state_interval_s = 0.5);
  /// Solves for all states of the source at once, after next() has returned nothing. Throws UsageError where
  /// the measurements were not kept or the source has not ended, EstimationError where there is no pose.
  Refinement refine() const;

  struct Implementation;
  const Implementation& implementation() const { return *implementation_; }

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lodeline
