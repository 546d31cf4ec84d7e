#include "trimquad/seamless/seamless_map.h"

#include "bindings.h"
#include "trimquad/mesh/write_obj.h"

namespace py = pybind11;

namespace trimquad {

py::dict countersOf(const MapCounters& counters) {
  py::dict all;
  all["flipped_before"] = counters.flippedBefore;
  all["untangle_iterations"] = counters.untangleIterations;
  all["convex_start"] = counters.convexStart;
  all["iterations"] = counters.iterations;
  all["distortion_start"] = counters.distortionStart;
  all["distortion_end"] = counters.distortionEnd;
  return all;
}

void bindSeamless(py::module_& m) {
  py::class_<SeamlessMap>(m, "SeamlessMap")
      .def_property_readonly("counters", [](const SeamlessMap& map) { return countersOf(map.counters); })
      .def_property_readonly("arrays", [](const SeamlessMap& map) { return arraysOf(map); })
      .def(
          "to_obj", [](const SeamlessMap& map) { return writeObj(map); }, Released());
  m.def("seamless_map", &seamlessMap, py::arg("region"), py::arg("field"), py::arg("edge_length"),
        py::arg("progress"), Released());
}

}  // namespace trimquad
