// SPDX-License-Identifier: MIT
#include "tests/support/traced_child.hpp"

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <elf.h>
#include <linux/ptrace.h>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <stdexcept>

namespace popcut::testing {
namespace {

// A call that does nothing, and that nobody else makes: getppid with three arguments.
constexpr long kBegin[] = {0x706f70, 0x637574, 0x1};

template <typename Data>
long trace(long request, pid_t thread, std::uint64_t address, Data data) {
  return ::syscall(SYS_ptrace, request, thread, address, data);
}

/// The name of a call that changes something in the file system; nullptr: it does not.
const char* changing(std::uint64_t number, const std::uint64_t* arguments) {
  switch (number) {
    case SYS_write:
      return "write";
    case SYS_pwrite64:
      return "pwrite";
    case SYS_writev:
      return "writev";
    case SYS_pwritev:
      return "pwritev";
    case SYS_fsync:
      return "fsync";
    case SYS_fdatasync:
      return "fdatasync";
    case SYS_ftruncate:
      return "ftruncate";
    case SYS_fallocate:
      return "fallocate";
    case SYS_renameat:
      return "rename";
    case SYS_renameat2:
      return "rename";
    case SYS_unlinkat:
      return "unlink";
    case SYS_mkdirat:
      return "mkdir";
    case SYS_linkat:
      return "link";
    case SYS_copy_file_range:
      return "copy_file_range";
    case SYS_sendfile:
      return "sendfile";
#ifdef SYS_rename
    case SYS_rename:
      return "rename";
    case SYS_unlink:
      return "unlink";
    case SYS_rmdir:
      return "rmdir";
    case SYS_mkdir:
      return "mkdir";
    case SYS_link:
      return "link";
    case SYS_open:
      return (arguments[1] & (O_CREAT | O_TRUNC)) != 0 ? "open" : nullptr;
#endif
    case SYS_openat:
      return (arguments[2] & (O_CREAT | O_TRUNC)) != 0 ? "open" : nullptr;
    default:
      return nullptr;
  }
}

/// Whether the call is of a regular file or of names: what wakes a thread or goes to a pipe is not.
bool is_of_files(pid_t thread, std::uint64_t number, std::uint64_t file) {
  if (number != SYS_write && number != SYS_writev) return true;
  char link[64], path[256];
  std::snprintf(link, sizeof link, "/proc/%d/fd/%d", thread, static_cast<int>(file));
  const ssize_t length = ::readlink(link, path, sizeof path - 1);
  return length > 0 && path[0] == '/' &&
         (length < 5 || std::string(path, 5) != "/dev/" || std::string(path, 9) == "/dev/shm/");
}

/// Makes the call that `thread` is about to make fail: it makes none, and gets `error`.
class Refusal {
 public:
  explicit Refusal(int error) : error_(error) {}
  void at_entry(pid_t thread) {
#if defined(__x86_64__)
    user_regs_struct registers{};
    iovec place{&registers, sizeof registers};
    trace(PTRACE_GETREGSET, thread, NT_PRSTATUS, &place);
    registers.orig_rax = static_cast<unsigned long long>(-1);
    trace(PTRACE_SETREGSET, thread, NT_PRSTATUS, &place);
#endif
    thread_ = thread;
  }
  void at_exit(pid_t thread) {
    if (thread != thread_) return;
#if defined(__x86_64__)
    user_regs_struct registers{};
    iovec place{&registers, sizeof registers};
    trace(PTRACE_GETREGSET, thread, NT_PRSTATUS, &place);
    registers.rax = static_cast<unsigned long long>(-error_);
    trace(PTRACE_SETREGSET, thread, NT_PRSTATUS, &place);
#endif
    thread_ = 0;
  }

 private:
  int error_;
  pid_t thread_{};
};

[[noreturn]] void be_child(const std::function<int()>& work) {
  int code = 99;
  trace(PTRACE_TRACEME, 0, 0, nullptr);
  ::raise(SIGSTOP);
  try {
    code = work();
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "in the child: %s\n", fault.what());
  } catch (...) {
    std::fprintf(stderr, "in the child: a requirement did not hold\n");
  }
  ::_exit(code);
}

/// Follows all threads of a child from call to call.
class Tracer {
 public:
  Tracer(pid_t child, int number, CallFate fate)
      : child_(child),
        number_(number),
        fate_(fate),
        refusal_(fate == CallFate::NoRoom ? ENOSPC : EIO) {}

  ChildEnd follow() {
    int status = 0;
    ::waitpid(child_, &status, 0);
    trace(PTRACE_SETOPTIONS, child_, 0,
          PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL);
    go_on(child_, 0);
    for (;;) {
      const pid_t thread = ::waitpid(-1, &status, __WALL);
      if (thread < 0) throw std::runtime_error("a traced child is gone");
      if (WIFEXITED(status) || WIFSIGNALED(status)) {
        if (thread != child_) continue;
        end_.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return end_;
      }
      stopped(thread, WSTOPSIG(status), status >> 16);
    }
  }

 private:
  void go_on(pid_t thread, int signal) const {
    // Counting is over once the fate has come: the rest runs unwatched.
    const bool watch = !(end_.chosen && refused_);
    trace(watch ? PTRACE_SYSCALL : PTRACE_CONT, thread, 0, signal);
  }

  void stopped(pid_t thread, int signal, int event) {
    if (signal == (SIGTRAP | 0x80)) {
      call(thread);
      go_on(thread, 0);
    } else if (event != 0 || signal == SIGSTOP || signal == SIGTRAP) {
      go_on(thread, 0);
    } else {
      go_on(thread, signal);
    }
  }

  void call(pid_t thread) {
    ptrace_syscall_info info{};
    if (trace(PTRACE_GET_SYSCALL_INFO, thread, sizeof info, &info) <= 0) return;
    if (info.op == PTRACE_SYSCALL_INFO_EXIT) {
      if (end_.chosen && !refused_) {
        refusal_.at_exit(thread);
        refused_ = true;
      }
      return;
    }
    if (info.op != PTRACE_SYSCALL_INFO_ENTRY) return;
    const std::uint64_t* const arguments = reinterpret_cast<const std::uint64_t*>(info.entry.args);
    if (info.entry.nr == SYS_getppid && static_cast<long>(arguments[0]) == kBegin[0] &&
        static_cast<long>(arguments[1]) == kBegin[1])
      counting_ = true;
    if (!counting_ || end_.chosen) return;
    const char* const name = changing(info.entry.nr, arguments);
    if (name == nullptr || !is_of_files(thread, info.entry.nr, arguments[0])) return;
    end_.calls.emplace_back(name);
    if (end_.calls.size() != static_cast<std::size_t>(number_)) return;
    end_.chosen = true;
    if (fate_ == CallFate::Dies)
      ::kill(child_, SIGKILL);
    else
      refusal_.at_entry(thread);
  }

  pid_t child_;
  int number_;
  CallFate fate_;
  Refusal refusal_;
  bool counting_{false}, refused_{false};
  ChildEnd end_;
};

}  // namespace

bool can_trace() {
#if !defined(__x86_64__)
  return false;
#else
  static const bool can = [] {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(trace(PTRACE_TRACEME, 0, 0, nullptr) == 0 ? 0 : 1);
    int status = 0;
    return child > 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
  }();
  return can;
#endif
}

ChildEnd run_with_fate(int number, CallFate fate, const std::function<int()>& work) {
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no child");
  if (child == 0) be_child(work);
  return Tracer(child, number, fate).follow();
}

void count_calls_from_here() { (void)::syscall(SYS_getppid, kBegin[0], kBegin[1], kBegin[2]); }

}  // namespace popcut::testing
