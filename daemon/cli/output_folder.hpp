// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut::cli {

/// Reads a whole file.
///
/// @retval Malformed  it is absent, a folder, unreadable, or larger than `limit_bytes`
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::uintmax_t limit_bytes = 1u << 30);

/// The files of one run into one folder: they appear whole or not at all. Each is written aside in
/// the folder and renamed by `commit`, which also removes what the folder's last manifest.json
/// lists and this run no longer writes, and writes the new manifest. Other files stay.
class OutputFolder {
 public:
  /// @retval Unwritable  the folder cannot be made or written
  [[nodiscard]] static Result<OutputFolder> open(const std::filesystem::path& folder);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  OutputFolder(const OutputFolder&) = delete;
  ~OutputFolder();  ///< what was not committed is removed

  /// Adds a file by its name relative to the folder ("report.json", "deploy/psi_001.stl").
  [[nodiscard]] Result<void> add(const std::string& name, const std::string& content);
  /// Adds a file that is streamed.
  [[nodiscard]] Result<void> add(const std::string& name,
                                 const std::function<Result<void>(std::ostream&)>& write);
  /// Makes all added files appear.
  [[nodiscard]] Result<void> commit(const std::string& made_by);

 private:
  explicit OutputFolder(std::filesystem::path folder);
  std::filesystem::path folder_;
  std::vector<std::string> names_;  ///< added, in order
};

}  // namespace popcut::cli
