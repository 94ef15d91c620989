// SPDX-License-Identifier: MIT
#include "tests/support/process.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace popcut::testing {
namespace {

namespace fs = std::filesystem;

void limit(int what, long value) {
  if (value < 0) return;
  const rlimit both{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  ::setrlimit(static_cast<__rlimit_resource>(what), &both);
}

void redirect(const char* path, int flags, int to) {
  const int file = ::open(path, flags, 0600);
  if (file < 0 || ::dup2(file, to) < 0) ::_exit(126);
  ::close(file);
}

}  // namespace

TempFolder::TempFolder(Place place) {
  const char* const memory = "/dev/shm";
  const bool in_memory = place == Place::Memory && ::access(memory, W_OK | X_OK) == 0;
  std::string name =
      ((in_memory ? fs::path(memory) : fs::temp_directory_path()) / "popcut-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for temporary files");
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Ran run_program(const std::vector<std::string>& arguments, const fs::path& folder,
                const Limits& limits) {
  const TempFolder said;
  const std::string out = said / "out", err = said / "err";
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const auto begun = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    redirect("/dev/null", O_RDONLY, 0);
    redirect(out.c_str(), O_WRONLY | O_CREAT, 1);
    redirect(err.c_str(), O_WRONLY | O_CREAT, 2);
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    limit(RLIMIT_FSIZE, limits.file_bytes);
#if !defined(__SANITIZE_ADDRESS__)  // whose shadow takes terabytes of addresses
    limit(RLIMIT_AS, limits.memory_bytes);
#endif
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  rusage used{};
  ::wait4(child, &status, 0, &used);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begun;
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  const int exit = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return {exit,
          text_of_file(out),
          text_of_file(err),
          wall.count(),
          seconds(used.ru_utime) + seconds(used.ru_stime),
          used.ru_maxrss};
}

std::string text_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

void write_file(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory() || entry.is_symlink()) {
      names.push_back(entry.path().lexically_relative(folder).string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace popcut::testing
