#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "trimquad/base/error.h"
#include "trimquad/seamless/convex_start.h"
#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {
namespace {

/// Radius of the frame over half the length of the outer loop, which no map without distortion reaches
/// beyond.
constexpr double kFrameRoom = 1.2;
/// Width of a collar around the outer loop, quads, and the weight of its area beside the region's: where the
/// boundary comes close to itself, a surface has to get from one side to the other in between.
constexpr double kCollar = 0.5, kCollarWeight = 0.1;
constexpr int kScaffoldRounds = 100, kStepsPerRound = 4;
constexpr double kScaffoldWeight = 1e-2;  ///< of the region's energy, for the scaffold as a whole
/// Least relative decrease of the energy in a round, and rounds in a row that may stay below it.
constexpr double kWorthARound = 2e-3;
constexpr int kPatience = 3;
/// Steps of Progress that a triangle's share of an iteration takes.
constexpr long kWorkOnTriangle = 8;

/// A plane region with a collar and rings around its outer loop, and its other holes filled by a fan each;
/// positions in the plane.
struct Frame {
  TriangleSoup soup;  // the region's triangles first; points are not used but for their number
  MapTarget collar;   ///< of the triangles that follow, next to the outer loop
  std::vector<Eigen::Vector2d> position;
  std::vector<int> outermost;  ///< vertices of the last ring
  /// The basis holds vertex 0 at the origin. That must be one of the outermost ring, which does not move
  /// anyway, so the region's vertex 0 and the first of the ring have changed numbers.
  int zero = 0;
  int number(int vertex) const { return vertex == 0 ? zero : vertex == zero ? 0 : vertex; }
};

std::array<int, 3> corners(const SurfaceMesh& mesh, FaceHandle f) {
  const auto h = mesh.halfedge_handle(f), n = mesh.next_halfedge_handle(h);
  return {mesh.from_vertex_handle(h).idx(), mesh.to_vertex_handle(h).idx(), mesh.to_vertex_handle(n).idx()};
}

/// Factors from ring to ring around a circle of this radius, the last to a ring with room for the unrolled
/// region.
std::vector<double> ringGrowths(double radius, double outerLoop) {
  std::vector<double> growths{1.15, 1.3, 1.5, 1.8};
  for (const double growth : growths) radius *= growth;
  const double missing = kFrameRoom * outerLoop / 2 / radius;
  if (missing > 1.1) growths.push_back(missing);
  return growths;
}

/// Length of a boundary edge in the target, quads.
double lengthOf(const SurfaceMesh& mesh, const MapTarget& target, HalfedgeHandle boundary) {
  const HalfedgeHandle inner = mesh.opposite_halfedge_handle(boundary);
  const FaceHandle f = mesh.face_handle(inner);
  int k = 0;
  for (HalfedgeHandle at = mesh.halfedge_handle(f); at != inner; at = mesh.next_halfedge_handle(at)) ++k;
  return (target[f.idx()][(k + 1) % 3] - target[f.idx()][k]).norm();
}

using Loop = std::vector<HalfedgeHandle>;

/// Collar and rings of ever larger triangles around the circle on which the outer loop lies.
void surround(const SurfaceMesh& mesh, const Loop& loop, const MapTarget& target, Frame& frame) {
  const int n = int(loop.size());
  std::vector<int> ring(n);
  std::vector<double> length(n);
  for (int i = 0; i < n; ++i) {
    ring[i] = mesh.from_vertex_handle(loop[i]).idx();
    length[i] = lengthOf(mesh, target, loop[i]);
  }
  const double around = std::accumulate(length.begin(), length.end(), 0.0);
  for (const double growth : ringGrowths(frame.position[ring[0]].norm(), around)) {
    std::vector<int> next(n);
    for (int i = 0; i < n; ++i) {
      next[i] = int(frame.position.size());
      const Eigen::Vector2d p = growth * frame.position[ring[i]];
      frame.position.push_back(p);
    }
    const bool isCollar = frame.collar.empty();
    for (int i = 0; i < n; ++i) {
      const int j = (i + 1) % n;
      frame.soup.triangles.push_back({ring[i], ring[j], next[j]});
      frame.soup.triangles.push_back({ring[i], next[j], next[i]});
      if (!isCollar) continue;
      const Eigen::Vector2d a(0, 0), b(length[i], 0), up(0, kCollar);
      frame.collar.push_back({a, b, b + up});
      frame.collar.push_back({a, b + up, a + up});
    }
    ring = next;
  }
  frame.outermost = ring;
}

void fill(const SurfaceMesh& mesh, const Loop& loop, Frame& frame) {
  const int centre = int(frame.position.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto h : loop) mean += frame.position[mesh.from_vertex_handle(h).idx()] / double(loop.size());
  frame.position.push_back(mean);
  for (const auto h : loop)
    frame.soup.triangles.push_back(
        {mesh.from_vertex_handle(h).idx(), mesh.to_vertex_handle(h).idx(), centre});
}

Frame frameAround(const SurfaceMesh& mesh, int outer, const MapTarget& target,
                  std::vector<Eigen::Vector2d> position) {
  Frame result;
  result.position = std::move(position);
  for (const auto f : mesh.faces()) result.soup.triangles.push_back(corners(mesh, f));
  const auto loops = boundaryLoops(mesh);
  surround(mesh, loops[outer], target, result);
  for (int l = 0; l < int(loops.size()); ++l)
    if (l != outer) fill(mesh, loops[l], result);
  result.zero = result.outermost.front();
  for (auto& triangle : result.soup.triangles)
    for (int& v : triangle) v = result.number(v);
  for (int& v : result.outermost) v = result.number(v);
  std::swap(result.position[0], result.position[result.zero]);
  for (const auto& p : result.position) result.soup.points.emplace_back(p.x(), p.y(), 0);
  return result;
}

/// Twice the area of a triangle.
double doubleArea(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double cotangent(const Eigen::Vector2d& at, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a - at).dot(b - at) / doubleArea(at, a, b);
}

/// A region's map within its scaffold.
class ScaffoldedMap {
 public:
  ScaffoldedMap(const Frame& frame, const MapTarget& target)
      : mesh_(buildSurfaceMesh(frame.soup)),
        regionFaces_(int(target.size())),
        target_(target),
        position_(frame.position) {
    target_.insert(target_.end(), frame.collar.begin(), frame.collar.end());
    for (int f = 0; f < int(target_.size()); ++f) {
      // The mesh may have another corner of the triangle first.
      const auto& corner = frame.soup.triangles[f];
      const int first = corners(mesh_, mesh_.face_handle(f))[0];
      std::rotate(target_[f].begin(),
                  target_[f].begin() + (std::find(corner.begin(), corner.end(), first) - corner.begin()),
                  target_[f].end());
    }
    for (const auto& corner : frame.collar)
      collarWeight_ +=
          kCollarWeight * doubleArea(corner[0], corner[1], corner[2]) / 2 / double(frame.collar.size());
    isOutermost_.assign(mesh_.n_vertices(), 0);
    for (const int v : frame.outermost) isOutermost_[v] = 1;
  }

  /// Scaffold triangles become those of the constrained Delaunay triangulation of their vertices: thin ones
  /// would hold the region's boundary where it is.
  void remesh() {
    std::vector<EdgeHandle> stack;
    for (const auto e : mesh_.edges()) stack.push_back(e);
    std::vector<char> waits(mesh_.n_edges(), 1);
    // By Lawson's theorem flips end; doubles close to a circle must not go on for ever.
    for (std::size_t left = 50 * mesh_.n_edges(); !stack.empty() && left > 0; --left) {
      const EdgeHandle e = stack.back();
      stack.pop_back();
      waits[e.idx()] = 0;
      if (!isToBeFlipped(e)) continue;
      mesh_.flip(e);
      for (const int side : {0, 1}) {
        const HalfedgeHandle h = mesh_.halfedge_handle(e, side), next = mesh_.next_halfedge_handle(h);
        for (const auto around : {next, mesh_.next_halfedge_handle(next)}) {
          const EdgeHandle other = mesh_.edge_handle(around);
          if (!waits[other.idx()]) stack.push_back(other);
          waits[other.idx()] = 1;
        }
      }
    }
  }

  /// Newton steps on the energy of region and collar. The scaffold's target is its present shape, so that it
  /// yields but never folds. Gives the region's energy before.
  template <class Step>
  double improve(double follow, const Step& step) {
    SeamGraph none;
    none.crossing.resize(mesh_.n_halfedges());
    const SeamBasis basis(mesh_, none, {});
    MapEnergy energy(mesh_, wholeTarget(), basis);
    Eigen::VectorXd x = coordinates(basis);
    if (follow > 0) {
      turnTarget(energy, x);
      energy.aim(wholeTarget());
    }
    energy.setScaffold(regionFaces_, 0);
    const double regionEnergy = energy.value(x, symmetricDirichlet, follow);
    energy.setScaffold(regionFaces_, collarWeight_);
    energy.setScaffold(firstScaffold(),
                       kScaffoldWeight * regionEnergy / (4.0 * double(mesh_.n_faces() - firstScaffold())));
    Eigen::VectorXd z = basis.basis().restrict(x);
    const std::vector<int> held = heldUnknowns(basis);
    for (int i = 0; i < kStepsPerRound; ++i) {
      newtonStep(energy, symmetricDirichlet, follow, true, solver_, z, held);
      step();
    }
    x = basis.basis().matrix() * z + basis.basis().offset();
    const Eigen::Vector2d origin = position_[0];  // where the basis has zero
    for (const auto h : mesh_.halfedges())
      if (!mesh_.is_boundary(h))
        for (int axis = 0; axis < 2; ++axis)
          position_[mesh_.from_vertex_handle(h).idx()][axis] =
              x[basis.coordinate(basis.wedge(h), axis)] + origin[axis];
    return regionEnergy;
  }

  int turnedOver() const {
    int count = 0;
    for (const auto f : mesh_.faces()) {
      const auto [a, b, c] = corners(mesh_, f);
      count += !(doubleArea(position_[a], position_[b], position_[c]) > 0);
    }
    return count;
  }
  /// In the plane of the target as it was given.
  Eigen::Vector2d position(int vertex) const { return turned_.inverse() * position_[vertex]; }

 private:
  int firstScaffold() const { return int(target_.size()); }
  bool isScaffold(HalfedgeHandle h) const {
    return !mesh_.is_boundary(h) && mesh_.face_handle(h).idx() >= firstScaffold();
  }
  const Eigen::Vector2d& apex(HalfedgeHandle h) const {
    return position_[mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)).idx()];
  }

  /// Whether the edge's circle test fails, and its other diagonal leaves both triangles area.
  bool isToBeFlipped(EdgeHandle e) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(e, 0), opposite = mesh_.halfedge_handle(e, 1);
    if (!isScaffold(h) || !isScaffold(opposite) || !mesh_.is_flip_ok(e)) return false;
    const Eigen::Vector2d &a = position_[mesh_.from_vertex_handle(h).idx()],
                          &b = position_[mesh_.to_vertex_handle(h).idx()], &c = apex(h), &d = apex(opposite);
    constexpr double kClearly = 1e-6, kFlat = 1e-9;
    if (!(cotangent(c, a, b) + cotangent(d, b, a) < -kClearly)) return false;
    const double least = kFlat * (d - c).squaredNorm();
    return doubleArea(a, d, c) > least && doubleArea(b, c, d) > least;
  }

  /// So that the map as a whole need not turn to follow the target: the scaffold would turn slowly.
  void turnTarget(const MapEnergy& energy, const Eigen::VectorXd& x) {
    std::complex<double> sum = 0;
    for (int f = 0; f < regionFaces_; ++f) {
      const auto j = energy.jacobian(f, x);
      sum += doubleArea(target_[f][0], target_[f][1], target_[f][2]) * std::complex(j.fzReal, j.fzImag);
    }
    const Eigen::Rotation2Dd turn(std::arg(sum));
    for (int f = 0; f < regionFaces_; ++f)
      for (auto& corner : target_[f]) corner = turn * corner;
    turned_ = turned_ * turn;
  }

  MapTarget wholeTarget() const {
    MapTarget whole = target_;
    for (const auto f : mesh_.faces()) {
      if (f.idx() < firstScaffold()) continue;
      const auto [a, b, c] = corners(mesh_, f);
      whole.push_back({position_[a], position_[b], position_[c]});
    }
    return whole;
  }

  Eigen::VectorXd coordinates(const SeamBasis& basis) const {
    Eigen::VectorXd x(basis.basis().variableCount());
    for (const auto h : mesh_.halfedges())
      if (!mesh_.is_boundary(h))
        for (int axis = 0; axis < 2; ++axis)
          x[basis.coordinate(basis.wedge(h), axis)] =
              position_[mesh_.from_vertex_handle(h).idx()][axis] - position_[0][axis];
    return x;
  }

  /// The outermost ring stays convex, so that the whole is one to one as long as no triangle is turned over.
  std::vector<int> heldUnknowns(const SeamBasis& basis) const {
    std::vector<char> isHeld(basis.basis().variableCount(), 0);
    for (const auto h : mesh_.halfedges())
      if (!mesh_.is_boundary(h) && isOutermost_[mesh_.from_vertex_handle(h).idx()])
        for (int axis = 0; axis < 2; ++axis) isHeld[basis.coordinate(basis.wedge(h), axis)] = 1;
    std::vector<int> held;
    for (int i = 0; i < basis.basis().freeCount(); ++i)
      if (isHeld[basis.basis().freeVariable(i)]) held.push_back(i);
    return held;
  }

  SurfaceMesh mesh_;
  int regionFaces_;
  double collarWeight_ = 0;  ///< of a triangle
  MapTarget target_;         ///< of region and collar
  std::vector<Eigen::Vector2d> position_;
  std::vector<char> isOutermost_;
  Eigen::Rotation2Dd turned_{0};  ///< the target
  SparseSolver solver_{"seamless"};
};

}  // namespace

Eigen::VectorXd oneToOneMap(const SurfaceMesh& mesh, const SeamGraph& seams, const MapTarget& target,
                            const SeamBasis& basis, double follow, MapCounters& counters,
                            const Progress& progress) {
  TRIMQUAD_ASSERT(basis.branchCount() == 0);
  double area = 0;
  for (const auto& t : target) {
    const Eigen::Vector2d a = t[1] - t[0], b = t[2] - t[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  const auto start = convexStart(mesh, seams, basis, area, std::nullopt);
  TRIMQUAD_ASSERT(start.has_value());
  std::vector<Eigen::Vector2d> position(mesh.n_vertices());
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h))
      for (int axis = 0; axis < 2; ++axis)
        position[mesh.from_vertex_handle(h).idx()][axis] = (*start)[basis.coordinate(basis.wedge(h), axis)];
  const Frame frame = frameAround(mesh, *seams.outerLoop, target, std::move(position));
  ScaffoldedMap map(frame, target);
  if (map.turnedOver() > 0)
    throw stageError("seamless",
                     "a convex embedding of the region is too narrow for floating point; refine the mesh");
  double previous = INFINITY;
  int stalled = 0;
  for (int round = 0; round < kScaffoldRounds && stalled < kPatience; ++round) {
    map.remesh();
    const double energy = map.improve(follow, [&] {
      ++counters.iterations;
      progress.addWork(kWorkOnTriangle * long(mesh.n_faces()));
      progress.check();
    });
    progress.report(0.5 + 0.5 * round / kScaffoldRounds);
    stalled = energy > previous * (1 - kWorthARound) ? stalled + 1 : 0;
    previous = energy;
  }
  Eigen::VectorXd mine(basis.basis().variableCount());
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h))
      for (int axis = 0; axis < 2; ++axis)
        mine[basis.coordinate(basis.wedge(h), axis)] =
            map.position(frame.number(mesh.from_vertex_handle(h).idx()))[axis];
  const Eigen::Vector2d origin(mine[basis.coordinate(0, 0)], mine[basis.coordinate(0, 1)]);
  for (int w = 0; w < basis.wedgeCount(); ++w)
    for (int axis = 0; axis < 2; ++axis) mine[basis.coordinate(w, axis)] -= origin[axis];
  const MapEnergy energy(mesh, target, basis);
  counters.distortionEnd = energy.meanSymmetricDirichlet(mine);
  return basis.basis().restrict(mine);
}

}  // namespace trimquad
