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

/// The pairs of faces that share an edge, one of them at least among these; ascending.
std::set<std::pair<int, int>> neighboursOf(const SplineModel& model, const std::vector<int>& faces) {
  std::vector<std::vector<int>> users(model.edges.size());
  for (int f = 0; f < int(model.faces.size()); ++f)
    for (const auto& loop : model.faces[f].loops)
      for (const auto& coedge : loop) users[coedge.edge.index].push_back(f);
  std::set<std::pair<int, int>> result;
  for (const int f : faces)
    for (const auto& loop : model.faces.at(f).loops)
      for (const auto& coedge : loop)
        for (const int other : users[coedge.edge.index])
          if (other != f) result.insert(std::minmax(f, other));
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
  for (const auto& [a, b] : neighboursOf(model, folded))
    if (result[a].empty() && result[b].empty()) pairs.push_back({a, b});
  const auto together = check(pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (const int face : pairs[k])
      result[face].insert(result[face].end(), together[k].begin(), together[k].end());
  known_ = std::move(checked);
  return result;
}

}  // namespace trimquad
