#include "trimquad/brep/cad_model.h"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <array>
#include <numeric>

#include "trimquad/base/error.h"
#include "trimquad/brep/occt_parts.h"

namespace trimquad {
namespace {

/// Groups of faces that hang together through shared edges.
int connectedGroups(const TopoDS_Shape& shape) {
  const auto faces = elements(shape, TopAbs_FACE);
  TopTools_IndexedDataMapOfShapeListOfShape facesOfEdge;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, facesOfEdge);
  std::vector<int> parent(faces.Extent() + 1);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  int groups = faces.Extent();
  for (int e = 1; e <= facesOfEdge.Extent(); ++e) {
    if (facesOfEdge(e).IsEmpty()) continue;
    const int first = root(faces.FindIndex(facesOfEdge(e).First()));
    for (const TopoDS_Shape& face : facesOfEdge(e))
      if (const int other = root(faces.FindIndex(face)); other != root(first))
        parent[other] = root(first), --groups;
  }
  return groups;
}

/// A copy of a shape, and what became of the original's vertices, edges and faces in it.
struct Traced {
  TopoDS_Shape shape;
  TopTools_DataMapOfShapeInteger number;                ///< of the original, by element of the copy; from 1
  std::vector<std::vector<TopoDS_Shape>> edge, vertex;  ///< by number of the original, from 0: in the copy

  std::vector<std::vector<TopoDS_Shape>>* images(TopAbs_ShapeEnum kind) {
    return kind == TopAbs_EDGE ? &edge : kind == TopAbs_VERTEX ? &vertex : nullptr;
  }
  const std::vector<std::vector<TopoDS_Shape>>* images(TopAbs_ShapeEnum kind) const {
    return kind == TopAbs_EDGE ? &edge : kind == TopAbs_VERTEX ? &vertex : nullptr;
  }
};

constexpr std::array kKinds{TopAbs_VERTEX, TopAbs_EDGE, TopAbs_FACE};

template <class Image>
void trace(const TopoDS_Shape& from, const TopoDS_Shape& numbering, Image&& image, Traced& to) {
  for (const auto kind : kKinds) {
    const auto named = elements(numbering, kind), used = elements(from, kind);
    auto* const images = to.images(kind);
    if (images) images->resize(named.Extent());
    for (int i = 1; i <= named.Extent(); ++i) {
      if (!used.Contains(named(i))) continue;
      const TopoDS_Shape copy = image(used(used.FindIndex(named(i))));
      if (copy.IsNull()) continue;
      if (!to.number.IsBound(copy)) to.number.Bind(copy, i);
      if (images) (*images)[i - 1].push_back(copy);
    }
  }
}

Traced copied(const TopoDS_Shape& shape, const TopoDS_Shape& numbering) {
  BRepBuilderAPI_Copy copy(shape, false, false);
  Traced result{copy.Shape(), {}, {}, {}};
  trace(
      shape, numbering, [&](const TopoDS_Shape& s) { return copy.ModifiedShape(s); }, result);
  return result;
}

Traced sewn(const Traced& apart, double tolerance) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(apart.shape);
  sewing.Perform();
  Traced result{sewing.SewedShape(), {}, {}, {}};
  if (result.shape.IsNull() ||
      elements(result.shape, TopAbs_FACE).Extent() != elements(apart.shape, TopAbs_FACE).Extent())
    return apart;
  for (const auto kind : kKinds) {
    const auto before = elements(apart.shape, kind), after = elements(result.shape, kind);
    // An edge that sewing cut into sections answers with a wire or compound of them.
    const auto imagesOf = [&](const TopoDS_Shape& element) {
      std::vector<TopoDS_Shape> images;
      for (TopExp_Explorer part(sewing.ModifiedSubShape(element), kind); part.More(); part.Next())
        if (after.Contains(part.Current())) images.push_back(part.Current());
      return images;
    };
    for (int i = 1; i <= before.Extent(); ++i)
      for (const auto& image : imagesOf(before(i)))
        if (!result.number.IsBound(image) && apart.number.IsBound(before(i)))
          result.number.Bind(image, apart.number(before(i)));
    if (auto* const images = result.images(kind))
      for (const auto& copies : *apart.images(kind)) {
        auto& named = images->emplace_back();
        for (const auto& copy : copies)
          for (const auto& image : imagesOf(copy)) named.push_back(image);
      }
  }
  return result;
}

std::string nameOf(const TopoDS_Shape& element, const Traced& traced, const std::string& prefix,
                   int fallback) {
  return prefix + std::to_string(traced.number.IsBound(element) ? traced.number(element) : fallback);
}

void collectFaces(const Traced& traced, CadModel& model) {
  const auto faces = elements(traced.shape, TopAbs_FACE);
  TopTools_DataMapOfShapeInteger solidOfFace;
  const auto solids = elements(traced.shape, TopAbs_SOLID);
  for (int s = 1; s <= solids.Extent(); ++s)
    for (TopExp_Explorer face(solids(s), TopAbs_FACE); face.More(); face.Next())
      if (!solidOfFace.IsBound(face.Current())) solidOfFace.Bind(face.Current(), s - 1);
  for (int i = 1; i <= faces.Extent(); ++i) {
    CadFace& entry = model.faces.emplace_back();
    entry.name = nameOf(faces(i), traced, "Face", i);
    entry.face = TopoDS::Face(faces(i).Oriented(TopAbs_FORWARD));
    entry.surface = BRep_Tool::Surface(entry.face);
    if (entry.surface.IsNull())
      throw inputError("tessellate", "a face has no surface; repair the shape", entry.name);
    entry.reversed = faces(i).Orientation() == TopAbs_REVERSED;
    if (solidOfFace.IsBound(faces(i))) entry.solid = solidOfFace(faces(i));
  }
}

std::vector<std::vector<int>> indices(const std::vector<std::vector<TopoDS_Shape>>& images,
                                      const TopTools_IndexedMapOfShape& elements) {
  std::vector<std::vector<int>> result;
  for (const auto& copies : images) {
    auto& named = result.emplace_back();
    for (const auto& copy : copies)
      if (elements.Contains(copy)) named.push_back(elements.FindIndex(copy) - 1);
  }
  return result;
}

void collectEdges(const Traced& traced, CadModel& model) {
  const auto vertices = elements(traced.shape, TopAbs_VERTEX);
  for (int i = 1; i <= vertices.Extent(); ++i) {
    const gp_Pnt p = BRep_Tool::Pnt(TopoDS::Vertex(vertices(i)));
    model.vertices.emplace_back(p.X(), p.Y(), p.Z());
  }
  model.edgeNumbers = elements(traced.shape, TopAbs_EDGE);
  for (int i = 1; i <= model.edgeNumbers.Extent(); ++i) {
    CadEdge& entry = model.edges.emplace_back();
    entry.name = nameOf(model.edgeNumbers(i), traced, "Edge", i);
    entry.edge = TopoDS::Edge(model.edgeNumbers(i).Oriented(TopAbs_FORWARD));
    entry.degenerate = BRep_Tool::Degenerated(entry.edge);
    const TopoDS_Vertex start = TopExp::FirstVertex(entry.edge), end = TopExp::LastVertex(entry.edge);
    if (start.IsNull() || end.IsNull())
      throw inputError("tessellate", "an edge has no end; repair the shape", entry.name);
    entry.start = vertices.FindIndex(start) - 1;
    entry.end = vertices.FindIndex(end) - 1;
  }
  model.edgesNamed = indices(traced.edge, model.edgeNumbers);
  model.verticesNamed = indices(traced.vertex, vertices);
}

}  // namespace

CadModel cadModel(const Shape& shape, double gap) {
  Traced traced = copied(shape.topology(), shape.numbering());
  CadModel model;
  model.sewn =
      gap > 0 && shape.solidCount() == 0 && shape.faceCount() > 1 && connectedGroups(traced.shape) > 1;
  if (model.sewn) traced = sewn(traced, gap * shape.diagonal());
  model.shape = traced.shape;
  collectFaces(traced, model);
  collectEdges(traced, model);
  return model;
}

}  // namespace trimquad
