#include "trimquad/field/cross_field.h"

#include <pybind11/stl.h>

#include <map>

#include "bindings.h"
#include "trimquad/field/curvature_guidance.h"
#include "trimquad/field/singularity_free_field.h"

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
  py::class_<FieldGuidance>(m, "FieldGuidance");
  m.def("curvature_guidance", &curvatureGuidance, py::arg("region"), py::arg("progress"), Released());
  m.def("cross_field", &crossField, py::arg("region"), py::arg("guidance"), py::arg("guidance_reach"),
        py::arg("progress"), Released());
  m.def(
      "singularity_free_field",
      [](const Region& region, const FieldGuidance& guidance, const Progress& progress) {
        requireArea(region.mesh);
        return singularityFreeField(region.mesh, guidance, progress);
      },
      py::arg("region"), py::arg("guidance"), py::arg("progress"), Released());
  m.def(
      "admits_no_singularity", [](const Region& region) { return admitsNoSingularity(region.mesh); },
      py::arg("region"), Released());
}

}  // namespace trimquad
