#include "trimquad/spline/corner_point.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

constexpr double kSmallestVolume = 0.0025;  ///< of the parallelepiped of the unit normals
constexpr int kMeetingSteps = 30;

/// S0 = S1 (= S2), by Newton; two sheets are cut with the plane through `p` across their intersection.
std::optional<std::vector<Eigen::Vector2d>> commonPoint(const Eigen::Vector3d& p,
                                                        const std::vector<const Sheet*>& sheets,
                                                        std::vector<Eigen::Vector2d> at, double reach,
                                                        double smallestAngle) {
  const int count = int(sheets.size()), size = 2 * count;
  std::vector<SplineSurface::Jet> jets(count);
  const auto evaluate = [&] {
    for (int i = 0; i < count; ++i) jets[i] = sheets[i]->jet(at[i]);
  };
  evaluate();
  const Eigen::Vector3d along = normal(jets[0]).cross(normal(jets[1]));
  for (int step = 0; step < kMeetingSteps; ++step) {
    const Eigen::Vector3d n2 = count == 3 ? normal(jets[2]) : along;
    const double smallest = count == 3 ? kSmallestVolume : smallestAngle * smallestAngle;
    if (std::abs(normal(jets[0]).cross(normal(jets[1])).dot(n2)) < smallest) return {};
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(size);
    for (int i = 1; i < count; ++i) {
      m.block<3, 1>(3 * i - 3, 0) = jets[0].su;
      m.block<3, 1>(3 * i - 3, 1) = jets[0].sv;
      m.block<3, 1>(3 * i - 3, 2 * i) = -jets[i].su;
      m.block<3, 1>(3 * i - 3, 2 * i + 1) = -jets[i].sv;
      f.segment<3>(3 * i - 3) = jets[0].s - jets[i].s;
    }
    if (count == 2) {
      m(3, 0) = along.dot(jets[0].su);
      m(3, 1) = along.dot(jets[0].sv);
      f[3] = along.dot(jets[0].s - p);
    }
    const Eigen::VectorXd move = m.partialPivLu().solve(-f);
    if (!move.allFinite()) return {};
    for (int i = 0; i < count; ++i) {
      at[i] += move.segment<2>(2 * i);
      if (!sheets[i]->holds(at[i])) return {};
    }
    evaluate();
    if (move.cwiseAbs().maxCoeff() < 1e-13) break;
  }
  for (int i = 0; i < count; ++i)
    if ((jets[i].s - jets[0].s).norm() > 1e-12 * std::max(1.0, p.norm()) || (jets[i].s - p).norm() > reach)
      return {};
  return at;
}

/// The three sheets that cross most steeply, then the two that do. Curves in which these cut each other then
/// end in one point, whichever sheets are tangent to them.
std::vector<std::vector<int>> steepestFirst(const std::vector<const Sheet*>& sheets,
                                            const std::vector<Eigen::Vector2d>& at) {
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t i = 0; i < sheets.size(); ++i) normals.push_back(normal(sheets[i]->jet(at[i])));
  std::vector<int> pair, triple;
  double steepest = 0, largest = 0;
  for (int i = 0; i < int(sheets.size()); ++i)
    for (int j = i + 1; j < int(sheets.size()); ++j) {
      const Eigen::Vector3d across = normals[i].cross(normals[j]);
      if (across.norm() > steepest) steepest = across.norm(), pair = {i, j};
      for (int k = j + 1; k < int(sheets.size()); ++k)
        if (const double volume = std::abs(across.dot(normals[k])); volume > largest)
          largest = volume, triple = {i, j, k};
    }
  std::vector<std::vector<int>> chosen;
  if (!triple.empty()) chosen.push_back(triple);
  if (!pair.empty()) chosen.push_back(pair);
  return chosen;
}

}  // namespace

CornerPoint cornerPoint(const Eigen::Vector3d& p, const std::vector<const Sheet*>& sheets,
                        const std::vector<Eigen::Vector2d>& guess, double reach, double smallestAngle) {
  TRIMQUAD_ASSERT(!sheets.empty() && sheets.size() == guess.size());
  CornerPoint corner{Eigen::Vector3d::Zero(), guess};
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    corner.at[i] = sheets[i]->footPoint(p, guess[i]);
    corner.point += sheets[i]->jet(corner.at[i]).s / double(sheets.size());
  }
  if (sheets.size() == 1) return corner;
  for (const auto& chosen : steepestFirst(sheets, corner.at)) {
    std::vector<const Sheet*> some;
    std::vector<Eigen::Vector2d> at;
    for (const int i : chosen) some.push_back(sheets[i]), at.push_back(corner.at[i]);
    const auto common = commonPoint(p, some, std::move(at), reach, smallestAngle);
    if (!common) continue;
    corner.point = some[0]->jet((*common)[0]).s;
    for (std::size_t i = 0; i < sheets.size(); ++i)
      corner.at[i] = sheets[i]->footPoint(corner.point, corner.at[i]);
    for (std::size_t k = 0; k < chosen.size(); ++k) corner.at[chosen[k]] = (*common)[k];
    return corner;
  }
  for (std::size_t i = 0; i < sheets.size(); ++i)
    corner.at[i] = sheets[i]->footPoint(corner.point, corner.at[i]);
  return corner;
}

double placeOnLine(const Eigen::Vector3d& p, const SheetLine& line, double guess, const Sheet* other,
                   const Eigen::Vector2d& otherGuess, double reach) {
  const auto tangent = [&](const SplineSurface::Jet& jet) -> Eigen::Vector3d {
    return jet.su * line.along[0] + jet.sv * line.along[1];
  };
  double s = guess;
  for (int step = 0; step < kMeetingSteps; ++step) {
    const auto jet = line.sheet->jet(line.at(s));
    const Eigen::Vector3d t = tangent(jet);
    const double move = (p - jet.s).dot(t) / t.squaredNorm();
    s += move;
    if (std::abs(move) < 1e-14) break;
  }
  if (!other) return s;
  const double nearest = s;
  Eigen::Vector2d x = other->footPoint(line.sheet->jet(line.at(s)).s, otherGuess);
  for (int step = 0; step < kMeetingSteps; ++step) {
    const auto jet = line.sheet->jet(line.at(s)), there = other->jet(x);
    Eigen::Matrix3d m;
    m << tangent(jet), -there.su, -there.sv;
    const Eigen::Vector3d move = m.partialPivLu().solve(there.s - jet.s);
    if (!move.allFinite() || std::abs(tangent(jet).normalized().dot(normal(there))) < kSmallestVolume)
      return nearest;
    s += move[0];
    x += move.tail<2>();
    if (!other->holds(x) || !line.sheet->holds(line.at(s))) return nearest;
    if (move.cwiseAbs().maxCoeff() < 1e-14) break;
  }
  const Eigen::Vector3d found = line.sheet->jet(line.at(s)).s;
  return (found - other->jet(x).s).norm() < 1e-12 * std::max(1.0, p.norm()) && (found - p).norm() < reach
             ? s
             : nearest;
}

}  // namespace trimquad
