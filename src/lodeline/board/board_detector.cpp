#include "lodeline/board/board_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "lodeline/board/corner_refinement.h"
#include "lodeline/board/tag_detector.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Errors (in edges of the tag) of the tags against one homography of the board. Tags may be printed turned:
/// corner k of the library is corner k + `turn` of the board.
std::vector<double> homographyErrors(const CalibrationBoard& board, const std::vector<FoundTag>& tags,
                                     int turn) {
  std::vector<cv::Point2d> on_board, in_image;
  for (const FoundTag& tag : tags) {
    for (int k = 0; k < 4; ++k) {
      const Vec3 corner_T = board.corner_T(4 * tag.id + (k + turn) % 4);
      on_board.emplace_back(corner_T.x() / board.tag_size_m, corner_T.y() / board.tag_size_m);
      in_image.emplace_back(tag.corners[k].x(), tag.corners[k].y());
    }
  }
  std::vector<double> errors(tags.size(), std::numeric_limits<double>::max());
  const cv::Mat homography = cv::findHomography(on_board, in_image, cv::LMEDS);
  if (homography.empty()) return errors;
  std::vector<cv::Point2d> mapped;
  cv::perspectiveTransform(on_board, mapped, homography);
  for (size_t i = 0; i < tags.size(); ++i) {
    double worst_px = 0.0;
    for (size_t k = 4 * i; k < 4 * i + 4; ++k)
      worst_px = std::max(worst_px, std::hypot(mapped[k].x - in_image[k].x, mapped[k].y - in_image[k].y));
    errors[i] = worst_px / tags[i].edge_px();
  }
  return errors;
}

/// Removes tags that do not fit the others, and returns how the tags are turned on the board.
int keepFittingTags(const CalibrationBoard& board, std::vector<FoundTag>* tags) {
  constexpr double kMostError = 0.5;  // edges; a wide lens bends the board
  int best_turn = 0;
  std::vector<double> best;
  for (int turn = 0; turn < 4; ++turn) {
    const std::vector<double> errors = homographyErrors(board, *tags, turn);
    if (best.empty() || median(errors) < median(best)) {
      best = errors;
      best_turn = turn;
    }
  }
  std::vector<FoundTag> kept;
  for (size_t i = 0; i < tags->size(); ++i) {
    if (best[i] < kMostError) kept.push_back((*tags)[i]);
  }
  *tags = std::move(kept);
  return best_turn;
}

}  // namespace

BoardDetector::BoardDetector(const CalibrationBoard& board)
    : board_(board), tags_(std::make_unique<TagDetector>()) {}
BoardDetector::~BoardDetector() = default;

namespace {

/// The tags of a second search that the first one missed. Their corners were drawn in by `inset_px`.
void addMissed(std::vector<FoundTag> more, double inset_px, std::vector<FoundTag>* tags) {
  const std::vector<FoundTag> before = *tags;
  for (FoundTag& tag : more) {
    if (std::any_of(before.begin(), before.end(), [&](const FoundTag& known) { return known.id == tag.id; }))
      continue;
    const Vec2 centre = 0.25 * (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]);
    for (Vec2& corner : tag.corners) corner += inset_px * std::sqrt(2.0) * (corner - centre).normalized();
    tags->push_back(tag);
  }
}

}  // namespace

std::vector<BoardCorner> BoardDetector::detect(const cv::Mat& image) const {
  std::vector<FoundTag> tags = tags_->find(image, board_.tagCount());
  if (static_cast<int>(tags.size()) < board_.tagCount()) {
    // In a blurred image, the squares at the crossings join the tags to one black area. Thinner black parts
    // them.
    cv::Mat thinned;
    cv::dilate(image, thinned, cv::getStructuringElement(cv::MORPH_CROSS, cv::Size(3, 3)));
    addMissed(tags_->find(thinned, board_.tagCount()), 1.0, &tags);
  }
  if (tags.size() < kLeastTags) return {};
  const int turn = keepFittingTags(board_, &tags);
  if (tags.size() < kLeastTags) return {};
  std::vector<BoardCorner> corners;
  for (const FoundTag& tag : tags) {
    const double gap_px = std::min(board_.spacing, tag.border_share) * tag.edge_px();
    for (int k = 0; k < 4; ++k) {
      const auto pixel = refinedCorner(image, tag.corners[k], gap_px);
      if (pixel) corners.push_back({4 * tag.id + (k + turn) % 4, *pixel});
    }
  }
  std::sort(corners.begin(), corners.end(),
            [](const BoardCorner& a, const BoardCorner& b) { return a.index < b.index; });
  const auto twice = [](const BoardCorner& a, const BoardCorner& b) { return a.index == b.index; };
  corners.erase(std::unique(corners.begin(), corners.end(), twice), corners.end());
  return corners;
}

}  // namespace lodeline
