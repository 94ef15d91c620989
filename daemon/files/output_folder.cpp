// SPDX-License-Identifier: MIT
#include "daemon/files/output_folder.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"

namespace popcut::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAside = ".popcut-aside";  // files of the run that is not yet committed
constexpr const char* kManifest = "manifest.json";
constexpr std::uintmax_t kManifestLimitBytes = 16u << 20;

std::string reason(int error_number) { return std::strerror(error_number); }

tl::unexpected<Error> unwritable(const fs::path& path, const std::string& why,
                                 const std::string& right = "give a folder that can be written") {
  return fail(ErrorKind::Unwritable, path.string(), why + "; " + right);
}

/// A name that stays inside the folder and is not one of the folder's own.
bool is_allowed(const std::string& name) {
  const fs::path path(name);
  if (name.empty() || name.find('\0') != std::string::npos || path.is_absolute()) return false;
  if (name == kManifest || *path.begin() == kAside) return false;
  return std::all_of(path.begin(), path.end(), [](const fs::path& part) {
    return !part.empty() && part != "." && part != "..";
  });
}

/// True when the folders between `folder` and its file `name` are real folders, or absent.
bool is_reached_plainly(const fs::path& folder, const std::string& name) {
  fs::path here = folder;
  for (const fs::path& part : fs::path(name).parent_path()) {
    here /= part;
    std::error_code error;
    const auto type = fs::symlink_status(here, error).type();
    if (type == fs::file_type::not_found) return true;
    if (type != fs::file_type::directory) return false;
  }
  return true;
}

/// The valid names among the texts of a JSON list.
std::set<std::string> allowed_names(const nlohmann::json& list) {
  std::set<std::string> names;
  if (!list.is_array()) return names;
  for (const auto& file : list)
    if (file.is_string() && is_allowed(file.get<std::string>())) names.insert(file);
  return names;
}

/// "popcut plan 0.1.0" is made by "plan", whatever the version.
std::string command_of(const std::string& made_by) {
  std::istringstream words(made_by);
  std::string program, command;
  words >> program >> command;
  return command;
}

/// What the folder's manifest lists, by the command that wrote it: a command removes only its own
/// stale files, so that planning beside a design does not take the design away.
std::map<std::string, std::set<std::string>> listed_before(const fs::path& folder) {
  std::map<std::string, std::set<std::string>> names;
  const auto text = read_file(folder / kManifest, kManifestLimitBytes);
  if (!text) return names;
  const auto parsed = parse_json(*text);
  const nlohmann::json manifest = parsed ? *parsed : nlohmann::json();
  if (!manifest.is_object() || manifest.value("popcut", nlohmann::json()) != 1) return names;
  const auto files = manifest.find("files"), others = manifest.find("others");
  const auto made_by = manifest.find("made_by");
  if (files != manifest.end() && made_by != manifest.end() && made_by->is_string())
    names[command_of(*made_by)] = allowed_names(*files);
  if (others != manifest.end() && others->is_object())
    for (const auto& [command, list] : others->items()) names[command].merge(allowed_names(list));
  return names;
}

/// Removes the plain file `folder/name`, and the folders below `folder` that it leaves empty.
void remove_stale(const fs::path& folder, const std::string& name) {
  std::error_code error;
  const fs::path file = folder / name;
  if (!is_reached_plainly(folder, name)) return;
  if (fs::symlink_status(file, error).type() != fs::file_type::regular) return;
  fs::remove(file, error);
  for (fs::path up = fs::path(name).parent_path(); !up.empty(); up = up.parent_path()) {
    if (::rmdir((folder / up).c_str()) != 0) return;
  }
}

}  // namespace

namespace {

/// Whether a file is a pipe with a name: who opens it may never meet anybody who writes. A pipe of
/// the shell, such as <(...), has its writer already.
bool is_named_pipe(int file, const struct stat& status) {
  struct statfs system {};
  return S_ISFIFO(status.st_mode) && ::fstatfs(file, &system) == 0 && system.f_type != PIPEFS_MAGIC;
}

/// Waits until there is something to read, or the last writer has gone.
bool is_written(int file, std::chrono::milliseconds wait) {
  const auto end = std::chrono::steady_clock::now() + wait;
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    pollfd one{file, POLLIN, 0};
    const int ready = ::poll(&one, 1, static_cast<int>(std::max<long>(0, left.count())));
    if (ready >= 0 || errno != EINTR) return ready > 0;
  }
}

}  // namespace

Result<std::string> read_file(const fs::path& path, std::uintmax_t limit_bytes,
                              std::chrono::milliseconds pipe_wait) {
  const auto malformed = [&](const std::string& why) {
    return fail(ErrorKind::Malformed, path.string(), why);
  };
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return malformed("cannot be read: " + reason(errno) + "; give an existing file");
  struct Closer {
    int file;
    ~Closer() { ::close(file); }
  } const closer{file};
  struct stat status {};
  if (::fstat(file, &status) != 0) return malformed("cannot be read: " + reason(errno));
  if (S_ISDIR(status.st_mode)) return malformed("is a folder; give a file");
  if (is_named_pipe(file, status) && !is_written(file, pipe_wait))
    return malformed("is a pipe into which nothing is written; give a file");
  ::fcntl(file, F_SETFL, 0);  // reading waits again
  const auto too_large = [&] {
    return fail(ErrorKind::Malformed, path.string(),
                "is larger than " + std::to_string(limit_bytes) + " bytes; give a smaller file",
                ErrorReason::TooMuch);
  };
  std::string content;
  if (S_ISREG(status.st_mode)) {
    if (static_cast<std::uintmax_t>(status.st_size) > limit_bytes) return too_large();
    content.reserve(static_cast<std::size_t>(status.st_size));
  }
  std::vector<char> block(1u << 16);
  while (true) {
    const ssize_t got = ::read(file, block.data(), block.size());
    if (got == 0) return content;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return malformed("cannot be read: " + reason(errno));
    if (content.size() + static_cast<std::size_t>(got) > limit_bytes) return too_large();
    content.append(block.data(), static_cast<std::size_t>(got));
  }
}

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)),
      made_(std::move(other.made_)),
      names_(std::move(other.names_)),
      inside_(std::move(other.inside_)),
      lock_(std::exchange(other.lock_, -1)) {}

OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept {
  if (this == &other) return *this;
  discard();
  folder_ = std::move(other.folder_);
  made_ = std::move(other.made_);
  names_ = std::move(other.names_);
  inside_ = std::move(other.inside_);
  lock_ = std::exchange(other.lock_, -1);
  return *this;
}

OutputFolder::~OutputFolder() { discard(); }

/// Removes what is aside, gives the lock back, and removes folders that were made and stay empty.
void OutputFolder::discard() noexcept {
  if (lock_ >= 0) {
    std::error_code error;
    fs::remove_all(folder_ / kAside, error);
    ::close(std::exchange(lock_, -1));
  }
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) ::rmdir(made->c_str());
  made_.clear();
}

Result<OutputFolder> OutputFolder::open(const fs::path& folder) {
  OutputFolder opened(folder.empty() ? fs::path(".") : folder);
  if (auto done = opened.prepare(); !done) return tl::unexpected(done.error());
  return opened;
}

Result<void> OutputFolder::prepare() {
  // 1. The folder and those above it.
  for (fs::path up = folder_; !up.empty() && ::access(up.c_str(), F_OK) != 0;) {
    if (up.has_filename()) made_.insert(made_.begin(), up);
    if (up == up.parent_path()) break;
    up = up.parent_path();
  }
  for (const fs::path& missing : made_) {
    if (::mkdir(missing.c_str(), 0777) != 0 && errno != EEXIST)
      return unwritable(missing, "cannot create the folder: " + reason(errno));
  }
  // 2. The lock. A file system without locks is used as it is.
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 && errno == ENOTDIR) return unwritable(folder_, "is not a folder");
  if (lock_ < 0) return unwritable(folder_, "cannot open the folder: " + reason(errno));
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(std::exchange(lock_, -1));
    return unwritable(folder_, "another popcut is writing there",
                      "wait for it or give another folder");
  }
  // 3. A fresh place aside.
  std::error_code error;
  fs::remove_all(folder_ / kAside, error);
  if (::mkdir((folder_ / kAside).c_str(), 0777) != 0)
    return unwritable(folder_, "cannot write in the folder: " + reason(errno));
  return {};
}

Result<void> OutputFolder::add(const std::string& name, const std::string& content) {
  return add(name, [&](std::ostream& out) -> Result<void> {
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    return {};
  });
}

Result<void> OutputFolder::add(const std::string& own_name,
                               const std::function<Result<void>(std::ostream&)>& write) {
  const std::string name = inside_.empty() ? own_name : inside_ + "/" + own_name;
  if (!is_allowed(name) || std::find(names_.begin(), names_.end(), name) != names_.end())
    return fail(ErrorKind::Internal, name, "is not a new name below the output folder");
  const fs::path aside = folder_ / kAside / name;
  std::error_code error;
  fs::create_directories(aside.parent_path(), error);
  if (error) return unwritable(folder_ / name, "cannot create its folder: " + error.message());
  const auto failed = [&] {
    return unwritable(folder_ / name, "cannot be written: " + reason(errno != 0 ? errno : EIO),
                      "free some space or give another folder");
  };
  errno = 0;
  std::ofstream out(aside, std::ios::binary | std::ios::trunc);
  if (!out) return failed();
  if (auto done = write(out); !done) return out ? done : failed();
  if (!out.flush()) return failed();
  out.close();
  if (!out) return failed();
  names_.push_back(name);
  return {};
}

/// Finds what is in the way before anything is changed.
Result<void> OutputFolder::check_places() const {
  std::error_code error;
  for (const std::string& name : names_) {
    const fs::path file = folder_ / name;
    if (!is_reached_plainly(folder_, name))
      return unwritable(file, "a file or symbolic link has the name of its folder",
                        "move it away or give another folder");
    if (fs::symlink_status(file, error).type() == fs::file_type::directory)
      return unwritable(file, "is a folder", "move it away or give another folder");
  }
  return {};
}

/// Moves one file from aside to its place.
Result<void> OutputFolder::put(const std::string& name) const {
  const fs::path file = folder_ / name;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (!error) fs::rename(folder_ / kAside / name, file, error);
  if (error) return unwritable(file, "cannot be renamed: " + error.message());
  return {};
}

Result<void> OutputFolder::put_manifest(const std::string& made_by,
                                        const std::vector<std::string>& files,
                                        const FilesOfCommands& others) const {
  nlohmann::ordered_json manifest{{"popcut", 1}, {"made_by", made_by}, {"files", files}};
  for (const auto& [command, names] : others)
    if (!names.empty()) manifest["others"][command] = names;
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  errno = 0;
  std::ofstream out(folder_ / kAside / kManifest, std::ios::binary | std::ios::trunc);
  out << manifest.dump(2, ' ', false, replace) << '\n';
  out.close();
  if (!out)
    return unwritable(folder_ / kManifest, "cannot be written: " + reason(errno != 0 ? errno : EIO),
                      "free some space or give another folder");
  return put(kManifest);
}

Result<void> OutputFolder::commit(const std::string& made_by) {
  if (auto clear = check_places(); !clear) return clear;
  // 1. Until all is done the manifest lists old and new, so that whenever the run is killed the
  //    next one still knows every file that popcut wrote.
  FilesOfCommands others = listed_before(folder_);
  std::set<std::string> stale = std::move(others[command_of(made_by)]);
  others.erase(command_of(made_by));
  for (auto& [command, names] : others)
    for (const std::string& name : names_) names.erase(name);
  std::set<std::string> all = stale;
  all.insert(names_.begin(), names_.end());
  if (auto done = put_manifest(made_by, {all.begin(), all.end()}, others); !done) return done;
  // 2. The new files, each by one rename.
  for (const std::string& name : names_) {
    if (auto done = put(name); !done) return done;
    stale.erase(name);
  }
  // 3. What no longer belongs.
  for (const std::string& name : stale) remove_stale(folder_, name);
  if (auto done = put_manifest(made_by, names_, others); !done) return done;
  discard();
  return {};
}

Result<void> write_whole_file(const std::filesystem::path& path,
                              const std::function<void(std::ostream&)>& write) {
  namespace fs = std::filesystem;
  const auto unwritable = [&](const std::string& why) {
    return fail(ErrorKind::Unwritable, path.string(), why + "; give a file that can be written");
  };
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return unwritable("is a folder");
  const bool direct = fs::exists(status) && !fs::is_regular_file(status);
  // A link stays a link: the file that it names is replaced.
  const fs::path target = fs::is_regular_file(status) ? fs::canonical(path, error) : path;
  fs::path aside = target;
  if (!direct) aside += ".part-" + std::to_string(getpid());
  errno = 0;
  std::ofstream out(aside, std::ios::binary | std::ios::trunc);
  if (out) write(out);
  out.close();
  if (!out) {
    const std::string why = errno != 0 ? std::strerror(errno) : "cannot be written";
    if (!direct) fs::remove(aside, error);
    return unwritable(why);
  }
  if (direct) return {};
  fs::rename(aside, target, error);
  if (!error) return {};
  const std::string why = error.message();
  fs::remove(aside, error);
  return unwritable(why);
}

}  // namespace popcut::cli
