// SPDX-License-Identifier: MIT
// A worker in the hands of an attacker: this test stops one in the middle of its work and makes it
// call the kernel, as a hostile design would that had found a fault in a parser.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/running_daemon.hpp"

#if defined(__x86_64__)

namespace takeover_test {

using namespace popcut;
using namespace popcut::testing;
namespace fs = std::filesystem;

namespace {

std::string line_of(const fs::path& file, const std::string& begin) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(begin)) return line.substr(begin.size());
  return {};
}

/// A drawing whose shortest way takes seconds to look for.
std::string slow_svg() {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='200mm' height='250mm' viewBox='0 0 200 250'>"
      "<path fill='none' stroke='black' d='";
  for (int k = 0; k < 20'000; ++k)
    svg +=
        fmt::format("M{}.{:02},{}l.5,.5", 5 + k * 7919 % 190, k * 31 % 100, 5 + k * 104729 % 240);
  return svg + "'/></svg>";
}

/// The worker of a popcutd that has computed for a moment.
pid_t busy_worker(pid_t daemon) {
  pid_t found = -1;
  const bool came = happens([&] {
    for (const auto& task : fs::directory_iterator(fmt::format("/proc/{}/task", daemon))) {
      std::ifstream list(task.path() / "children");
      for (pid_t pid = 0; list >> pid;) {
        const std::string stat = text_of_file(fmt::format("/proc/{}/stat", pid));
        std::istringstream words(stat.substr(stat.rfind(')') + 1));
        std::string word;
        for (int k = 0; k < 12; ++k) words >> word;  // the last: its own time, in hundredths
        if (std::atoi(word.c_str()) >= 10) found = pid;
      }
    }
    return found > 0;
  });
  return came ? found : -1;
}

constexpr long kGetpidOf32Bits = 20;

/// Whether the kernel answers programs of 32 bits: it can be told not to.
bool has_calls_of_32_bits() {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGSEGV, SIG_DFL);
    long answer = kGetpidOf32Bits;
    asm volatile("int $0x80" : "+a"(answer) : : "memory");
    ::_exit(answer == static_cast<long>(::getpid()) ? 0 : 1);
  }
  int status = 0;
  return child > 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

/// Makes another process call the kernel.
class TakenOver {
 public:
  explicit TakenOver(pid_t pid) : pid_(pid) {
    if (::ptrace(PTRACE_SEIZE, pid_, nullptr, nullptr) != 0) {
      why_not_ = std::strerror(errno);
      return;
    }
    ::ptrace(PTRACE_INTERRUPT, pid_, nullptr, nullptr);
    held_ = ::waitpid(pid_, &status_, __WALL) == pid_ && WIFSTOPPED(status_);
    ::ptrace(PTRACE_GETREGS, pid_, nullptr, &before_);
    before_.orig_rax = static_cast<unsigned long long>(-1);  // what it was about to call waits
    code_ = ::ptrace(PTRACE_PEEKTEXT, pid_, before_.rip, nullptr);
    constexpr long kSystemCall = 0x050f;
    ::ptrace(PTRACE_POKETEXT, pid_, before_.rip, (code_ & ~0xffffL) | kSystemCall);
    const long room =
        call(SYS_mmap, {0, kRoom, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0});
    room_ = room > 0 ? room : 0;
  }
  TakenOver(const TakenOver&) = delete;
  TakenOver& operator=(const TakenOver&) = delete;
  ~TakenOver() { let_go(); }

  [[nodiscard]] bool works() const { return held_ && room_ > 0; }
  [[nodiscard]] const std::string& why_not() const { return why_not_; }
  /// What a call answers, as the kernel has it: -errno if it is refused.
  long call(long number, const std::array<long, 6>& arguments = {}, bool other_machine = false) {
    user_regs_struct now = before_;
    now.rax = static_cast<unsigned long long>(number);
    const auto word = [&](std::size_t k) { return static_cast<unsigned long long>(arguments[k]); };
    now.rdi = word(0), now.rsi = word(1), now.rdx = word(2);
    now.r10 = word(3), now.r8 = word(4), now.r9 = word(5);
    if (other_machine) {
      constexpr long kInterrupt = 0x80cd;
      now.rbx = word(0), now.rcx = word(1);
      ::ptrace(PTRACE_POKETEXT, pid_, before_.rip, (code_ & ~0xffffL) | kInterrupt);
    }
    ::ptrace(PTRACE_SETREGS, pid_, nullptr, &now);
    ::ptrace(PTRACE_SINGLESTEP, pid_, nullptr, nullptr);
    held_ = ::waitpid(pid_, &status_, __WALL) == pid_ && WIFSTOPPED(status_);
    if (!held_) return 0;
    ::ptrace(PTRACE_GETREGS, pid_, nullptr, &now);
    return static_cast<long>(now.rax);
  }
  /// The address at which these bytes lie in its memory.
  long put(const std::string& bytes) {
    const long at = room_ + used_;
    used_ += static_cast<long>((bytes.size() + 64) / 64 * 64);
    for (std::size_t k = 0; k <= bytes.size(); k += sizeof(long)) {
      long word = 0;
      std::memcpy(&word, bytes.data() + k, std::min(sizeof word, bytes.size() - k));
      ::ptrace(PTRACE_POKEDATA, pid_, at + static_cast<long>(k), word);
    }
    return at;
  }
  long zeros(std::size_t count) { return put(std::string(count, '\0')); }
  [[nodiscard]] int status() const { return status_; }
  void let_go() {
    if (!held_) return;
    ::ptrace(PTRACE_POKETEXT, pid_, before_.rip, code_);
    ::ptrace(PTRACE_SETREGS, pid_, nullptr, &before_);
    ::ptrace(PTRACE_DETACH, pid_, nullptr, nullptr);
    held_ = false;
  }

 private:
  static constexpr long kRoom = 1L << 18;
  pid_t pid_;
  bool held_{false};
  std::string why_not_;
  user_regs_struct before_{};
  long code_{}, room_{}, used_{};
  int status_{};
};

/// A call that would do lasting harm to the computer if it were let through has arguments that the
/// kernel finds wrong, but only after it has let the call through.
struct Attempt {
  std::string text;
  long number{};
  std::array<long, 6> arguments{};
};

struct Prey {
  fs::path folder;  ///< with the file "precious" and the folder "empty"
  pid_t daemon{};
};

void against_files(TakenOver& worker, const Prey& prey, std::vector<Attempt>& all) {
  const auto name = [&](const char* one) { return worker.put((prey.folder / one).string()); };
  const long file = name("precious"), fresh = name("fresh"), empty = name("empty"),
             passwd = worker.put("/etc/passwd"), room = worker.zeros(512),
             memory = worker.put(fmt::format("/proc/{}/mem", prey.daemon)),
             descriptor = worker.put(fmt::format("/proc/{}/fd/3", prey.daemon)), here = AT_FDCWD;
  const long how = worker.put(std::string("\x02\0\0\0\0\0\0\0", 8) + std::string(16, '\0'));
  for (Attempt& one : std::vector<Attempt>{
           {"open a file to write", SYS_open, {file, O_WRONLY}},
           {"open a file to read", SYS_open, {passwd, O_RDONLY}},
           {"make a file", SYS_openat, {here, fresh, O_CREAT | O_WRONLY, 0600}},
           {"open a file another way", SYS_openat2, {here, file, how, 24}},
           {"creat", SYS_creat, {fresh, 0600}},
           {"open popcutd's memory", SYS_open, {memory, O_RDWR}},
           {"open a descriptor of popcutd", SYS_open, {descriptor, O_RDWR}},
           {"unlink", SYS_unlink, {file}},
           {"unlinkat", SYS_unlinkat, {here, file, 0}},
           {"rmdir", SYS_rmdir, {empty}},
           {"rename", SYS_rename, {file, fresh}},
           {"renameat2", SYS_renameat2, {here, file, here, fresh, 0}},
           {"link", SYS_link, {file, fresh}},
           {"linkat", SYS_linkat, {here, file, here, fresh, 0}},
           {"symlink", SYS_symlink, {file, fresh}},
           {"symlinkat", SYS_symlinkat, {file, here, fresh}},
           {"mkdir", SYS_mkdir, {fresh, 0700}},
           {"mkdirat", SYS_mkdirat, {here, fresh, 0700}},
           {"mknod", SYS_mknod, {fresh, S_IFIFO | 0600, 0}},
           {"chmod", SYS_chmod, {file, 0777}},
           {"fchmodat", SYS_fchmodat, {here, file, 0777}},
           {"chown", SYS_chown, {file, 12345, 12345}},
           {"truncate", SYS_truncate, {file, 0}},
           {"set a file's times", SYS_utimensat, {here, file, 0, 0}},
           {"set an attribute of a file", SYS_setxattr, {file, worker.put("user.x"), room, 1, 0}},
           {"look at a file", SYS_stat, {passwd, room}},
           {"look at a file another way", SYS_statx, {here, passwd, 0, 0x7ff, room}},
           {"ask whether a file is there", SYS_access, {passwd, R_OK}},
           {"read a link", SYS_readlink, {worker.put("/proc/self/exe"), room, 256}},
           {"change the folder", SYS_chdir, {worker.put("/tmp")}},
           {"change the root", SYS_chroot, {worker.put("/tmp")}},
           {"mount", SYS_mount, {file, empty, worker.put("none"), 0, 0}},
           {"unmount", SYS_umount2, {empty, 0}},
           {"open_tree", SYS_open_tree, {here, worker.put("/"), 0}},
           {"fsopen", SYS_fsopen, {worker.put("tmpfs"), 0}},
           {"watch a folder", SYS_inotify_init1, {0}},
           {"map a file", SYS_mmap, {0, 4096, PROT_READ, MAP_PRIVATE, 0, 0}}})
    all.push_back(std::move(one));
}

void against_processes(TakenOver& worker, const Prey& prey, std::vector<Attempt>& all) {
  const long daemon = prey.daemon, room = worker.zeros(512);
  const long shell = worker.put("/bin/sh");
  iovec here{};
  here.iov_base = reinterpret_cast<void*>(room);
  here.iov_len = 8;
  const long vector = worker.put(std::string(reinterpret_cast<const char*>(&here), sizeof here));
  for (Attempt& one : std::vector<Attempt>{
           {"run a program", SYS_execve, {shell, 0, 0}},
           {"run a program another way", SYS_execveat, {AT_FDCWD, shell, 0, 0, 0}},
           {"fork", SYS_fork},
           {"vfork", SYS_vfork},
           {"clone", SYS_clone, {SIGCHLD, 0, 0, 0, 0}},
           {"start a thread", SYS_clone, {CLONE_VM | CLONE_THREAD | CLONE_SIGHAND, room}},
           {"clone3", SYS_clone3, {room, 88}},
           {"kill popcutd", SYS_kill, {daemon, SIGKILL}},
           {"a signal to all", SYS_kill, {-1, 0}},
           {"ask whether popcutd is there", SYS_kill, {daemon, 0}},
           {"stop a thread of popcutd", SYS_tgkill, {daemon, daemon, SIGSTOP}},
           {"tkill popcutd", SYS_tkill, {daemon, SIGKILL}},
           {"queue a signal for popcutd", SYS_rt_sigqueueinfo, {daemon, SIGKILL, room}},
           {"ptrace popcutd", SYS_ptrace, {PTRACE_ATTACH, daemon, 0, 0}},
           {"seize popcutd", SYS_ptrace, {PTRACE_SEIZE, daemon, 0, 0}},
           {"read popcutd's memory", SYS_process_vm_readv, {daemon, vector, 1, vector, 1, 0}},
           {"write popcutd's memory", SYS_process_vm_writev, {daemon, vector, 1, vector, 1, 0}},
           {"a handle of popcutd", SYS_pidfd_open, {daemon, 0}},
           {"a signal by a handle", SYS_pidfd_send_signal, {0, SIGKILL, 0, 0}},
           {"a descriptor of popcutd by a handle", SYS_pidfd_getfd, {0, 3, 0}},
           {"change popcutd's limits", SYS_prlimit64, {daemon, 7, room, 0}},
           {"change its own limits", SYS_prlimit64, {0, 7, room, 0}},
           {"change popcutd's priority", SYS_setpriority, {0, daemon, 19}},
           {"change popcutd's processor", SYS_sched_setaffinity, {daemon, 8, room}},
           {"compare with popcutd", SYS_kcmp, {daemon, daemon, 0, 0, 0}},
           {"wait for another", SYS_wait4, {-1, room, 1, 0}}})
    all.push_back(std::move(one));
}

void against_the_kernel(TakenOver& worker, std::vector<Attempt>& all) {
  const long room = worker.zeros(512);
  constexpr long kSetDumpable = 4, kSetMemoryMap = 35, kReadImplies = 0x0400000;
  const long name = worker.put("x");
  for (Attempt& one : std::vector<Attempt>{
           {"an internet socket", SYS_socket, {2, 1, 0}},
           {"a unix socket", SYS_socket, {1, 1, 0}},
           {"a netlink socket", SYS_socket, {16, 3, 0}},
           {"a pair of sockets", SYS_socketpair, {1, 1, 0, room}},
           {"connect", SYS_connect, {0, room, 16}},
           {"bind", SYS_bind, {0, room, 16}},
           {"send a descriptor", SYS_sendmsg, {1, room, 0}},
           {"send", SYS_sendto, {1, room, 1, 0, 0, 0}},
           {"write to a descriptor that is not its own", SYS_write, {3, room, 1}},
           {"write to what it reads from", SYS_write, {0, room, 1}},
           {"copy a descriptor", SYS_dup, {1}},
           {"control a descriptor", SYS_fcntl, {1, 4, 0}},
           {"control a terminal", SYS_ioctl, {0, 0x5412, room}},
           {"a pipe", SYS_pipe2, {room, 0}},
           {"splice", SYS_splice, {0, 0, 1, 0, 4096, 0}},
           {"vmsplice", SYS_vmsplice, {1, room, 1, 0}},
           {"sendfile", SYS_sendfile, {1, 0, 0, 4096}},
           {"set dumpable", SYS_prctl, {kSetDumpable, 1, 0, 0, 0}},
           {"change its memory map", SYS_prctl, {kSetMemoryMap, 1, 0, 0, 0}},
           {"a second filter", SYS_seccomp, {1, 0, room}},
           {"a file in memory", SYS_memfd_create, {name, 0}},
           {"memory that can run",
            SYS_mmap,
            {0, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0}},
           {"make memory run", SYS_mprotect, {room & ~4095L, 4096, PROT_READ | PROT_EXEC}},
           {"make memory run by a key", SYS_pkey_mprotect, {room & ~4095L, 4096, 5, 0}},
           {"handle page faults", SYS_userfaultfd, {0}},
           {"io_uring", SYS_io_uring_setup, {8, room}},
           {"bpf", SYS_bpf, {0, room, 48}},
           {"measure with perf", SYS_perf_event_open, {room, 0, -1, -1, 0}},
           {"a key", SYS_add_key, {worker.put("user"), name, room, 1, -3}},
           {"read keys", SYS_keyctl, {0, -3, 0, 0, 0}},
           {"change its personality", SYS_personality, {kReadImplies}},
           {"a new user namespace", SYS_unshare, {CLONE_NEWUSER}},
           {"a new mount namespace", SYS_unshare, {CLONE_NEWNS}},
           {"enter a namespace", SYS_setns, {0, 0}},
           {"become root", SYS_setuid, {0}},
           {"another group", SYS_setgid, {0}},
           {"take capabilities", SYS_capset, {room, room}},
           {"a new session", SYS_setsid},
           {"shared memory", SYS_shmget, {0, 4096, 01600}},
           {"messages", SYS_msgget, {0, 01600}},
           {"semaphores", SYS_semget, {0, 1, 01600}},
           {"a message queue", SYS_mq_open, {name, O_CREAT | O_RDWR, 0600, 0}},
           {"a timer's signal", SYS_timer_create, {0, 0, room}},
           {"set a clock", SYS_clock_settime, {1, room}},
           {"read the kernel's log", SYS_syslog, {3, room, 64}},
           {"load a module", SYS_init_module, {room, 1, name}},
           {"load a kernel", SYS_kexec_load, {0, 0, 0, 0}},
           {"restart the computer", SYS_reboot, {0, 0, 0, 0}},
           {"ports of the processor", SYS_iopl, {3}},
           {"tables of the processor", SYS_modify_ldt, {0, room, 16}},
           {"poll", SYS_poll, {room, 1, 0}},
           {"change what Landlock lets", SYS_landlock_create_ruleset, {room, 8, 0}}})
    all.push_back(std::move(one));
}

}  // namespace

TEST_CASE("a worker that is taken over is refused everything but its pipes and its memory",
          "[popcutd][takeover]") {
  RunningDaemon popcutd;
  popcutd.open();
  Prey prey{popcutd.daemon().folder() / "prey", popcutd.daemon().pid()};
  fs::create_directories(prey.folder / "empty");
  fs::permissions(prey.folder, fs::perms::all);
  std::ofstream(prey.folder / "precious") << "kept";
  fs::permissions(prey.folder / "precious", fs::perms(0666));

  const std::string design = popcutd.design(slow_svg());
  const auto made = popcutd.api().post("/v1/jobs", {{"design", design}}, "jobs");
  REQUIRE(made);
  const pid_t pid = busy_worker(prey.daemon);
  REQUIRE(pid > 0);
  TakenOver worker(pid);
  if (!worker.why_not().empty()) {
    WARN("skipped: this user may not trace the worker (" << worker.why_not() << ")");
    return;
  }
  REQUIRE(worker.works());
  // What it was left with works, so that a refusal below is one.
  CHECK(worker.call(SYS_getpid) > 0);
  CHECK(worker.call(SYS_brk, {0}) > 0);
  CHECK(worker.call(SYS_write, {2, worker.put("x"), 1}) == 1);

  std::vector<Attempt> attempts;
  against_files(worker, prey, attempts);
  against_processes(worker, prey, attempts);
  against_the_kernel(worker, attempts);
  std::string listed;
  std::size_t refused = 0;
  for (const Attempt& attempt : attempts) {
    const long answer = worker.call(attempt.number, attempt.arguments);
    const bool is_refused = answer == -EPERM;
    refused += is_refused ? 1 : 0;
    listed += fmt::format("  {:<42} {}\n", attempt.text,
                          is_refused ? "refused (EPERM)" : fmt::format("answered {}", answer));
    CAPTURE(attempt.text, answer);
    CHECK(is_refused);
  }
  fmt::print("taken over: {} of {} attempts refused\n{}", refused, attempts.size(), listed);

  CHECK(text_of_file(prey.folder / "precious") == "kept");
  CHECK(std::distance(fs::directory_iterator(prey.folder), fs::directory_iterator()) == 2);
  CHECK(popcutd.get("/v1/meta")["api"] == "v1");

  // The way of another machine: no list holds for it, so it ends the process. Where the kernel has
  // no such calls, they are a fault of the program.
  (void)worker.call(kGetpidOf32Bits, {}, true);
  if (has_calls_of_32_bits()) {
    CHECK(WIFSIGNALED(worker.status()));
    CHECK(WTERMSIG(worker.status()) == SIGSYS);
    fmt::print("  {:<42} killed ({})\n", "call the kernel of 32 bits", strsignal(SIGSYS));
  } else {
    CHECK(WIFSTOPPED(worker.status()));
    CHECK(WSTOPSIG(worker.status()) == SIGSEGV);
    fmt::print("  {:<42} this kernel has no such calls\n", "call the kernel of 32 bits");
  }
  CHECK(popcutd.get("/v1/meta")["api"] == "v1");
}

TEST_CASE("popcutd tells at its start how workers are confined and it is so",
          "[popcutd][takeover]") {
  RunningDaemon popcutd;
  popcutd.open();
  REQUIRE(happens([&] {
    return popcutd.daemon().log().find("workers are confined by: ") != std::string::npos;
  }));
  std::string said = popcutd.daemon().log();
  said.erase(0, said.find("workers are confined by: "));
  said.erase(said.find('\n'));
  INFO(said);
  const auto claims = [&](const char* wall) {
    const std::size_t at = said.find(wall), until = said.find("; not by");
    REQUIRE(at != std::string::npos);
    return at < until;
  };
  RunningDaemon::Json told;
  REQUIRE(happens([&] {
    told = popcutd.get("/v1/meta")["workers"];
    return !told["confined_by"].empty();
  }));
  for (const auto& name : told["confined_by"]) CHECK(claims(name.get<std::string>().c_str()));
  for (const auto& wall : told["not_confined_by"]) {
    CHECK_FALSE(claims(wall["name"].get<std::string>().c_str()));
    CHECK_FALSE(wall["why"].get<std::string>().empty());
  }
  CHECK(told["confined_by"].size() + told["not_confined_by"].size() == 3);

  const std::string design = popcutd.design(slow_svg());
  REQUIRE(popcutd.api().post("/v1/jobs", {{"design", design}}, "jobs"));
  const pid_t pid = busy_worker(popcutd.daemon().pid());
  REQUIRE(pid > 0);
  const std::string status = fmt::format("/proc/{}/status", pid);
  CHECK((line_of(status, "Seccomp:\t") == "2") == claims("seccomp"));
  CHECK((line_of(status, "NSpid:").find("\t1", 2) != std::string::npos) == claims("namespaces"));
  CHECK(line_of(status, "NoNewPrivs:\t") == "1");
}

}  // namespace takeover_test

#endif
