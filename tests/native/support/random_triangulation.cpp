#include "support/random_triangulation.h"

#include <algorithm>

namespace trimquad::samples {}  // namespace trimquad::samples
