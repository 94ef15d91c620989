// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "core/result.hpp"
#include "device/port/transport.hpp"

namespace popcut {

/// A plain file instead of a cutter: it takes the program as it would be streamed, and answers
/// nothing. Its clock is virtual, so that pacing costs no time.
///
/// Nothing that arrives here is ever cut: all of it stays `in_transit`.
class FileTransport final : public Transport {
 public:
  /// The bytes go into a file beside `path` that takes its name with `finish`.
  ///
  /// @retval Unwritable  it cannot be written there
  /// @retval Refused     `path` is there and is no plain file: a device has a transport of its own
  [[nodiscard]] static Result<std::unique_ptr<FileTransport>> create(const std::string& path);
  FileTransport(const FileTransport&) = delete;
  FileTransport& operator=(const FileTransport&) = delete;
  /// Without `finish` nothing is left behind.
  ~FileTransport() override;

  /// All is there: the file takes its name.
  ///
  /// @retval Unwritable  the disk said no
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
