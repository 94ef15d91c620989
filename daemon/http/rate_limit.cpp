// SPDX-License-Identifier: MIT
#include "daemon/http/rate_limit.hpp"

#include <algorithm>
#include <cmath>

namespace popcut::daemon::http {
namespace {

// Keys are users, networks and tokens. No more than this many matter at once.
constexpr std::size_t kMostKeys = 4096;
constexpr double kWindow_s = 60;

}  // namespace

void RateLimit::forget_full(double now_s) {
  std::erase_if(buckets_, [&](const auto& entry) {
    return entry.second.left + (now_s - entry.second.since_s) * per_s_ >= burst_;
  });
  if (buckets_.size() >= kMostKeys) buckets_.clear();
}

std::optional<int> RateLimit::take(const std::string& key, double now_s) {
  if (buckets_.size() >= kMostKeys && buckets_.find(key) == buckets_.end()) forget_full(now_s);
  Bucket& bucket = buckets_.try_emplace(key, Bucket{burst_, now_s}).first->second;
  bucket.left = std::min(burst_, bucket.left + std::max(0.0, now_s - bucket.since_s) * per_s_);
  bucket.since_s = now_s;
  if (bucket.left < 1) {
    const double wait_s = per_s_ > 0 ? (1 - bucket.left) / per_s_ : 3600;
    return std::max(1, static_cast<int>(std::ceil(std::min(wait_s, 3600.0))));
  }
  bucket.left -= 1;
  return std::nullopt;
}

std::optional<int> FailedLogins::wait(const std::string& key, double now_s) const {
  const auto found = failures_.find(key);
  if (found == failures_.end()) return std::nullopt;
  const auto recent = std::find_if(found->second.begin(), found->second.end(),
                                   [&](double time) { return now_s - time < kWindow_s; });
  if (found->second.end() - recent < per_minute_) return std::nullopt;
  return std::max(1, static_cast<int>(std::ceil(kWindow_s - (now_s - *recent))));
}

std::optional<int> FailedLogins::note(const std::string& key, double now_s) {
  if (failures_.size() >= kMostKeys && !failures_.contains(key)) {
    std::erase_if(failures_, [&](const auto& entry) {
      return entry.second.empty() || now_s - entry.second.back() >= kWindow_s;
    });
    if (failures_.size() >= kMostKeys) failures_.clear();
  }
  std::deque<double>& times = failures_[key];
  while (!times.empty() && now_s - times.front() >= kWindow_s) times.pop_front();
  if (static_cast<int>(times.size()) >= per_minute_)
    return std::max(1, static_cast<int>(std::ceil(kWindow_s - (now_s - times.front()))));
  times.push_back(now_s);
  return std::nullopt;
}

}  // namespace popcut::daemon::http
