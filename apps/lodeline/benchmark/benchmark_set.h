#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/trajectory.h"

namespace lodeline {

/// One place where the ground truth of a sequence may be. Patterns are explained at SetLayout.
struct SetTruth {
  std::string file;           ///< pattern of a trajectory; empty where it is in the bag
  std::string topic;          ///< of poses in the bag; empty where it is in a file
  bool is_of_camera = false;  ///< poses of the first camera instead of the IMU
  /// Pattern of the list of images whose numbers the truth has in place of times; empty for times.
  std::string frame_numbers;
};

/// Describes one layout of the files of a sequence. All names are patterns of paths. {word} in a pattern
/// is replaced by a word of the sequence. A pattern may begin in any folder of the set.
struct SetLayout {
  std::vector<std::string> data;              ///< folder with mav0 or bag; none where it is made of links
  std::map<std::string, std::string> links;   ///< names in a folder with mav0 that is made, and their targets
  std::vector<std::string> rig;               ///< calibration files
  std::string rig_text;                       ///< a further calibration file, which the set does not have
  std::map<std::string, std::string> topics;  ///< by sensor
  std::vector<SetTruth> truth;                ///< the first that exists is used
};

struct SetSequence {
  std::string name;
  std::map<std::string, std::string> words;   ///< for patterns; `name` is one
  std::map<std::string, double> published_m;  ///< position RMSE by method
};

/// A method whose figures are given, and where they were published.
struct PublishedMethod {
  std::string name, source;
};

/// A public set of recordings.
struct BenchmarkSet {
  std::string title, about;
  AlignmentType alignment = AlignmentType::SE3;
  std::optional<double> tolerance_s;  ///< between poses of estimate and truth
  std::vector<SetLayout> layouts;
  std::vector<PublishedMethod> published;  ///< in the order of the columns
  std::vector<std::string> remarks;
  std::vector<SetSequence> sequences;
};

/// Names of the sets.
std::vector<std::string> benchmarkSetNames();

/// A set by its name. Throws UsageError for another name.
BenchmarkSet benchmarkSet(const std::string& name);

}  // namespace lodeline
