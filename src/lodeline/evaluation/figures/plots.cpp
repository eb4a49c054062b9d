#include "lodeline/evaluation/figures/plots.h"

#include <fmt/format.h>
#include <unistd.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/plot_figures.h"

namespace lodeline {

const char* alignmentTitle(AlignmentType type) {
  switch (type) {
    case AlignmentType::None:
      return "no";
    case AlignmentType::Yaw:
      return "position and yaw";
    case AlignmentType::SE3:
      return "SE(3)";
    case AlignmentType::Sim3:
      return "sim(3)";
  }
  return "";
}

void drawFigures(const std::vector<gnuplot::Figure>& figures, const std::filesystem::path& folder,
                 Diagnostics& diagnostics) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error) || access(folder.c_str(), W_OK) != 0) {
    throw InputError(
        fmt::format("{}: plots cannot be written there; it is no writable folder", folder.string()));
  }
  const gnuplot::Result result = gnuplot::draw(figures, folder);
  if (result.outcome == gnuplot::Outcome::Missing) {
    diagnostics.report(Severity::Warning, "gnuplot_missing",
                       "no plots: the program gnuplot is not installed (Debian package gnuplot-nox)");
  } else if (result.outcome == gnuplot::Outcome::Failed) {
    diagnostics.report(Severity::Warning, "gnuplot_failed", "no plots: gnuplot failed: " + result.message);
  }
}

void writePlots(const Evaluation& evaluation, const std::filesystem::path& folder, Diagnostics& diagnostics) {
  std::vector<gnuplot::Figure> figures = {topViewFigure(evaluation), sideViewFigure(evaluation),
                                          errorOverTimeFigure(evaluation)};
  if (!evaluation.relative.empty()) figures.push_back(relativeErrorFigure(evaluation));
  drawFigures(figures, folder, diagnostics);
}

}  // namespace lodeline
