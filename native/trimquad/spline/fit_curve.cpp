#include "trimquad/spline/fit_curve.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

template <int Dim>
using Samples = std::vector<CurveSample<Dim>>;

/// Minimises the squared distances in the samples' own coordinates, end poles held. A very small second
/// difference keeps poles apart that few samples reach.
template <int Dim>
void solvePoles(SplineCurve<Dim>& curve, const Samples<Dim>& samples) {
  const int count = int(curve.knots.size()) - curve.degree - 1, free = count - 2;
  curve.poles.assign(count, Eigen::Matrix<double, Dim, 1>::Zero());
  curve.poles.front() = samples.front().point;
  curve.poles.back() = samples.back().point;
  if (free <= 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Matrix<double, Eigen::Dynamic, Dim> rhs =
      Eigen::Matrix<double, Eigen::Dynamic, Dim>::Zero(free, Dim);
  const auto addRow = [&](int first, int size, const double* weight,
                          const Eigen::Matrix<double, Dim, 1>& value) {
    Eigen::Matrix<double, Dim, 1> rest = value;
    for (int k = 0; k < size; ++k) {
      const int i = first + k;
      if (i == 0 || i == count - 1) rest -= weight[k] * curve.poles[i];
    }
    for (int k = 0; k < size; ++k) {
      const int i = first + k;
      if (i == 0 || i == count - 1) continue;
      rhs.row(i - 1) += weight[k] * rest.transpose();
      for (int l = 0; l < size; ++l)
        if (first + l != 0 && first + l != count - 1)
          entries.emplace_back(i - 1, first + l - 1, weight[k] * weight[l]);
    }
  };
  BasisFunctions basis;
  for (const auto& sample : samples) {
    basisFunctions(curve.knots, curve.degree, sample.s, 0, basis);
    addRow(basis.first, curve.degree + 1, basis.value[0].data(), sample.point);
  }
  constexpr double fairness = 1e-6;
  const double difference[3] = {fairness, -2 * fairness, fairness};
  for (int i = 0; i + 2 < count; ++i) addRow(i, 3, difference, Eigen::Matrix<double, Dim, 1>::Zero());
  Eigen::SparseMatrix<double> matrix(free, free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  TRIMQUAD_ASSERT(factor.info() == Eigen::Success);
  const Eigen::Matrix<double, Eigen::Dynamic, Dim> poles = factor.solve(rhs);
  for (int i = 0; i < free; ++i) curve.poles[i + 1] = poles.row(i).transpose();
}

/// Moves each inner sample's parameter to its foot on the curve (one Newton step), in ascending order.
template <int Dim>
void slide(const SplineCurve<Dim>& curve, Samples<Dim>& samples) {
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    auto& sample = samples[i];
    const auto c = curve.derivatives(sample.s, 1);
    const Eigen::Vector3d tangent = sample.metric * c[1], error = sample.metric * (sample.point - c[0]);
    const double speed2 = tangent.squaredNorm();
    if (!(speed2 > 0)) continue;
    // At most half the way to a neighbour, so that the order stays.
    const double before = (sample.s - samples[i - 1].s) / 2, after = (samples[i + 1].s - sample.s) / 2;
    sample.s += std::clamp(error.dot(tangent) / speed2, -before, after);
  }
}

/// Distance in space. A sliding sample could still lose most of its part along the curve: only a tenth of it
/// counts.
template <int Dim>
double distance(const SplineCurve<Dim>& curve, const CurveSample<Dim>& sample, SampleParameters parameters) {
  const auto c = curve.derivatives(sample.s, 1);
  const Eigen::Vector3d error = sample.metric * (sample.point - c[0]);
  if (parameters == SampleParameters::Fixed) return error.norm();
  const Eigen::Vector3d tangent = sample.metric * c[1];
  const double speed2 = tangent.squaredNorm();
  if (!(speed2 > 0)) return error.norm();
  return (error - 0.9 * tangent * (error.dot(tangent) / speed2)).norm();
}

}  // namespace

template <int Dim>
SplineCurve<Dim> fitCurve(
    std::vector<CurveSample<Dim>>& samples, int degree, double tolerance, SampleParameters parameters,
    const std::function<CurveSample<Dim>(const CurveSample<Dim>&, const CurveSample<Dim>&)>& between,
    const Progress& progress) {
  TRIMQUAD_ASSERT(samples.size() >= 2);
  const double first = samples.front().s, last = samples.back().s, narrowest = 1e-6 * (last - first);
  const std::size_t samplesPerSpan = 6;
  std::vector<double> breaks{first, last};
  const auto sampled = [](double s, const CurveSample<Dim>& sample) { return s < sample.s; };
  constexpr int maxRounds = 60, maxSamples = 200000;
  for (int round = 0; round < maxRounds; ++round) {
    progress.check();
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
      auto begin = std::upper_bound(samples.begin(), samples.end(), breaks[k], sampled);
      auto end = std::upper_bound(samples.begin(), samples.end(), breaks[k + 1], sampled);
      while (std::size_t(end - begin) < samplesPerSpan) {
        const auto from = begin == samples.begin() ? begin : begin - 1,
                   to = end == samples.end() ? end - 1 : end;
        Samples<Dim> denser;
        for (auto it = from; it != to; ++it) {
          denser.push_back(*it);
          denser.push_back(between(*it, *(it + 1)));
        }
        const auto at = samples.erase(from, to) - samples.begin();
        samples.insert(samples.begin() + at, denser.begin(), denser.end());
        begin = std::upper_bound(samples.begin(), samples.end(), breaks[k], sampled);
        end = std::upper_bound(samples.begin(), samples.end(), breaks[k + 1], sampled);
      }
    }
    SplineCurve<Dim> curve;
    curve.degree = degree;
    curve.knots.assign(degree, first);
    curve.knots.insert(curve.knots.end(), breaks.begin(), breaks.end());
    curve.knots.insert(curve.knots.end(), degree, last);
    solvePoles(curve, samples);
    if (parameters == SampleParameters::Sliding) {
      slide(curve, samples);
      solvePoles(curve, samples);
    }
    std::vector<double> worst(breaks.size() - 1, 0);
    for (const auto& sample : samples) {
      const auto it = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, sample.s);
      double& w = worst[it - breaks.begin() - 1];
      w = std::max(w, distance(curve, sample, parameters));
    }
    if (*std::max_element(worst.begin(), worst.end()) <= tolerance) return curve;
    std::vector<double> finer;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
      finer.push_back(breaks[k]);
      if (worst[k] > tolerance && breaks[k + 1] - breaks[k] > narrowest)
        finer.push_back((breaks[k] + breaks[k + 1]) / 2);
    }
    finer.push_back(last);
    if (finer.size() == breaks.size() || samples.size() > maxSamples) break;
    breaks = std::move(finer);
  }
  throw stageError("fit", "a boundary curve cannot be followed within the tolerance; use a larger tolerance");
}

template PlaneCurve fitCurve<2>(
    std::vector<CurveSample<2>>&, int, double, SampleParameters,
    const std::function<CurveSample<2>(const CurveSample<2>&, const CurveSample<2>&)>&, const Progress&);
template SpaceCurve fitCurve<3>(
    std::vector<CurveSample<3>>&, int, double, SampleParameters,
    const std::function<CurveSample<3>(const CurveSample<3>&, const CurveSample<3>&)>&, const Progress&);

}  // namespace trimquad
