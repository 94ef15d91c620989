// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include <catch2/catch.hpp>

#include "daemon/planning/worker/confinement.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace confinement_test {

using namespace popcut;
using namespace popcut::testing;
using planning::WorkerWall;

TEST_CASE("Landlock alone lets a worker reach no file and no other process",
          "[daemon][planner][takeover]") {
  const TempFolder temp;
  const std::string file = (temp / "precious").string(), fresh = (temp / "fresh").string();
  write_file(file, "kept");
  // What a child that is held by it alone gets: errno of each attempt, 0 where it succeeds.
  constexpr std::size_t kAttempts = 8;
  constexpr int kNotHere = 3;
  void* const shared =
      ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  auto& answers = *static_cast<std::array<int, kAttempts>*>(shared);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) {
    bool holds = false;
    for (const WorkerWall& wall : planning::confine_worker(false))
      holds = holds || (wall.name == "landlock" && wall.holds());
    if (!holds) ::_exit(kNotHere);
    std::size_t at = 0;
    const auto note = [&](long answer) { answers[at++] = answer < 0 ? errno : 0; };
    note(::open(file.c_str(), O_WRONLY));
    note(::open("/etc/passwd", O_RDONLY));
    note(::unlink(file.c_str()));
    note(::rename(file.c_str(), fresh.c_str()));
    note(::mkdir(fresh.c_str(), 0700));
    note(::symlink(file.c_str(), fresh.c_str()));
    note(::link(file.c_str(), fresh.c_str()));
    note(::ptrace(PTRACE_ATTACH, parent, nullptr, nullptr));
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  if (WEXITSTATUS(status) == kNotHere) {
    WARN("skipped: this kernel has no Landlock");
  } else {
    for (const int answer : answers)
      CHECK((answer == EACCES || answer == EPERM || answer == EMFILE));
    CHECK(answers[2] == EACCES);
    CHECK(answers[7] == EPERM);
  }
  ::munmap(shared, 4096);
  CHECK(text_of_file(file) == "kept");
}

TEST_CASE("what a worker says of its walls is read as it was written", "[daemon][planner]") {
  const std::vector<WorkerWall> walls{{"seccomp", ""}, {"landlock", "the kernel does not have it"}};
  const auto read = planning::read_walls(planning::walls_text(walls));
  REQUIRE(read.size() == 2);
  CHECK(read[0].holds());
  CHECK(read[1].why_not == "the kernel does not have it");
  CHECK(planning::confinement_text(read) ==
        "workers are confined by: seccomp; not by: landlock (the kernel does not have it)");
  CHECK(planning::confinement_text({{"seccomp", "x"}}) ==
        "workers are confined by: nothing; not by: seccomp (x)");
  for (const char* wrong : {"", "seccomp", "seccomp\n", "a b"})
    CHECK(planning::read_walls(wrong).empty());
}

TEST_CASE("a program that does not say how it is confined is an error", "[daemon][planner]") {
  CHECK_FALSE(planning::try_confinement("/bin/true"));
  CHECK_FALSE(planning::try_confinement("/nowhere"));
  const auto walls = planning::try_confinement(worker_program());
  REQUIRE(walls);
  CHECK(walls->size() == 3);
}

}  // namespace confinement_test
