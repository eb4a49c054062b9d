#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "lodeline/problem/state/factor.h"
#include "lodeline/types.h"

namespace lodeline {

class FactorBuilder;
class Window;
struct Frame;

/// What a measurement needs to make its factors.
struct MeasurementContext {
  /// What the factors are for: the solution of the window, the marginalization prior, of which they become
  /// part now, or the batch solution.
  enum class Scope { Window, Prior, Batch };

  const FactorBuilder& builder;
  Window& window;
  Frame* before;  ///< the frame before; null for the first
  Frame& frame;
  Scope scope = Scope::Window;
};

/// Velocity that a sensor measured some time before a frame, carried there by inertial readings without
/// gravity: R_B_W (v_W - g_W elapsed_s) at the frame, with one sigma of each axis.
struct CarriedVelocity {
  Vec3 velocity_B = Vec3::Zero();  ///< m/s
  double elapsed_s = 0.0;
  double sigma_m_per_s = 0.0;
};

/// Measurement of one sensor at a frame, until it becomes part of the prior. Each kind of sensor derives its
/// own kind, which makes its factors. Window, marginalizer, covariance and batch solver know only this
/// interface, so that a new kind is added in its own folder.
class Measurement {
 public:
  virtual ~Measurement() = default;

  /// Name of the sensor, the same for all measurements of a kind.
  virtual std::string_view sensor() const = 0;
  /// The terms of the cost; none where the window lacks what they need.
  virtual std::vector<Factor> factors(const MeasurementContext& context) const = 0;
  /// Whether the factors contain the frame before. They are then marginalized with that frame.
  virtual bool isRelative() const { return false; }
  /// Whether the factors contain the frames that observe the same landmarks as the frame.
  virtual bool containsLandmarks() const { return false; }
  /// Called before the factors become part of the prior: sets the linearization points of shared states.
  virtual void fixLinearizationPoints(const Window&) const {}

  /// Sigma with which it measures the height of the frame, m; empty where it does not.
  virtual std::optional<double> heightSigma_m() const { return std::nullopt; }
  /// Whether it measures the velocity of the frame, at least in part. Inertial readings are then not alone.
  virtual bool measuresVelocity() const { return false; }
  /// Information about the factor that all its velocities share, 1 / sigma^2, without the calibration of that
  /// factor; 0 where it measures no velocity.
  virtual double speedInformation() const { return 0.0; }
  /// The whole velocity, for a start with one camera; empty where it does not measure all of it.
  virtual std::optional<CarriedVelocity> velocity() const { return std::nullopt; }

  /// Whether the batch solver uses it.
  virtual bool isForBatch() const { return true; }
  /// Whether it asks for a state of the batch solution before the usual interval has passed.
  virtual bool wantsBatchState() const { return false; }
  /// The measurement that replaces `count` measurements, which the run took for independent.
  virtual std::shared_ptr<const Measurement> weighted(int count) const = 0;
};

/// The measurements of one frame, at most one of each kind, in the order of the sensors.
class Measurements {
 public:
  using Item = std::shared_ptr<const Measurement>;

  bool empty() const { return items_.empty(); }
  bool measureVelocity() const {
    return std::any_of(items_.begin(), items_.end(),
                       [](const Item& item) { return item->measuresVelocity(); });
  }
  std::vector<Item>::const_iterator begin() const { return items_.begin(); }
  std::vector<Item>::const_iterator end() const { return items_.end(); }

  /// The measurement of a kind; null where there is none.
  template <typename Kind>
  const Kind* find() const {
    for (const Item& item : items_) {
      if (const auto* found = dynamic_cast<const Kind*>(item.get())) return found;
    }
    return nullptr;
  }
  /// Adds a measurement in place of one of the same kind.
  template <typename Kind>
  void set(Kind measurement) {
    add(std::make_shared<const Kind>(std::move(measurement)));
  }
  void add(Item item) {
    const auto same = std::find_if(items_.begin(), items_.end(),
                                   [&](const Item& other) { return other->sensor() == item->sensor(); });
    if (same != items_.end()) {
      *same = std::move(item);
    } else {
      items_.push_back(std::move(item));
    }
  }
  template <typename Condition>
  void removeIf(const Condition& condition) {
    std::erase_if(items_, [&](const Item& item) { return condition(*item); });
  }
  template <typename Kind>
  void remove() {
    removeIf([](const Measurement& item) { return dynamic_cast<const Kind*>(&item) != nullptr; });
  }
  void clear() { items_.clear(); }

 private:
  std::vector<Item> items_;
};

}  // namespace lodeline
