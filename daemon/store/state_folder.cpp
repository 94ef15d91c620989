// SPDX-License-Identifier: MIT
#include "daemon/store/state_folder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "daemon/files/held_folder.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool good() const { return fd_ >= 0; }
  /// Some file systems tell only here that a write failed.
  bool shut() { return close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

tl::unexpected<Error> system_error(const std::string& path, const char* doing) {
  const char* const advice =
      errno == ENOSPC || errno == EDQUOT ? "; the disk is full; free some space" : "";
  return fail(ErrorKind::Unwritable, path,
              fmt::format("{}: {}{}", doing, std::strerror(errno), advice));
}

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = write(fd, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

// Folders are held while something is written in them: a link that takes a folder's place meanwhile
// leads nowhere else.

Result<void> write_synced(const std::string& path, std::string_view bytes) {
  std::string name;
  const auto folder = HeldFolder::around(path, name);
  if (!folder) return tl::unexpected(folder.error());
  Descriptor file(folder->create_again(name));
  if (!file.good()) return system_error(path, "cannot be created");
  if (!write_all(file.get(), bytes)) return system_error(path, "cannot be written");
  if (fsync(file.get()) != 0) return system_error(path, "cannot be synced");
  if (!file.shut()) return system_error(path, "cannot be closed");
  return {};
}

Result<void> rename_synced(const std::string& from, const std::string& to) {
  std::string old_name, name;
  const auto source = HeldFolder::around(from, old_name);
  if (!source) return tl::unexpected(source.error());
  const auto folder = HeldFolder::around(to, name);
  if (!folder) return tl::unexpected(folder.error());
  if (renameat(source->descriptor(), old_name.c_str(), folder->descriptor(), name.c_str()) != 0)
    return system_error(to, "cannot be renamed");
  if (!folder->sync()) return system_error(to, "cannot be synced");
  return {};
}

void clear_unfinished(const std::string& path) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(path + "/incoming", ignored))
    remove_tree(entry.path().string());
  for (const char* inside :
       {"plans", "searches", "previews", "designs", "assets", "backups", "intents", "witnesses"})
    for (const auto& entry : fs::directory_iterator(path + "/" + inside, ignored))
      if (entry.path().filename().string().starts_with(".new-")) remove_tree(entry.path().string());
}

std::string beside(const std::string& path) {
  const fs::path place(path);
  return (place.parent_path() / (".new-" + place.filename().string())).string();
}

/// Who holds the lock, as `sign_lock` wrote it.
std::string text_of_lock(int lock) {
  std::array<char, 16> room{};
  const ssize_t got = pread(lock, room.data(), room.size(), 0);
  std::string text(room.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  text = text.substr(0, text.find_first_not_of("0123456789"));
  return text;
}

/// For whom comes next; that it may fail (a full disk) matters to nobody.
void sign_lock(int lock) {
  const std::string text = std::to_string(getpid()) + "\n";
  if (ftruncate(lock, 0) != 0 || pwrite(lock, text.data(), text.size(), 0) < 0) return;
}

/// Takes the lock. A popcutd that was killed a moment ago may leave a child that was about to
/// become a worker: it has the lock, too, until it comes to run and ends. It is given a second.
bool take_lock(int file) {
  constexpr int kTries = 50;
  constexpr useconds_t kPause = 20'000;
  for (int k = 0; k < kTries; ++k) {
    if (flock(file, LOCK_EX | LOCK_NB) == 0) return true;
    if (errno != EWOULDBLOCK && errno != EINTR) return false;
    usleep(kPause);
  }
  return flock(file, LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

Result<std::unique_ptr<StateFolder>> StateFolder::open(const std::string& given) {
  std::error_code error;
  // The folder itself may be reached by a link, as systemd makes one for DynamicUser; from here on
  // it is the folder to which that leads now.
  std::string path = given;
  if (fs::is_symlink(given, error))
    if (const fs::path real = fs::canonical(given, error); !error) path = real.string();
  if (!fs::exists(path, error)) {
    fs::create_directories(fs::path(path).parent_path(), error);
    if (mkdir(path.c_str(), 0700) != 0 && errno != EEXIST)
      return system_error(path, "cannot be created");
  }
  for (const char* inside : {"designs", "assets", "plans", "searches", "previews", "incoming",
                             "backups", "intents", "witnesses"}) {
    const std::string folder = path + "/" + inside;
    if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
      return system_error(folder, "cannot be created");
    // What is unfinished in them is removed, which must never happen elsewhere.
    struct stat found {};
    if (lstat(folder.c_str(), &found) != 0 || !S_ISDIR(found.st_mode))
      return fail(ErrorKind::Unwritable, folder,
                  "is a link or a file; make it a folder (you can mount another disk there)");
  }
  const std::string lock_path = path + "/lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0) return system_error(lock_path, "cannot be created");
  if (!take_lock(lock)) {
    const bool held = errno == EWOULDBLOCK;
    const std::string holder = text_of_lock(lock);
    close(lock);
    if (!held) return system_error(lock_path, "cannot be locked");
    return fail(ErrorKind::Refused, path,
                fmt::format("another popcutd{} uses this folder; stop it first, or name another "
                            "folder with --state",
                            holder.empty() ? "" : " (process " + holder + ")"));
  }
  sign_lock(lock);
  clear_unfinished(path);
  std::unique_ptr<StateFolder> folder(new StateFolder(path, lock));
  folder->reserved_ = fs::exists(folder->at("reserve"), error);
  return folder;
}

StateFolder::~StateFolder() {
  if (lock_ >= 0) close(lock_);
}

bool StateFolder::has_moved_to_fleet() const {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(at("backups"), error))
    if (entry.path().filename().string().starts_with("moved-to-fleet-")) return true;
  return false;
}

std::string StateFolder::at(std::string_view inside) const {
  return fmt::format("{}/{}", path_, inside);
}

bool StateFolder::is_in_place() const {
  struct stat held {};
  struct stat found {};
  return fstat(lock_, &held) == 0 && stat(at("lock").c_str(), &found) == 0 &&
         held.st_dev == found.st_dev && held.st_ino == found.st_ino;
}

std::uint64_t StateFolder::free_bytes() const {
  struct statvfs disk {};
  if (fstatvfs(lock_, &disk) != 0) return 0;
  return std::uint64_t{disk.f_bavail} * disk.f_frsize;
}

bool StateFolder::take_reserve(std::uint64_t bytes) {
  if (reserved_) return true;
  const char* const fresh = ".new-reserve";
  std::string name;
  const auto folder = HeldFolder::around(at("reserve"), name);
  if (!folder) return false;
  Descriptor file(folder->create_again(fresh));
  if (!file.good()) return false;
  const bool taken = posix_fallocate(file.get(), 0, static_cast<off_t>(bytes)) == 0 &&
                     file.shut() && folder->rename(fresh, name) == 0;
  if (!taken) (void)folder->remove(fresh);
  reserved_ = taken;
  return taken;
}

bool StateFolder::free_reserve() {
  if (!reserved_) return false;
  reserved_ = false;
  return unlink(at("reserve").c_str()) == 0;
}

Result<void> keep_file(const std::string& from, const std::string& to) {
  Descriptor file(open(from.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file.good()) return system_error(from, "cannot be opened");
  if (fsync(file.get()) != 0) return system_error(from, "cannot be synced");
  return rename_synced(from, to);
}

std::error_code copy_new(const std::string& from, const std::string& to) {
  const auto last = [] { return std::error_code(errno, std::generic_category()); };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> source(std::fopen(from.c_str(), "rbe"),
                                                               &std::fclose);
  if (!source) return last();
  std::string name;
  const auto folder = HeldFolder::around(to, name);
  if (!folder) return std::make_error_code(std::errc::not_a_directory);
  Descriptor file(folder->create(name));
  if (!file.good()) return last();
  std::string block(1u << 18, '\0');
  while (const std::size_t got = std::fread(block.data(), 1, block.size(), source.get()))
    if (!write_all(file.get(), std::string_view(block).substr(0, got))) return last();
  if (std::ferror(source.get()) != 0) return std::make_error_code(std::errc::io_error);
  return file.shut() ? std::error_code() : last();
}

Result<void> write_file(const std::string& path, std::string_view bytes) {
  const std::string fresh = beside(path);
  Result<void> done = write_synced(fresh, bytes);
  if (done) done = rename_synced(fresh, path);
  if (!done) unlink(fresh.c_str());
  return done;
}

Result<void> write_folder(const std::string& path,
                          const std::vector<std::pair<std::string, std::string_view>>& files) {
  const std::string fresh = beside(path);
  remove_tree(fresh);
  std::string name_of_fresh;
  const auto around = HeldFolder::around(fresh, name_of_fresh);
  if (!around) return tl::unexpected(around.error());
  if (around->make_folder(name_of_fresh) != 0) return system_error(fresh, "cannot be created");
  Result<void> done{};
  for (const auto& [name, bytes] : files) {
    if (!is_plain_name(name))
      done = fail(ErrorKind::Internal, name,
                  "is not a plain file name; use letters, digits, . - _ only");
    else
      done = write_synced(fresh + "/" + name, bytes);
    if (!done) break;
  }
  if (done) done = sync_folder(fresh);
  if (done) {
    remove_tree(path);
    done = rename_synced(fresh, path);
  }
  if (!done) remove_tree(fresh);
  return done;
}

Result<std::string> read_whole(const std::string& path, std::uint64_t limit) {
  Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  struct stat about {};
  if (!file.good() || fstat(file.get(), &about) != 0 || !S_ISREG(about.st_mode))
    return fail(ErrorKind::Malformed, path, "cannot be opened; it must be a readable file");
  if (static_cast<std::uint64_t>(about.st_size) > limit)
    return fail(ErrorKind::Malformed, path,
                fmt::format("is {} bytes long; the maximum is {}", about.st_size, limit));
  std::string bytes(static_cast<std::size_t>(about.st_size), '\0');
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t got = read(file.get(), bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return fail(ErrorKind::Malformed, path, "cannot be read completely");
    have += static_cast<std::size_t>(got);
  }
  return bytes;
}

void remove_tree(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

Result<void> sync_folder(const std::string& path) {
  const Descriptor folder(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!folder.good()) return system_error(path, "cannot be opened");
  if (fsync(folder.get()) != 0) return system_error(path, "cannot be synced");
  return {};
}

bool is_plain_name(std::string_view name) {
  return !name.empty() && name.size() <= 100 && name[0] != '.' &&
         name.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") ==
             std::string_view::npos;
}

}  // namespace popcut::daemon
