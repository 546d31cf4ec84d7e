#include "trimquad/field/cross_field.h"

#include <pybind11/stl.h>

#include <map>

#include "bindings.h"

namespace py = pybind11;

namespace trimquad {

void bindField(py::module_& m) {
  py::class_<CrossField>(m, "CrossField")
      .def_property_readonly(
          "singularities",
          [](const CrossField& field) {
            std::map<int, int> counts;
            for (int index : field.index)
              if (index != 0) ++counts[index];
            return counts;
          },
          "index in quarter turns -> number of vertices");
  m.def("cross_field", &crossField, py::arg("region"), py::arg("progress"), Released());
}

}  // namespace trimquad
