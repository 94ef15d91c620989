// SPDX-License-Identifier: MIT
#include "daemon/planning/worker/confinement.hpp"

#include <poll.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>

#include <fmt/format.h>

#include "daemon/planning/worker_process.hpp"

namespace popcut::planning {
namespace {

std::string reason(int error) {
  if (error == ENOSYS) return "the kernel does not have it";
  if (error == EOPNOTSUPP) return "it is switched off in this kernel";
  return std::strerror(error);
}

// Landlock, whose C library functions do not exist. The structure is longer than that of Debian's
// headers; an older kernel takes one whose tail is zero.

#ifndef SYS_landlock_create_ruleset  // the same number on all machines
#define SYS_landlock_create_ruleset 444
#define SYS_landlock_restrict_self 446
#endif

struct LandlockRules {
  std::uint64_t files{}, ports{}, scopes{};
};

/// All that a kernel of this version can refuse.
LandlockRules all_of_landlock(long version) {
  constexpr std::uint64_t kOfVersion1 = (1U << 13) - 1, kRefer = 1U << 13, kTruncate = 1U << 14,
                          kDeviceControl = 1U << 15;
  LandlockRules rules;
  rules.files = kOfVersion1;
  if (version >= 2) rules.files |= kRefer;
  if (version >= 3) rules.files |= kTruncate;
  if (version >= 5) rules.files |= kDeviceControl;
  if (version >= 4) rules.ports = 3;   // bind, connect
  if (version >= 6) rules.scopes = 3;  // abstract sockets, signals
  return rules;
}

std::string refuse_files() {
  constexpr unsigned kTellVersion = 1;
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, kTellVersion);
  if (version < 1) return reason(errno);
  LandlockRules rules = all_of_landlock(version);
  const auto set =
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0U));
  if (set < 0) return reason(errno);
  const bool done = ::syscall(SYS_landlock_restrict_self, set, 0U) == 0;
  const std::string why = done ? "" : reason(errno);
  ::close(set);
  return why;
}

// seccomp

/// A call that a worker may make, if its arguments are as these say.
struct Allowed {
  int call{};
  std::vector<scmp_arg_cmp> arguments{};
};

/// A condition on the lower 32 bits of an argument. The macros of libseccomp need extensions of C.
scmp_arg_cmp argument(unsigned index, scmp_compare comparison, scmp_datum_t a, scmp_datum_t b = 0) {
  return {index, comparison, static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)};
}

std::vector<Allowed> allowed_calls() {
  const auto self = static_cast<scmp_datum_t>(::getpid());
  const auto thread = static_cast<scmp_datum_t>(::syscall(SYS_gettid));
  constexpr scmp_datum_t kRun = PROT_EXEC, kNoFile = MAP_ANONYMOUS;
  std::vector<Allowed> calls{
      // its pipes
      {SCMP_SYS(read), {argument(0, SCMP_CMP_EQ, STDIN_FILENO)}},
      {SCMP_SYS(write), {argument(0, SCMP_CMP_EQ, STDOUT_FILENO)}},
      {SCMP_SYS(write), {argument(0, SCMP_CMP_EQ, STDERR_FILENO)}},
      {SCMP_SYS(writev), {argument(0, SCMP_CMP_EQ, STDOUT_FILENO)}},
      {SCMP_SYS(writev), {argument(0, SCMP_CMP_EQ, STDERR_FILENO)}},
      {SCMP_SYS(close)},
      // memory: never a file, and nothing that can be written and run
      {SCMP_SYS(brk)},
      {SCMP_SYS(mmap),
       {argument(2, SCMP_CMP_MASKED_EQ, kRun, 0),
        argument(3, SCMP_CMP_MASKED_EQ, kNoFile, kNoFile)}},
      {SCMP_SYS(mmap2),
       {argument(2, SCMP_CMP_MASKED_EQ, kRun, 0),
        argument(3, SCMP_CMP_MASKED_EQ, kNoFile, kNoFile)}},
      {SCMP_SYS(mprotect), {argument(2, SCMP_CMP_MASKED_EQ, kRun, 0)}},
      {SCMP_SYS(munmap)},
      {SCMP_SYS(mremap)},
      {SCMP_SYS(madvise)},
      {SCMP_SYS(futex)},
      {SCMP_SYS(futex_time64)},
      // what the C library asks before it sorts in memory or starts a heap
      {SCMP_SYS(sysinfo)},
      {SCMP_SYS(sched_getaffinity), {argument(0, SCMP_CMP_EQ, 0)}},
      {SCMP_SYS(sched_yield)},
      {SCMP_SYS(getrandom)},
      // time
      {SCMP_SYS(clock_gettime)},
      {SCMP_SYS(clock_gettime64)},
      {SCMP_SYS(clock_getres)},
      {SCMP_SYS(gettimeofday)},
      {SCMP_SYS(time)},
      // its end, by a signal to itself too
      {SCMP_SYS(getpid)},
      {SCMP_SYS(gettid)},
      {SCMP_SYS(tgkill), {argument(0, SCMP_CMP_EQ, self), argument(1, SCMP_CMP_EQ, thread)}},
      {SCMP_SYS(rt_sigaction)},
      {SCMP_SYS(rt_sigprocmask)},
      {SCMP_SYS(rt_sigreturn)},
      {SCMP_SYS(sigreturn)},
      {SCMP_SYS(sigaltstack)},
      {SCMP_SYS(restart_syscall)},
      {SCMP_SYS(exit)},
      {SCMP_SYS(exit_group)},
  };
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  // Builds for tests only: the runtime of a sanitizer asks for its limits and how it was called.
  for (const int call : {SCMP_SYS(prlimit64), SCMP_SYS(getrlimit)})
    calls.push_back({call, {scmp_arg_cmp{2, SCMP_CMP_EQ, 0, 0}}});
#endif
  return calls;
}

std::string refuse_calls() {
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> filter(
      ::seccomp_init(SCMP_ACT_ERRNO(EPERM)), ::seccomp_release);
  if (!filter) return "there is no memory for its list";
  // A call in the way of another machine (32 bits on 64) ends the process.
  int failed = ::seccomp_attr_set(filter.get(), SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
  for (const Allowed& one : allowed_calls()) {
    if (failed != 0) break;
    if (one.call < 0) continue;  // unknown to this machine
    failed =
        ::seccomp_rule_add_array(filter.get(), SCMP_ACT_ALLOW, one.call,
                                 static_cast<unsigned>(one.arguments.size()), one.arguments.data());
  }
  if (failed == 0) failed = ::seccomp_load(filter.get());
  return failed == 0 ? "" : reason(-failed);
}

/// From now on no limit lets this process open a file or a socket, or start a process.
void lower_limits() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit pipes{3, 3};  // 0, 1 and 2 are there
  (void)::setrlimit(RLIMIT_NOFILE, &pipes);
#endif
  const rlimit none{0, 0};
  (void)::setrlimit(RLIMIT_NPROC, &none);
}

}  // namespace

std::vector<WorkerWall> confine_worker(const bool list_calls) {
  (void)::prctl(PR_SET_DUMPABLE, 0);  // another worker cannot look into this one
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) {
    const std::string why = reason(errno);
    return {{"seccomp", why}, {"landlock", why}};
  }
  std::vector<WorkerWall> walls{{"seccomp", ""}, {"landlock", refuse_files()}};
  lower_limits();
  // Last: it refuses what the others need.
  walls[0].why_not = list_calls ? refuse_calls() : "it was not asked for";
  return walls;
}

std::string walls_text(const std::vector<WorkerWall>& walls) {
  std::string text;
  for (const WorkerWall& wall : walls) text += wall.name + ' ' + wall.why_not + '\n';
  return text;
}

std::vector<WorkerWall> read_walls(std::string_view text) {
  std::vector<WorkerWall> walls;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::size_t blank = text.find(' ', at);
    if (end == text.npos || blank == text.npos || blank > end) return {};
    walls.push_back({std::string(text.substr(at, blank - at)),
                     std::string(text.substr(blank + 1, end - blank - 1))});
    at = end + 1;
  }
  return walls;
}

std::string confinement_text(const std::vector<WorkerWall>& walls) {
  std::string by, not_by;
  for (const WorkerWall& wall : walls) {
    std::string& list = wall.holds() ? by : not_by;
    list += (list.empty() ? "" : ", ") + wall.name;
    if (!wall.holds()) list += " (" + wall.why_not + ")";
  }
  std::string text = "workers are confined by: " + (by.empty() ? "nothing" : by);
  if (!not_by.empty()) text += "; not by: " + not_by;
  return text;
}

Result<std::vector<WorkerWall>> try_confinement(const std::string& program) {
  auto process = WorkerProcess::start(program, {}, "tell");
  if (!process) return tl::unexpected(process.error());
  constexpr int kPatience_ms = 10'000;
  constexpr std::size_t kMost = 4096;
  std::string text;
  std::array<char, 512> block{};
  while (text.size() < kMost) {
    pollfd answer{process->from(), POLLIN, 0};
    const int ready = ::poll(&answer, 1, kPatience_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) break;
    const ssize_t got = ::read(process->from(), block.data(), block.size());
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) break;
    text.append(block.data(), static_cast<std::size_t>(got));
  }
  std::vector<WorkerWall> walls = read_walls(text);
  if (walls.empty()) return fail(ErrorKind::Internal, "worker", "does not say how it is confined");
  const int refused = process->namespaces_error();
  walls.push_back({"namespaces", refused == 0 ? "" : reason(refused)});
  return walls;
}

}  // namespace popcut::planning
