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
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <mutex>
#include <set>
#include <sstream>
#include <streambuf>
#include <string>
#include <system_error>
#include <thread>
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

/// The folder below `top` in which the last part of `name` lies; none with errno.
///
/// @param mode  of folders that are made where they are absent; 0: none is made
HeldFolder folder_of(HeldFolder top, const std::string& name, std::string& leaf, unsigned mode) {
  const fs::path path(name);
  leaf = path.filename().string();
  for (const fs::path& part : path.parent_path()) {
    if (mode != 0 && top.make_folder(part.string(), mode) != 0 && errno != EEXIST) return {};
    top = top.below(part.string());
    if (!top.holds()) return {};
  }
  return top;
}

std::string content_of(int file, std::uintmax_t limit_bytes) {
  std::string content;
  std::vector<char> block(1u << 16);
  for (ssize_t got = 0; (got = ::read(file, block.data(), block.size())) > 0;) {
    content.append(block.data(), static_cast<std::size_t>(got));
    if (content.size() > limit_bytes) return {};
  }
  return content;
}

/// Writes to a descriptor, which it closes. errno says what failed.
class DescriptorBuffer final : public std::streambuf {
 public:
  explicit DescriptorBuffer(int file) : file_(file), block_(1u << 16) {
    setp(block_.data(), block_.data() + block_.size());
  }
  ~DescriptorBuffer() override { (void)close(); }
  DescriptorBuffer(const DescriptorBuffer&) = delete;
  DescriptorBuffer& operator=(const DescriptorBuffer&) = delete;
  [[nodiscard]] bool close() {
    if (file_ < 0) return true;
    const bool is_written = sync() == 0;
    return ::close(std::exchange(file_, -1)) == 0 && is_written;
  }

 protected:
  int sync() override {
    const char* from = pbase();
    while (from < pptr()) {
      const ssize_t put = ::write(file_, from, static_cast<std::size_t>(pptr() - from));
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) return -1;
      from += put;
    }
    setp(block_.data(), block_.data() + block_.size());
    return 0;
  }
  int_type overflow(int_type next) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(next, traits_type::eof())) {
      *pptr() = traits_type::to_char_type(next);
      pbump(1);
    }
    return traits_type::not_eof(next);
  }

 private:
  int file_;
  std::vector<char> block_;
};

/// Writes a new file by `write`; errno says what failed where no error is returned.
///
/// @return whether all of it is written
Result<bool> write_new(int file, const std::function<Result<void>(std::ostream&)>& write) {
  if (file < 0) return false;
  errno = 0;
  DescriptorBuffer buffer(file);
  std::ostream out(&buffer);
  if (auto done = write(out); !done && out) return tl::unexpected(done.error());
  return out && buffer.close();
}

void remove_aside(const HeldFolder& folder) {
  std::error_code error;
  fs::remove_all("/proc/self/fd/" + std::to_string(folder.descriptor()) + "/" + kAside, error);
}

/// Removes what is aside when a signal ends the program: what a handler may not do, a thread does.
class EndBySignal {
 public:
  static EndBySignal& only() {
    static EndBySignal one;
    return one;
  }
  void add(const HeldFolder& folder, const std::vector<fs::path>& made) {
    const std::lock_guard lock(mutex_);
    if (open_.empty()) begin();
    open_.emplace(folder.descriptor(), std::pair(folder, made));
  }
  void remove(int descriptor) {
    const std::lock_guard lock(mutex_);
    if (open_.erase(descriptor) > 0 && open_.empty()) end();
  }

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  static inline std::atomic<int> told_{-1};  ///< a descriptor to which the handler writes

  static void tell(int signal) {
    const int before = errno;
    const auto byte = static_cast<unsigned char>(signal);
    if (::write(told_, &byte, 1) < 0) ::_exit(128 + signal);
    errno = before;
  }
  void begin() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) return;
    told_ = ends_[1];
    thread_ = std::thread([this] { wait(); });
    for (std::size_t k = 0; k < kSignals.size(); ++k) {
      struct sigaction own {};
      own.sa_handler = tell;
      own.sa_flags = SA_RESTART;
      ::sigaction(kSignals[k], nullptr, &before_[k]);
      if (before_[k].sa_handler == SIG_DFL) ::sigaction(kSignals[k], &own, nullptr);
    }
  }
  void end() {
    if (!thread_.joinable()) return;
    for (std::size_t k = 0; k < kSignals.size(); ++k)
      if (before_[k].sa_handler == SIG_DFL) ::sigaction(kSignals[k], &before_[k], nullptr);
    ::close(ends_[1]);
    thread_.join();
    ::close(ends_[0]);
  }
  void wait() {
    unsigned char signal = 0;
    if (::read(ends_[0], &signal, 1) != 1) return;  // the other end was closed
    // Not given back: nothing may be written any more, and nothing renamed.
    mutex_.lock();
    for (const auto& [descriptor, one] : open_) {
      remove_aside(one.first);
      for (auto made = one.second.rbegin(); made != one.second.rend(); ++made)
        ::rmdir(made->c_str());
    }
    std::signal(signal, SIG_DFL);
    ::raise(signal);
    ::_exit(128 + signal);
  }

  std::mutex mutex_;
  std::map<int, std::pair<HeldFolder, std::vector<fs::path>>> open_;
  std::array<int, 2> ends_{-1, -1};
  std::array<struct sigaction, kSignals.size()> before_{};
  std::thread thread_;
};

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
std::map<std::string, std::set<std::string>> listed_before(const HeldFolder& folder) {
  std::map<std::string, std::set<std::string>> names;
  const int file = folder.read(kManifest);
  if (file < 0) return names;
  const auto parsed = parse_json(content_of(file, kManifestLimitBytes));
  ::close(file);
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
void remove_stale(const HeldFolder& folder, const std::string& name) {
  std::string leaf;
  const HeldFolder place = folder_of(folder, name, leaf, 0);
  struct stat found {};
  if (!place.holds() ||
      ::fstatat(place.descriptor(), leaf.c_str(), &found, AT_SYMLINK_NOFOLLOW) != 0 ||
      !S_ISREG(found.st_mode) || place.remove(leaf) != 0)
    return;
  for (fs::path up = fs::path(name).parent_path(); !up.empty(); up = up.parent_path()) {
    const HeldFolder above = folder_of(folder, up.string(), leaf, 0);
    if (!above.holds() || ::unlinkat(above.descriptor(), leaf.c_str(), AT_REMOVEDIR) != 0) return;
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

Result<std::string> read_beside(const fs::path& file, const std::string& name) {
  const auto malformed = [&](const std::string& why) {
    return fail(ErrorKind::Malformed, name, why);
  };
  const fs::path path = fs::path(name).lexically_normal();
  if (name.empty() || name.find('\0') != std::string::npos || path.is_absolute() ||
      *path.begin() == "..")
    return malformed("lies outside of the folder of " + file.filename().string() +
                     "; put it beside that file");
  const fs::path above = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::string leaf;
  const HeldFolder folder =
      folder_of(HeldFolder::of(::open(above.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)),
                path.string(), leaf, 0);
  const int found = folder.holds() ? folder.read(leaf) : -1;
  if (found < 0 && (errno == ELOOP || errno == ENOTDIR))
    return malformed("is a link, or reached through one; put the file itself there");
  if (found < 0 && (errno == EINVAL || errno == EISDIR || errno == ENOENT))
    return malformed("is not a file");
  if (found < 0) return malformed("cannot be read: " + reason(errno));
  constexpr std::uintmax_t kMost = 1u << 30;
  std::string content = content_of(found, kMost);
  ::close(found);
  return content;
}

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : folder_(std::move(other.folder_)),
      made_(std::move(other.made_)),
      names_(std::move(other.names_)),
      inside_(std::move(other.inside_)),
      held_(std::exchange(other.held_, {})),
      aside_(std::exchange(other.aside_, {})) {}

OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept {
  if (this == &other) return *this;
  discard();
  folder_ = std::move(other.folder_);
  made_ = std::move(other.made_);
  names_ = std::move(other.names_);
  inside_ = std::move(other.inside_);
  held_ = std::exchange(other.held_, {});
  aside_ = std::exchange(other.aside_, {});
  return *this;
}

OutputFolder::~OutputFolder() { discard(); }

/// Removes what is aside, gives the lock back, and removes folders that were made and stay empty.
void OutputFolder::discard() noexcept {
  if (held_.holds()) {
    EndBySignal::only().remove(held_.descriptor());
    aside_ = {};
    remove_aside(held_);
    held_ = {};
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
  HeldFolder held = HeldFolder::of(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!held.holds() && errno == ENOTDIR) return unwritable(folder_, "is not a folder");
  if (!held.holds()) return unwritable(folder_, "cannot open the folder: " + reason(errno));
  if (::flock(held.descriptor(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return unwritable(folder_, "another popcut is writing there",
                      "wait for it or give another folder");
  }
  // 3. A fresh place aside.
  held_ = std::move(held);
  remove_aside(held_);
  EndBySignal::only().add(held_, made_);
  if (held_.make_folder(kAside) != 0)
    return unwritable(folder_, "cannot write in the folder: " + reason(errno));
  aside_ = held_.below(kAside);
  // Who may write in the folder may have put another one in its place.
  struct stat found {};
  if (!aside_.holds() || ::fstat(aside_.descriptor(), &found) != 0 || found.st_uid != ::geteuid() ||
      (found.st_mode & 022) != 0)
    return unwritable(folder_, "somebody else changes it now");
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
  std::string leaf;
  const HeldFolder aside = aside_for(name, leaf);
  if (!aside.holds())
    return unwritable(folder_ / name, "cannot create its folder: " + reason(errno));
  const Result<bool> written = write_new(aside.create_again(leaf, 0666), write);
  if (!written) return tl::unexpected(written.error());
  if (!*written)
    return unwritable(folder_ / name, "cannot be written: " + reason(errno != 0 ? errno : EIO),
                      "free some space or give another folder");
  names_.push_back(name);
  return {};
}

HeldFolder OutputFolder::aside_for(const std::string& name, std::string& leaf) const {
  return folder_of(aside_, name, leaf, 0700);
}

/// Finds what is in the way before anything is changed.
Result<void> OutputFolder::check_places() const {
  for (const std::string& name : names_) {
    const fs::path file = folder_ / name;
    std::string leaf;
    const HeldFolder place = folder_of(held_, name, leaf, 0);
    if (!place.holds() && errno != ENOENT)
      return unwritable(file, "a file or symbolic link has the name of its folder",
                        "move it away or give another folder");
    struct stat found {};
    if (place.holds() &&
        ::fstatat(place.descriptor(), leaf.c_str(), &found, AT_SYMLINK_NOFOLLOW) == 0 &&
        S_ISDIR(found.st_mode))
      return unwritable(file, "is a folder", "move it away or give another folder");
  }
  return {};
}

/// Moves one file from aside to its place.
Result<void> OutputFolder::put(const std::string& name) const {
  std::string leaf;
  const HeldFolder place = folder_of(held_, name, leaf, 0777);
  if (!place.holds() || aside_for(name, leaf).move(leaf, place, leaf) != 0)
    return unwritable(folder_ / name, "cannot be renamed: " + reason(errno));
  return {};
}

Result<void> OutputFolder::put_manifest(const std::string& made_by,
                                        const std::vector<std::string>& files,
                                        const FilesOfCommands& others) const {
  nlohmann::ordered_json manifest{{"popcut", 1}, {"made_by", made_by}, {"files", files}};
  for (const auto& [command, names] : others)
    if (!names.empty()) manifest["others"][command] = names;
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  const auto written =
      write_new(aside_.create_again(kManifest, 0666), [&](std::ostream& out) -> Result<void> {
        out << manifest.dump(2, ' ', false, replace) << '\n';
        return {};
      });
  if (!written || !*written)
    return unwritable(folder_ / kManifest, "cannot be written: " + reason(errno != 0 ? errno : EIO),
                      "free some space or give another folder");
  return put(kManifest);
}

Result<void> OutputFolder::commit(const std::string& made_by) {
  if (auto clear = check_places(); !clear) return clear;
  // 1. Until all is done the manifest lists old and new, so that whenever the run is killed the
  //    next one still knows every file that popcut wrote.
  FilesOfCommands others = listed_before(held_);
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
  for (const std::string& name : stale) remove_stale(held_, name);
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
  const auto written_by = [&](std::ostream& out) -> Result<void> {
    write(out);
    return {};
  };
  const auto why = [] { return errno != 0 ? std::strerror(errno) : "cannot be written"; };
  if (direct) {
    const auto done =
        write_new(::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY), written_by);
    return done && *done ? Result<void>() : unwritable(why());
  }
  const fs::path above = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const HeldFolder folder =
      HeldFolder::of(::open(above.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.holds()) return unwritable(why());
  const std::string name = target.filename().string();
  const std::string aside = name + ".part-" + std::to_string(getpid());
  const auto done = write_new(folder.create_again(aside, 0666), written_by);
  if (done && *done && folder.rename(aside, name) == 0) return {};
  const std::string problem = why();
  folder.remove(aside);
  return unwritable(problem);
}

}  // namespace popcut::cli
