// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "core/result.hpp"
#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// The kinds of problem of the HTTP interface; each has one status and one type URI.
enum class ProblemKind : std::uint8_t {
  Validation,             ///< 422
  MalformedJson,          ///< 400, with the byte offset
  BadRequest,             ///< 400: what no front door should let in
  UnsupportedMedia,       ///< 415
  TooLarge,               ///< 413
  WrongHost,              ///< 421
  Unauthenticated,        ///< 401
  Forbidden,              ///< 403
  NotFound,               ///< 404
  MethodNotAllowed,       ///< 405
  StateConflict,          ///< 409, with the state and the allowed actions
  DeviceAbsent,           ///< 409
  Stale,                  ///< 412, with the current revision
  PreconditionRequired,   ///< 428
  IdempotencyKeyMissing,  ///< 400
  IdempotencyKeyReused,   ///< 422
  IdempotencyInProgress,  ///< 409
  Superseded,             ///< 409: a newer request took its place
  Rate,                   ///< 429, with Retry-After
  QueueFull,              ///< 503
  Unavailable,            ///< 503
  DiskFull,               ///< 507
  Internal,               ///< 500
};

/// One thing that is wrong with a request.
struct RequestFault {
  std::string pointer;  ///< JSON pointer into the body, "?name" of a query, or "line:column"
  std::string code;     ///< "range", "unknown_member", "type", "missing", ...
  std::string detail;   ///< "is 0; must be a whole number from 1 to 1000"
  std::string got{};    ///< the value found there, as JSON, if it is short; empty: not reported
};

/// Why a request was not done.
struct Problem {
  ProblemKind kind{};
  std::string detail;
  std::vector<RequestFault> errors{};
  std::optional<std::int64_t> rev{};           ///< current revision (Stale)
  std::string state{};                         ///< current state (StateConflict, Stale)
  std::vector<std::string> allowed_actions{};  ///< allowed now (StateConflict, Stale)
  std::optional<int> retry_after_s{};
  std::vector<NextAction> next_actions{};  ///< complete requests that would pass now
  std::string asks{};                      ///< JSON of `planning::drawing_question`, if it must be
                                           ///< answered first; else empty
  std::vector<Warning> warnings{};         ///< of the job, where they are the reason; else none
};

template <typename T>
using Answer = tl::expected<T, Problem>;

/// Shorthand for returning a problem from a function that yields an `Answer`.
///
/// @param retry_after_s  after which time the same request may pass
[[nodiscard]] inline tl::unexpected<Problem> refuse(ProblemKind kind, std::string detail,
                                                    std::optional<int> retry_after_s = {}) {
  Problem problem{kind, std::move(detail)};
  problem.retry_after_s = retry_after_s;
  return tl::unexpected<Problem>(std::move(problem));
}

/// One invalid value: 422 with its pointer, code and what would be right.
/// `detail` is "POINTER is not valid" if it is empty.
[[nodiscard]] Problem invalid_value(const std::string& pointer, std::string code,
                                    std::string advice, std::string detail = {});
[[nodiscard]] inline tl::unexpected<Problem> refuse_value(const std::string& pointer,
                                                          std::string code, std::string advice,
                                                          std::string detail = {}) {
  return tl::unexpected(
      invalid_value(pointer, std::move(code), std::move(advice), std::move(detail)));
}

/// "validation", "state-conflict", ...: the last part of the type's URI.
[[nodiscard]] std::string_view slug_of(ProblemKind kind);
/// "Request is not valid", ...
[[nodiscard]] std::string_view title_of(ProblemKind kind);
/// The HTTP status of `kind`.
[[nodiscard]] int status_of(ProblemKind kind);
/// An error of the pipeline as a problem: Malformed, OutOfRange and Infeasible are validation.
[[nodiscard]] Problem problem_from(const Error& error);

}  // namespace popcut::daemon
