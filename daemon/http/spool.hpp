// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "daemon/digest/digest.hpp"
#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon::http {

/// A body on its way to the disk: a new file in the folder for uploads, with its SHA-256.
/// The file is removed if the upload ends early.
class Spool {
 public:
  /// @param name of the file in `folder`; chosen by popcutd, never by a client
  /// @retval DiskFull, Unavailable
  [[nodiscard]] static Answer<Spool> create(const std::string& folder, const std::string& name);
  ~Spool();
  Spool(Spool&& other) noexcept;
  Spool& operator=(Spool&&) = delete;

  [[nodiscard]] std::optional<Problem> add(std::string_view bytes);
  /// The bytes are on the disk (fdatasync). The file stays until `remove`, or until the spool goes.
  [[nodiscard]] Answer<Upload> finish();
  /// Removes the file, unless its receiver has moved it away.
  void remove();

 private:
  Spool(int file, std::string path);
  int file_{-1};
  std::string path_;
  Sha256 hash_;
  std::uint64_t bytes_{0};
};

/// Removes leftovers of an earlier run from `folder`: only files with the extension of spools.
void clear_spools(const std::string& folder);

}  // namespace popcut::daemon::http
