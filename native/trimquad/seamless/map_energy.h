#pragma once

#include <Eigen/Sparse>
#include <vector>

#include "trimquad/seamless/hessian_pattern.h"
#include "trimquad/seamless/seam_basis.h"
#include "trimquad/seamless/seamless_map.h"

namespace trimquad {

/// Energies of a piecewise linear map as functions of |J|^2 and det J, J the Jacobian against the target
/// triangle, plus `follow` * |J - 1|^2. Value and derivatives of the first part:
struct MapDensity {
  double value, dI, dD, dId, dDd;  ///< by I = |J|^2, D = det J; second derivatives ID and DD (II is 0)
};

/// |J|^2 + |J^-1|^2, infinite where D <= 0.
MapDensity symmetricDirichlet(double I, double D);
/// The same and a multiple of |J|^2 / det J, which is least where angles are kept: what maps are optimised
/// for. Quads become straighter for a little of the evenness of their edges.
MapDensity straightDirichlet(double I, double D);
/// (|J|^2 + 1 + D^2) / chi(D), chi a smooth positive stand-in for D that tends to max(D, 0) with epsilon:
/// finite everywhere, so that it leads from maps with flipped triangles to maps without. (Garanzha et al.
/// 2021)
MapDensity foldoverFree(double I, double D, double epsilon);

/// The part of a triangle's area that is turned over. No derivatives.
inline MapDensity turnedArea(double, double D) {
  return {D < 0 ? -D : 0, 0, 0, 0, 0};
}

/// The map energies of one mesh, target and basis.
class MapEnergy {
 public:
  MapEnergy(const SurfaceMesh& mesh, const MapTarget& target, const SeamBasis& basis);

  /// Changes the target. Triangles weigh what their areas in it are.
  void aim(const MapTarget& target);

  /// Makes triangles from `first` on part of a scaffold: each has the weight `weight` instead of its area,
  /// and they do not follow their target's directions.
  void setScaffold(int first, double weight);

  /// Weighs triangles by area^(1 - evenness), as much as before on the whole.
  void evenOut(double evenness);

  /// Weighs triangles by `factor` (by face) beside their areas.
  void stiffen(const std::vector<double>& factor);

  /// Adds to all coordinates from now on.
  void shift(const Eigen::VectorXd& x) { shift_ = x; }

  /// Jacobian of a triangle as derivatives by z and its conjugate: J a = fz a + fzbar conj(a).
  struct Jacobian {
    double fzReal, fzImag, fzbarReal, fzbarImag;
    double det() const {
      return fzReal * fzReal + fzImag * fzImag - fzbarReal * fzbarReal - fzbarImag * fzbarImag;
    }
    double norm2() const {
      return 2 * (fzReal * fzReal + fzImag * fzImag + fzbarReal * fzbarReal + fzbarImag * fzbarImag);
    }
  };
  Jacobian jacobian(int face, const Eigen::VectorXd& x) const;

  int faceCount() const { return int(local_.size()); }
  int unknownCount() const { return int(pattern_.basis().cols()); }
  Eigen::VectorXd coordinates(const Eigen::VectorXd& z) const;  ///< x = matrix z + offset + shift
  /// How x moves where z moves like this.
  Eigen::VectorXd movement(const Eigen::VectorXd& z) const { return pattern_.basis() * z; }
  /// The unknowns that a triangle depends on, ascending.
  std::vector<int> unknownsOf(int face) const;
  /// The energy of these triangles alone as a function of these unknowns, where z holds the others.
  MapEnergy restricted(const std::vector<int>& faces, const std::vector<int>& unknowns,
                       const Eigen::VectorXd& z) const;

  /// Triangles that the constraints hold flat, whatever z is.
  std::vector<int> heldFlat() const;
  std::vector<FaceHandle> turnedOver(const Eigen::VectorXd& x) const;  ///< triangles with det <= 0, ascending
  int flipped(const Eigen::VectorXd& x) const;                         ///< how many
  double smallestDeterminant(const Eigen::VectorXd& x) const;
  /// Largest step along `direction` before a triangle collapses; infinite where none does.
  double stepToCollapse(const Eigen::VectorXd& x, const Eigen::VectorXd& direction) const;
  double meanSymmetricDirichlet(const Eigen::VectorXd& x) const;
  /// About how many multiplications value and derivatives take, for a StepBudget.
  double stepWork() const;

  template <typename Density>
  double value(const Eigen::VectorXd& x, const Density& density, double follow) const;
  /// Gradient by z and the Hessian by z, each triangle's projected to be positive semidefinite.
  template <typename Density>
  void derivatives(const Eigen::VectorXd& x, const Density& density, double follow, Eigen::VectorXd& gradient,
                   Eigen::SparseMatrix<double>& hessian) const;

 private:
  struct Local {
    HessianPattern::Corners coordinate;      ///< u0 v0 u1 v1 u2 v2 in x
    Eigen::Matrix<double, 4, 6> toJacobian;  ///< corner coordinates to (Re fz, Im fz, Re fzbar, Im fzbar)
    double area;
    double following = 1;  ///< factor of `follow`
  };
  void addTriangle(int face, double dP, double dQ, double dPP, double dQQ, double dPQ, double tangentP,
                   double tangentQ, const Jacobian& j, double follow, Eigen::VectorXd& gradientX,
                   HessianPattern::Sum& hessian) const;

  MapEnergy() = default;

  std::vector<Local> local_;
  HessianPattern pattern_;
  Eigen::VectorXd offset_;
  double totalArea_ = 0;
  Eigen::VectorXd shift_;  ///< empty for 0
};

}  // namespace trimquad

#include "trimquad/seamless/map_energy.inl"
