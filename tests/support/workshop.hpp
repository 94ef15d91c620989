// SPDX-License-Identifier: MIT
// For tests whose target knows popcut_program() and popcutd_program().
#pragma once

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/daemon_process.hpp"
#include "tests/support/paths.hpp"

namespace popcut::testing {

/// A daemon and people who talk with it.
struct Workshop {
  explicit Workshop(double time_scale = 0, const std::string& more = "")
      : daemon(popcutd_program(), time_scale, more) {
    ::setenv("POPCUT_URL", daemon.socket().c_str(), 1);
    ::unsetenv("POPCUT_TOKEN");
  }
  DaemonProcess daemon;

  void open() {
    const bool serves = daemon.start();
    INFO(daemon.log());
    REQUIRE(serves);
  }
  [[nodiscard]] Ran popcut(std::vector<std::string> words) const {
    words.insert(words.begin(), popcut_program());
    return run_program(words, daemon.folder().path());
  }
  [[nodiscard]] Ran until_done(const std::vector<std::string>& words) const {
    const auto begun = std::chrono::steady_clock::now();
    for (;;) {
      Ran ran = popcut(words);
      if (ran.exit == 0 || std::chrono::steady_clock::now() - begun > std::chrono::seconds(60))
        return ran;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  [[nodiscard]] nlohmann::json job(const std::string& id) const {
    return nlohmann::json::parse(popcut({"jobs", id, "--json"}).out);
  }
  [[nodiscard]] bool comes_to(const std::string& id, const std::string& state) const {
    const auto begun = std::chrono::steady_clock::now();
    while (job(id)["state"] != state) {
      if (std::chrono::steady_clock::now() - begun > std::chrono::seconds(60)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return true;
  }
  /// What the simulated knife did, newest sheet.
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
