// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "device/session/session.hpp"
#include "device/sim/sim_transport.hpp"
#include "protocol/encode.hpp"
#include "tests/support/value.hpp"

namespace popcut::testing {

inline Machine machine(const char* name) { return value(find_machine(name)); }

inline SimCutter cutter(const Machine& machine, const SimOptions& options = {}) {
  return value(SimCutter::make(machine, options));
}

inline std::span<const std::byte> bytes(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// All replies that arrive in the next ten seconds, as text.
inline std::string replies(SimCutter& sim) {
  sim.run_until(sim.now() + std::chrono::seconds(10));
  std::string text;
  for (const std::byte byte : sim.take_replies()) text += static_cast<char>(byte);
  return text;
}

/// Random strokes within a square of `side_mm`, in grid units of a machine or between them.
inline Toolpath random_toolpath(std::mt19937& random, std::size_t strokes, double side_mm,
                                const Material& material) {
  std::uniform_real_distribution<double> place(1, side_mm - 1);
  std::uniform_real_distribution<double> step(-0.9, 0.9);
  std::uniform_int_distribution<int> count(2, 9);
  std::bernoulli_distribution fold(0.5), far(0.3);
  Toolpath path;
  for (std::size_t k = 0; k < strokes; ++k) {
    const bool folded = fold(random);
    const ToolSettings& tool = folded ? material.fold : material.cut;
    Stroke stroke;
    stroke.operation = folded ? Operation::FoldValley : Operation::Cut;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = static_cast<std::uint32_t>(count(random));
    stroke.line = static_cast<std::uint32_t>(k);
    stroke.tool = static_cast<std::uint8_t>(tool.tool);
    stroke.force_gf = tool.force_gf;
    stroke.speed_mm_s = tool.speed_mm_s;
    PagePoint at{place(random), place(random)};
    for (std::uint32_t i = 0; i < stroke.count; ++i) {
      path.points.push_back(at);
      const bool jump = far(random);
      const auto next = [&](double v) {
        return jump ? place(random)
                    : std::clamp(v + (v < side_mm / 2 ? 0.1 : -0.1) + step(random), 1.0,
                                 side_mm - 1);
      };
      at = {next(at.x), next(at.y)};
    }
    path.strokes.push_back(stroke);
  }
  return path;
}

/// A job on paper for a machine, and cables to the machine's simulation.
struct SimJob {
  Machine machine;
  Toolpath path;
  EncodedProgram program;
  double page_length_mm{};  ///< of the job and the sheet; 0: the machine's

  SimJob(Machine target, Toolpath strokes, double length_mm = 0)
      : machine(std::move(target)), path(std::move(strokes)), page_length_mm(length_mm) {
    JobOptions options;
    options.page_length_mm = length_mm;
    program = value(encode(path, machine, value(find_material("paper-220")), options));
  }
  /// A job of random strokes within 190 mm.
  SimJob(Machine target, std::mt19937& random, std::size_t strokes, double length_mm = 0)
      : SimJob(std::move(target),
               random_toolpath(random, strokes, 190, value(find_material("paper-220"))),
               length_mm) {}
  [[nodiscard]] SimTransport cable(std::vector<SimFault> faults = {}) const {
    SimOptions sheet;
    sheet.page_length_mm = page_length_mm;
    return SimTransport(cutter(machine, sheet), std::move(faults));
  }
};

/// Bytes that a session sent, without the moves that lift the tool at ends of strokes: those belong
/// to no stroke.
inline std::string without_lifts(const std::string& sent, const EncodedProgram& program) {
  std::string rest;
  std::size_t at = 0;
  for (const ByteRange& stroke : program.strokes) {
    const std::string lift =
        lift_after(program, static_cast<std::size_t>(&stroke - program.strokes.data()));
    const std::size_t whole = stroke.end - rest.size();
    rest += sent.substr(at, whole);
    at = std::min(at + whole, sent.size());
    const std::string next = program.bytes.substr(stroke.end, 8);
    while (!lift.empty() && sent.compare(at, lift.size(), lift) == 0 &&
           (sent.compare(at, next.size(), next) != 0 ||
            sent.compare(at + lift.size(), next.size(), next) == 0))
      at += lift.size();
  }
  return rest + sent.substr(at);
}

/// A machine whose motion takes `1 / factor` of the time that its model says.
inline Machine at_pace(Machine machine, double factor) {
  Motion& m = machine.motion;
  m.travel_mm_s *= factor;
  m.swivel_mm_s *= factor;
  m.accel_mm_s2 *= factor * factor;
  machine.speed_mm_s.per_step *= factor;
  for (double* seconds :
       {&m.drop_s, &m.lift_s, &m.setup_s, &m.trailer_s, &m.autoblade_reset_s, &m.autoblade_tap_s})
    *seconds /= factor;
  return machine;
}

/// How many strokes have this fate.
inline std::size_t count(const SessionEnd& end, StrokeFate fate) {
  return static_cast<std::size_t>(std::count(end.fates.begin(), end.fates.end(), fate));
}

}  // namespace popcut::testing
