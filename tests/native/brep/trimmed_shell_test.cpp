// A sheet of several patches with T-joints, trimmed by a free outline and a hole, as CAD systems are to take
// it: lengths are millimetres, the sheet is six metres wide.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numbers>

// Before OpenCASCADE, whose macro Handle() breaks OpenMesh.
#include "support/analytic_region.h"
#include "support/fit_figures.h"
#include "support/grid_maps.h"
#include "support/sample_maps.h"
#include "trimquad/mesh/polyline_curve.h"
#include "trimquad/spline/trim_model.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_FreeBounds.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>

#include "trimquad/brep/assemble.h"
#include "trimquad/brep/shape.h"

namespace trimquad {
namespace {

constexpr double kMetre = 1000;

Eigen::Vector3d wave(double x, double y) {
  const double a = x / kMetre, b = y / kMetre;
  return {kMetre * std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), -std::sin(a) * std::sin(b)};
}

/// A star with a hole in it over 24 x 24 quads of z = sin x cos y, its boundary zigzagging by `teeth` quads.
GridMap star(double teeth) {
  constexpr int around = 120, rings = 24;
  samples::MappedSoup mapped;
  const auto at = [&](int i, int j) -> Eigen::Vector2d {
    const double a = 2 * std::numbers::pi * j / around, inner = 2.3, outer = 10.2 + 1.3 * std::cos(3 * a);
    const double zigzag = i == 0 || i == rings ? (j % 2 ? teeth : -teeth) : 0;
    return (zigzag + inner + (outer - inner) * i / rings) * Eigen::Vector2d(std::cos(a), std::sin(a));
  };
  const auto vertex = [&](int i, int j) { return i * around + j % around; };
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const Eigen::Vector2d p = at(i, j) * kMetre / 4;
      mapped.soup.points.push_back({p[0], p[1], wave(p[0], p[1])[0]});
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      mapped.add({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)},
                 {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mapped.add({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)},
                 {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return samples::gridMapOf(mapped, 30);
}

struct Trimmed {
  FittedSurface fitted;
  test::FitFigures figures;
  SplineModel model;
  std::vector<PolylineCurve> boundary;  ///< of the mesh
};

/// Parameter of the polyline's vertex nearest to a point.
double nearest(const PolylineCurve& polyline, const Eigen::Vector3d& p) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < polyline.points().size(); ++i)
    if ((polyline.points()[i] - p).norm() < (polyline.points()[best] - p).norm()) best = i;
  return polyline.parameters()[best];
}

Trimmed trimmedStar(double tolerance = 3e-4 * kMetre, double teeth = 0) {
  const GridMap flat = star(teeth);
  Model model = meshModel(sample::soupOf(flat.mesh), {}, Progress());
  model.regions[0].surface = std::make_shared<GraphSurface>(wave);
  const GridMap map = sample::mapOn(model.regions[0], flat);
  Trimmed result;
  for (const auto& curve : model.curves)
    result.boundary.push_back(dynamic_cast<const PolylineCurve&>(*curve.curve));
  result.fitted = fitSurface(model.regions[0], map,
                             {.tolerance = tolerance, .bisections = {{0}, {0}, {2}, {2}}}, Progress());
  result.figures = test::figures(result.fitted, model.regions[0], map);
  result.model = trimModel(model, {&map}, {&result.fitted}, {tolerance}, Progress());
  return result;
}

double largestTolerance(const TopoDS_Shape& shape) {
  double tolerance = 0;
  TopTools_IndexedMapOfShape edges, vertices;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
  for (int i = 1; i <= edges.Extent(); ++i)
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Edge(edges(i))));
  for (int i = 1; i <= vertices.Extent(); ++i)
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Vertex(vertices(i))));
  return tolerance;
}

/// Closed wires of free edges; none may be open.
int freeWires(const TopoDS_Shape& shape) {
  const ShapeAnalysis_FreeBounds bounds(shape);
  TopTools_IndexedMapOfShape closed, open;
  if (!bounds.GetClosedWires().IsNull()) TopExp::MapShapes(bounds.GetClosedWires(), TopAbs_WIRE, closed);
  if (!bounds.GetOpenWires().IsNull()) TopExp::MapShapes(bounds.GetOpenWires(), TopAbs_WIRE, open);
  EXPECT_EQ(open.Extent(), 0);
  return closed.Extent();
}

TEST(TrimmedShell, starOfSeveralPatchesIsWatertightBeforeAndAfterStep) {
  const auto star = trimmedStar();
  EXPECT_GE(star.model.faces.size(), 4u);
  EXPECT_LE(star.figures.max, 3e-4 * kMetre);
  EXPECT_LE(star.figures.regularJump, 1e-3);
  double gap = 0;
  for (const auto& border : star.fitted.layout->borders)
    for (double s = 0; s <= 1; s += 1.0 / 256) {
      Eigen::Vector3d p[2];
      for (const int side : {0, 1}) {
        const Eigen::Vector2d x = border.start[side] + s * (border.end[side] - border.start[side]);
        p[side] = star.fitted.surfaces[border.chart[side]].point(x[0], x[1]);
      }
      gap = std::max(gap, (p[0] - p[1]).norm());
    }
  EXPECT_LE(gap, 1e-9);

  const Shape shape = assemble(star.model);
  const auto path =
      (std::filesystem::temp_directory_path() / ("trimquad_shell_" + std::to_string(::getpid()) + ".step"))
          .string();
  writeStep(shape, path);
  const Shape read = readShape(path);
  std::filesystem::remove(path);
  for (const Shape* s : {&shape, &read}) {
    EXPECT_EQ(faults(*s), std::vector<std::string>{});
    EXPECT_LE(largestTolerance(s->topology()), 1.001e-7);
    EXPECT_EQ(freeWires(s->topology()), 2);
    EXPECT_EQ(s->faceCount(), int(star.model.faces.size()));
  }
}

TEST(TrimmedShell, aJaggedOutlineIsSmoothedWithinTheTolerance) {
  const double tolerance = 4, teeth = 0.006;  // millimetres; quads of 250 mm
  const auto star = trimmedStar(tolerance, teeth);
  std::vector<int> uses(star.model.edges.size(), 0);
  for (const auto& face : star.model.faces)
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) ++uses[coedge.edge.index];
  std::size_t spans = 0;
  double farthest = 0;
  for (const auto& face : star.model.faces)
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) {
        if (uses[coedge.edge.index] != 1) continue;
        spans += coedge.curve.poles.size() - coedge.curve.degree;
        const auto& curve = star.model.edges[coedge.edge.index].curve;
        for (int i = 0; i <= 200; ++i) {
          const Eigen::Vector3d p = curve.point(curve.first() + (curve.last() - curve.first()) * i / 200);
          double off = HUGE_VAL;
          for (const auto& polyline : star.boundary)
            off = std::min(off, (polyline.point(polyline.closest(p, nearest(polyline, p))) - p).norm());
          farthest = std::max(farthest, off);
        }
      }
  EXPECT_LE(farthest, tolerance);
  EXPECT_LE(spans, 100u);  // of 240 mesh edges
}

TEST(TrimmedShell, starBecomesAThickSolid) {
  const auto star = trimmedStar();
  const Shape shape = assemble(star.model);
  BRepOffsetAPI_MakeThickSolid thick;
  thick.MakeThickSolidBySimple(shape.topology(), 60);
  ASSERT_TRUE(thick.IsDone());
  const TopoDS_Shape solid = thick.Shape();
  EXPECT_TRUE(TopExp_Explorer(solid, TopAbs_SOLID).More());
  EXPECT_TRUE(BRepCheck_Analyzer(solid).IsValid());
  EXPECT_EQ(freeWires(solid), 0);
  EXPECT_LE(largestTolerance(solid), 1e-3);
}

}  // namespace
}  // namespace trimquad
