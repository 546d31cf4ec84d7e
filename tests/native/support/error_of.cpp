#include "support/error_of.h"

namespace trimquad {

std::optional<Error> errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  return {};
}

}  // namespace trimquad
