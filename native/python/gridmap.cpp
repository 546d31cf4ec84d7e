#include "bindings.h"
#include "trimquad/gridmap/grid_map.h"
#include "trimquad/mesh/write_obj.h"

namespace py = pybind11;

namespace trimquad {

void bindGridMap(py::module_& m) {
  py::class_<GridMap>(m, "GridMap")
      .def_property_readonly("counters", [](const GridMap& map) { return countersOf(map.counters); })
      .def_property_readonly("arrays", [](const GridMap& map) { return arraysOf(map); })
      .def(
          "to_obj", [](const GridMap& map) { return writeObj(map); }, Released());
  m.def("grid_map", &gridMap, py::arg("seamless"), py::arg("tmesh"), py::arg("quantization"),
        py::arg("progress"), Released());
}

}  // namespace trimquad
