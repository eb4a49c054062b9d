#include "lodeline/output/survey/grid/angle_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

namespace lodeline {
namespace {

enum class Kind { Number, Mark, Word, Comma, Bad };

struct Token {
  Kind kind = Kind::Bad;
  double number = 0.0;
  bool is_signed = false, has_fraction = false;
  bool is_attached = false;  ///< no blank before it
  std::string text;          ///< of a word; of a mark "d", "m" or "s"
};

/// Symbols of other alphabets as ASCII.
std::string plainSymbols(std::string text) {
  static const std::vector<std::pair<std::string, std::string>> kSymbols = {
      {"°", "*"},  {"º", "*"},  {"˚", "*"},  {"′", "'"}, {"’", "'"},  {"‘", "'"},
      {"″", "\""}, {"”", "\""}, {"“", "\""}, {"−", "-"}, {"''", "\""}};
  for (const auto& [symbol, ascii] : kSymbols) {
    for (size_t at = text.find(symbol); at != std::string::npos; at = text.find(symbol, at + ascii.size()))
      text.replace(at, symbol.size(), ascii);
  }
  return text;
}

Token numberAt(const std::string& text, size_t* at) {
  Token token;
  size_t end = *at;
  if (text[end] == '-' || text[end] == '+') ++end;
  while (end < text.size() && (std::isdigit(static_cast<unsigned char>(text[end])) || text[end] == '.'))
    ++end;
  const std::string digits = text.substr(*at, end - *at);
  char* rest = nullptr;
  token.number = std::strtod(digits.c_str(), &rest);
  token.kind = rest != nullptr && *rest == '\0' && rest != digits.c_str() ? Kind::Number : Kind::Bad;
  token.is_signed = text[*at] == '-' || text[*at] == '+';
  token.has_fraction = digits.find('.') != std::string::npos;
  *at = end;
  return token;
}

std::vector<Token> tokensOf(const std::string& text) {
  std::vector<Token> tokens;
  bool is_attached = false;
  for (size_t at = 0; at < text.size();) {
    const auto c = static_cast<unsigned char>(text[at]);
    Token token;
    if (std::isspace(c)) {
      is_attached = false;
      ++at;
      continue;
    }
    if (std::isdigit(c) || c == '.' || c == '-' || c == '+') {
      token = numberAt(text, &at);
    } else if (std::isalpha(c)) {
      size_t end = at;
      while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end]))) ++end;
      // "12sN": the mark of the seconds, then the letter.
      if (is_attached && end == at + 2 && std::string("dms").find(text[at]) != std::string::npos &&
          std::string("NSEW").find(text[at + 1]) != std::string::npos)
        --end;
      token.kind = Kind::Word;
      token.text = text.substr(at, end - at);
      at = end;
    } else {
      const size_t mark = std::string("*'\":").find(static_cast<char>(c));
      token.kind = c == ',' || c == ';' ? Kind::Comma : mark != std::string::npos ? Kind::Mark : Kind::Bad;
      token.text = std::string(1, static_cast<char>(c));
      ++at;
    }
    token.is_attached = is_attached;
    is_attached = true;
    tokens.push_back(token);
  }
  return tokens;
}

/// Degrees, minutes, seconds, as far as they are given.
struct Angle {
  std::vector<double> parts;
  bool is_negative = false, is_signed = false, has_fraction = false, is_marked = false;
  char letter = 0;  ///< N, S, E, W

  bool isOfLatitude() const { return letter == 'N' || letter == 'S'; }
  std::optional<double> degrees() const {
    double value = 0.0, share = 1.0;
    for (size_t i = 0; i < parts.size(); ++i, share /= 60.0) {
      if (i > 0 && !(parts[i] >= 0.0 && parts[i] < 60.0)) return std::nullopt;
      value += share * std::abs(parts[i]);
    }
    if (letter != 0 && is_signed) return std::nullopt;
    return is_negative || letter == 'S' || letter == 'W' ? -value : value;
  }
};

/// Collects two angles and a height from tokens.
class Reader {
 public:
  bool read(const std::vector<Token>& tokens) {
    for (size_t i = 0; i < tokens.size(); ++i) {
      if (!take(tokens[i], i + 1 < tokens.size() ? tokens[i + 1] : Token())) return false;
    }
    finish();
    return angles_.size() == 2 && current_.parts.empty() && current_.letter == 0;
  }

  std::optional<AnglePair> result() const {
    Angle first = angles_[0], second = angles_[1];
    const bool is_swapped = second.isOfLatitude() || (first.letter != 0 && !first.isOfLatitude());
    if (is_swapped) std::swap(first, second);
    if (first.letter != 0 && !first.isOfLatitude()) return std::nullopt;
    if (second.isOfLatitude()) return std::nullopt;
    // Blanks alone do not tell where an angle ends.
    const auto isClear = [](const Angle& a) { return a.letter != 0 || a.is_marked || a.parts.size() == 1; };
    const auto latitude = first.degrees(), longitude = second.degrees();
    if (!latitude || !longitude || !isClear(first) || !isClear(second)) return std::nullopt;
    return AnglePair{*latitude, *longitude, height_m_};
  }

 private:
  bool take(const Token& token, const Token& next) {
    switch (token.kind) {
      case Kind::Bad:
        return false;
      case Kind::Comma:
        finish();
        return true;
      case Kind::Number:
        return takeNumber(token, next);
      case Kind::Mark:
        return takeMark(token.text);
      case Kind::Word:
        return takeWord(token);
    }
    return false;
  }

  bool takeNumber(const Token& token, const Token& next) {
    const bool begins = token.is_signed || current_.has_fraction || current_.parts.size() == 3 ||
                        (next.kind == Kind::Mark && next.text == "*");
    if (begins && !current_.parts.empty()) finish();
    if (angles_.size() == 2) {
      if (height_m_) return false;
      height_m_ = token.number;
      return true;
    }
    if (current_.parts.empty()) {
      current_.is_signed = token.is_signed;
      current_.is_negative = token.is_signed && std::signbit(token.number);
    }
    current_.parts.push_back(token.number);
    current_.has_fraction = token.has_fraction;
    return true;
  }

  bool takeMark(const std::string& mark) {
    const size_t count = current_.parts.size();
    const size_t wanted = mark == "*" || mark == "d" ? 1 : mark == "'" || mark == "m" ? 2 : 3;
    current_.is_marked = true;
    if (mark == ":") return count == 1 || count == 2;
    return count == wanted;
  }

  bool takeWord(const Token& token) {
    if (angles_.size() == 2) return takeUnit(token.text);
    const size_t count = current_.parts.size();
    if (token.is_attached && token.text == "d") return takeMark("d");
    if (token.is_attached && token.text == "m" && count == 2) return takeMark("m");
    if (token.is_attached && token.text == "s" && count == 3) return takeMark("s");
    if ((token.text == "m" || token.text == "ft") && angles_.size() == 1 && count >= 2) {
      // "W87 23 5 m": the last number was the height.
      const double height = current_.parts.back();
      current_.parts.pop_back();
      finish();
      height_m_ = height;
      return takeUnit(token.text);
    }
    return takeLetter(token.text);
  }

  bool takeUnit(const std::string& unit) {
    if (!height_m_ || has_unit_) return false;
    has_unit_ = true;
    if (unit == "ft" || unit == "feet") *height_m_ *= kMetresPerFoot;
    return unit == "m" || unit == "ft" || unit == "feet";
  }

  bool takeLetter(const std::string& word) {
    std::string upper = word;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    for (const char* name : {"NORTH", "SOUTH", "EAST", "WEST"}) {
      if (upper == name) upper.resize(1);
    }
    if (upper.size() != 1 || std::string("NSEW").find(upper) == std::string::npos) return false;
    if (!current_.parts.empty() && current_.letter != 0) finish();
    const bool is_after = !current_.parts.empty();
    if (current_.letter != 0) return false;
    current_.letter = upper.front();
    if (is_after) finish();
    return true;
  }

  void finish() {
    if (current_.parts.empty()) return;
    angles_.push_back(current_);
    current_ = {};
  }

  std::vector<Angle> angles_;
  Angle current_;
  std::optional<double> height_m_;
  bool has_unit_ = false;
};

}  // namespace

std::optional<AnglePair> parseAngles(const std::string& text) {
  Reader reader;
  if (!reader.read(tokensOf(plainSymbols(text)))) return std::nullopt;
  return reader.result();
}

}  // namespace lodeline
