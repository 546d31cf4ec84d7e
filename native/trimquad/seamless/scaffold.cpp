#include <cmath>
#include <numbers>

#include "trimquad/base/error.h"
#include "trimquad/seamless/convex_start.h"
#include "trimquad/seamless/newton.h"
#include "trimquad/seamless/solve_map.h"

namespace trimquad {
namespace {

/// Radius of the frame over half the length of the outer loop, which no map without distortion reaches
/// beyond.
constexpr double kFrameRoom = 1.2;
constexpr int kRounds = 100, kStepsPerRound = 4;
constexpr double kScaffoldWeight = 1e-2;  ///< of the region's energy, for the scaffold as a whole
/// Least relative decrease of the energy in a round, and rounds in a row that may stay below it.
constexpr double kWorthARound = 2e-3;
constexpr int kPatience = 3;

/// A plane region with its holes filled by a fan each and its outer loop surrounded by rings; positions in
/// the plane.
struct Frame {
  TriangleSoup soup;  // the region's triangles first; points are not used but for their number
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

/// \param outerLoop length of the outer loop without distortion, quads
Frame frameAround(const SurfaceMesh& mesh, int outer, double outerLoop,
                  std::vector<Eigen::Vector2d> position) {
  Frame result;
  for (const auto f : mesh.faces()) result.soup.triangles.push_back(corners(mesh, f));
  const auto loops = boundaryLoops(mesh);
  for (int l = 0; l < int(loops.size()); ++l) {
    const auto& loop = loops[l];
    if (l != outer) {
      const int centre = int(position.size());
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (const auto h : loop) mean += position[mesh.from_vertex_handle(h).idx()] / double(loop.size());
      position.push_back(mean);
      for (const auto h : loop)
        result.soup.triangles.push_back(
            {mesh.from_vertex_handle(h).idx(), mesh.to_vertex_handle(h).idx(), centre});
      continue;
    }
    // Rings of ever larger triangles around the circle on which the outer loop lies.
    const int n = int(loop.size());
    std::vector<int> ring(n);
    for (int i = 0; i < n; ++i) ring[i] = mesh.from_vertex_handle(loop[i]).idx();
    for (const double growth : ringGrowths(position[ring[0]].norm(), outerLoop)) {
      std::vector<int> next(n);
      for (int i = 0; i < n; ++i) {
        next[i] = int(position.size());
        const Eigen::Vector2d p = growth * position[ring[i]];
        position.push_back(p);
      }
      for (int i = 0; i < n; ++i) {
        const int j = (i + 1) % n;
        result.soup.triangles.push_back({ring[i], ring[j], next[j]});
        result.soup.triangles.push_back({ring[i], next[j], next[i]});
      }
      ring = next;
    }
    result.outermost = ring;
  }
  result.zero = result.outermost.front();
  for (auto& triangle : result.soup.triangles)
    for (int& v : triangle) v = result.number(v);
  for (int& v : result.outermost) v = result.number(v);
  std::swap(position[0], position[result.zero]);
  result.position = std::move(position);
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
      : mesh_(buildSurfaceMesh(frame.soup)), target_(target), position_(frame.position) {
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

  /// Newton steps on the region's energy. The scaffold's target is its present shape, so that it yields but
  /// never folds. Gives the energy before.
  template <class Step>
  double improve(double follow, const Step& step) {
    SeamGraph none;
    none.crossing.resize(mesh_.n_halfedges());
    const SeamBasis basis(mesh_, none, {});
    MapEnergy energy(mesh_, wholeTarget(), basis);
    Eigen::VectorXd x = coordinates(basis);
    energy.setScaffold(regionFaces(), 0);
    const double regionEnergy = energy.value(x, symmetricDirichlet, follow);
    energy.setScaffold(regionFaces(),
                       kScaffoldWeight * regionEnergy / (4.0 * double(mesh_.n_faces() - regionFaces())));
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
  const Eigen::Vector2d& position(int vertex) const { return position_[vertex]; }

 private:
  int regionFaces() const { return int(target_.size()); }
  bool isScaffold(HalfedgeHandle h) const {
    return !mesh_.is_boundary(h) && mesh_.face_handle(h).idx() >= regionFaces();
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
    constexpr double kClearly = 1e-6;
    if (!(cotangent(c, a, b) + cotangent(d, b, a) < -kClearly)) return false;
    const double size = kClearly * (d - c).squaredNorm();
    return doubleArea(a, d, c) > size * 1e-3 && doubleArea(b, c, d) > size * 1e-3;
  }

  MapTarget wholeTarget() const {
    MapTarget whole = target_;
    for (const auto f : mesh_.faces()) {
      if (f.idx() < regionFaces()) continue;
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
  const MapTarget& target_;  ///< of the region
  std::vector<Eigen::Vector2d> position_;
  std::vector<char> isOutermost_;
  SparseSolver solver_{"seamless"};
};

/// Length of a loop in the target, quads.
double lengthOf(const SurfaceMesh& mesh, const MapTarget& target, const std::vector<HalfedgeHandle>& loop) {
  double length = 0;
  for (const auto h : loop) {
    const HalfedgeHandle inner = mesh.opposite_halfedge_handle(h);
    const FaceHandle f = mesh.face_handle(inner);
    int k = 0;
    for (HalfedgeHandle at = mesh.halfedge_handle(f); at != inner; at = mesh.next_halfedge_handle(at)) ++k;
    length += (target[f.idx()][(k + 1) % 3] - target[f.idx()][k]).norm();
  }
  return length;
}

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
  const auto outer = boundaryLoops(mesh)[*seams.outerLoop];
  const Frame frame = frameAround(mesh, *seams.outerLoop, lengthOf(mesh, target, outer), std::move(position));
  ScaffoldedMap map(frame, target);
  if (map.turnedOver() > 0)
    throw stageError("seamless",
                     "a convex embedding of the region is too narrow for floating point; refine the mesh");
  double previous = INFINITY;
  int stalled = 0;
  for (int round = 0; round < kRounds && stalled < kPatience; ++round) {
    map.remesh();
    const double energy = map.improve(follow, [&] {
      ++counters.iterations;
      progress.check();
    });
    progress.report(0.5 + 0.5 * round / kRounds);
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
