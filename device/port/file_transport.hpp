// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "core/result.hpp"
#include "device/port/transport.hpp"

namespace popcut {

/// A regular file instead of a cutter: it receives the program as it would be streamed, and answers
/// nothing. Its clock is virtual, so pacing takes no time. Nothing is ever cut: all bytes stay
/// `in_transit`.
class FileTransport final : public Transport {
 public:
  /// Writes to a temporary file next to `path`; `finish` renames it.
  ///
  /// @retval Unwritable  the file cannot be written
  /// @retval Refused     `path` exists and is not a regular file: devices have their own transport
  [[nodiscard]] static Result<std::unique_ptr<FileTransport>> create(const std::string& path);
  FileTransport(const FileTransport&) = delete;
  FileTransport& operator=(const FileTransport&) = delete;
  /// Without `finish`, removes the temporary file.
  ~FileTransport() override;

  /// The program is complete: the file gets its name.
  ///
  /// @retval Unwritable  the disk is full or failed
  [[nodiscard]] Result<void> finish();

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override { return now_; }
  void wait(std::chrono::nanoseconds duration) override;
  [[nodiscard]] bool answers() const override { return false; }
  [[nodiscard]] std::size_t in_transit() const override { return written_; }

 private:
  FileTransport(std::string path, std::string aside, int descriptor)
      : path_(std::move(path)), aside_(std::move(aside)), descriptor_(descriptor) {}

  std::string path_, aside_;
  int descriptor_;
  std::size_t written_{};
  std::chrono::nanoseconds now_{};
};

}  // namespace popcut
