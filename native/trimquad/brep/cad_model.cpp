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
#include <numeric>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Gaps up to this share of the diagonal are closed by sewing.
constexpr double kSewingTolerance = 1e-5;

TopTools_IndexedMapOfShape elements(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  return map;
}

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

/// A copy of a shape, and what became of the original's edges and faces in it.
struct Traced {
  TopoDS_Shape shape;
  TopTools_DataMapOfShapeInteger number;  ///< of the original, by element of the copy; from 1
};

template <class Image>
void trace(const TopoDS_Shape& from, const TopoDS_Shape& numbering, Image&& image, Traced& to) {
  for (const auto kind : {TopAbs_EDGE, TopAbs_FACE}) {
    const auto named = elements(numbering, kind), used = elements(from, kind);
    for (int i = 1; i <= named.Extent(); ++i) {
      if (!used.Contains(named(i))) continue;
      const TopoDS_Shape copy = image(used(used.FindIndex(named(i))));
      if (!copy.IsNull() && !to.number.IsBound(copy)) to.number.Bind(copy, i);
    }
  }
}

Traced copied(const TopoDS_Shape& shape, const TopoDS_Shape& numbering) {
  BRepBuilderAPI_Copy copy(shape, false, false);
  Traced result{copy.Shape(), {}};
  trace(
      shape, numbering, [&](const TopoDS_Shape& s) { return copy.ModifiedShape(s); }, result);
  return result;
}

Traced sewn(const Traced& apart, double diagonal) {
  BRepBuilderAPI_Sewing sewing(kSewingTolerance * diagonal);
  sewing.Add(apart.shape);
  sewing.Perform();
  Traced result{sewing.SewedShape(), {}};
  if (result.shape.IsNull() ||
      elements(result.shape, TopAbs_FACE).Extent() != elements(apart.shape, TopAbs_FACE).Extent())
    return apart;
  for (const auto kind : {TopAbs_EDGE, TopAbs_FACE}) {
    const auto before = elements(apart.shape, kind), after = elements(result.shape, kind);
    for (int i = 1; i <= before.Extent(); ++i) {
      const TopoDS_Shape image = sewing.ModifiedSubShape(before(i));
      // An edge that sewing cut into sections answers with a wire or compound of them.
      for (TopExp_Explorer part(image, kind); part.More(); part.Next())
        if (after.Contains(part.Current()) && !result.number.IsBound(part.Current()))
          result.number.Bind(part.Current(), apart.number(before(i)));
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
}

}  // namespace

CadModel cadModel(const Shape& shape) {
  Traced traced = copied(shape.topology(), shape.numbering());
  if (shape.solidCount() == 0 && shape.faceCount() > 1 && connectedGroups(traced.shape) > 1)
    traced = sewn(traced, shape.diagonal());
  CadModel model;
  model.shape = traced.shape;
  collectFaces(traced, model);
  collectEdges(traced, model);
  return model;
}

}  // namespace trimquad
