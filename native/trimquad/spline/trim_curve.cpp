#include "trimquad/spline/trim_curve.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/spline/fit_curve.h"

namespace trimquad {
namespace {

/// Length of the stretch over which a curve is led to a corner off it, by how far off that is.
constexpr double kPullLength = 20;
constexpr int kGapSamples = 1000, kGapSamplesPerPole = 4, kGoldenSections = 20;
constexpr double kNearlyLargest = 0.7;
/// How far the start of an edge with a gap is moved, by the gap; by which part of its distance that has to
/// fall on the curve's first span, evenly at least, and from which part of the span on that is looked at.
constexpr double kExposedGap = 1.25, kExposedFall = 0.1, kExposedNear = 1e-6;
/// By how much more it moves on than keeps the corner's foot in the curve's end.
constexpr double kExposedForward = 1.5;
constexpr int kExposingSpans = 20, kExposingSamples = 64;

Eigen::Matrix<double, 3, 2> metric(const Sheet& sheet, const Eigen::Vector2d& x) {
  const auto jet = sheet.jet(x);
  Eigen::Matrix<double, 3, 2> m;
  m << jet.su, jet.sv;
  return m;
}

/// A value's place among ascending ones: between number `left` and the next, this part of the way.
struct Place {
  std::size_t left;
  double part;
};

Place placeAmong(const std::vector<double>& ascending, double x) {
  const auto next = std::clamp(std::lower_bound(ascending.begin(), ascending.end(), x), ascending.begin() + 1,
                               ascending.end() - 1);
  const std::size_t left = next - ascending.begin() - 1;
  return {left, std::clamp((x - ascending[left]) / (*next - ascending[left]), 0.0, 1.0)};
}

/// Parameters in (a, b) where x(s) crosses the sheet's seam.
void appendSeamCrossings(const Sheet& sheet, const std::function<Eigen::Vector2d(double)>& x, double a,
                         double b, std::vector<double>& found) {
  if (!sheet.period) return;
  constexpr int steps = 512;
  double low = x(a)[0], high = low;
  for (int i = 1; i <= steps; ++i) {
    const double u = x(a + (b - a) * i / steps)[0];
    low = std::min(low, u);
    high = std::max(high, u);
  }
  const double first = sheet.surface.firstU();
  for (double turn = std::ceil((low - first) / *sheet.period); first + turn * *sheet.period <= high; ++turn) {
    const auto one =
        crossings([&](double s) { return x(s)[0]; }, first + turn * *sheet.period, 0, a, b, steps);
    found.insert(found.end(), one.begin(), one.end());
  }
}

/// Cuts of [a, b] into edges: at the given crossings, and once in the middle where a closed curve has no
/// other.
std::vector<double> edgeEnds(double a, double b, std::vector<double> cuts, bool closed) {
  std::sort(cuts.begin(), cuts.end());
  if (cuts.empty() && closed) cuts.push_back((a + b) / 2);
  cuts.insert(cuts.begin(), a);
  cuts.push_back(b);
  return cuts;
}

/// Puts the curve's end exactly onto the seam that it was cut at.
void snapToSeam(const Sheet& sheet, Eigen::Vector2d& end) {
  if (!sheet.period) return;
  const double first = sheet.surface.firstU();
  const double seam = first + *sheet.period * std::round((end[0] - first) / *sheet.period);
  constexpr double rounding = 1e-9;
  if (std::abs(end[0] - seam) < rounding) end[0] = seam;
}

/// The largest distance of a piece's curve from its images on the sheets at a place.
double gapAt(const TrimPiece& piece, const std::vector<const Sheet*>& sheets, double s) {
  const Eigen::Vector3d p = piece.curve.point(s);
  double gap = 0;
  for (std::size_t k = 0; k < sheets.size(); ++k)
    gap = std::max(gap, (sheets[k]->jet(piece.onSheet[k].point(s)).s - p).norm());
  return gap;
}

/// The largest of these distances: of many samples, and around the largest of these of what golden sections
/// find.
double largestGap(const TrimPiece& piece, const std::vector<const Sheet*>& sheets) {
  const double a = piece.curve.first(), b = piece.curve.last();
  std::vector<double> places{b};
  for (int i = 0; i < kGapSamples; ++i) places.push_back(a + (b - a) * i / kGapSamples);
  const auto addBetween = [&](const std::vector<double>& knots) {
    for (std::size_t i = 0; i + 1 < knots.size(); ++i)
      for (int k = 0; k < kGapSamplesPerPole && knots[i] < knots[i + 1]; ++k)
        places.push_back(knots[i] + (knots[i + 1] - knots[i]) * k / kGapSamplesPerPole);
  };
  addBetween(piece.curve.knots);
  for (const auto& image : piece.onSheet) addBetween(image.knots);
  std::sort(places.begin(), places.end());
  // Curves that were made together have the same knots.
  places.erase(std::unique(places.begin(), places.end()), places.end());
  std::vector<double> gaps;
  for (const double s : places) gaps.push_back(gapAt(piece, sheets, s));
  const double sampled = *std::max_element(gaps.begin(), gaps.end());
  double largest = sampled;
  for (std::size_t i = 1; i + 1 < gaps.size(); ++i)
    if (gaps[i] >= kNearlyLargest * sampled && gaps[i] >= gaps[i - 1] && gaps[i] >= gaps[i + 1]) {
      constexpr double part = 0.381966;  // of a golden section
      double low = places[i - 1], middle = places[i], high = places[i + 1], best = gaps[i];
      for (int step = 0; step < kGoldenSections; ++step) {
        const bool above = high - middle > middle - low;
        const double s = middle + part * (above ? high - middle : low - middle),
                     gap = gapAt(piece, sheets, s);
        if (gap > best) {
          (above ? low : high) = middle;
          middle = s;
          best = gap;
        } else {
          (above ? high : low) = s;
        }
      }
      largest = std::max(largest, best);
    }
  return largest;
}

/// Leads one end of a piece, in space and on both sheets, to where it is to be, unless that is far off.
void leadToEnd(TrimPiece& piece, bool atStart, const Eigen::Vector3d& point,
               const std::vector<SheetSide>& sides) {
  const auto tip = [&](auto& curve) -> auto& {
    return atStart ? curve.poles.front() : curve.poles.back();
  };
  const auto leg = [&](const auto& curve) {
    const auto& p = curve.poles;
    return atStart ? (p[1] - p[0]).norm() : (p[p.size() - 2] - p.back()).norm();
  };
  constexpr double near = 0.2;  // by the first leg of the poles
  const auto isNear = [&](auto& curve, const auto& place) {
    return (place - tip(curve)).norm() <= near * leg(curve);
  };
  Eigen::Vector2d place[2];
  bool allNear = isNear(piece.curve, point);
  for (const int k : {0, 1}) {
    place[k] = atStart ? sides[k].start : sides[k].end;
    snapToSeam(*sides[k].sheet, place[k]);
    allNear = allNear && isNear(piece.onSheet[k], place[k]);
  }
  if (!allNear) return;
  tip(piece.curve) = point;
  for (const int k : {0, 1}) tip(piece.onSheet[k]) = place[k];
}

/// S(x(s)) as a curve in space.
SpaceCurve composed(const Sheet& sheet, const PlaneCurve& x, const Progress& progress) {
  const auto onSurface = [&](double s) {
    const auto d = x.derivatives(s, 2);
    const auto jet = sheet.jet(d[0]);
    CurveJet<3> c;
    c.value = jet.s;
    c.first = jet.su * d[1][0] + jet.sv * d[1][1];
    c.second = jet.suu * (d[1][0] * d[1][0]) + jet.suv * (2 * d[1][0] * d[1][1]) +
               jet.svv * (d[1][1] * d[1][1]) + jet.su * d[2][0] + jet.sv * d[2][1];
    return c;
  };
  const auto deviation = [&](double s, const Eigen::Vector3d& p) {
    return (sheet.jet(x.point(s)).s - p).norm();
  };
  auto breaks = knotCrossings(
      sheet, [&](double s) { return x.point(s); }, x.first(), x.last());
  breaks.insert(breaks.end(), x.knots.begin() + x.degree + 1, x.knots.end() - x.degree - 1);
  return hermiteChain<3>(onSurface, mergedBreaks(std::move(breaks), x.first(), x.last()),
                         std::max(1, sheet.continuity()), deviation, kComposedError, progress);
}

/// The curve that `fit` gives; its errors say where.
template <class Fit>
auto located(const SheetSide& side, const SampledCurve& sampled, const Fit& fit) {
  try {
    return fit();
  } catch (const Error& error) {
    if (error.kind() != Error::Kind::Stage) throw;
    throw stageError(error.stage(), error.message(), side.region + ", " + sampled.curve->name,
                     sampled.point[sampled.point.size() / 2]);
  }
}

/// Where a corner lies off the curve that ends in it, the curve is led there over a stretch that is long
/// against the way; what a fit within the tolerance bridges itself is left to it.
class EndPull {
 public:
  EndPull(const Sheet& sheet, const Eigen::Vector2d& foot, const Eigen::Vector2d& corner, double tolerance)
      : move_(corner - foot), off_((metric(sheet, foot) * move_).norm()) {
    if (!(off_ > tolerance / 2)) move_.setZero();
  }
  /// \param away from the end, along the curve
  Eigen::Vector2d at(double away, double length) const {
    const double x = away / std::min(kPullLength * off_, length / 3);
    return x < 1 ? Eigen::Vector2d((1 - x) * (1 - x) * (1 + 2 * x) * move_) : Eigen::Vector2d(0, 0);
  }

 private:
  Eigen::Vector2d move_;
  double off_;
};

/// The foot of a point between two places on a sheet. Where the sheet bends sharply a point has several: the
/// one that goes on best between both places counts, and where all are far from there what is halfway
/// between, if that is within `reach`.
Eigen::Vector2d footBetween(const Sheet& sheet, const Eigen::Vector3d& point, const Eigen::Vector2d& p,
                            const Eigen::Vector2d& q, double reach) {
  const Eigen::Vector2d middle = (p + q) / 2;
  const Eigen::Vector2d foot = sheet.footPoint(point, middle);
  const auto jet = sheet.jet(middle);
  const auto away = [&](const Eigen::Vector2d& x) {
    const Eigen::Vector2d by = x - middle;
    return (jet.su * by[0] + jet.sv * by[1]).norm();
  };
  const double limit = away(p) + reach;
  if (away(foot) <= limit) return foot;
  Eigen::Vector2d best = foot;
  for (const auto& from : {p, q}) {
    const Eigen::Vector2d other = sheet.footPoint(point, from);
    if (away(other) < away(best) && (sheet.jet(other).s - point).norm() <= reach) best = other;
  }
  if (away(best) > limit && (jet.s - point).norm() <= reach) return middle;
  return best;
}

/// The smooth curve on the sheet that follows the sampled curve, from the side's start to its end.
PlaneCurve planeCurve(const SampledCurve& sampled, int sideIndex, const SheetSide& side,
                      const CurveCloseness& closeness, const Progress& progress) {
  const double tolerance = closeness.onSheet, inSpace = closeness.inSpace;
  const auto& feet = sampled.foot[sideIndex];
  const EndPull start(*side.sheet, feet.front(), side.start, tolerance),
      end(*side.sheet, feet.back(), side.end, tolerance);
  // Of the sampled curve, by its parameter: those of the samples slide along the fitted one.
  const double length = sampled.s.back() - sampled.s.front();
  const auto pull = [&](double t) -> Eigen::Vector2d {
    const double from = sampled.lengthAt(t) - sampled.s.front();
    return start.at(from, length) + end.at(length - from, length);
  };
  const auto sample = [&](double s, double t, const Eigen::Vector3d& p, const Eigen::Vector2d& foot) {
    const Eigen::Vector2d x = foot + pull(t);
    const double off = (side.sheet->jet(foot).s - p).norm();
    const double allowed = std::max(tolerance, std::sqrt(std::max(0.0, inSpace * inSpace - off * off)));
    return CurveSample<2>{s, t, x, metric(*side.sheet, x) * (tolerance / allowed)};
  };
  std::vector<CurveSample<2>> samples;
  for (std::size_t i = 0; i < sampled.s.size(); ++i)
    samples.push_back(sample(sampled.s[i], sampled.t[i], sampled.point[i], feet[i]));
  samples.front().point = side.start;
  samples.back().point = side.end;
  const auto between = [&](const CurveSample<2>& p, const CurveSample<2>& q) {
    const double t = (p.t + q.t) / 2;
    const Eigen::Vector3d point = sampled.curve->curve->point(t);
    return sample((p.s + q.s) / 2, t, point,
                  footBetween(*side.sheet, point, p.point - pull(p.t), q.point - pull(q.t),
                              std::max(tolerance, inSpace)));
  };
  return located(side, sampled, [&] {
    return fitCurve<2>(samples, 3, tolerance, SampleParameters::Sliding, between, progress);
  });
}

/// The samples' feet on a side's sheet. Where the sheet bends sharply a point has several, and which one is
/// reached depends on where the way to it starts: at the map's parameter of the point, or at a neighbour's
/// foot. The nearest one counts.
std::vector<Eigen::Vector2d> feetOn(const SheetSide& side, const SampledCurve& sampled, double reach) {
  const auto& run = *side.run;
  std::vector<Eigen::Vector2d> ofMap, feet;
  std::vector<double> off;
  const auto tryFrom = [&](std::size_t i, const Eigen::Vector2d& guess) {
    const Eigen::Vector2d foot = side.sheet->footPoint(sampled.point[i], guess);
    const double distance = (side.sheet->jet(foot).s - sampled.point[i]).norm();
    if (!(distance < off[i])) return;
    feet[i] = foot;
    off[i] = distance;
  };
  const auto tryBeside = [&](std::size_t i, std::size_t beside) {
    // A foot that is the nearest to rounding is not looked for again.
    if (off[i] > kComposedError) tryFrom(i, feet[beside] + ofMap[i] - ofMap[beside]);
  };
  for (std::size_t i = 0; i < sampled.t.size(); ++i) {
    const auto [left, x] = placeAmong(run.t, sampled.t[i]);
    ofMap.push_back((1 - x) * run.uv[left] + x * run.uv[left + 1]);
    feet.push_back(ofMap.back());
    off.push_back(HUGE_VAL);
    tryFrom(i, ofMap[i]);
    if (i > 0) tryBeside(i, i - 1);
  }
  for (std::size_t i = feet.size(); i-- > 1;) tryBeside(i - 1, i);
  for (std::size_t i = 0; i < feet.size(); ++i)
    if (off[i] > reach)
      throw stageError("fit",
                       "the fitted surface misses the boundary; use a smaller tolerance or edge length",
                       side.region + ", " + sampled.curve->name, sampled.point[i]);
  return feet;
}

/// More and more samples towards both ends of a curve, where its sheets may be tangent on a short stretch
/// only.
void refineEnds(std::vector<double>& t) {
  constexpr std::size_t kIntervals = 4, kMore = 24;
  constexpr double kRatio = 0.8;
  if (t.size() <= 2 * kIntervals) return;
  std::vector<double> more;
  for (const auto& [end, from] :
       {std::pair(t.front(), t[kIntervals]), {t.back(), t[t.size() - 1 - kIntervals]}}) {
    double part = 1;
    for (std::size_t k = 0; k < kMore; ++k) more.push_back(end + (part *= kRatio) * (from - end));
  }
  t.insert(t.end(), more.begin(), more.end());
  std::sort(t.begin(), t.end());
  t.erase(std::unique(t.begin(), t.end()), t.end());
}

}  // namespace

double SampledCurve::lengthAt(double at) const {
  const auto [left, x] = placeAmong(t, at);
  return (1 - x) * s[left] + x * s[left + 1];
}

double SampledCurve::apart(const std::vector<SheetSide>& sides) const {
  double most = 0;
  for (std::size_t i = 0; i < point.size(); ++i)
    most = std::max(most, (sides[0].sheet->jet(foot[0][i]).s - sides[1].sheet->jet(foot[1][i]).s).norm());
  return most;
}

SampledCurve sampleCurve(const ModelCurve& curve, const std::vector<SheetSide>& sides, double reach) {
  SampledCurve sampled{&curve, {}, {}, {}, {}};
  const auto& stations = sides.front().run->t;
  const int pieces = int(stations.size()) - 1, perPiece = std::max(4, (256 + pieces - 1) / pieces);
  for (int i = 0; i < pieces; ++i)
    for (int k = 0; k < perPiece; ++k)
      sampled.t.push_back(stations[i] + (stations[i + 1] - stations[i]) * k / perPiece);
  sampled.t.push_back(stations.back());
  if (sides.size() == 2) refineEnds(sampled.t);
  for (const double t : sampled.t) {
    const Eigen::Vector3d p = curve.curve->point(t);
    const double s = sampled.s.empty() ? 0 : sampled.s.back() + (p - sampled.point.back()).norm();
    // Two samples in one place would have one parameter: the later one says nothing new.
    if (!sampled.s.empty() && !(s > sampled.s.back())) {
      sampled.s.push_back(std::nextafter(sampled.s.back(), HUGE_VAL));
    } else {
      sampled.s.push_back(s);
    }
    sampled.point.push_back(p);
  }
  for (const auto& side : sides) sampled.foot.push_back(feetOn(side, sampled, reach));
  return sampled;
}

std::vector<TrimPiece> freeEdge(const SampledCurve& sampled, const SheetSide& side,
                                const CurveCloseness& closeness, const Progress& progress) {
  // The side is the only one that this edge is for, whichever place it has among the curve's sides.
  const PlaneCurve whole = planeCurve(sampled, 0, side, closeness, progress);
  std::vector<double> cuts;
  appendSeamCrossings(
      *side.sheet, [&](double s) { return whole.point(s); }, whole.first(), whole.last(), cuts);
  const auto ends =
      edgeEnds(whole.first(), whole.last(), std::move(cuts), sampled.curve->start == sampled.curve->end);
  std::vector<TrimPiece> pieces;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    PlaneCurve x = restricted(whole, ends[i], ends[i + 1]);
    snapToSeam(*side.sheet, x.poles.front());
    snapToSeam(*side.sheet, x.poles.back());
    TrimPiece piece{composed(*side.sheet, x, progress), {x}, 0};
    piece.gap = largestGap(piece, {side.sheet});
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

std::optional<IntersectionCurve> intersectionCurve(const SampledCurve& sampled,
                                                   const std::vector<SheetSide>& sides, double tolerance,
                                                   double reach, double smallestAngle,
                                                   const std::vector<TangentStretch>& tangent,
                                                   const Progress& progress) {
  const bool folded = smallestAngle < kSmallestCrossing;
  // In a wedge that closes towards an end there is none in the end itself.
  const auto angleAt = [&](std::size_t i) {
    return crossingAngle(sides[0].sheet->jet(sampled.foot[0][i]), sides[1].sheet->jet(sampled.foot[1][i]));
  };
  if (!folded && std::min(angleAt(0), angleAt(sampled.s.size() - 1)) < smallestAngle) return {};
  std::vector<CurveSample<3>> samples;
  for (std::size_t i = 0; i < sampled.s.size(); ++i)
    samples.push_back({sampled.s[i], sampled.t[i], sampled.point[i], Eigen::Matrix3d::Identity()});
  const auto between = [&](const CurveSample<3>& p, const CurveSample<3>& q) {
    const double t = (p.t + q.t) / 2;
    return CurveSample<3>{(p.s + q.s) / 2, t, sampled.curve->curve->point(t), Eigen::Matrix3d::Identity()};
  };
  auto reference = located(sides[0], sampled, [&] {
    return fitCurve<3>(samples, 5, tolerance, SampleParameters::Sliding, between, progress);
  });
  std::vector<IntersectionCurve::Guess> guesses;
  for (std::size_t i = 0; i < sampled.s.size(); ++i) {
    IntersectionCurve::Guess guess{sampled.s[i], {}};
    guess.at << sampled.foot[0][i], sampled.foot[1][i];
    guesses.push_back(guess);
  }
  IntersectionCurve intersection(*sides[0].sheet, *sides[1].sheet, std::move(reference), std::move(guesses),
                                 reach, smallestAngle, tangent);
  // The ends themselves may lie beyond the surfaces' common point; the corners settle those.
  constexpr double end = 0.5 / 64;
  const int tests = folded ? 2048 : 64;
  for (int i = 0; i < tests; ++i) {
    progress.check();
    const double at = std::clamp((i + 0.5) / tests, end, 1 - end);
    if (!intersection.parameters(sampled.s.back() * at)) return {};
  }
  return intersection;
}

std::optional<std::vector<TrimPiece>> sharedEdge(const IntersectionCurve& intersection, bool closed,
                                                 const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                                                 const std::vector<SheetSide>& sides,
                                                 const Progress& progress) {
  const Sheet &sheetA = intersection.a(), &sheetB = intersection.b();
  const auto& reference = intersection.reference();
  const double a = intersection.parameterOf(start, reference.first());
  const double b = intersection.parameterOf(end, reference.last());
  if (!(a < b)) return {};
  const auto solved = [&](double s) {
    const auto z = intersection.parameters(s);
    if (!z) throw IntersectionCurve::Missing{};
    return *z;
  };
  const auto onA = [&](double s) -> Eigen::Vector2d { return solved(s).head<2>(); };
  const auto onB = [&](double s) -> Eigen::Vector2d { return solved(s).tail<2>(); };
  const auto deviation = [&](double s, const Eigen::Matrix<double, 7, 1>& x) {
    return std::max((sheetA.jet(x.head<2>()).s - x.tail<3>()).norm(),
                    (sheetB.jet(x.segment<2>(2)).s - x.tail<3>()).norm() - intersection.apart(s));
  };
  std::vector<TrimPiece> pieces;
  try {
    std::vector<double> cuts;
    appendSeamCrossings(sheetA, onA, a, b, cuts);
    appendSeamCrossings(sheetB, onB, a, b, cuts);
    auto breaks = knotCrossings(sheetA, onA, a, b);
    const auto breaksB = knotCrossings(sheetB, onB, a, b);
    breaks.insert(breaks.end(), breaksB.begin(), breaksB.end());
    for (const auto* more : {&reference.knots, &intersection.tangentEnds()})
      breaks.insert(breaks.end(), more->begin(), more->end());
    const int continuity = std::max(1, std::min(sheetA.continuity(), sheetB.continuity()));
    const auto ends = edgeEnds(a, b, std::move(cuts), closed);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const auto chain = hermiteChain<7>([&](double s) { return intersection.jet(s); },
                                         mergedBreaks(breaks, ends[i], ends[i + 1]), continuity, deviation,
                                         kComposedError, progress);
      TrimPiece piece;
      piece.curve = {chain.degree, chain.knots, {}};
      piece.onSheet.assign(2, {chain.degree, chain.knots, {}});
      for (const auto& pole : chain.poles) {
        piece.onSheet[0].poles.push_back(pole.head<2>());
        piece.onSheet[1].poles.push_back(pole.segment<2>(2));
        piece.curve.poles.push_back(pole.tail<3>());
      }
      for (int k : {0, 1})
        for (auto* tip : {&piece.onSheet[k].poles.front(), &piece.onSheet[k].poles.back()})
          snapToSeam(k == 0 ? sheetA : sheetB, *tip);
      pieces.push_back(std::move(piece));
    }
    leadToEnd(pieces.front(), true, start, sides);
    leadToEnd(pieces.back(), false, end, sides);
    for (auto& piece : pieces) piece.gap = largestGap(piece, {&sheetA, &sheetB});
  } catch (const IntersectionCurve::Missing&) {
    return {};
  }
  return pieces;
}

void exposeGap(TrimPiece& piece, const std::vector<SheetSide>& sides, double exact, double most) {
  if (!(piece.gap > exact && piece.gap < most)) return;
  std::vector<const Sheet*> sheets;
  for (const auto& side : sides) sheets.push_back(side.sheet);
  const double first = piece.curve.first(), atFirst = gapAt(piece, sheets, first);
  // Looks at the first span before it searches the whole curve.
  const auto isFarthest = [&](TrimPiece& moved, double span) {
    const double atStart = gapAt(moved, sheets, first);
    const auto falls = [&](double part) {
      return gapAt(moved, sheets, first + part * span) <= (1 - kExposedFall * part) * atStart;
    };
    for (int i = kExposingSamples; i > 0; --i)
      if (!falls(double(i) / kExposingSamples)) return false;
    for (double part = 0.5 / kExposingSamples; part > kExposedNear; part /= 2)
      if (!falls(part)) return false;
    moved.gap = largestGap(moved, sheets);
    return moved.gap <= atStart;
  };
  // Away from both sheets: a reader that looks for curves of its own on them finds none that are closer.
  const Eigen::Vector3d away =
      (kExposedGap * piece.gap - atFirst) * normal(sides[0].sheet->jet(piece.onSheet[0].poles.front()));
  // The first pole is felt on the curve's first span; on a long one the gap grows before the move has faded.
  double span = piece.curve.knots[piece.curve.degree + 1] - first;
  for (int k = 0; k < kExposingSpans; ++k, span /= 2)
    for (const double way : {1, -1}) {
      TrimPiece moved = piece;
      if (k > 0) moved.curve = withKnot(moved.curve, first + span);
      auto& poles = moved.curve.poles;
      const Eigen::Vector3d leg = poles[1] - poles[0];
      // The corner's foot on the curve stays in its end: readers of STEP start there.
      poles[0] += way * away + kExposedForward * away.squaredNorm() / leg.squaredNorm() * leg;
      if (!isFarthest(moved, span)) continue;
      piece = std::move(moved);
      return;
    }
}

std::vector<TrimPiece> looseEdge(const SampledCurve& sampled, const std::vector<SheetSide>& sides,
                                 double closeness, const Progress& progress) {
  const Sheet &sheetA = *sides[0].sheet, &sheetB = *sides[1].sheet;
  const PlaneCurve wholeA = planeCurve(sampled, 0, sides[0], {closeness, closeness}, progress);
  const auto guessB = [&](double s) {
    const auto [left, x] = placeAmong(sampled.s, s);
    return Eigen::Vector2d((1 - x) * sampled.foot[1][left] + x * sampled.foot[1][left + 1]);
  };
  const auto sampleB = [&](double s) {
    const Eigen::Vector2d x = sheetB.footPoint(sheetA.jet(wholeA.point(s)).s, guessB(s));
    return CurveSample<2>{s, s, x, metric(sheetB, x)};
  };
  std::vector<CurveSample<2>> samples;
  for (const double s : sampled.s) samples.push_back(sampleB(s));
  samples.front().point = sides[1].start;
  samples.back().point = sides[1].end;
  const auto between = [&](const CurveSample<2>& p, const CurveSample<2>& q) {
    return sampleB((p.s + q.s) / 2);
  };
  // The end points are the corners', which may lie off the feet by as much as the sheets are apart.
  const double offset =
      std::max((samples.front().metric * (samples.front().point - sampleB(samples.front().s).point)).norm(),
               (samples.back().metric * (samples.back().point - sampleB(samples.back().s).point)).norm());
  double apart = kComposedError;
  for (const auto& sample : samples)
    apart = std::max(apart, (sheetA.jet(wholeA.point(sample.s)).s - sheetB.jet(sample.point).s).norm());
  const double tolerance = std::max(std::min(apart, closeness / 20), 1.1 * offset);
  const PlaneCurve wholeB = located(sides[1], sampled, [&] {
    return fitCurve<2>(samples, 3, tolerance, SampleParameters::Fixed, between, progress);
  });
  std::vector<double> cuts;
  appendSeamCrossings(
      sheetA, [&](double s) { return wholeA.point(s); }, wholeA.first(), wholeA.last(), cuts);
  appendSeamCrossings(
      sheetB, [&](double s) { return wholeB.point(s); }, wholeB.first(), wholeB.last(), cuts);
  const auto ends =
      edgeEnds(wholeA.first(), wholeA.last(), std::move(cuts), sampled.curve->start == sampled.curve->end);
  std::vector<TrimPiece> pieces;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    PlaneCurve xa = restricted(wholeA, ends[i], ends[i + 1]), xb = restricted(wholeB, ends[i], ends[i + 1]);
    for (auto* end : {&xa.poles.front(), &xa.poles.back()}) snapToSeam(sheetA, *end);
    for (auto* end : {&xb.poles.front(), &xb.poles.back()}) snapToSeam(sheetB, *end);
    TrimPiece piece{composed(sheetA, xa, progress), {xa, xb}, 0};
    piece.gap = largestGap(piece, {&sheetA, &sheetB});
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace trimquad
