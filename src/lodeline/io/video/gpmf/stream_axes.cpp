#include "lodeline/io/video/gpmf/stream_axes.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace lodeline::gpmf {
namespace {

/// Order of the output where a stream does not state it (ORIO of all cameras that do).
constexpr const char* kOutputOrder = "ZXY";
/// A matrix within this of the letters may be their calibrated form; beyond, the two contradict each other.
constexpr double kGreatestCalibration = 0.1;

/// Order of the numbers by model, from the tables of gopro/gpmf-parser. Later models state it by ORIN.
struct ModelOrder {
  std::string_view model;  ///< lower case
  const char* letters;
};
constexpr std::array kModels = {ModelOrder{"hero5", "ZXY"}, ModelOrder{"fusion", "yXZ"},
                                ModelOrder{"hero6", "YxZ"}, ModelOrder{"hero7", "YxZ"},
                                ModelOrder{"max", "YxZ"}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Letters in the name of a stream: "Gyroscope (z,x,y)", "Accelerometer (up/down, right/left, forward/back)".
std::string lettersInName(const std::string& name) {
  const std::string text = lower(name);
  const size_t open = text.find('('), close = text.find(')', open == std::string::npos ? 0 : open);
  if (open == std::string::npos || close == std::string::npos) return {};
  const std::string inside = text.substr(open + 1, close - open - 1);
  if (inside == "up/down, right/left, forward/back") return "ZXY";
  std::string letters;
  for (const char c : inside) {
    if (c == ',' || c == ' ') continue;
    if (c < 'x' || c > 'z') return {};
    letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return letters;
}

std::optional<Mat3> fromMatrix(const Stream& stream) {
  if (!stream.matrix) return std::nullopt;
  const std::optional<Mat3> body_from_output =
      fromLetters(stream.output_axes.empty() ? kOutputOrder : stream.output_axes);
  if (!body_from_output) return std::nullopt;
  const Mat3 body_from_stored = *body_from_output * *stream.matrix;
  const double skew =
      (body_from_stored.transpose() * body_from_stored - Mat3::Identity()).cwiseAbs().maxCoeff();
  const bool is_rotation = skew < 2.0 * kGreatestCalibration && body_from_stored.determinant() > 0.0;
  return is_rotation ? std::optional(body_from_stored) : std::nullopt;
}

}  // namespace

std::optional<Mat3> fromLetters(const std::string& letters) {
  if (letters.size() != 3) return std::nullopt;
  Mat3 body_from_stored = Mat3::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto letter = static_cast<unsigned char>(letters[static_cast<size_t>(i)]);
    const int axis = std::tolower(letter) - 'x';
    if (axis < 0 || axis > 2) return std::nullopt;
    body_from_stored(axis, i) = std::isupper(letter) != 0 ? 1.0 : -1.0;
  }
  if (body_from_stored.determinant() < 0.5) return std::nullopt;
  return body_from_stored;
}

StreamAxes axesOf(const Stream& stream) {
  const std::optional<Mat3> stated = fromLetters(stream.stored_axes);
  const std::optional<Mat3> matrix = fromMatrix(stream);
  StreamAxes axes;
  axes.is_known = true;
  if (!stream.stored_axes.empty() && !stated) {
    axes.problem = fmt::format("ORIN '{}' is no right-handed order of axes", stream.stored_axes);
  } else if (stream.matrix && !matrix) {
    axes.problem = "MTRX is no rotation";
  } else if (stated && matrix && (*stated - *matrix).cwiseAbs().maxCoeff() > kGreatestCalibration) {
    axes.problem = fmt::format("MTRX contradicts ORIN '{}', which is used", stream.stored_axes);
  }
  if (stated) {
    const bool agrees = matrix && axes.problem.empty();
    axes.body_from_stored = agrees ? *matrix : *stated;
    axes.source = fmt::format("ORIN {}", stream.stored_axes);
    return axes;
  }
  if (matrix) {
    axes.body_from_stored = *matrix;
    axes.source = "MTRX";
    return axes;
  }
  if (const std::optional<Mat3> named = fromLetters(lettersInName(stream.name))) {
    axes.body_from_stored = *named;
    axes.source = fmt::format("its name '{}'", stream.name);
    return axes;
  }
  const std::string model = lower(stream.device_name);
  const auto known = std::find_if(kModels.begin(), kModels.end(), [&](const ModelOrder& order) {
    return model.find(order.model) != std::string::npos;
  });
  axes.is_known = known != kModels.end();
  axes.body_from_stored = *fromLetters(axes.is_known ? known->letters : kOutputOrder);
  axes.source = axes.is_known ? fmt::format("the model {}", stream.device_name) : "assumption Z, X, Y";
  return axes;
}

}  // namespace lodeline::gpmf
