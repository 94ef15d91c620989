// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace popcut {

/// What went wrong, seen by the person who can mend it. Each kind has one exit code (`exit_code`).
enum class ErrorKind {
  Internal,     ///< a fault in popcut itself
  Usage,        ///< the command line is wrong
  Malformed,    ///< an input cannot be read as what it claims to be
  OutOfRange,   ///< an input is readable, but a value in it is not valid
  Infeasible,   ///< the input is fine, but no valid pattern or layout exists for it
  DeviceGone,   ///< the device is absent or went away
  Timeout,      ///< the device did not answer in time
  Refused,      ///< the device, the daemon or a person said no
  CheckFailed,  ///< a check did not hold (verify, simulate --expect)
  Unwritable,   ///< the output could not be written
};

/// What happened, where the kind alone does not say it. Programs go by this, never by the words of
/// `Error::detail`, in which a machine's own answer may stand.
enum class ErrorReason {
  None,
  Stalled,    ///< the device halted the line
  Overflow,   ///< the device sent more than was asked for
  NoMedia,    ///< there is no sheet in it, or none any more
  NoMarks,    ///< the registration marks were not found
  PanelStop,  ///< somebody stopped it at its panel
  TooMuch,    ///< an input is larger than a limit that can be raised
  NotThere,   ///< popcutd has nothing of that name
  Misplaced,  ///< a surface has no part where it can pop up
  Unclear,    ///< a drawing does not say which of its lines are folds
};

/// One clear error: `place: what is wrong; what would be right`.
struct Error {
  ErrorKind kind{};
  std::string place;   ///< JSON pointer, line and column, or path index; may be empty
  std::string detail;  ///< one sentence, values with units; then "; " and what would be right
  ErrorReason reason{ErrorReason::None};
};

template <typename T>
using Result = tl::expected<T, Error>;

/// Shorthand for returning an error from a function that yields a `Result`.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorKind kind, std::string place,
                                                std::string detail,
                                                ErrorReason reason = ErrorReason::None) {
  return tl::unexpected<Error>(Error{kind, std::move(place), std::move(detail), reason});
}

/// The error of an input that is over a limit of its reader, with what helps always. Who knows a
/// way to raise the limits adds it (`ErrorReason::TooMuch`).
///
/// @param what  "the drawing has more than 5 points"
[[nodiscard]] inline Error too_much(std::string what) {
  return {ErrorKind::OutOfRange, "", std::move(what) + "; simplify the drawing",
          ErrorReason::TooMuch};
}

/// The process exit code of `kind` as the manual lists them: 1..7.
[[nodiscard]] int exit_code(ErrorKind kind);

/// `place: detail`, or only `detail` where no place is known.
[[nodiscard]] std::string message(const Error& error);

/// The same error, found inside `outer` (a file, usually): places are joined as `outer: place`.
[[nodiscard]] Error within(const std::string& outer, Error error);

}  // namespace popcut
