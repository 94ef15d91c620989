// SPDX-License-Identifier: MIT
// A worker that tells what it has, or misbehaves as none may; the design says how.
#include <dirent.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "daemon/planning/frames.hpp"
#include "daemon/planning/task_json.hpp"

using namespace popcut::planning;

namespace {

void send(FrameKind kind, const std::string& name, const std::string& bytes) {
  const std::string all = frame_head(kind, name, bytes.size()) + bytes;
  if (::write(STDOUT_FILENO, all.data(), all.size()) < 0) std::_Exit(9);
}

std::string outcome() { return outcome_json({.design_kind = "svg"}); }

/// What a worker has and may do, as text.
std::string surroundings() {
  std::ostringstream text;
  text << "fds:";
  if (DIR* folder = ::opendir("/proc/self/fd")) {
    const std::string own = std::to_string(::dirfd(folder));
    while (const dirent* entry = ::readdir(folder))
      if (entry->d_name[0] != '.' && entry->d_name != own) text << ' ' << entry->d_name;
    ::closedir(folder);
  }
  text << "\nenvironment:";
  for (char** word = environ; *word != nullptr; ++word) text << ' ' << *word;
  text << "\n";
  for (const auto& [name, resource] : {std::pair{"cpu", RLIMIT_CPU},
                                       {"as", RLIMIT_AS},
                                       {"fsize", RLIMIT_FSIZE},
                                       {"core", RLIMIT_CORE},
                                       {"nofile", RLIMIT_NOFILE}}) {
    rlimit limit{};
    ::getrlimit(resource, &limit);
    text << name << ": " << limit.rlim_cur << "\n";
  }
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("NoNewPrivs", 0) == 0 || line.rfind("SigBlk", 0) == 0 ||
        line.rfind("SigIgn", 0) == 0)
      text << line << "\n";
  return text.str();
}

[[noreturn]] void misbehave(const std::string& word) {
  if (word == "surroundings") {
    send(FrameKind::File, "surroundings.txt", surroundings());
    send(FrameKind::Outcome, "", outcome());
    std::_Exit(0);
  }
  if (word == "garbage") send(FrameKind::File, "a", "b"), send(FrameKind::Task, "", "{}");
  if (word == "no head") std::printf("Segmentation fault, and more words\n"), std::fflush(stdout);
  if (word == "path") send(FrameKind::File, "../../etc/passwd", "x");
  if (word == "twice") send(FrameKind::File, "a", "1"), send(FrameKind::File, "a", "2");
  if (word == "promise") {
    const std::string head = frame_head(FrameKind::File, "a", std::uint64_t{1} << 60);
    if (::write(STDOUT_FILENO, head.data(), head.size()) < 0) std::_Exit(9);
  }
  if (word == "flood") {
    const std::string much(1u << 20, 'x');
    for (int k = 0;; ++k) send(FrameKind::File, "f" + std::to_string(k), much);
  }
  if (word == "nonsense") send(FrameKind::Outcome, "", "{\"design_kind\": 7}");
  if (word == "deep") send(FrameKind::Outcome, "", std::string(100'000, '['));
  if (word == "dies") std::fputs("first\n\x1b[31mlast words\n", stderr), __builtin_trap();
  if (word == "sleeps")
    for (;;) ::pause();
  if (word == "tells") {
    for (const char* phase : {"no json", "[]", R"({"doing":"x"})",
                              R"({"doing":"cutting","done":7})", R"({"doing":"","done":0})"})
      send(FrameKind::Phase, "", phase);
    for (int k = 0; k < 10'000; ++k)
      send(FrameKind::Phase, "", R"({"doing":"reading \u001b[31m\u00e9<b>","done":0.5})");
    ::usleep(600'000);
    send(FrameKind::Outcome, "", outcome());
    std::_Exit(0);
  }
  if (word == "eats") {
    constexpr std::size_t kMuch = std::size_t{160} << 20, kPage = 4096;
    auto* const bytes = static_cast<volatile char*>(std::malloc(kMuch));
    for (std::size_t at = 0; bytes != nullptr && at < kMuch; at += kPage) bytes[at] = 1;
    for (;;) ::pause();
  }
  if (word == "naps") {
    ::usleep(400'000);
    send(FrameKind::Outcome, "", outcome());
    std::_Exit(0);
  }
  if (word == "spins") {
    std::atomic<std::uint64_t> k{0};
    for (;;) ++k;
  }
  if (word == "lingers") {  // an answer, and then it stays
    send(FrameKind::Outcome, "", outcome());
    ::close(STDOUT_FILENO);
    for (;;) ::pause();
  }
  std::_Exit(5);
}

}  // namespace

int main() {
  FrameReader reader(std::uint64_t{1} << 32);
  std::string design;
  bool go = false;
  char block[4096];
  while (!go) {
    const ssize_t got = ::read(STDIN_FILENO, block, sizeof block);
    if (got <= 0) std::_Exit(7);
    const auto fed = reader.feed(std::string_view(block, static_cast<std::size_t>(got)),
                                 [&](Frame frame) -> popcut::Result<void> {
                                   if (frame.kind == FrameKind::Design) design = frame.bytes;
                                   go = go || frame.kind == FrameKind::Go;
                                   return {};
                                 });
    if (!fed) std::_Exit(7);
  }
  misbehave(design);
}
