// SPDX-License-Identifier: MIT
// Cutters: their programs and replies, the simulated one, tables of machines and fault scripts.
#include <string>

#include "core/machines/machine.hpp"
#include "device/sim/sim_faults.hpp"
#include "device/sim/simulate.hpp"
#include "protocol/command_reader.hpp"
#include "protocol/decode.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/other_replies.hpp"

namespace popcut::fuzzing {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// What must hold of a program read from any bytes: its indices are in range and its memory is
/// bounded by the input.
void check_sound(const Program& program, std::size_t bytes) {
  std::size_t text = 0;
  for (const Command& command : program.commands) {
    demand(command.begin < command.end && command.end <= bytes);
    const bool way = command.verb == Verb::Move || command.verb == Verb::Draw;
    const std::uint64_t last = std::uint64_t{command.first} + command.count;
    demand(last <= (way ? program.points.size() : program.args.size()));
    if (!way && command.verb != Verb::Empty) demand(command.text < program.texts.size());
  }
  for (const std::string& one : program.texts) text += one.size();
  demand(program.commands.size() <= bytes && program.points.size() <= bytes);
  demand(program.args.size() <= bytes && text <= 2 * bytes);
}

/// Reads the text whole and in two pieces: both must be sound and equal.
template <typename Reader>
void program(std::string_view text) {
  const std::span<const std::byte> bytes = bytes_of(text);
  Program whole, parted;
  Reader one, two;
  one.feed(bytes, whole);
  one.finish(whole);
  const std::size_t cut =
      bytes.empty() ? 0 : std::to_integer<std::size_t>(bytes[0]) % (bytes.size() + 1);
  two.feed(bytes.first(cut), parted);
  two.feed(bytes.subspan(cut), parted);
  two.finish(parted);
  check_sound(whole, bytes.size());
  demand(whole.truncated == parted.truncated && listing(whole) == listing(parted));
  const PenMoves pen = moves(whole);
  std::size_t points = 0;
  for (const PenStroke& stroke : pen.strokes) points += stroke.count;
  demand(points == pen.points.size());
}

void replies(std::string_view reply) {
  const DeviceStatus status = parse_status(reply);
  demand(!name_of(status).empty());
  // Only one character, blanks around it, may ever mean ready.
  if (status == DeviceStatus::Ready)
    demand(reply.find_first_not_of(" 0\x03") == std::string_view::npos);
  if (const auto identity = parse_identity(reply))
    demand(!identity->model.empty() && identity->model.size() <= 64);
  for (const bool is_valid : {parse_pair(reply).has_value(), parse_number(reply).has_value(),
                              parse_position(reply).has_value(), parse_tools(reply).has_value()})
    if (is_valid) demand(reply.size() <= 64);
  if (const auto tools = parse_tools(reply))
    for (const int code : *tools) demand(!tool_name(code).empty());
}

/// The simulated cutter in both languages: it must come to rest and not draw a line twice as long.
void sim_cutter(std::string_view bytes) {
  static const Machine gpgl = *find_machine("cameo3");
  static const Machine hpgl = *find_machine("hpgl-generic");
  if (bytes.empty()) return;
  const auto first = static_cast<unsigned char>(bytes[0]);
  Machine machine = first % 2 == 0 ? gpgl : hpgl;
  machine.buffer_bytes = 1U + first;
  const auto trace = simulate(bytes_of(bytes), machine);
  if (!trace) return;
  demand(std::isfinite(trace->seconds) && trace->seconds >= 0);
  demand(trace->clipped_mm <= trace->cut_mm * (1 + 1e-9) + 1e-6);
  demand(trace->points.size() <= 2 * bytes.size());
}

/// A user's own table of machines and materials, and a fault script: refused with a reason, or with
/// figures that a plan can be made of.
void tables(std::string_view bytes) {
  const std::string text(bytes);
  (void)accepted(all_machines({text}));
  if (const auto materials = all_materials({text}); accepted(materials))
    for (const Material& one : *materials)
      demand(!one.name.empty() && one.blade_offset_mm >= 0 && one.overcut_mm >= 0 &&
             std::isfinite(one.blade_offset_mm) && std::isfinite(one.overcut_mm));
  if (const auto faults = parse_faults(text); accepted(faults)) demand(faults->size() <= 1000);
}

constexpr Target kTargets[] = {{"gpgl", program<GpglReader>},
                               {"hpgl", program<HpglReader>},
                               {"replies", replies},
                               {"sim_cutter", sim_cutter},
                               {"tables", tables, true}};

}  // namespace

std::span<const Target> cutter_targets() { return kTargets; }

}  // namespace popcut::fuzzing
