#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/mesh/region.h"

namespace trimquad {

/// A region of a CAD model cut along smooth edges inside it.
struct RegionParts {
  /// The parts with the curves and corners that they end in; names and shells mean nothing.
  Model model;
  std::vector<std::vector<double>> division;  ///< by curve
  std::vector<int> cadEdge;                   ///< by curve
  std::vector<int> cadVertex;                 ///< by corner
  std::vector<std::vector<int>> triangles;    ///< by part, of the welded mesh
  std::vector<int> cut;                       ///< the CAD edges, ascending
  std::vector<std::string> edges;             ///< their names
};

/// Where a region is cut.
struct CutPlace {
  bool creases = false;  ///< along edges where it bends sharply (FeatureEdges::crease) only
  std::optional<Eigen::Vector3d> point = {};  ///< around the CAD faces there, model units
};

/// Cuts a region along smooth edges inside it: at the place, or between all CAD faces where it has none or
/// the faces at its point are no part of their own. A region of one face only is opened along its seams.
/// Edges that the region's boundary has already keep their division, so that the parts fit the neighbours;
/// cuts that would separate nothing are not made. Feature points and aligned edges stay.
///
/// Returns nothing where there is nothing to cut, as in models that no CAD shape is behind. The model's
/// region may have been refined since. Throws Error(Stage, "tessellate") where a part cannot be remeshed.
std::optional<RegionParts> regionParts(const Model& model, int region, const CutPlace& where,
                                       const Progress& progress);

/// Control points of the surfaces that the CAD faces of a region lie on, those of a bicubic patch for each at
/// least. Nothing where there are not several faces, or no CAD shape.
std::optional<int> cadPoles(const Model& model, int region);

/// The model with regions replaced by their parts, which come in the place of the whole: "region 3" becomes
/// "region 3.1", "region 3.2". Curves and corners keep their numbers, new ones come last.
/// \param parts by region
Model withParts(const Model& model, const std::map<int, const RegionParts*>& parts);

}  // namespace trimquad
