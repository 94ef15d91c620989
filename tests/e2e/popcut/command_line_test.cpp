// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace command_line_test {

using namespace popcut::testing;

namespace {

Ran run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), popcut_program());
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

TEST_CASE("every help keeps to a hundred columns and sums up in one sentence", "[cli][e2e]") {
  const auto lines_of = [](const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      lines.push_back(text.substr(at, end - at));
      at = end + 1;
    }
    return lines;
  };
  const auto all = lines_of(run({"--help"}).out);
  auto line = std::find(all.begin(), all.end(), "Subcommands:");
  REQUIRE(line != all.end());
  int commands = 0;
  for (++line; line != all.end() && !line->empty(); ++line, ++commands) {
    CAPTURE(*line);
    CHECK(line->size() <= 100);
    CHECK(line->back() == '.');
    const std::string name = line->substr(2, line->find(' ', 2) - 2);
    const Ran help = run({name, "--help"});
    CHECK(help.exit == 0);
    for (const std::string& one : lines_of(help.out)) {
      CAPTURE(one);
      CHECK(one.size() <= 100);
    }
  }
  CHECK(commands > 25);
}

TEST_CASE("the version is one line", "[cli][e2e]") {
  const Ran ran = run({"--version"});
  CHECK(ran.exit == 0);
  CHECK(ran.out == fmt::format("popcut {}\n", popcut_version()));
}

TEST_CASE("a wrong command line gives one line and exit code 2", "[cli][e2e]") {
  const std::vector<std::vector<std::string>> wrong{{},   {"frobnicate"}, {"--frobnicate"},
                                                    {""}, {"two\nlines"}, {"-q"}};
  for (const auto& arguments : wrong) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.exit == 2);
    check_one_line(ran);
  }
}

TEST_CASE("a usage error keeps names in capitals", "[cli][e2e]") {
  const Ran ran = run({"confirm", "X", "1", "maybe"});
  CHECK(ran.exit == 2);
  check_one_line(ran);
  CHECK(ran.err.find("RESULT") != std::string::npos);
}

TEST_CASE("a wrong value is reported with its option and the valid values", "[cli][e2e]") {
  using Words = std::vector<std::string>;
  const std::vector<std::pair<Words, std::string>> wrong{
      {{"cut", "x", "--copies", "0"}, "--copies: is \"0\"; give a whole number from 1 to 1000"},
      {{"cut", "x", "--priority", "1.5"},
       "--priority: is \"1.5\"; give a whole number from -10 to 10"},
      {{"arm", "01J", "0"}, "SHEET: is \"0\"; give a whole number from 1 to 10000"},
      {{"arm", "01J", "1", "--blank", "-1"}, "--blank: is \"-1\"; give a whole number from 1"},
      {{"resume", "01J", "--from", "x"}, "--from: is \"x\"; give a whole number from 0 to"},
      {{"events", "--after", "-1"}, "--after: is \"-1\"; give a whole number from 0 to"},
      {{"token", "create", "--role", "operater"},
       "--role: is \"operater\"; did you mean operator?"},
      {{"confirm", "01J", "1", "maybe"}, "RESULT: is \"maybe\"; one of good, bad"},
      {{"design", "x", "-o", "y", "--frames", "0"},
       "--frames: is \"0\"; give a whole number from 1 to 10000"},
      {{"design", "x", "-o", "y", "--from-psi", "4"},
       "--from-psi: is \"4\"; give an angle from 0 (closed) to pi (flat); for 4 degrees, give "
       "4deg"},
      {{"design", "x", "-o", "y", "--to-psi", "90"},
       "--to-psi: is \"90\"; give an angle from 0 (closed) to pi (flat); for 90 degrees, give "
       "90deg"},
      {{"design", "x", "-o", "y", "--to-psi", "190"},
       "--to-psi: is \"190\"; give an angle from 0 (closed) to pi (flat)\n"},
      {{"design", "x", "-o", "y", "--fold-frames", "9"}, "--fold-frames: "},
      {{"plan", "x", "-o", "y", "--seed", "-1"}, "--seed: is \"-1\"; give a whole number from 0"},
      {{"plan", "x", "-o", "y", "--effort", "nan"},
       "--effort: is \"nan\"; give a number from 0.01 to 1000"},
      {{"plan", "x", "-o", "y", "--curve-tolerance", "0"},
       "--curve-tolerance: is \"0\"; give a number from 0.001 to 1 (mm)"},
      {{"plan", "x", "-o", "y", "--seam-x", "a"},
       "--seam-x: is \"a\"; give numbers with commas between (mm)"},
      {{"verify", "x", "--dof", "-1"}, "--dof: is \"-1\"; give a whole number from 0"},
      {{"simulate", "x", "-o", "y", "--sheet", "0"}, "--sheet: is \"0\"; give a whole number"},
      {{"simulate", "--pty", "--speedup", "0"}, "--speedup: is \"0\"; give a number from"},
      {{"arm", ""}, "JOB: is empty; give a value or leave it out"},
      {{"arm", "01J", "1", "--device", ""}, "--device: is empty"},
      {{"move", "01J", "--before", ""}, "--before: is empty"},
      {{"jobs", ""}, "JOB: is empty"},
      {{"cut", "x", "--material", ""}, "--material: is empty"},
      {{"token", "create", "--role", "admin", "--name", ""}, "--name: is empty"},
      {{"usage", "--from", ""}, "--from: is empty"},
      {{"plan", "x", "-o", ""}, "--output: is empty"},
      {{"change", "", "--name", "x"}, "JOB: is empty"},
      {{"curvature", "solve", "--K", "x"}, "--K: is \"x\"; give a number"}};
  for (const auto& [arguments, words] : wrong) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.exit == 2);
    check_one_line(ran);
    CHECK(ran.err.rfind("popcut: " + words, 0) == 0);
  }
}

TEST_CASE("a mistyped word gets the nearest valid one suggested", "[cli][e2e]") {
  using Words = std::vector<std::string>;
  const std::vector<std::pair<Words, std::string>> wrong{
      {{"cutt", "x"}, "'cutt' is not a command; did you mean cut?"},
      {{"frobnicate"}, "'frobnicate' is not a command; one of design, deploy,"},
      {{"design", "--fames", "3", "x"}, "'--fames' is not an option; did you mean --frames?"},
      {{"jobs", "--jsn"}, "'--jsn' is not an option; did you mean --json?"},
      {{"jobs", "a", "b"}, "'b' is one argument too many; see 'popcut jobs --help'"},
      {{"db", "bakup"}, "'bakup' is not a command; did you mean backup?"},
      {{"db"}, "'popcut db' needs a command; one of backup, check, salvage"},
      {{"token"}, "'popcut token' needs a command; one of create, list, sessions, delete"}};
  for (const auto& [arguments, words] : wrong) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.exit == 2);
    check_one_line(ran);
    CHECK(ran.err.rfind("popcut: command line: " + words, 0) == 0);
    CHECK(ran.err.find("help-page") == std::string::npos);  // for packages only
  }
}

TEST_CASE("the help of a command that does not exist is refused", "[cli][e2e]") {
  using Words = std::vector<std::string>;
  const std::vector<std::pair<Words, std::string>> wrong{
      {{"layout", "--help"}, "'layout' is not a command; one of design, deploy,"},
      {{"--help", "layout"}, "'layout' is not a command; one of design, deploy,"},
      {{"desing", "-h"}, "'desing' is not a command; did you mean design?"},
      {{"db", "bakup", "--help"}, "'bakup' is not a command; did you mean backup?"}};
  for (const auto& [arguments, words] : wrong) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.exit == 2);
    check_one_line(ran);
    CHECK(ran.err.rfind("popcut: command line: " + words, 0) == 0);
  }
  for (const Words& arguments : {Words{"--help", "design"}, Words{"db", "backup", "--help"},
                                 Words{"verify", "x", "y", "--help"}, Words{"--json", "-h"},
                                 Words{"--machine", "x", "--help"}}) {
    CAPTURE(arguments);
    const Ran ran = run(arguments);
    CHECK(ran.exit == 0);
    CHECK(ran.err.empty());
    CHECK(ran.out.find("Usage: popcut") != std::string::npos);
  }
  const Ran version = run({"--version", "layout"});
  CHECK(version.exit == 0);
  CHECK(version.err.empty());
  CHECK(version.out.rfind("popcut ", 0) == 0);
}

TEST_CASE("a full standard output is reported", "[cli][e2e]") {
  for (const char* words : {"--help", "machines", "design --schema", "design --example sphere"}) {
    CAPTURE(words);
    const Ran ran = run_program(
        {"/bin/sh", "-c", "exec \"$0\" " + std::string(words) + " > /dev/full", popcut_program()},
        "/");
    CHECK(ran.exit == 7);
    check_one_line(ran);
  }
}

}  // namespace command_line_test
