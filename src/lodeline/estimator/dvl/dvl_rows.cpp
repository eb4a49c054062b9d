#include "lodeline/estimator/dvl/dvl_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kGreatestSpeed_m_per_s = 10.0;
constexpr double kLeastSigma_m_per_s = 1e-4;

bool isPossible(double velocity) { return std::abs(velocity) <= kGreatestSpeed_m_per_s; }  // not for nan

void addBeams(const DvlSample& sample, const DvlCalibration& dvl, DvlReading* reading) {
  for (const DvlBeam& beam : sample.beams) {
    if (!beam.velocity_m_per_s) continue;
    if (beam.index < 0 || beam.index >= static_cast<int>(dvl.beams_D.size())) {
      reading->fault = fmt::format("beam {} of {}", beam.index, dvl.beams_D.size());
    } else if (!isPossible(*beam.velocity_m_per_s)) {
      reading->fault = fmt::format("{} m/s along beam {}", *beam.velocity_m_per_s, beam.index);
    } else {
      reading->rows.push_back({dvl.beams_D[static_cast<size_t>(beam.index)], *beam.velocity_m_per_s});
    }
  }
}

void addAxes(const DvlSample& sample, DvlReading* reading) {
  if (!sample.velocity_D) return;
  const Vec3& v = *sample.velocity_D;
  reading->is_velocity = true;
  if (!isPossible(v.norm())) {
    reading->fault = fmt::format("a velocity of ({}, {}, {}) m/s", v.x(), v.y(), v.z());
    return;
  }
  for (int axis = 0; axis < 3; ++axis) reading->rows.push_back({Vec3::Unit(axis), v[axis]});
}

}  // namespace

DvlReading readRows(const DvlSample& sample, const DvlCalibration& dvl) {
  DvlReading reading;
  reading.time = sample.time;
  reading.track = sample.track;
  const bool has_beams = std::any_of(sample.beams.begin(), sample.beams.end(),
                                     [](const DvlBeam& beam) { return beam.velocity_m_per_s.has_value(); });
  if (has_beams) {
    addBeams(sample, dvl, &reading);
  } else {
    addAxes(sample, &reading);
  }
  reading.sigma_m_per_s = std::max(dvl.velocity_noise_std_m_per_s, kLeastSigma_m_per_s);
  const double stated = sample.velocity_sigma_m_per_s.value_or(0.0);
  if (reading.is_velocity && std::isfinite(stated))
    reading.sigma_m_per_s = std::max(reading.sigma_m_per_s, stated);
  const bool are_zero = std::all_of(reading.rows.begin(), reading.rows.end(),
                                    [](const DvlRow& row) { return row.velocity_m_per_s == 0.0; });
  if (reading.rows.size() > 1 && are_zero) {
    reading.rows.clear();
    reading.fault = "nothing but velocities of exactly 0";
  }
  return reading;
}

}  // namespace lodeline
