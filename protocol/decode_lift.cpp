// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "protocol/gpgl_variants.hpp"

namespace popcut {

std::string lift_after(const EncodedProgram& program, std::size_t index) {
  const ByteRange range = program.strokes.at(index);
  if (range.begin == range.end) return {};
  const Result<Program> read = decode(program.dialect, program.view(range));
  if (!read || read->points.empty()) return {};
  // A stroke begins with a move to a point, so that its last point is absolute.
  const MachinePoint end = read->points.back();
  if (program.dialect == Dialect::Gpgl) return fmt::format("M{},{}{}", end.a, end.b, kEtx);
  // In the words of the program itself.
  for (const Command& command : read->commands) {
    if (command.verb != Verb::Move) continue;
    const char first = program.bytes[range.begin + command.begin];
    if (first == 'U') return "U;";
    if (first == 'M') return fmt::format("M{},{};", end.a, end.b);
    break;
  }
  return "PU;";
}

}  // namespace popcut
