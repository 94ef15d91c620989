// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut {

/// One pair of lines of a DXF file: the kind of value, and the value without outer spaces.
struct DxfGroup {
  int code{};
  std::string_view value;
  std::size_t line{};  ///< line of the value, from 1

  [[nodiscard]] bool is(int its_code, std::string_view its_value) const {
    return code == its_code && value == its_value;
  }
};

/// "line N".
[[nodiscard]] std::string dxf_line(std::size_t line);

/// The beginning of `text` for an error message: printable, at most 40 characters.
[[nodiscard]] std::string dxf_shown(std::string_view text);

/// Walks over the groups of an ASCII DXF text and skips comments (999). Lines end in LF or CR LF,
/// or in CR if the text has no LF. Allocates nothing; `text` must outlive it.
class DxfCursor {
 public:
  explicit DxfCursor(std::string_view text);

  /// Moves to the next group. Returns false at the end of the text or at a fault, which `error`
  /// then holds.
  bool next();
  [[nodiscard]] const DxfGroup& group() const { return group_; }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  /// The current group's value as a number. Returns false and sets a fault if it is not one.
  bool real(double& value);
  bool integer(int& value);
  /// Sets a fault at a line unless there is one already; always returns false.
  bool refuse(std::size_t line, std::string detail, ErrorKind kind = ErrorKind::Malformed);

 private:
  bool line(std::string_view& out);

  std::string_view text_;
  std::size_t at_{0};
  std::size_t line_{0};
  char newline_{'\n'};
  DxfGroup group_;
  std::optional<Error> error_;
};

/// Whether a transparency (codes 440 and 1071) is an object's own (2 in the highest byte) and
/// leaves nothing to see (0 in the lowest).
[[nodiscard]] constexpr bool is_dxf_transparent(int value) {
  return (value >> 24 & 255) == 2 && (value & 255) == 0;
}

}  // namespace popcut
