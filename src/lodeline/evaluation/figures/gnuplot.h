#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lodeline::gnuplot {

/// One figure as a gnuplot script, independent of the file type.
struct Figure {
  std::string name;     ///< file name without ending
  int width_px = 1200;  ///< of the PNG; the SVG has the same shape
  int height_px = 900;
  std::string commands;  ///< data blocks, settings and plot commands; no terminal, no output
};

/// Points to be joined by a line; a break interrupts the line.
struct Curve {
  struct Point {
    double x = 0.0;
    double y = 0.0;
    bool break_before = false;
    std::optional<double> value = std::nullopt;  ///< third column, for a colour
  };
  std::vector<Point> points;
};

/// `$name << EOD ... EOD`, reduced to a few thousand points so that figures of long recordings stay small.
std::string dataBlock(const std::string& name, const Curve& curve);

/// `$name << EOD ... EOD` with any number of columns.
std::string dataBlock(const std::string& name, const std::vector<std::vector<double>>& rows);

enum class Outcome { Drawn, Missing, Failed };

struct Result {
  Outcome outcome = Outcome::Drawn;
  std::string message;  ///< message of gnuplot
};

/// Draws every figure into `folder` as NAME.svg and NAME.png.
Result draw(const std::vector<Figure>& figures, const std::filesystem::path& folder);

}  // namespace lodeline::gnuplot
