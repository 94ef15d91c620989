// SPDX-License-Identifier: MIT
#include "tests/support/moves.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr std::size_t kHolders = 16;

/// Follows a program and collects its strokes.
class Follower {
 public:
  explicit Follower(const Program& program) : program_(program) {
    result_.points.reserve(program.points.size() + program.commands.size());
  }

  PenMoves run() {
    for (const Command& command : program_.commands) follow(command);
    return std::move(result_);
  }

 private:
  double arg(const Command& command, std::uint32_t k) const {
    return k < command.count ? program_.args[command.first + k] : 0;
  }

  MachinePoint shifted(MachinePoint point) const {
    return {point.a + origin_.a, point.b + origin_.b};
  }

  void follow(const Command& command) {
    switch (command.verb) {
      case Verb::Move:
        open_ = false;
        if (command.count > 0)
          position_ = shifted(program_.points[command.first + command.count - 1]);
        return;
      case Verb::Draw:
        return draw(command);
      case Verb::Speed:
        return set(speed_, command);
      case Verb::Force:
        return set(force_, command);
      case Verb::SelectTool:
        tool_ = static_cast<int>(std::clamp(arg(command, 0), 0.0, 255.0));
        open_ = false;
        return;
      case Verb::SetOrigin:
        origin_ = position_;
        open_ = false;
        return;
      case Verb::Home:
      case Verb::Initialise:
        open_ = false;
        if (program_.dialect == Dialect::Gpgl) origin_ = position_ = {};
        return;
      default:
        return;
    }
  }

  /// Sets a value for one holder, or for all if none is named. A value that differs ends the
  /// stroke.
  void set(std::array<double, kHolders>& values, const Command& command) {
    const double value = arg(command, 0);
    const double holder = arg(command, 1);
    const double before = values[slot()];
    if (holder >= 1 && holder < kHolders)
      values[static_cast<std::size_t>(holder)] = value;
    else
      values.fill(value);
    if (values[slot()] != before) open_ = false;
  }

  std::size_t slot() const {
    return tool_ >= 1 && tool_ < static_cast<int>(kHolders) ? static_cast<std::size_t>(tool_) : 1;
  }

  void draw(const Command& command) {
    if (!open_) {
      const auto first = static_cast<std::uint32_t>(result_.points.size());
      result_.points.push_back(position_);
      result_.strokes.push_back(
          {first, 1, tool_, force_[slot()], speed_[slot()], command.begin, command.end});
      open_ = true;
    }
    PenStroke& stroke = result_.strokes.back();
    for (std::uint32_t k = 0; k < command.count; ++k) {
      const MachinePoint point = shifted(program_.points[command.first + k]);
      if (point == position_) continue;
      result_.points.push_back(point);
      position_ = point;
      ++stroke.count;
    }
    stroke.end = command.end;
  }

  const Program& program_;
  PenMoves result_;
  MachinePoint position_{};
  MachinePoint origin_{};
  std::array<double, kHolders> speed_{};  // by holder
  std::array<double, kHolders> force_{};
  int tool_{1};
  bool open_{};  // the last stroke goes on
};

/// Printable text with each backslash doubled, so that \xNN is unambiguous.
std::string escaped(std::string_view text) {
  std::string doubled;
  for (const char c : text) doubled.append(c == '\\' ? 2 : 1, c);
  return printable(doubled);
}

}  // namespace

PenMoves moves(const Program& program) { return Follower(program).run(); }

Result<Toolpath> to_toolpath(const Program& program, const Machine& machine,
                             double page_length_mm) {
  Result<PageMap> map = page_map(machine, page_length_mm);
  if (!map) return tl::unexpected(map.error());
  const PenMoves pen = moves(program);
  Toolpath toolpath;
  toolpath.points.reserve(pen.points.size());
  for (const MachinePoint& point : pen.points) toolpath.points.push_back(map->to_page(point));
  toolpath.strokes.reserve(pen.strokes.size());
  for (const PenStroke& stroke : pen.strokes) {
    Stroke out{.operation = Operation::Cut, .first = stroke.first, .count = stroke.count};
    out.tool = static_cast<std::uint8_t>(std::clamp(stroke.tool, 1, 255));
    out.force_gf = stroke.force * machine.force_gf.per_step;
    out.speed_mm_s = stroke.speed * machine.speed_mm_s.per_step;
    toolpath.strokes.push_back(out);
  }
  return toolpath;
}

std::string listing(const Program& program, std::size_t most_points) {
  std::string out;
  const auto to = std::back_inserter(out);
  for (const Command& command : program.commands) {
    fmt::format_to(to, "{:>8}  {:<13}", command.begin, name_of(command.verb));
    const bool drawn = command.verb == Verb::Move || command.verb == Verb::Draw;
    if (!drawn && command.verb != Verb::Empty)
      fmt::format_to(to, " {}", escaped(program.texts[command.text]));
    const std::size_t shown = std::min<std::size_t>(command.count, most_points);
    for (std::size_t k = 0; k < shown; ++k) {
      if (drawn) {
        const MachinePoint& point = program.points[command.first + k];
        fmt::format_to(to, " {},{}", point.a, point.b);
      } else {
        fmt::format_to(to, "{}{}", k == 0 ? " " : ",", program.args[command.first + k]);
      }
    }
    if (shown < command.count) fmt::format_to(to, " ... {} more", command.count - shown);
    while (out.back() == ' ') out.pop_back();
    out += '\n';
  }
  if (program.truncated) out += "the last command is cut off by the end of the program\n";
  return out;
}

}  // namespace popcut
