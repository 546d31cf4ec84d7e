#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/brep/assemble.h"
#include "trimquad/brep/shape.h"
#include "trimquad/brep/tessellate.h"

namespace py = pybind11;

namespace trimquad {
namespace {

Model tessellateShape(const Shape& shape, double edgeLength, double tolerance, const FeatureOptions& features,
                      const Progress& progress) {
  return tessellate(shape, {.edgeLength = edgeLength, .tolerance = tolerance, .features = features},
                    progress);
}

}  // namespace

void bindBrep(py::module_& m) {
  py::class_<Shape>(m, "Shape")
      .def_property_readonly("area", &Shape::area)
      .def_property_readonly("diagonal", &Shape::diagonal)
      .def_property_readonly("faces", &Shape::faceCount)
      .def_property_readonly("edges", &Shape::edgeCount)
      .def_property_readonly("solids", &Shape::solidCount)
      .def("sub_shape", &Shape::subShape, py::arg("faces"), Released());
  m.def("read_shape", &readShape, py::arg("path"), Released());
  m.def(
      "shape_from_freecad",
      [](const py::bytes& bytes) {
        const std::string data = bytes;
        py::gil_scoped_release release;
        return shapeFromFreeCAD(data);
      },
      py::arg("bytes"));
  m.def(
      "shape_to_freecad", [](const Shape& shape) { return py::bytes(shapeToFreeCAD(shape)); },
      py::arg("shape"));
  m.def("tessellate", &tessellateShape, py::arg("shape"), py::kw_only(), py::arg("edge_length"),
        py::arg("tolerance"), py::arg("features"), py::arg("progress"), Released());
  m.def("assemble", &assemble, py::arg("spline"), Released());
  m.def("face_faults", &faceFaults, py::arg("spline"), Released(),
        "by face, what BRepCheck and the argument analysis of booleans find wrong with it alone");
  m.def("shape_faults", &faults, py::arg("shape"), py::arg("crossings"), Released());
  m.def("write_step", &writeStep, py::arg("shape"), py::arg("path"), Released());
  m.def("write_brep", &writeBrep, py::arg("shape"), py::arg("path"), Released());
}

}  // namespace trimquad
