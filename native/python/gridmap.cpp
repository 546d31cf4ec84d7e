#include <pybind11/stl.h>

#include <chrono>

#include "bindings.h"
#include "trimquad/embed/embed.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/gridmap/optimized_patch_map.h"
#include "trimquad/mesh/region.h"
#include "trimquad/mesh/write_obj.h"

namespace py = pybind11;

namespace trimquad {

void bindGridMap(py::module_& m) {
  py::class_<GridMap>(m, "GridMap")
      .def_property_readonly("counters", [](const GridMap& map) { return countersOf(map.counters); })
      .def_property_readonly("arrays", [](const GridMap& map) { return arraysOf(map); })
      .def(
          "to_obj", [](const GridMap& map) { return writeObj(map); }, Released());
  m.def(
      "reembed",
      [](Model& model, int index, const SeamlessMap& seamless, const TMesh& tmesh,
         const Quantization& quantization, const Progress& progress) {
        const auto started = std::chrono::steady_clock::now();
        EmbeddedTMesh embedded = embed(seamless, tmesh, quantization, progress);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - started;
        const PatchMap patches = constructiveMap(seamless, std::move(embedded), progress);
        GridMap map = optimizedPatchMap(seamless, patches, progress);
        Region& region = model.regions.at(std::size_t(index));
        region = refinedRegion(region, model.curves, patches.embedded.surface);
        const auto& counters = patches.embedded.counters;
        return std::make_tuple(std::move(map), seconds.count(),
                               std::map<std::string, int>{{"inserted_vertices", counters.inserted},
                                                          {"collapses", counters.zeroArcCollapses +
                                                                            counters.patchCollapses +
                                                                            counters.patchSplits},
                                                          {"splits", counters.splits + patches.splits}});
      },
      py::arg("model"), py::arg("index"), py::arg("seamless"), py::arg("tmesh"), py::arg("quantization"),
      py::arg("progress"), Released(),
      "The constructive route: the grid map, seconds of re-embedding, counters. The region of the model "
      "gets the refined mesh that the map is of.");
  m.def("grid_map", &gridMap, py::arg("seamless"), py::arg("tmesh"), py::arg("quantization"),
        py::arg("progress"), Released());
}

}  // namespace trimquad
