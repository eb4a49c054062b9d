#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

namespace lodeline::terminal {

/// Columns of the terminal that `stream` writes to; nothing where it writes to a file or a pipe.
std::optional<size_t> width(std::FILE* stream);

enum class Colour { Red, Yellow, Cyan, Bold, Faint };

/// Whether `stream` shows colours: it is a terminal that is not "dumb", and NO_COLOR is not set
/// (https://no-color.org).
bool hasColours(std::FILE* stream);

/// `text` in a colour, as an ANSI escape sequence; `text` itself where `in_colour` is false.
std::string coloured(std::string_view text, Colour colour, bool in_colour);

/// `text` broken into lines of at most `width` columns at its spaces, each line after the first with `indent`
/// spaces before it. `first_column` columns of the first line are taken. A longer word has its own line. The
/// line breaks of `text` stay.
std::string wrapped(std::string_view text, size_t width, size_t first_column, size_t indent);

/// The first `columns` characters of a UTF-8 text.
std::string cut(std::string_view text, size_t columns);

}  // namespace lodeline::terminal
