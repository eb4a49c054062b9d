#pragma once

#include <array>
#include <bitset>
#include <string>
#include <string_view>

namespace lodeline {

/// Deviations of a simulated recording from the ideal; each can be switched separately.
enum class Effect {
  // Effects of any recording, on in `clean` and `field`.
  ImuNoise,
  ImuBias,
  MagnetometerNoise,
  MagnetometerIron,
  PressureNoise,
  SonarNoise,
  ImageNoise,
  MotionBlur,
  MarineSnow,
  Daylight,
  // Effects of a diver's recording, on in `field`.
  CameraIntrinsics,
  CameraImuExtrinsics,
  StereoExtrinsics,
  MagnetometerExtrinsics,
  FlatPort,
  CameraDelay,
  StampJitter,
  DroppedFrames,
  ImuScale,
  ImuWarmUp,
  MilkyWater,
  SiltOuts,
  SecondDiver,
  BareWalls,
  PoorExposure,
  HardIronCreep,
  MagneticDisturbances,
  LampCurrent,
  MagnetometerLag,
  DepthErrors,
  // Effects that are on only by request.
  RollingShutter,
  ClockDrift,
};
constexpr int kEffectCount = static_cast<int>(Effect::ClockDrift) + 1;

struct EffectDescription {
  Effect effect;
  std::string_view name;  ///< as on the command line
  bool in_clean, in_field;
  std::string_view what;
};
const std::array<EffectDescription, kEffectCount>& effectDescriptions();

class EffectSet {
 public:
  static EffectSet clean();
  static EffectSet field();
  static EffectSet none() { return {}; }
  /// Effects of `clean` or `field`; throws UsageError for any other word.
  static EffectSet named(std::string_view realism);

  bool has(Effect effect) const { return on_[static_cast<size_t>(effect)]; }
  void set(Effect effect, bool on) { on_[static_cast<size_t>(effect)] = on; }
  /// Parses "name=on" or "name=off". Throws UsageError naming the existing effects.
  void set(const std::string& assignment);

 private:
  std::bitset<kEffectCount> on_;
};

}  // namespace lodeline
