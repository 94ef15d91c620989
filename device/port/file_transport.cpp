// SPDX-License-Identifier: MIT
#include "device/port/file_transport.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace popcut {
namespace {

Error unwritable(const std::string& path, int code) {
  return {ErrorKind::Unwritable, path,
          fmt::format("cannot be written ({}); give a path that can",
                      std::generic_category().message(code))};
}

}  // namespace

Result<std::unique_ptr<FileTransport>> FileTransport::create(const std::string& path) {
  struct stat there {};
  if (::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode))
    return fail(ErrorKind::Refused, path,
                S_ISDIR(there.st_mode)
                    ? "is a folder; give the name of a file in it"
                    : "is not a regular file; for a device use usb:ID, serial:/dev/ttyUSB0 or "
                      "lp:/dev/usb/lp0, which ask before they move");
  std::string aside = path + ".XXXXXX";
  const int descriptor = ::mkostemp(aside.data(), O_CLOEXEC);
  if (descriptor < 0) return tl::unexpected(unwritable(path, errno));
  return std::unique_ptr<FileTransport>(new FileTransport(path, aside, descriptor));
}

FileTransport::~FileTransport() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(aside_.c_str());
}

Result<void> FileTransport::finish() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const bool kept = ::fchmod(descriptor_, 0666 & ~mask) == 0 && ::fsync(descriptor_) == 0;
  const int code = kept ? 0 : errno;
  const bool closed = ::close(std::exchange(descriptor_, -1)) == 0;
  if (kept && closed && std::rename(aside_.c_str(), path_.c_str()) == 0) return {};
  const int why = code != 0 ? code : errno;
  ::unlink(aside_.c_str());
  return tl::unexpected(unwritable(path_, why));
}

Transport::WriteEnd FileTransport::write(std::span<const std::byte> bytes, Deadline) {
  WriteEnd end;
  while (end.taken < bytes.size()) {
    const ssize_t count = ::write(descriptor_, bytes.data() + end.taken, bytes.size() - end.taken);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      end.error = unwritable(path_, count < 0 ? errno : ENOSPC);
      break;
    }
    end.taken += static_cast<std::size_t>(count);
    written_ += static_cast<std::size_t>(count);
  }
  return end;
}

Result<std::vector<std::byte>> FileTransport::read(Deadline until) {
  now_ = std::max(now_, until);
  return fail(ErrorKind::Timeout, path_, "a file answers nothing");
}

void FileTransport::wait(std::chrono::nanoseconds duration) {
  now_ += std::max(duration, std::chrono::nanoseconds(0));
}

}  // namespace popcut
