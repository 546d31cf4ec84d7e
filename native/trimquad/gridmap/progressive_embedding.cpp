#include "trimquad/gridmap/progressive_embedding.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kNewtonSteps = 4;  ///< of one vertex
constexpr int kHalvings = 40;    ///< of a step, until it keeps all triangles
constexpr double kGrowth = 1.1;  ///< by which the mesh grows between sweeps over all vertices
constexpr int kFinalSweeps = 5;

/// Sum over triangles of their squared side lengths over their area, as a function of one corner.
struct ShapeEnergy {
  double value = 0;
  Vector2d gradient = Vector2d::Zero();
  Matrix2d hessian = Matrix2d::Zero();

  /// Triangle (p, a, b), with doubled area `area`.
  void add(const Vector2d& p, const Vector2d& a, const Vector2d& b, double area) {
    const double n = (p - a).squaredNorm() + (p - b).squaredNorm() + (a - b).squaredNorm();
    const Vector2d dn = 2 * (p - a) + 2 * (p - b), da(a.y() - b.y(), b.x() - a.x());
    value += n / area;
    gradient += dn / area - n * da / (area * area);
    hessian += 4 * Matrix2d::Identity() / area - (dn * da.transpose() + da * dn.transpose()) / (area * area) +
               2 * n * da * da.transpose() / (area * area * area);
  }
};

class Progression {
 public:
  Progression(const PatchDisk& disk, const std::vector<FixedVector>& rim, FixedScale scale)
      : disk_(disk), scale_(scale), ring_(disk.vertexCount), place_(rim) {
    place_.resize(disk.vertexCount);
    std::vector<std::map<int, int>> next(disk.vertexCount);
    for (const auto& t : disk.triangles)
      for (int k = 0; k < 3; ++k) next[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    for (std::size_t v = 0; v < disk.vertexCount; ++v) {
      int first = next[v].begin()->first;
      if (!disk.isInner(int(v))) {  // from the neighbour that follows on the rim on
        std::set<int> reached;
        for (const auto& [a, b] : next[v]) reached.insert(b);
        for (const auto& [a, b] : next[v])
          if (!reached.contains(a)) first = a;
      }
      int at = first;
      do {
        ring_[v].push_back(at);
        const auto after = next[v].find(at);
        if (after == next[v].end()) break;
        at = after->second;
      } while (at != first);
    }
  }

  std::optional<std::vector<FixedVector>> run() && {
    takeOut();
    if (!mapRest()) return {};
    double sweepAt = kGrowth * double(present_.size());
    while (!removed_.empty()) {
      const Removed back = std::move(removed_.back());
      removed_.pop_back();
      if (!putIn(back)) return {};
      if (double(present_.size()) < sweepAt) continue;
      sweep();
      sweepAt = kGrowth * double(present_.size());
    }
    for (int k = 0; k < kFinalSweeps; ++k) sweep();
    for (const auto& t : disk_.triangles)
      if (orientation(place_[t[0]], place_[t[1]], place_[t[2]]) <= 0) return {};
    return std::move(place_);
  }

 private:
  struct Removed {
    int vertex;
    std::vector<int> ring;  ///< first the neighbour onto which it was collapsed
  };

  Vector2d at(int v) const { return scale_.toQuads(place_[v]); }

  bool onOneSide(int a, int b) const {
    if (disk_.isInner(a) || disk_.isInner(b)) return false;
    for (int s = 0; s < 4; ++s)
      if (disk_.sides[a][s] && disk_.sides[b][s]) return true;
    return false;
  }

  static bool contains(const std::vector<int>& ring, int v) {
    return std::find(ring.begin(), ring.end(), v) != ring.end();
  }

  // --- out

  /// Vertices with few neighbours first; of each wave none next to one that is gone already.
  void takeOut() {
    for (int v = int(disk_.rim.size()); v < int(disk_.vertexCount); ++v) present_.push_back(v);
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<int> order = present_;
      std::stable_sort(order.begin(), order.end(),
                       [&](int a, int b) { return ring_[a].size() < ring_[b].size(); });
      std::set<int> touched, gone;
      for (const int v : order) {
        if (touched.contains(v)) continue;
        const std::vector<int> ring = ring_[v];
        if (!collapse(v)) continue;
        touched.insert(ring.begin(), ring.end());
        gone.insert(v);
        changed = true;
      }
      std::erase_if(present_, [&](int v) { return gone.contains(v); });
    }
  }

  /// Onto the neighbour that has the fewest, if there is one that can take it.
  bool collapse(int v) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < ring_[v].size(); ++k)
      if (isSound(v, k) && (!best || ring_[ring_[v][k]].size() < ring_[ring_[v][*best]].size())) best = k;
    if (!best) return false;
    std::vector<int> ring = ring_[v];
    std::rotate(ring.begin(), ring.begin() + long(*best), ring.end());
    const int u = ring.front();
    auto& around = ring_[u];
    const auto place = around.erase(std::find(around.begin(), around.end(), v));
    around.insert(place, ring.begin() + 2, ring.end() - 1);
    for (std::size_t i = 1; i < ring.size(); ++i) {
      auto& other = ring_[ring[i]];
      const auto mine = std::find(other.begin(), other.end(), v);
      if (i == 1 || i + 1 == ring.size())
        other.erase(mine);
      else
        *mine = u;
    }
    removed_.push_back({v, std::move(ring)});
    return true;
  }

  bool isSound(int v, std::size_t k) const {
    const auto& ring = ring_[v];
    const int u = ring[k];
    for (std::size_t i = 2; i + 1 < ring.size(); ++i) {
      const int r = ring[(k + i) % ring.size()];
      if (contains(ring_[u], r) || onOneSide(u, r)) return false;
    }
    return true;
  }

  // --- the rest

  /// Every vertex in the mean of its neighbours.
  bool mapRest() {
    if (present_.empty()) return true;
    const int n = int(present_.size());
    std::map<int, int> number;
    for (int i = 0; i < n; ++i) number[present_[i]] = i;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
    for (int i = 0; i < n; ++i) {
      const auto& ring = ring_[present_[i]];
      entries.emplace_back(i, i, 1.0);
      for (const int r : ring)
        if (const auto inner = number.find(r); inner != number.end())
          entries.emplace_back(i, inner->second, -1.0 / double(ring.size()));
        else
          right.row(i) += at(r).transpose() / double(ring.size());
    }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseLU<Eigen::SparseMatrix<double>> solver;
    solver.compute(matrix);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::MatrixXd x = solver.solve(right);
    for (int i = 0; i < n; ++i) place_[present_[i]] = scale_.round(Vector2d(x.row(i).transpose()));
    return std::all_of(present_.begin(), present_.end(), [&](int v) { return isPositive(v, place_[v]); });
  }

  // --- in

  bool isPositive(int v, FixedVector x) const {
    const auto& ring = ring_[v];
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (orientation(x, place_[ring[i]], place_[ring[(i + 1) % ring.size()]]) <= 0) return false;
    return true;
  }

  bool putIn(const Removed& back) {
    const auto& ring = back.ring;
    const int v = back.vertex, u = ring.front(), a = ring[1], b = ring.back();
    // Room first: the neighbours, while the triangles there are still one fan.
    for (const int r : ring) improve(r);
    auto& around = ring_[u];
    // The ring of an inner vertex has no begin; that of a rim vertex keeps its.
    if (disk_.isInner(u))
      std::rotate(around.begin(), std::find(around.begin(), around.end(), a), around.end());
    const auto from = around.insert(std::find(around.begin(), around.end(), a) + 1, v) + 1;
    const auto to = from + long(ring.size()) - 3;
    TRIMQUAD_ASSERT((to == around.end() ? around.front() : *to) == b);
    around.erase(from, to);
    for (std::size_t i = 1; i < ring.size(); ++i) {
      auto& other = ring_[ring[i]];
      const auto mine = std::find(other.begin(), other.end(), u);
      if (i == 1)
        other.insert(mine, v);
      else if (i + 1 == ring.size())
        other.insert(mine + 1, v);
      else
        *mine = v;
    }
    ring_[v] = ring;
    if (!placeNear(v, u, a, b)) return false;
    present_.push_back(v);
    improve(v);
    for (const int r : ring) improve(r);
    improve(v);
    return true;
  }

  /// On the bisector of the corner that the ring of `v` has at `u`, as far from `u` as keeps the triangles
  /// large.
  bool placeNear(int v, int u, int a, int b) {
    const Vector2d origin = at(u), toA = at(a) - origin, toB = at(b) - origin;
    double angle = std::atan2(toA.x() * toB.y() - toA.y() * toB.x(), toA.dot(toB));
    if (angle <= 0) angle += 2 * M_PI;
    const Vector2d along = Eigen::Rotation2Dd(angle / 2) * toA.normalized();
    double reach = std::max(toA.norm(), toB.norm());
    for (int k = 0; k < kHalvings; ++k, reach /= 2) {
      const FixedVector x = scale_.round(Vector2d(origin + reach * along));
      if (!isPositive(v, x)) continue;
      place_[v] = x;
      return true;
    }
    return false;
  }

  void sweep() {
    for (const int v : present_) improve(v);
  }

  std::optional<ShapeEnergy> energy(int v, const Vector2d& p) const {
    ShapeEnergy sum;
    const auto& ring = ring_[v];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d a = at(ring[i]), b = at(ring[(i + 1) % ring.size()]);
      const double area = (a - p).x() * (b - p).y() - (a - p).y() * (b - p).x();
      if (area <= 0) return {};
      sum.add(p, a, b, area);
    }
    return sum;
  }

  /// Newton steps of one vertex to the least energy of its triangles.
  void improve(int v) {
    if (!disk_.isInner(v)) return;
    for (int k = 0; k < kNewtonSteps; ++k) {
      const auto here = energy(v, at(v));
      if (!here) return;
      Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(here->hessian);
      const Vector2d values = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-12 * here->hessian.norm());
      const Vector2d step = -(eigen.eigenvectors() * values.cwiseInverse().asDiagonal() *
                              eigen.eigenvectors().transpose() * here->gradient);
      if (!step.allFinite()) return;
      double part = 1;
      bool moved = false;
      for (int i = 0; i < kHalvings && !moved; ++i, part /= 2) {
        const FixedVector x = scale_.round(Vector2d(at(v) + part * step));
        const auto there = energy(v, scale_.toQuads(x));
        if (!there || there->value >= here->value || !isPositive(v, x)) continue;
        place_[v] = x;
        moved = true;
      }
      if (!moved) return;
    }
  }

  const PatchDisk& disk_;
  FixedScale scale_;
  std::vector<std::vector<int>> ring_;  ///< by vertex, counter-clockwise; of a rim vertex from rim to rim
  std::vector<FixedVector> place_;      ///< by vertex
  std::vector<int> present_;            ///< inner vertices
  std::vector<Removed> removed_;
};

}  // namespace

std::optional<std::vector<FixedVector>> progressiveEmbedding(const PatchDisk& disk,
                                                             const std::vector<FixedVector>& rim,
                                                             FixedScale scale) {
  return Progression(disk, rim, scale).run();
}

}  // namespace trimquad
