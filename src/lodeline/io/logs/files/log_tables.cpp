#include "lodeline/io/logs/files/log_tables.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/csv/sensor_columns.h"
#include "lodeline/io/logs/files/zip_archive.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr size_t kMostTables = 200;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool isNamedAsTable(const std::filesystem::path& name) {
  constexpr std::array kExtensions = {".csv", ".tsv", ".txt"};
  const std::string extension = lower(name.extension().string());
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

ColumnName nameOf(const LogTable& table) {
  return ColumnName(std::filesystem::path(table.name).stem().string());
}

bool isGravity(const LogTable& table) { return nameOf(table).hasStem({"gravity", "gravitation"}); }

/// What one table holds.
struct Content {
  bool has_gyroscope = false, has_accelerometer = false, has_magnetometer = false;
  double force_m_per_s2 = 0.0;  ///< median magnitude of the first readings
};

Content contentOf(const LogTable& table) {
  constexpr size_t kReadings = 100;
  Content content;
  try {
    Diagnostics unheard;
    PlainCsv csv(table.open(), table.name, &unheard, tableOptions(table, {}));
    content.has_gyroscope = csv.hasGyroscope();
    content.has_accelerometer = csv.hasAccelerometer();
    content.has_magnetometer = csv.hasMagnetometer();
    std::vector<double> forces;
    for (PlainReading reading; forces.size() < kReadings && csv.next(&reading);) {
      if (!reading.specific_force) break;
      forces.push_back(reading.specific_force->norm());
    }
    content.force_m_per_s2 = median(std::move(forces));
  } catch (const InputError&) {
    return {};  // another table, such as places or notes
  }
  return content;
}

/// The first of several tables that are alike, with the uncorrected readings of a telephone before others.
template <typename Fits>
std::optional<size_t> best(const std::vector<LogTable>& tables, const std::vector<Content>& contents,
                           const Fits& fits) {
  std::optional<size_t> found;
  for (size_t i = 0; i < tables.size(); ++i) {
    if (!fits(contents[i], tables[i])) continue;
    const bool is_raw = nameOf(tables[i]).hasStem({"uncal", "raw"});
    if (!found || (is_raw && !nameOf(tables[*found]).hasStem({"uncal", "raw"}))) found = i;
  }
  return found;
}

}  // namespace

std::vector<LogTable> tablesIn(const std::filesystem::path& path) {
  std::vector<LogTable> tables;
  if (std::filesystem::is_directory(path)) {
    std::error_code error;
    for (auto entry = std::filesystem::directory_iterator(path, error);
         !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      const std::filesystem::path file = entry->path();
      if (!isNamedAsTable(file) || !entry->is_regular_file(error)) continue;
      tables.push_back({file.filename().string(), [file] { return openFile(file); }});
    }
  } else {
    const auto archive = std::make_shared<ZipArchive>(path);
    for (const ZipEntry& entry : archive->entries()) {
      const std::filesystem::path file = entry.name;
      if (!isNamedAsTable(file)) continue;
      tables.push_back({file.filename().string(), [archive, entry] { return archive->open(entry); }});
    }
  }
  std::sort(tables.begin(), tables.end(),
            [](const LogTable& a, const LogTable& b) { return a.name < b.name; });
  if (tables.size() > kMostTables) tables.resize(kMostTables);
  return tables;
}

RecordingFacts factsOf(const std::vector<LogTable>& tables) {
  RecordingFacts facts;
  const auto metadata = std::find_if(tables.begin(), tables.end(), [](const LogTable& table) {
    return lower(table.name) == "metadata.csv";
  });
  if (metadata == tables.end()) return facts;
  // Sensor Logger: "version,device name,...,platform,...,standardisation,...".
  std::optional<size_t> platform, standardized;
  TableOptions options;
  options.needs_rows = false;
  options.is_header = [&](const std::vector<ColumnName>& names) {
    for (size_t i = 0; i < names.size(); ++i) {
      if (names[i].text == "platform") platform = i;
      if (names[i].hasStem({"standardi"})) standardized = i;
    }
    return platform && standardized;
  };
  Diagnostics unheard;
  TableReader table(metadata->open(), metadata->name, options, &unheard);
  if (!table.hasHeader() || !table.next()) return facts;
  facts.is_sensor_logger = facts.has_metadata = true;
  facts.has_negative_forces = lower(std::string(table.cell(*platform))) == "ios" &&
                              lower(std::string(table.cell(*standardized))) != "true";
  return facts;
}

PlainCsvOptions tableOptions(const LogTable& table, const RecordingFacts& facts) {
  constexpr double kMicrotesla_T = 1e-6;
  PlainCsvOptions options;
  options.bare_columns = isGravity(table) ? Quantity::SpecificForce : quantityOfName(nameOf(table));
  if (facts.is_sensor_logger) options.field_unit_T = kMicrotesla_T;
  return options;
}

TableChoice chooseTables(const std::vector<LogTable>& tables) {
  constexpr double kLeastWithGravity_m_per_s2 = 4.9, kMostWithGravity_m_per_s2 = 19.7;
  std::vector<Content> contents;
  for (const LogTable& table : tables) {
    const bool is_of_other_device = nameOf(table).hasWord({"watch", "wrist", "headphone", "headphones"});
    contents.push_back(is_of_other_device ? Content() : contentOf(table));
  }
  TableChoice choice;
  choice.gyroscope =
      best(tables, contents, [](const Content& content, const LogTable&) { return content.has_gyroscope; });
  choice.magnetometer = best(
      tables, contents, [](const Content& content, const LogTable&) { return content.has_magnetometer; });
  choice.accelerometer = best(tables, contents, [&](const Content& content, const LogTable& table) {
    return content.has_accelerometer && !isGravity(table) &&
           content.force_m_per_s2 > kLeastWithGravity_m_per_s2 &&
           content.force_m_per_s2 < kMostWithGravity_m_per_s2;
  });
  if (choice.accelerometer) return choice;
  const auto linear = best(tables, contents, [](const Content& content, const LogTable& table) {
    return content.has_accelerometer && !isGravity(table);
  });
  choice.gravity = best(tables, contents, [](const Content& content, const LogTable& table) {
    return content.has_accelerometer && isGravity(table);
  });
  choice.has_no_gravity = linear && !choice.gravity;
  if (linear && choice.gravity) choice.accelerometer = linear;
  if (!choice.accelerometer) choice.gravity.reset();
  return choice;
}

}  // namespace lodeline
