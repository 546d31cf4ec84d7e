#include "trimquad/brep/creased_faces.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <ShapeExtend.hxx>
#include <ShapeUpgrade_FaceDivide.hxx>
#include <ShapeUpgrade_ShapeDivide.hxx>
#include <ShapeUpgrade_SplitSurface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HSequenceOfReal.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "trimquad/brep/occt_parts.h"

namespace trimquad {
namespace {

/// Smallest angle of a crease, radians. A single surface rounds a slighter one within the tolerance with
/// fewer poles than two that meet in it.
constexpr double kSmallestCrease = 10 * std::numbers::pi / 180;
/// Places along a line where its angle is measured, and how far from it, by the range of the parameter:
/// twice, since across a crease the angle does not depend on it.
constexpr int kPlaces = 16;
constexpr double kAside[] = {1e-6, 1e-7};

struct Range {
  double first, last;
  double at(double part) const { return first + part * (last - first); }
};

/// Parameters between the ends of the range where a surface has creases, in one of its directions.
std::vector<double> creases(const Handle(Geom_Surface) & surface, const Range& u, const Range& v,
                            bool alongU) {
  const GeomAdaptor_Surface adaptor(surface, u.first, u.last, v.first, v.last);
  const int intervals = alongU ? adaptor.NbUIntervals(GeomAbs_C1) : adaptor.NbVIntervals(GeomAbs_C1);
  TColStd_Array1OfReal ends(1, intervals + 1);
  if (alongU)
    adaptor.UIntervals(ends, GeomAbs_C1);
  else
    adaptor.VIntervals(ends, GeomAbs_C1);
  const Range &across = alongU ? u : v, &along = alongU ? v : u;
  const auto normal = [&](double x, double y) {
    gp_Pnt p;
    gp_Vec du, dv;
    surface->D1(alongU ? x : y, alongU ? y : x, p, du, dv);
    return du.Crossed(dv);
  };
  const auto bends = [&](double x, double y) {
    return std::all_of(std::begin(kAside), std::end(kAside), [&](double part) {
      const double aside = part * (across.last - across.first);
      const gp_Vec before = normal(x - aside, y), after = normal(x + aside, y);
      const double product = before.Magnitude() * after.Magnitude();
      return product > 0 && before.Dot(after) < std::cos(kSmallestCrease) * product;
    });
  };
  std::vector<double> result;
  for (int i = 2; i <= intervals; ++i) {
    bool creased = false;
    for (int k = 0; k < kPlaces && !creased; ++k) creased = bends(ends(i), along.at((k + 0.5) / kPlaces));
    if (creased) result.push_back(ends(i));
  }
  return result;
}

std::vector<double> creases(const TopoDS_Face& face, bool alongU) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  if (surface.IsNull()) return {};
  Range u, v;
  BRepTools::UVBounds(face, u.first, u.last, v.first, v.last);
  return creases(surface, u, v, alongU);
}

/// Splits a face's surface at its creases.
class SplitAtCreases : public ShapeUpgrade_SplitSurface {
 public:
  void Compute(const Standard_Boolean) override {
    const Range u{myUSplitValues->First(), myUSplitValues->Last()},
        v{myVSplitValues->First(), myVSplitValues->Last()};
    for (const bool alongU : {true, false}) {
      const auto& values = alongU ? myUSplitValues : myVSplitValues;
      for (const double x : creases(mySurface, u, v, alongU)) {
        values->InsertBefore(values->Length(), x);
        myStatus |= ShapeExtend::EncodeStatus(ShapeExtend_DONE1);
      }
    }
  }
};

}  // namespace

DividedShape dividedAtCreases(const TopoDS_Shape& shape) {
  const auto faces = elements(shape, TopAbs_FACE);
  const auto isCreased = [](const TopoDS_Shape& s) {
    const TopoDS_Face face = TopoDS::Face(s);
    return !creases(face, true).empty() || !creases(face, false).empty();
  };
  if (std::none_of(faces.cbegin(), faces.cend(), isCreased)) return {};
  const Handle(ShapeUpgrade_FaceDivide) divideFace = new ShapeUpgrade_FaceDivide;
  divideFace->SetSplitSurfaceTool(new SplitAtCreases);
  ShapeUpgrade_ShapeDivide divide(shape);
  divide.SetSplitFaceTool(divideFace);
  if (!divide.Perform() || divide.Status(ShapeExtend_FAIL) || divide.Result().IsNull()) return {};
  if (BRepCheck_Analyzer(shape).IsValid() && !BRepCheck_Analyzer(divide.Result()).IsValid()) return {};
  return {divide.Result(), divide.GetContext()};
}

}  // namespace trimquad
