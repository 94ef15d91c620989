// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace popcut {

/// A failure: where (JSON pointer into the FOLD file) and what.
struct VerifyFailure {
  std::string place;
  std::string detail;
};

/// One check of a pattern. It lists the first `kListed` failures and counts the rest.
struct VerifyCheck {
  static constexpr std::size_t kListed = 20;

  std::string name;    ///< stable, so that scripts can look for it
  std::string detail;  ///< the figures, in a sentence
  bool ran{true};      ///< false: the check could not run, and `detail` says why
  std::size_t failed{};
  std::vector<VerifyFailure> failures;

  [[nodiscard]] bool ok() const { return failed == 0; }
  void fail(std::string place, std::string what) {
    ++failed;
    if (failures.size() < kListed) failures.push_back({std::move(place), std::move(what)});
  }
  /// Marks the check as not made, unless it has already found a failure.
  void not_judged(std::string why) {
    if (failed > 0) return;
    ran = false;
    detail = "not checked: " + std::move(why);
  }
};

}  // namespace popcut
