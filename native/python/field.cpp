#include "trimquad/field/cross_field.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <map>

#include "bindings.h"
#include "trimquad/field/field_file.h"

namespace py = pybind11;

namespace trimquad {

namespace {

py::array_t<double> rowsOf(const std::vector<Eigen::Vector3d>& vectors) {
  py::array_t<double> rows({py::ssize_t(vectors.size()), py::ssize_t(3)});
  auto r = rows.mutable_unchecked<2>();
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (int k = 0; k < 3; ++k) r(i, k) = vectors[i][k];
  return rows;
}

}  // namespace

void bindField(py::module_& m) {
  py::class_<CrossField>(m, "CrossField")
      .def_property_readonly("aligned_edges", [](const CrossField& field) { return field.aligned.size(); })
      .def_readonly("loop_turns", &CrossField::loopTurns,
                    "quarter turns of each boundary loop against the field")
      .def_property_readonly(
          "singularities",
          [](const CrossField& field) {
            std::map<int, int> counts;
            for (int index : field.index)
              if (index != 0) ++counts[index];
            return counts;
          },
          "index in quarter turns -> number of vertices")
      .def_property_readonly(
          "singular_vertices",
          [](const CrossField& field) {
            std::vector<std::pair<int, int>> singular;
            for (int v = 0; v < int(field.index.size()); ++v)
              if (field.index[v] != 0) singular.emplace_back(v, field.index[v]);
            return singular;
          },
          "(vertex of the region, index in quarter turns)")
      .def_property_readonly(
          "directions", [](const CrossField& field) { return rowsOf(field.direction); },
          "by triangle of the region: one of the four directions, unit length, (m, 3)");
  py::class_<FieldFile>(m, "FieldFile")
      .def_property_readonly("count", &FieldFile::count)
      .def_property_readonly("placed", [](const FieldFile& field) { return !field.point.empty(); });
  py::class_<FieldGuidance>(m, "FieldGuidance")
      .def_property_readonly("directions", [](const FieldGuidance& field) { return rowsOf(field.direction); })
      .def_readonly("weights", &FieldGuidance::weight);
  m.def(
      "read_field", [](const std::string& path) { return readField(path); }, py::arg("path"), Released());
  m.def("triangle_directions", &triangleDirections, py::arg("field"), py::arg("mesh"), Released());
  m.def("guidance_of_triangles", py::overload_cast<const Region&, const FieldGuidance&>(&guidanceOf),
        py::arg("region"), py::arg("by_input_triangle"), Released());
  m.def("guidance_of_points", py::overload_cast<const Region&, const FieldFile&>(&guidanceOf),
        py::arg("region"), py::arg("field"), Released());
}

}  // namespace trimquad
