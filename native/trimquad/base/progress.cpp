#include "trimquad/base/progress.h"

#include "trimquad/base/error.h"

namespace trimquad {

void Progress::check() const {
  if (cancelled_) throw Error(Error::Kind::Cancelled, "cancelled", "cancelled");
}

}  // namespace trimquad
