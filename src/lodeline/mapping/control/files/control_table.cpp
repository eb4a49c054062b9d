#include "lodeline/mapping/control/files/control_table.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "lodeline/io/tables/table_reader.h"
#include "lodeline/io/tables/units.h"
#include "lodeline/mapping/control/files/control_positions.h"

namespace lodeline {
namespace {

using Column = std::optional<size_t>;
using Triple = std::array<Column, 3>;

/// The columns of a table of control points.
struct ControlColumns {
  Column name, kind, tag, size, time, dive, horizontal_sigma, vertical_sigma;
  Triple geodetic, grid, local;
};

ControlColumns columnsOf(const std::vector<ColumnName>& names) {
  ControlColumns columns;
  for (size_t i = 0; i < names.size(); ++i) {
    const ColumnName& name = names[i];
    const auto take = [&](Column* column) {
      if (!*column) *column = i;
    };
    if (name.hasWord({"sigma", "accuracy", "std"}))
      take(name.hasWord({"vertical", "v", "height", "up"}) ? &columns.vertical_sigma
                                                           : &columns.horizontal_sigma);
    else if (name.hasWord({"size", "edge"}))
      take(&columns.size);
    else if (name.hasWord({"name", "station", "point"}))
      take(&columns.name);
    else if (name.hasWord({"kind", "type"}))
      take(&columns.kind);
    else if (name.hasWord({"tag"}))
      take(&columns.tag);
    else if (name.hasWord({"time", "stamp", "timestamp"}))
      take(&columns.time);
    else if (name.hasWord({"dive"}))
      take(&columns.dive);
    else if (name.hasWord({"latitude", "lat"}))
      take(&columns.geodetic[0]);
    else if (name.hasWord({"longitude", "lon", "long", "lng"}))
      take(&columns.geodetic[1]);
    else if (name.hasWord({"height"}))
      take(&columns.geodetic[2]);
    else if (name.hasWord({"easting"}))
      take(&columns.grid[0]);
    else if (name.hasWord({"northing"}))
      take(&columns.grid[1]);
    else if (name.hasWord({"altitude"}))
      take(&columns.grid[2]);
    else if (name.hasWord({"east"}))
      take(&columns.local[0]);
    else if (name.hasWord({"north"}))
      take(&columns.local[1]);
    else if (name.hasWord({"up"}))
      take(&columns.local[2]);
  }
  return columns;
}

/// Reads the rows of a table of control points.
class ControlTable {
 public:
  ControlTable(const std::filesystem::path& file, const ControlReadOptions& options, Diagnostics* diagnostics)
      : table_(file, tableOptions(), diagnostics), options_(options) {
    if (!table_.hasHeader()) {
      throw InputError(
          fmt::format("{}: there is no header with the columns 'name' and, say, 'kind', 'latitude', "
                      "'longitude', 'height'",
                      file.string()));
    }
    columns_ = columnsOf(table_.columns());
    if (columns_.geodetic[0] && !columns_.geodetic[1]) fail("there is a latitude but no longitude");
  }

  ControlSet read() {
    ControlSet set;
    while (table_.next()) readRow(&set);
    return set;
  }

 private:
  static TableOptions tableOptions() {
    TableOptions options;
    options.is_header = [](const std::vector<ColumnName>& names) {
      const ControlColumns columns = columnsOf(names);
      return columns.name && names.size() > 1;
    };
    options.finding = "control_row";
    options.refuses_misfits = true;
    options.may_have_units_below = false;  // a row may have names alone
    options.rows_may_be_short = true;
    return options;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(fmt::format("{}: {}", table_.where(), reason));
  }

  std::string text(const Column& column) const {
    return column ? std::string(table_.cell(*column)) : std::string();
  }

  /// A number in metres or degrees; nothing for an empty cell.
  std::optional<double> number(const Column& column) const {
    if (!column || table_.cell(*column).empty()) return std::nullopt;
    const auto value = table_.number(*column);
    if (!value || !std::isfinite(*value)) {
      fail(fmt::format("'{}' in the column '{}' is no number", excerpt(table_.cell(*column)),
                       table_.columns()[*column].text));
    }
    return *value;
  }

  /// A length in metres by the unit that the header states.
  std::optional<double> length_m(const Column& column) const {
    const auto value = number(column);
    if (!value) return std::nullopt;
    const StatedUnit unit = statedUnit(table_.columns()[*column], Quantity::Length);
    if (unit.isUnknown()) {
      fail(fmt::format("the column '{}' has the unknown unit '{}'", table_.columns()[*column].text,
                       unit.text));
    }
    return *value * unit.factor.value_or(1.0);
  }

  ControlKind kind(bool has_tag) const {
    const std::string word = text(columns_.kind);
    if (word.empty()) return has_tag ? ControlKind::Tag : ControlKind::Station;
    const auto kind = controlKindFrom(word);
    if (!kind) fail(fmt::format("the kind '{}' is none of gps, station, tag, tie", excerpt(word)));
    return *kind;
  }

  ControlReadOptions::Sigmas sigmas(ControlKind kind) const {
    ControlReadOptions::Sigmas sigmas = options_.sigmasOf(kind);
    sigmas.horizontal_m = length_m(columns_.horizontal_sigma).value_or(sigmas.horizontal_m);
    sigmas.vertical_m = length_m(columns_.vertical_sigma).value_or(sigmas.vertical_m);
    if (!(sigmas.horizontal_m > 0.0 && sigmas.vertical_m > 0.0)) fail("a sigma is not positive");
    return sigmas;
  }

  /// All three coordinates, or nothing where the row has none of them.
  std::optional<Vec3> lengths_m(const Triple& columns) const {
    Vec3 values;
    int count = 0;
    for (size_t i = 0; i < 3; ++i) {
      if (const auto value = length_m(columns[i])) {
        values[static_cast<long>(i)] = *value;
        ++count;
      }
    }
    if (count == 0) return std::nullopt;
    if (count < 3) fail("a coordinate is missing");
    return values;
  }

  std::optional<PositionPrior> position(ControlKind kind) const {
    try {
      const auto latitude_deg = number(columns_.geodetic[0]), longitude_deg = number(columns_.geodetic[1]);
      if (latitude_deg.has_value() != longitude_deg.has_value()) fail("a coordinate is missing");
      if (latitude_deg) {
        const auto height_m = length_m(columns_.geodetic[2]);
        if (!height_m) fail("the height is missing");
        return onMap(GeodeticPosition{*latitude_deg, *longitude_deg, *height_m}, options_, sigmas(kind));
      }
      if (const auto grid = lengths_m(columns_.grid)) return onMap(*grid, options_, sigmas(kind));
      if (const auto local = lengths_m(columns_.local)) return onMap(*local, {}, sigmas(kind));
    } catch (const InputError& error) {
      const std::string where = table_.where() + ": ";
      if (std::string_view(error.what()).starts_with(where)) throw;
      throw InputError(where + error.what());
    }
    return std::nullopt;
  }

  void readRow(ControlSet* set) {
    ControlPoint point;
    point.origin = table_.where();
    if (const auto tag = number(columns_.tag)) {
      if (*tag < 0.0 || *tag != std::floor(*tag) || *tag > 1e6) fail("the tag is no number of an AprilTag");
      point.tag = static_cast<int>(*tag);
    }
    point.name = text(columns_.name);
    point.kind = kind(point.tag.has_value());
    if (point.kind == ControlKind::Tag && !point.tag) fail("a tag lacks its number in the column 'tag'");
    if (point.name.empty() && point.tag) point.name = fmt::format("tag {}", *point.tag);
    if (point.name.empty()) fail("the name is missing");
    point.position = position(point.kind);
    if (point.kind == ControlKind::Gps && !point.position && set->find(point.name) == nullptr)
      fail(fmt::format("'{}' has no position", point.name));
    set->add(point);
    addSize(point, set);
    addVisit(point, set);
  }

  void addSize(const ControlPoint& point, ControlSet* set) const {
    const auto size_m = length_m(columns_.size);
    if (!size_m) return;
    if (!point.tag) fail(fmt::format("'{}' has a size but is no tag", point.name));
    if (!(*size_m > 0.0)) fail("the size of a tag is not positive");
    const auto [stated, is_new] = set->tag_sizes_m.try_emplace(*point.tag, *size_m);
    if (!is_new && stated->second != *size_m) fail(fmt::format("tag {} has two sizes", *point.tag));
  }

  void addVisit(const ControlPoint& point, ControlSet* set) {
    if (!columns_.time || table_.cell(*columns_.time).empty()) return;
    ControlVisit visit{point.name, text(columns_.dive), {}, {}, point.origin};
    const auto value = number(columns_.time);
    const auto unit = timeUnitOfName(table_.columns()[*columns_.time].text);
    // A number as large as a stamp of a clock is one: of seconds from 1973 on, or of nanoseconds.
    constexpr double kLeastStamp_s = 1e8, kLeastStamp_ns = 1e12;
    const TimeUnit actual =
        unit ? *unit : (*value >= kLeastStamp_ns ? TimeUnit::Nanoseconds : TimeUnit::Seconds);
    const auto time_ns = table_.time_ns(*columns_.time, actual);
    if (!time_ns) fail("the time exceeds the range of stamps");
    if (*time_ns < 0) fail("the time is negative");
    if (*time_ns >= static_cast<int64_t>(1e9 * kLeastStamp_s))
      visit.stamp = Time::fromNanoseconds(*time_ns);
    else
      visit.since_start = Duration::fromNanoseconds(*time_ns);
    set->visits.push_back(visit);
  }

  TableReader table_;
  const ControlReadOptions& options_;
  ControlColumns columns_;
};

}  // namespace

ControlSet readControlTable(const std::filesystem::path& file, const ControlReadOptions& options,
                            Diagnostics* diagnostics) {
  return ControlTable(file, options, diagnostics).read();
}

}  // namespace lodeline
