// SPDX-License-Identifier: MIT
#include "tests/support/at_terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace popcut::testing {

using namespace std::chrono_literals;

AtTerminal::AtTerminal(const std::string& program, const std::vector<std::string>& words,
                       const TempFolder& folder)
    : folder_(folder) {
  int slave = -1;
  if (::openpty(&master_, &slave, nullptr, nullptr, nullptr) != 0)
    throw std::runtime_error("no terminal to be had");
  std::vector<std::string> all{program};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::string config = (folder / "config").string();
  const std::string out = (folder / "out").string();
  child_ = ::fork();
  if (child_ < 0) throw std::runtime_error("cannot fork");
  if (child_ == 0) {
    ::setsid();
    ::ioctl(slave, TIOCSCTTY, 0);
    const int file = ::open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
    ::dup2(slave, STDIN_FILENO);
    ::dup2(slave, STDERR_FILENO);
    ::dup2(file, STDOUT_FILENO);
    ::close(master_);
    ::setenv("XDG_CONFIG_HOME", config.c_str(), 1);
    if (::chdir(folder.path().c_str()) != 0) ::_exit(126);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(slave);
}

AtTerminal::~AtTerminal() {
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  if (master_ >= 0) ::close(master_);
}

bool AtTerminal::shows(const std::string& words) {
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (shown.find(words) == std::string::npos && std::chrono::steady_clock::now() < until)
    if (!read_some()) return shown.find(words) != std::string::npos;
  return shown.find(words) != std::string::npos;
}

void AtTerminal::type(std::string_view words) {
  if (::write(master_, words.data(), words.size()) != static_cast<ssize_t>(words.size()))
    throw std::runtime_error("the terminal takes no keys");
}

void AtTerminal::signal(int number) { ::kill(child_, number); }

void AtTerminal::close() {
  ::close(master_);
  master_ = -1;
}

int AtTerminal::ended() {
  while (read_some()) {
  }
  int status = 0;
  ::waitpid(child_, &status, 0);
  child_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string AtTerminal::first_line() const {
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < until) {
    const std::string text = out();
    if (const std::size_t end = text.find('\n'); end != std::string::npos)
      return text.substr(0, end);
    std::this_thread::sleep_for(10ms);
  }
  return {};
}

bool AtTerminal::read_some() {
  if (master_ < 0) return false;
  pollfd terminal{master_, POLLIN, 0};
  if (::poll(&terminal, 1, 60'000) <= 0) return false;
  std::array<char, 4096> room{};
  const ssize_t count = ::read(master_, room.data(), room.size());
  if (count <= 0) return false;
  shown.append(room.data(), static_cast<std::size_t>(count));
  return true;
}

}  // namespace popcut::testing
