// SPDX-License-Identifier: MIT
#include "protocol/decode.hpp"

#include <algorithm>
#include <string_view>

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

namespace {

/// Whether a line is a command of G-code: "G1 X10 Y5", "N10 G21", "M3 S255".
bool is_gcode_line(std::string_view line) {
  const auto skip = [&](std::string_view of) {
    const std::size_t n = std::min(line.find_first_not_of(of), line.size());
    line.remove_prefix(n);
    return n;
  };
  skip(" \t");
  if (line.starts_with('N')) {
    line.remove_prefix(1);
    if (skip("0123456789") == 0) return false;
    skip(" \t");
  }
  if (line.empty() || (line[0] != 'G' && line[0] != 'g')) return false;
  line.remove_prefix(1);
  const std::size_t digits = skip("0123456789");
  if (digits == 0 || digits > 3) return false;
  return line.empty() || std::string_view(" \t\rXYZFxyzf.;(").find(line[0]) != line.npos;
}

}  // namespace

std::string foreign_program(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                        std::min<std::size_t>(bytes.size(), 4096));
  const std::size_t first = text.find_first_not_of(" \t\r\n;");
  text.remove_prefix(std::min(first, text.size()));
  if (text.starts_with("\x1b."))
    return fmt::format(
        "begins with ESC.{}, a setting of a pen plotter's serial line, which popcut does not send; "
        "delete all before \"IN;\" and send the rest, which is HPGL",
        text.size() > 2 && text[2] > ' ' && text[2] <= '~' ? text.substr(2, 1) : "");
  if (text.starts_with("\x1b%") || text.starts_with("@PJL") ||
      text.starts_with("\x1b"
                       "E"))
    return "is a print job (PJL or PCL), not a program for a cutter; plot it as HPGL into a file, "
           "or "
           "export the drawing as SVG or DXF";
  std::size_t lines = 0;
  for (std::string_view rest = text; !rest.empty() && lines < 2;) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    if (is_gcode_line(rest.substr(0, end))) ++lines;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (lines >= 2)
    return "is G-code, which no cutter that popcut drives understands; export the drawing as SVG "
           "or "
           "DXF, and use 'popcut plan'";
  return {};
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
