// SPDX-License-Identifier: MIT
#include "device/session/pace.hpp"

#include <algorithm>
#include <cmath>

#include "device/port/transport.hpp"

namespace popcut {
namespace {

constexpr double kMostDoubtS = 1.2;    // of the position, before the machine is waited for
constexpr double kMostMotionS = 12;    // between two rests
constexpr double kLeastMotionS = 0.3;  // shorter motion says nothing about speed
constexpr double kForget = 0.7;        // weight of what was seen before the last rest
constexpr double kModelError = 0.04;   // a model fits no two drawings equally well
constexpr double kRestError = 0.15;    // s: what settling at a rest may add
constexpr double kSlowest = 0.1, kFastest = 10;

}  // namespace

void Pace::start(Time now, double at_s) {
  now_ = since_ = now;
  at_ = least_ = most_ = since_s_ = at_s;
  undisturbed_ = true;
}

void Pace::advance(Time now, double sent_s) {
  const double passed = std::max(to_seconds(now - now_), 0.0);
  now_ = now;
  const auto moved = [&](double from, double rate) {
    return std::max(from, std::min(from + rate * passed, sent_s));
  };
  at_ = moved(at_, rate_);
  least_ = moved(least_, slow_);
  most_ = moved(most_, fast_);
}

void Pace::stand_still(Time now) {
  now_ = now;
  undisturbed_ = false;
}

void Pace::rest(Time now, Time earliest, double at_s, bool waited) {
  const double least_real = to_seconds(earliest - since_);
  const double most_real = to_seconds(now - since_);
  const double real = std::max(0.5 * (least_real + most_real), 1e-3);
  const double motion = at_s - since_s_;
  if (measured_ && undisturbed_ && motion > kLeastMotionS) {
    const double seen = std::clamp(motion / real, kSlowest, kFastest);
    if (!waited || seen > rate_) {
      seen_model_s_ = kForget * seen_model_s_ + motion;
      seen_real_s_ = kForget * seen_real_s_ + real;
      const double before = rate_;
      const bool first = seen_model_s_ == motion;
      rate_ = waited ? seen : std::clamp(seen_model_s_ / seen_real_s_, kSlowest, kFastest);
      const double reading = (0.5 * (most_real - least_real) + kRestError) / seen_real_s_;
      const double surprise = first ? 0.0 : std::abs(seen / before - 1);
      const double error = std::min(kModelError + reading + 0.5 * surprise, 0.5);
      slow_ = rate_ * (1 - error);
      fast_ = rate_ * (1 + error) * (waited ? 1.5 : 1.0);
    }
  }
  start(now, at_s);
}

bool Pace::sync_due() const {
  return measured_ && (most_ - least_ > kMostDoubtS || at_ - since_s_ > kMostMotionS * rate_);
}

}  // namespace popcut
