// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace popcut::daemon::http {

/// A file of the page, as it is in the program.
struct PageFile {
  std::string_view name;        ///< "main-AB12.js", for /page/main-AB12.js; empty: it is /
  std::string_view media_type;  ///< "text/javascript; charset=utf-8"
  std::string_view hash;        ///< 16 hexadecimal digits of the SHA-256 of the file itself
  std::string_view bytes;
  bool is_gzip{false};  ///< `bytes` are a gzip of the file
};

/// All files of the page; the first is /. CMake makes them (daemon/web/page_files.cmake).
[[nodiscard]] std::span<const PageFile> page_files();

/// The SHA-256 of the sources that the page was built from, 64 hexadecimal digits; empty: the
/// program has only a plain page.
[[nodiscard]] std::string_view page_stamp();

}  // namespace popcut::daemon::http
