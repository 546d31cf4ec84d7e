#include "trimquad/spline/fit_curve.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// Neighbouring samples are at most this part of a span apart, so that the curve cannot swing out between
/// them.
constexpr int kIntervalsPerSpan = 5;
/// Halvings of a span in a row that may bring less than half of the distance: beyond that the samples jump.
constexpr int kMaxHalvings = 10;

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

/// The way of a sample's parameter to its foot on the curve: one Newton step, at most half the way to a
/// neighbour, so that the order stays.
template <int Dim>
double slideOf(const SplineCurve<Dim>& curve, const Samples<Dim>& samples, std::size_t i) {
  if (i == 0 || i + 1 == samples.size()) return 0;
  const auto& sample = samples[i];
  const auto c = curve.derivatives(sample.s, 1);
  const Eigen::Vector3d tangent = sample.metric * c[1], error = sample.metric * (sample.point - c[0]);
  const double speed2 = tangent.squaredNorm();
  if (!(speed2 > 0)) return 0;
  return std::clamp(error.dot(tangent) / speed2, (samples[i - 1].s - sample.s) / 2,
                    (samples[i + 1].s - sample.s) / 2);
}

template <int Dim>
void slide(const SplineCurve<Dim>& curve, Samples<Dim>& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].s += slideOf(curve, samples, i);
}

std::size_t spanOf(const std::vector<double>& breaks, double s) {
  return std::size_t(std::upper_bound(breaks.begin() + 1, breaks.end() - 1, s) - breaks.begin() - 1);
}

/// By span: the largest distance, in space, of its samples from the curve; of sliding ones, from where they
/// slide to.
template <int Dim>
std::vector<double> distances(const SplineCurve<Dim>& curve, const std::vector<double>& breaks,
                              const Samples<Dim>& samples, SampleParameters parameters) {
  std::vector<double> largest(breaks.size() - 1, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double s = samples[i].s;
    const double foot = parameters == SampleParameters::Sliding ? s + slideOf(curve, samples, i) : s;
    double& span = largest[spanOf(breaks, s)];
    span = std::max(span, (samples[i].metric * (samples[i].point - curve.point(foot))).norm());
  }
  return largest;
}

/// With a new sample between every two neighbours for which `wanted(left, right)` holds.
template <int Dim, class Wanted>
Samples<Dim> halved(const Samples<Dim>& samples, const SampleBetween<Dim>& between, const Wanted& wanted) {
  Samples<Dim> denser;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    denser.push_back(samples[i]);
    if (wanted(samples[i], samples[i + 1])) denser.push_back(between(samples[i], samples[i + 1]));
  }
  denser.push_back(samples.back());
  return denser;
}

/// Adds samples until neighbours are close together against every span that they lie in or around.
template <int Dim>
void fillSpans(Samples<Dim>& samples, const std::vector<double>& breaks, const SampleBetween<Dim>& between) {
  const auto far = [&](const CurveSample<Dim>& left, const CurveSample<Dim>& right) {
    double narrowest = breaks.back() - breaks.front();
    for (std::size_t k = spanOf(breaks, left.s); k <= spanOf(breaks, right.s); ++k)
      narrowest = std::min(narrowest, breaks[k + 1] - breaks[k]);
    return right.s - left.s > narrowest / kIntervalsPerSpan;
  };
  for (std::size_t before = 0; before < samples.size();) {
    before = samples.size();
    samples = halved(samples, between, far);
  }
}

}  // namespace

template <int Dim>
SplineCurve<Dim> fitCurve(std::vector<CurveSample<Dim>>& samples, int degree, double tolerance,
                          SampleParameters parameters, const SampleBetween<Dim>& between,
                          const Progress& progress) {
  TRIMQUAD_ASSERT(samples.size() >= 2);
  const double first = samples.front().s, last = samples.back().s, narrowest = 1e-6 * (last - first);
  std::vector<double> breaks{first, last};
  // By span: the distance that was last halved in it, and how often the span was since.
  struct History {
    double distance = HUGE_VAL;
    int halvings = 0;
  };
  std::vector<History> history(1);
  const auto anywhere = [](const CurveSample<Dim>&, const CurveSample<Dim>&) { return true; };
  constexpr int maxRounds = 60, maxSamples = 40000;
  for (int round = 0; round < maxRounds && samples.size() <= maxSamples; ++round) {
    progress.check();
    fillSpans<Dim>(samples, breaks, between);
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
    const auto misses = [&](double distance) { return distance > tolerance; };
    const auto worst = distances(curve, breaks, samples, parameters);
    if (std::none_of(worst.begin(), worst.end(), misses)) {
      const auto control = distances(curve, breaks, halved<Dim>(samples, between, anywhere), parameters);
      if (std::none_of(control.begin(), control.end(), misses)) return curve;
      samples = halved<Dim>(samples, between, [&](const CurveSample<Dim>& p, const CurveSample<Dim>& q) {
        return misses(control[spanOf(breaks, (p.s + q.s) / 2)]);
      });
      continue;
    }
    std::vector<double> finer;
    std::vector<History> finerHistory;
    bool hopeless = false;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
      finer.push_back(breaks[k]);
      finerHistory.push_back(history[k]);
      if (!misses(worst[k]) || !(breaks[k + 1] - breaks[k] > narrowest)) continue;
      auto& [distance, halvings] = finerHistory.back();
      if (worst[k] < distance / 2) {
        distance = worst[k];
        halvings = 0;
      } else {
        hopeless = hopeless || ++halvings > kMaxHalvings;
      }
      finer.push_back((breaks[k] + breaks[k + 1]) / 2);
      finerHistory.push_back(finerHistory.back());
    }
    finer.push_back(last);
    if (hopeless || finer.size() == breaks.size()) break;
    breaks = std::move(finer);
    history = std::move(finerHistory);
  }
  throw stageError("fit", "a boundary curve cannot be followed within the tolerance; use a larger tolerance");
}

template PlaneCurve fitCurve<2>(std::vector<CurveSample<2>>&, int, double, SampleParameters,
                                const SampleBetween<2>&, const Progress&);
template SpaceCurve fitCurve<3>(std::vector<CurveSample<3>>&, int, double, SampleParameters,
                                const SampleBetween<3>&, const Progress&);

}  // namespace trimquad
