#include "trimquad/brep/tessellate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/feature_points.h"

// This order: OpenCASCADE's macros must not reach the mesh headers.
#include "trimquad/brep/cut_regions.h"
#include "trimquad/brep/inner_edges.h"
#include "trimquad/brep/meshed_regions.h"
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

struct Cut {
  std::shared_ptr<const WeldedShape> shape;
  FeatureEdges features;
  CutModel model;
};

Cut cutIntoRegions(CadModel cad, double deflection, const TessellateOptions& options) {
  auto shape = std::make_shared<WeldedShape>(WeldedShape{std::move(cad), {}, {}, {}, {}});
  shape->mesh = weldedMesh(shape->cad, deflection);
  shape->reversed = orientFaces(shape->cad, shape->mesh);
  shape->uses = sideUses(shape->cad, shape->mesh);
  auto features = featureEdges(shape->cad, shape->mesh, shape->uses, shape->reversed, options.features,
                               kShortestEdge * options.edgeLength);
  divideInnerEdges(shape->cad, shape->mesh, features);
  shape->uses = sideUses(shape->cad, shape->mesh);
  shape->points = featureVertices(shape->cad, shape->mesh, options.features);
  std::vector<int> triangles(shape->mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0);
  auto model = cutRegions(*shape, features, triangles);
  return {std::move(shape), std::move(features), std::move(model)};
}

/// BRepMesh cannot triangulate some faces at one deflection that it can at another. Since the true surface is
/// reached by Newton's method from any of them, coarser ones are tried before the complaint about the finest
/// is passed on.
/// Loose faces that sewing joins to something that is no surface are sewn across narrower gaps, then left
/// apart.
Cut regionsOf(const Shape& shape, double deflection, const TessellateOptions& options,
              const Progress& progress) {
  std::optional<Error> complaint;
  for (const double gap : {kSewnGap, kNarrowGap, 0.0}) {
    bool sewn = false;
    for (const double coarser : kDeflectionSteps) {
      progress.check();
      CadModel cad = cadModel(shape, gap);  // anew: its triangulation is kept with it
      sewn = cad.sewn;
      try {
        Cut cut = cutIntoRegions(std::move(cad), coarser * deflection, options);
        cut.model.model.keptApart = gap == 0;
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

/// What the model's regions were cut from. The model's curves are those of the cut one that are not inner.
std::shared_ptr<const CadOrigin> originOf(const Cut& cut, std::vector<std::vector<double>> division,
                                          const TessellateOptions& options) {
  CadOrigin origin{cut.shape,
                   cut.features,
                   {options.edgeLength, options.tolerance},
                   options.features.quadLength,
                   cut.model.triangles,
                   std::vector<std::vector<double>>(cut.shape->cad.edges.size()),
                   std::vector<std::optional<CurveId>>(cut.shape->cad.edges.size()),
                   std::vector<std::optional<CornerId>>(cut.shape->cad.vertices.size())};
  int curves = 0;
  for (size_t c = 0; c < division.size(); ++c) {
    const int edge = cut.model.cadEdge[c];
    origin.division[edge] = std::move(division[c]);
    if (!cut.model.inner[c]) origin.curve[edge] = CurveId{curves++};
  }
  for (size_t c = 0; c < cut.model.cadVertex.size(); ++c)
    origin.corner[cut.model.cadVertex[c]] = CornerId{int(c)};
  return std::make_shared<const CadOrigin>(std::move(origin));
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
    Cut cut = regionsOf(shape, deflection, options, progress);
    const auto curvePoints = pinPoints(cut.model.model, options.features);
    const RemeshOptions wanted{options.edgeLength, options.tolerance};
    auto division = divideCurves(cut.model.model, wanted);
    divideByCurvature(cut.model.model, cut.model.inner, wanted, division);
    divideAt(curvePoints, division);
    divideSlits(cut.model, division);
    Model model = meshedRegions(cut.model, curvePoints, division, wanted, progress);
    model.keptApart = cut.model.model.keptApart;
    model.origin = originOf(cut, std::move(division), options);
    return model;
  });
}

}  // namespace trimquad
