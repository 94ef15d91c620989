// SPDX-License-Identifier: MIT
#include "core/result.hpp"

#include <array>

namespace popcut {

int exit_code(ErrorKind kind) {
  constexpr std::array kCodes{1, 2, 3, 3, 4, 5, 5, 5, 6, 7};  // by kind
  return kCodes.at(static_cast<std::size_t>(kind));
}

std::string message(const Error& error) {
  return error.place.empty() ? error.detail : error.place + ": " + error.detail;
}

Error within(const std::string& outer, Error error) {
  error.place = error.place.empty() ? outer : outer + ": " + error.place;
  return error;
}

}  // namespace popcut
