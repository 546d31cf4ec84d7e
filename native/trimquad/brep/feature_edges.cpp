#include "trimquad/brep/feature_edges.h"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "trimquad/base/error.h"
#include "trimquad/brep/surface_normal.h"

namespace trimquad {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Triangle = WeldedMesh::Triangle;

constexpr std::array<double, 3> kSamples{1. / 6, 1. / 2, 5. / 6};  // along a side

/// True normal at the fraction `s` of the triangle's side k, `reach` inside; `along` false runs the side
/// backwards.
Vector3d normalBesideSide(const CadModel& model, const WeldedMesh& mesh, const Triangle& triangle, int k,
                          double s, bool along, double reach) {
  const Vector2d &a = triangle.uv[k], &b = triangle.uv[(k + 1) % 3];
  const Vector2d uv = along ? Vector2d((1 - s) * a + s * b) : Vector2d(s * a + (1 - s) * b);
  const Vector2d &apex = triangle.uv[(k + 2) % 3], inside = (a + b + apex) / 3;
  const Vector3d p = mesh.vertices[triangle.vertex[k]].point,
                 q = mesh.vertices[triangle.vertex[(k + 1) % 3]].point,
                 r = mesh.vertices[triangle.vertex[(k + 2) % 3]].point;
  const double height = (q - p).cross(r - p).norm() / (q - p).norm();
  const double share = height > 0 ? std::min(0.5, reach / height) : 0;
  return surfaceNormal(*model.faces[triangle.face].surface, (1 - share) * uv + share * apex, inside);
}

double areaOf(const WeldedMesh& mesh, const Triangle& triangle) {
  const Vector3d& a = mesh.vertices[triangle.vertex[0]].point;
  return 0.5 * (mesh.vertices[triangle.vertex[1]].point - a)
                   .cross(mesh.vertices[triangle.vertex[2]].point - a)
                   .norm();
}

double volumeOf(const WeldedMesh& mesh, const Triangle& triangle, const Vector3d& origin) {
  return (mesh.vertices[triangle.vertex[0]].point - origin)
             .dot((mesh.vertices[triangle.vertex[1]].point - origin)
                      .cross(mesh.vertices[triangle.vertex[2]].point - origin)) /
         6;
}

/// Faces joined across edges, each with its orientation relative to the group's first face.
class FaceGroups {
 public:
  explicit FaceGroups(size_t count) : parent_(count), flipped_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int f) const {
    while (parent_[f] != f) f = parent_[f];
    return f;
  }
  bool flipped(int f) const {
    bool flip = false;
    for (; parent_[f] != f; f = parent_[f]) flip ^= bool(flipped_[f]);
    return flip;
  }
  /// False where the faces are joined already and disagree.
  bool join(int f, int g, bool opposite) {
    const bool flip = flipped(f) ^ flipped(g) ^ opposite;
    const int a = root(f), b = root(g);
    if (a == b) return !flip;
    parent_[std::max(a, b)] = std::min(a, b);
    flipped_[std::max(a, b)] = flip;
    return true;
  }

 private:
  std::vector<int> parent_;
  std::vector<char> flipped_;
};

/// How sharp the edges of a model are.
struct Sharpness {
  std::vector<char> free;    ///< by CAD edge: whether only one face is there
  std::vector<char> used;    ///< by CAD edge: whether any is
  std::vector<char> sharp;   ///< by CAD edge: on most of its length
  std::vector<char> crease;  ///< by side of the mesh
};

bool runsForward(const WeldedMesh& mesh, const std::pair<int, int>& use) {
  const Triangle& triangle = mesh.triangles[use.first];
  return mesh.sides[triangle.side[use.second]].from == triangle.vertex[use.second];
}

Sharpness sharpness(const CadModel& model, const WeldedMesh& mesh, const SideUses& uses,
                    const std::vector<char>& reversed, double angle, double reach) {
  std::vector<double> sharp(model.edges.size(), 0), smooth(model.edges.size(), 0);
  const std::vector<char> no(model.edges.size(), 0);
  Sharpness result{no, no, no, std::vector<char>(mesh.sides.size(), 0)};
  for (size_t s = 0; s < uses.size(); ++s) {
    const auto& side = mesh.sides[s];
    if (!side.cadEdge || uses[s].empty()) continue;
    result.used[*side.cadEdge] = 1;
    if (uses[s].size() == 1) {
      result.free[*side.cadEdge] = 1;
      continue;
    }
    if (std::isinf(angle)) continue;
    const double length = (mesh.vertices[side.to].point - mesh.vertices[side.from].point).norm();
    const auto turnAt = [&](double fraction, double distance) -> std::optional<double> {
      std::array<Vector3d, 2> normal;
      for (int i = 0; i < 2; ++i) {
        const auto& [t, k] = uses[s][i];
        normal[i] = normalBesideSide(model, mesh, mesh.triangles[t], k, fraction,
                                     runsForward(mesh, uses[s][i]), distance);
        if (reversed[mesh.triangles[t].face]) normal[i] = -normal[i];
      }
      if (normal[0].isZero() || normal[1].isZero()) return {};
      return std::atan2(normal[0].cross(normal[1]).norm(), normal[0].dot(normal[1]));
    };
    for (const double fraction : kSamples) {
      if (const auto turn = turnAt(fraction, 0)) (*turn > angle ? sharp : smooth)[*side.cadEdge] += length;
      if (turnAt(fraction, reach).value_or(0) > angle) result.crease[s] = 1;
    }
  }
  for (size_t e = 0; e < sharp.size(); ++e) result.sharp[e] = sharp[e] > smooth[e];
  return result;
}

/// Takes back the cuts along chains of sharp edges that end inside a region: they separate nothing there.
void dropDangling(const CadModel& model, const std::vector<char>& isFree, std::vector<char>& cut) {
  std::vector<int> degree(model.vertices.size(), 0);
  const auto endsOf = [&](size_t e) { return std::array<int, 2>{model.edges[e].start, model.edges[e].end}; };
  for (size_t e = 0; e < cut.size(); ++e)
    if (cut[e])
      for (const int v : endsOf(e)) ++degree[v];
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t e = 0; e < cut.size(); ++e) {
      if (!cut[e] || isFree[e]) continue;
      const auto [a, b] = endsOf(e);
      if (degree[a] != 1 && degree[b] != 1) continue;
      cut[e] = 0;
      --degree[a], --degree[b];
      changed = true;
    }
  }
}

/// The elements that names like "Edge3" mean.
std::vector<int> named(const std::vector<std::string>& names, const std::string& prefix,
                       const std::vector<std::vector<int>>& elements) {
  std::vector<int> result;
  for (const std::string& name : names) {
    size_t number = 0;
    const char *begin = name.data() + std::min(prefix.size(), name.size()), *end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(begin, end, number);
    if (!name.starts_with(prefix) || error != std::errc{} || stop != end || number < 1 ||
        number > elements.size())
      throw inputError("options", "the shape has no " + name + "; its names run from " + prefix + "1 to " +
                                      prefix + std::to_string(elements.size()));
    const auto& found = elements[number - 1];
    if (found.empty()) throw inputError("options", name + " is not part of the faces that are converted");
    result.insert(result.end(), found.begin(), found.end());
  }
  return result;
}

std::vector<char> chosen(const CadModel& model, const Sharpness& edges,
                         const std::vector<std::string>& names) {
  std::vector<char> result(model.edges.size(), 0);
  for (const int e : named(names, "Edge", model.edgesNamed)) {
    if (!edges.used[e])
      throw inputError("options", model.edges[e].name + " has no length, or no face ends there");
    result[e] = 1;
  }
  return result;
}

/// Triangles must not reach across creases: their vertices are on these edges, the same on both sides.
void openCreases(const WeldedMesh& mesh, FeatureEdges& features) {
  for (size_t s = 0; s < features.crease.size(); ++s) {
    if (!features.crease[s]) continue;
    const int e = *mesh.sides[s].cadEdge;
    if (features.cut[e])
      features.crease[s] = 0;
    else
      features.inner[e] = 1;
  }
  for (size_t e = 0; e < features.cut.size(); ++e) features.cut[e] |= features.inner[e];
}

}  // namespace

SideUses sideUses(const CadModel& model, const WeldedMesh& mesh) {
  SideUses uses(mesh.sides.size());
  for (int t = 0; t < int(mesh.triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) uses[mesh.triangles[t].side[k]].push_back({t, k});
  for (size_t s = 0; s < uses.size(); ++s) {
    if (uses[s].size() <= 2) continue;
    const auto& side = mesh.sides[s];
    throw inputError("tessellate",
                     "more than two faces meet in one edge; convert the solids or shells one by one",
                     side.cadEdge ? model.edges[*side.cadEdge].name
                                  : model.faces[mesh.triangles[uses[s][0].first].face].name,
                     mesh.vertices[side.from].point);
  }
  return uses;
}

std::vector<char> orientFaces(const CadModel& model, WeldedMesh& mesh) {
  const auto uses = sideUses(model, mesh);
  FaceGroups groups(model.faces.size());
  std::vector<char> open(model.faces.size(), 0);
  for (size_t s = 0; s < uses.size(); ++s) {
    if (uses[s].size() == 1) open[mesh.triangles[uses[s][0].first].face] = 1;
    if (uses[s].size() != 2) continue;
    const int f = mesh.triangles[uses[s][0].first].face, g = mesh.triangles[uses[s][1].first].face;
    const bool opposite = runsForward(mesh, uses[s][0]) == runsForward(mesh, uses[s][1]);
    if (groups.join(f, g, opposite)) continue;
    const auto& side = mesh.sides[s];
    if (!side.cadEdge)
      throw inputError("tessellate", "the face cannot be triangulated: its wires cross; repair the shape",
                       model.faces[f].name, mesh.vertices[side.from].point);
    throw inputError("tessellate", "the surface has one side only (a Moebius strip); cut it open first",
                     model.edges[*side.cadEdge].name, mesh.vertices[side.from].point);
  }

  // Signed sums per group, with every face as its group's first face has it.
  std::vector<double> majority(model.faces.size(), 0), volume(model.faces.size(), 0);
  std::vector<char> openGroup(model.faces.size(), 0);
  for (size_t f = 0; f < open.size(); ++f)
    if (open[f]) openGroup[groups.root(int(f))] = 1;
  const Vector3d origin = mesh.vertices.front().point;
  for (const auto& triangle : mesh.triangles) {
    const int root = groups.root(triangle.face);
    const double flip = groups.flipped(triangle.face) ? -1 : 1;
    majority[root] += areaOf(mesh, triangle) * flip * (model.faces[triangle.face].reversed ? -1 : 1);
    volume[root] += flip * volumeOf(mesh, triangle, origin);
  }
  std::vector<char> reversed(model.faces.size());
  std::vector<double> solidVolume;
  const auto orientedByVolume = [&](int root) { return !openGroup[root] && !model.faces[root].solid; };
  for (size_t f = 0; f < reversed.size(); ++f) {
    const int root = groups.root(int(f));
    const bool against = orientedByVolume(root) ? volume[root] < 0 : majority[root] < 0;
    reversed[f] = char(groups.flipped(int(f)) != against);
  }
  // A cavity's shell points into the cavity, so the volume of a solid decides only as a whole.
  for (const auto& triangle : mesh.triangles) {
    const auto& solid = model.faces[triangle.face].solid;
    if (!solid) continue;
    if (*solid >= int(solidVolume.size())) solidVolume.resize(*solid + 1, 0);
    solidVolume[*solid] += volumeOf(mesh, triangle, origin) * (reversed[triangle.face] ? -1 : 1);
  }
  for (size_t f = 0; f < reversed.size(); ++f)
    if (const auto& solid = model.faces[f].solid; solid && solidVolume[*solid] < 0)
      reversed[f] = !reversed[f];

  for (auto& triangle : mesh.triangles) {
    if (!reversed[triangle.face]) continue;
    std::swap(triangle.vertex[1], triangle.vertex[2]);
    std::swap(triangle.uv[1], triangle.uv[2]);
    std::swap(triangle.side[0], triangle.side[2]);
  }
  return reversed;
}

FeatureEdges featureEdges(const CadModel& model, const WeldedMesh& mesh, const SideUses& uses,
                          const std::vector<char>& reversed, const FeatureOptions& options, double reach) {
  using Sharp = FeatureOptions::Sharp;
  const double angle = options.sharp == Sharp::Ignore ? std::numeric_limits<double>::infinity()
                                                      : options.angle * std::numbers::pi / 180;
  const Sharpness edges = sharpness(model, mesh, uses, reversed, angle, reach);
  const auto chosenAligned = chosen(model, edges, options.align), freed = chosen(model, edges, options.free);
  FeatureEdges result;
  result.cut = edges.free;
  if (options.sharp == Sharp::Trim) {
    for (size_t e = 0; e < model.edges.size(); ++e) result.cut[e] |= edges.sharp[e];
    dropDangling(model, edges.free, result.cut);
  }
  for (size_t e = 0; e < model.edges.size(); ++e) {
    // A sharp edge that separates nothing is still sharp: no smooth surface follows it.
    const bool byDefault = result.cut[e] ? options.alignBoundary : bool(edges.sharp[e]);
    result.aligned.push_back((byDefault || chosenAligned[e]) && !freed[e]);
    result.alignedAsBorder.push_back((options.alignBoundary || chosenAligned[e]) && !freed[e]);
    result.inner.push_back(result.aligned[e] && !result.cut[e]);
    result.cut[e] |= result.inner[e];
  }
  result.crease = edges.crease;
  openCreases(mesh, result);
  return result;
}

void cutAlong(FeatureEdges& features, const WeldedMesh& mesh, const std::vector<int>& edges) {
  for (const int e : edges) {
    if (features.inner[e]) features.aligned[e] = features.alignedAsBorder[e];
    features.cut[e] = 1;
    features.inner[e] = 0;
  }
  for (size_t s = 0; s < features.crease.size(); ++s) {
    if (!features.crease[s]) continue;
    const int e = *mesh.sides[s].cadEdge;
    if (!features.cut[e] || features.inner[e]) continue;
    features.aligned[e] = 1;
    features.crease[s] = 0;
  }
}

std::vector<char> featureVertices(const CadModel& model, const WeldedMesh& mesh,
                                  const FeatureOptions& options) {
  std::vector<char> wanted(model.vertices.size(), 0), result(mesh.vertices.size(), 0), found = wanted;
  for (const int v : named(options.vertices, "Vertex", model.verticesNamed)) wanted[v] = 1;
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    if (const auto& vertex = mesh.vertices[v].cadVertex; vertex && wanted[*vertex])
      result[v] = found[*vertex] = 1;
  for (size_t v = 0; v < wanted.size(); ++v)
    if (wanted[v] && !found[v])
      throw inputError("options", "a vertex that is to be a feature point is on no face", {},
                       model.vertices[v]);
  return result;
}

}  // namespace trimquad
