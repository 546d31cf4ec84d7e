#include "trimquad/spline/trim_loops.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <map>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

Eigen::Vector2d startOf(const SplineCoedge& c) {
  return c.forward ? c.curve.poles.front() : c.curve.poles.back();
}
Eigen::Vector2d endOf(const SplineCoedge& c) {
  return c.forward ? c.curve.poles.back() : c.curve.poles.front();
}

void shiftU(PlaneCurve& curve, double by) {
  if (by == 0) return;
  for (auto& pole : curve.poles) pole[0] += by;
}

/// Twice the signed area.
double signedArea(const std::vector<Eigen::Vector2d>& polygon) {
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    area += p[0] * q[1] - p[1] * q[0];
  }
  return area;
}

bool inside(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& polygon) {
  bool in = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]))
      in = !in;
  }
  return in;
}

/// A place where a loop passes over the seam.
struct SeamCrossing {
  double v;
  int step;  ///< +1 towards higher u: the region lies above; -1: below
  SplineVertexId vertex;
  std::size_t next;         ///< the piece that begins here
  std::size_t partner = 0;  ///< the crossing at the other end of the seam edge
  SplineEdgeId edge{0};     ///< of the seam
};

/// Loops on a closed sheet cut along its seam.
class SeamCut {
 public:
  SeamCut(const Sheet& sheet, const std::vector<PieceLoop>& loops, std::string name)
      : sheet_(sheet), name_(std::move(name)) {
    for (const auto& loop : loops) append(loop);
  }

  std::vector<std::vector<SplineCoedge>> cut(SplineModel& model) {
    addSeamEdges(model);
    std::vector<std::vector<SplineCoedge>> result;
    std::vector<bool> used(pieces_.size(), false);
    for (std::size_t start = 0; start < pieces_.size(); ++start) {
      if (used[start]) continue;
      auto& loop = result.emplace_back();
      for (std::size_t at = start; !used[at];) {
        used[at] = true;
        loop.push_back(pieces_[at]);
        const auto crossing = crossingAfter_.find(at);
        if (crossing == crossingAfter_.end()) {
          at = next_[at];
        } else {
          const SeamCrossing& from = crossings_[crossing->second];
          loop.push_back(alongSeam(from, model));
          at = crossings_[from.partner].next;
        }
      }
    }
    return result;
  }

 private:
  void append(const PieceLoop& loop) {
    const double period = *sheet_.period, first = sheet_.surface.firstU();
    const std::size_t begin = pieces_.size(), count = loop.size();
    std::vector<int> strip;
    for (const auto& piece : loop) {
      const auto& curve = piece.coedge.curve;
      strip.push_back(int(std::floor((curve.point((curve.first() + curve.last()) / 2)[0] - first) / period)));
      pieces_.push_back(piece.coedge);
      shiftU(pieces_.back().curve, -strip.back() * period);
      next_.push_back(pieces_.size());
    }
    next_.back() = begin;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = (i + 1) % count;
      // The loop's pieces are unwrapped one after another; only its end may come back turns later.
      const int turns = int(std::round((endOf(loop[i].coedge)[0] - startOf(loop[j].coedge)[0]) / period));
      const int step = strip[j] + turns - strip[i];
      if (step == 0) continue;
      if (std::abs(step) > 1)
        throw stageError("fit", "the boundary runs more than once around the closed surface", name_);
      crossingAfter_[begin + i] = crossings_.size();
      crossings_.push_back({endOf(loop[i].coedge)[1], step, loop[i].end, begin + j});
    }
  }

  /// Neighbouring crossings along the seam pair up: entering the region, leaving it.
  void addSeamEdges(SplineModel& model) {
    std::vector<std::size_t> order(crossings_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return std::tuple(crossings_[i].v, i) < std::tuple(crossings_[j].v, j);
    });
    const auto& surface = sheet_.surface;
    const SpaceCurve seam = surface.curveAtU(surface.firstU());
    for (std::size_t i = 0; i < order.size(); i += 2) {
      SeamCrossing& low = crossings_[order[i]];
      if (i + 1 == order.size() || low.step != 1 || crossings_[order[i + 1]].step != -1)
        throw stageError("fit", "boundary loops cross each other at the seam of a closed surface", name_,
                         seam.point(low.v));
      SeamCrossing& high = crossings_[order[i + 1]];
      low.partner = order[i + 1];
      high.partner = order[i];
      low.edge = high.edge = {int(model.edges.size())};
      const double from = std::max(low.v, seam.first()), to = std::min(high.v, seam.last());
      model.edges.push_back({restricted(seam, from, to), low.vertex, high.vertex, 1e-7});
    }
  }

  SplineCoedge alongSeam(const SeamCrossing& from, const SplineModel& model) const {
    const bool up = from.step == 1;
    const auto& curve = model.edges[from.edge.index].curve;
    const double u = sheet_.surface.firstU() + (up ? *sheet_.period : 0), a = curve.first(), b = curve.last();
    return {from.edge, up, {1, {a, a, b, b}, {{u, a}, {u, b}}}};
  }

  const Sheet& sheet_;
  std::string name_;
  std::vector<SplineCoedge> pieces_;  ///< of all loops, moved into the sheet's domain
  std::vector<std::size_t> next_;
  std::vector<SeamCrossing> crossings_;
  std::map<std::size_t, std::size_t> crossingAfter_;  ///< by piece
};

}  // namespace

std::vector<Eigen::Vector2d> loopPolygon(const std::vector<SplineCoedge>& loop) {
  std::vector<Eigen::Vector2d> polygon;
  for (const auto& coedge : loop) {
    const auto& curve = coedge.curve;
    const std::size_t begin = polygon.size();
    // Along the curve, its last point left out (or its first where the loop runs against it).
    std::vector<double> breaks(curve.knots.begin() + curve.degree, curve.knots.end() - curve.degree);
    breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
    const int perSpan = curve.degree == 1 ? 1 : std::max(6, 24 / int(breaks.size()));
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
      for (int k = 0; k < perSpan; ++k)
        polygon.push_back(curve.point(breaks[i] + (breaks[i + 1] - breaks[i]) * k / perSpan));
    if (!coedge.forward) {
      polygon.push_back(curve.poles.back());
      std::reverse(polygon.begin() + begin, polygon.end());
      polygon.pop_back();
    }
  }
  return polygon;
}

std::vector<SplineFace> trimmedFaces(const Sheet& sheet, const std::vector<PieceLoop>& loops, int region,
                                     const std::string& name, SplineModel& model) {
  std::vector<std::vector<SplineCoedge>> closed;
  if (sheet.period) {
    closed = SeamCut(sheet, loops, name).cut(model);
  } else {
    for (const auto& loop : loops) {
      auto& coedges = closed.emplace_back();
      for (const auto& piece : loop) coedges.push_back(piece.coedge);
    }
  }
  struct Outer {
    std::vector<Eigen::Vector2d> polygon;
    double area;
  };
  std::vector<Outer> outers;
  std::vector<SplineFace> faces;
  std::vector<std::size_t> holes;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    auto polygon = loopPolygon(closed[i]);
    const double area = signedArea(polygon);
    if (area > 0) {
      outers.push_back({std::move(polygon), area});
      faces.push_back({sheet.surface, {closed[i]}, region});
    } else {
      holes.push_back(i);
    }
  }
  if (faces.empty())
    throw stageError("fit", "the boundary on the fitted surface encloses nothing; use a smaller edge length",
                     name);
  for (const std::size_t i : holes) {
    const auto p = startOf(closed[i].front());
    std::size_t best = outers.size();
    double bestArea = HUGE_VAL;
    for (std::size_t k = 0; k < outers.size(); ++k)
      if (outers[k].area < bestArea && inside(p, outers[k].polygon)) {
        best = k;
        bestArea = outers[k].area;
      }
    if (best == outers.size())
      throw stageError("fit", "boundary loops cross each other on the fitted surface", name, sheet.jet(p).s);
    faces[best].loops.push_back(closed[i]);
  }
  return faces;
}

std::optional<Eigen::Vector2d> loopCrossing(const SplineFace& face) {
  struct Segment {
    Eigen::Vector2d a, b;
  };
  std::vector<Segment> segments;
  for (const auto& loop : face.loops) {
    const auto polygon = loopPolygon(loop);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      Segment s{polygon[i], polygon[(i + 1) % polygon.size()]};
      segments.push_back(s);
    }
  }
  const auto low = [](const Segment& s, int axis) { return std::min(s.a[axis], s.b[axis]); };
  const auto high = [](const Segment& s, int axis) { return std::max(s.a[axis], s.b[axis]); };
  std::sort(segments.begin(), segments.end(), [&](const Segment& s, const Segment& t) {
    return std::tuple(low(s, 0), low(s, 1), s.a[0], s.a[1]) <
           std::tuple(low(t, 0), low(t, 1), t.a[0], t.a[1]);
  });
  const auto side = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    const Eigen::Vector2d d = b - a, e = c - a;
    return d[0] * e[1] - d[1] * e[0];
  };
  constexpr double same = 1e-9;
  const auto touch = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - b).norm() < same;
  };
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (std::size_t j = i + 1; j < segments.size() && low(segments[j], 0) <= high(segments[i], 0); ++j) {
      const Segment &s = segments[i], &t = segments[j];
      if (low(t, 1) > high(s, 1) || low(s, 1) > high(t, 1)) continue;
      if (touch(s.a, t.a) || touch(s.a, t.b) || touch(s.b, t.a) || touch(s.b, t.b)) continue;
      if (side(s.a, s.b, t.a) * side(s.a, s.b, t.b) < 0 && side(t.a, t.b, s.a) * side(t.a, t.b, s.b) < 0)
        return Eigen::Vector2d((s.a + s.b) / 2);
    }
  return {};
}

double seamPlace(const Sheet& sheet, const std::vector<std::vector<Eigen::Vector2d>>& boundary) {
  const double period = *sheet.period, first = sheet.surface.firstU();
  auto candidates = sheet.knotLines(0, first - 1e-6, first + period - 1e-6);
  candidates.push_back(first + period);
  for (std::size_t i = candidates.size() - 1; i > 0; --i)
    candidates.push_back((candidates[i - 1] + candidates[i]) / 2);
  double best = first;
  std::pair<int, double> bestCost{INT_MAX, 0};
  constexpr double enough = 0.25, tooClose = 0.02;  // quads
  for (double u : candidates) {
    if (u >= first + period) continue;
    u = std::max(u, first);
    double clearance = enough;
    int count = 0;
    const auto away = [&](double x) { return std::abs(std::remainder(x - u, period)); };
    for (const auto& stretch : boundary)
      for (std::size_t i = 0; i < stretch.size(); ++i) {
        const double x = stretch[i][0];
        const bool end = i == 0 || i + 1 == stretch.size();
        if (end || (x - stretch[i - 1][0]) * (stretch[i + 1][0] - x) <= 0)
          clearance = std::min(clearance, away(x));
        if (i > 0)
          count += int(std::abs(std::floor((x - u) / period) - std::floor((stretch[i - 1][0] - u) / period)));
      }
    const std::pair<int, double> cost{count + (clearance < tooClose ? 1000000 : 0), -clearance};
    if (cost < bestCost) {
      bestCost = cost;
      best = u;
    }
  }
  return best;
}

}  // namespace trimquad
