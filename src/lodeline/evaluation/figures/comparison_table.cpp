#include <fmt/format.h>

#include <algorithm>

#include "lodeline/evaluation/figures/comparison_report.h"

namespace lodeline {
namespace {

constexpr double kComplete = 0.9995;

/// Remarks on runs that failed, missed images, or know less about north than the others of their method.
std::vector<std::string> remarks(const ComparedRecording& recording) {
  std::vector<std::string> lines;
  for (const ComparedMethod& method : recording.methods) {
    const bool some_north = std::any_of(method.runs.begin(), method.runs.end(), [](const ComparedRun& run) {
      return run.errors && run.errors->basis == HeadingBasis::North;
    });
    for (const ComparedRun& run : method.runs) {
      const std::string name = fmt::format("{}, {}", method.name, run.seed);
      if (!run.errors) {
        lines.push_back(fmt::format("{}: failed: {}", name, run.failure));
      } else if (run.completion < kComplete) {
        lines.push_back(fmt::format("{}: {:.1f} % of the images have a pose; errors are of these alone", name,
                                    100.0 * run.completion));
      }
      if (some_north && run.errors && run.errors->basis == HeadingBasis::Start) {
        lines.push_back(fmt::format("{}: found no north; its heading is judged from equal starts", name));
      }
    }
  }
  return lines;
}

std::string ratio(double value, double baseline) {
  return baseline > 0.0 ? fmt::format("x{:.2f}", value / baseline) : "-";
}

std::string textRow(const std::string& name, const MethodMeans& m, const MethodMeans& baseline) {
  std::string row = fmt::format("{:<10} {:>5} {:>7.1f}", name, fmt::format("{}/{}", m.runs, m.total_runs),
                                100.0 * m.completion);
  if (m.runs == 0) return row + "   no trajectory\n";
  row += fmt::format(" {:>8.2f} {:>6} {:>9.3f} {:>6} {:>7.4f}", m.sim3.rotation_deg,
                     ratio(m.sim3.rotation_deg, baseline.sim3.rotation_deg), m.sim3.position_m,
                     ratio(m.sim3.position_m, baseline.sim3.position_m), m.scale);
  row += fmt::format(" {:>8.2f} {:>9.3f} {:>7.2f}", m.yaw.rotation_deg, m.yaw.position_m,
                     m.end_point_equal_start_percent);
  row += fmt::format(" {:>8.2f} {:<5} {:>7.2f}", m.heading_rmse_deg, toString(m.basis), m.end_point_percent);
  row += fmt::format(" {:>8.2f} {:>8.2f}", m.relative_yaw_deg, m.relative_yaw_growth_deg);
  return row + (m.core_ms_per_frame > 0.0 ? fmt::format(" {:>7.1f}\n", m.core_ms_per_frame) : "       -\n");
}

const char* const kTextHeader =
    "                           ATE, sim(3) aligned                     ATE, yaw aligned    end  "
    "against the world      relative yaw       cost\n"
    "method      runs  images      deg           m         scale      deg         m       %"
    "      deg from        %      deg  deg/100m core-ms\n";

/// Rotation and position error with their ratios to the baseline's, and the scale: the rest of a Markdown
/// row.
std::string markdownRow(const std::string& name, const MethodMeans& m, const MethodMeans& baseline) {
  const std::string runs =
      fmt::format("| `{}` | {}/{} | {:.1f} % |", name, m.runs, m.total_runs, 100.0 * m.completion);
  if (m.runs == 0) return runs + " no trajectory | | | | | | | |\n";
  return runs +
         fmt::format(" {:.2f}° ({}) | {:.3f} m ({}) | {:.4f} |", m.sim3.rotation_deg,
                     ratio(m.sim3.rotation_deg, baseline.sim3.rotation_deg), m.sim3.position_m,
                     ratio(m.sim3.position_m, baseline.sim3.position_m), m.scale) +
         fmt::format(" {:.2f}° / {:.3f} m | {:.2f} % | {:.2f}° ({}) | {:.2f}°, {:+.2f}° |",
                     m.yaw.rotation_deg, m.yaw.position_m, m.end_point_equal_start_percent,
                     m.heading_rmse_deg, toString(m.basis), m.relative_yaw_deg, m.relative_yaw_growth_deg) +
         (m.core_ms_per_frame > 0.0 ? fmt::format(" {:.1f} |\n", m.core_ms_per_frame) : " – |\n");
}

MethodMeans baselineMeans(const ComparedRecording& recording) {
  const ComparedMethod* baseline = baselineOf(recording);
  return baseline ? meansOf(*baseline) : MethodMeans{};
}

}  // namespace

std::string comparisonTable(const ComparedRecording& recording) {
  const MethodMeans baseline = baselineMeans(recording);
  std::string text = fmt::format("{}: {}\n{}", recording.name, recording.extent, kTextHeader);
  for (const ComparedMethod& method : recording.methods) {
    text += textRow(method.name, meansOf(method), baseline);
  }
  for (const std::string& line : remarks(recording)) text += "  " + line + "\n";
  return text;
}

std::string comparisonMarkdown(const ComparedRecording& recording) {
  const MethodMeans baseline = baselineMeans(recording);
  std::string text = fmt::format("### {}\n\n{}\n\n", recording.name, recording.extent);
  text +=
      "| method | runs | images with a pose | rotation, sim(3) | position, sim(3) | scale | after yaw "
      "alignment "
      "| end point | heading against the world (from) | relative yaw, growth per 100 m | core-ms a frame |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const ComparedMethod& method : recording.methods) {
    text += markdownRow(method.name, meansOf(method), baseline);
  }
  const std::vector<std::string> lines = remarks(recording);
  if (!lines.empty()) text += "\n";
  for (const std::string& line : lines) text += "- " + line + "\n";
  return text;
}

}  // namespace lodeline
