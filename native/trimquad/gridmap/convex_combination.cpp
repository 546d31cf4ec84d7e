#include "trimquad/gridmap/convex_combination.h"

#include <Eigen/SparseLU>
#include <cmath>

namespace trimquad {
namespace {

using Eigen::Vector2d;

/// Of a corner's half angle's tangent and of edge lengths, relative to the triangle: beyond, a weight says
/// nothing.
constexpr double kThin = 1e-9;

double halfAngleTangent(const Vector2d& a, const Vector2d& b) {
  return (a.norm() * b.norm() - a.dot(b)) / (a.x() * b.y() - a.y() * b.x());
}

}  // namespace

std::optional<EdgeWeights> meanValueWeights(const std::vector<std::array<Vector2d, 3>>& shapes) {
  EdgeWeights weights;
  for (const auto& x : shapes) {
    const Vector2d a = x[1] - x[0], b = x[2] - x[0];
    const double size = std::max({a.squaredNorm(), b.squaredNorm(), (x[2] - x[1]).squaredNorm()});
    if (!(a.x() * b.y() - a.y() * b.x() > kThin * size)) return {};
    auto& w = weights.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Vector2d to = x[(k + 1) % 3] - x[k], back = x[(k + 2) % 3] - x[k];
      const double tangent = halfAngleTangent(to, back);
      w[k][0] = tangent / to.norm();
      w[(k + 2) % 3][1] = tangent / back.norm();
    }
  }
  return weights;
}

EdgeWeights uniformWeights(std::size_t triangles) {
  // Half of an inner edge's from either triangle.
  return EdgeWeights(triangles, {{{0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}}});
}

std::optional<std::vector<Vector2d>> convexCombinationMap(const PatchDisk& disk, const EdgeWeights& weights,
                                                          const std::vector<Vector2d>& rim) {
  const int rimCount = int(disk.rim.size()), inner = int(disk.vertexCount) - rimCount;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(inner, 2);
  std::vector<double> sum(inner, 0);
  const auto pull = [&](int i, int j, double weight) {
    if (!disk.isInner(i)) return;
    sum[i - rimCount] += weight;
    if (disk.isInner(j))
      entries.emplace_back(i - rimCount, j - rimCount, -weight);
    else
      right.row(i - rimCount) += weight * rim[j].transpose();
  };
  for (std::size_t t = 0; t < disk.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int i = disk.triangles[t][k], j = disk.triangles[t][(k + 1) % 3];
      pull(i, j, weights[t][k][0]);
      pull(j, i, weights[t][k][1]);
    }
  std::vector<Vector2d> image = rim;
  if (inner == 0) return image;
  // Rows scaled to one: each states a mean.
  for (auto& entry : entries) entry = {entry.row(), entry.col(), entry.value() / sum[entry.row()]};
  for (int i = 0; i < inner; ++i) {
    right.row(i) /= sum[i];
    entries.emplace_back(i, i, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(inner, inner);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver;
  solver.compute(matrix);
  if (solver.info() != Eigen::Success) return {};
  const Eigen::MatrixXd x = solver.solve(right);
  for (int i = 0; i < inner; ++i) image.push_back(x.row(i).transpose());
  return image;
}

}  // namespace trimquad
