// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/timing.hpp"

namespace popcut::testing {

/// A popcutd of its own, and the built popcut as its client. The test's program defines
/// popcut_program() and popcutd_program().
struct DaemonWithCli {
  explicit DaemonWithCli(double time_scale = 0, const std::string& more = "")
      : daemon(popcutd_program(), time_scale, more) {
    ::setenv("POPCUT_URL", daemon.socket().c_str(), 1);
    ::unsetenv("POPCUT_TOKEN");
  }
  static constexpr std::chrono::milliseconds kBetweenRuns{50};
  DaemonProcess daemon;

  void open() {
    const bool serves = daemon.start();
    INFO(daemon.log());
    REQUIRE(serves);
  }
  [[nodiscard]] Ran popcut(std::vector<std::string> words) const {
    return popcut_in(daemon.folder(), std::move(words));
  }
  /// Repeats the command until it succeeds; the last run.
  [[nodiscard]] Ran until_done(const std::vector<std::string>& words) const {
    Ran ran;
    (void)comes_true([&] { return (ran = popcut(words)).exit == 0; }, 300, kBetweenRuns);
    return ran;
  }
  [[nodiscard]] nlohmann::json job(const std::string& id) const {
    return nlohmann::json::parse(popcut({"jobs", id, "--json"}).out);
  }
  [[nodiscard]] bool comes_to(const std::string& id, const std::string& state) const {
    return comes_true([&] { return job(id)["state"] == state; }, 300, kBetweenRuns);
  }
  /// The trace of the newest sheet that was cut.
  [[nodiscard]] nlohmann::json trace() const {
    std::filesystem::path newest;
    for (const auto& entry : std::filesystem::directory_iterator(daemon.folder() / "trace"))
      if (entry.path().extension() == ".json" && (newest.empty() || entry.path() > newest))
        newest = entry.path();
    return nlohmann::json::parse(text_of_file(newest));
  }
};

inline std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace popcut::testing
