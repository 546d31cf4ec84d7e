#include "trimquad/brep/assemble.h"

#include <BRepClass3d_SolidClassifier.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <map>

#include "trimquad/brep/occt_guard.h"
#include "trimquad/brep/occt_parts.h"

namespace trimquad {
namespace {

constexpr double kTolerance = 1e-7;

/// Flat knots as OpenCASCADE wants them: each once, with its multiplicity.
struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;

  explicit Knots(const std::vector<double>& flat)
      : values(1, distinct(flat)), multiplicities(1, distinct(flat)) {
    int k = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
      if (i == 0 || flat[i] != flat[i - 1]) {
        values(++k) = flat[i];
        multiplicities(k) = 0;
      }
      ++multiplicities(k);
    }
  }

 private:
  static int distinct(const std::vector<double>& flat) {
    int count = 1;
    for (std::size_t i = 1; i < flat.size(); ++i) count += flat[i] != flat[i - 1];
    return count;
  }
};

gp_Pnt toPoint(const Eigen::Vector3d& p) {
  return {p[0], p[1], p[2]};
}

Handle(Geom_BSplineCurve) toOcct(const SpaceCurve& curve) {
  const Knots knots(curve.knots);
  TColgp_Array1OfPnt poles(1, int(curve.poles.size()));
  for (int i = 0; i < int(curve.poles.size()); ++i) poles(i + 1) = toPoint(curve.poles[i]);
  return new Geom_BSplineCurve(poles, knots.values, knots.multiplicities, curve.degree);
}

Handle(Geom2d_BSplineCurve) toOcct(const PlaneCurve& curve) {
  const Knots knots(curve.knots);
  TColgp_Array1OfPnt2d poles(1, int(curve.poles.size()));
  for (int i = 0; i < int(curve.poles.size()); ++i)
    poles(i + 1) = gp_Pnt2d(curve.poles[i][0], curve.poles[i][1]);
  return new Geom2d_BSplineCurve(poles, knots.values, knots.multiplicities, curve.degree);
}

Handle(Geom_BSplineSurface) toOcct(const SplineSurface& surface) {
  const Knots u(surface.knotsU), v(surface.knotsV);
  TColgp_Array2OfPnt poles(1, surface.countU, 1, surface.countV);
  for (int j = 0; j < surface.countV; ++j)
    for (int i = 0; i < surface.countU; ++i) poles(i + 1, j + 1) = toPoint(surface.pole(i, j));
  return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities,
                                 surface.degreeU, surface.degreeV);
}

class Assembly {
 public:
  explicit Assembly(const SplineModel& model) : model_(model) {
    for (const auto& vertex : model.vertices)
      builder_.MakeVertex(vertices_.emplace_back(), toPoint(vertex.point),
                          std::max(kTolerance, vertex.tolerance));
    for (const auto& edge : model.edges) addEdge(edge);
    for (const auto& face : model.faces) addFace(face);
  }

  TopoDS_Shape shape() const {
    std::vector<TopoDS_Shape> parts;
    std::map<int, TopoDS_Solid> solids;
    for (const auto& shell : model_.shells) {
      TopoDS_Shell whole;
      builder_.MakeShell(whole);
      for (const int face : shell.faces) builder_.Add(whole, faces_[face]);
      whole.Closed(BRep_Tool::IsClosed(whole));
      if (!shell.solid) {
        parts.push_back(whole);
        continue;
      }
      auto [solid, isNew] = solids.try_emplace(*shell.solid);
      if (isNew) builder_.MakeSolid(solid->second);
      builder_.Add(solid->second, whole);
    }
    for (const auto& [id, solid] : solids) parts.push_back(outward(solid));
    if (parts.size() == 1) return parts.front();
    TopoDS_Compound compound;
    builder_.MakeCompound(compound);
    for (const auto& part : parts) builder_.Add(compound, part);
    return compound;
  }

  const std::vector<TopoDS_Face>& faces() const { return faces_; }

 private:
  void addEdge(const SplineEdge& edge) {
    const auto curve = toOcct(edge.curve);
    TopoDS_Edge& result = edges_.emplace_back();
    builder_.MakeEdge(result, curve, std::max(kTolerance, edge.tolerance));
    builder_.Add(result, vertices_[edge.start.index].Oriented(TopAbs_FORWARD));
    builder_.Add(result, vertices_[edge.end.index].Oriented(TopAbs_REVERSED));
    builder_.Range(result, curve->FirstParameter(), curve->LastParameter());
  }

  void addFace(const SplineFace& face) {
    TopoDS_Face& result = faces_.emplace_back();
    builder_.MakeFace(result, toOcct(face.surface), kTolerance);
    // By edge: the curves of its forward and its reversed use; a seam has both.
    struct Uses {
      Handle(Geom2d_BSplineCurve) forward, reversed;
    };
    std::map<int, Uses> uses;
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) {
        auto& use = uses[coedge.edge.index];
        (coedge.forward ? use.forward : use.reversed) = toOcct(coedge.curve);
      }
    for (const auto& [index, use] : uses) {
      const double tolerance = std::max(kTolerance, model_.edges[index].tolerance);
      if (!use.forward.IsNull() && !use.reversed.IsNull())
        builder_.UpdateEdge(edges_[index], use.forward, use.reversed, result, tolerance);
      else
        builder_.UpdateEdge(edges_[index], use.forward.IsNull() ? use.reversed : use.forward, result,
                            tolerance);
    }
    for (const auto& loop : face.loops) {
      TopoDS_Wire wire;
      builder_.MakeWire(wire);
      for (const auto& coedge : loop)
        builder_.Add(wire,
                     edges_[coedge.edge.index].Oriented(coedge.forward ? TopAbs_FORWARD : TopAbs_REVERSED));
      wire.Closed(true);
      builder_.Add(result, wire);
    }
  }

  /// Shells of a solid enclose it when the far point lies outside.
  TopoDS_Shape outward(const TopoDS_Solid& solid) const {
    BRepClass3d_SolidClassifier classifier(solid);
    classifier.PerformInfinitePoint(kTolerance);
    return classifier.State() == TopAbs_IN ? solid.Complemented() : TopoDS_Shape(solid);
  }

  const SplineModel& model_;
  BRep_Builder builder_;
  std::vector<TopoDS_Vertex> vertices_;
  std::vector<TopoDS_Edge> edges_;
  std::vector<TopoDS_Face> faces_;
};

}  // namespace

Shape assemble(const SplineModel& model) {
  return guarded(Error::Kind::Stage, "write", "the trimmed surfaces make no shape",
                 [&] { return Shape(Assembly(model).shape()); });
}

std::vector<Shape> assembledFaces(const SplineModel& model) {
  return guarded(Error::Kind::Stage, "write", "the trimmed surfaces make no shape", [&] {
    const Assembly assembly(model);
    return std::vector<Shape>(assembly.faces().begin(), assembly.faces().end());
  });
}

std::vector<int> faceOrder(const SplineModel& model) {
  return guarded(Error::Kind::Stage, "write", "the trimmed surfaces make no shape", [&] {
    const Assembly assembly(model);
    const auto counted = elements(assembly.shape(), TopAbs_FACE);
    std::vector<int> order(counted.Extent());
    for (int f = 0; f < int(assembly.faces().size()); ++f)
      if (const int place = counted.FindIndex(assembly.faces()[f])) order[place - 1] = f;
    return order;
  });
}

}  // namespace trimquad
