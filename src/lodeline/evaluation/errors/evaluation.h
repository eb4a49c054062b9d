#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/evaluation/errors/alignment.h"
#include "lodeline/evaluation/errors/association.h"
#include "lodeline/evaluation/errors/claims.h"
#include "lodeline/evaluation/errors/completion.h"
#include "lodeline/evaluation/errors/pose_error.h"
#include "lodeline/evaluation/trajectory/trajectory.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct EvaluationOptions {
  AssociationOptions association;
  AlignmentType alignment = AlignmentType::SE3;
  /// Number of first pairs used for the alignment; 0 uses all.
  std::size_t alignment_pairs = 0;
  /// Lengths (m) of the overlapping sections; empty: 10, 20, 30, 40 and 50 % of the reference's path, rounded
  /// to two digits.
  std::vector<double> stretch_lengths_m;
  /// Length (m) of the consecutive sections.
  double consecutive_length_m = 10.0;
  /// Time stamps of the images that should have a pose; empty: completion is computed from time.
  std::vector<Time> expected_stamps;
};

/// Results of one evaluation. All positions are in the world of the reference, z up.
struct Evaluation {
  EvaluationOptions options;
  Trajectory estimate;   ///< as given, rotated to z up
  Trajectory reference;  ///< as given, rotated to z up

  PosePairs pairs;  ///< before alignment
  Alignment alignment;
  std::vector<Rigid3> aligned_estimate;      ///< one for each pair
  std::vector<double> reference_distance_m;  ///< path length from the first pair, one for each pair

  AbsoluteErrors absolute;
  std::vector<RelativeErrors> relative;  ///< overlapping sections, one entry per length
  RelativeErrors consecutive;            ///< consecutive sections; empty when the path is too short

  double reference_path_m = 0.0;  ///< along the pairs
  double estimate_path_m = 0.0;   ///< along the pairs, in the estimate's own scale
  double end_point_m = 0.0;       ///< position error of the last pair after `alignment`
  double drift_m = 0.0;           ///< position error of the last pair after alignment of the first pair

  Completion completion;
  ConsistencyCheck claims;  ///< no poses unless filled by checkConsistency()

  double percentOfPath(double length_m) const;
};

/// Compares an estimate with a reference. Remarks on the reliability of the results are added to
/// `diagnostics`. Throws InputError when the trajectories cannot be associated or aligned.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& reference, const EvaluationOptions& options,
                    Diagnostics& diagnostics);

}  // namespace lodeline
