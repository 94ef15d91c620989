// SPDX-License-Identifier: MIT
#include "daemon/model/turns.hpp"

#include <algorithm>
#include <ctime>

namespace popcut::daemon {
namespace {

// More names than there are routes and kinds of work would be a mistake, not more knowledge.
constexpr std::size_t kMostNames = 200;

thread_local std::string current_name;

std::int64_t now_ns(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

void name_turn(std::string_view name, std::string_view more) {
  current_name = name;
  if (more.empty()) return;
  current_name += ' ';
  current_name += more;
}

TurnClock::TurnClock()
    : wall_ns_(now_ns(CLOCK_MONOTONIC)), cpu_ns_(now_ns(CLOCK_THREAD_CPUTIME_ID)) {
  current_name.clear();
}

TurnTime TurnClock::elapsed() const {
  return {static_cast<double>(now_ns(CLOCK_MONOTONIC) - wall_ns_) * 1e-9,
          static_cast<double>(now_ns(CLOCK_THREAD_CPUTIME_ID) - cpu_ns_) * 1e-9};
}

const std::string& TurnClock::name() {
  static const std::string other = "other";
  return current_name.empty() ? other : current_name;
}

void Turns::add(const std::string& name, const TurnTime& time) {
  wall_.add(time.wall_s);
  auto found = longest_.find(name);
  if (found == longest_.end()) {
    if (longest_.size() >= kMostNames) return;
    found = longest_.emplace(name, TurnTime{}).first;
  }
  found->second.wall_s = std::max(found->second.wall_s, time.wall_s);
  found->second.cpu_s = std::max(found->second.cpu_s, time.cpu_s);
}

}  // namespace popcut::daemon
