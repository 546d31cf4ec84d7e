#include "trimquad/brep/tessellate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "trimquad/brep/cut_regions.h"
#include "trimquad/brep/occt_guard.h"
#include "trimquad/mesh/divide_curves.h"
#include "trimquad/mesh/remesh.h"

namespace trimquad {
namespace {

/// BRepMesh's triangles only tell where to start on the true surface, so they may be coarser than the
/// tolerance; the bounds are shares of the diagonal.
constexpr double kFinestDeflection = 2e-5, kCoarsestDeflection = 2e-4;
constexpr std::array<double, 3> kDeflectionSteps{1, 5, 25};

void demandPositive(double value, const char* option) {
  if (!std::isfinite(value) || value <= 0)
    throw inputError("tessellate", std::string(option) + " must be a positive number");
}

CutModel cutIntoRegions(const Shape& shape, double deflection, const TessellateOptions& options) {
  const CadModel cad = cadModel(shape);
  WeldedMesh mesh = weldedMesh(cad, deflection);
  const auto reversed = orientFaces(cad, mesh);
  const auto uses = sideUses(cad, mesh);
  const double angle = options.features == TessellateOptions::Features::Trim
                           ? options.featureAngle * std::numbers::pi / 180
                           : std::numeric_limits<double>::infinity();
  const auto features = featureEdges(cad, mesh, uses, reversed, angle, kShortestEdge * options.edgeLength);
  return cutRegions(cad, mesh, uses, features, reversed);
}

/// BRepMesh cannot triangulate some faces at one deflection that it can at another. Since the true surface is
/// reached by Newton's method from any of them, coarser ones are tried before the complaint about the finest
/// is passed on.
CutModel regionsOf(const Shape& shape, double deflection, const TessellateOptions& options,
                   const Progress& progress) {
  std::optional<Error> complaint;
  for (const double coarser : kDeflectionSteps) {
    progress.check();
    try {
      return cutIntoRegions(shape, coarser * deflection, options);
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::Input) throw;
      if (!complaint) complaint = error;
    }
  }
  throw Error(*complaint);
}

}  // namespace

Model tessellate(const Shape& shape, const TessellateOptions& options, const Progress& progress) {
  demandPositive(options.edgeLength, "the edge length");
  demandPositive(options.tolerance, "the tolerance");
  demandPositive(options.featureAngle, "the feature angle");
  const std::string complaint = "OpenCASCADE cannot triangulate the shape; repair it";
  return guarded(Error::Kind::Input, "tessellate", complaint, [&] {
    const double diagonal = shape.diagonal();
    const double deflection = std::clamp(std::min(options.tolerance, 0.1 * options.edgeLength),
                                         kFinestDeflection * diagonal, kCoarsestDeflection * diagonal);
    auto [model, creases] = regionsOf(shape, deflection, options, progress);
    const RemeshOptions wanted{options.edgeLength, options.tolerance};
    const auto division = divideCurves(model, wanted);
    for (size_t r = 0; r < model.regions.size(); ++r)
      remesh(model.regions[r], model, division, creases[r], wanted, progress);
    return std::move(model);
  });
}

}  // namespace trimquad
