#pragma once

#include <atomic>

namespace trimquad {

/// Progress of one conversion, shared between the thread that works and the one that watches.
/// The working thread calls `report` and `check`; any thread may call `cancel` and read `fraction`.
class Progress {
 public:
  /// Stop at the next `check`.
  void cancel() { cancelled_ = true; }
  bool cancelled() const { return cancelled_; }

  /// Part of the running stage that is done, in [0, 1].
  double fraction() const { return fraction_; }
  void report(double fraction) const {
    fraction_ = fraction;
    check();
  }

  /// What was done so far, in steps of any kind, that does not depend on the machine's speed.
  long work() const { return work_; }
  void addWork(long steps) const { work_ += steps; }

  /// Throws Error(Cancelled) once `cancel` was called. Call it in every loop that can last over 0.1 s.
  void check() const;

 private:
  std::atomic<bool> cancelled_{false};
  mutable std::atomic<double> fraction_{0};
  mutable std::atomic<long> work_{0};
};

}  // namespace trimquad
