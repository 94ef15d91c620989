// SPDX-License-Identifier: MIT
#include "tests/support/daemon_process.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>

namespace popcut::testing {
namespace {

using Clock = std::chrono::steady_clock;

/// Only what hangs takes longer, also on a busy machine with sanitizers.
constexpr std::chrono::seconds kPatience(300);

void nap() { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }

}  // namespace

std::string (*DaemonProcess::fleet_section)(std::shared_ptr<void>&){};

DaemonProcess::DaemonProcess(std::string program, double time_scale, const std::string& more,
                             const std::string& device)
    : program_(std::move(program)) {
  const bool joins = fleet_section != nullptr && more.find("[fleet]") == std::string::npos;
  write_file(config(), "listen = [\"127.0.0.1:0\"]\nsocket = \"" + socket() + "\"\nstate = \"" +
                           state() + "\"\n[[device]]\nid = \"" + device +
                           "\"\nmachine = \"cameo3\"\ntime_scale = " + std::to_string(time_scale) +
                           "\ntrace = \"" + (folder_ / "trace").string() + "\"\n" +
                           (joins ? fleet_section(kept_) : std::string()) +
                           "[limits]\nrate_per_s = 100000\nrate_burst = 100000\n" + more);
}

DaemonProcess::~DaemonProcess() {
  if (std::uncaught_exceptions() > 0)  // a test has failed: what popcutd said goes with it
    std::fprintf(stderr, "popcutd's log:\n%s\n", log().c_str());
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
}

bool DaemonProcess::start(const std::vector<std::string>& environment) {
  const std::string log_file = folder_ / "log", file = config();
  ::unlink(log_file.c_str());
  if (pid_ > 0) {  // one that should have ended is not left behind
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  pid_ = ::fork();
  if (pid_ == 0) {
    const int null = ::open("/dev/null", O_RDONLY);
    const int log = ::open(log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (null < 0 || log < 0 || ::dup2(null, 0) < 0 || ::dup2(log, 1) < 0 || ::dup2(log, 2) < 0)
      ::_exit(126);
    ::close_range(3, ~0U, 0);  // what a test listens with is not for popcutd
    for (const std::string& one : environment) ::putenv(const_cast<char*>(one.c_str()));
    ::execl(program_.c_str(), program_.c_str(), "--config", file.c_str(), nullptr);
    ::_exit(127);
  }
  const auto begun = Clock::now();
  while (Clock::now() - begun < kPatience) {
    if (text_of_file(log_file).find("serving at ") != std::string::npos) return true;
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      return false;
    }
    nap();
  }
  return false;
}

void DaemonProcess::signal(int number) const {
  if (pid_ > 0) ::kill(pid_, number);  // -1 would be everybody
}

int DaemonProcess::wait() {
  const auto begun = Clock::now();
  while (pid_ > 0 && Clock::now() - begun < kPatience) {
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    }
    nap();
  }
  return -1;
}

std::string DaemonProcess::url() const {
  const std::string text = log();
  const std::size_t at = text.find("127.0.0.1:");
  const std::size_t end = text.find_first_of(", \n", at);
  return at == std::string::npos ? std::string() : "http://" + text.substr(at, end - at);
}

}  // namespace popcut::testing
