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
  void spend(double work) {
    left_ -= work;
    used_ += work;
  }
  /// All that was spent, in Progress' steps: a million take about half a second, for the most work is not on
  /// systems so large that they are solved at full speed.
  long steps() const { return long(used_ / (kWork / 200e6)); }

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
  double left_, used_ = 0;
};

}  // namespace trimquad
