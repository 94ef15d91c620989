// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/files/held_folder.hpp"

namespace popcut::cli {

/// Reads a whole file, or what is written into a pipe.
///
/// @param pipe_wait  how long a pipe with a name waits for its first byte
/// @retval Malformed  it is absent, a folder, unreadable, larger than `limit_bytes`, or a pipe into
///                    which nobody writes
[[nodiscard]] Result<std::string> read_file(
    const std::filesystem::path& path, std::uintmax_t limit_bytes = 1u << 30,
    std::chrono::milliseconds pipe_wait = std::chrono::seconds(10));

/// Reads a file that another one names, such as the picture of a model: a regular file in the same
/// folder or below it, reached through no link.
///
/// @param file  the one that names it
/// @retval Malformed  it lies elsewhere, or is absent, a link, no regular file or unreadable
[[nodiscard]] Result<std::string> read_beside(const std::filesystem::path& file,
                                              const std::string& name);

/// The files of one run into one folder: they appear whole or not at all. Each is written aside in
/// the folder and renamed by `commit`, which also removes what the folder's last manifest.json
/// lists and this run no longer writes, and writes the new manifest. Other files stay.
///
/// The folder is held by a descriptor and no link in it is followed, so that whoever else may write
/// there leads no file elsewhere. A signal that ends the program first removes what is aside.
///
/// The folder is locked while it is open, so that two runs never mix their files. Names in a found
/// manifest are not trusted: only plain files below the folder, reached through no symbolic link,
/// are ever removed.
class OutputFolder {
 public:
  /// Makes the folder where it is absent, locks it, and clears what a killed run left aside.
  ///
  /// @retval Unwritable  the folder cannot be made or written, or another run is writing there
  [[nodiscard]] static Result<OutputFolder> open(const std::filesystem::path& folder);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();  ///< what was not committed is removed

  /// Adds a file by its name relative to the folder ("report.json", "deploy/psi_001.stl").
  ///
  /// @retval Unwritable  it cannot be written (a full disk, say); `place` is the file
  /// @retval Internal    the name leaves the folder, is reserved, or was added before
  [[nodiscard]] Result<void> add(const std::string& name, const std::string& content);
  /// Adds a file that is streamed.
  [[nodiscard]] Result<void> add(const std::string& name,
                                 const std::function<Result<void>(std::ostream&)>& write);
  /// Files added from now on go into `subfolder` ("part-01"), empty for the folder itself.
  void enter(const std::string& subfolder) { inside_ = subfolder; }
  /// Makes all added files appear; `made_by` ("popcut design") goes into the manifest. Call once.
  ///
  /// @retval Unwritable  a file cannot be put in its place; `place` is that file
  [[nodiscard]] Result<void> commit(const std::string& made_by);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  explicit OutputFolder(std::filesystem::path folder);
  [[nodiscard]] Result<void> prepare();
  [[nodiscard]] Result<void> check_places() const;
  [[nodiscard]] Result<void> put(const std::string& name) const;
  using FilesOfCommands = std::map<std::string, std::set<std::string>>;
  [[nodiscard]] Result<void> put_manifest(const std::string& made_by,
                                          const std::vector<std::string>& files,
                                          const FilesOfCommands& others) const;
  void discard() noexcept;

  /// The folder aside in which a file is written, which is made, and the last part of its name.
  [[nodiscard]] HeldFolder aside_for(const std::string& name, std::string& leaf) const;

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< folders that were made, outermost first
  std::vector<std::string> names_;           ///< added, in order
  std::string inside_;                       ///< the subfolder that files are added to
  HeldFolder held_{};                        ///< the folder, open and locked
  HeldFolder aside_{};                       ///< in it
};

/// Writes one file: aside, then renamed, so that it appears whole or not at all. What is there and
/// is no plain file (a pipe, /dev/null) is written to directly.
///
/// @retval Unwritable  it cannot be written; `place` is the file
[[nodiscard]] Result<void> write_whole_file(const std::filesystem::path& path,
                                            const std::function<void(std::ostream&)>& write);

}  // namespace popcut::cli
