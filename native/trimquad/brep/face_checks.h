#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "trimquad/brep/checker.h"
#include "trimquad/mesh/region.h"
#include "trimquad/spline/spline_model.h"

namespace trimquad {

/// The fault of a face whose check does not end.
inline constexpr const char* kCheckDoesNotEnd = "the check does not end";

struct FaceFault {
  std::string what;          ///< a line of trimquad::faults(), of the face alone or together with `other`
  std::optional<int> other;  ///< index of the face that it crosses
  bool operator==(const FaceFault&) const = default;
};

/// Two CAD faces that meet where they have no common edge.
struct MeetingFaces {
  std::string first, second;  ///< names
  bool cross;                 ///< rather than touch, with an edge or a corner of one on the other
};

/// Checks a model that is trimmed again and again as OpenCASCADE does, face by face and pair by pair: such as
/// have not changed since an earlier time are not checked again. Crossings, of a face with itself and of
/// pairs, are looked for as the model's STEP file holds them: its numbers are rounded, and whether
/// OpenCASCADE's intersections end can hang on that.
class FaceChecks {
 public:
  /// \param checker the file of the program `trimquad_checker`
  explicit FaceChecks(std::string checker);

  /// What is wrong with each face of the model (see trimquad::faults()), in the model's order: alone, and
  /// with others, which counts for both. Of the faces that share an edge, those are checked together first
  /// where one is among `folded`, indices of faces that have folds, or both are of one region and bent
  /// against each other somewhere along the edge; where nothing is at fault so far, all of one body whose
  /// boxes overlap and that are not surely apart (FaceSeparation). A check that crashes or does not end
  /// within a limit, which usual ones stay far below, is a fault. What was done is added to the progress's
  /// work. On up to `threads` threads. Throws Error(Stage, "write") as assemble() does, Error(Input, "setup")
  /// where the program cannot be run, Error(Cancelled).
  std::vector<std::vector<FaceFault>> faults(const SplineModel& model, const std::vector<int>& folded,
                                             int threads, const Progress& progress);
  /// Those that come first, without the last and longest part: all pairs.
  std::vector<std::vector<FaceFault>> likelyFaults(const SplineModel& model, const std::vector<int>& folded,
                                                   int threads, const Progress& progress);

  /// Two CAD faces, one of each region, that cross each other as they are, or else touch: then surfaces that
  /// follow them do, or cross. None where no two of them do, or the model is one of a mesh. Throws
  /// Error(Input, "setup"), Error(Cancelled).
  std::optional<MeetingFaces> meetingCadFaces(const Model& model, int regionA, int regionB,
                                              const Progress& progress) const;

  /// What is wrong with the model as a whole, itself or as its STEP file holds it, but for faces that cross
  /// others.
  std::vector<std::string> faultsOfWhole(const SplineModel& model, const Progress& progress) const;

 private:
  std::vector<std::vector<FaceFault>> checked(const SplineModel& model, const std::vector<int>& folded,
                                              bool allPairs, int threads, const Progress& progress);

  Checker checker_;
  std::map<std::string, int> numbers_;  ///< of all that makes up a face, an edge or a vertex
  std::map<std::vector<int>, std::vector<std::string>> known_;  ///< by numbers of faces
};

}  // namespace trimquad
