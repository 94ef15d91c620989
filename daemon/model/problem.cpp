// SPDX-License-Identifier: MIT
#include "daemon/model/problem.hpp"

#include <array>
#include <cstddef>

namespace popcut::daemon {
namespace {

struct Row {
  std::string_view slug;
  std::string_view title;
  int status{};
};

// In the order of the enumeration.
constexpr std::array<Row, 23> kRows{{
    {"validation", "Request is not valid", 422},
    {"malformed-json", "Body is not JSON", 400},
    {"bad-request", "Request is not valid HTTP", 400},
    {"unsupported-media", "Unsupported media type", 415},
    {"too-large", "Request is too large", 413},
    {"wrong-host", "Host is not served here", 421},
    {"unauthenticated", "Authentication required", 401},
    {"forbidden", "Not permitted for this role", 403},
    {"not-found", "Not found", 404},
    {"method-not-allowed", "Method not allowed", 405},
    {"state-conflict", "Not possible in this state", 409},
    {"device-absent", "Device not available", 409},
    {"stale", "Changed in the meantime", 412},
    {"precondition-required", "If-Match required", 428},
    {"idempotency-key-missing", "Idempotency-Key required", 400},
    {"idempotency-key-reused", "Idempotency-Key was used for another request", 422},
    {"idempotency-in-progress", "The same request is still running", 409},
    {"superseded", "A newer request took its place", 409},
    {"rate", "Too many requests", 429},
    {"queue-full", "Queue is full", 503},
    {"unavailable", "Not available", 503},
    {"disk-full", "Disk is full", 507},
    {"internal", "Internal error in popcutd", 500},
}};

const Row& row_of(ProblemKind kind) { return kRows.at(static_cast<std::size_t>(kind)); }

ProblemKind kind_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::Malformed:
    case ErrorKind::OutOfRange:
    case ErrorKind::Infeasible:
    case ErrorKind::Usage:
    case ErrorKind::CheckFailed:
      return ProblemKind::Validation;
    case ErrorKind::DeviceGone:
      return ProblemKind::DeviceAbsent;
    case ErrorKind::Refused:
      return ProblemKind::StateConflict;
    case ErrorKind::Timeout:
      return ProblemKind::Unavailable;
    case ErrorKind::Unwritable:
      return ProblemKind::DiskFull;
    case ErrorKind::Internal:
      break;
  }
  return ProblemKind::Internal;
}

}  // namespace

std::string_view slug_of(ProblemKind kind) { return row_of(kind).slug; }
std::string_view title_of(ProblemKind kind) { return row_of(kind).title; }
int status_of(ProblemKind kind) { return row_of(kind).status; }

Problem invalid_value(const std::string& pointer, std::string code, std::string advice,
                      std::string detail) {
  if (detail.empty()) detail = pointer + " is not valid";
  return {
      ProblemKind::Validation, std::move(detail), {{pointer, std::move(code), std::move(advice)}}};
}

Problem problem_from(const Error& error) {
  Problem problem{kind_of(error.kind), message(error)};
  if (problem.kind != ProblemKind::Validation) return problem;
  const bool is_late = error.kind == ErrorKind::Infeasible && error.reason == ErrorReason::TooMuch;
  problem.errors.push_back({error.place,
                            is_late                               ? "too-long"
                            : error.kind == ErrorKind::OutOfRange ? "range"
                                                                  : "content",
                            error.detail});
  return problem;
}

}  // namespace popcut::daemon
