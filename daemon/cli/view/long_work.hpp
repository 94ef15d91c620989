// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "core/progress.hpp"

namespace popcut::cli {

/// Shows on the terminal what is being done while this exists, once it has taken two seconds: a
/// thread of its own draws, so that the line moves on where the work itself is silent. Without a
/// terminal at standard error it does nothing. Print nothing else meanwhile.
class LongWork {
 public:
  explicit LongWork(bool wanted, std::string_view what = "working");
  ~LongWork();  ///< clears the line
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;

  /// What is being done now, and how far it is (as `Progress`).
  void now(std::string_view what, double done = kUnknownPart);
  /// For those who compute; empty where nothing is shown. Valid while this exists.
  [[nodiscard]] Progress progress();

 private:
  void draw();

  std::mutex mutex_;
  std::condition_variable over_;
  std::string what_;
  double done_{kUnknownPart}, part_begun_{0.0};
  double since_s_{}, part_since_s_{};  ///< monotonic seconds
  bool ended_{false};
  std::thread thread_;
};

}  // namespace popcut::cli
