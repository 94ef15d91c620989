// SPDX-License-Identifier: MIT
// Part of protocol/encode.hpp.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/text/words.hpp"
#include "protocol/encode.hpp"
#include "protocol/stroke_encoder.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMaxPointBytes = 26;

/// A word of a variant and what it changes.
struct HabitWord {
  std::string_view word;
  void (*change)(HpglHabits& habits);
};

constexpr std::array<HabitWord, 9> kHabitWords{{
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

class HpglEncoder final : public StrokeEncoder {
 public:
  HpglEncoder(const Toolpath& toolpath, const Machine& machine, const HpglHabits& habits,
              const PageMap& map, std::optional<double> feed_out_mm)
      : StrokeEncoder(toolpath, machine, map, feed_out_mm), habits_(habits) {}

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

  void send_changes(const StrokeSteps& steps) {
    if (steps.tool != sent_.tool) write_value("SP", steps.tool);
    if (habits_.speed_and_force) {
      if (steps.speed && steps.speed != sent_.speed) write_value("VS", *steps.speed);
      if (steps.force && steps.force != sent_.force) write_value("FS", *steps.force);
    }
    sent_ = steps;
  }

  void write_setup(const StrokeSteps& first) override {
    write_plain("IN");
    if (habits_.words != HpglWords::MoveDraw) write_plain("PA");
    program_.setup.push_back({0, program_.bytes.size()});
    const std::uint64_t begin = program_.bytes.size();
    sent_.tool = 0;
    send_changes(first);
    program_.setup.push_back({begin, program_.bytes.size()});
  }

  void write_trailer() override {
    write_move({0, 0});
    write_plain("SP0");
    if (habits_.final_in) write_plain("IN");
  }

  void write_feed_out(GridPoint point) override { write_move(point); }

  [[nodiscard]] Result<void> check_line(std::size_t index) const override {
    GridPoint least = line_.front();
    for (const GridPoint& point : line_) {
      least.a = std::min(least.a, point.a);
      least.b = std::min(least.b, point.b);
    }
    if (habits_.negative || (least.a >= 0 && least.b >= 0)) return {};
    const auto missing = [&](std::int64_t units) {
      return static_cast<double>(units < 0 ? -units : 0) * machine_.unit_mm;
    };
    return fail(
        ErrorKind::OutOfRange, stroke_place(index),
        fmt::format("negative coordinates, which HPGL machines do not take; move the drawing by "
                    "{} mm along the machine's x and {} mm along its y",
                    missing(least.a), missing(least.b)));
  }

  void write_changes(const StrokeSteps& steps) override {
    const bool changes =
        steps.tool != sent_.tool ||
        (habits_.speed_and_force && (steps.speed != sent_.speed || steps.force != sent_.force));
    if (!changes) return;
    // Nothing changes while the tool is down. M of CAMM-GL needs a point, so PU lifts there too.
    write_plain(habits_.words == HpglWords::UpDown ? "U" : "PU");
    send_changes(steps);
  }

  /// A longer line continues with another PD.
  void write_line() override {
    write_move(line_.front());
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

  const HpglHabits habits_;
  StrokeSteps sent_;
};

}  // namespace

Result<HpglHabits> hpgl_habits(std::string_view variant) {
  HpglHabits habits;
  std::string_view rest = variant;
  for (bool more = true; more;) {
    more = rest.find('+') != std::string_view::npos;
    const std::string_view word = take_word(rest, "+");
    const auto known = std::find_if(kHabitWords.begin(), kHabitWords.end(),
                                    [&](const HabitWord& w) { return w.word == word; });
    if (known == kHabitWords.end()) {
      return fail(ErrorKind::OutOfRange, "/variant",
                  fmt::format("\"{}\" is not a variant of HPGL; known words, joined by +: {}", word,
                              fmt::join(kHpglWords, ", ")));
    }
    known->change(habits);
  }
  if (habits.move_by_pa && habits.words != HpglWords::PenUpDown)
    return fail(
        ErrorKind::OutOfRange, "/variant",
        fmt::format("\"{}\": pa needs PU and PD; remove pa, or remove ud and camm1", variant));
  return habits;
}

Result<EncodedProgram> encode_hpgl(const Toolpath& toolpath, const Machine& machine,
                                   const Material&, const JobOptions& options) {
  if (options.marks)
    return fail(ErrorKind::OutOfRange, "/language",
                fmt::format("{} uses HPGL, which cannot search for registration marks; use a "
                            "Silhouette machine",
                            machine.name));
  const Result<HpglHabits> habits =
      options.hpgl ? Result<HpglHabits>(*options.hpgl) : hpgl_habits(machine.variant);
  if (!habits) return tl::unexpected(habits.error());
  const Result<PageMap> map = page_map(machine, options.page_length_mm);
  if (!map) return tl::unexpected(map.error());
  return HpglEncoder(toolpath, machine, *habits, *map, options.feed_out_mm).run();
}

}  // namespace popcut
