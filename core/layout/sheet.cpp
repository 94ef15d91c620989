// SPDX-License-Identifier: MIT
#include "core/layout/sheet.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "core/drawing/paper.hpp"
#include "core/text/near_names.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr double kDrawingMargin = 10.0;  // mm around a drawing that popcut places
constexpr double kFits = 1e-6;           // mm; rounding errors up to this size still fit

bool take_number(std::string_view& text, double& out) {
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (fault != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

// The margin on each side of `size` in `room`, at most kDrawingMargin.
double margin(double size, double room) {
  return std::clamp((room - size) / 2, 0.0, kDrawingMargin);
}

bool inside(const Box& box, const std::array<double, 2>& reach) {
  return box.x0 >= -kFits && box.y0 >= -kFits && box.x1 <= reach[0] + kFits &&
         box.y1 <= reach[1] + kFits;
}

}  // namespace

bool is_mat_name(const Mat& mat, std::string_view word) { return same_word(mat.name, word); }

Result<std::array<double, 2>> parse_size_mm(std::string_view text) {
  const auto wrong = [&] {
    return fail(ErrorKind::Usage, "/options/mat",
                fmt::format("{} is not a size; give a paper such as A4, or WIDTHxLENGTH such as "
                            "300x200 (mm) or 12x12in",
                            text.substr(0, 40)));
  };
  std::string_view rest = text;
  std::array<double, 2> size{};
  if (!take_number(rest, size[0]) || rest.empty() || (rest[0] != 'x' && rest[0] != 'X')) {
    if (const auto paper = find_paper(text)) return std::array{paper->width_mm, paper->height_mm};
    return wrong();
  }
  rest.remove_prefix(1);
  if (!take_number(rest, size[1])) return wrong();
  double unit = 0.0;
  if (rest.empty() || same_word(rest, "mm")) unit = 1.0;
  if (same_word(rest, "cm")) unit = 10.0;
  if (same_word(rest, "in")) unit = 25.4;
  if (unit == 0.0) return wrong();
  for (double& side : size) {
    side *= unit;
    if (!(side >= 1.0 && side <= kMaxCoordinate)) return wrong();
  }
  return size;
}

bool is_roll(std::string_view mat) { return same_word(mat, "roll"); }

Result<Mat> choose_mat(const Machine& machine, std::string_view wanted) {
  if (wanted.empty())
    return machine.mats.empty() ? Mat{"", 0, machine.width_mm, machine.length_mm}
                                : machine.mats.front();
  if (is_roll(wanted) && machine.driven()) return Mat{"", 0, machine.width_mm, machine.length_mm};
  std::vector<std::string> names;
  for (const Mat& mat : machine.mats) {
    if (is_mat_name(mat, wanted)) return mat;
    names.push_back(mat.name);
  }
  const auto size = parse_size_mm(wanted);
  if (!size)
    return fail(
        ErrorKind::Usage, "/options/mat",
        names.empty()
            ? fmt::format("{} has no named mats; give a paper such as A4, or a size such as "
                          "300x200 (mm) or 12x12in",
                          machine.name)
            : fmt::format("{} has no mat {}; {} (or give a paper such as A4, a size such as "
                          "300x200 or 12x12in, or roll)",
                          machine.name, wanted.substr(0, 40), suggestion(wanted, names)));
  if ((*size)[0] > machine.width_mm + kFits || (*size)[1] > machine.length_mm + kFits)
    return fail(
        ErrorKind::OutOfRange, "/options/mat",
        fmt::format("{:.1f} x {:.1f} mm is too large for {}; use at most {:.1f} x {:.1f} mm",
                    (*size)[0], (*size)[1],
                    machine.language == "hand" ? "a page to print" : machine.name, machine.width_mm,
                    machine.length_mm));
  constexpr double kLeastPaper = 60.0;
  if (machine.language == "hand" && std::min((*size)[0], (*size)[1]) < kLeastPaper)
    return fail(ErrorKind::OutOfRange, "/options/mat",
                fmt::format("{:.1f} x {:.1f} mm is too small to print on; use at least {:.0f} x "
                            "{:.0f} mm",
                            (*size)[0], (*size)[1], kLeastPaper, kLeastPaper));
  return Mat{std::string(wanted), 0, (*size)[0], (*size)[1]};
}

Result<Machine> ideal_plotter(double width_mm, double length_mm) {
  auto machine = find_machine("cameo3");
  if (!machine) return machine;
  machine->name = "ideal";
  machine->title = "Ideal plotter";
  machine->width_mm = width_mm;
  machine->length_mm = length_mm;
  machine->autoblade = false;
  machine->usb_vendor = machine->usb_product = 0;
  machine->mats = {Mat{fmt::format("{:g}x{:g}", width_mm, length_mm), 0, width_mm, length_mm}};
  return machine;
}

std::array<double, 2> reach_mm(const Machine& machine, const Mat& mat) {
  if (machine.language == "hand")
    return {mat.width_mm - 2 * kPrintSideMm, mat.length_mm - kPrintSideMm - kPrintFooterMm};
  return {std::min(mat.width_mm, machine.width_mm - std::max(0.0, machine.margin_left_mm)),
          std::min(mat.length_mm, machine.length_mm - std::max(0.0, machine.margin_top_mm))};
}

Result<Placement> place(const LineWork& work, const std::array<double, 2>& reach,
                        const PlaceOptions& options) {
  const Box box = bounds(work);
  if (box.empty()) return Placement{};
  const double w = box.width(), h = box.height();
  const auto fits = [&](double width, double height) {
    return width <= reach[0] + kFits && height <= reach[1] + kFits;
  };
  const auto moved_to = [&](double x, double y) {
    return Placement{1, 0, x - box.x0, 0, 1, y - box.y0};
  };
  // A quarter turn (x, y) -> (-y, x), then a shift of the corner to its place.
  const auto turned_to = [&](double x, double y) {
    return Placement{0, -1, x + box.y1, 1, 0, y - box.x0};
  };
  if (options.at) {
    const PagePoint at = *options.at;
    const auto lies = [&](double width, double height) {
      return inside({at.x, at.y, at.x + width, at.y + height}, reach);
    };
    if (options.clip || lies(w, h)) return moved_to(at.x, at.y);
    if ((options.at_is_usual || !fits(w, h)) && lies(h, w)) return turned_to(at.x, at.y);
    if (fits(w, h) && !options.at_is_usual)
      return fail(
          ErrorKind::Infeasible, "/options/at",
          fmt::format("a drawing of {:.1f} x {:.1f} mm at {:g},{:g} does not fit in the {:.1f} x "
                      "{:.1f} mm that can be cut; use at most {:.1f},{:.1f}",
                      w, h, at.x, at.y, reach[0], reach[1], reach[0] - w, reach[1] - h));
  } else {
    if (work.has_page && (options.clip || inside(box, reach))) return Placement{};
    if (fits(w, h) || options.clip) return moved_to(margin(w, reach[0]), margin(h, reach[1]));
    if (fits(h, w)) return turned_to(margin(h, reach[0]), margin(w, reach[1]));
  }
  return fail(
      ErrorKind::Infeasible, "",
      fmt::format("the pattern is {:.1f} x {:.1f} mm, but the area holds {:.1f} x {:.1f} mm", w, h,
                  reach[0], reach[1]));
}

LineWork placed(LineWork work, const Placement& placement) {
  for (PagePoint& p : work.points) p = placement(p);
  return work;
}

LineWork clipped(const LineWork& work, const std::array<double, 2>& reach, double room) {
  const Box area{room, room, reach[0] - room, reach[1] - room};
  LineWork out = work.without_lines();
  std::vector<PagePoint> run;
  for (const DrawnLine& line : work.lines)
    clip_line(work.points_of(line), line.operation, area, run, out);
  return out;
}

}  // namespace popcut
