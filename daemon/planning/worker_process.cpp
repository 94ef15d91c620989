// SPDX-License-Identifier: MIT
#include "daemon/planning/worker_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <ctime>
#include <utility>

namespace popcut::planning {
namespace {

using daemon::PlanningLimits;

void close_one(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

/// Both ends of a pipe, closed with the value unless they are taken.
struct Pipe {
  int read{-1}, write{-1};
  bool open() {
    std::array<int, 2> ends;
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    read = ends[0];
    write = ends[1];
    return true;
  }
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_one(read);
    close_one(write);
  }
};

// What follows runs in the child between fork and exec: only calls that are safe there, no memory.

void limit(int resource, rlim_t soft, rlim_t hard) {
  rlimit now{};
  if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &now) != 0) return;
  const rlimit wanted{soft < now.rlim_max ? soft : now.rlim_max,
                      hard < now.rlim_max ? hard : now.rlim_max};
  if (::setrlimit(static_cast<__rlimit_resource_t>(resource), &wanted) != 0) ::_exit(126);
}

void set_limits(const PlanningLimits& limits) {
  const auto cpu_s = static_cast<rlim_t>(std::ceil(limits.cpu_s < 1 ? 1 : limits.cpu_s));
  // A worker answers SIGXCPU with kOutOfTimeCode; one that does not is killed a second later.
  limit(RLIMIT_CPU, cpu_s, cpu_s + 1);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  limit(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes);
#endif
#if !defined(__SANITIZE_THREAD__)  // whose runtime makes itself a file, and then gives it up
  limit(RLIMIT_FSIZE, 0, 0);
#endif
  limit(RLIMIT_CORE, 0, 0);
  constexpr rlim_t kForTheLoader = 16;  // the worker itself gives up even these
  limit(RLIMIT_NOFILE, kForTheLoader, kForTheLoader);
}

/// If memory runs out the kernel is to take the worker, never the process that cuts.
void offer_to_oom_killer() {
  const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  if (::write(file, "1000", 4) < 0) { /* then not */
  }
  ::close(file);
}

void close_all_from(unsigned int first) {
#ifdef SYS_close_range
  if (::syscall(SYS_close_range, first, ~0U, 0U) == 0) return;
#endif
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  const rlim_t end = files.rlim_cur < 65536 ? files.rlim_cur : 65536;
  for (rlim_t k = first; k < end; ++k) ::close(static_cast<int>(k));
}

void usual_signals() {
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) ::sigaction(signal, &usual, nullptr);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Nobody reads any more what is written there.
bool is_abandoned(int pipe) {
  pollfd end{pipe, 0, 0};
  return ::poll(&end, 1, 0) == 1 && (end.revents & POLLERR) != 0;
}

/// As fork, with namespaces of users, processes and System V IPC for the child where it can have
/// them; else `error` says why not. No network of its own: that takes as long as all the rest of a
/// start, and a worker has no sockets.
pid_t fork_apart(int& error) {
#if defined(__SANITIZE_THREAD__)  // whose runtime must know of it
  error = ENOTSUP;
#elif defined(__s390__)  // whose clone takes its arguments in another order
  error = ENOTSUP;
#else
  constexpr unsigned long kApart = CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWIPC;
  const long child = ::syscall(SYS_clone, kApart | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
  if (child >= 0) return static_cast<pid_t>(child);
  error = errno;
#endif
  return ::fork();
}

[[noreturn]] void become_worker(const char* program, const char* mode, const PlanningLimits& limits,
                                pid_t parent, std::array<int, 3> pipes) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // It died before that. In a namespace of its own this one sees no parent, but see below.
  if (const pid_t seen = ::getppid(); seen != 0 && seen != parent) ::_exit(126);
  usual_signals();
  ::setpgid(0, 0);  // what a terminal sends to popcutd is not for it
  if (limits.together && limits.together->group() >= 0 &&
      ::write(limits.together->group(), "0", 1) < 0) { /* then it stays in the group of popcutd */
  }
  // None of the pipes may be among 0, 1, 2 while those are put in place.
  for (int& pipe : pipes) pipe = ::fcntl(pipe, F_DUPFD, 3);
  for (int k = 0; k < 3; ++k)
    if (::dup2(pipes[static_cast<std::size_t>(k)], k) != k) ::_exit(126);
  close_all_from(3);
  if (is_abandoned(STDOUT_FILENO)) ::_exit(126);
  offer_to_oom_killer();
  ::setpriority(PRIO_PROCESS, 0, 10);
  if (::chdir("/") != 0) ::_exit(126);
  set_limits(limits);
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) ::_exit(126);
  auto name = std::to_array("popcutd");
  auto word = std::to_array("--worker");
  std::array<char, 16> mode_word{};
  if (mode != nullptr) std::strncpy(mode_word.data(), mode, mode_word.size() - 1);
  const std::array<char*, 4> arguments{name.data(), word.data(),
                                       mode != nullptr ? mode_word.data() : nullptr, nullptr};
  const std::array<char*, 1> environment{nullptr};
  ::execve(program, arguments.data(), environment.data());
  ::_exit(127);
}

}  // namespace

Result<WorkerProcess> WorkerProcess::start(const std::string& program, const PlanningLimits& limits,
                                           const char* word) {
  const auto failed = [] {
    return fail(ErrorKind::Internal, "worker",
                std::string("cannot be started: ") + std::strerror(errno));
  };
  Pipe to, from, errors;
  if (!to.open() || !from.open() || !errors.open()) return failed();
  for (const int end : {to.write, from.read, errors.read})
    if (::fcntl(end, F_SETFL, O_NONBLOCK) != 0) return failed();
  const pid_t self = ::getpid();
  int namespaces_error = 0;
  const pid_t child = fork_apart(namespaces_error);
  if (child < 0) return failed();
  if (child == 0)
    become_worker(program.c_str(), word, limits, self, {to.read, from.write, errors.write});
  WorkerProcess process;
  process.namespaces_error_ = namespaces_error;
  process.pid_ = child;
  process.to_ = std::exchange(to.write, -1);
  process.from_ = std::exchange(from.read, -1);
  process.errors_ = std::exchange(errors.read, -1);
  return process;
}

WorkerProcess::WorkerProcess(WorkerProcess&& other) noexcept
    : to_(std::exchange(other.to_, -1)),
      from_(std::exchange(other.from_, -1)),
      errors_(std::exchange(other.errors_, -1)),
      pid_(std::exchange(other.pid_, -1)),
      namespaces_error_(other.namespaces_error_),
      cpu_s_(other.cpu_s_) {}

WorkerProcess::~WorkerProcess() {
  if (pid_ > 0) {
    kill();
    wait();
  }
  close_one(to_);
  close_one(from_);
  close_one(errors_);
}

void WorkerProcess::close_to() { close_one(to_); }
void WorkerProcess::close_errors() { close_one(errors_); }

void WorkerProcess::send_kill() const {
  if (pid_ > 0) ::kill(pid_, SIGKILL);
}

double WorkerProcess::cpu_so_far_s() const {
  clockid_t clock{};
  timespec used{};
  if (pid_ < 0 || ::clock_getcpuclockid(pid_, &clock) != 0 || ::clock_gettime(clock, &used) != 0)
    return 0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

int WorkerProcess::wait() {
  int status = 0;
  rusage used{};
  constexpr int kLooks = 400;
  for (int look = 0; pid_ > 0; ++look) {
    const pid_t ended = ::wait4(pid_, &status, look < kLooks ? WNOHANG : 0, &used);
    if (ended == pid_ || (ended < 0 && errno != EINTR)) {
      const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
      };
      cpu_s_ = seconds(used.ru_utime) + seconds(used.ru_stime);
      pid_ = -1;
      break;
    }
    if (look == kLooks - 1) kill();
    constexpr timespec kMoment{0, 5'000'000};
    if (look < kLooks) ::nanosleep(&kMoment, nullptr);
  }
  return status;
}

}  // namespace popcut::planning
