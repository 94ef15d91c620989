// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut {

/// One pair of lines of a DXF file: what kind of value it is, and the value without outer spaces.
struct DxfGroup {
  int code{};
  std::string_view value;
  std::size_t line{};  ///< of the value, from 1

  [[nodiscard]] bool is(int its_code, std::string_view its_value) const {
    return code == its_code && value == its_value;
  }
};

/// "line N".
[[nodiscard]] std::string dxf_line(std::size_t line);

/// The beginning of `text` for an error message: printable, at most 40 characters.
[[nodiscard]] std::string dxf_shown(std::string_view text);

/// Walks over the groups of an ASCII DXF text, comments (999) left out. Lines end in LF or CR LF,
/// or in CR where there is no LF at all. Takes no memory; `text` must outlive it.
class DxfCursor {
 public:
  explicit DxfCursor(std::string_view text);

  /// Goes to the next group; false at the end of the text or at a fault, which `error` then has.
  bool next();
  [[nodiscard]] const DxfGroup& group() const { return group_; }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  /// The value of the present group as a number; false, and a fault, if it is none.
  bool real(double& value);
  bool integer(int& value);
  /// Sets a fault at a line, unless there is one; always false.
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

}  // namespace popcut
