#include "trimquad/brep/face_checks.h"

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <optional>
#include <set>

#include "trimquad/base/byte_key.h"
#include "trimquad/base/parallel.h"
#include "trimquad/brep/assemble.h"
#include "trimquad/brep/occt_guard.h"

namespace trimquad {
namespace {

/// Faces of one region that turn against each other by more than this somewhere along a common border may
/// cross beside it: around singularities, and where the region has a crease. Sine of 20 degrees.
constexpr double kBent = 0.342;
constexpr int kPlacesOfBorder = 64;

struct EdgeUse {
  int face;
  const SplineCoedge* coedge;
};

bool isBent(const SplineModel& model, const EdgeUse& a, const EdgeUse& b) {
  const SplineFace &faceA = model.faces[a.face], &faceB = model.faces[b.face];
  if (a.face == b.face || faceA.region != faceB.region) return false;
  const auto normal = [](const SplineFace& face, const PlaneCurve& curve, double s) -> Eigen::Vector3d {
    const Eigen::Vector2d x = curve.point(s);
    const auto jet = face.surface.jet(x[0], x[1]);
    return jet.su.cross(jet.sv);
  };
  const PlaneCurve &onA = a.coedge->curve, &onB = b.coedge->curve;
  for (int i = 0; i < kPlacesOfBorder; ++i) {
    const double s = onA.first() + (onA.last() - onA.first()) * (i + 0.5) / kPlacesOfBorder;
    const Eigen::Vector3d m = normal(faceA, onA, s), n = normal(faceB, onB, s);
    if (m.dot(n) <= 0 || m.cross(n).norm() > kBent * m.norm() * n.norm()) return true;
  }
  return false;
}

/// The pairs of faces that share an edge and may cross beside it: one of them has folds, or they turn against
/// each other; ascending.
std::set<std::pair<int, int>> neighboursToCheck(const SplineModel& model, const std::vector<int>& folded) {
  std::vector<std::vector<EdgeUse>> users(model.edges.size());
  for (int f = 0; f < int(model.faces.size()); ++f)
    for (const auto& loop : model.faces[f].loops)
      for (const auto& coedge : loop) users[coedge.edge.index].push_back({f, &coedge});
  std::set<std::pair<int, int>> result;
  for (const int f : folded)
    for (const auto& loop : model.faces.at(f).loops)
      for (const auto& coedge : loop)
        for (const auto& other : users[coedge.edge.index])
          if (other.face != f) result.insert(std::minmax(f, other.face));
  for (const auto& uses : users)
    if (uses.size() == 2 && isBent(model, uses[0], uses[1]))
      result.insert(std::minmax(uses[0].face, uses[1].face));
  return result;
}

Shape compound(const std::vector<Shape>& faces) {
  TopoDS_Compound result;
  BRep_Builder builder;
  builder.MakeCompound(result);
  for (const auto& face : faces) builder.Add(result, face.topology());
  return Shape(result);
}

/// Faces with their edges and vertices as bytes: the same for faces that are the same.
class Description {
 public:
  explicit Description(const SplineModel& model) : model_(model) {}

  void add(const SplineFace& face) {
    const auto& s = face.surface;
    for (const int n : {s.degreeU, s.degreeV, s.countU, s.countV}) key_.add(n);
    key_.add(s.knotsU).add(s.knotsV).add(s.poles).add(face.loops.size());
    for (const auto& loop : face.loops) {
      key_.add(loop.size());
      for (const auto& coedge : loop) {
        add(coedge.edge);
        key_.add(coedge.forward);
        add(coedge.curve);
      }
    }
  }
  std::string bytes() && { return std::move(key_).bytes(); }

 private:
  template <int Dim>
  void add(const SplineCurve<Dim>& curve) {
    key_.add(curve.degree).add(curve.knots).add(curve.poles);
  }
  void add(SplineVertexId id) {
    const auto [place, isNew] = vertices_.try_emplace(id, int(vertices_.size()));
    key_.add(place->second);
    if (!isNew) return;
    const auto& vertex = model_.vertices[id.index];
    key_.add(vertex.point).add(vertex.tolerance);
  }
  void add(SplineEdgeId id) {
    const auto [place, isNew] = edges_.try_emplace(id, int(edges_.size()));
    key_.add(place->second);
    if (!isNew) return;
    const auto& edge = model_.edges[id.index];
    add(edge.curve);
    add(edge.start);
    add(edge.end);
    key_.add(edge.tolerance);
  }

  const SplineModel& model_;
  std::map<SplineVertexId, int> vertices_;
  std::map<SplineEdgeId, int> edges_;
  ByteKey key_;
};

}  // namespace

std::vector<std::vector<std::string>> FaceChecks::faults(const SplineModel& model,
                                                         const std::vector<int>& folded, int threads) {
  const auto faces = assembledFaces(model);
  std::map<std::string, std::vector<std::string>> checked;
  const auto check = [&](const std::vector<std::vector<int>>& groups) {
    std::vector<std::string> keys;
    for (const auto& group : groups) {
      Description description(model);
      for (const int f : group) description.add(model.faces[f]);
      keys.push_back(std::move(description).bytes());
    }
    std::vector<std::vector<std::string>> found(groups.size());
    parallelEach(int(groups.size()), threads, [&](int k) {
      if (const auto before = known_.find(keys[k]); before != known_.end()) {
        found[k] = before->second;
        return;
      }
      std::vector<Shape> members;
      for (const int f : groups[k]) members.push_back(faces[f]);
      found[k] = trimquad::faults(members.size() == 1 ? members[0] : compound(members));
    });
    for (std::size_t k = 0; k < groups.size(); ++k) checked.emplace(std::move(keys[k]), found[k]);
    return found;
  };
  std::vector<std::vector<int>> single, pairs;
  for (int f = 0; f < int(faces.size()); ++f) single.push_back({f});
  auto result = check(single);
  for (const auto& [a, b] : neighboursToCheck(model, folded))
    if (result[a].empty() && result[b].empty()) pairs.push_back({a, b});
  const auto together = check(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (const int face : pairs[k])
      result[face].insert(result[face].end(), together[k].begin(), together[k].end());
  known_ = std::move(checked);
  return result;
}

}  // namespace trimquad
