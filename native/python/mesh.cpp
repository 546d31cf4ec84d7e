#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <map>

#include "bindings.h"
#include "trimquad/base/error.h"
#include "trimquad/mesh/check_mesh.h"
#include "trimquad/mesh/edge_choice.h"
#include "trimquad/mesh/feature_graph.h"
#include "trimquad/mesh/hole_bridges.h"
#include "trimquad/mesh/mesh_model.h"
#include "trimquad/mesh/parametrization.h"
#include "trimquad/mesh/read_mesh.h"
#include "trimquad/mesh/region.h"
#include "trimquad/mesh/touching_regions.h"

namespace py = pybind11;

namespace trimquad {
namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Triangles = py::array_t<int, py::array::c_style | py::array::forcecast>;

MeshFile meshOf(const Points& points, const Triangles& triangles) {
  if (points.ndim() != 2 || points.shape(1) != 3 || triangles.ndim() != 2 || triangles.shape(1) != 3)
    throw inputError("read", "points and triangles must be arrays of three columns");
  MeshFile mesh;
  const auto p = points.unchecked<2>();
  const auto t = triangles.unchecked<2>();
  for (py::ssize_t i = 0; i < p.shape(0); ++i) mesh.soup.points.emplace_back(p(i, 0), p(i, 1), p(i, 2));
  for (py::ssize_t i = 0; i < t.shape(0); ++i) {
    mesh.soup.triangles.push_back({t(i, 0), t(i, 1), t(i, 2)});
    mesh.face.push_back(int(i));
  }
  mesh.faceCount = int(t.shape(0));
  return mesh;
}

/// A mesh made an oriented manifold.
struct RepairedMesh {
  TriangleSoup soup;
  RepairReport report;

  double area() const {
    double sum = 0;
    for (const auto& [a, b, c] : soup.triangles)
      sum += 0.5 * (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]).norm();
    return sum;
  }
  double diagonal() const {
    Eigen::AlignedBox3d box;
    for (const auto& p : soup.points) box.extend(p);
    return box.diagonal().norm();
  }
};

RepairedMesh repaired(const MeshFile& mesh) {
  RepairedMesh result{mesh.soup, {}};
  result.report = repair(result.soup);
  return result;
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

FeatureOptions::Sharp sharpOf(const std::string& features) {
  if (features == "trim") return FeatureOptions::Sharp::Trim;
  return features == "align" ? FeatureOptions::Sharp::Align : FeatureOptions::Sharp::Ignore;
}

py::dict featuresOf(const Region& region) {
  using Node = FeatureGraph::Node;
  const FeatureGraph graph = featureGraph(region);
  py::dict counts;
  counts["aligned_edges"] = region.aligned.size();
  counts["curves"] = graph.curves.size();
  counts["ends"] = graph.count(Node::End);
  counts["corners"] = graph.count(Node::Corner);
  counts["junctions"] = graph.count(Node::Junction);
  counts["points"] = region.featurePoints.size();
  return counts;
}

py::array_t<double> pointsOf(const SurfaceMesh& mesh) {
  py::array_t<double> points({py::ssize_t(mesh.n_vertices()), py::ssize_t(3)});
  auto p = points.mutable_unchecked<2>();
  for (const auto v : mesh.vertices())
    for (int k = 0; k < 3; ++k) p(v.idx(), k) = mesh.point(v)[k];
  return points;
}

py::array_t<int> cornersOf(const SurfaceMesh& mesh) {
  py::array_t<int> corners({py::ssize_t(mesh.n_faces()), py::ssize_t(3)});
  auto c = corners.mutable_unchecked<2>();
  for (const auto f : mesh.faces()) {
    auto h = mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      c(f.idx(), k) = mesh.from_vertex_handle(h).idx();
  }
  return corners;
}

py::array_t<int> alignedOf(const Region& region) {
  py::array_t<int> edges({py::ssize_t(region.aligned.size()), py::ssize_t(2)});
  auto e = edges.mutable_unchecked<2>();
  for (std::size_t i = 0; i < region.aligned.size(); ++i) {
    const auto h = region.mesh.halfedge_handle(region.aligned[i], 0);
    e(i, 0) = region.mesh.from_vertex_handle(h).idx();
    e(i, 1) = region.mesh.to_vertex_handle(h).idx();
  }
  return edges;
}

py::list curvesOf(const Model& model) {
  std::vector<int> sides(model.curves.size(), 0), aligned(model.curves.size(), 0);
  for (const auto& region : model.regions) {
    for (const auto e : region.mesh.edges())
      if (const auto& curve = region.edgeCurve[e.idx()]) ++sides[curve->index];
    for (const auto e : region.aligned)
      if (const auto& curve = region.edgeCurve[e.idx()]) ++aligned[curve->index];
  }
  const auto names = pieceNames(model.curves);
  const auto place = [&](CornerId corner) {
    const auto& p = model.corners[corner.index];
    return py::make_tuple(p.x(), p.y(), p.z());
  };
  py::list curves;
  for (std::size_t c = 0; c < model.curves.size(); ++c) {
    py::dict entry;
    entry["name"] = names[c];
    entry["from"] = place(model.curves[c].start);
    entry["to"] = place(model.curves[c].end);
    entry["aligned"] = sides[c] > 0 && aligned[c] == sides[c];
    curves.append(entry);
  }
  return curves;
}

void bindRegion(py::module_& m) {
  m.def(
      "copy_region", [](const Region& region) { return region; }, py::arg("region"));
  m.def(
      "without_creases",
      [](const Region& region) {
        Region smooth = region;
        std::erase_if(smooth.aligned, [&](EdgeHandle e) { return !smooth.mesh.is_boundary(e); });
        return smooth;
      },
      py::arg("region"), "A region without the aligned edges inside it.");
  m.def(
      "place_region",
      [](Model& model, int index, const Region& region) { model.regions.at(std::size_t(index)) = region; },
      py::arg("model"), py::arg("index"), py::arg("region"), "Puts a region into the model.");
  m.def(
      "bridge_holes",
      [](Model& model, int index, double length, const Progress& progress) {
        Region& region = model.regions.at(std::size_t(index));
        Region bridged = region;
        const HoleCounts counts = bridgeHoles(bridged, length, progress);
        if (counts.bridged > 0) region = withoutBridges(bridged);
        return std::make_tuple(std::move(bridged), std::map<std::string, int>{{"bridged", counts.bridged},
                                                                              {"aligned", counts.aligned},
                                                                              {"ends", counts.ends}});
      },
      py::arg("model"), py::arg("index"), py::arg("length"), py::arg("progress"), Released(),
      "A region of the model with its holes shorter than `length` bridged, and how many boundary loops were "
      "bridged, not bridged because they are aligned, or because they are no holes. Vertices and triangles "
      "of the model's region keep their numbers.");
  py::class_<Region>(m, "Region")
      .def_readonly("name", &Region::name)
      .def_property_readonly(
          "bridge", [](const Region& region) { return region.bridge; },
          "by triangle whether it bridges a hole; empty where none does")
      .def_property_readonly("triangles", [](const Region& region) { return region.mesh.n_faces(); })
      .def_property_readonly("vertices", [](const Region& region) { return region.mesh.n_vertices(); })
      .def_property_readonly("boundary_loops",
                             [](const Region& region) { return boundaryLoops(region.mesh).size(); })
      .def_property_readonly("euler", [](const Region& region) { return eulerCharacteristic(region.mesh); })
      .def_property_readonly("area", [](const Region& region) { return surfaceArea(region.mesh); })
      .def_property_readonly("features", &featuresOf, "the object `features` of report.json")
      .def_property_readonly(
          "points", [](const Region& region) { return pointsOf(region.mesh); }, "of the vertices, (n, 3)")
      .def_property_readonly(
          "corners", [](const Region& region) { return cornersOf(region.mesh); },
          "vertex numbers of the triangles, (m, 3)")
      .def_property_readonly("aligned", &alignedOf, "vertex numbers of the aligned edges, (k, 2)")
      .def_property_readonly("feature_points", [](const Region& region) {
        std::vector<int> vertices;
        for (const auto v : region.featurePoints) vertices.push_back(v.idx());
        return vertices;
      });
}

}  // namespace

py::tuple arraysOf(const Parametrization& map) {
  py::array_t<double> images({py::ssize_t(map.mesh.n_faces()), py::ssize_t(3), py::ssize_t(2)});
  auto uv = images.mutable_unchecked<3>();
  for (const auto f : map.mesh.faces()) {
    auto h = map.mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = map.mesh.next_halfedge_handle(h)) {
      const Eigen::Vector2d x = map.scale.toQuads(map.from(h));
      uv(f.idx(), k, 0) = x.x();
      uv(f.idx(), k, 1) = x.y();
    }
  }
  return py::make_tuple(pointsOf(map.mesh), cornersOf(map.mesh), images);
}

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
      .def_readonly("kept_apart", &Model::keptApart)
      .def_property_readonly("curves", &curvesOf, "the list `curves` of report.json");
  m.def("touching_regions", &touchingRegions, py::arg("model"), py::arg("region"), Released(),
        "Numbers of the regions that have a corner in common with one, ascending.");
  py::class_<FeatureOptions>(m, "FeatureOptions")
      .def(py::init([](const std::string& features, double angle, bool alignBoundary,
                       std::vector<std::string> align, std::vector<std::string> free,
                       std::vector<std::string> vertices, std::vector<Eigen::Vector3d> points,
                       double quadLength) {
             return FeatureOptions{sharpOf(features), angle,           alignBoundary,
                                   std::move(align),  std::move(free), std::move(vertices),
                                   std::move(points), quadLength};
           }),
           py::kw_only(), py::arg("features"), py::arg("angle"), py::arg("align_boundary"), py::arg("align"),
           py::arg("free"), py::arg("vertices"), py::arg("points"), py::arg("quad_length"));
  py::class_<MeshFile>(m, "MeshFile").def_property_readonly("triangles", [](const MeshFile& mesh) {
    return mesh.soup.triangles.size();
  });
  py::class_<RepairedMesh>(m, "RepairedMesh")
      .def_property_readonly("area", &RepairedMesh::area)
      .def_property_readonly("diagonal", &RepairedMesh::diagonal)
      .def_property_readonly("repairs", [](const RepairedMesh& mesh) { return repairsOf(mesh.report); })
      .def_property_readonly("summary", [](const RepairedMesh& mesh) { return mesh.report.summary(); });
  m.def(
      "read_mesh", [](const std::string& path) { return readMesh(path); }, py::arg("path"), Released());
  m.def("mesh_from_arrays", &meshOf, py::arg("points"), py::arg("triangles"));
  m.def("repair", &repaired, py::arg("mesh"), Released());
  m.def(
      "mesh_model",
      [](const RepairedMesh& mesh, const FeatureOptions& features, const Progress& progress) {
        return meshModel(mesh.soup, {.features = features}, progress, mesh.report.triangle);
      },
      py::arg("mesh"), py::arg("features"), py::arg("progress"), Released());
}

}  // namespace trimquad
