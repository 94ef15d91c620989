// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "protocol/program.hpp"

namespace popcut {

/// What both languages skip between commands.
[[nodiscard]] constexpr bool is_blank(unsigned char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// The row of a language's table of commands, null where it has none of that mnemonic.
template <typename Row, std::size_t kRows>
[[nodiscard]] const Row* command_named(const std::array<Row, kRows>& table,
                                       std::string_view mnemonic) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Row& row) { return row.mnemonic == mnemonic; });
  return found == table.end() ? nullptr : &*found;
}

/// Appends a command without points and arguments; a text that is there already is not kept twice.
///
/// @param text        mnemonic, or all bytes of an Unknown; empty where it has none
/// @param begin, end  the bytes it was read from
void append_command(Verb verb, std::string text, std::uint64_t begin, std::uint64_t end,
                    Program& into);

/// Appends a Move or a Draw through points.
///
/// @param coordinates  two a point, machine units; one left over does not count
/// @param relative     each point is counted from the one before
/// @param position     where the tool is; afterwards the last point
void append_points(Verb verb, std::span<const double> coordinates, bool relative,
                   MachinePoint& position, std::uint64_t begin, std::uint64_t end, Program& into);

}  // namespace popcut
