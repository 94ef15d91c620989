// SPDX-License-Identifier: MIT
#include "daemon/files/held_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr mode_t kOwn = 0600;

/// With O_NOFOLLOW nothing else is needed to stay in a folder (as RESOLVE_BENEATH of openat2).
bool has_one_part(const std::string& name) {
  if (!name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos)
    return true;
  errno = EINVAL;
  return false;
}

}  // namespace

HeldFolder::HeldFolder(int folder)
    : folder_(new int(folder), [](const int* held) {
        ::close(*held);
        delete held;
      }) {}

Result<HeldFolder> HeldFolder::open(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder >= 0) return HeldFolder(folder);
  const int why = errno;
  auto failed = fail(ErrorKind::Unwritable, path,
                     why == ELOOP || why == ENOTDIR
                         ? "is a link or a file; name a folder"
                         : fmt::format("cannot be opened: {}", std::strerror(why)));
  errno = why;
  return failed;
}

Result<HeldFolder> HeldFolder::around(const std::string& path, std::string& name) {
  const std::filesystem::path whole(path);
  name = whole.filename().string();
  return open(whole.has_parent_path() ? whole.parent_path().string() : ".");
}

HeldFolder HeldFolder::of(int descriptor) {
  return descriptor < 0 ? HeldFolder() : HeldFolder(descriptor);
}

HeldFolder HeldFolder::below(const std::string& name) const {
  if (!has_one_part(name)) return {};
  return of(::openat(descriptor(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

int HeldFolder::create(const std::string& name, unsigned mode) const {
  if (!has_one_part(name)) return -1;
  return ::openat(descriptor(), name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                  mode);
}

int HeldFolder::read(const std::string& name) const {
  if (!has_one_part(name)) return -1;
  const int file =
      ::openat(descriptor(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
  struct stat found {};
  if (file < 0 || (::fstat(file, &found) == 0 && S_ISREG(found.st_mode))) return file;
  ::close(file);
  errno = S_ISDIR(found.st_mode) ? EISDIR : EINVAL;
  return -1;
}

int HeldFolder::create_again(const std::string& name, unsigned mode) const {
  if (!has_one_part(name)) return -1;
  if (::unlinkat(descriptor(), name.c_str(), 0) != 0 && errno != ENOENT) return -1;
  return create(name, mode);
}

int HeldFolder::append(const std::string& name) const {
  if (!has_one_part(name)) return -1;
  const int file =
      ::openat(descriptor(), name.c_str(),
               O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, kOwn);
  struct stat found {};
  if (file < 0) return -1;
  if (::fstat(file, &found) == 0 && S_ISREG(found.st_mode) && found.st_nlink == 1) return file;
  ::close(file);
  errno = EMLINK;
  return -1;
}

int HeldFolder::rename(const std::string& from, const std::string& to) const {
  if (!has_one_part(from) || !has_one_part(to)) return -1;
  return ::renameat(descriptor(), from.c_str(), descriptor(), to.c_str());
}

int HeldFolder::remove(const std::string& name) const {
  return has_one_part(name) ? ::unlinkat(descriptor(), name.c_str(), 0) : -1;
}

int HeldFolder::make_folder(const std::string& name, unsigned mode) const {
  return has_one_part(name) ? ::mkdirat(descriptor(), name.c_str(), mode) : -1;
}

int HeldFolder::move(const std::string& from, const HeldFolder& folder,
                     const std::string& to) const {
  if (!has_one_part(from) || !has_one_part(to)) return -1;
  return ::renameat(descriptor(), from.c_str(), folder.descriptor(), to.c_str());
}

bool HeldFolder::sync() const { return ::fsync(descriptor()) == 0; }

}  // namespace popcut
