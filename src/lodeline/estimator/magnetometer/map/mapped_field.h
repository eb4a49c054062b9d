#pragma once

#include <deque>
#include <optional>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/field_map/field_map.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Learns the field near steel where the gate does not take it for the Earth's, and uses it on the next
/// visit.
/// - A reading is learnt when its frame has lost its motion state, at the pose that the window then gives it.
///   A reading that the window uses is never learnt, and the reverse.
/// - The map's axes have a heading in the world (MappedFieldMeasurement::kHeading). It is tied to the heading
///   of the frame at which the map begins. So the window knows how far headings are known relative to the
///   map.
/// - A reading is used where the map is `kAway_s` old and gives heading better than `kMaxHeadingSigma_rad`.
/// Its
///   covariance contains that of the map, the drift of position and heading since, and the noise.
/// - A place whose field differs from the map `kContradictions` times in a row is forgotten.
/// Nothing is allocated before the first reading that is not the Earth's field.
class MappedField {
 public:
  static constexpr double kAway_s = 30.0;
  static constexpr double kMaxHeadingSigma_rad = 0.1;
  static constexpr int kContradictions = 5;

  struct Reading {
    Time time;
    Vec3 field_B = Vec3::Zero();  ///< without hard iron and currents, T
    Vec3 earth_W = Vec3::Zero();  ///< the Earth's field, T
    double variance_T2 = 0.0;     ///< of its independent noise, per axis
    double tilt_sigma_rad = 0.0;  ///< of roll and pitch, per axis
  };

  /// `diagnostics` must outlive it.
  MappedField(bool is_wanted, Diagnostics* diagnostics) : is_wanted_(is_wanted), diagnostics_(diagnostics) {}

  /// Learns the waiting readings of frames that have no motion state any more.
  void learnSettled(const Window& window);
  /// Takes the newest frame's reading, which is not the Earth's field. Returns true where the frame got a
  /// measurement from the map; otherwise the reading waits to be learnt, if `may_learn`.
  bool take(const Reading& reading, bool may_learn, Window& window);
  /// Stores how well position and heading are known relative to the map.
  void remember(const JointCovariance& covariance, const Window& window);

  int tiles() const { return map_ ? map_->tiles() : 0; }
  int used() const { return used_; }  ///< readings so far

 private:
  struct Waiting {
    FrameId frame = 0;
    Rigid3 world_from_body;  ///< as last estimated
    Reading reading;
    FieldMapOrigin origin;
  };
  void begin(const Reading& reading, Window& window);
  void learn(const Waiting& waiting, double heading_rad);
  /// The measurement by the map; empty where it knows too little, or where the reading contradicts it.
  bool use(const Reading& reading, Window& window);
  void await(const Reading& reading, const Window& window);
  void contradict(const Vec3& place_W);

  bool is_wanted_;
  Diagnostics* diagnostics_;
  std::optional<FieldMap> map_;
  Vec3 earth_M_ = Vec3::Zero();
  std::deque<Waiting> waiting_;
  std::optional<Vec3> last_learnt_W_, last_used_W_;  ///< places
  /// Of the newest frame, relative to the map's heading and to the first pose; empty until they are known.
  std::optional<FieldMapOrigin> known_;
  int contradictions_ = 0;
  int used_ = 0;
};

}  // namespace lodeline
