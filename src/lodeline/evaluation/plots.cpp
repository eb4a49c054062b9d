#include "lodeline/evaluation/plots.h"
namespace lodeline {
void writePlots(const Evaluation&, const std::filesystem::path&, Diagnostics& diagnostics) {
  diagnostics.report(Severity::Warning, "no_plots", "plots are not available in this build");
}
}  // namespace lodeline
