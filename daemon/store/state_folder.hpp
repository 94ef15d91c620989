// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/result.hpp"

namespace popcut::daemon {

/// The folder where popcutd keeps everything: the database and the files it speaks of.
///
/// One process at a time: STATE/lock is held by flock as long as this lives. Files and folders are
/// written beside their place, synced and renamed, so that what has its name is whole. Names are
/// made by us (digests and ids), never by a client.
class StateFolder {
 public:
  /// Makes the folder (0700) with designs, assets, plans, searches, previews, incoming, backups,
  /// intents and witnesses, takes the lock, and clears what an earlier process left unfinished.
  ///
  /// @retval Refused     another process holds it
  /// @retval Unwritable  it cannot be made or written
  [[nodiscard]] static Result<std::unique_ptr<StateFolder>> open(const std::string& path);
  ~StateFolder();
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Path of something inside: "plans/01J...".
  [[nodiscard]] std::string at(std::string_view inside) const;

  /// Whether the folder is still where it was opened; false if it was renamed or replaced.
  [[nodiscard]] bool is_in_place() const;
  /// Bytes that an unprivileged process can still write there.
  [[nodiscard]] std::uint64_t free_bytes() const;
  /// Reserves `bytes` of the disk for later; false if there is no space.
  bool take_reserve(std::uint64_t bytes);
  /// Gives the reserve back to the disk. True if there was one.
  bool free_reserve();
  [[nodiscard]] bool has_reserve() const { return reserved_; }
  /// Whether 'popcut fleet import' has moved the jobs of this folder: the copy that it leaves is in
  /// `backups`.
  [[nodiscard]] bool has_moved_to_fleet() const;

 private:
  StateFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_{-1};
  bool reserved_{false};
};

/// Syncs the file `from` and moves it to `to`, which may be there already with the same content.
///
/// @retval Unwritable  the disk is full or failing
[[nodiscard]] Result<void> keep_file(const std::string& from, const std::string& to);
/// Copies a file to a new one; the error is EEXIST if `to` is there, be it a link.
[[nodiscard]] std::error_code copy_new(const std::string& from, const std::string& to);
/// Writes `bytes` to `path` through a temporary file beside it.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view bytes);
/// Writes a folder of files by way of one beside it: all of them are there, or none. A folder of
/// that name is replaced. Names must be plain.
[[nodiscard]] Result<void> write_folder(
    const std::string& path, const std::vector<std::pair<std::string, std::string_view>>& files);
/// The whole file.
///
/// @retval Malformed  it is not there, or larger than `limit`
[[nodiscard]] Result<std::string> read_whole(const std::string& path, std::uint64_t limit);
/// Removes a file or folder, if it is there.
void remove_tree(const std::string& path);
/// Makes the names in a folder durable.
[[nodiscard]] Result<void> sync_folder(const std::string& path);
/// Letters, digits, dot, dash and underscore, at most 100, not starting with a dot.
[[nodiscard]] bool is_plain_name(std::string_view name);

}  // namespace popcut::daemon
