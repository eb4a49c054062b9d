#pragma once

#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/estimator/sonar/echo_source.h"
#include "lodeline/estimator/sonar/sonar_measurement.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Status of a sonar in a frame.
enum class SonarStatus {
  Off,        ///< not requested, or not on board
  NoData,     ///< no echo since the frame before
  Used,       ///< at least one echo
  NoSurface,  ///< too few landmarks around the beam
  Rejected,   ///< the echoes disagree with the surface
};
const char* toString(SonarStatus status);

/// Result of a sonar for a frame; each kind of sonar has its type.
template <typename Sample>
struct EchoEstimate {
  SonarStatus status = SonarStatus::Off;
  int echoes = 0;             ///< since the frame before
  int used = 0;               ///< of these
  double innovation_m = 0.0;  ///< mean of range minus predicted range, of the echoes that were used
};

/// Adds the echoes of a kind of sonar (EchoSource) to a window. Each echo is compared with the surface that
/// the landmarks around its beam form. It is used within a gate, whose width follows from sonar noise,
/// scatter of the surface and the window's covariance of the scale.
template <typename Sample>
class EchoFusion final : public SensorFusion {
 public:
  /// `diagnostics` must outlive it.
  EchoFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);

  std::string_view name() const override { return EchoSource<Sample>::kName; }
  void take(const SensorReadings& readings, std::span<const ImuSample> imu,
            const Vec3& gyroscope_bias_B) override;
  void addToNewest(Window& window, Marginalizer& marginalizer) override;
  void remember(const JointCovariance& covariance, Window& window) override;
  void report(const Window& window, SensorEstimates* estimates) const override;
  std::optional<SensorRow> row() const override;

 private:
  bool isValid(const RawEcho& echo) const;
  SonarEcho echoOf(const RawEcho& echo, const Frame& before, const Frame& newest) const;
  /// Whether an echo agrees with the surface.
  bool agrees(const SonarEcho& echo, const LocalSurface& surface);
  void reportRejections(Time time);

  SonarOptions options_;
  Diagnostics* diagnostics_;
  std::optional<EchoSource<Sample>> sonar_;
  std::vector<RawEcho> waiting_;
  EchoEstimate<Sample> estimate_;
  double scale_sigma_;             ///< relative, within the limits of the options
  std::optional<Time> last_used_;  ///< time of the last echo that was used
  int judged_ = 0, rejected_ = 0;  ///< echoes on a surface since the start
  bool is_rejection_reported_ = false;
};

using SonarEstimate = EchoEstimate<SonarSample>;
using SonarFusion = EchoFusion<SonarSample>;
using AltimeterEstimate = EchoEstimate<AltimeterSample>;
using AltimeterFusion = EchoFusion<AltimeterSample>;
using DvlRangeEstimate = EchoEstimate<DvlSample>;
using DvlRangeFusion = EchoFusion<DvlSample>;

}  // namespace lodeline
