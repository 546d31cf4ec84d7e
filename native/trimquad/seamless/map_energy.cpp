#include "trimquad/seamless/map_energy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace trimquad {
namespace {

/// Weight of kept angles beside symmetric Dirichlet energy. Measured: deviations from right angles fall by a
/// third, those of edge lengths rise by a tenth.
constexpr double kStraightness = 4;

}  // namespace

MapDensity symmetricDirichlet(double I, double D) {
  if (D <= 0) return {std::numeric_limits<double>::infinity(), 0, 0, 0, 0};
  const double r = 1 / D, r2 = r * r;
  return {I * (1 + r2), 1 + r2, -2 * I * r2 * r, -2 * r2 * r, 6 * I * r2 * r2};
}

MapDensity straightDirichlet(double I, double D) {
  MapDensity d = symmetricDirichlet(I, D);
  if (D <= 0) return d;
  const double r = kStraightness / D;
  d.value += r * I;
  d.dI += r;
  d.dD -= r * I / D;
  d.dId -= r / D;
  d.dDd += 2 * r * I / (D * D);
  return d;
}

MapDensity foldoverFree(double I, double D, double epsilon) {
  const double e2 = epsilon * epsilon, s = std::sqrt(D * D + e2);
  const double chi = D >= 0 ? (D + s) / 2 : e2 / (2 * (s - D));  // the second form does not cancel
  const double chi1 = chi / s, chi2 = e2 / (2 * s * s * s);
  const double n = I + 1 + D * D, c2 = chi * chi;
  return {n / chi, 1 / chi, 2 * D / chi - n * chi1 / c2, -chi1 / c2,
          2 / chi - 4 * D * chi1 / c2 - n * (chi2 / c2 - 2 * chi1 * chi1 / (c2 * chi))};
}

MapEnergy::MapEnergy(const SurfaceMesh& mesh, const MapTarget& target, const SeamBasis& basis)
    : local_(mesh.n_faces()), offset_(basis.basis().offset()) {
  std::vector<HessianPattern::Corners> corners;
  corners.reserve(local_.size());
  for (const auto f : mesh.faces()) {
    auto& local = local_[f.idx()];
    HalfedgeHandle h = mesh.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      for (int axis = 0; axis < 2; ++axis)
        local.coordinate[2 * k + axis] = basis.coordinate(basis.wedge(h), axis);
    corners.push_back(local.coordinate);
  }
  pattern_ = HessianPattern(basis.basis().matrix(), corners);
  aim(target);
}

void MapEnergy::aim(const MapTarget& target) {
  totalArea_ = 0;
  for (size_t f = 0; f < local_.size(); ++f) {
    auto& local = local_[f];
    const auto& corner = target[f];
    const Eigen::Vector2d e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const double twice = e1.x() * e2.y() - e1.y() * e2.x();
    local.area = twice / 2;
    totalArea_ += local.area;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d across = corner[(k + 2) % 3] - corner[(k + 1) % 3];
      const double gx = -across.y() / twice,
                   gy = across.x() / twice;  // gradient of the corner's hat function
      local.toJacobian.col(2 * k) << gx / 2, -gy / 2, gx / 2, gy / 2;
      local.toJacobian.col(2 * k + 1) << gy / 2, gx / 2, -gy / 2, gx / 2;
    }
  }
}

void MapEnergy::setScaffold(int first, double weight) {
  for (int f = first; f < int(local_.size()); ++f) {
    local_[f].area = weight;
    local_[f].following = 0;
  }
}

void MapEnergy::evenOut(double evenness) {
  // Slivers that weighed as much as their neighbours would leave systems without digits.
  constexpr double kMostRaised = 1e4;
  const double mean = totalArea_ / double(local_.size());
  double total = 0;
  for (auto& local : local_)
    total += local.area *= std::pow(std::min(mean / local.area, kMostRaised), evenness);
  for (auto& local : local_) local.area *= totalArea_ / total;
}

void MapEnergy::stiffen(const std::vector<double>& factor) {
  for (size_t f = 0; f < local_.size(); ++f) local_[f].area *= factor[f];
}

MapEnergy::Jacobian MapEnergy::jacobian(int face, const Eigen::VectorXd& x) const {
  const auto& local = local_[face];
  Eigen::Matrix<double, 6, 1> corners;
  for (int i = 0; i < 6; ++i) corners[i] = x[local.coordinate[i]];
  const Eigen::Vector4d j = local.toJacobian * corners;
  return {j[0], j[1], j[2], j[3]};
}

Eigen::VectorXd MapEnergy::coordinates(const Eigen::VectorXd& z) const {
  Eigen::VectorXd x = pattern_.basis() * z + offset_;
  if (shift_.size() > 0) x += shift_;
  return x;
}

std::vector<int> MapEnergy::unknownsOf(int face) const {
  std::vector<int> unknowns;
  for (const int variable : local_[face].coordinate)
    for (HessianPattern::Basis::InnerIterator term(pattern_.basis(), variable); term; ++term)
      unknowns.push_back(int(term.col()));
  std::sort(unknowns.begin(), unknowns.end());
  unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
  return unknowns;
}

MapEnergy MapEnergy::restricted(const std::vector<int>& faces, const std::vector<int>& unknowns,
                                const Eigen::VectorXd& z) const {
  const auto place = [](const std::vector<int>& ascending, int element) {
    return int(std::lower_bound(ascending.begin(), ascending.end(), element) - ascending.begin());
  };
  std::vector<int> variables;
  for (const int f : faces)
    variables.insert(variables.end(), local_[f].coordinate.begin(), local_[f].coordinate.end());
  std::sort(variables.begin(), variables.end());
  variables.erase(std::unique(variables.begin(), variables.end()), variables.end());

  MapEnergy part;
  part.offset_.resize(Eigen::Index(variables.size()));
  std::vector<Eigen::Triplet<double>> terms;
  for (int i = 0; i < int(variables.size()); ++i) {
    double held = offset_[variables[i]] + (shift_.size() > 0 ? shift_[variables[i]] : 0);
    for (HessianPattern::Basis::InnerIterator term(pattern_.basis(), variables[i]); term; ++term) {
      const int unknown = int(term.col()), column = place(unknowns, unknown);
      if (column < int(unknowns.size()) && unknowns[column] == unknown)
        terms.emplace_back(i, column, term.value());
      else
        held += term.value() * z[unknown];
    }
    part.offset_[i] = held;
  }
  HessianPattern::Basis basis(Eigen::Index(variables.size()), Eigen::Index(unknowns.size()));
  basis.setFromTriplets(terms.begin(), terms.end());

  std::vector<HessianPattern::Corners> corners;
  for (const int f : faces) {
    part.local_.push_back(local_[f]);
    for (int& variable : part.local_.back().coordinate) variable = place(variables, variable);
    corners.push_back(part.local_.back().coordinate);
    part.totalArea_ += local_[f].area;
  }
  part.pattern_ = HessianPattern(basis, corners);
  return part;
}

std::vector<int> MapEnergy::heldFlat() const {
  // det is a polynomial in z: one that vanishes at points without structure vanishes everywhere. (Schwartz
  // and Zippel) Two of them, since z also has the size of the constants.
  constexpr double kVanished = 1e-9;  // relative to |J|^2
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<int> flat;
  for (int round = 0; round < 2; ++round) {
    Eigen::VectorXd z(unknownCount());
    const double size = 1 + (offset_.size() > 0 ? offset_.cwiseAbs().maxCoeff() : 0);
    for (double& value : z) value = size * uniform(random);
    const Eigen::VectorXd x = coordinates(z);
    const auto vanishes = [&](int f) {
      const Jacobian j = jacobian(f, x);
      return std::abs(j.det()) <= kVanished * j.norm2();
    };
    if (round == 0) {
      for (int f = 0; f < int(local_.size()); ++f)
        if (vanishes(f)) flat.push_back(f);
    } else {
      std::erase_if(flat, [&](int f) { return !vanishes(f); });
    }
  }
  return flat;
}

std::vector<FaceHandle> MapEnergy::turnedOver(const Eigen::VectorXd& x) const {
  std::vector<FaceHandle> faces;
  for (int f = 0; f < int(local_.size()); ++f)
    if (!(jacobian(f, x).det() > 0)) faces.emplace_back(f);
  return faces;
}

int MapEnergy::flipped(const Eigen::VectorXd& x) const {
  int count = 0;
  for (int f = 0; f < int(local_.size()); ++f) count += !(jacobian(f, x).det() > 0);
  return count;
}

double MapEnergy::smallestDeterminant(const Eigen::VectorXd& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (int f = 0; f < int(local_.size()); ++f) least = std::min(least, jacobian(f, x).det());
  return least;
}

double MapEnergy::stepToCollapse(const Eigen::VectorXd& x, const Eigen::VectorXd& direction) const {
  double step = std::numeric_limits<double>::infinity();
  for (int f = 0; f < int(local_.size()); ++f) {
    const Jacobian a = jacobian(f, x), b = jacobian(f, direction);
    // det(a + t b) = c + 2 h t + d t^2; its smallest positive root, without cancellation
    const double c = a.det(), d = b.det();
    const double h =
        a.fzReal * b.fzReal + a.fzImag * b.fzImag - a.fzbarReal * b.fzbarReal - a.fzbarImag * b.fzbarImag;
    const double discriminant = h * h - c * d;
    if (discriminant < 0) continue;
    const double root = std::sqrt(discriminant);
    const double denominator = -h + root;  // c / (-h + root) is the root that becomes positive first
    if (denominator > 0 && c / denominator > 0) step = std::min(step, c / denominator);
  }
  return step;
}

double MapEnergy::meanSymmetricDirichlet(const Eigen::VectorXd& x) const {
  return value(x, symmetricDirichlet, 0) / totalArea_;
}

double MapEnergy::stepWork() const {
  // A triangle's share takes about so many times as long as its numbers in the Hessian; measured.
  constexpr double kMemory = 10, kTriangle = 3000;
  return kTriangle * double(local_.size()) + kMemory * pattern_.work();
}

void MapEnergy::addTriangle(int face, double dP, double dQ, double dPP, double dQQ, double dPQ,
                            double tangentP, double tangentQ, const Jacobian& j, double follow,
                            Eigen::VectorXd& gradientX, HessianPattern::Sum& hessian) const {
  const auto& local = local_[face];
  const double p = std::hypot(j.fzReal, j.fzImag), q = std::hypot(j.fzbarReal, j.fzbarImag);
  const Eigen::Vector2d n = p > 0 ? Eigen::Vector2d(j.fzReal / p, j.fzImag / p) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d m = q > 0 ? Eigen::Vector2d(j.fzbarReal / q, j.fzbarImag / q) : Eigen::Vector2d(1, 0);

  Eigen::Vector4d gradient;
  gradient << dP * n, dQ * m;
  follow *= local.following;
  gradient += 4 * follow * Eigen::Vector4d(j.fzReal - 1, j.fzImag, j.fzbarReal, j.fzbarImag);

  // Positive part of the radial block, in closed form.
  const double mean = (dPP + dQQ) / 2, half = std::hypot((dPP - dQQ) / 2, dPQ);
  const double high = mean + half, low = mean - half;
  double a = dPP, b = dPQ, c = dQQ;
  if (high <= 0) {
    a = b = c = 0;
  } else if (low < 0) {
    // keep only the eigenvector of `high`
    double ex = dPQ, ey = high - dPP;
    if (std::abs(high - dQQ) > std::abs(ey)) ex = high - dQQ, ey = dPQ;
    const double norm2 = ex * ex + ey * ey;
    if (norm2 > 0)
      a = high * ex * ex / norm2, b = high * ex * ey / norm2, c = high * ey * ey / norm2;
    else
      a = c = high, b = 0;
  }
  const Eigen::Vector2d nt(-n.y(), n.x()), mt(-m.y(), m.x());
  Eigen::Matrix4d byJacobian;
  byJacobian.topLeftCorner<2, 2>() = a * n * n.transpose() + std::max(tangentP, 0.0) * nt * nt.transpose();
  byJacobian.bottomRightCorner<2, 2>() =
      c * m * m.transpose() + std::max(tangentQ, 0.0) * mt * mt.transpose();
  byJacobian.topRightCorner<2, 2>() = b * n * m.transpose();
  byJacobian.bottomLeftCorner<2, 2>() = b * m * n.transpose();
  byJacobian.diagonal().array() += 4 * follow;

  const Eigen::Matrix<double, 6, 1> g = local.area * (local.toJacobian.transpose() * gradient);
  const Eigen::Matrix<double, 6, 6> h =
      local.area * (local.toJacobian.transpose() * byJacobian * local.toJacobian);
  for (int i = 0; i < 6; ++i) gradientX[local.coordinate[i]] += g[i];
  pattern_.add(face, h, hessian);
}

}  // namespace trimquad
