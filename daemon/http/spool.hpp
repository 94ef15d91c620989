// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "daemon/digest/digest.hpp"
#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon::http {

/// A body on its way to the disk: a new file in the folder for what comes in, with its SHA-256.
/// Whatever ends it early removes the file.
class Spool {
 public:
  /// @param name of the file in `folder`; made by us, never by a client
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

/// Removes what an earlier run left in `folder`: files with the ending of spools, nothing else.
void clear_spools(const std::string& folder);

}  // namespace popcut::daemon::http
