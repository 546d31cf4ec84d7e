#include "trimquad/brep/tessellate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/feature_points.h"
#include "trimquad/mesh/join_regions.h"
#include "trimquad/mesh/remesh.h"
#include "trimquad/mesh/split_triangles.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cut_regions.h"
#include "trimquad/brep/inner_edges.h"
#include "trimquad/brep/occt_guard.h"

namespace trimquad {
namespace {

/// BRepMesh's triangles only tell where to start on the true surface, so they may be coarser than the
/// tolerance; the bounds are shares of the diagonal.
constexpr double kFinestDeflection = 2e-5, kCoarsestDeflection = 2e-4;
/// Gaps that sewing closes, shares of the diagonal.
constexpr double kSewnGap = 1e-5, kNarrowGap = 1e-7;
constexpr std::array<double, 3> kDeflectionSteps{1, 5, 25};

void demandPositive(double value, const char* option) {
  if (!std::isfinite(value) || value <= 0)
    throw inputError("tessellate", std::string(option) + " must be a positive number");
}

CutModel cutIntoRegions(const CadModel& cad, double deflection, const TessellateOptions& options) {
  WeldedMesh mesh = weldedMesh(cad, deflection);
  const auto reversed = orientFaces(cad, mesh);
  auto uses = sideUses(cad, mesh);
  auto features =
      featureEdges(cad, mesh, uses, reversed, options.features, kShortestEdge * options.edgeLength);
  divideInnerEdges(cad, mesh, features);
  uses = sideUses(cad, mesh);
  return cutRegions(cad, mesh, uses, features, featureVertices(cad, mesh, options.features), reversed);
}

/// BRepMesh cannot triangulate some faces at one deflection that it can at another. Since the true surface is
/// reached by Newton's method from any of them, coarser ones are tried before the complaint about the finest
/// is passed on.
/// Loose faces that sewing joins to something that is no surface are sewn across narrower gaps, then left
/// apart.
CutModel regionsOf(const Shape& shape, double deflection, const TessellateOptions& options,
                   const Progress& progress) {
  std::optional<Error> complaint;
  for (const double gap : {kSewnGap, kNarrowGap, 0.0}) {
    bool sewn = false;
    for (const double coarser : kDeflectionSteps) {
      progress.check();
      const CadModel cad = cadModel(shape, gap);  // anew: its triangulation is kept with it
      sewn = cad.sewn;
      try {
        CutModel cut = cutIntoRegions(cad, coarser * deflection, options);
        cut.model.keptApart = gap == 0;
        return cut;
      } catch (const Error& error) {
        if (error.kind() != Error::Kind::Input || error.stage() == "options") throw;
        if (!complaint) complaint = error;
      }
    }
    if (!sewn) break;
  }
  throw Error(*complaint);
}

/// Two pieces at least where regions are joined again: a slit of one piece would close by itself.
void divideSlits(const CutModel& cut, std::vector<std::vector<double>>& division) {
  for (size_t c = 0; c < division.size(); ++c)
    if (cut.inner[c] && division[c].size() == 2)
      division[c].insert(division[c].begin() + 1, 0.5 * (division[c].front() + division[c].back()));
}

/// Marks the aligned edges of the boundaries, and the vertices that were wanted on curves.
void markConstraints(CutModel& cut, const std::vector<CurvePoint>& points) {
  for (auto& region : cut.model.regions) {
    for (const auto e : region.mesh.edges())
      if (const auto& curve = region.edgeCurve[e.idx()]; curve && cut.aligned[curve->index])
        region.aligned.push_back(e);
    markCurvePoints(region, points);
  }
}

}  // namespace

Model tessellate(const Shape& shape, const TessellateOptions& options, const Progress& progress) {
  demandPositive(options.edgeLength, "the edge length");
  demandPositive(options.tolerance, "the tolerance");
  demandPositive(options.features.angle, "the feature angle");
  const std::string complaint = "OpenCASCADE cannot triangulate the shape; repair it";
  return guarded(Error::Kind::Input, "tessellate", complaint, [&] {
    const double diagonal = shape.diagonal();
    const double deflection = std::clamp(std::min(options.tolerance, 0.1 * options.edgeLength),
                                         kFinestDeflection * diagonal, kCoarsestDeflection * diagonal);
    CutModel cut = regionsOf(shape, deflection, options, progress);
    const auto curvePoints = pinPoints(cut.model, options.features);
    const RemeshOptions wanted{options.edgeLength, options.tolerance};
    auto division = divideCurves(cut.model, wanted);
    divideAt(curvePoints, division);
    divideSlits(cut, division);
    for (size_t r = 0; r < cut.model.regions.size(); ++r)
      remesh(cut.model.regions[r], cut.model, division, cut.creases[r], wanted, progress);
    markConstraints(cut, curvePoints);
    Model model = joinRegions(cut.model, cut.inner, cut.surfaces);
    model.keptApart = cut.model.keptApart;
    for (auto& region : model.regions) splitConstrainedTriangles(region);
    return model;
  });
}

}  // namespace trimquad
