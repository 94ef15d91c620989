// SPDX-License-Identifier: MIT
#include "daemon/planning/fair_line.hpp"

#include <algorithm>
#include <utility>

namespace popcut::daemon {
namespace {

constexpr std::size_t kMostKnown = 1000;  // principals whose last turn is remembered

}  // namespace

FairLine::Added FairLine::add(Place place) {
  const auto is_same = [&](const Place& one) {
    return !place.key.empty() && one.key == place.key && one.who == place.who;
  };
  if (const auto older = std::find_if(waiting_.begin(), waiting_.end(), is_same);
      older != waiting_.end()) {
    const std::uint64_t replaced = older->id;
    *older = std::move(place);
    return {true, replaced};
  }
  const auto own = std::count_if(waiting_.begin(), waiting_.end(),
                                 [&](const Place& one) { return one.who == place.who; });
  if (waiting_.size() >= most_ || static_cast<std::size_t>(own) >= each_) return {};
  waiting_.push_back(std::move(place));
  return {true, std::nullopt};
}

bool FairLine::remove(std::uint64_t id) {
  return std::erase_if(waiting_, [&](const Place& one) { return one.id == id; }) > 0;
}

std::uint64_t FairLine::last_turn(const std::string& who) const {
  const auto found = turns_.find(who);
  return found == turns_.end() ? 0 : found->second;
}

std::optional<FairLine::Place> FairLine::next(
    const std::function<bool(const std::string& who)>& may) {
  auto best = waiting_.end();
  for (auto one = waiting_.begin(); one != waiting_.end(); ++one)
    if ((best == waiting_.end() || last_turn(one->who) < last_turn(best->who)) && may(one->who))
      best = one;
  if (best == waiting_.end()) return std::nullopt;
  Place place = std::move(*best);
  waiting_.erase(best);
  if (turns_.size() >= kMostKnown) turns_.clear();
  turns_[place.who] = ++turn_;
  return place;
}

}  // namespace popcut::daemon
