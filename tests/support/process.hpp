// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace popcut::testing {

/// A new folder; its destruction removes it with all its content.
class TempFolder {
 public:
  /// Memory: where that can be had, for tests that sync thousands of files.
  enum class Place { Disk, Memory };
  explicit TempFolder(Place place = Place::Disk);
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  ~TempFolder();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// How a program ended and what it printed.
struct Ran {
  int exit{-1};  ///< exit code, or 128 + the signal that ended it
  std::string out, err;
  double wall_s{}, cpu_s{};
  long peak_kb{};  ///< resident memory; at least the peak of this process
};

/// Limits for a program that is expected to fail.
struct Limits {
  long file_bytes{-1};    ///< largest file it may write; -1: no limit
  long memory_bytes{-1};  ///< address space; -1: no limit
};

/// Runs `arguments[0]` in `folder` with the rest as its arguments, nothing on standard input.
[[nodiscard]] Ran run_program(const std::vector<std::string>& arguments,
                              const std::filesystem::path& folder, const Limits& limits = {});

[[nodiscard]] std::string text_of_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& text);
/// True if `text` contains `words`.
[[nodiscard]] inline bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}
/// Names of all files below `folder`, relative to it, sorted.
[[nodiscard]] std::vector<std::string> files_below(const std::filesystem::path& folder);

}  // namespace popcut::testing
