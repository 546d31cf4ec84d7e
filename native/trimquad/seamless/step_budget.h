#pragma once

namespace trimquad {

/// The work that Newton steps on maps of one region may still do before the search for a map is given up:
/// the rungs of the ladder share it. Counted in operations, not in seconds, so that the outcome does not
/// depend on the machine.
class StepBudget {
 public:
  /// \param share  of what is spent at most on a map for which there is no other way
  explicit StepBudget(double share = 1) : left_(share * kWork) {}
  /// \param work  multiply-adds
  static StepBudget ofWork(double work) { return StepBudget(work / kWork); }

  bool spent() const { return left_ <= 0; }
  void spend(double work) { left_ -= work; }

  /// Puts a share of what is left aside while some attempts run. Returns what is put aside.
  double setAside(double share) {
    const double aside = share * (left_ > 0 ? left_ : 0);
    left_ -= aside;
    return aside;
  }
  /// The same with all but so much of what is left.
  double setAsideAllBut(double work) { return left_ > work ? setAside(1 - work / left_) : 0; }
  void add(double work) { left_ += work; }

 private:
  static constexpr double kWork = 4e11;  // multiply-adds, about a minute
  double left_;
};

}  // namespace trimquad
