#include "support/trim_samples.h"

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <numbers>

namespace trimquad::test {

CornerId TrimCase::corner(const Eigen::Vector3d& p) {
  model.corners.push_back(p);
  return {int(model.corners.size()) - 1};
}

CurveId TrimCase::curve(double first, double last, CornerId start, CornerId end,
                        std::function<Eigen::Vector3d(double)> f, int pieces) {
  const int index = int(model.curves.size());
  model.curves.push_back({std::make_shared<FunctionCurve>(first, last, std::move(f)), start, end,
                          "Edge" + std::to_string(index + 1)});
  pieces_.push_back(pieces);
  return {index};
}

CurveId TrimCase::closedCurve(double first, double last, std::function<Eigen::Vector3d(double)> f,
                              int pieces) {
  const CornerId c = corner(f(first));
  return curve(first, last, c, c, std::move(f), pieces);
}

int TrimCase::region(const SplineSurface& surface, const std::vector<Loop>& loops,
                     const std::function<Eigen::Vector2d(const Eigen::Vector3d&)>& inverse) {
  Region region;
  region.name = "Face" + std::to_string(model.regions.size() + 1);
  FittedSurface fit;
  fit.surface = surface;
  const double period = surface.closedU ? surface.lastU() - surface.firstU() : 0;
  if (surface.closedU) fit.chart.period = fit.chart.scale.round(period);
  struct Boundary {
    VertexHandle vertex;
    CurveId curve;
  };
  for (const Loop& loop : loops) {
    std::vector<Boundary> ring;
    for (const Use& use : loop) {
      const ModelCurve& c = model.curves[use.curve.index];
      const int n = pieces_[use.curve.index];
      for (int i = 0; i < n; ++i) {
        const double t =
            c.curve->first() + (c.curve->last() - c.curve->first()) * (use.forward ? i : n - i) / n;
        ring.push_back({region.mesh.add_vertex(c.curve->point(t)), use.curve});
        region.curveParameter.push_back(t);
        region.corner.push_back(i > 0 ? std::optional<CornerId>{} : use.forward ? c.start : c.end);
      }
    }
    const auto apex = region.mesh.add_vertex(Eigen::Vector3d::Zero());
    region.curveParameter.push_back(0);
    region.corner.emplace_back();
    for (std::size_t i = 0; i < ring.size(); ++i)
      region.mesh.add_face(ring[i].vertex, ring[(i + 1) % ring.size()].vertex, apex);
    region.edgeCurve.resize(region.mesh.n_edges());
    fit.chart.corner.resize(region.mesh.n_halfedges());
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const auto p = ring[i].vertex, q = ring[(i + 1) % ring.size()].vertex;
      const auto h = region.mesh.find_halfedge(p, q);
      region.edgeCurve[region.mesh.edge_handle(h).idx()] = ring[i].curve;
      const Eigen::Vector2d at = inverse(region.mesh.point(p));
      Eigen::Vector2d to = inverse(region.mesh.point(q));
      if (period > 0) to[0] += period * std::round((at[0] - to[0]) / period);
      fit.chart.corner[h.idx()] = fit.chart.scale.round(at);
      fit.chart.corner[region.mesh.next_halfedge_handle(h).idx()] = fit.chart.scale.round(to);
    }
  }
  model.regions.push_back(std::move(region));
  fits.emplace_back(std::move(fit));
  maps.emplace_back();
  return int(model.regions.size()) - 1;
}

SplineModel TrimCase::trim(int threads, TrimMemory* memory) {
  std::vector<const GridMap*> mapPointers;
  std::vector<const FittedSurface*> fitPointers;
  for (auto& map : maps) mapPointers.push_back(&map);
  for (auto& fit : fits) fitPointers.push_back(fit ? &*fit : nullptr);
  model.diagonal = 20;
  return trimModel(model, mapPointers, fitPointers,
                   {.tolerance = tolerance, .threads = threads, .memory = memory}, Progress());
}

std::vector<double> clampedKnots(int degree, double a, double b, int spans) {
  std::vector<double> knots(degree, a);
  for (int i = 0; i <= spans; ++i) knots.push_back(a + (b - a) * i / spans);
  knots.insert(knots.end(), degree, b);
  return knots;
}

SplineSurface interpolated(const PlaneFunction& f, double u0, double u1, int spansU, double v0, double v1,
                           int spansV, int degree) {
  SplineSurface s;
  s.degreeU = s.degreeV = degree;
  s.knotsU = clampedKnots(degree, u0, u1, spansU);
  s.knotsV = clampedKnots(degree, v0, v1, spansV);
  s.countU = spansU + degree;
  s.countV = spansV + degree;
  const auto greville = [&](const std::vector<double>& knots, int i) {
    double sum = 0;
    for (int k = 1; k <= degree; ++k) sum += knots[i + k];
    return sum / degree;
  };
  const auto collocation = [&](const std::vector<double>& knots, int count) {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(count, count);
    for (int i = 0; i < count; ++i) {
      BasisFunctions basis;
      basisFunctions(knots, degree, greville(knots, i), 0, basis);
      for (int k = 0; k <= degree; ++k) m(i, basis.first + k) = basis.value[0][k];
    }
    return m;
  };
  const Eigen::MatrixXd mu = collocation(s.knotsU, s.countU).inverse(),
                        mv = collocation(s.knotsV, s.countV).inverse();
  s.poles.assign(std::size_t(s.countU) * s.countV, Eigen::Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::MatrixXd values(s.countU, s.countV);
    for (int i = 0; i < s.countU; ++i)
      for (int j = 0; j < s.countV; ++j) values(i, j) = f(greville(s.knotsU, i), greville(s.knotsV, j))[axis];
    const Eigen::MatrixXd poles = mu * values * mv.transpose();
    for (int i = 0; i < s.countU; ++i)
      for (int j = 0; j < s.countV; ++j) s.poles[i + s.countU * j][axis] = poles(i, j);
  }
  return s;
}

SplineSurface closedSurface(const PlaneFunction& f, int rings, double v0, double v1, int spansV) {
  SplineSurface s;
  s.degreeU = s.degreeV = 3;
  s.knotsV = clampedKnots(3, v0, v1, spansV);
  s.countV = spansV + 3;
  s.closedU = true;
  for (int j = 0; j < s.countV; ++j) {
    const double v = (s.knotsV[j + 1] + s.knotsV[j + 2] + s.knotsV[j + 3]) / 3;
    SpaceCurve unclamped;
    for (int k = -5; k <= rings + 5; ++k) unclamped.knots.push_back(k);
    for (int i = 0; i < rings + 7; ++i) unclamped.poles.push_back(f((i - 3 + rings) % rings, v));
    SpaceCurve row = restricted(unclamped, 0, rings);
    row.poles.back() = row.poles.front();
    s.knotsU = row.knots;
    s.countU = int(row.poles.size());
    s.poles.insert(s.poles.end(), row.poles.begin(), row.poles.end());
  }
  return s;
}

Eigen::Vector2d dropZ(const Eigen::Vector3d& p) {
  return p.head<2>();
}

Eigen::Vector3d wavy(double x, double y) {
  return {x, y, 0.4 * std::sin(0.7 * x) * std::cos(0.5 * y)};
}

TrimCase rectangleSheet() {
  TrimCase c;
  const auto surface = interpolated(wavy, -1, 11, 24, -1, 7, 16);
  const Eigen::Vector2d at[] = {{0, 0}, {10, 0}, {10, 6}, {0, 6}};
  std::vector<CornerId> corners;
  for (const auto& p : at) corners.push_back(c.corner(surface.point(p[0], p[1])));
  TrimCase::Loop loop;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d p = at[i], q = at[(i + 1) % 4];
    loop.push_back(
        {c.curve(0, 1, corners[i], corners[(i + 1) % 4],
                 [=](double t) { return surface.point(p[0] + t * (q - p)[0], p[1] + t * (q - p)[1]); }),
         true});
  }
  const int r = c.region(surface, {loop}, dropZ);
  c.model.shells.push_back({{r}, {}});
  return c;
}

TrimCase tangentSheets(const std::function<double(double, double)>& offset) {
  TrimCase c;
  const auto lifted = [&](double x, double y) {
    return Eigen::Vector3d(wavy(x, y) + Eigen::Vector3d(0, 0, offset(x, y)));
  };
  const SplineSurface surfaces[] = {interpolated(wavy, -1, 11, 24, -1, 7, 16),
                                    interpolated(lifted, -1, 11, 24, -1, 7, 16)};
  const Eigen::Vector2d at[] = {{0, 0}, {5, 0}, {10, 0}, {10, 6}, {5, 6}, {0, 6}};
  std::vector<CornerId> corners;
  for (const auto& p : at) corners.push_back(c.corner(wavy(p[0], p[1])));
  const auto line = [&](int i, int j) {
    const Eigen::Vector2d p = at[i], d = at[j] - at[i];
    return c.curve(0, 1, corners[i], corners[j],
                   [=](double t) { return wavy(p[0] + t * d[0], p[1] + t * d[1]); });
  };
  const CurveId middle = line(1, 4);
  c.region(surfaces[0], {{{line(0, 1), true}, {middle, true}, {line(4, 5), true}, {line(5, 0), true}}},
           dropZ);
  c.region(surfaces[1], {{{line(1, 2), true}, {line(2, 3), true}, {line(3, 4), true}, {middle, false}}},
           dropZ);
  c.model.shells.push_back({{0, 1}, {}});
  return c;
}

TrimCase roundSheet(double holeX) {
  TrimCase c;
  const auto surface = interpolated(wavy, -6, 6, 24, -6, 6, 24);
  const auto circle = [&](double x, double y, double r) {
    return c.closedCurve(0, 2 * std::numbers::pi,
                         [=](double t) { return surface.point(x + r * std::cos(t), y + r * std::sin(t)); });
  };
  const int r = c.region(surface,
                         {{{circle(0, 0, 5), true}},
                          {{circle(holeX, 1, 1), false}},
                          {{circle(-2, 1.5, 0.7), false}},
                          {{circle(0.3, -2.5, 1.1), false}}},
                         dropZ);
  c.model.shells.push_back({{r}, {}});
  return c;
}

Eigen::Vector2d angleAndZ(const Eigen::Vector3d& p) {
  double turn = std::atan2(p[1], p[0]) / (2 * std::numbers::pi);
  if (turn < 0) turn += 1;
  return {turn * kRings, p[2]};
}

TrimCase tube(const std::vector<Eigen::Vector2d>& holes, double radius) {
  TrimCase c;
  const auto surface = closedSurface(
      [](double u, double v) {
        const double a = 2 * std::numbers::pi * u / kRings, r = 4 + 0.2 * std::sin(v);
        return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), v);
      },
      kRings, -1, 11, 12);
  const auto ring = [&](double height, double phase) {
    return c.closedCurve(0, kRings, [=](double t) {
      return surface.point(surface.wrappedU(t),
                           height + 0.5 * std::sin(4 * std::numbers::pi * t / kRings + phase));
    });
  };
  std::vector<TrimCase::Loop> loops{{{ring(1, 0), true}}, {{ring(9, 1), false}}};
  for (const auto& hole : holes)
    loops.push_back({{c.closedCurve(0, 2 * std::numbers::pi,
                                    [=](double t) {
                                      return surface.point(surface.wrappedU(hole[0] + radius * std::cos(t)),
                                                           hole[1] + radius * std::sin(t));
                                    }),
                      false}});
  const int r = c.region(surface, loops, angleAndZ);
  c.model.shells.push_back({{r}, {}});
  return c;
}

TrimCase tangentQuarters(const std::function<double(int, double, double)>& offset) {
  TrimCase c;
  CornerId corner[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) corner[i][j] = c.corner(wavy(5 * i, 3 * j));
  const auto line = [&](int i, int j, int k, int l) {
    return c.curve(0, 1, corner[i][j], corner[k][l],
                   [=](double t) { return wavy(5 * ((1 - t) * i + t * k), 3 * ((1 - t) * j + t * l)); });
  };
  CurveId along[2][3] = {{line(0, 0, 1, 0), line(0, 1, 1, 1), line(0, 2, 1, 2)},
                         {line(1, 0, 2, 0), line(1, 1, 2, 1), line(1, 2, 2, 2)}};
  CurveId across[3][2] = {{line(0, 0, 0, 1), line(0, 1, 0, 2)},
                          {line(1, 0, 1, 1), line(1, 1, 1, 2)},
                          {line(2, 0, 2, 1), line(2, 1, 2, 2)}};
  const int quarters[4][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  for (int q = 0; q < 4; ++q) {
    const auto [i, j] = quarters[q];
    const auto lifted = [&](double x, double y) {
      return Eigen::Vector3d(wavy(x, y) + Eigen::Vector3d(0, 0, offset(q, x, y)));
    };
    c.region(
        interpolated(lifted, -1, 11, 24, -1, 7, 16),
        {{{along[i][j], true}, {across[i + 1][j], true}, {along[i][j + 1], false}, {across[i][j], false}}},
        dropZ);
  }
  c.model.shells.push_back({{0, 1, 2, 3}, {}});
  return c;
}

TrimCase tangentTubes(const std::function<double(double)>& offset) {
  TrimCase c;
  const auto at = [](double u, double v, double more) {
    const double a = 2 * std::numbers::pi * u / kRings, r = 4 + 0.2 * std::sin(v) + more;
    return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), v);
  };
  const SplineSurface surfaces[] = {
      closedSurface([&](double u, double v) { return at(u, v, 0); }, kRings, -1, 11, 12),
      closedSurface([&](double u, double v) { return at(u, v, offset(u)); }, kRings, -1, 11, 12)};
  const auto ring = [&](double height, double waves) {
    return c.closedCurve(0, kRings, [=, surface = surfaces[0]](double t) {
      return surface.point(surface.wrappedU(t), height + waves * std::sin(4 * std::numbers::pi * t / kRings));
    });
  };
  const CurveId low = ring(1, 0), middle = ring(5, 0.4), high = ring(9, 0);
  c.region(surfaces[0], {{{low, true}}, {{middle, false}}}, angleAndZ);
  c.region(surfaces[1], {{{middle, true}}, {{high, false}}}, angleAndZ);
  c.model.shells.push_back({{0, 1}, {}});
  return c;
}

TrimCase bulgedBox(double waves, const std::vector<int>& which) {
  TrimCase c;
  const Eigen::Vector3d half(5, 4, 3);
  const auto height = [=](int side, const Eigen::Vector3d& p) {
    const int d = side / 2, e = (d + 1) % 3, f = (d + 2) % 3;
    return (side % 2 ? 1 : -1) *
           (half[d] + waves * (1 + 0.3 * std::sin(0.9 * p[e] + side) * std::cos(0.7 * p[f])));
  };
  const auto settle = [=](Eigen::Vector3d p, const std::vector<int>& sides) {
    for (int i = 0; i < 60; ++i)
      for (const int side : sides) p[side / 2] = height(side, p);
    return p;
  };
  std::vector<CornerId> corners;
  for (int k = 0; k < 8; ++k) {
    const std::vector<int> sides{k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2 & 1)};
    corners.push_back(c.corner(settle(Eigen::Vector3d::Zero(), sides)));
  }
  // Edge along `axis` between the corners k and k + (1 << axis).
  std::vector<std::vector<std::optional<CurveId>>> edges(3, std::vector<std::optional<CurveId>>(8));
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 8; ++k) {
      if (k >> axis & 1) continue;
      std::vector<int> sides;
      for (int d = 0; d < 3; ++d)
        if (d != axis) sides.push_back(2 * d + (k >> d & 1));
      const double from = c.model.corners[k][axis], to = c.model.corners[k | 1 << axis][axis];
      edges[axis][k] = c.curve(0, 1, corners[k], corners[k | 1 << axis], [=](double t) {
        Eigen::Vector3d p = Eigen::Vector3d::Zero();
        p[axis] = from + t * (to - from);
        return settle(p, sides);
      });
    }
  for (const int side : which) {
    const int d = side / 2, u = (d + (side % 2 ? 1 : 2)) % 3, v = (d + (side % 2 ? 2 : 1)) % 3;
    const auto surface = interpolated(
        [=](double x, double y) {
          Eigen::Vector3d p = Eigen::Vector3d::Zero();
          p[u] = x;
          p[v] = y;
          p[d] = height(side, p);
          return p;
        },
        -half[u] - 2, half[u] + 2, 20, -half[v] - 2, half[v] + 2, 20);
    const int base = side % 2 << d;
    const TrimCase::Loop loop{{*edges[u][base], true},
                              {*edges[v][base | 1 << u], true},
                              {*edges[u][base | 1 << v], false},
                              {*edges[v][base], false}};
    c.region(surface, {loop}, [=](const Eigen::Vector3d& p) { return Eigen::Vector2d(p[u], p[v]); });
  }
  Model::Shell shell;
  for (int r = 0; r < int(which.size()); ++r) shell.regions.push_back(r);
  shell.solid = 0;
  c.model.shells.push_back(shell);
  return c;
}

TrimCase filletedPlate() {
  TrimCase c;
  c.tolerance = 0.02;
  constexpr double halfX = 8, halfY = 5, fillet = 2, height = 3, hole = 1.5;
  constexpr double pi = std::numbers::pi;
  const double straightX = 2 * (halfX - fillet), straightY = 2 * (halfY - fillet), arc = fillet * pi / 2;
  const double length = 2 * (straightX + straightY) + 4 * arc;
  // Counter-clockwise from the right side's lower end, by arc length.
  const auto outline = [=](double s) {
    s -= length * std::floor(s / length);
    const double straight[] = {straightY, straightX, straightY, straightX};
    const Eigen::Vector2d centre[] = {{halfX - fillet, halfY - fillet},
                                      {fillet - halfX, halfY - fillet},
                                      {fillet - halfX, fillet - halfY},
                                      {halfX - fillet, fillet - halfY}};
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d out(std::cos(k * pi / 2), std::sin(k * pi / 2)), along(-out[1], out[0]);
      if (s <= straight[k]) return Eigen::Vector2d(centre[k] + fillet * out + (s - straight[k]) * along);
      s -= straight[k];
      if (s <= arc || k == 3)
        return Eigen::Vector2d(centre[k] +
                               fillet * (std::cos(s / fillet) * out + std::sin(s / fillet) * along));
      s -= arc;
    }
    return Eigen::Vector2d(0, 0);
  };
  constexpr int outlineRings = 192, holeRings = 32;
  const auto wall = closedSurface(
      [=](double u, double v) {
        const Eigen::Vector2d p = outline(length * u / outlineRings);
        return Eigen::Vector3d(p[0], p[1], v);
      },
      outlineRings, -1, height + 1, 4);
  // Clockwise, so that the normal points to the axis, out of the plate.
  const auto holeWall = closedSurface(
      [=](double u, double v) {
        const double a = -2 * pi * u / holeRings;
        return Eigen::Vector3d(hole * std::cos(a), hole * std::sin(a), v);
      },
      holeRings, -1, height + 1, 4);
  const auto flat = [](double z, bool up) {
    return interpolated(
        [=](double u, double v) { return up ? Eigen::Vector3d(u, v, z) : Eigen::Vector3d(v, u, z); }, -10, 10,
        4, -10, 10, 4);
  };
  CurveId outer[2], inner[2];
  for (int k : {0, 1}) {
    const double z = k * height;
    outer[k] = c.closedCurve(
        0, length,
        [=](double s) {
          const Eigen::Vector2d p = outline(s);
          return Eigen::Vector3d(p[0], p[1], z);
        },
        96);
    inner[k] = c.closedCurve(
        0, 2 * pi, [=](double a) { return Eigen::Vector3d(hole * std::cos(a), hole * std::sin(a), z); }, 48);
  }
  const auto wallInverse = [=](const Eigen::Vector3d& p) {
    double best = HUGE_VAL, at = 0;
    constexpr int tries = 1920;
    for (int i = 0; i < tries; ++i) {
      const double d = (outline(length * i / tries) - p.head<2>()).norm();
      if (d < best) {
        best = d;
        at = i;
      }
    }
    return Eigen::Vector2d(at * outlineRings / tries, p[2]);
  };
  const auto holeInverse = [=](const Eigen::Vector3d& p) {
    double turn = -std::atan2(p[1], p[0]) / (2 * pi);
    return Eigen::Vector2d((turn < 0 ? turn + 1 : turn) * holeRings, p[2]);
  };
  c.region(flat(0, false), {{{outer[0], false}}, {{inner[0], true}}},
           [](const Eigen::Vector3d& p) { return Eigen::Vector2d(p[1], p[0]); });
  c.region(flat(height, true), {{{outer[1], true}}, {{inner[1], false}}}, dropZ);
  c.region(wall, {{{outer[0], true}}, {{outer[1], false}}}, wallInverse);
  c.region(holeWall, {{{inner[0], false}}, {{inner[1], true}}}, holeInverse);
  c.model.shells.push_back({{0, 1, 2, 3}, 0});
  return c;
}

ModelGaps measuredGaps(const SplineModel& model, int samples) {
  ModelGaps gaps;
  for (const auto& face : model.faces)
    for (const auto& loop : face.loops)
      for (const auto& coedge : loop) {
        const SplineEdge& edge = model.edges[coedge.edge.index];
        for (int i = 0; i <= samples; ++i) {
          const double s = i == samples
                               ? edge.curve.last()
                               : edge.curve.first() + (edge.curve.last() - edge.curve.first()) * i / samples;
          const Eigen::Vector2d x = coedge.curve.point(s);
          const double gap = (face.surface.point(x[0], x[1]) - edge.curve.point(s)).norm();
          gaps.edge = std::max(gaps.edge, gap);
          for (const auto& [at, vertex] : {std::pair{0, edge.start}, std::pair{samples, edge.end}})
            if (i == at)
              gaps.vertex =
                  std::max(gaps.vertex, (edge.curve.point(s) - model.vertices[vertex.index].point).norm());
        }
        gaps.edgeTolerance = std::max(gaps.edgeTolerance, edge.tolerance);
      }
  for (const auto& vertex : model.vertices)
    gaps.vertexTolerance = std::max(gaps.vertexTolerance, vertex.tolerance);
  return gaps;
}

}  // namespace trimquad::test
