// SPDX-License-Identifier: MIT
#include "protocol/append.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace popcut {

void append_command(Verb verb, std::string text, std::uint64_t begin, std::uint64_t end,
                    Program& into) {
  std::uint32_t index = 0;
  if (!text.empty()) {
    // The same few mnemonics come again and again; Unknown texts need no search.
    constexpr std::size_t kSearched = 64;
    const std::size_t searched = verb == Verb::Unknown ? 0 : std::min(into.texts.size(), kSearched);
    const auto known = std::find(into.texts.begin(),
                                 into.texts.begin() + static_cast<std::ptrdiff_t>(searched), text);
    index = static_cast<std::uint32_t>(known - into.texts.begin());
    if (index == searched) {
      index = static_cast<std::uint32_t>(into.texts.size());
      into.texts.push_back(std::move(text));
    }
  }
  into.commands.push_back({verb, 0, 0, begin, end, index});
}

void append_points(Verb verb, std::span<const double> coordinates, bool relative,
                   MachinePoint& position, std::uint64_t begin, std::uint64_t end, Program& into) {
  const auto first = static_cast<std::uint32_t>(into.points.size());
  for (std::size_t k = 0; k + 1 < coordinates.size(); k += 2) {
    const MachinePoint from = relative ? position : MachinePoint{};
    position = {from.a + coordinates[k], from.b + coordinates[k + 1]};
    into.points.push_back(position);
  }
  into.commands.push_back(
      {verb, first, static_cast<std::uint32_t>(coordinates.size() / 2), begin, end, 0});
}

}  // namespace popcut
