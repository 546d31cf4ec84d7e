#pragma once

#include <vector>

#include "trimquad/spline/boundary_runs.h"

namespace trimquad {

/// The model's curves cut where charts meet on them.
class CurvePieces {
 public:
  CurvePieces(const Model& model, std::vector<CurveSplit> splits);

  const ModelCurve& operator[](int piece) const { return pieces_[piece]; }
  int model(int piece) const { return modelCurve_[piece]; }  ///< index of the curve that it is a part of
  /// Whether it is a chain of mesh edges, whose corners say nothing about the shape.
  bool isPolyline(int piece) const { return isPolyline_[modelCurve_[piece]]; }
  /// The piece that a run, cut at all splits, lies on.
  int pieceOf(const BoundaryRun& run) const;

 private:
  std::vector<ModelCurve> pieces_;
  std::vector<int> modelCurve_, first_;  ///< first_: by model curve
  std::vector<bool> isPolyline_;         ///< by model curve
};

}  // namespace trimquad
