#pragma once

#include <functional>
#include <optional>

#include "trimquad/base/error.h"

namespace trimquad {

/// The error that `action` throws.
std::optional<Error> errorOf(const std::function<void()>& action);

}  // namespace trimquad
