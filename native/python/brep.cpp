#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/brep/assemble.h"
#include "trimquad/brep/deviation_map.h"
#include "trimquad/brep/face_checks.h"
#include "trimquad/brep/region_parts.h"
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

py::list deviationMapsOf(const SplineModel& spline, const std::vector<const Region*>& regions, double chord,
                         double size, int threads, const Progress& progress) {
  std::vector<DeviationMap> maps;
  {
    py::gil_scoped_release release;
    maps = deviationMaps(spline, regions, {chord, size, threads}, progress);
  }
  py::list result;
  for (const DeviationMap& map : maps) {
    py::array_t<double> points({py::ssize_t(map.points.size()), py::ssize_t(3)});
    py::array_t<int> triangles({py::ssize_t(map.triangles.size()), py::ssize_t(3)});
    auto p = points.mutable_unchecked<2>();
    auto t = triangles.mutable_unchecked<2>();
    for (std::size_t i = 0; i < map.points.size(); ++i)
      for (int k = 0; k < 3; ++k) p(i, k) = map.points[i][k];
    for (std::size_t i = 0; i < map.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) t(i, k) = map.triangles[i][k];
    result.append(
        py::make_tuple(points, py::array_t<double>(map.distances.size(), map.distances.data()), triangles));
  }
  return result;
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
  py::class_<RegionParts>(m, "RegionParts")
      .def_property_readonly("count", [](const RegionParts& parts) { return parts.model.regions.size(); })
      .def_readonly("edges", &RegionParts::edges, "names of the edges that were cut");
  m.def(
      "region_parts",
      [](const Model& model, int region, const std::optional<Eigen::Vector3d>& place, bool creases,
         const Progress& progress) {
        return regionParts(model, region, {creases, place}, progress);
      },
      py::arg("model"), py::arg("region"), py::arg("place"), py::arg("creases"), py::arg("progress"),
      Released(),
      "A region cut along its smooth inner edges: with `creases` those where it bends sharply, else around "
      "the CAD faces at `place`, or between all faces where it is None. None where there is nothing to cut.");
  m.def("cad_poles", &cadPoles, py::arg("model"), py::arg("region"),
        "Control points of a region's CAD faces, 16 for each at least; None where there are not several.");
  m.def("with_parts", &withParts, py::arg("model"), py::arg("parts"), Released(),
        "The model with regions (by number) replaced by their parts.");
  m.def("assemble", &assemble, py::arg("spline"), Released());
  m.attr("CHECK_DOES_NOT_END") = kCheckDoesNotEnd;
  py::class_<FaceFault>(m, "FaceFault")
      .def(py::init<std::string, std::optional<int>>(), py::arg("what"), py::arg("other") = std::nullopt)
      .def_readonly("what", &FaceFault::what)
      .def_readonly("other", &FaceFault::other, "index of the face that it crosses, or None");
  py::class_<MeetingFaces>(m, "MeetingFaces", "two CAD faces that meet where they have no common edge")
      .def_readonly("first", &MeetingFaces::first, "its name")
      .def_readonly("second", &MeetingFaces::second, "its name")
      .def_readonly("cross", &MeetingFaces::cross, "whether they cross, rather than touch");
  py::class_<FaceChecks>(
      m, "FaceChecks",
      "OpenCASCADE's checks of a model's faces, and of pairs of them as its STEP file holds "
      "them, which are not repeated while these stay the same.")
      .def(py::init<std::string>(), py::arg("checker"))
      .def("faults", &FaceChecks::faults, py::arg("spline"), py::arg("folded"), py::arg("threads"),
           py::arg("progress"), Released(),
           "By face, its FaceFaults: what BRepCheck and the argument analysis of booleans find wrong with it "
           "and with pairs of it and another one. Pairs with a face in `folded` (indices) and such as are "
           "bent against each other come first; the others where nothing is wrong so far.")
      .def("likely_faults", &FaceChecks::likelyFaults, py::arg("spline"), py::arg("folded"),
           py::arg("threads"), py::arg("progress"), Released(), "faults() without the pairs that come last.")
      .def("meeting_cad_faces", &FaceChecks::meetingCadFaces, py::arg("model"), py::arg("region_a"),
           py::arg("region_b"), py::arg("progress"), Released(),
           "MeetingFaces: two CAD faces, one of each region, that cross each other as they are, or else "
           "touch; or None.")
      .def("faults_of_whole", &FaceChecks::faultsOfWhole, py::arg("spline"), py::arg("progress"), Released(),
           "what they find wrong with the whole, also in memory, but for faces that cross others");
  m.def("face_order", &faceOrder, py::arg("spline"), Released(),
        "by face of the assembled shape, its index among the spline's");
  m.def("deviation_maps", &deviationMapsOf, py::arg("spline"), py::arg("regions"), py::kw_only(),
        py::arg("chord"), py::arg("size"), py::arg("threads"), py::arg("progress"),
        "By face of the spline: points (n, 3), distances from its region (n), triangles (m, 3). `chord` and "
        "`size` bound the triangles' distances from the face and their sides.");
  m.def("write_step", &writeStep, py::arg("shape"), py::arg("path"), Released());
  m.def("write_brep", &writeBrep, py::arg("shape"), py::arg("path"), Released());
}

}  // namespace trimquad
