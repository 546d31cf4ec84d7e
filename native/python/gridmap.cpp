#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/embed/embed.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/gridmap/optimized_patch_map.h"
#include "trimquad/mesh/hole_bridges.h"
#include "trimquad/mesh/region.h"
#include "trimquad/mesh/write_obj.h"

namespace py = pybind11;

namespace trimquad {

namespace {

/// The grid map of the region alone, without what bridges its holes.
GridMap onSurface(GridMap map, const Region& bridged) {
  if (!bridged.bridge.empty()) static_cast<Parametrization&>(map) = withoutBridges(map, bridged);
  return map;
}

}  // namespace

void bindGridMap(py::module_& m) {
  py::class_<GridMap>(m, "GridMap")
      .def_property_readonly("counters", [](const GridMap& map) { return countersOf(map.counters); })
      .def_property_readonly("arrays", [](const GridMap& map) { return arraysOf(map); })
      .def(
          "to_obj", [](const GridMap& map) { return writeObj(map); }, Released());
  py::class_<EmbeddedTMesh>(m, "EmbeddedTMesh")
      .def_property_readonly("crossings", [](const EmbeddedTMesh& e) { return e.counters.crossings; });
  m.def(
      "embed",
      [](const SeamlessMap& seamless, const TMesh& tmesh, const Quantization& quantization,
         const Progress& progress) { return embed(seamless, tmesh, quantization, progress); },
      py::arg("seamless"), py::arg("tmesh"), py::arg("quantization"), py::arg("progress"), Released(),
      "The T-mesh on edges of a refined mesh, its zero arcs collapsed: the constructive route.");
  m.def(
      "embedded_grid_map",
      [](Model& model, int index, const Region& bridged, const SeamlessMap& seamless,
         const EmbeddedTMesh& embedded, const Progress& progress) {
        const PatchMap patches = constructiveMap(seamless, embedded, progress);
        GridMap map = optimizedPatchMap(seamless, patches, progress);
        const Region refined = refinedRegion(bridged, model.curves, patches.embedded.surface);
        map = onSurface(std::move(map), refined);
        model.regions.at(std::size_t(index)) = withoutBridges(refined);
        const auto& counters = patches.embedded.counters;
        return std::make_tuple(
            std::move(map),
            std::map<std::string, int>{
                {"inserted_vertices", counters.inserted},
                {"collapses", counters.zeroArcCollapses + counters.patchCollapses + counters.patchSplits},
                {"splits", counters.splits + patches.splits}});
      },
      py::arg("model"), py::arg("index"), py::arg("bridged"), py::arg("seamless"), py::arg("embedded"),
      py::arg("progress"), Released(),
      "The optimised grid map of an embedded T-mesh, and counters. The region of the model gets the refined "
      "mesh that the map is of. `bridged` is the region that the seamless map is of; what bridges its holes "
      "is in neither.");
  m.def(
      "grid_map",
      [](const Region& bridged, const SeamlessMap& seamless, const TMesh& tmesh,
         const Quantization& quantization, bool thorough, const Progress& progress) {
        return onSurface(gridMap(seamless, tmesh, quantization, thorough, progress), bridged);
      },
      py::arg("bridged"), py::arg("seamless"), py::arg("tmesh"), py::arg("quantization"), py::arg("thorough"),
      py::arg("progress"), Released(),
      "`bridged` is the region that the seamless map is of; what bridges its holes is left out.");
}

}  // namespace trimquad
