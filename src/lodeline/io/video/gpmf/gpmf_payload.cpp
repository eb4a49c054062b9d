#include "lodeline/io/video/gpmf/gpmf_payload.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "lodeline/io/video/gpmf/klv_reader.h"

namespace lodeline::gpmf {
namespace {

/// Elements that describe the data. A stream whose last element is one of these has no data.
constexpr std::array<std::string_view, 22> kDescriptions = {
    "DVID", "DVNM", "STNM", "RMRK", "SCAL", "SIUN", "UNIT", "TYPE", "TSMP", "STMP", "TIMO",
    "EMPT", "TMPC", "TICK", "TOCK", "ORIN", "ORIO", "MTRX", "GPSF", "GPSP", "GPSU", "FWVS"};

bool isDescription(std::string_view key) {
  return std::find(kDescriptions.begin(), kDescriptions.end(), key) != kDescriptions.end();
}

std::vector<Element> elementsOf(std::span<const uint8_t> bytes, const std::string& where, Payload* payload) {
  std::vector<Element> elements;
  ElementReader reader(bytes);
  while (const std::optional<Element> element = reader.next()) elements.push_back(*element);
  if (!reader.problem().empty()) payload->problems.push_back(where + ": " + reader.problem());
  return elements;
}

/// The number of an element that has one; NaN otherwise.
double single(const Element& element) {
  const std::optional<std::vector<double>> numbers = numbersOf(element);
  return numbers && numbers->size() == 1 ? numbers->front() : std::nan("");
}

std::optional<int64_t> wholeNumber(const Element& element) {
  constexpr double kGreatest = 9.0e15;  // a double holds all whole numbers up to here
  const double number = single(element);
  if (!(std::abs(number) <= kGreatest)) return std::nullopt;
  return static_cast<int64_t>(number);
}

std::optional<Mat3> matrixOf(const Element& element) {
  const std::optional<std::vector<double>> numbers = numbersOf(element);
  if (!numbers || numbers->size() != 9) return std::nullopt;
  Mat3 matrix;
  for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = (*numbers)[static_cast<size_t>(i)];
  return matrix;
}

/// The first of the units, which are texts of equal length. Samples of one byte are the letters of one text,
/// or equal letters, one for each number.
std::string firstUnit(Element element) {
  const auto is_first = [&](uint8_t letter) { return letter == element.bytes.front(); };
  const bool is_one_text =
      element.size == 1 && !std::all_of(element.bytes.begin(), element.bytes.end(), is_first);
  if (element.repeats > 1 && !is_one_text) element.bytes = element.bytes.first(element.size);
  return textOf(element);
}

/// Parses one stream, element by element.
class StreamParser {
 public:
  StreamParser(Stream described, Payload* payload) : stream_(std::move(described)), payload_(payload) {}

  void parse(std::span<const uint8_t> bytes) {
    const std::vector<Element> elements = elementsOf(bytes, "STRM", payload_);
    if (elements.empty() || isDescription(elements.back().key)) return;
    stream_.key = elements.back().key;
    bool is_usable = true;
    for (const Element& element : elements) {
      if (element.key != stream_.key) {
        describe(element);
      } else if (is_usable && !element.isNested()) {
        is_usable = add(element);
      }
    }
    if (stream_.samples == 0) return;
    if (is_usable) payload_->streams.push_back(std::move(stream_));
  }

 private:
  void describe(const Element& element) {
    if (element.key == "STNM") stream_.name = textOf(element);
    if (element.key == "SIUN") stream_.unit = firstUnit(element);
    if (element.key == "UNIT" && stream_.unit.empty()) stream_.unit = firstUnit(element);
    if (element.key == "TYPE") types_ = expandedTypes(textOf(element));
    if (element.key == "SCAL") divisors_ = numbersOf(element).value_or(std::vector<double>{});
    if (element.key == "ORIN") stream_.stored_axes = textOf(element);
    if (element.key == "ORIO") stream_.output_axes = textOf(element);
    if (element.key == "MTRX") stream_.matrix = matrixOf(element);
    if (element.key == "STMP") stream_.stamp_us = wholeNumber(element);
    if (element.key == "TICK") stream_.tick_ms = wholeNumber(element);
    if (element.key == "TIMO" && std::isfinite(single(element))) stream_.delay_s = single(element);
    if (element.key != "TSMP") return;
    const std::optional<int64_t> total = wholeNumber(element);
    if (total && *total >= 0) stream_.total_samples = static_cast<uint64_t>(*total);
  }

  bool add(const Element& element) {
    if (element.repeats == 0) return true;
    std::optional<std::vector<double>> numbers = numbersOf(element, types_);
    const auto leaveOut = [&](const std::string& problem) {
      payload_->problems.push_back(fmt::format("{}: {}", stream_.key, problem));
      return false;
    };
    if (!numbers) {
      return leaveOut(fmt::format(
          "type '{}' does not fit samples of {} bytes",
          std::isprint(static_cast<unsigned char>(element.type)) != 0 ? element.type : '.', element.size));
    }
    const size_t axes = numbers->size() / element.repeats;
    if (stream_.axes != 0 && stream_.axes != axes) return leaveOut("samples of different sizes");
    stream_.axes = axes;
    const bool has_zero = std::any_of(divisors_.begin(), divisors_.end(),
                                      [](double divisor) { return !(std::abs(divisor) > 0.0); });
    const bool fits = divisors_.empty() || divisors_.size() == 1 || divisors_.size() == axes;
    if (has_zero || !fits)
      return leaveOut("its scale (SCAL) has a zero, or as many numbers as no sample has");
    for (size_t i = 0; i < numbers->size() && !divisors_.empty(); ++i) {
      (*numbers)[i] /= divisors_[divisors_.size() == 1 ? 0 : i % axes];
    }
    stream_.samples += element.repeats;
    stream_.values.insert(stream_.values.end(), numbers->begin(), numbers->end());
    return true;
  }

  Stream stream_;
  Payload* payload_;
  std::string types_;
  std::vector<double> divisors_;
};

void parseDevice(std::span<const uint8_t> bytes, Payload* payload) {
  Stream device;
  for (const Element& element : elementsOf(bytes, "DEVC", payload)) {
    if (element.key == "DVID") device.device = single(element);
    if (element.key == "DVNM") device.device_name = textOf(element);
    if (element.key == "STRM" && element.isNested()) StreamParser(device, payload).parse(element.bytes);
  }
}

}  // namespace

Payload parsePayload(std::span<const uint8_t> bytes) {
  Payload payload;
  for (const Element& element : elementsOf(bytes, "payload", &payload)) {
    if (element.key == "DEVC" && element.isNested()) parseDevice(element.bytes, &payload);
  }
  return payload;
}

}  // namespace lodeline::gpmf
