#include "lodeline/io/euroc/dvl_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/time_columns.h"

namespace lodeline {
namespace {

/// Rows with a beam have the stamp of their ping, which makes the table look faster.
constexpr PlausibleRate kRowRate = {1.0 / 120.0, 400.0};
constexpr const char* kHeaders =
    "#timestamp [ns],v_x,v_y,v_z [m/s],valid` or `#timestamp [ns],beam,velocity [m/s],range [m],valid";

bool namesVelocity(const ColumnName& column) {
  return column.hasWord({"v", "vx", "vy", "vz"}) || column.hasStem({"vel", "speed"});
}
bool namesValidity(const ColumnName& column) { return column.hasStem({"valid"}) || column.hasWord({"lock"}); }
bool namesSigma(const ColumnName& column) {
  return column.hasStem({"sigma", "std"}) || column.hasWord({"fom"});
}

/// The axis of a velocity in instrument axes; nothing for another column.
std::optional<size_t> axisOf(const ColumnName& column) {
  if (!namesVelocity(column) || namesValidity(column) || namesSigma(column)) return std::nullopt;
  if (column.hasWord({"x", "vx", "velx"})) return 0;
  if (column.hasWord({"y", "vy", "vely"})) return 1;
  if (column.hasWord({"z", "vz", "velz"})) return 2;
  return std::nullopt;
}

template <typename IsWanted>
std::optional<size_t> columnThat(const std::vector<ColumnName>& columns, const IsWanted& is_wanted) {
  const auto found = std::find_if(columns.begin(), columns.end(), is_wanted);
  if (found == columns.end()) return std::nullopt;
  return static_cast<size_t>(found - columns.begin());
}

/// "water", or the number 2 of marine_acoustic_msgs.
DvlTrack trackOf(const std::string& word) {
  const bool is_water = word == "2" || word.starts_with("w") || word.starts_with("W");
  return is_water ? DvlTrack::Water : DvlTrack::Bottom;
}

}  // namespace

DvlTable::DvlTable(AsWritten, const std::filesystem::path& file, size_t beam_count, Diagnostics* diagnostics)
    : file_(file),
      places_(kNumbers),
      reader_(file,
              CsvLayout{3, [this](const std::vector<ColumnName>& columns) { return findColumns(columns); },
                        kHeaders},
              diagnostics, kRowRate),
      screen_(file.string(), beam_count, diagnostics) {}

DvlTable::DvlTable(const std::filesystem::path& file, size_t beam_count, Diagnostics* diagnostics)
    : DvlTable(AsWritten(), file, beam_count, diagnostics) {
  if (!places_[kBeam]) return;
  Diagnostics reported_when_read_in_earnest;
  DvlTable ahead(AsWritten(), file, beam_count, &reported_when_read_in_earnest);
  if (!ahead.countsFromOne(beam_count)) return;
  first_beam_ = 1;
  diagnostics->report(
      Severity::Notice, "dvl_beam_numbers",
      fmt::format("{}: counts its beams from 1; beam 1 is the first of the calibration", file.string()));
}

CsvColumns DvlTable::findColumns(const std::vector<ColumnName>& columns) {
  CsvColumns found;
  places_.assign(kNumbers, std::nullopt);
  addVelocityColumns(columns, &found);
  addBeamColumns(columns, &found);
  if (!places_[kVx] && !places_[kVelocity]) {
    throw InputError(
        fmt::format("{}: its header names no velocity, or a beam without its velocity; expected `{}`",
                    file_.string(), kHeaders));
  }
  const auto sigma = columnThat(columns, namesSigma);
  if (sigma) {
    places_[kSigma] = found.numbers.size();
    const StatedUnit unit = statedUnit(columns[*sigma], Quantity::Velocity);
    found.numbers.push_back({*sigma, unitFactorOf(file_, unit, Quantity::Velocity), true});
  }
  found.text = columnThat(columns, [](const ColumnName& column) {
    return column.hasWord({"track", "mode"});
  });
  return found;
}

void DvlTable::addVelocityColumns(const std::vector<ColumnName>& columns, CsvColumns* found) {
  std::vector<std::optional<size_t>> axes(3);
  StatedUnit common;  // of the first axis that states one
  for (size_t i = 0; i < columns.size(); ++i) {
    const std::optional<size_t> axis = axisOf(columns[i]);
    if (!axis || axes[*axis]) continue;
    axes[*axis] = i;
    if (common.text.empty()) common = statedUnit(columns[i], Quantity::Velocity);
  }
  const auto count =
      std::count_if(axes.begin(), axes.end(), [](const auto& axis) { return axis.has_value(); });
  if (count == 0) return;
  if (count != 3) {
    throw InputError(fmt::format("{}: its header names {} of the three axes of the velocity; expected `{}`",
                                 file_.string(), count, kHeaders));
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    StatedUnit unit = statedUnit(columns[*axes[axis]], Quantity::Velocity);
    if (unit.text.empty()) unit = common;
    places_[kVx + axis] = found->numbers.size();
    found->numbers.push_back({*axes[axis], unitFactorOf(file_, unit, Quantity::Velocity), true});
  }
  const bool has_beams =
      columnThat(columns, [](const ColumnName& c) { return c.hasWord({"beam"}); }).has_value();
  const auto valid = columnThat(columns, [&](const ColumnName& column) {
    return namesValidity(column) && (namesVelocity(column) || !has_beams);
  });
  if (!valid) return;
  places_[kVelocityValid] = found->numbers.size();
  found->numbers.push_back({*valid, 1.0, false});
}

void DvlTable::addBeamColumns(const std::vector<ColumnName>& columns, CsvColumns* found) {
  const auto add = [&](Number number, std::optional<size_t> column, double to_si, bool may_be_missing) {
    if (!column) return;
    places_[number] = found->numbers.size();
    found->numbers.push_back({*column, to_si, may_be_missing});
  };
  const auto velocity = columnThat(columns, [](const ColumnName& column) {
    return namesVelocity(column) && !axisOf(column) && !namesValidity(column) && !namesSigma(column);
  });
  const auto beam = columnThat(columns, [](const ColumnName& column) {
    return column.hasWord({"beam", "transducer"}) && !namesVelocity(column) && !namesValidity(column) &&
           !column.hasWord({"range", "distance"});
  });
  if (!beam || !velocity) return;
  const auto range = columnThat(columns, [](const ColumnName& column) {
    return column.hasWord({"range", "distance"});
  });
  const auto valid = columnThat(columns, [&](const ColumnName& column) {
    return namesValidity(column) && !(namesVelocity(column) && places_[kVelocityValid].has_value());
  });
  add(kBeam, beam, 1.0, true);
  add(kVelocity, velocity,
      unitFactorOf(file_, statedUnit(columns[*velocity], Quantity::Velocity), Quantity::Velocity), true);
  if (range) {
    const StatedUnit unit = statedUnit(columns[*range], Quantity::Length);
    add(kRange, range, unitFactorOf(file_, unit, Quantity::Length), true);
  }
  add(kValid, valid, 1.0, false);
}

std::optional<double> DvlTable::number(Number number) const {
  if (!places_[number]) return std::nullopt;
  return row_.numbers[*places_[number]];
}

bool DvlTable::countsFromOne(size_t beam_count) {
  constexpr int kRows = 400;
  bool has_last = false;
  for (int i = 0; i < kRows && reader_.next(&row_); ++i) {
    const double beam = number(kBeam).value_or(0.0);
    if (beam == 0.0) return false;
    has_last = has_last || beam == static_cast<double>(beam_count);
  }
  return has_last;
}

void DvlTable::addBeam(StatedDvlPing* ping) {
  const double beam = number(kBeam).value_or(std::nan(""));
  if (!std::isfinite(beam)) return;  // a ping without beams
  if (beam != std::floor(beam) || std::abs(beam) > 1000.0) {
    reader_.passOver(fmt::format("{:g} is no number of a beam", beam));
    return;
  }
  StatedDvlBeam stated;
  stated.index = static_cast<int>(beam) - first_beam_;
  stated.velocity_m_per_s = number(kVelocity).value_or(stated.velocity_m_per_s);
  stated.range_m = number(kRange).value_or(stated.range_m);
  if (const std::optional<double> valid = number(kValid)) stated.is_valid = *valid != 0.0;
  ping->beams.push_back(stated);
}

StatedDvlPing DvlTable::pingOfRow() {
  StatedDvlPing ping;
  ping.time = row_.time;
  ping.track = trackOf(row_.text);
  if (places_[kVx]) ping.velocity_D = Vec3(*number(kVx), *number(kVy), *number(kVz));
  if (const std::optional<double> valid = number(kVelocityValid)) ping.is_velocity_valid = *valid != 0.0;
  ping.velocity_sigma_m_per_s = number(kSigma).value_or(ping.velocity_sigma_m_per_s);
  if (places_[kBeam]) addBeam(&ping);
  return ping;
}

std::optional<DvlSample> DvlTable::next() {
  if (!has_row_ && !reader_.next(&row_)) {
    screen_.finish();
    return std::nullopt;
  }
  StatedDvlPing ping = pingOfRow();
  has_row_ = false;
  while (places_[kBeam] && reader_.next(&row_)) {
    has_row_ = true;
    const double beam = number(kBeam).value_or(0.0) - first_beam_;
    const bool is_listed = std::any_of(ping.beams.begin(), ping.beams.end(), [&](const StatedDvlBeam& other) {
      return static_cast<double>(other.index) == beam;
    });
    if (row_.time != ping.time || is_listed) break;  // a beam that is listed again begins another ping
    addBeam(&ping);
    has_row_ = false;
  }
  return screen_.screened(ping);
}

}  // namespace lodeline
