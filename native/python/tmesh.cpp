#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/mesh/read_map.h"
#include "trimquad/seamless/seamless_map.h"
#include "trimquad/tmesh/partition.h"

namespace py = pybind11;

namespace trimquad {
namespace {

const char* kindOf(TMesh::NodeKind kind) {
  switch (kind) {
    case TMesh::NodeKind::Singular:
      return "singular";
    case TMesh::NodeKind::Feature:
      return "feature";
    case TMesh::NodeKind::Boundary:
      return "boundary";
    case TMesh::NodeKind::Regular:
      return "regular";
    case TMesh::NodeKind::TJunction:
      return "tjunction";
    default:
      return "virtual";
  }
}

py::list nodesOf(const TMesh& tmesh) {
  py::list nodes;
  for (const auto& node : tmesh.nodes)
    nodes.append(py::make_tuple(kindOf(node.kind), node.critical, node.border,
                                std::array{node.position.x(), node.position.y(), node.position.z()}));
  return nodes;
}

py::list arcsOf(const TMesh& tmesh) {
  py::list arcs;
  for (const auto& arc : tmesh.arcs)
    arcs.append(py::make_tuple(arc.from.index, arc.to.index, tmesh.scale.toQuads(arc.length), arc.isVirtual,
                               arc.border, arc.critical));
  return arcs;
}

py::list patchesOf(const TMesh& tmesh) {
  py::list patches;
  for (const auto& patch : tmesh.patches) {
    py::list sides;
    for (const auto& side : patch.sides) {
      py::list arcs;
      for (const HalfArc h : side) arcs.append(h.forward ? h.arc.index + 1 : -(h.arc.index + 1));
      sides.append(arcs);
    }
    patches.append(py::make_tuple(patch.type, sides));
  }
  return patches;
}

/// Corners of each arc's course in space, n x 3; of a virtual arc the places of its nodes.
py::list curvesOf(const TMesh& tmesh, const Parametrization& map) {
  py::list curves;
  for (const auto& arc : tmesh.arcs) {
    std::vector<Eigen::Vector3d> points{tmesh[arc.from].position};
    for (const auto& leg : arc.legs) points.push_back(placeInSpace(map, leg.to));
    if (arc.isVirtual) points.push_back(tmesh[arc.to].position);
    Eigen::MatrixX3d rows(points.size(), 3);
    for (std::size_t k = 0; k < points.size(); ++k) rows.row(Eigen::Index(k)) = points[k];
    curves.append(rows);
  }
  return curves;
}

}  // namespace

void bindTMesh(py::module_& m) {
  py::class_<TMesh>(m, "TMesh")
      .def_property_readonly("nodes", &nodesOf, "(kind, critical, border, xyz) each")
      .def_property_readonly("arcs", &arcsOf, "(from, to, length in quads, virtual, border, critical) each")
      .def_property_readonly(
          "patches", &patchesOf,
          "(type, sides) each; an arc is its number + 1, negative where it is walked backward");
  m.def(
      "arc_curves", [](const TMesh& tmesh, const SeamlessMap& map) { return curvesOf(tmesh, map); },
      py::arg("tmesh"), py::arg("seamless"),
      "Corners of each arc's course in space, n x 3; of a virtual arc the places of its nodes.");
  m.def("read_map", &readMapObj, py::arg("name"), py::arg("text"), Released(),
        "The map in the text of an OBJ file.");
  m.def(
      "partition", [](const SeamlessMap& map, const Progress& progress) { return partition(map, progress); },
      py::arg("seamless"), py::arg("progress"), Released());
  m.def("partition", &partition, py::arg("map"), py::arg("progress"), Released());
}

}  // namespace trimquad
