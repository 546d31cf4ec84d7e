#include "trimquad/mesh/check_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trimquad/base/error.h"
#include "trimquad/mesh/equal_points.h"
#include "trimquad/mesh/flat_triangles.h"
#include "trimquad/mesh/side_gluing.h"

namespace trimquad {
namespace {

using Eigen::Vector3d;

/// Share of the volumes that cancel under which a closed surface encloses none, so that it has no outside.
constexpr double kNoVolume = 1e-10;

void requireUsable(const TriangleSoup& soup) {
  if (soup.triangles.empty()) throw inputError("tessellate", "the mesh has no triangles");
  for (std::size_t v = 0; v < soup.points.size(); ++v)
    if (!soup.points[v].allFinite())
      throw inputError("tessellate", "a coordinate is not a finite number", "vertex " + std::to_string(v));
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (const int v : soup.triangles[t])
      if (v < 0 || v >= int(soup.points.size()))
        throw inputError("tessellate", "a triangle names a vertex that does not exist",
                         "triangle " + std::to_string(t));
}

/// Keeps the triangles for which `keep(t)`, in order; returns how many went.
template <class Keep>
int dropTriangles(TriangleSoup& soup, std::vector<int>& origin, Keep keep) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (!keep(t)) continue;
    soup.triangles[kept] = soup.triangles[t];
    origin[kept++] = origin[t];
  }
  const int dropped = int(soup.triangles.size() - kept);
  soup.triangles.resize(kept);
  origin.resize(kept);
  return dropped;
}

std::array<int, 3> sortedPlaces(const std::array<int, 3>& triangle, const std::vector<int>& place) {
  std::array<int, 3> corners{place[triangle[0]], place[triangle[1]], place[triangle[2]]};
  std::sort(corners.begin(), corners.end());
  return corners;
}

int dropRepeatedCorners(TriangleSoup& soup, const std::vector<int>& place, std::vector<int>& origin) {
  return dropTriangles(soup, origin, [&](std::size_t t) {
    const auto corners = sortedPlaces(soup.triangles[t], place);
    return corners[0] != corners[1] && corners[1] != corners[2];
  });
}

int dropDuplicates(TriangleSoup& soup, const std::vector<int>& place, std::vector<int>& origin) {
  std::vector<int> order(soup.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::array<int, 3>> key;
  for (const auto& t : soup.triangles) key.push_back(sortedPlaces(t, place));
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
  std::vector<bool> duplicate(order.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i) duplicate[order[i]] = key[order[i]] == key[order[i - 1]];
  return dropTriangles(soup, origin, [&](std::size_t t) { return !duplicate[t]; });
}

/// Turns triangles until neighbours agree, then whole components as check_mesh.h says. The gluing still tells
/// which sides are one edge, but no longer how they run.
int orient(TriangleSoup& soup, const SideGluing& gluing) {
  const int count = int(soup.triangles.size());
  const std::vector<int> component = components(gluing);
  std::vector<std::optional<bool>> turned(count);
  std::vector<std::vector<int>> members(count);
  for (int t = 0; t < count; ++t) members[component[t]].push_back(t);

  for (int root = 0; root < count; ++root) {
    if (component[root] != root) continue;
    std::vector<int> queue{root};
    turned[root] = false;
    bool closed = true;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (int s = 3 * queue[i]; s < 3 * queue[i] + 3; ++s) {
        if (!gluing.opposite[s]) {
          closed = false;
          continue;
        }
        const int neighbour = *gluing.opposite[s] / 3;
        const bool turn = *turned[queue[i]] != gluing.sameDirection[s];
        if (!turned[neighbour]) {
          turned[neighbour] = turn;
          queue.push_back(neighbour);
        } else if (*turned[neighbour] != turn) {
          throw inputError(
              "tessellate", "the surface has only one side (it is not orientable); cut it open first",
              "triangle " + std::to_string(neighbour), soup.points[soup.triangles[neighbour][0]]);
        }
      }
    }
    const auto& own = members[root];
    int turns = 0;
    double volume = 0, cancelled = 0;
    const Vector3d origin = soup.points[soup.triangles[root][0]];
    for (const int t : own) {
      turns += *turned[t];
      const auto& c = soup.triangles[t];
      const double v =
          (soup.points[c[0]] - origin).dot((soup.points[c[1]] - origin).cross(soup.points[c[2]] - origin));
      volume += *turned[t] ? -v : v;
      cancelled += std::abs(v);
    }
    const bool enclosing = closed && std::abs(volume) > kNoVolume * cancelled;
    if (enclosing ? volume < 0 : 2 * turns > int(own.size()))
      for (const int t : own) turned[t] = !*turned[t];
  }
  int total = 0;
  for (int t = 0; t < count; ++t) {
    if (!*turned[t]) continue;
    std::swap(soup.triangles[t][1], soup.triangles[t][2]);
    ++total;
  }
  return total;
}

/// Gives every fan of corners a vertex of its own, ordered by the soup's vertex that it comes from.
void renumberVertices(TriangleSoup& soup, const std::vector<int>& fan, RepairReport& report) {
  const auto corner = [&](int c) { return soup.triangles[c / 3][c % 3]; };
  const int corners = int(3 * soup.triangles.size());
  std::vector<int> smallest(corners, int(soup.points.size()));  // by fan: its smallest vertex
  std::vector<std::array<int, 2>> pairs;                        // fan, vertex
  for (int c = 0; c < corners; ++c) {
    smallest[fan[c]] = std::min(smallest[fan[c]], corner(c));
    pairs.push_back({fan[c], corner(c)});
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<int> fansOfVertex(soup.points.size(), 0);
  std::vector<std::array<int, 2>> order;  // smallest vertex, fan
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [f, v] = pairs[i];
    if (i > 0 && pairs[i - 1][0] == f)
      ++report.weldedVertices;
    else
      order.push_back({smallest[f], f});
    ++fansOfVertex[v];
  }
  for (const int n : fansOfVertex) {
    report.unusedVertices += n == 0;
    report.splitVertices += std::max(0, n - 1);
  }
  std::sort(order.begin(), order.end());
  std::vector<int> number(corners);
  std::vector<Vector3d> points;
  for (const auto& [vertex, f] : order) {
    number[f] = int(points.size());
    points.push_back(soup.points[vertex]);
  }
  for (int c = 0; c < corners; ++c) soup.triangles[c / 3][c % 3] = number[fan[c]];
  soup.points = std::move(points);
}

/// Everything but triangles without area.
void repairConnectivity(TriangleSoup& soup, RepairReport& report) {
  const std::vector<int> place = firstEqualPoint(soup.points);
  report.repeatedCorners += dropRepeatedCorners(soup, place, report.triangle);
  report.duplicateTriangles += dropDuplicates(soup, place, report.triangle);
  if (soup.triangles.empty()) throw inputError("tessellate", "no triangle of the mesh has an area");
  const SideGluing gluing = glueSides(soup, place);
  renumberVertices(soup, cornerFans(soup, gluing), report);
  requireManifoldEdges(soup);
  report.turnedTriangles += orient(soup, gluing);
}

}  // namespace

int RepairReport::count() const {
  return unusedVertices + repeatedCorners + duplicateTriangles + weldedVertices + splitVertices +
         turnedTriangles + flatTriangles;
}

std::string RepairReport::summary() const {
  std::string text;
  const auto add = [&](int count, const char* one, const char* many, const char* done) {
    if (count == 0) return;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + (count == 1 ? one : many) + " " + done;
  };
  add(unusedVertices, "unused vertex", "unused vertices", "dropped");
  add(repeatedCorners, "triangle with a repeated corner", "triangles with a repeated corner", "dropped");
  add(duplicateTriangles, "duplicate triangle", "duplicate triangles", "dropped");
  add(weldedVertices, "vertex", "vertices", "welded");
  add(splitVertices, "vertex", "vertices", "split where sheets touch");
  add(turnedTriangles, "triangle", "triangles", "turned");
  add(flatTriangles, "triangle without area", "triangles without area", "resolved");
  return text;
}

RepairReport repair(TriangleSoup& soup) {
  requireUsable(soup);
  RepairReport report;
  report.triangle.resize(soup.triangles.size());
  std::iota(report.triangle.begin(), report.triangle.end(), 0);
  // Welding can bring two boundary edges between the same vertices, and a triangle without area that goes can
  // leave two on each other: both are one edge then. Every round glues more sides, so that the rounds end.
  for (int before = -1; before < report.count();) {
    before = report.count();
    repairConnectivity(soup, report);
    report.flatTriangles += resolveFlatTriangles(soup, report.triangle);
  }
  return report;
}

}  // namespace trimquad
