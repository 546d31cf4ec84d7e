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
#include "trimquad/brep/creased_faces.h"
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

/// The same of a shape made from a traced one. \param image (element of that one) what it became: an edge
/// that was cut, a wire or compound of its parts
template <class Image>
Traced followed(const Traced& before, const TopoDS_Shape& after, const Image& image) {
  Traced result{after, {}, {}, {}};
  for (const auto kind : kKinds) {
    const auto own = elements(before.shape, kind), all = elements(after, kind);
    const auto imagesOf = [&](const TopoDS_Shape& element) {
      std::vector<TopoDS_Shape> parts;
      for (TopExp_Explorer part(image(element), kind); part.More(); part.Next())
        if (all.Contains(part.Current())) parts.push_back(part.Current());
      return parts;
    };
    for (int i = 1; i <= own.Extent(); ++i)
      for (const auto& part : imagesOf(own(i)))
        if (!result.number.IsBound(part) && before.number.IsBound(own(i)))
          result.number.Bind(part, before.number(own(i)));
    if (auto* const images = result.images(kind))
      for (const auto& copies : *before.images(kind)) {
        auto& named = images->emplace_back();
        for (const auto& copy : copies)
          for (const auto& part : imagesOf(copy)) named.push_back(part);
      }
  }
  return result;
}

Traced sewn(const Traced& apart, double tolerance) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(apart.shape);
  sewing.Perform();
  const TopoDS_Shape whole = sewing.SewedShape();
  if (whole.IsNull() || elements(whole, TopAbs_FACE).Extent() != elements(apart.shape, TopAbs_FACE).Extent())
    return apart;
  return followed(apart, whole,
                  [&](const TopoDS_Shape& element) { return sewing.ModifiedSubShape(element); });
}

Traced divided(const Traced& whole) {
  const DividedShape parts = dividedAtCreases(whole.shape);
  if (parts.shape.IsNull()) return whole;
  return followed(whole, parts.shape,
                  [&](const TopoDS_Shape& element) { return parts.history->Apply(element); });
}

/// \param otherwise of what is no element of the input
std::string nameOf(const TopoDS_Shape& element, const Traced& traced, const std::string& prefix,
                   const std::string& otherwise) {
  return traced.number.IsBound(element) ? prefix + std::to_string(traced.number(element)) : otherwise;
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
    entry.name = nameOf(faces(i), traced, "Face", "Face" + std::to_string(i));
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
  TopTools_IndexedDataMapOfShapeListOfShape facesOfEdge;
  TopExp::MapShapesAndAncestors(traced.shape, TopAbs_EDGE, TopAbs_FACE, facesOfEdge);
  const auto faceAt = [&](const TopoDS_Shape& edge) {
    const auto* const faces = facesOfEdge.Seek(edge);
    return faces && !faces->IsEmpty() ? nameOf(faces->First(), traced, "Face", "") : "";
  };
  for (int i = 1; i <= model.edgeNumbers.Extent(); ++i) {
    CadEdge& entry = model.edges.emplace_back();
    entry.name = nameOf(model.edgeNumbers(i), traced, "Edge", faceAt(model.edgeNumbers(i)));
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
  Traced traced = divided(copied(shape.topology(), shape.numbering()));
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
