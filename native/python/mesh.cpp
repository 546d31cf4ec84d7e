#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/base/error.h"
#include "trimquad/mesh/check_mesh.h"
#include "trimquad/mesh/mesh_model.h"
#include "trimquad/mesh/read_mesh.h"
#include "trimquad/mesh/region.h"

namespace py = pybind11;

namespace trimquad {
namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Triangles = py::array_t<int, py::array::c_style | py::array::forcecast>;

TriangleSoup soupOf(const Points& points, const Triangles& triangles) {
  if (points.ndim() != 2 || points.shape(1) != 3 || triangles.ndim() != 2 || triangles.shape(1) != 3)
    throw inputError("read", "points and triangles must be arrays of three columns");
  TriangleSoup soup;
  const auto p = points.unchecked<2>();
  const auto t = triangles.unchecked<2>();
  for (py::ssize_t i = 0; i < p.shape(0); ++i) soup.points.emplace_back(p(i, 0), p(i, 1), p(i, 2));
  for (py::ssize_t i = 0; i < t.shape(0); ++i) soup.triangles.push_back({t(i, 0), t(i, 1), t(i, 2)});
  return soup;
}

py::dict repairsOf(const RepairReport& report) {
  py::dict counts;
  const auto add = [&](const char* name, int count) {
    if (count > 0) counts[name] = count;
  };
  add("unused_vertices", report.unusedVertices);
  add("repeated_corners", report.repeatedCorners);
  add("duplicate_triangles", report.duplicateTriangles);
  add("welded_vertices", report.weldedVertices);
  add("split_vertices", report.splitVertices);
  add("turned_triangles", report.turnedTriangles);
  add("flat_triangles", report.flatTriangles);
  return counts;
}

py::tuple repairedModel(TriangleSoup soup, std::optional<double> trimAngle, const Progress& progress) {
  std::optional<Model> model;
  RepairReport report;
  {
    py::gil_scoped_release release;
    report = repair(soup);
    model = meshModel(soup, {.trimAngle = trimAngle}, progress);
  }
  return py::make_tuple(std::move(*model), repairsOf(report));
}

void bindRegion(py::module_& m) {
  py::class_<Region>(m, "Region")
      .def_readonly("name", &Region::name)
      .def_property_readonly("triangles", [](const Region& region) { return region.mesh.n_faces(); })
      .def_property_readonly("vertices", [](const Region& region) { return region.mesh.n_vertices(); })
      .def_property_readonly("boundary_loops",
                             [](const Region& region) { return boundaryLoops(region.mesh).size(); })
      .def_property_readonly("euler", [](const Region& region) { return eulerCharacteristic(region.mesh); })
      .def_property_readonly("area", [](const Region& region) { return surfaceArea(region.mesh); });
}

}  // namespace

void bindMesh(py::module_& m) {
  bindRegion(m);
  py::class_<Model>(m, "Model")
      .def_property_readonly(
          "regions",
          [](py::object self) {
            py::list regions;
            for (Region& region : self.cast<Model&>().regions)
              regions.append(py::cast(&region, py::return_value_policy::reference_internal, self));
            return regions;
          })
      .def_readonly("diagonal", &Model::diagonal)
      .def_property_readonly("curves", [](const Model& model) { return model.curves.size(); });
  py::class_<TriangleSoup>(m, "TriangleSoup")
      .def_property_readonly("triangles", [](const TriangleSoup& soup) { return soup.triangles.size(); });
  m.def(
      "read_mesh", [](const std::string& path) { return readMesh(path).soup; }, py::arg("path"), Released());
  m.def("mesh_from_arrays", &soupOf, py::arg("points"), py::arg("triangles"));
  m.def("mesh_model", &repairedModel, py::arg("soup"), py::arg("trim_angle"), py::arg("progress"),
        "The model of a triangle soup, and what had to be repaired as counts. Sharp edges over `trim_angle` "
        "degrees "
        "separate regions; None: nothing does.");
}

}  // namespace trimquad
