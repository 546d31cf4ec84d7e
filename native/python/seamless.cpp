#include "trimquad/seamless/seed.h"

#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/field/bridged_guidance.h"
#include "trimquad/mesh/hole_bridges.h"
#include "trimquad/mesh/write_obj.h"
#include "trimquad/seamless/local_refinement.h"

namespace py = pybind11;

namespace trimquad {

py::dict countersOf(const MapCounters& counters) {
  py::dict all;
  all["flipped_before"] = counters.flippedBefore;
  all["path_steps"] = counters.pathSteps;
  all["neighbourhoods"] = counters.neighbourhoods;
  all["untangle_iterations"] = counters.untangleIterations;
  all["refinements"] = counters.refinements;
  all["halved_edges"] = counters.halvedEdges;
  all["stiffenings"] = counters.stiffenings;
  all["starts"] = counters.starts;
  all["convex_start"] = counters.convexStart;
  all["scaffolded"] = counters.scaffolded;
  all["iterations"] = counters.iterations;
  all["distortion_start"] = counters.distortionStart;
  all["distortion_end"] = counters.distortionEnd;
  return all;
}

void bindSeamless(py::module_& m) {
  py::class_<Parametrization>(m, "Map")
      .def_property_readonly("arrays", [](const Parametrization& map) { return arraysOf(map); })
      .def(
          "to_obj", [](const Parametrization& map) { return writeObj(map); }, Released());
  m.def(
      "without_bridges",
      [](const SeamlessMap& map, const Region& bridged) { return withoutBridges(map, bridged); },
      py::arg("map"), py::arg("bridged"), Released(),
      "The map of the region alone, without what bridges its holes.");
  py::class_<SeamlessMap>(m, "SeamlessMap")
      .def_property_readonly("counters", [](const SeamlessMap& map) { return countersOf(map.counters); })
      .def_property_readonly("arrays", [](const SeamlessMap& map) { return arraysOf(map); })
      .def(
          "to_obj", [](const SeamlessMap& map) { return writeObj(map); }, Released());
  py::class_<Seed>(m, "Seed")
      .def_readonly("field", &Seed::field)
      .def_readonly("map", &Seed::map)
      .def_property_readonly("refined", [](const Seed& s) { return s.map.refined.has_value(); })
      .def_readonly("field_edits", &Seed::fieldEdits)
      .def_readonly("field_seconds", &Seed::fieldSeconds)
      .def_readonly("seamless_seconds", &Seed::seamlessSeconds);
  m.def(
      "seed",
      [](const Region& region, const std::string& follow, std::optional<FieldGuidance> guidance,
         std::optional<double> weight, double edgeLength, const std::string& singularities,
         const Progress& progress) {
        SeedOptions options;
        options.follow = guidance             ? SeedOptions::Follow::Given
                         : follow == "smooth" ? SeedOptions::Follow::Smooth
                                              : SeedOptions::Follow::Curvature;
        options.guidance = std::move(guidance);
        options.weight = weight;
        options.edgeLength = edgeLength;
        options.singularities = singularities == "none"       ? SeedOptions::Singularities::None
                                : singularities == "of field" ? SeedOptions::Singularities::OfField
                                                              : SeedOptions::Singularities::Weighed;
        return seed(region, options, progress);
      },
      py::arg("region"), py::arg("follow"), py::arg("guidance"), py::arg("weight"), py::arg("edge_length"),
      py::arg("singularities"), py::arg("progress"), Released(),
      "follow: 'curvature' or 'smooth', where there is no `guidance`; weight: how closely, 0 to 1, or None; "
      "singularities: 'weighed' against distortion, 'none', or those 'of field'");
  m.def(
      "place_refined",
      [](Model& model, int index, const Region& bridged, const Seed& seed,
         std::optional<FieldGuidance> guidance) {
        const RefinedMesh& refined = *seed.map.refined;
        Region region = refinedRegion(bridged, model.curves, refined);
        if (guidance)
          guidance = offBridges(refinedGuidance(refined, overBridges(*guidance, bridged)), region);
        model.regions.at(std::size_t(index)) = withoutBridges(region);
        return std::make_tuple(std::move(region), std::move(guidance));
      },
      py::arg("model"), py::arg("index"), py::arg("bridged"), py::arg("seed"), py::arg("guidance"),
      Released(),
      "The region of the model gets the mesh with halved edges that the map is of, without what bridges its "
      "holes. Returns that mesh with it, and the guidance of the region.");
}

}  // namespace trimquad
