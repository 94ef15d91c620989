// SPDX-License-Identifier: MIT
#include "daemon/http/spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace popcut::daemon::http {
namespace {

constexpr std::string_view kEnding = ".upload";
constexpr std::uint64_t kWriteBack = 4u << 20;

Problem disk_problem(int error) {
  if (error == ENOSPC || error == EDQUOT || error == EFBIG)
    return Problem{ProblemKind::DiskFull, "popcutd's disk is full; free some space"};
  if (error == ENOENT)
    return Problem{ProblemKind::Unavailable,
                   "popcutd's state folder was moved; move it back, or restart popcutd with "
                   "--state and its new place"};
  return Problem{ProblemKind::Unavailable, fmt::format("the upload cannot be written ({})",
                                                       std::generic_category().message(error))};
}

}  // namespace

Spool::Spool(int file, std::string path) : file_(file), path_(std::move(path)) {}

Spool::Spool(Spool&& other) noexcept
    : file_(std::exchange(other.file_, -1)),
      path_(std::exchange(other.path_, {})),
      hash_(std::move(other.hash_)),
      bytes_(other.bytes_) {}

Spool::~Spool() { remove(); }

Answer<Spool> Spool::create(const std::string& folder, const std::string& name) {
  std::string path = fmt::format("{}/{}{}", folder, name, kEnding);
  const int held = ::open(folder.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (held < 0) return tl::unexpected<Problem>(disk_problem(errno));
  const int file =
      ::openat(held, fmt::format("{}{}", name, kEnding).c_str(),
               O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR);
  const int error = errno;
  ::close(held);
  if (file < 0) return tl::unexpected<Problem>(disk_problem(error));
  return Spool(file, std::move(path));
}

std::optional<Problem> Spool::add(std::string_view bytes) {
  hash_.add(bytes);
  const std::uint64_t before = bytes_ / kWriteBack;
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return disk_problem(written < 0 ? errno : ENOSPC);
    bytes_ += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
#ifdef __linux__
  // The disk begins at once, so that `finish` has little left to wait for.
  if (bytes_ / kWriteBack != before)
    ::sync_file_range(file_, static_cast<off64_t>(before * kWriteBack), 0, SYNC_FILE_RANGE_WRITE);
#endif
  return std::nullopt;
}

Answer<Upload> Spool::finish() {
  if (::fdatasync(file_) != 0) return tl::unexpected<Problem>(disk_problem(errno));
  ::close(std::exchange(file_, -1));
  return Upload{path_, hash_.hex(), bytes_};
}

void Spool::remove() {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  if (!path_.empty()) ::unlink(path_.c_str());
  path_.clear();
}

void clear_spools(const std::string& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.is_regular_file(none) && !entry.is_symlink(none) &&
        entry.path().native().ends_with(kEnding))
      ::unlink(entry.path().c_str());
}

}  // namespace popcut::daemon::http
