// SPDX-License-Identifier: MIT
#include "core/rigid/propagation.hpp"

namespace popcut::rigid {

void Propagation::hold(std::uint32_t line) {
  work_.push_back(line);
  while (!work_.empty()) {
    const std::uint32_t next = work_.back();
    work_.pop_back();
    if (held_[next] != 0) continue;
    held_[next] = 1;
    for (const std::uint32_t node : section_.folds[next]) {
      if (held_[node] != 0) continue;
      held_[node] = 1;
      for (const std::uint32_t other : section_.folds[node]) reach(other, node);
    }
  }
}

/// A node of a line has become held.
void Propagation::reach(std::uint32_t line, std::uint32_t node) {
  if (held_[line] != 0) return;
  if (first_[line] == kNone) {
    first_[line] = node;
    with_one_node_.push_back(line);
  } else if (section_.offset[first_[line]] != section_.offset[node]) {
    work_.push_back(line);
  }
}

int Propagation::pin(std::uint32_t line) {
  int pins = 0;
  while (!with_one_node_.empty()) {
    const std::uint32_t next = with_one_node_.back();
    with_one_node_.pop_back();
    if (held_[next] != 0) continue;
    ++pins;
    hold(next);
  }
  if (held_[line] != 0) return pins;
  hold(line);
  return pins + 2;
}

}  // namespace popcut::rigid
