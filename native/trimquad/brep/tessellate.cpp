#include "trimquad/brep/tessellate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "trimquad/brep/cut_regions.h"
#include "trimquad/brep/occt_guard.h"
#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/remesh.h"

namespace trimquad {
namespace {

/// BRepMesh's triangles only tell where to start on the true surface, so they may be coarser than the
/// tolerance; the bounds are shares of the diagonal.
constexpr double kFinestDeflection = 2e-5, kCoarsestDeflection = 2e-4;

void demandPositive(double value, const char* option) {
  if (!std::isfinite(value) || value <= 0)
    throw inputError("tessellate", std::string(option) + " must be a positive number");
}

}  // namespace

Model tessellate(const Shape& shape, const TessellateOptions& options, const Progress& progress) {
  demandPositive(options.edgeLength, "the edge length");
  demandPositive(options.tolerance, "the tolerance");
  demandPositive(options.featureAngle, "the feature angle");
  const std::string complaint = "OpenCASCADE cannot triangulate the shape; repair it";
  return guarded(Error::Kind::Input, "tessellate", complaint, [&] {
    const CadModel cad = cadModel(shape);
    const double diagonal = shape.diagonal();
    const double deflection = std::clamp(std::min(options.tolerance, 0.1 * options.edgeLength),
                                         kFinestDeflection * diagonal, kCoarsestDeflection * diagonal);
    progress.check();
    WeldedMesh mesh = weldedMesh(cad, deflection);
    progress.check();
    const auto reversed = orientFaces(cad, mesh);
    const auto uses = sideUses(cad, mesh);
    const double angle = options.features == TessellateOptions::Features::Trim
                             ? options.featureAngle * std::numbers::pi / 180
                             : std::numeric_limits<double>::infinity();
    Model model = cutRegions(cad, mesh, uses, cutEdges(cad, mesh, uses, reversed, angle), reversed);
    progress.check();
    const RemeshOptions wanted{options.edgeLength, options.tolerance};
    const auto division = divideCurves(model, wanted);
    for (Region& region : model.regions) remesh(region, model, division, wanted, progress);
    return model;
  });
}

}  // namespace trimquad
