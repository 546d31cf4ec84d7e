#include "trimquad/seamless/hessian_pattern.h"

#include <Eigen/Dense>
#include <algorithm>

#include "trimquad/base/error.h"

namespace trimquad {

HessianPattern::HessianPattern(const ConstraintBasis& basis, const std::vector<Corners>& triangles) {
  using RowIterator = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
  const int n = basis.freeCount(), count = int(triangles.size());
  std::vector<int> unknown;  // of all triangles, one after another
  triangles_.resize(count + 1);
  for (int t = 0; t < count; ++t) {
    Triangle& triangle = triangles_[t];
    triangle.firstUnknown = int(unknown.size());
    triangle.firstCoefficient = int(coefficients_.size());
    triangle.plain = true;
    for (int i = 0; i < 6; ++i) {
      int terms = 0;
      for (RowIterator r(basis.matrix(), triangles[t][i]); r; ++r, ++terms) {
        const auto first = unknown.begin() + triangle.firstUnknown;
        const auto found = std::find(first, unknown.end(), int(r.col()));
        const int local = int(found - first);
        if (found == unknown.end()) unknown.push_back(int(r.col()));
        coefficients_.push_back({i, local, r.value()});
        triangle.plain = triangle.plain && local == i && r.value() == 1;
      }
      triangle.plain = triangle.plain && terms == 1;
    }
    triangle.unknowns = int(unknown.size()) - triangle.firstUnknown;
    triangles_[t + 1].firstPlace =
        triangle.firstPlace + size_t(triangle.unknowns) * size_t(triangle.unknowns);
  }
  triangles_[count].firstUnknown = int(unknown.size());
  triangles_[count].firstCoefficient = int(coefficients_.size());
  place_.resize(triangles_[count].firstPlace);

  // The triangles of every unknown, as places in `unknown`.
  std::vector<int> start(n + 1, 0), use(unknown.size()), triangleOf(unknown.size());
  for (const int a : unknown) ++start[a + 1];
  for (int a = 0; a < n; ++a) start[a + 1] += start[a];
  std::vector<int> next(start.begin(), start.end() - 1);
  for (int t = 0; t < count; ++t)
    for (int k = triangles_[t].firstUnknown; k < triangles_[t + 1].firstUnknown; ++k) {
      triangleOf[k] = t;
      use[next[unknown[k]]++] = k;
    }

  std::vector<int> outer{0}, inner, slot(n), seenFrom(n, n), column;
  outer.reserve(n + 1);
  for (int b = 0; b < n; ++b) {
    seenFrom[b] = b;
    column.assign(1, b);  // the diagonal, even where no triangle depends on the unknown
    for (int u = start[b]; u < start[b + 1]; ++u) {
      const Triangle& triangle = triangles_[triangleOf[use[u]]];
      for (int k = 0; k < triangle.unknowns; ++k) {
        const int a = unknown[triangle.firstUnknown + k];
        if (seenFrom[a] == b) continue;
        seenFrom[a] = b;
        column.push_back(a);
      }
    }
    std::sort(column.begin(), column.end());
    for (size_t i = 0; i < column.size(); ++i) slot[column[i]] = int(inner.size() + i);
    for (int u = start[b]; u < start[b + 1]; ++u) {
      const Triangle& triangle = triangles_[triangleOf[use[u]]];
      int* const places = place_.data() + triangle.firstPlace +
                          size_t(use[u] - triangle.firstUnknown) * size_t(triangle.unknowns);
      for (int k = 0; k < triangle.unknowns; ++k) places[k] = slot[unknown[triangle.firstUnknown + k]];
    }
    inner.insert(inner.end(), column.begin(), column.end());
    outer.push_back(int(inner.size()));
  }
  const std::vector<double> zeros(inner.size(), 0.0);
  zero_ = Eigen::Map<const Eigen::SparseMatrix<double>>(n, n, Eigen::Index(inner.size()), outer.data(),
                                                        inner.data(), zeros.data());
}

void HessianPattern::add(int t, const Eigen::Matrix<double, 6, 6>& second,
                         Eigen::SparseMatrix<double>& hessian) const {
  const Triangle& triangle = triangles_[t];
  const int* const places = place_.data() + triangle.firstPlace;
  double* const values = hessian.valuePtr();
  if (triangle.plain) {
    for (int i = 0; i < 36; ++i) values[places[i]] += second.data()[i];
    return;
  }
  const auto begin = coefficients_.begin() + triangle.firstCoefficient,
             end = coefficients_.begin() + triangles_[t + 1].firstCoefficient;
  const auto terms = size_t(end - begin), unknowns = size_t(triangle.unknowns);
  if (terms * terms > 4 * unknowns * unknowns) {
    // Long sums of the same unknowns, as along aligned curves: dense, the six variables cost less than their
    // terms.
    Eigen::Matrix<double, 6, Eigen::Dynamic> byUnknown =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, triangle.unknowns);
    for (auto s = begin; s != end; ++s) byUnknown(s->corner, s->unknown) += s->value;
    const Eigen::MatrixXd whole = byUnknown.transpose() * (second * byUnknown);
    for (Eigen::Index i = 0; i < whole.size(); ++i) values[places[i]] += whole.data()[i];
    return;
  }
  for (auto s = begin; s != end; ++s)
    for (auto r = begin; r != end; ++r)
      values[places[s->unknown * triangle.unknowns + r->unknown]] +=
          r->value * s->value * second(r->corner, s->corner);
}

}  // namespace trimquad
