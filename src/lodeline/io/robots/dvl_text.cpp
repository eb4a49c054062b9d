#include "lodeline/io/robots/dvl_text.h"

#include <fmt/core.h>

namespace lodeline {
namespace {

/// A missing number is an empty cell.
std::string cell(const std::optional<double>& number) { return number ? fmt::format("{}", *number) : ""; }

}  // namespace

DvlText::DvlText(const std::vector<DvlSample>& pings) {
  for (const DvlSample& ping : pings) {
    has_velocity_ = has_velocity_ || ping.velocity_D.has_value();
    has_beams_ = has_beams_ || !ping.beams.empty();
    has_sigma_ = has_sigma_ || ping.velocity_sigma_m_per_s.has_value();
    has_track_ = has_track_ || ping.track == DvlTrack::Water;
  }
  if (!has_beams_) has_velocity_ = true;
}

std::string DvlText::header() const {
  std::string header = "#timestamp [ns]";
  if (has_beams_) header += ",beam,velocity [m/s],range [m],valid";
  if (has_velocity_)
    header += has_beams_ ? ",v_x [m/s],v_y [m/s],v_z [m/s],v_valid" : ",v_x [m/s],v_y [m/s],v_z [m/s],valid";
  if (has_sigma_) header += ",sigma [m/s]";
  if (has_track_) header += ",track";
  return header + "\n";
}

std::string DvlText::velocityCells(const DvlSample& ping) const {
  if (!has_velocity_) return "";
  if (!ping.velocity_D) return ",,,,0";
  const Vec3& v = *ping.velocity_D;
  return fmt::format(",{},{},{},1", v.x(), v.y(), v.z());
}

std::string DvlText::lastCells(const DvlSample& ping) const {
  std::string text;
  if (has_sigma_) text += fmt::format(",{}", cell(ping.velocity_sigma_m_per_s));
  if (has_track_) text += ping.track == DvlTrack::Water ? ",water" : ",bottom";
  return text;
}

std::string DvlText::rows(const DvlSample& ping) const {
  const std::string stamp = fmt::format("{}", ping.time.nanoseconds());
  const std::string rest = velocityCells(ping) + lastCells(ping) + "\n";
  if (!has_beams_) return stamp + rest;
  if (ping.beams.empty()) return stamp + ",,,,0" + rest;
  std::string text;
  for (const DvlBeam& beam : ping.beams) {
    // A beam is valid by its velocity; the range is an empty cell where it is missing.
    text += fmt::format("{},{},{},{},{:d}{}", stamp, beam.index, cell(beam.velocity_m_per_s),
                        cell(beam.range_m), beam.velocity_m_per_s || beam.range_m, rest);
  }
  return text;
}

}  // namespace lodeline
