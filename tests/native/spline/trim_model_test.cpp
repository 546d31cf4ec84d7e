#include "trimquad/spline/trim_model.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>

#include "support/trim_samples.h"
#include "trimquad/base/error.h"
#include "trimquad/spline/trim_loops.h"

namespace trimquad {
namespace {

using namespace test;

/// What holds for every trimmed model whose surfaces are not tangent to each other.
void expectExact(const SplineModel& model) {
  const auto gaps = measuredGaps(model);
  EXPECT_LE(gaps.edge, 5e-8);
  EXPECT_LE(gaps.vertex, 1e-7);
  EXPECT_LE(gaps.edgeTolerance, 1e-7);
  EXPECT_LE(gaps.vertexTolerance, 1e-7);
  EXPECT_EQ(model.looseEdges, 0);
  for (const auto& face : model.faces) {
    EXPECT_FALSE(loopCrossing(face));
    for (const auto& loop : face.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const auto &coedge = loop[k], &next = loop[(k + 1) % loop.size()];
        const auto end = coedge.forward ? coedge.curve.poles.back() : coedge.curve.poles.front();
        const auto start = next.forward ? next.curve.poles.front() : next.curve.poles.back();
        EXPECT_LE((end - start).norm(), 1e-9) << "edges of a loop end apart";
      }
  }
  for (const auto& edge : model.edges) {
    EXPECT_NE(edge.start, edge.end);
    for (std::size_t i = edge.curve.degree + 1; i + edge.curve.degree + 1 < edge.curve.knots.size(); ++i)
      EXPECT_GT(edge.curve.knots[i + edge.curve.degree - 2], edge.curve.knots[i]) << "not C2";
  }
}

std::size_t coedges(const SplineModel& model) {
  std::size_t count = 0;
  for (const auto& face : model.faces)
    for (const auto& loop : face.loops) count += loop.size();
  return count;
}

TEST(TrimModel, rectangleHasFourExactEdges) {
  const auto model = rectangleSheet().trim();
  expectExact(model);
  EXPECT_EQ(model.faces.size(), 1u);
  EXPECT_EQ(model.edges.size(), 4u);
  EXPECT_EQ(model.vertices.size(), 4u);
}

TEST(TrimModel, facesKeepOnlyTheKnotSpansThatTheirLoopsReach) {
  auto sheet = rectangleSheet();  // [0, 10] x [0, 6] of [-1, 11] x [-1, 7] with knots at every half
  const auto& whole = sheet.fits[0]->surface;
  const auto model = sheet.trim();
  const auto& part = model.faces[0].surface;
  EXPECT_GE(part.firstU(), -0.5);
  EXPECT_LE(part.lastU(), 10.5);
  EXPECT_GE(part.firstV(), -0.5);
  EXPECT_LE(part.lastV(), 6.5);
  EXPECT_LT(part.poles.size(), whole.poles.size());
  for (const double u : {0.0, 0.3, 4.7, 10.0})
    for (const double v : {0.0, 2.2, 6.0}) EXPECT_LT((part.point(u, v) - whole.point(u, v)).norm(), 1e-13);
  for (const auto& loop : model.faces[0].loops)
    for (const auto& coedge : loop)
      for (const auto& pole : coedge.curve.poles) {
        EXPECT_GE(pole[0], part.firstU() - 1e-9);
        EXPECT_LE(pole[0], part.lastU() + 1e-9);
        EXPECT_GE(pole[1], part.firstV() - 1e-9);
        EXPECT_LE(pole[1], part.lastV() + 1e-9);
      }
}

TEST(TrimModel, roundSheetHasItsHoles) {
  const auto model = roundSheet().trim();
  expectExact(model);
  ASSERT_EQ(model.faces.size(), 1u);
  EXPECT_EQ(model.faces[0].loops.size(), 4u);
  EXPECT_EQ(model.edges.size(), 8u);
  for (const auto& edge : model.edges) EXPECT_LT(edge.curve.poles.size(), 400u);
}

TEST(TrimModel, tubeIsCutOnceAlongItsSeam) {
  const auto model = tube({}).trim();
  expectExact(model);
  ASSERT_EQ(model.faces.size(), 1u);
  EXPECT_EQ(model.faces[0].loops.size(), 1u);
  EXPECT_EQ(model.edges.size(), 5u);
  EXPECT_EQ(coedges(model), 6u);
}

TEST(TrimModel, seamKeepsClearOfHoles) {
  const auto model = tube({{0.3, 5}, {9, 4}}).trim();
  expectExact(model);
  ASSERT_EQ(model.faces.size(), 1u);
  EXPECT_EQ(model.faces[0].loops.size(), 3u);
  EXPECT_EQ(model.edges.size(), 9u);
}

TEST(TrimModel, seamThatNothingAvoidsIsCutAtTheHoles) {
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < 12; ++i) ring.emplace_back(2 * i + 0.4, i % 2 ? 3.5 : 6);
  const auto model = tube(ring, 1.3).trim();
  expectExact(model);
  ASSERT_EQ(model.faces.size(), 1u);
  std::map<int, int> uses;
  for (const auto& loop : model.faces[0].loops)
    for (const auto& coedge : loop) ++uses[coedge.edge.index];
  int seams = 0;
  for (const auto& [edge, count] : uses) seams += count == 2;
  EXPECT_GE(seams, 2);
  EXPECT_EQ(uses.size(), model.edges.size());
}

TEST(TrimModel, boxOfPlanesIsClosed) {
  const auto model = bulgedBox(0).trim();
  expectExact(model);
  EXPECT_EQ(model.faces.size(), 6u);
  EXPECT_EQ(model.edges.size(), 12u);
  EXPECT_EQ(model.vertices.size(), 8u);
  EXPECT_EQ(coedges(model), 24u);
  ASSERT_EQ(model.shells.size(), 1u);
  EXPECT_EQ(model.shells[0].solid, 0);
}

TEST(TrimModel, cornersOfASheetThatTurnsBackAreWhereItsBoundaryComesToThem) {
  TrimCase c = bulgedBox(0);
  c.tolerance = 0.05;
  // The top goes on a little beyond one of the walls and comes back above itself; the map has the boundary on
  // the way back.
  constexpr double turns = 4.8, reach = 0.3, back = 5.5236;
  FittedSurface& top = *c.fits[5];
  top.surface = interpolated(
      [=](double u, double v) {
        const double x = u < turns ? u : turns + reach * std::sin((u - turns) / reach);
        return Eigen::Vector3d(x, v, u < turns ? 3 : 3 + 0.05 * std::pow(u - turns, 2));
      },
      -7, 5.7, 240, -6, 6, 20);
  for (FixedVector& x : top.chart.corner)
    if (top.chart.scale.toQuads(x.u) > 4.99) x.u = top.chart.scale.round(back);
  const auto model = c.trim();
  expectExact(model);
  for (const auto& vertex : model.vertices)
    EXPECT_LE((vertex.point.cwiseAbs() - Eigen::Vector3d(5, 4, 3)).norm(), 0.01);
}

TEST(TrimModel, curvedSheetsMeetInTheirIntersections) {
  const auto model = bulgedBox(0.8).trim();
  expectExact(model);
  EXPECT_EQ(model.edges.size(), 12u);
  EXPECT_EQ(model.vertices.size(), 8u);
}

TEST(TrimModel, twoCurvedSheetsShareOneEdge) {
  const auto model = bulgedBox(0.8, {1, 5}).trim();
  expectExact(model);
  EXPECT_EQ(model.edges.size(), 7u);
  EXPECT_EQ(model.vertices.size(), 6u);
  EXPECT_FALSE(model.shells[0].solid);
}

/// Sine of the angle between a model's two faces near a point.
double angleAt(const SplineModel& model, const Eigen::Vector3d& p, const Eigen::Vector2d& guess) {
  std::vector<Eigen::Vector3d> normals;
  for (const auto& face : model.faces) {
    const Eigen::Vector2d foot = face.surface.footPoint(p, guess);
    const auto jet = face.surface.jet(foot[0], foot[1]);
    normals.push_back(jet.su.cross(jet.sv).normalized());
  }
  return normals[0].cross(normals[1]).norm();
}

/// Apart by up to 4e-4, now above and now below.
double slowlyVarying(double x, double y) {
  return 2e-4 * (std::sin(1.1 * x + 0.3) + std::cos(1.7 * y));
}

TEST(TrimModel, tangentSheetsMeetInAFoldOnTheModelsCurve) {
  auto sheets = tangentSheets(slowlyVarying);
  for (auto& pole : sheets.fits[0]->surface.poles) pole[2] -= 1.5e-4;
  const auto model = sheets.trim();
  expectExact(model);
  EXPECT_EQ(model.edges.size(), 7u);
  EXPECT_EQ(model.moved.size(), 2u);
  for (double y = 0.1; y < 6; y += 0.1) {
    const Eigen::Vector3d p = wavy(5, y);
    std::vector<Eigen::Vector3d> normals;
    for (const auto& face : model.faces) {
      const Eigen::Vector2d foot = face.surface.footPoint(p, {5, y});
      const auto jet = face.surface.jet(foot[0], foot[1]);
      EXPECT_LE((jet.s - p).norm(), 1.5e-7 * sheets.model.diagonal) << y;
      normals.push_back(jet.su.cross(jet.sv).normalized());
    }
    EXPECT_NEAR(normals[0].cross(normals[1]).norm(), 0.01, 0.002) << y;
  }
  for (int k : {0, 1})
    for (double x = 5 * k; x <= 5 + 5 * k; x += 0.25)
      for (double y = 0; y <= 6; y += 0.25) {
        const auto &before = sheets.fits[k]->surface, &after = model.faces[k].surface;
        const double moved = (after.point(x, y) - before.point(x, y)).norm();
        EXPECT_LE(moved, std::abs(x - 5) < 2.5 ? 2e-3 : 2e-4) << x << " " << y;
      }
}

TEST(TrimModel, sheetsThatMakeAnEdgeInPlacesOnlyKeepItThere) {
  // Tangent at both ends, an edge of a tenth of a right angle between them.
  const auto slope = [](double y) { return 0.16 * std::exp(-2 * (y - 3) * (y - 3)); };
  for (const int sign : {-1, 1}) {
    auto sheets = tangentSheets(
        [&](double x, double y) { return sign * slope(y) * (x - 5) * std::exp(-(x - 5) * (x - 5)); });
    const auto model = sheets.trim();
    expectExact(model);
    EXPECT_EQ(model.edges.size(), 7u);
    for (double y = 0.1; y < 6; y += 0.1) {
      const double angle = angleAt(model, wavy(5, y), {5, y});
      EXPECT_GE(angle, 0.005) << y;
      EXPECT_LE(angle, std::max(0.015, slope(y))) << y;
    }
  }
}

TEST(TrimModel, aSheetThatMayNotMoveOntoTheCurveIsFollowedByTheOther) {
  auto sheets = tangentSheets(slowlyVarying);
  // Its inner double knot keeps it from moving.
  sheets.fits[0]->surface = withKnotU(sheets.fits[0]->surface, sheets.fits[0]->surface.knotsU[10]);
  for (auto& pole : sheets.fits[0]->surface.poles) pole[2] -= 1.5e-4;
  const auto model = sheets.trim();
  EXPECT_EQ(model.looseEdges, 0);
  ASSERT_EQ(model.moved.size(), 1u);
  EXPECT_EQ(model.moved.begin()->first, 1);
  EXPECT_EQ(model.edges.size(), 7u);
  EXPECT_LE(measuredGaps(model).edge, 2.5e-7 * sheets.model.diagonal);
  const auto &before = sheets.fits[1]->surface, &after = model.faces[1].surface;
  for (double x = 5; x <= 10; x += 0.25)
    for (double y = 0; y <= 6; y += 0.25)
      EXPECT_LE((after.point(x, y) - before.point(x, y)).norm(), x < 7.5 ? 1e-3 : 2e-4) << x << " " << y;
}

TEST(TrimModel, sheetsAroundACornerAgreeThere) {
  auto quarters = tangentQuarters([](int quarter, double x, double y) {
    return 1e-4 * std::sin(0.8 * x + 2 * quarter) + 1e-4 * std::cos(0.9 * y + quarter * quarter);
  });
  const auto model = quarters.trim();
  EXPECT_EQ(model.looseEdges, 0);
  EXPECT_EQ(model.edges.size(), 12u);
  EXPECT_EQ(model.vertices.size(), 9u);
  EXPECT_EQ(model.moved.size(), 4u);  // all into their common corner
  expectExact(model);
}

TEST(TrimModel, aRidgeThatBecomesAValleyIsTangentBetween) {
  const auto slope = [](double y) { return 0.4 * std::sin(std::numbers::pi / 3 * y); };
  auto sheets =
      tangentSheets([&](double x, double y) { return slope(y) * (x - 5) * std::exp(-(x - 5) * (x - 5)); });
  const auto model = sheets.trim();
  expectExact(model);
  EXPECT_EQ(model.edges.size(), 7u);
  EXPECT_LE(angleAt(model, wavy(5, 3), {5, 3}), 0.005);
  for (const double y : {0.5, 1.5, 2.5, 3.5, 4.5, 5.5})
    EXPECT_GE(angleAt(model, wavy(5, y), {5, y}), 0.009) << y;
}

TEST(TrimModel, aSlightValleyAlongARidgeIsTurnedIntoARidge) {
  const auto slope = [](double y) { return 0.17 - 0.3 * std::exp(-(y - 3) * (y - 3)); };
  auto sheets = tangentSheets(
      [&](double x, double y) { return slope(y) * (x - 5) * std::exp(-8 * (x - 5) * (x - 5)); });
  const auto model = sheets.trim();
  expectExact(model);
  EXPECT_EQ(model.edges.size(), 7u);
  for (double y = 0.1; y < 6; y += 0.1) EXPECT_GE(angleAt(model, wavy(5, y), {5, y}), 0.008) << y;
}

TEST(TrimModel, closedSheetsAreMovedAndStayClosed) {
  auto tubes = tangentTubes([](double u) { return 2e-4 * std::sin(2 * std::numbers::pi * 3 * u / kRings); });
  const auto model = tubes.trim();
  EXPECT_EQ(model.looseEdges, 0);
  EXPECT_EQ(model.moved.size(), 2u);
  EXPECT_LE(measuredGaps(model).edge, 2e-7 * tubes.model.diagonal);
  const SplineSurface& moved = model.faces[1].surface;
  for (double v = 1; v < 9; v += 0.5) {
    const auto start = moved.jet(moved.firstU(), v), end = moved.jet(moved.lastU(), v);
    EXPECT_EQ(start.s, end.s);
    EXPECT_LE((start.su - end.su).norm() + (start.suu - end.suu).norm(), 1e-9);
  }
}

/// Two plane sheets that make a wedge of ten degrees along x = 5, each moved into it by `inwards`.
TrimCase wedge(double inwards) {
  TrimCase c;
  const double slope = std::tan(std::numbers::pi / 18);
  const auto lower =
      interpolated([=](double x, double y) { return Eigen::Vector3d(x, y, inwards); }, -1, 6, 8, -1, 7, 8);
  const auto upper =
      interpolated([=](double y, double x) { return Eigen::Vector3d(x, y, (5 - x) * slope - inwards); }, -1,
                   7, 8, -1, 6, 8);
  const Eigen::Vector3d a(5, 0, 0), b(5, 6, 0), up(0, 0, 5 * slope);
  const Eigen::Vector3d at[] = {a, b, {0, 6, 0}, {0, 0, 0}, {0, 6, up[2]}, {0, 0, up[2]}};
  std::vector<CornerId> corners;
  for (const auto& p : at) corners.push_back(c.corner(p));
  const auto line = [&](int i, int j) {
    const Eigen::Vector3d from = at[i], to = at[j];
    return c.curve(0, 1, corners[i], corners[j],
                   [=](double t) { return Eigen::Vector3d(from + t * (to - from)); });
  };
  const CurveId shared = line(0, 1);
  const TrimCase::Loop ofLower{{shared, true}, {line(1, 2), true}, {line(2, 3), true}, {line(3, 0), true}};
  const TrimCase::Loop ofUpper{{shared, false}, {line(0, 5), true}, {line(5, 4), true}, {line(4, 1), true}};
  c.region(lower, {ofLower}, dropZ);
  c.region(upper, {ofUpper}, [](const Eigen::Vector3d& p) { return Eigen::Vector2d(p[1], p[0]); });
  c.model.shells.push_back({{0, 1}, {}});
  return c;
}

TEST(TrimModel, edgesOfAWedgeThatStrayFromTheirCurveAreNamed) {
  // Either surface is half a tolerance away; they cut each other 5.7 tolerances from the curve.
  const auto model = wedge(5e-4).trim();
  EXPECT_EQ(model.strayRegions, (std::set<int>{0, 1}));
  EXPECT_EQ(model.looseEdges, 0);
  EXPECT_TRUE(wedge(-5e-4).trim().strayRegions.empty()) << "beyond the curve nothing is missing";
  EXPECT_TRUE(wedge(1e-4).trim().strayRegions.empty()) << "1.1 tolerances, which crossing sheets may leave";
}

TEST(TrimModel, sheetsThatCannotMoveMeetLooselyAndSaySo) {
  auto sheets = tangentSheets([](double, double) { return 2e-4; });
  for (auto& fit : sheets.fits) fit->surface = withKnotU(fit->surface, fit->surface.knotsU[10]);
  const auto model = sheets.trim();
  EXPECT_EQ(model.looseEdges, 1);
  EXPECT_EQ(model.looseRegions, (std::set<int>{0, 1}));
  EXPECT_TRUE(model.moved.empty());
  EXPECT_EQ(model.edges.size(), 7u);
  const auto gaps = measuredGaps(model);
  EXPECT_GT(gaps.edge, 1e-4);
  EXPECT_LE(gaps.edge, gaps.edgeTolerance);
  EXPECT_LT(gaps.edgeTolerance, 3e-4);
}

TEST(TrimModel, allRegionsThatCannotBeTrimmedAreNamed) {
  auto sheets = tangentSheets([](double, double) { return 0.0; });
  for (auto& fit : sheets.fits)
    for (auto& pole : fit->surface.poles) pole[2] += 20;
  try {
    sheets.trim();
    FAIL();
  } catch (const RegionErrors& error) {
    ASSERT_EQ(error.others().size(), 1u);
    const std::string &first = error.where(), &second = error.others()[0].where();
    EXPECT_EQ(first.substr(0, first.find(',')), sheets.model.regions[0].name);
    EXPECT_EQ(second.substr(0, second.find(',')), sheets.model.regions[1].name);
  }
}

void expectSame(const SplineModel& a, const SplineModel& b) {
  ASSERT_EQ(a.edges.size(), b.edges.size());
  for (std::size_t e = 0; e < a.edges.size(); ++e) {
    EXPECT_EQ(a.edges[e].curve.knots, b.edges[e].curve.knots);
    EXPECT_EQ(a.edges[e].curve.poles, b.edges[e].curve.poles);
    EXPECT_EQ(a.edges[e].tolerance, b.edges[e].tolerance);
  }
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t f = 0; f < a.faces.size(); ++f)
    EXPECT_EQ(a.faces[f].surface.poles, b.faces[f].surface.poles);
  ASSERT_EQ(a.moved.size(), b.moved.size());
  for (const auto& [region, charts] : a.moved) {
    EXPECT_EQ(charts.at(0).deviation.max, b.moved.at(region).at(0).deviation.max);
    EXPECT_EQ(charts.at(0).surface.poles, b.moved.at(region).at(0).surface.poles);
  }
}

TEST(TrimModel, theNumberOfThreadsChangesNothing) {
  auto sheets = tangentSheets(slowlyVarying);
  expectSame(sheets.trim(1), sheets.trim(3));
}

TEST(TrimModel, memoryOfEarlierTrimsChangesNothing) {
  auto sheets = tangentSheets(slowlyVarying);
  TrimMemory memory;
  const auto fresh = sheets.trim();
  for (int again = 0; again < 3; ++again) expectSame(sheets.trim(1, &memory), fresh);
  // One sheet is another one; the memory is of the one before, then of both.
  auto& pole = sheets.fits[0]->surface.poles[sheets.fits[0]->surface.poles.size() / 2][2];
  const double before = pole;
  pole += 0.01;
  const auto freshOther = sheets.trim();
  expectSame(sheets.trim(1, &memory), freshOther);
  EXPECT_NE(freshOther.edges[0].curve.poles, fresh.edges[0].curve.poles);
  pole = before;
  expectSame(sheets.trim(1, &memory), fresh);
}

TEST(TrimModel, jaggedBoundaryIsSmoothedWithinTheTolerance) {
  auto sheet = roundSheet();
  sheet.tolerance = 0.02;
  auto& circle = sheet.model.curves[0];
  const auto smooth = circle.curve;
  circle.curve = std::make_shared<FunctionCurve>(0, smooth->last(), [=](double t) {
    return Eigen::Vector3d(smooth->point(t) * (1 + 5e-4 * std::sin(300 * t)));
  });
  const auto model = sheet.trim();
  const auto& loop = model.faces[0].loops[0];
  for (const auto& coedge : loop) {
    EXPECT_LT(coedge.curve.poles.size(), 40u);
    for (int i = 0; i <= 100; ++i) {
      const auto& c = coedge.curve;
      EXPECT_NEAR(c.point(c.first() + (c.last() - c.first()) * i / 100).norm(), 5, 0.01);
    }
  }
}

TEST(TrimModel, crossingBoundariesAreAnError) {
  TrimCase c = roundSheet(4.6);
  try {
    c.trim();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Stage);
    EXPECT_EQ(error.where(), "Face1");
  }
}

TEST(Sheet, movedSeamIsTheSameSurface) {
  const auto closed = tube({}).fits[0]->surface;
  for (const double u : {5.0, 7.3, 23.9}) {
    const auto moved = withSeamAt(closed, u);
    EXPECT_EQ(moved.firstU(), u);
    EXPECT_NEAR(moved.lastU(), u + kRings, 1e-12);
    for (double x = u; x < u + kRings; x += 0.37)
      EXPECT_LT((moved.point(x, 3.1) - closed.point(closed.wrappedU(x), 3.1)).norm(), 1e-12);
  }
}

TEST(TrimModel, failedNeighbourLeavesFreeEdges) {
  auto box = bulgedBox(0.8);
  box.fits[2].reset();
  const auto model = box.trim();
  expectExact(model);
  EXPECT_EQ(model.faces.size(), 5u);
  EXPECT_EQ(model.edges.size(), 12u);
  EXPECT_FALSE(model.shells[0].solid);
}

TEST(TrimModel, platesWallsAndCapsShareTheirEdges) {
  const auto model = filletedPlate().trim();
  expectExact(model);
  EXPECT_EQ(model.faces.size(), 4u);
  ASSERT_EQ(model.shells.size(), 1u);
  EXPECT_EQ(model.shells[0].solid, 0);
}

}  // namespace
}  // namespace trimquad
