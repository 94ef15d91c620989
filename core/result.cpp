// SPDX-License-Identifier: MIT
#include "core/result.hpp"

namespace popcut {

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::Internal:
      return 1;
    case ErrorKind::Usage:
      return 2;
    case ErrorKind::Malformed:
    case ErrorKind::OutOfRange:
      return 3;
    case ErrorKind::Infeasible:
      return 4;
    case ErrorKind::DeviceGone:
    case ErrorKind::Timeout:
    case ErrorKind::Refused:
      return 5;
    case ErrorKind::CheckFailed:
      return 6;
    case ErrorKind::Unwritable:
      return 7;
  }
  return 1;
}

std::string message(const Error& error) {
  return error.place.empty() ? error.detail : error.place + ": " + error.detail;
}

Error within(const std::string& outer, Error error) {
  error.place = error.place.empty() ? outer : outer + ": " + error.place;
  return error;
}

}  // namespace popcut
