#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/mesh/region.h"
#include "trimquad/quads/extract_quads.h"
#include "trimquad/quads/merge_slivers.h"

namespace py = pybind11;

namespace trimquad {
namespace {

std::vector<VertexHandle> cornersOf(const Region& region) {
  std::vector<VertexHandle> corners;
  for (std::size_t v = 0; v < region.corner.size(); ++v)
    if (region.corner[v]) corners.emplace_back(static_cast<int>(v));
  return corners;
}

py::dict statisticsOf(const QuadMesh& quads) {
  const QuadStatistics s = statistics(quads);
  py::dict angle, edge, all;
  angle["mean"] = s.angleDeviation.mean;
  angle["p95"] = s.angleDeviation.p95;
  angle["max"] = s.angleDeviation.max;
  edge["mean"] = s.edgeLength.mean;
  edge["std"] = s.edgeLength.std;
  all["quads"] = s.quads;
  all["trimmed"] = s.trimmed;
  all["merged_slivers"] = quads.mergedSlivers;
  all["dropped_slivers"] = quads.droppedSlivers;
  all["irregular_vertices"] = s.irregularVertices;
  all["angle_deviation"] = angle;
  all["edge_length"] = edge;
  return all;
}

}  // namespace

void bindQuads(py::module_& m) {
  py::class_<QuadMesh>(m, "QuadMesh")
      .def_property_readonly("statistics", &statisticsOf, "the object `quads` of report.json")
      .def_property_readonly(
          "measures",
          [](const QuadMesh& quads) {
            const QuadMeasures found = measures(quads);
            return std::make_tuple(found.angleDeviations, found.edgeLengths);
          },
          "(degrees from 90 of the corners of full quads at inner points, lengths of the edges of full "
          "quads)")
      .def_property_readonly(
          "doubled_side",
          [](const QuadMesh& quads) -> py::object {
            const auto side = doubledSide(quads);
            if (!side) return py::none();
            const auto& p = quads.points[std::size_t((*side)[0].index)].position;
            return py::make_tuple(p.x(), p.y(), p.z());
          },
          "where two sides join the same two points, or None")
      .def_readonly("euler", &QuadMesh::eulerCharacteristic)
      .def("to_obj", &writeQuadsObj, Released());
  m.def(
      "extract_quads",
      [](const GridMap& grid, const Region& region, const Progress& progress) {
        QuadMesh quads = extractQuads(grid, cornersOf(region), progress);
        dropVanishingCells(quads);
        return quads;
      },
      py::arg("grid"), py::arg("region"), py::arg("progress"), Released(),
      "The quads of a grid map; the region says which boundary vertices are corners. Cells under a millionth "
      "of a whole one, and such as are lines in space, go into neighbours.");
  m.def("merge_slivers", &mergeSlivers, py::arg("quads"), py::arg("fraction"), Released(),
        "Merges trimmed cells under this fraction of a whole cell with neighbours; returns how many.");
}

}  // namespace trimquad
