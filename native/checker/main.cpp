// Checks shapes for a Checker, which can end this process where a check does not end.
#include <cstdlib>

#include "trimquad/brep/checker.h"

int main() {
  trimquad::serveChecks();
  std::_Exit(EXIT_SUCCESS);
}
