// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/start_popcutd.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "daemon/client/address.hpp"

namespace popcut::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kNotThere = 127;  // as shells say it

// Beside this program, where it is installed or was built; else what PATH finds.
std::string popcutd_program() {
  std::error_code failed;
  const fs::path own = fs::read_symlink("/proc/self/exe", failed);
  if (!failed)
    for (const fs::path& beside :
         {own.parent_path() / "popcutd", own.parent_path().parent_path() / "popcutd" / "popcutd"})
      if (fs::is_regular_file(beside, failed) && ::access(beside.c_str(), X_OK) == 0)
        return beside.string();
  return "popcutd";
}

void onto(int descriptor, int number) {
  if (descriptor == number)
    ::fcntl(descriptor, F_SETFD, 0);  // else it would close with the exec
  else
    ::dup2(descriptor, number);
}

// Becomes the program `words`, with no terminal, and `output` as what it writes to. Does not
// return.
[[noreturn]] void become(const std::vector<std::string>& words, int output) {
  ::setsid();
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  onto(nothing, STDIN_FILENO);
  onto(output, STDOUT_FILENO);
  onto(output, STDERR_FILENO);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::execvp(arguments[0], arguments.data());
  ::_exit(kNotThere);
}

Result<int> open_log(const std::string& path) {
  struct stat found {};
  const bool is_long = ::stat(path.c_str(), &found) == 0 && found.st_size > (1 << 20);
  const int log = ::open(
      path.c_str(),
      O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | (is_long ? O_TRUNC : 0), 0600);
  if (log < 0) return fail(ErrorKind::Unwritable, path, std::strerror(errno));
  return log;
}

}  // namespace

Result<StartedPopcutd> start_popcutd(const std::vector<std::string>& arguments) {
  const std::string folder =
      client::user_state_folder([](const char* name) { return std::getenv(name); });
  if (folder.empty())
    return fail(ErrorKind::Unwritable, "popcutd",
                "has no place for its state, since neither HOME nor XDG_STATE_HOME is set; start "
                "it with --state FOLDER");
  std::error_code failed;
  fs::create_directories(fs::path(folder).parent_path(), failed);
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    return fail(ErrorKind::Unwritable, folder, std::strerror(errno));
  std::vector<std::string> words{popcutd_program()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  StartedPopcutd started{-1, folder + "/popcutd.log"};
  const Result<int> log = open_log(started.log);
  if (!log) return tl::unexpected(log.error());
  started.log_from = ::lseek(*log, 0, SEEK_END);
  started.pid = ::fork();
  if (started.pid == 0) {
    if (::chdir("/") != 0) ::_exit(kNotThere);
    become(words, *log);
  }
  ::close(*log);
  if (started.pid < 0) return fail(ErrorKind::Refused, words.front(), std::strerror(errno));
  return started;
}

bool is_running(const StartedPopcutd& started) {
  int state = 0;
  return ::waitpid(started.pid, &state, WNOHANG) == 0;
}

std::string last_words(const StartedPopcutd& started) {
  std::ifstream log(started.log);
  log.seekg(std::max<std::int64_t>(0, started.log_from));
  std::string last, fault;
  for (std::string line; std::getline(log, line);) {
    if (line.empty()) continue;
    last = line;
    if (line.find(" info: ") == line.npos) fault = line;
  }
  return fault.empty() ? last : fault;
}

bool run_apart(const std::vector<std::string>& words, double seconds) {
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  const pid_t child = ::fork();
  if (child == 0) become(words, nothing);
  ::close(nothing);
  if (child < 0) return false;
  const auto until =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(std::max(0.0, seconds));
  int state = 0;
  while (::waitpid(child, &state, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() >= until) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return WIFEXITED(state) && WEXITSTATUS(state) == 0;
}

}  // namespace popcut::cli
