// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>

namespace popcut::daemon::http {

/// Lets each key do `burst` things at once and `per_s` a second in the long run. Time is seconds of
/// any steady clock, given by the caller.
class RateLimit {
 public:
  RateLimit(double per_s, double burst) : per_s_(per_s), burst_(burst) {}
  /// Changes the limits; whatever is left above the new burst is lost.
  void set(double per_s, double burst) { per_s_ = per_s, burst_ = burst; }
  /// Takes one; if none is left, the whole seconds until there is one.
  [[nodiscard]] std::optional<int> take(const std::string& key, double now_s);
  [[nodiscard]] std::size_t size() const { return buckets_.size(); }

 private:
  struct Bucket {
    double left{}, since_s{};
  };
  void forget_full(double now_s);
  double per_s_, burst_;
  std::unordered_map<std::string, Bucket> buckets_;
};

/// Counts failed logins per key over the last minute. A client with a valid token is never locked
/// out by others: only failures are refused.
class FailedLogins {
 public:
  explicit FailedLogins(int per_minute) : per_minute_(per_minute) {}
  void set(int per_minute) { per_minute_ = per_minute; }
  /// Records a failure; seconds to wait if that is one too many.
  [[nodiscard]] std::optional<int> note(const std::string& key, double now_s);
  /// Seconds to wait if another failure would be too many; records nothing.
  [[nodiscard]] std::optional<int> wait(const std::string& key, double now_s) const;

 private:
  int per_minute_;
  std::unordered_map<std::string, std::deque<double>> failures_;
};

}  // namespace popcut::daemon::http
