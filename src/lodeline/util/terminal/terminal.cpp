#include "lodeline/util/terminal/terminal.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace lodeline::terminal {
namespace {

/// Whether a byte of UTF-8 text begins a character.
bool beginsCharacter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }

size_t columnsOf(std::string_view text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), beginsCharacter));
}

int codeOf(Colour colour) {
  switch (colour) {
    case Colour::Red:
      return 31;
    case Colour::Yellow:
      return 33;
    case Colour::Cyan:
      return 36;
    case Colour::Bold:
      return 1;
    case Colour::Faint:
      return 2;
  }
  return 0;
}

}  // namespace

std::optional<size_t> width(std::FILE* stream) {
  const int file = fileno(stream);
  if (isatty(file) == 0) return std::nullopt;
  constexpr size_t kUsualColumns = 80;
  winsize size = {};
  const bool is_known = ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? size.ws_col : kUsualColumns;
}

bool hasColours(std::FILE* stream) {
  const char* const no_colour = std::getenv("NO_COLOR");
  const char* const type = std::getenv("TERM");
  if (no_colour != nullptr && *no_colour != '\0') return false;
  return isatty(fileno(stream)) != 0 && type != nullptr && std::string_view(type) != "dumb";
}

std::string coloured(std::string_view text, Colour colour, bool in_colour) {
  return in_colour ? fmt::format("\033[{}m{}\033[0m", codeOf(colour), text) : std::string(text);
}

std::string wrapped(std::string_view text, size_t width, size_t first_column, size_t indent) {
  std::string result;
  size_t column = first_column;
  bool at_start = true;  // of a line
  const auto breakLine = [&](size_t spaces) {
    result += '\n' + std::string(spaces, ' ');
    column = spaces;
    at_start = true;
  };
  for (size_t begin = 0; begin < text.size();) {
    if (text[begin] == '\n') {
      breakLine(indent);
      ++begin;
      continue;
    }
    const size_t spaces = std::min(text.find_first_not_of(' ', begin), text.size()) - begin;
    const size_t end = std::min(text.find_first_of(" \n", begin + spaces), text.size());
    const std::string_view word = text.substr(begin + spaces, end - begin - spaces);
    if (!word.empty() && !at_start && column + spaces + columnsOf(word) > width) {
      breakLine(indent);
    } else {
      result.append(spaces, ' ');
      column += spaces;
    }
    result += word;
    column += columnsOf(word);
    at_start = at_start && word.empty();
    begin = end;
  }
  return result;
}

std::string cut(std::string_view text, size_t columns) {
  size_t end = 0;
  for (size_t seen = 0; end < text.size(); ++end) {
    if (beginsCharacter(text[end]) && seen++ == columns) break;
  }
  return std::string(text.substr(0, end));
}

}  // namespace lodeline::terminal
