// SPDX-License-Identifier: MIT
// Loaded into popcutd by LD_PRELOAD: kills it at a chosen call, lets the disk be full or fail, sets
// the clock, or keeps a thread, as `FaultControl` says.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "tests/support/fault_control.hpp"

using popcut::testing::FaultControl;

namespace {

FaultControl* control() {
  static FaultControl* const shared = []() -> FaultControl* {
    const char* const path = std::getenv(popcut::testing::kFaultControl);
    if (path == nullptr) return nullptr;
    const long file = ::syscall(SYS_openat, AT_FDCWD, path, O_RDWR | O_CLOEXEC);
    if (file < 0) return nullptr;
    void* const page = ::mmap(nullptr, sizeof(FaultControl), PROT_READ | PROT_WRITE, MAP_SHARED,
                              static_cast<int>(file), 0);
    ::syscall(SYS_close, file);
    return page == MAP_FAILED ? nullptr : static_cast<FaultControl*>(page);
  }();
  return shared;
}

/// The function that would have been called without this one.
template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// One call that leaves something behind, from begin to end.
class Call {
 public:
  Call() : control_(control()) {
    if (control_ == nullptr) return;
    number_ = ++control_->calls;
    if (is_due(control_->kill_at)) ::kill(::getpid(), SIGKILL);
  }
  ~Call() {
    const int kept = errno;
    if (control_ != nullptr && is_due(control_->kill_after)) ::kill(::getpid(), SIGKILL);
    errno = kept;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// A disk that takes its time.
  static void wait_for_disk() {
    FaultControl* const shared = control();
    if (shared == nullptr || shared->stall == 0) return;
    ++shared->stalled;
    while (shared->stall != 0) ::usleep(1000);
    --shared->stalled;
  }

  /// Whether the disk has no room for it.
  [[nodiscard]] bool full() const {
    if (control_ == nullptr) return false;
    const std::uint64_t number = ++control_->disk;
    const std::uint64_t from = control_->full_from, until = control_->full_until;
    const bool full = from != 0 && number >= from && (until == 0 || number < until);
    if (full) errno = ENOSPC;
    return full;
  }

 private:
  /// The program counts on while the test says a number: it may be behind already.
  [[nodiscard]] bool is_due(std::uint64_t at) const { return at != 0 && number_ >= at; }

  FaultControl* control_;
  std::uint64_t number_{};
};

/// Not a pipe, a socket or what wakes a thread: those are as many as somebody asks how it goes.
bool is_file(int file) {
  struct stat status {};
  return file > 2 && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

/// Whether the path of an open file has `part` in it.
bool has_in_path(int file, const char* part) {
  char link[64], path[512];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = ::readlink(link, path, sizeof path - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  return std::strstr(path, part) != nullptr;
}

bool is_trace(int file) { return has_in_path(file, "/trace/"); }

/// A file of popcutd's own: not what it says, not the cutter's log.
bool is_plain(int file) { return is_file(file) && !is_trace(file); }

/// Stays here as long as the control says so.
void stand_at(popcut::testing::Blocked where) {
  const int kept = errno;
  while (control() != nullptr && control()->blocked == where) ::usleep(1000);
  errno = kept;
}

/// One sync, of any file, and what may become of that of the database.
template <typename Function>
int sync_file(int file, Function* next) {
  const Call call;
  Call::wait_for_disk();
  FaultControl* const shared = control();
  if (shared != nullptr && shared->bad_journal != 0 && has_in_path(file, "/intents/")) {
    --shared->bad_journal;
    errno = EIO;
    return -1;
  }
  if (shared == nullptr || !has_in_path(file, "/popcut.db")) return next(file);
  stand_at(popcut::testing::kSyncs);
  const std::uint64_t number = ++shared->syncs;
  if (number == shared->bad_sync) {  // as a disk does that lost what it was given
    errno = EIO;
    return -1;
  }
  const int done = next(file);
  if (shared->last_sync != 0 && number >= shared->last_sync) ::kill(::getpid(), SIGKILL);
  return done;
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, size_t count) {
  static auto* const next = real<ssize_t(int, const void*, size_t)>("write");
  if (control() != nullptr && control()->blocked == popcut::testing::kTraces && is_trace(file))
    stand_at(popcut::testing::kTraces);
  if (!is_file(file)) return next(file, bytes, count);
  const Call call;
  if (is_plain(file) && call.full()) return -1;
  return next(file, bytes, count);
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  static auto* const next = real<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  const Call call;
  if (is_plain(file) && call.full()) return -1;
  return next(file, bytes, count, at);
}

ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
  static auto* const next = real<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  const Call call;
  if (is_plain(file) && call.full()) return -1;
  return next(file, bytes, count, at);
}

ssize_t writev(int file, const struct iovec* parts, int count) {
  static auto* const next = real<ssize_t(int, const struct iovec*, int)>("writev");
  if (!is_file(file)) return next(file, parts, count);
  const Call call;
  if (is_plain(file) && call.full()) return -1;
  return next(file, parts, count);
}

int fsync(int file) {
  static auto* const next = real<int(int)>("fsync");
  return sync_file(file, next);
}

int fdatasync(int file) {
  static auto* const next = real<int(int)>("fdatasync");
  return sync_file(file, next);
}

int rename(const char* from, const char* to) {
  static auto* const next = real<int(const char*, const char*)>("rename");
  const Call call;
  if (call.full()) return -1;
  return next(from, to);
}

int renameat(int folder, const char* from, int other, const char* to) {
  static auto* const next = real<int(int, const char*, int, const char*)>("renameat");
  const Call call;
  if (call.full()) return -1;
  return next(folder, from, other, to);
}

int unlinkat(int folder, const char* path, int flags) {
  static auto* const next = real<int(int, const char*, int)>("unlinkat");
  const Call call;
  return next(folder, path, flags);
}

int mkdirat(int folder, const char* path, mode_t mode) {
  static auto* const next = real<int(int, const char*, mode_t)>("mkdirat");
  const Call call;
  if (call.full()) return -1;
  return next(folder, path, mode);
}

int unlink(const char* path) {
  static auto* const next = real<int(const char*)>("unlink");
  const Call call;
  return next(path);
}

int mkdir(const char* path, mode_t mode) {
  static auto* const next = real<int(const char*, mode_t)>("mkdir");
  const Call call;
  if (call.full()) return -1;
  return next(path, mode);
}

int ftruncate(int file, off_t size) {
  static auto* const next = real<int(int, off_t)>("ftruncate");
  const Call call;
  return next(file, size);
}

int ftruncate64(int file, off64_t size) {
  static auto* const next = real<int(int, off64_t)>("ftruncate64");
  const Call call;
  return next(file, size);
}

int posix_fallocate(int file, off_t at, off_t size) {
  static auto* const next = real<int(int, off_t, off_t)>("posix_fallocate");
  const Call call;
  if (call.full()) return ENOSPC;
  return next(file, at, size);
}

int posix_fallocate64(int file, off64_t at, off64_t size) {
  static auto* const next = real<int(int, off64_t, off64_t)>("posix_fallocate64");
  const Call call;
  if (call.full()) return ENOSPC;
  return next(file, at, size);
}

int ioctl(int file, unsigned long request, ...) {
  static auto* const next = real<int(int, unsigned long, void*)>("ioctl");
  std::va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  const Call call;
  return next(file, request, argument);
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  static auto* const next = real<int(clockid_t, struct timespec*)>("clock_gettime");
  const int done = next(clock, time);
  if (done == 0 && clock == CLOCK_REALTIME && control() != nullptr)
    time->tv_sec += control()->clock_s;
  return done;
}

int epoll_wait(int queue, struct epoll_event* events, int most, int timeout) {
  static auto* const next = real<int(int, struct epoll_event*, int, int)>("epoll_wait");
  stand_at(popcut::testing::kPolls);
  return next(queue, events, most, timeout);
}

}  // extern "C"
