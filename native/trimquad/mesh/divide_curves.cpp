#include "trimquad/mesh/divide_curves.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace trimquad {
namespace {

using Eigen::Vector3d;

constexpr int kFewestSamples = 256, kMostSamples = 65536, kSamplesPerPiece = 4;

/// A curve as a polyline with its length up to each sample.
struct Polyline {
  std::vector<double> parameter, length;
  std::vector<Vector3d> point;
  int last() const { return int(point.size()) - 1; }
};

Polyline sampled(const TrueCurve& curve, int samples) {
  Polyline line;
  for (int i = 0; i <= samples; ++i) {
    const double s = double(i) / samples;
    line.parameter.push_back((1 - s) * curve.first() + s * curve.last());
    line.point.push_back(curve.point(line.parameter.back()));
    line.length.push_back(i == 0 ? 0 : line.length.back() + (line.point[i] - line.point[i - 1]).norm());
  }
  return line;
}

/// The parameters of `pieces` pieces of equal length.
std::vector<double> equalPieces(const Polyline& line, int pieces) {
  std::vector<double> division{line.parameter.front()};
  for (int k = 1; k < pieces; ++k) {
    const double wanted = line.length.back() * k / pieces;
    const auto i = std::clamp<long>(
        std::upper_bound(line.length.begin(), line.length.end(), wanted) - line.length.begin(), 1,
        line.last());
    const double gap = line.length[i] - line.length[i - 1];
    const double s = gap > 0 ? (wanted - line.length[i - 1]) / gap : 0.5;
    division.push_back((1 - s) * line.parameter[i - 1] + s * line.parameter[i]);
  }
  division.push_back(line.parameter.back());
  return division;
}

/// Whether the pieces stay within the tolerance of the curve and turn little.
bool follows(const Polyline& line, int pieces, double tolerance) {
  const double total = line.length.back();
  int first = 0;
  for (int k = 1; k <= pieces; ++k) {
    int last = first;
    while (last < line.last() && line.length[last] < total * k / pieces) ++last;
    const Vector3d chord = line.point[last] - line.point[first];
    const double square = chord.squaredNorm();
    double turn = 0;
    for (int i = first + 1; i < last; ++i) {
      const Vector3d d = line.point[i] - line.point[first];
      const double s = square > 0 ? std::clamp(d.dot(chord) / square, 0.0, 1.0) : 0;
      if ((d - s * chord).norm() > tolerance) return false;
      const Vector3d before = line.point[i] - line.point[i - 1], after = line.point[i + 1] - line.point[i];
      turn += std::atan2(before.cross(after).norm(), before.dot(after));
    }
    if (turn > kLargestTurn) return false;
    first = last;
  }
  return true;
}

/// By sample of the line: the length of pieces that the surfaces ask for, at most `longest`.
std::vector<double> wantedPieces(const Polyline& line, const std::vector<const TrueSurface*>& surfaces,
                                 double longest, const RemeshOptions& options) {
  std::vector<double> wanted(line.point.size(), longest);
  for (size_t i = 0; i < wanted.size(); ++i)
    for (const TrueSurface* surface : surfaces)
      if (const double k = largestCurvature(*surface, line.point[i]); !isSharp(k, options))
        wanted[i] = std::min(wanted[i], lengthByCurvature(k, options));
  const auto limit = [&](size_t i, size_t next) {
    wanted[i] = std::min(wanted[i], wanted[next] + kGradation * std::abs(line.length[next] - line.length[i]));
  };
  for (size_t i = 1; i < wanted.size(); ++i) limit(i, i - 1);
  for (size_t i = wanted.size() - 1; i > 0; --i) limit(i - 1, i);
  return wanted;
}

}  // namespace

double largestCurvature(const TrueSurface& surface, const Vector3d& point) {
  const auto c = surface.curvature(point);
  return std::max(std::abs(c.k1), std::abs(c.k2));
}

double lengthByCurvature(double k, const RemeshOptions& options) {
  if (!(k > 0)) return options.edgeLength;
  // An edge of length l on a circle of curvature k is l^2 k / 8 away from it.
  const double sag = std::sqrt(8 * options.tolerance / k);
  const double wanted = std::min(sag, kLargestTurn / k);
  // Where even the shortest edge would cut off more than the tolerance, such as the lip of an inlet.
  const double lower =
      std::min(kShortestEdge * options.edgeLength, std::max(sag, kTightestEdge * options.edgeLength));
  return std::clamp(wanted, lower, options.edgeLength);
}

void divideByCurvature(const Model& model, const std::vector<char>& chosen, const RemeshOptions& options,
                       std::vector<std::vector<double>>& division) {
  std::vector<std::vector<const TrueSurface*>> surfaces(model.curves.size());
  for (const auto& region : model.regions) {
    std::vector<char> touches(model.curves.size(), 0);
    for (const auto& curve : region.edgeCurve)
      if (curve) touches[curve->index] = 1;
    for (size_t c = 0; c < touches.size(); ++c)
      if (touches[c] && region.surface) surfaces[c].push_back(region.surface.get());
  }
  for (size_t c = 0; c < division.size(); ++c) {
    if (!chosen[c]) continue;
    const TrueCurve& curve = *model.curves[c].curve;
    Polyline line = sampled(curve, kFewestSamples);
    const double finest = kSamplesPerPiece * line.length.back() / (kTightestEdge * options.edgeLength);
    if (finest > kFewestSamples) line = sampled(curve, int(std::min<double>(finest, kMostSamples)));
    const int before = int(division[c].size()) - 1;
    const auto wanted = wantedPieces(line, surfaces[c], line.length.back() / before, options);
    // Lengths are measured in wanted ones from here on.
    double last = line.length[0];
    for (size_t i = 1; i < wanted.size(); ++i) {
      const double step = line.length[i] - last;
      last = line.length[i];
      line.length[i] = line.length[i - 1] + 2 * step / (wanted[i - 1] + wanted[i]);
    }
    division[c] = equalPieces(line, std::max(before, int(std::lround(line.length.back()))));
  }
}

std::vector<std::vector<double>> divideCurves(const Model& model, const RemeshOptions& options) {
  std::map<std::pair<CornerId, CornerId>, int> curvesBetween;
  for (const auto& curve : model.curves) ++curvesBetween[std::minmax(curve.start, curve.end)];
  std::vector<std::vector<double>> division;
  for (const auto& curve : model.curves) {
    Polyline line = sampled(*curve.curve, kFewestSamples);
    const double finest = kSamplesPerPiece * line.length.back() / (kShortestEdge * options.edgeLength);
    if (finest > kFewestSamples) line = sampled(*curve.curve, int(std::min<double>(finest, kMostSamples)));
    const double total = line.length.back();
    const int fewest = curve.start == curve.end                                 ? 3
                       : curvesBetween[std::minmax(curve.start, curve.end)] > 1 ? 2
                                                                                : 1;
    const int limit = line.last() / kSamplesPerPiece;
    const int most =
        std::max(fewest, int(std::min<double>(total / (kShortestEdge * options.edgeLength), limit)));
    int pieces =
        std::clamp(int(std::lround(std::min<double>(total / options.edgeLength, limit))), fewest, most);
    while (pieces < most && !follows(line, pieces, options.tolerance))
      pieces = std::min(most, pieces + 1 + pieces / 8);
    division.push_back(equalPieces(line, pieces));
  }
  return division;
}

}  // namespace trimquad
