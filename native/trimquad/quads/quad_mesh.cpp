#include "trimquad/quads/quad_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace trimquad {

std::optional<std::array<QuadPointId, 2>> doubledSide(const QuadMesh& quads) {
  std::vector<std::array<QuadPointId, 2>> sides;
  for (const auto& cell : quads.cells)
    for (const auto& polygon : cell.simple.empty() ? cell.loops : cell.simple)
      for (size_t k = 0; k < polygon.size(); ++k)
        sides.push_back({polygon[k], polygon[(k + 1) % polygon.size()]});
  std::sort(sides.begin(), sides.end());
  const auto twice = std::adjacent_find(sides.begin(), sides.end());
  return twice == sides.end() ? std::nullopt : std::optional(*twice);
}

namespace {

/// Of a corner of a full quad, in degrees from 90.
double angleDeviation(const QuadMesh& quads, const QuadMesh::Polygon& corners, size_t k) {
  const auto position = [&](size_t i) { return quads.points[corners[i % 4].index].position; };
  const Eigen::Vector3d a = position(k + 1) - position(k), b = position(k + 3) - position(k);
  return std::abs(std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI - 90);
}

std::vector<double> edgeLengths(const QuadMesh& quads) {
  std::vector<std::array<int, 2>> edges;
  for (const auto& cell : quads.cells)
    for (size_t k = 0; cell.full && k < 4; ++k) {
      const int from = cell.loops[0][k].index, to = cell.loops[0][(k + 1) % 4].index;
      edges.push_back({std::min(from, to), std::max(from, to)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<double> lengths;
  for (const auto& [from, to] : edges)
    lengths.push_back((quads.points[to].position - quads.points[from].position).norm());
  return lengths;
}

}  // namespace

QuadMeasures measures(const QuadMesh& quads) {
  QuadMeasures result;
  for (const auto& cell : quads.cells)
    for (size_t k = 0; cell.full && k < 4; ++k)
      if (!quads.points[cell.loops[0][k].index].border)
        result.angleDeviations.push_back(angleDeviation(quads, cell.loops[0], k));
  result.edgeLengths = edgeLengths(quads);
  return result;
}

QuadStatistics statistics(const QuadMesh& quads) {
  QuadStatistics result;
  std::vector<double> deviations;
  for (const auto& cell : quads.cells) {
    ++(cell.full ? result.quads : result.trimmed);
    for (size_t k = 0; cell.full && k < 4; ++k) deviations.push_back(angleDeviation(quads, cell.loops[0], k));
  }
  for (const auto& p : quads.points) result.irregularVertices += p.quads != 0 && p.quads != 4;

  std::sort(deviations.begin(), deviations.end());
  if (!deviations.empty()) {
    for (const double d : deviations) result.angleDeviation.mean += d / double(deviations.size());
    result.angleDeviation.p95 = deviations[size_t(0.95 * double(deviations.size() - 1))];
    result.angleDeviation.max = deviations.back();
  }
  const std::vector<double> lengths = edgeLengths(quads);
  for (const double length : lengths) result.edgeLength.mean += length / double(lengths.size());
  for (const double length : lengths)
    result.edgeLength.std += std::pow(length - result.edgeLength.mean, 2) / double(lengths.size());
  result.edgeLength.std = std::sqrt(result.edgeLength.std);
  return result;
}

std::string writeQuadsObj(const QuadMesh& quads) {
  std::string text;
  char line[128];
  for (const auto& p : quads.points) {
    const int length = std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.position.x(),
                                     p.position.y(), p.position.z());
    text.append(line, size_t(length));
  }
  const auto polygon = [&](const QuadMesh::Polygon& corners) {
    text += "f";
    for (const auto id : corners) text += ' ' + std::to_string(id.index + 1);
    text += '\n';
  };
  text += "g quads\n";
  for (const auto& cell : quads.cells)
    if (cell.full) polygon(cell.loops[0]);
  text += "g trimmed\n";
  for (const auto& cell : quads.cells)
    if (!cell.full)
      for (const auto& corners : cell.simple.empty() ? cell.loops : cell.simple) polygon(corners);
  if (!quads.featureEdges.empty()) text += "g feature\n";
  for (const auto& [from, to] : quads.featureEdges)
    text += "l " + std::to_string(from.index + 1) + ' ' + std::to_string(to.index + 1) + '\n';
  return text;
}

}  // namespace trimquad
