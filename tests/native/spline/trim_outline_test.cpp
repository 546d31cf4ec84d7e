#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/trim_samples.h"
#include "trimquad/mesh/polyline_curve.h"

namespace trimquad {
namespace {

using namespace test;

using Polygon = std::vector<Eigen::Vector3d>;

double distanceToChain(const Eigen::Vector3d& p, const Polygon& chain) {
  double best = HUGE_VAL;
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    const Eigen::Vector3d d = chain[i + 1] - chain[i];
    const double x = std::clamp((p - chain[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (chain[i] + x * d - p).norm());
  }
  return best;
}

double largestDistance(const Polygon& from, const Polygon& to) {
  constexpr int kSamples = 16;  // on each segment
  double largest = 0;
  for (std::size_t i = 0; i + 1 < from.size(); ++i)
    for (int k = 0; k <= kSamples; ++k)
      largest =
          std::max(largest, distanceToChain(from[i] + double(k) / kSamples * (from[i + 1] - from[i]), to));
  return largest;
}

/// A chain of mesh edges round a flat sheet whose parameter lines are curved, and the outline that it is
/// trimmed to.
struct Outline {
  Polygon chain, curve;
  double tolerance;
};

Outline trimmedOutline(Polygon corners, double tolerance) {
  const auto bent = [](double u, double v) {
    return Eigen::Vector3d(u + 0.2 * std::sin(1.3 * v), v + 0.15 * std::sin(1.7 * u), 0);
  };
  const auto surface = interpolated(bent, -8, 8, 64, -8, 8, 64);
  corners.push_back(corners.front());
  TrimCase c;
  c.tolerance = tolerance;
  const auto chain = std::make_shared<PolylineCurve>(corners);
  const auto border = c.closedCurve(
      0, double(corners.size() - 1),
      [&](double t) {
        const auto i = std::min<std::size_t>(std::size_t(t), corners.size() - 2);
        return Eigen::Vector3d(corners[i] + (t - double(i)) * (corners[i + 1] - corners[i]));
      },
      int(corners.size()) - 1);
  const int region = c.region(surface, {{{border, true}}},
                              [&](const Eigen::Vector3d& p) { return surface.footPoint(p, p.head<2>()); });
  // From the number of the edge to the length along the chain.
  auto& parameter = c.model.regions[region].curveParameter;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) parameter[i] = chain->parameters()[i];
  c.model.curves[border.index].curve = chain;
  c.model.shells.push_back({{region}, {}});

  Outline outline{corners, {}, tolerance};
  const auto model = c.trim();
  for (const auto& edge : model.edges) {
    constexpr int kSamples = 16;  // in each span
    const auto& curve = edge.curve;
    for (std::size_t k = curve.degree; k + curve.degree + 1 < curve.knots.size(); ++k)
      for (int i = 0; i <= kSamples; ++i)
        outline.curve.push_back(
            curve.point(curve.knots[k] + (curve.knots[k + 1] - curve.knots[k]) * i / kSamples));
  }
  return outline;
}

void expectClose(const Outline& outline) {
  EXPECT_LE(largestDistance(outline.curve, outline.chain), outline.tolerance);
  EXPECT_LE(largestDistance(outline.chain, outline.curve), outline.tolerance);
}

TEST(TrimOutline, followsLongEdgesBesideShortOnes) {
  Polygon halfDisc;
  constexpr int kShortEdges = 149;
  for (int i = 0; i <= kShortEdges; ++i) {
    const double a = std::numbers::pi * i / kShortEdges;
    halfDisc.push_back({5 * std::cos(a), 0.5 + 5 * std::sin(a), 0});
  }
  expectClose(trimmedOutline(halfDisc, 0.01));
}

TEST(TrimOutline, runsOutToTheTipsOfThinTongues) {
  for (const double width : {0.4, 0.1, 0.02}) {
    SCOPED_TRACE(width);
    const Polygon corners{{-5, -5, 0}, {0, -5, 0}, {0, -6.5, 0}, {width, -5, 0},
                          {5, -5, 0},  {5, 5, 0},  {-5, 5, 0}};
    expectClose(trimmedOutline(corners, 0.01));
  }
}

}  // namespace
}  // namespace trimquad
