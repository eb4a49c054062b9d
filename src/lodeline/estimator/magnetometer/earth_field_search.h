#pragma once

#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// Decides when another field than the present one is more likely the Earth's. A dive may begin beside a boat
/// or between tanks. The disturbed field there is then measured first, and the gate rejects the Earth's field
/// as soon as the diver swims away. The Earth's field keeps size and direction in the world wherever the rig
/// goes, so the field that persists longest is the Earth's:
/// - a field replaces the present one when it has persisted for `kLeast_s` and for longer than the present
///   one agreed;
/// - `kPlausible_s` suffice where the present one cannot be the Earth's at the site (alignHeading());
/// - a field that has agreed for `kConfirmed_s` is not replaced any more, nor is any field after
///   `kMostReplacements`: then the calibration is likely wrong.
/// Only time with readings counts.
class EarthFieldSearch {
 public:
  static constexpr double kLeast_s = 20.0;
  static constexpr double kPlausible_s = 5.0;
  static constexpr double kConfirmed_s = 300.0;
  static constexpr int kMostReplacements = 3;
  static constexpr double kSteadiness = 0.05;  ///< greatest change, relative to the field's size

  struct Reading {
    Time time;
    Vec3 field_W = Vec3::Zero();  ///< measured, T
    bool agrees = false;          ///< with the present field
    bool is_plausible = false;    ///< as the Earth's field at the site
    bool is_field_in_force_plausible = false;
  };
  /// Gives the field (T, world axes) that replaces the present one, where there is one.
  std::optional<Vec3> add(const Reading& reading);

 private:
  void follow(const Reading& reading, double since_s);

  std::optional<Time> last_time_;
  double agreed_s_ = 0.0;            ///< time for which the present field agreed
  std::optional<Vec3> candidate_W_;  ///< mean of the readings that have persisted
  int readings_ = 0;                 ///< of that mean
  double held_s_ = 0.0;
  int replacements_ = 0;
};

}  // namespace lodeline
