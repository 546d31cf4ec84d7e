#include "trimquad/quads/cell_loops.h"

#include <algorithm>
#include <array>
#include <map>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

int keptCount(const CellLoop& loop) {
  return int(std::count_if(loop.begin(), loop.end(), [](const auto& p) { return p.kept; }));
}

WideQuanta keptArea(const CellLoop& loop) {
  std::optional<FixedVector> origin, last;
  WideQuanta area = 0;
  for (const auto& p : loop) {
    if (!p.kept) continue;
    if (!origin) origin = last = p.at;
    area += cross(*last - *origin, p.at - *origin);
    last = p.at;
  }
  return area;
}

/// Index of the kept point that follows `i`, counted on past the end of the loop.
size_t nextKept(const CellLoop& loop, size_t i) {
  do ++i;
  while (!loop[i % loop.size()].kept);
  return i;
}

}  // namespace

CellLoops::CellLoops(const Parametrization& map, const GridOverlay& overlay, const std::vector<bool>& node)
    : map_(map), overlay_(overlay) {
  joinPieces();
  walkLoops(node);
  for (int c = 0; c < cellCount(); ++c) keepEnough(c);
  separateCoincidingSides();
  for (auto& loops : loops_)
    for (auto& loop : loops) {
      const auto first = std::find_if(loop.begin(), loop.end(), [](const auto& p) { return p.kept; });
      std::rotate(loop.begin(), first, loop.end());
    }
}

void CellLoops::joinPieces() {
  cellOfPiece_ = overlay_.cellOfPiece();
  for (int p = 0; p < int(overlay_.pieces.size()); ++p) {
    if (cellOfPiece_[p] == int(firstPiece_.size())) {
      firstPiece_.push_back(p);
      area_.push_back(0);
    }
    area_[cellOfPiece_[p]] += overlay_.pieces[p].doubleArea;
  }
}

void CellLoops::walkLoops(const std::vector<bool>& node) {
  loops_.resize(firstPiece_.size());
  std::vector<bool> seen(overlay_.halfedges.size(), false);
  for (int h = 0; h < int(overlay_.halfedges.size()); ++h) {
    const int piece = overlay_.halfedges[h].piece;
    if (seen[h] || piece < 0 || !overlay_.edges[h >> 1].separates()) continue;
    CellLoop loop = walkLoop(h, node);
    for (const auto& p : loop) seen[p.halfedge] = true;
    loops_[cellOfPiece_[piece]].push_back(std::move(loop));
  }
}

CellLoop CellLoops::walkLoop(int start, const std::vector<bool>& node) const {
  CellLoop loop;
  Transition toStart;
  int h = start;
  do {
    const auto& half = overlay_.halfedges[h];
    loop.push_back({h, toStart(half.at), node[half.origin]});
    h = half.next;
    while (!overlay_.edges[h >> 1].separates()) {
      const auto& back = overlay_.halfedges[h ^ 1];
      toStart = toStart.after(map_.transition(back.meshHalfedge));
      h = back.next;
    }
  } while (h != start);
  return loop;
}

/// A vertex of the boundary at which nothing else ends: it belongs to this cell alone.
bool CellLoops::onBoundaryOnly(const LoopPoint& p) const {
  const auto& point = overlay_.points[pointOf(p)];
  return point.border && point.degree == 2;
}

/// Where one loop is the whole border, keeps the vertices of the boundary that the cell needs to have three
/// corners and a positive area, the farthest from its chord first. With holes it keeps them all: a hole may
/// lie in the way of a chord.
void CellLoops::keepEnough(int cell) {
  auto& loops = loops_[cell];
  TRIMQUAD_ASSERT(!loops.empty());
  if (loops.size() > 1 || isPinched(cell)) {
    for (auto& loop : loops)
      for (auto& p : loop) p.kept = p.kept || onBoundaryOnly(p);
    return;
  }
  auto& loop = loops[0];
  while (keptCount(loop) < 3 || keptArea(loop) <= 0) {
    const auto vertex = farthest(loop);
    if (!vertex) break;
    loop[vertex->index].kept = true;
  }
}

/// Two sides with the same ends, at least one on the boundary, would be one edge to a reader of the polygons,
/// and a hole between them would be gone. They keep a vertex each.
void CellLoops::separateCoincidingSides() {
  struct Side {
    std::array<int, 2> ends;
    int cell, loop;
    size_t from, to;
    bool border;
  };
  std::vector<Side> sides;
  for (int c = 0; c < cellCount(); ++c)
    for (int l = 0; l < int(loops_[c].size()); ++l) {
      const auto& loop = loops_[c][l];
      for (size_t i = 0; i < loop.size(); ++i) {
        if (!loop[i].kept || !overlay_.points[pointOf(loop[i])].border) continue;
        const size_t to = nextKept(loop, i);
        const int a = pointOf(loop[i]), b = pointOf(loop[to % loop.size()]);
        if (!overlay_.points[b].border) continue;
        sides.push_back(
            {{std::min(a, b), std::max(a, b)}, c, l, i, to, overlay_.edges[loop[i].halfedge >> 1].border});
      }
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.ends < b.ends; });
  for (size_t i = 0; i < sides.size();) {
    size_t end = i;
    int cellsAlong = 0;  // an inner side has two
    for (; end < sides.size() && sides[end].ends == sides[i].ends; ++end)
      cellsAlong += sides[end].border ? 2 : 1;
    for (; i < end; ++i) {
      if (cellsAlong <= 2 || !sides[i].border) continue;
      auto& loop = loops_[sides[i].cell][sides[i].loop];
      if (const auto vertex = farthestOnSide(loop, sides[i].from, sides[i].to))
        loop[vertex->index].kept = true;
    }
  }
}

std::optional<CellLoops::Farthest> CellLoops::farthestOnSide(const CellLoop& loop, size_t from,
                                                             size_t to) const {
  const size_t n = loop.size();
  const auto position = [&](size_t i) -> const Eigen::Vector3d& {
    return overlay_.points[pointOf(loop[i % n])].position;
  };
  const Eigen::Vector3d chord = position(to) - position(from);
  std::optional<Farthest> best;
  for (size_t k = from + 1; k < to; ++k) {
    if (!onBoundaryOnly(loop[k % n])) continue;
    const Eigen::Vector3d x = position(k) - position(from);
    const double t = chord.isZero(0) ? 0 : std::clamp(x.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
    const double distance = (x - t * chord).norm();
    if (!best || distance > best->distance) best = {distance, k % n};
  }
  return best;
}

std::optional<CellLoops::Farthest> CellLoops::farthest(const CellLoop& loop) const {
  size_t first = 0;
  while (first < loop.size() && !loop[first].kept) ++first;
  if (first == loop.size()) {  // nothing to measure from yet
    for (size_t i = 0; i < loop.size(); ++i)
      if (onBoundaryOnly(loop[i])) return Farthest{0, i};
    return {};
  }
  std::optional<Farthest> best;
  for (size_t i = first; i < first + loop.size();) {
    const size_t to = nextKept(loop, i);
    const auto candidate = farthestOnSide(loop, i, to);
    if (candidate && (!best || candidate->distance > best->distance)) best = candidate;
    i = to;
  }
  return best;
}

bool CellLoops::isFull(int cell) const {
  if (loops_[cell].size() > 1) return false;
  int corners = 0;
  for (const auto& p : loops_[cell][0]) {
    if (!overlay_.edges[p.halfedge >> 1].grid) return false;
    if (!p.kept) continue;
    if (!overlay_.points[pointOf(p)].integer) return false;
    ++corners;
  }
  return corners == 4;
}

bool CellLoops::isPinched(int cell) const {
  std::vector<int> points;
  for (const auto& loop : loops_[cell])
    for (const auto& p : loop)
      if (p.kept) points.push_back(pointOf(p));
  std::sort(points.begin(), points.end());
  return std::adjacent_find(points.begin(), points.end()) != points.end();
}

void CellLoops::bringIntoOnePlane(int cell) {
  auto& loops = loops_[cell];
  if (!bringIntoOneChart(loops)) project(loops);
  const auto outer =
      std::find_if(loops.begin(), loops.end(), [](const CellLoop& l) { return keptArea(l) > 0; });
  if (outer != loops.end()) std::rotate(loops.begin(), outer, outer + 1);
}

/// False where the charts do not agree around the cell.
bool CellLoops::bringIntoOneChart(std::vector<CellLoop>& loops) const {
  std::map<int, Transition> toRoot;              // from the chart of each piece
  std::vector<int> queue{loops[0][0].halfedge};  // one half-edge per piece
  toRoot[overlay_.halfedges[queue[0]].piece] = Transition{};
  for (size_t i = 0; i < queue.size(); ++i) {
    const Transition here = toRoot.at(overlay_.halfedges[queue[i]].piece);
    int h = queue[i];
    do {
      if (!overlay_.edges[h >> 1].separates()) {
        const auto& back = overlay_.halfedges[h ^ 1];
        const Transition there = here.after(map_.transition(back.meshHalfedge));
        const auto [known, isNew] = toRoot.emplace(back.piece, there);
        if (isNew)
          queue.push_back(h ^ 1);
        else if (!(known->second == there))
          return false;
      }
      h = overlay_.halfedges[h].next;
    } while (h != queue[i]);
  }
  for (auto& loop : loops)
    for (auto& p : loop) {
      const auto& h = overlay_.halfedges[p.halfedge];
      p.at = toRoot.at(h.piece)(h.at);
    }
  return placesAgree(loops);
}

/// Whether corners that occur more than once do so in one place: around a hole the chart may be shifted.
bool CellLoops::placesAgree(const std::vector<CellLoop>& loops) const {
  std::map<int, FixedVector> places;
  for (const auto& loop : loops)
    for (const auto& p : loop)
      if (p.kept && places.emplace(pointOf(p), p.at).first->second != p.at) return false;
  return true;
}

/// Seen along the normal of the loop with the largest area, which is the outer one.
void CellLoops::project(std::vector<CellLoop>& loops) const {
  const auto position = [&](const LoopPoint& p) -> const Eigen::Vector3d& {
    return overlay_.points[pointOf(p)].position;
  };
  const Eigen::Vector3d origin = position(loops[0][0]);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double size = 0;
  for (const auto& loop : loops) {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < loop.size(); ++i) {
      area += (position(loop[i]) - origin).cross(position(loop[(i + 1) % loop.size()]) - origin);
      size = std::max(size, (position(loop[i]) - origin).norm());
    }
    if (area.norm() > normal.norm()) normal = area;
  }
  const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
  const FixedScale fine = FixedScale::fitting(1);
  for (auto& loop : loops)
    for (auto& p : loop) {
      const Eigen::Vector3d d = (position(p) - origin) / size;
      p.at = fine.round(Eigen::Vector2d(d.dot(x), d.dot(y)));
    }
}

}  // namespace trimquad
