#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

double cross(const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Floor plan between two stations as a ring, counter-clockwise as RFC 7946 requires; empty where the widths
/// are unknown or the corners do not form a convex outline (sharp bends).
std::vector<Vec3> planBetween(const SurveyStation& a, const SurveyStation& b) {
  if (!a.passage.left || !a.passage.right || !b.passage.left || !b.passage.right) return {};
  const Vec3 along = b.position_ENU - a.position_ENU;
  const Vec3 across = Vec3::UnitZ().cross(along);
  if (across.norm() < 1e-3) return {};
  const Vec3 left = across.normalized();
  const std::vector<Vec3> ring = {
      a.position_ENU - *a.passage.right * left, b.position_ENU - *b.passage.right * left,
      b.position_ENU + *b.passage.left * left, a.position_ENU + *a.passage.left * left};
  for (size_t i = 0; i < 4; ++i) {
    if (cross(ring[(i + 1) % 4] - ring[i], ring[(i + 2) % 4] - ring[(i + 1) % 4]) <= 0.0) return {};
  }
  return ring;
}

}  // namespace

std::vector<std::vector<Vec3>> passagePlan(const Survey& survey) {
  std::vector<std::vector<Vec3>> rings;
  for (size_t i = 1; i < survey.stations.size(); ++i) {
    std::vector<Vec3> ring = planBetween(survey.stations[i - 1], survey.stations[i]);
    if (!ring.empty()) rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace lodeline
