// SPDX-License-Identifier: MIT
#pragma once

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace popcut::testing {

/// A file system in memory that is soon full, on a folder that is there. Only root can have one.
class SmallDisk {
 public:
  SmallDisk(std::filesystem::path folder, std::uint64_t bytes) : folder_(std::move(folder)) {
    const std::string size = "size=" + std::to_string(bytes) + ",mode=0777";
    if (::mount("popcut-test", folder_.c_str(), "tmpfs", MS_NOSUID | MS_NODEV, size.c_str()) != 0)
      why_not_ = std::string("no small disk can be mounted here: ") + std::strerror(errno);
  }
  ~SmallDisk() {
    if (why_not_.empty()) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  /// Empty: it is there.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }
  [[nodiscard]] std::uint64_t free_bytes() const {
    struct statvfs space {};
    return ::statvfs(folder_.c_str(), &space) == 0 ? space.f_bavail * space.f_frsize : 0;
  }
  /// Writes until nothing more goes in.
  void fill() const {
    const int file = ::open(filler().c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    const std::vector<char> bytes(1 << 16);
    for (std::size_t size = bytes.size(); size > 0;)
      if (::write(file, bytes.data(), size) < 0) size /= 2;
    ::close(file);
  }
  /// Takes back what `fill` wrote.
  void clear() const { std::filesystem::remove(filler()); }

 private:
  [[nodiscard]] std::filesystem::path filler() const { return folder_ / "filler"; }
  std::filesystem::path folder_;
  std::string why_not_;
};

}  // namespace popcut::testing
