#include "lodeline/output/report/page/table_json.h"

#include <cmath>

#include "lodeline/output/report/data/row_choice.h"

namespace lodeline {
namespace {

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

}  // namespace

nlohmann::json shortNumber(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0;
  // Uses exact powers of ten, so that the shortest decimal of the result has six digits.
  const int digits_after_point = 5 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  const double power = std::pow(10.0, std::abs(digits_after_point));
  return digits_after_point >= 0 ? std::round(value * power) / power : rounded(value, power);
}

nlohmann::json shortNumbers(const std::vector<double>& values, const std::vector<size_t>& rows) {
  nlohmann::json json = nlohmann::json::array();
  for (const size_t row : rows) json.push_back(shortNumber(values[row]));
  return json;
}

nlohmann::json secondsSince(int64_t origin_ns, const std::vector<int64_t>& stamp_ns,
                            const std::vector<size_t>& rows) {
  nlohmann::json json = nlohmann::json::array();
  for (const size_t row : rows) {
    json.push_back(std::round(1e-6 * static_cast<double>(stamp_ns[row] - origin_ns)) / 1e3);
  }
  return json;
}

nlohmann::ordered_json tableJson(const RunTable& table, int64_t origin_ns, size_t most,
                                 const std::function<bool(const std::string&)>& is_wanted) {
  std::vector<const std::vector<std::string>*> words;
  for (const auto& [name, values] : table.words) words.push_back(&values);
  const RowChoice choice = chooseRows(table.rows(), most, words);
  nlohmann::ordered_json json;
  json["total"] = table.rows();
  json["stride"] = choice.stride;
  json["t_s"] = secondsSince(origin_ns, table.stamp_ns, choice.rows);
  json["numbers"] = nlohmann::json::object();
  json["words"] = nlohmann::json::object();
  for (const auto& [name, values] : table.numbers) {
    if (!is_wanted || is_wanted(name)) json["numbers"][name] = shortNumbers(values, choice.rows);
  }
  for (const auto& [name, values] : table.words) {
    nlohmann::ordered_json& column = json["words"][name] = nlohmann::ordered_json::array();
    for (const size_t row : choice.rows) column.push_back(values[row]);
  }
  return json;
}

}  // namespace lodeline
