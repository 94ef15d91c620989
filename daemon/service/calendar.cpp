// SPDX-License-Identifier: MIT
#include "daemon/service/calendar.hpp"

#include <algorithm>
#include <cstdlib>

namespace popcut::daemon {
namespace {

constexpr std::int64_t kAhead_ms = 24 * 3'600'000;  // the computer was asleep for so long
constexpr std::int64_t kBack_ms = 3'600'000;
constexpr std::int64_t kKeep_ms = 10 * 60'000;  // between two times that the state is stored

bool is_credible(std::int64_t step_ms) { return step_ms >= -kBack_ms && step_ms <= kAhead_ms; }

}  // namespace

void Calendar::load() {
  at_ms_ = store_.monotonic();
  claimed_ = believed_ = store_.now();
  Rows rows = store_.db().rows("SELECT believed, claimed, held_ms FROM calendar WHERE one=1");
  if (!rows.next()) return;
  const std::int64_t off_ms = claimed_ - rows.integer(1);
  believed_ = rows.integer(0);
  if (!is_credible(off_ms)) return;  // a jump: this clock continues from where it was
  believed_ += off_ms;
  held_ms_ = rows.integer(2);
}

void Calendar::follow() {
  // A fleet uses the clock of its database, which an administrator keeps right.
  if (store_.in_fleet()) {
    believed_ = claimed_ = store_.now();
    return;
  }
  const std::int64_t monotonic = store_.monotonic();
  const TimeMs wall = store_.now();
  const std::int64_t passed = std::max<std::int64_t>(0, monotonic - at_ms_);
  const std::int64_t step = wall - claimed_ - passed;
  at_ms_ = monotonic;
  claimed_ = wall;
  believed_ += passed;
  if (is_credible(step)) {
    believed_ += step;
    held_ms_ += passed;
  } else {
    held_ms_ = 0;
  }
  if (std::abs(wall - believed_) <= kBack_ms) {
    believed_ = wall;
    held_ms_ = 0;
  }
}

TimeMs Calendar::now() {
  follow();
  return believed_;
}

void Calendar::store(TimeMs believed, std::int64_t held_ms) {
  store_.db().put("calendar(one, believed, claimed, held_ms)", "one", 1, believed, claimed_,
                  held_ms);
}

void Calendar::believe() {
  const std::int64_t by = claimed_ - believed_;
  const Answer<void> written = store_.change([&]() -> Answer<void> {
    if (moved) moved(by);
    // In the same transaction, because after a crash in between `moved` would move them again.
    store(claimed_, 0);
    return {};
  });
  if (!written) return;
  believed_ = claimed_;
  held_ms_ = 0;
  kept_at_ms_ = at_ms_;
}

void Calendar::tick() {
  if (store_.in_fleet()) return;
  follow();
  if (claimed_ != believed_ && held_ms_ >= options_.believe_ms) believe();
  if (kept_at_ms_ >= 0 && at_ms_ - kept_at_ms_ < kKeep_ms) return;
  const Answer<void> written = store_.change([&]() -> Answer<void> {
    store(believed_, held_ms_);
    return {};
  });
  if (written) kept_at_ms_ = at_ms_;
}

}  // namespace popcut::daemon
