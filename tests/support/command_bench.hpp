// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing {

/// Runs the built popcut in `folder`. The test's program defines popcut_program().
[[nodiscard]] inline Ran popcut_in(const TempFolder& folder, std::vector<std::string> arguments,
                                   const Limits& limits = {}) {
  arguments.insert(arguments.begin(), popcut_program());
  return run_program(arguments, folder.path(), limits);
}

/// The built popcut in a folder of its own.
struct CommandBench {
  TempFolder temp;

  [[nodiscard]] Ran popcut(std::vector<std::string> arguments, const Limits& limits = {}) const {
    return popcut_in(temp, std::move(arguments), limits);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (temp / name).string(); }
  [[nodiscard]] nlohmann::json read_json(const std::string& name) const {
    return nlohmann::json::parse(text_of_file(temp / name));
  }
  void write(const std::string& name, const nlohmann::json& value) const {
    write_file(temp / name, value.dump());
  }
};

/// An error: `exit`, and one line on standard error that begins with "popcut: " and contains
/// `part`.
inline void check_refused(const Ran& ran, int exit, const std::string& part) {
  CAPTURE(ran.err, part);
  CHECK(ran.exit == exit);
  CHECK(ran.err.rfind("popcut: ", 0) == 0);
  CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  CHECK(says(ran.err, part));
}

/// The same for an error at `place`, which prints nothing on standard output.
inline void check_refused_at(const Ran& ran, int exit, const std::string& place) {
  check_refused(ran, exit, place);
  CHECK(ran.err.rfind("popcut: " + place, 0) == 0);
  CHECK(ran.out.empty());
}

}  // namespace popcut::testing
