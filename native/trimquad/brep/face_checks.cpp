#include "trimquad/brep/face_checks.h"

#include <BRepBndLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <optional>
#include <set>

#include "trimquad/base/byte_key.h"
#include "trimquad/base/parallel.h"
#include "trimquad/brep/cad_origin.h"
#include "trimquad/brep/face_separation.h"
#include "trimquad/brep/occt_guard.h"
#include "trimquad/brep/occt_parts.h"

namespace trimquad {
namespace {

/// Faces of one region that turn against each other by more than this somewhere along a common border may
/// cross beside it: around singularities, and where the region has a crease. Sine of 20 degrees.
constexpr double kBent = 0.342;
constexpr int kPlacesOfBorder = 64;

/// Processor time for a check of a face, of two for crossings, and of a whole model's elements, seconds, and
/// how many poles get a second more; thirty times of what usual ones take, and more.
constexpr int kSeconds = 8, kSecondsOfTwo = 5, kPolesPerSecond = 1000;
constexpr int kSecondsOfWhole = 10, kPolesOfWholePerSecond = 200;
/// Work of checks, in steps that take as long as those of fits.
constexpr long kWorkPerPole = 200, kWorkPerSecond = 2000000;

/// In place of the second face's number, where a face was checked with itself.
constexpr int kItself = -1;

const std::vector<std::string> kEndless{kCheckDoesNotEnd};

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

/// The pairs of faces that share an edge and are the likeliest to cross beside it: one of them has folds, or
/// they turn against each other; ascending.
std::set<std::pair<int, int>> neighboursToCheckFirst(const SplineModel& model,
                                                     const std::vector<int>& folded) {
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

/// The model's faces as they are in its STEP file, whose numbers are rounded: whether OpenCASCADE's
/// intersections end can hang on that. In the model's order.
std::vector<Shape> facesOfFile(const SplineModel& model) {
  return guarded(Error::Kind::Stage, "write", "the trimmed surfaces make no STEP file", [&] {
    const Shape read = shapeFromStep(stepText(assemble(model)), "STEP");
    const auto counted = elements(read.topology(), TopAbs_FACE);
    const auto order = faceOrder(model);
    if (counted.Extent() != int(order.size())) return assembledFaces(model);  // faultsOfWhole() tells
    std::vector<std::optional<Shape>> placed(order.size());
    for (int k = 0; k < int(order.size()); ++k) placed[order[k]].emplace(counted(k + 1));
    std::vector<Shape> result;
    for (auto& face : placed) result.push_back(std::move(*face));
    return result;
  });
}

/// The pairs of faces of one body whose boxes overlap and that may cross, ascending. Bodies may touch each
/// other, or cross: those of the input do.
std::vector<std::pair<int, int>> closePairs(const SplineModel& model, const std::vector<Shape>& faces) {
  std::vector<Bnd_Box> boxes(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) BRepBndLib::Add(faces[f].topology(), boxes[f]);
  std::vector<int> body(faces.size(), -1);
  for (const auto& shell : model.shells)
    for (const int f : shell.faces) body[f] = shell.body;
  const FaceSeparation separation(model);
  std::vector<std::pair<int, int>> result;
  for (int a = 0; a < int(faces.size()); ++a)
    for (int b = a + 1; b < int(faces.size()); ++b)
      if (body[a] == body[b] && !boxes[a].IsOut(boxes[b]) && !separation.areApart(a, b))
        result.push_back({a, b});
  return result;
}

/// Numbers of faces with their edges and vertices: the same for such as are the same, bit by bit.
class Numbers {
 public:
  Numbers(const SplineModel& model, std::map<std::string, int>& known) : model_(model), known_(known) {}

  int of(const SplineFace& face) {
    const auto& s = face.surface;
    ByteKey key;
    key.add('f');
    for (const int n : {s.degreeU, s.degreeV, s.countU, s.countV}) key.add(n);
    key.add(s.knotsU).add(s.knotsV).add(s.poles).add(face.loops.size());
    for (const auto& loop : face.loops) {
      key.add(loop.size());
      for (const auto& coedge : loop) add(key.add(of(coedge.edge)).add(coedge.forward), coedge.curve);
    }
    return number(key);
  }

 private:
  int of(SplineEdgeId id) {
    const auto [place, isNew] = edges_.try_emplace(id, 0);
    if (!isNew) return place->second;
    const auto& edge = model_.edges[id.index];
    ByteKey key;
    key.add('e');
    add(key, edge.curve);
    key.add(of(edge.start)).add(of(edge.end)).add(edge.tolerance);
    return edges_[id] = number(key);
  }
  int of(SplineVertexId id) {
    const auto& vertex = model_.vertices[id.index];
    ByteKey key;
    key.add('v').add(vertex.point).add(vertex.tolerance);
    return number(key);
  }
  template <int Dim>
  static void add(ByteKey& key, const SplineCurve<Dim>& curve) {
    key.add(curve.degree).add(curve.knots).add(curve.poles);
  }
  int number(const ByteKey& key) { return known_.try_emplace(key.bytes(), int(known_.size())).first->second; }

  const SplineModel& model_;
  std::map<std::string, int>& known_;
  std::map<SplineEdgeId, int> edges_;
};

}  // namespace

FaceChecks::FaceChecks(std::string checker) : checker_(std::move(checker)) {}

std::vector<std::vector<FaceFault>> FaceChecks::faults(const SplineModel& model,
                                                       const std::vector<int>& folded, int threads,
                                                       const Progress& progress) {
  return checked(model, folded, true, threads, progress);
}

std::vector<std::vector<FaceFault>> FaceChecks::likelyFaults(const SplineModel& model,
                                                             const std::vector<int>& folded, int threads,
                                                             const Progress& progress) {
  return checked(model, folded, false, threads, progress);
}

std::vector<std::vector<FaceFault>> FaceChecks::checked(const SplineModel& model,
                                                        const std::vector<int>& folded, bool allPairs,
                                                        int threads, const Progress& progress) {
  const auto faces = assembledFaces(model);
  std::vector<Shape> inFile;
  // Written and read where pairs are to be checked.
  const auto facesInFile = [&]() -> const std::vector<Shape>& {
    if (inFile.empty()) inFile = facesOfFile(model);
    return inFile;
  };
  Numbers numbers(model, numbers_);
  std::vector<int> number;
  for (const auto& face : model.faces) number.push_back(numbers.of(face));

  std::vector<std::vector<FaceFault>> result(faces.size());
  /// Checks of faces as they are, or, twice the same, of those in the file with themselves, or of pairs
  /// there.
  const auto check = [&](const std::vector<std::vector<int>>& groups) {
    std::vector<std::vector<int>> keys;
    std::vector<int> unknown;
    for (const auto& group : groups) {
      keys.emplace_back();
      for (const int f : group) keys.back().push_back(number[f]);
      if (group.size() > 1 && group.front() == group.back()) keys.back().back() = kItself;
      if (!known_.contains(keys.back())) unknown.push_back(int(keys.size()) - 1);
    }
    if (!unknown.empty() && groups[unknown.front()].size() > 1) facesInFile();
    std::vector<std::vector<std::string>> found(unknown.size());
    parallelEach(int(unknown.size()), threads, [&](int k) {
      progress.check();
      const auto& group = groups[unknown[k]];
      const bool inMemory = group.size() == 1, alone = group.front() == group.back();
      const auto& source = inMemory ? faces : inFile;
      const FaultKinds kinds{.elements = inMemory, .crossings = !inMemory, .selfCrossings = alone};
      int poles = int(model.faces[group.front()].surface.poles.size());
      if (!alone) poles += int(model.faces[group.back()].surface.poles.size());
      const int seconds = (alone ? kSeconds : kSecondsOfTwo) + poles / kPolesPerSecond;
      const Shape shape =
          alone ? source[group.front()] : compound({source[group.front()], source[group.back()]});
      const auto answer = checker_.faults(shape, kinds, seconds, progress);
      found[k] = answer ? *answer : kEndless;
      progress.addWork(answer ? kWorkPerPole * poles : kWorkPerSecond * seconds);
      progress.report((k + 1.0) / double(unknown.size()));
    });
    for (std::size_t k = 0; k < unknown.size(); ++k) known_[keys[unknown[k]]] = found[k];
    for (std::size_t k = 0; k < groups.size(); ++k)
      for (const std::string& what : known_[keys[k]]) {
        const int a = groups[k].front(), b = groups[k].back();
        if (a == b) {
          result[a].push_back({what, {}});
        } else {
          result[a].push_back({what, b});
          result[b].push_back({what, a});
        }
      }
  };
  const auto isClean = [&](int f) { return result[f].empty(); };
  const auto checkPairs = [&](const auto& pairs) {
    std::vector<std::vector<int>> groups;
    for (const auto& [a, b] : pairs)
      if (isClean(a) && isClean(b)) groups.push_back({a, b});
    check(groups);
  };
  std::vector<std::vector<int>> single;
  for (int f = 0; f < int(faces.size()); ++f) single.push_back({f});
  check(single);
  std::vector<std::pair<int, int>> withItself;
  for (int f = 0; f < int(faces.size()); ++f) withItself.push_back({f, f});
  checkPairs(withItself);
  checkPairs(neighboursToCheckFirst(model, folded));
  if (allPairs &&
      std::all_of(result.begin(), result.end(), [](const auto& faults) { return faults.empty(); }))
    checkPairs(closePairs(model, facesInFile()));
  return result;
}

std::optional<MeetingFaces> FaceChecks::meetingCadFaces(const Model& model, int regionA, int regionB,
                                                        const Progress& progress) const {
  if (!model.origin) return {};
  const CadModel& cad = model.origin->shape->cad;
  const WeldedMesh& mesh = model.origin->shape->mesh;
  const auto facesOf = [&](int region) {
    std::map<int, Bnd_Box> boxes;
    for (const int t : model.origin->triangles.at(region)) boxes[mesh.triangles[t].face];
    for (auto& [face, box] : boxes) BRepBndLib::Add(cad.faces[face].face, box);
    return boxes;
  };
  const auto facesA = facesOf(regionA), facesB = facesOf(regionB);
  const auto isOfBoth = [](const std::string& what) {
    return what.starts_with("Face1, Face2") || what.starts_with("Face2, Face1");
  };
  std::optional<MeetingFaces> touching;
  for (const auto& [a, boxA] : facesA)
    for (const auto& [b, boxB] : facesB) {
      if (a == b || boxA.IsOut(boxB)) continue;
      const auto met = checker_.faults(compound({Shape(cad.faces[a].face), Shape(cad.faces[b].face)}),
                                       {.elements = false, .selfCrossings = false}, kSecondsOfTwo, progress);
      if (!met || met->empty()) continue;
      const bool cross = std::any_of(met->begin(), met->end(), isOfBoth);
      if (cross || !touching) touching = {cad.faces[a].name, cad.faces[b].name, cross};
      if (cross) return touching;
    }
  return touching;
}

std::vector<std::string> FaceChecks::faultsOfWhole(const SplineModel& model, const Progress& progress) const {
  const Shape shape = assemble(model), read = shapeFromStep(stepText(shape), "STEP");
  int poles = 0;
  for (const auto& face : model.faces) poles += int(face.surface.poles.size());
  std::vector<std::string> found;
  for (const Shape* whole : {&shape, &read}) {
    const auto answer =
        checker_.faults(*whole, {true, false}, kSecondsOfWhole + poles / kPolesOfWholePerSecond, progress);
    found = answer ? *answer : kEndless;
    if (!found.empty()) return found;
  }
  if (read.faceCount() != shape.faceCount())
    found.push_back("its STEP file has " + std::to_string(read.faceCount()) + " faces instead of " +
                    std::to_string(shape.faceCount()));
  return found;
}

}  // namespace trimquad
