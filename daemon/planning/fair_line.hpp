// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace popcut::daemon {

/// Who waits for a worker, and whose turn it is. Principals take turns, however much each of them
/// asks for; what one of them asks for comes in its order. Something newer of the same principal
/// and key takes the place of what waits. Not for several threads at once.
class FairLine {
 public:
  /// @param most  that wait in all
  /// @param each  that wait of one principal
  FairLine(std::size_t most, std::size_t each) : most_(most), each_(each) {}

  struct Place {
    std::uint64_t id{};
    std::string who;
    std::string key;  ///< empty: nothing takes its place
  };
  struct Added {
    bool is_taken{};                        ///< false: the line is full
    std::optional<std::uint64_t> replaced;  ///< whose place it took
  };
  [[nodiscard]] Added add(Place place);
  /// True if it waited.
  bool remove(std::uint64_t id);
  /// Takes the next one of the principal, among those that `may` begin, whose last turn is the
  /// longest ago.
  [[nodiscard]] std::optional<Place> next(const std::function<bool(const std::string& who)>& may);
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }

 private:
  [[nodiscard]] std::uint64_t last_turn(const std::string& who) const;
  std::size_t most_, each_;
  std::deque<Place> waiting_;
  std::map<std::string, std::uint64_t> turns_;  ///< number of the last turn of each
  std::uint64_t turn_{0};
};

}  // namespace popcut::daemon
