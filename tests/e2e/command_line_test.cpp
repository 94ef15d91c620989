// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/process.hpp"

using namespace popcut::testing;

namespace {

Ran run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), POPCUT_PROGRAM);
  return run_program(arguments, "/");
}

/// An error is one line on standard error that starts with the program's name.
void check_one_line(const Ran& ran) {
  CAPTURE(ran.err);
  CHECK(ran.err.rfind("popcut: ", 0) == 0);
  CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  CHECK(ran.out.empty());
}

}  // namespace

TEST_CASE("the help starts with what popcut is for and the usual example", "[cli][e2e]") {
  const Ran ran = run({"--help"});
  CHECK(ran.exit == 0);
  CHECK(ran.err.empty());
  CHECK(ran.out.rfind("popcut turns", 0) == 0);
  CHECK(ran.out.find("popcut design sphere.json -o sphere") < ran.out.find("Options:"));
}

TEST_CASE("the version is one line", "[cli][e2e]") {
  const Ran ran = run({"--version"});
  CHECK(ran.exit == 0);
  CHECK(ran.out == fmt::format("popcut {}\n", POPCUT_VERSION));
}

TEST_CASE("a wrong command line is one line and exit code 2", "[cli][e2e]") {
  const std::vector<std::vector<std::string>> wrong{{},   {"frobnicate"}, {"--frobnicate"},
                                                    {""}, {"two\nlines"}, {"-q"}};
  for (const auto& arguments : wrong) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.exit == 2);
    check_one_line(ran);
  }
}

TEST_CASE("a name in capitals stays one in a usage error", "[cli][e2e]") {
  const Ran ran = run({"confirm", "X", "1", "maybe"});
  CHECK(ran.exit == 2);
  check_one_line(ran);
  CHECK(ran.err.find("RESULT") != std::string::npos);
}

TEST_CASE("a full standard output is told", "[cli][e2e]") {
  const Ran ran =
      run_program({"/bin/sh", "-c", "exec \"$0\" --help > /dev/full", POPCUT_PROGRAM}, "/");
  CHECK(ran.exit == 7);
  check_one_line(ran);
}
