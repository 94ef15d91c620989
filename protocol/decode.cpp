// SPDX-License-Identifier: MIT
#include "protocol/decode.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "protocol/command_reader.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 28;

template <typename Reader>
Program read_all(std::span<const std::byte> bytes) {
  Program program;
  Reader reader;
  reader.feed(bytes, program);
  reader.finish(program);
  return program;
}

/// Bytes of Unknown commands, without one that the end cut off.
std::uint64_t unknown_bytes(const Program& program) {
  std::uint64_t sum = 0;
  for (const Command& command : program.commands)
    if (command.verb == Verb::Unknown) sum += command.end - command.begin;
  if (program.truncated) sum -= program.commands.back().end - program.commands.back().begin;
  return sum;
}

}  // namespace

Result<Program> decode(Dialect dialect, std::span<const std::byte> bytes) {
  if (bytes.size() > kMostBytes)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("the program has {} bytes; it must have at most {}", bytes.size(), kMostBytes));
  return dialect == Dialect::Gpgl ? read_all<GpglReader>(bytes) : read_all<HpglReader>(bytes);
}

Dialect guess_dialect(std::span<const std::byte> bytes) {
  const auto head = bytes.first(std::min<std::size_t>(bytes.size(), 4096));
  const Program gpgl = read_all<GpglReader>(head);
  const Program hpgl = read_all<HpglReader>(head);
  const auto understood = [](const Program& program) {
    return program.commands.size() > (program.truncated ? 1U : 0U);
  };
  if (understood(gpgl) != understood(hpgl)) return understood(hpgl) ? Dialect::Hpgl : Dialect::Gpgl;
  return unknown_bytes(hpgl) < unknown_bytes(gpgl) ? Dialect::Hpgl : Dialect::Gpgl;
}

}  // namespace popcut
