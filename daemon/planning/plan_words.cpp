// SPDX-License-Identifier: MIT
#include "daemon/planning/plan_words.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_scan.hpp"

namespace popcut::planning {
namespace {

constexpr double kBandMm = 20.0;
constexpr double kCornerDeg = 60.0;

Result<double> millimetres(const std::string& text, const char* option, double most) {
  SvgScan scan(text);
  double mm = 0.0;
  if (scan.number(mm) && scan.at_end() && mm >= 0.0 && mm <= most) return mm;
  return fail(ErrorKind::Usage, option,
              fmt::format("{} is not a length; 0 to {:g} (mm)", text.substr(0, 40), most));
}

Result<std::size_t> one_of(const std::string& text, const char* option,
                           const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), text);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  return fail(
      ErrorKind::Usage, option,
      fmt::format("{} is not known; one of {}", text.substr(0, 40), fmt::join(words, ", ")));
}

Result<void> check_seams(const std::vector<double>& seams, const char* option) {
  for (const double mm : seams)
    if (!(std::abs(mm) <= kMaxCoordinate))
      return fail(ErrorKind::Usage, option,
                  fmt::format("{:g} is no place; mm from the drawing's left or upper edge", mm));
  return {};
}

}  // namespace

Result<OrderOptions> order_options(const OrderWords& words) {
  OrderOptions out;
  if (words.method == "best") {
    out.method = OrderMethod::Best;
  } else if (words.method == "keep") {
    out.method = OrderMethod::Keep;
  } else if (words.method != "quick") {
    return fail(ErrorKind::Usage, "--order",
                fmt::format("{} is not known; quick, best or keep", words.method));
  }
  if (!(words.effort >= 0.01 && words.effort <= 1000.0))
    return fail(ErrorKind::Usage, "--effort",
                fmt::format("{} is out of range; from 0.01 to 1000", words.effort));
  if (words.mat_free && out.method == OrderMethod::Keep)
    return fail(ErrorKind::Usage, "--mat-free",
                "it changes the order that --order keep keeps; leave one of them out");
  out.effort = words.effort;
  out.seed = words.seed;
  out.keep_going = words.keep_going;
  out.band_mm = words.mat_free ? kBandMm : 0.0;
  out.corner_deg = words.mat_free ? kCornerDeg : 0.0;
  return out;
}

Result<void> read_knife_words(const KnifeWords& words, PlanOptions& options) {
  if (!words.folds.empty()) {
    const auto mode = one_of(words.folds, "--folds", {"perforate", "score", "light"});
    if (!mode) return tl::unexpected(mode.error());
    options.knife.folds = static_cast<FoldMode>(*mode);
  }
  const auto direction = one_of(words.direction, "--direction", {"any", "cw", "ccw"});
  if (!direction) return tl::unexpected(direction.error());
  options.knife.direction = static_cast<CutDirection>(*direction);
  if (!words.overcut.empty()) {
    const auto mm = millimetres(words.overcut, "--overcut", 10.0);
    if (!mm) return tl::unexpected(mm.error());
    options.knife.overcut_mm = *mm;
  }
  if (!words.snap.empty()) {
    const auto mm = millimetres(words.snap, "--snap", kMostSnap);
    if (!mm) return tl::unexpected(mm.error());
    options.clean.snap_mm = *mm;
  }
  return {};
}

std::vector<ToolKind> holders_for(const PlannedSheet& sheet) {
  std::vector<ToolKind> holders;
  for (const Stroke& stroke : sheet.path.strokes)
    if (holders.size() < stroke.tool) holders.resize(stroke.tool, ToolKind::Pen);
  for (std::size_t i = 0; i < holders.size(); ++i)
    if (sheet.knife.blade(static_cast<int>(i) + 1)) holders[i] = ToolKind::Blade;
  return holders;
}

Result<void> read_split_words(const SplitWords& words, PlanOptions& options) {
  constexpr std::array kWords{"auto", "pen", "cut", "none"};
  const auto word = std::find(kWords.begin(), kWords.end(), words.labels);
  if (word == kWords.end())
    return fail(ErrorKind::Usage, "--labels",
                fmt::format("{} is not known; one of {}", words.labels.substr(0, 40),
                            fmt::join(kWords, ", ")));
  if (auto lawful = check_seams(words.seams_x, "--seam-x"); !lawful) return lawful;
  if (auto lawful = check_seams(words.seams_y, "--seam-y"); !lawful) return lawful;
  if (words.never && !(words.seams_x.empty() && words.seams_y.empty()))
    return fail(ErrorKind::Usage, "--no-split",
                "contradicts --seam-x and --seam-y; give one or the other");
  options.labels = static_cast<LabelTool>(word - kWords.begin());
  options.seams_x = words.seams_x;
  options.seams_y = words.seams_y;
  options.split = !words.never;
  return {};
}

Result<std::optional<MarkLayout>> read_mark_words(const MarkWords& words, const Machine& machine,
                                                  std::array<double, 2> area_mm) {
  if (words.form != "arm" && words.form != "line")
    return fail(ErrorKind::Usage, "--mark-form",
                fmt::format("{} is not known; arm or line", words.form));
  if (!words.wanted) return std::nullopt;
  auto marks = marks_for(area_mm);
  if (!marks) return tl::unexpected(marks.error());
  marks->arm_first = words.form == "arm";
  const auto named = [&](const char* word) { return machine.name.find(word) != std::string::npos; };
  marks->four_corners = named("alpha") || named("mk2");
  if (named("silhouette-sd") || named("craft-robo")) marks->style = 0;
  return *marks;
}

}  // namespace popcut::planning
