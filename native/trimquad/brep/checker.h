#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/brep/assemble.h"

namespace trimquad {

/// Checks shapes in processes of their own: some of OpenCASCADE's intersections do not end, and some crash.
/// May be used by several threads at once; every one of them has its process, which is kept for the next
/// check.
class Checker {
 public:
  /// \param program the file of the program `trimquad_checker`
  explicit Checker(std::string program);
  ~Checker();
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;

  /// What faults() finds. None where that takes more than `seconds` of processor time, or crashes. Throws
  /// Error(Input, "setup") where the program cannot be run, Error(Cancelled).
  std::optional<std::vector<std::string>> faults(const Shape& shape, FaultKinds kinds, int seconds,
                                                 const Progress& progress) const;

 private:
  class Process;
  class Processes;

  std::unique_ptr<Processes> processes_;
};

/// The other side: answers the checks that arrive at this process's standard input, until it is closed.
void serveChecks();

}  // namespace trimquad
