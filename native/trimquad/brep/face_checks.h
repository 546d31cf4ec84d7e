#pragma once

#include <map>
#include <string>
#include <vector>

#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// Checks the faces of a model that is trimmed again and again: such as have not changed since the last time
/// are not checked again.
class FaceChecks {
 public:
  /// What is wrong with each face of the model alone (see faults()), in the model's order. Also of two that
  /// share an edge together, which counts for both: where one of them is among `folded`, indices of faces
  /// that have folds, or both are of one region and bent against each other somewhere along the edge. On up
  /// to `threads` threads. Throws Error(Stage, "write") as assemble() does.
  std::vector<std::vector<std::string>> faults(const SplineModel& model, const std::vector<int>& folded,
                                               int threads);

 private:
  std::map<std::string, std::vector<std::string>> known_;  ///< by all that makes up the faces
};

}  // namespace trimquad
