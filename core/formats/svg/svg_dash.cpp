// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_dash.hpp"

#include <cmath>
#include <numeric>

#include "core/drawing/linework.hpp"

namespace popcut {
namespace {

constexpr std::string_view kBetween = ", \t\r\n\f";

// Builds the lines of `out` point by point; drops parts without length.
class Parts {
 public:
  explicit Parts(SvgLines& out) : out_(out), first_(out.points.size()) {}
  void add(const PagePoint& p) {
    if (out_.points.size() == first_ || out_.points.back() != p) out_.points.push_back(p);
  }
  void end() {
    if (out_.points.size() < first_ + 2) out_.points.resize(first_);
    if (out_.points.size() > first_)
      out_.ends.push_back(static_cast<std::uint32_t>(out_.points.size()));
    first_ = out_.points.size();
  }

 private:
  SvgLines& out_;
  std::size_t first_;
};

}  // namespace

std::optional<std::vector<SvgLength>> parse_svg_dashes(std::string_view text) {
  std::vector<SvgLength> list;
  text = trimmed(text);
  if (same_word(text, "none")) return list;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(kBetween), text.size());
    const auto length = parse_svg_length(text.substr(0, end));
    if (!length || length->value < 0.0) return std::vector<SvgLength>{};
    if (list.size() == kMaxDashNumbers) return std::nullopt;
    list.push_back(*length);
    text.remove_prefix(end);
    const std::size_t next = std::min(text.find_first_not_of(kBetween), text.size());
    text.remove_prefix(next);
  }
  return list;
}

SvgDashes svg_dashes(std::span<const SvgLength> list, const SvgLength& offset,
                     const SvgMeasure& measure) {
  SvgDashes dashes;
  for (int round = 0; round < (list.size() % 2 == 1 ? 2 : 1); ++round)
    for (const SvgLength& length : list) dashes.lengths.push_back(user_units(length, measure));
  const double period = std::accumulate(dashes.lengths.begin(), dashes.lengths.end(), 0.0);
  if (!(period > 0.0) || !std::isfinite(period)) return {};
  dashes.offset = std::fmod(user_units(offset, measure), period);
  if (!std::isfinite(dashes.offset)) dashes.offset = 0.0;
  if (dashes.offset < 0.0) dashes.offset += period;
  return dashes;
}

bool cut_into_dashes(std::span<const PagePoint> line, const SvgDashes& dashes, std::size_t& steps,
                     SvgLines& out) {
  const std::vector<double>& lengths = dashes.lengths;
  std::size_t at = 0;
  double phase = dashes.offset;
  while (phase > 0.0 && phase >= lengths[at] && at + 1 < lengths.size()) phase -= lengths[at++];
  double left = std::max(0.0, lengths[at] - phase);  // length left of the current dash or gap
  Parts parts(out);
  if (at % 2 == 0) parts.add(line.front());
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double length = distance(line[i - 1], line[i]);
    double t = 0.0;
    while (length - t > left) {
      if (steps == 0) return false;
      --steps;
      t += left;
      const PagePoint p{std::lerp(line[i - 1].x, line[i].x, t / length),
                        std::lerp(line[i - 1].y, line[i].y, t / length)};
      if (at % 2 == 0) {
        parts.add(p);
        parts.end();
      }
      at = (at + 1) % lengths.size();
      if (at % 2 == 0) parts.add(p);
      left = lengths[at];
    }
    left -= length - t;
    if (at % 2 == 0) parts.add(line[i]);
  }
  parts.end();
  return true;
}

}  // namespace popcut
