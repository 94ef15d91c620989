// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "protocol/encode.hpp"
#include "protocol/stroke_steps.hpp"

namespace popcut {
namespace {

// A longer line is continued with another PD: small machines have small buffers for a command.
constexpr std::size_t kMaxCommandBytes = 1023;
constexpr std::size_t kMaxPointBytes = 26;

// A word of a variant and what it changes.
struct HabitWord {
  std::string_view word;
  void (*change)(HpglHabits& habits);
};

constexpr std::array<HabitWord, 9> kWords{{
    {"generic", [](HpglHabits&) {}},
    {"pa", [](HpglHabits& h) { h.move_by_pa = true; }},
    {"newline", [](HpglHabits& h) { h.newline = true; }},
    {"plain", [](HpglHabits& h) { h.speed_and_force = false; }},
    {"open", [](HpglHabits& h) { h.final_in = false; }},
    {"negative", [](HpglHabits& h) { h.negative = true; }},
    {"ud", [](HpglHabits& h) { h.words = HpglWords::UpDown; }},
    {"camm1", [](HpglHabits& h) { h.words = HpglWords::MoveDraw, h.negative = true; }},
    {"camm2", [](HpglHabits& h) { h.negative = true; }},
}};

class HpglEncoder {
 public:
  HpglEncoder(const Toolpath& toolpath, const Machine& machine, const HpglHabits& habits,
              const PageMap& map)
      : toolpath_(toolpath), machine_(machine), habits_(habits), map_(map) {}

  Result<EncodedProgram> run() {
    program_.dialect = Dialect::Hpgl;
    program_.strokes.reserve(toolpath_.strokes.size());
    program_.bytes.reserve(toolpath_.points.size() * 12 + 256);
    StrokeSteps first;
    if (!toolpath_.strokes.empty()) {
      Result<StrokeSteps> steps = steps_of(toolpath_.strokes.front(), 0, machine_);
      if (!steps) return tl::unexpected(steps.error());
      first = *steps;
    }
    write_setup(first);
    program_.geometry.begin = program_.bytes.size();
    for (std::size_t k = 0; k < toolpath_.strokes.size(); ++k) {
      const std::uint64_t begin = program_.bytes.size();
      if (Result<void> done = write_stroke(k); !done) return tl::unexpected(done.error());
      program_.strokes.push_back({begin, program_.bytes.size()});
    }
    program_.geometry.end = program_.bytes.size();
    write_trailer();
    program_.trailer = {program_.geometry.end, program_.bytes.size()};
    return std::move(program_);
  }

 private:
  void end_command() { program_.bytes += habits_.newline ? ";\n" : ";"; }

  void write_plain(std::string_view command) {
    program_.bytes += command;
    end_command();
  }

  void write_value(std::string_view mnemonic, std::int64_t value) {
    program_.bytes += mnemonic;
    append_number(program_.bytes, value);
    end_command();
  }

  void append_point(GridPoint point) {
    append_number(program_.bytes, point.a);
    program_.bytes += ',';
    append_number(program_.bytes, point.b);
  }

  [[nodiscard]] std::string_view up() const {
    constexpr std::array<std::string_view, 3> kUp{"PU", "U", "M"};
    return kUp[static_cast<std::size_t>(habits_.words)];
  }
  [[nodiscard]] std::string_view down() const {
    return habits_.words == HpglWords::PenUpDown ? "PD" : "D";
  }

  void write_move(GridPoint point) {
    if (habits_.move_by_pa) write_plain("PU");
    program_.bytes += habits_.move_by_pa ? "PA" : up();
    append_point(point);
    end_command();
  }

  void write_changes(const StrokeSteps& steps) {
    if (steps.tool != sent_.tool) write_value("SP", steps.tool);
    if (habits_.speed_and_force) {
      if (steps.speed && steps.speed != sent_.speed) write_value("VS", *steps.speed);
      if (steps.force && steps.force != sent_.force) write_value("FS", *steps.force);
    }
    sent_ = steps;
  }

  void write_setup(const StrokeSteps& first) {
    write_plain("IN");
    if (habits_.words != HpglWords::MoveDraw) write_plain("PA");
    program_.setup.push_back({0, program_.bytes.size()});
    const std::uint64_t begin = program_.bytes.size();
    sent_.tool = 0;
    write_changes(first);
    program_.setup.push_back({begin, program_.bytes.size()});
  }

  void write_trailer() {
    write_move({0, 0});
    write_plain("SP0");
    if (habits_.final_in) write_plain("IN");
  }

  Result<void> check_not_negative(std::size_t index) const {
    GridPoint least = line_.front();
    for (const GridPoint& point : line_) {
      least.a = std::min(least.a, point.a);
      least.b = std::min(least.b, point.b);
    }
    if (habits_.negative || (least.a >= 0 && least.b >= 0)) return {};
    const auto missing = [&](std::int64_t units) {
      return static_cast<double>(units < 0 ? -units : 0) * machine_.unit_mm;
    };
    return fail(ErrorKind::OutOfRange, stroke_place(index),
                fmt::format("negative coordinates, which machines that speak HPGL do not take; "
                            "move the drawing by {} mm in x and {} mm in y of the machine",
                            missing(least.a), missing(least.b)));
  }

  Result<void> write_stroke(std::size_t index) {
    const Result<StrokeSteps> steps = steps_of(toolpath_.strokes[index], index, machine_);
    if (!steps) return tl::unexpected(steps.error());
    if (Result<void> done = put_on_grid(toolpath_, index, map_, 1, line_); !done) return done;
    if (line_.size() < 2) {
      program_.dots.push_back(static_cast<std::uint32_t>(index));
      return {};
    }
    if (Result<void> done = check_not_negative(index); !done) return done;
    const bool changes =
        steps->tool != sent_.tool ||
        (habits_.speed_and_force && (steps->speed != sent_.speed || steps->force != sent_.force));
    if (changes) {
      // Nothing changes while the tool is down. M of CAMM-GL does not go without a point.
      write_plain(habits_.words == HpglWords::UpDown ? "U" : "PU");
      write_changes(*steps);
    }
    write_move(line_.front());
    write_line();
    return {};
  }

  void write_line() {
    std::string& bytes = program_.bytes;
    std::size_t begin = bytes.size();
    bytes += down();
    for (std::size_t k = 1; k < line_.size(); ++k) {
      if (bytes.size() - begin + kMaxPointBytes > kMaxCommandBytes) {
        bytes.back() = ';';  // in place of the comma
        if (habits_.newline) bytes += '\n';
        begin = bytes.size();
        bytes += down();
      }
      append_point(line_[k]);
      bytes += ',';
    }
    bytes.back() = ';';
    if (habits_.newline) bytes += '\n';
  }

  const Toolpath& toolpath_;
  const Machine& machine_;
  const HpglHabits habits_;
  const PageMap map_;
  StrokeSteps sent_;
  EncodedProgram program_;
  std::vector<GridPoint> line_;
};

}  // namespace

Result<HpglHabits> hpgl_habits(std::string_view variant) {
  HpglHabits habits;
  for (std::string_view rest = variant;;) {
    const std::string_view word = rest.substr(0, rest.find('+'));
    const auto known = std::find_if(kWords.begin(), kWords.end(),
                                    [&](const HabitWord& w) { return w.word == word; });
    if (known == kWords.end()) {
      std::string names;
      for (const HabitWord& w : kWords)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", w.word);
      return fail(
          ErrorKind::OutOfRange, "/variant",
          fmt::format("\"{}\" is no variant of HPGL; {} are known, joined by +", word, names));
    }
    known->change(habits);
    if (word.size() == rest.size()) break;
    rest.remove_prefix(word.size() + 1);
  }
  if (habits.move_by_pa && habits.words != HpglWords::PenUpDown)
    return fail(ErrorKind::OutOfRange, "/variant",
                fmt::format("\"{}\": pa goes with PU and PD only; leave pa, or ud and camm1, out",
                            variant));
  return habits;
}

Result<EncodedProgram> encode_hpgl(const Toolpath& toolpath, const Machine& machine,
                                   const Material&, const JobOptions& options) {
  if (options.marks)
    return fail(ErrorKind::OutOfRange, "/language",
                fmt::format("{} speaks HPGL, in which no search for registration marks is known; a "
                            "Silhouette has one",
                            machine.name));
  const Result<HpglHabits> habits =
      options.hpgl ? Result<HpglHabits>(*options.hpgl) : hpgl_habits(machine.variant);
  if (!habits) return tl::unexpected(habits.error());
  const Result<PageMap> map = page_map(machine, options.page_length_mm);
  if (!map) return tl::unexpected(map.error());
  return HpglEncoder(toolpath, machine, *habits, *map).run();
}

Result<EncodedProgram> encode(const Toolpath& toolpath, const Machine& machine,
                              const Material& material, const JobOptions& options) {
  const Result<Dialect> dialect = dialect_of(machine);
  if (!dialect) return tl::unexpected(dialect.error());
  return *dialect == Dialect::Gpgl ? encode_gpgl(toolpath, machine, material, options)
                                   : encode_hpgl(toolpath, machine, material, options);
}

}  // namespace popcut
