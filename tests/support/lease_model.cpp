// SPDX-License-Identifier: MIT
#include "tests/support/lease_model.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace popcut::testing {
namespace {

using namespace lease;

/// Which states were seen, as 64 bits of each: of 10^7 states two are taken for one with a
/// probability of 3 in a million.
class Seen {
 public:
  static constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();

  Seen() : slots_(1U << 16) {}

  /// The number of the state; kNew: it had none, and now has `number`.
  std::uint32_t number(const World& world, std::uint32_t number) {
    if (2 * count_ >= slots_.size()) grow();
    Slot& slot = find(digest(world));
    if (slot.digest != 0) return slot.number;
    slot = {digest(world), number};
    ++count_;
    return kNew;
  }

 private:
  struct Slot {
    std::uint64_t digest{};  ///< 0: free
    std::uint32_t number{};
  };
  static std::uint64_t digest(const World& world) {
    std::array<std::uint64_t, (sizeof(World) + 7) / 8> words{};
    std::memcpy(words.data(), &world, sizeof(World));
    std::uint64_t sum = 0x9e3779b97f4a7c15;
    for (const std::uint64_t word : words) {
      sum = (sum ^ word) * 0xff51afd7ed558ccd;
      sum ^= sum >> 32U;
    }
    sum *= 0xc4ceb9fe1a85ec53;
    sum ^= sum >> 29U;
    return sum == 0 ? 1 : sum;
  }
  Slot& find(std::uint64_t digest) {
    std::size_t at = digest & (slots_.size() - 1);
    while (slots_[at].digest != 0 && slots_[at].digest != digest)
      at = (at + 1) & (slots_.size() - 1);
    return slots_[at];
  }
  void grow() {
    std::vector<Slot> before(2 * slots_.size());
    before.swap(slots_);
    for (const Slot& slot : before)
      if (slot.digest != 0) find(slot.digest) = slot;
  }

  std::vector<Slot> slots_;
  std::size_t count_{0};
};

class Search {
 public:
  Search(const Bounds& bounds, Flaw flaw) : bounds_(bounds), flaw_(flaw) {}

  Exploration run() {
    World first = first_world();
    tidy(first);
    add(first, {Do::Begin0}, 0);
    while (!next_.empty() && found_.wrong.empty()) {
      const std::vector<World> level = std::exchange(next_, {});
      for (const World& world : level) {
        if (!found_.wrong.empty()) break;
        expand(world);
      }
      ++found_.depth;
      if (ways_.size() > bounds_.states) break;
    }
    found_.whole = next_.empty();
    found_.states = ways_.size();
    if (found_.wrong.empty() && found_.whole) look_for_ends();
    return found_;
  }

 private:
  /// How a state was reached, and the next one on the way that heals.
  struct Way {
    std::uint32_t from{}, healing{};
    Step step{};
  };
  static constexpr std::uint32_t kNone = Seen::kNew;
  static constexpr std::uint32_t kEnded = kNone - 1;

  std::uint32_t add(const World& world, const Step& step, std::uint32_t from) {
    ++found_.steps;
    const auto number = static_cast<std::uint32_t>(ways_.size());
    if (const std::uint32_t known = seen_.number(world, number); known != Seen::kNew) return known;
    if (step.what == Do::Recovers) ++found_.recoveries;
    ways_.push_back({from, has_ended(world) ? kEnded : kNone, step});
    next_.push_back(world);
    if (const char* const broken = broken_rule(world); broken != nullptr && found_.wrong.empty())
      fail(broken, number);
    return number;
  }

  void expand(const World& world) {
    const auto from = expanded_++;
    Do best = kLastHealing;
    each_step(world, bounds_, flaw_, [&](const Step& step, World& to, const char* broken) {
      if (!found_.wrong.empty()) return;
      const std::uint32_t number = add(to, step, from);
      if (broken != nullptr && found_.wrong.empty()) {
        ways_.push_back({from, kNone, step});
        return fail(broken, static_cast<std::uint32_t>(ways_.size() - 1));
      }
      Way& way = ways_[from];
      if (way.healing == kEnded || number == from || step.what > best) return;
      if (way.healing != kNone && step.what == best) return;
      best = step.what;
      way.healing = number;
    });
  }

  void fail(const char* broken, std::uint32_t number) {
    found_.wrong = broken;
    for (std::uint32_t at = number;; at = ways_[at].from) {
      found_.path.push_back(sentence(ways_[at].step));
      if (at == 0) break;
    }
    std::reverse(found_.path.begin(), found_.path.end());
  }

  // Follows the healing steps of each state to where the job has ended.
  void look_for_ends() {
    std::vector<std::uint8_t> ends(
        ways_.size());  // 1: on the way that is being followed, 2: it does
    std::vector<std::uint32_t> trail;
    for (std::uint32_t start = 0; start < ways_.size(); ++start) {
      std::uint32_t at = start;
      trail.clear();
      while (at < kEnded && ends[at] == 0) {
        ends[at] = 1;
        trail.push_back(at);
        at = ways_[at].healing;
      }
      if (at == kNone || (at < kEnded && ends[at] == 1)) {
        fail("there is no way to the end of the job", start);
        found_.path.emplace_back(
            "... and then, without another fault and with a person who skips:");
        for (std::size_t i = 1; i < trail.size(); ++i)
          found_.path.push_back(sentence(ways_[trail[i]].step));
        return;
      }
      for (const std::uint32_t one : trail) ends[one] = 2;
    }
  }

  Bounds bounds_;
  Flaw flaw_;
  Seen seen_;
  std::vector<Way> ways_;
  std::vector<World> next_;
  std::uint32_t expanded_{0};
  Exploration found_;
};

}  // namespace

Exploration explore_leases(const Bounds& bounds, Flaw flaw) { return Search(bounds, flaw).run(); }

}  // namespace popcut::testing
