#pragma once

#include <set>
#include <string>
#include <vector>

#include "trimquad/base/error.h"
#include "trimquad/base/parallel.h"

namespace trimquad {

/// What went wrong in several regions of a model, by the first error of each. As an Error it is the first of
/// them.
class RegionErrors : public Error {
 public:
  /// \pre there is one
  explicit RegionErrors(const std::vector<Error>& all)
      : Error(all.front()), others_(all.begin() + 1, all.end()) {}
  const std::vector<Error>& others() const { return others_; }

 private:
  std::vector<Error> others_;
};

/// Gathers the stage errors of regions, so that one of them does not hide those of others.
class RegionErrorList {
 public:
  /// Does `step`; keeps the stage error that it ends with. Other errors go on.
  template <class Step>
  void attempt(const Step& step) {
    try {
      step();
    } catch (const Error& error) {
      if (error.kind() != Error::Kind::Stage) throw;
      add(error);
    }
  }
  /// The same for numbers below `count`, on up to `threads` threads.
  template <class Step>
  void attemptEach(int count, int threads, const Step& step) {
    std::vector<RegionErrorList> own(count);
    parallelEach(count, threads, [&](int number) { own[number].attempt([&] { step(number); }); });
    for (const auto& list : own)
      for (const auto& error : list.errors_) add(error);
  }
  /// `where` of an error is the region's name, which a comma and an edge of it may follow.
  void add(const Error& error) {
    if (regions_.insert(error.where().substr(0, error.where().find(','))).second) errors_.push_back(error);
  }
  bool empty() const { return errors_.empty(); }
  /// Throws RegionErrors where there are any.
  void raise() const {
    if (!errors_.empty()) throw RegionErrors(errors_);
  }

 private:
  std::set<std::string> regions_;
  std::vector<Error> errors_;
};

}  // namespace trimquad
