// SPDX-License-Identifier: MIT
#include "core/design/makeable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr double kRounding_mm = 1e-6;

/// Places where a measure is below its limit: how many, and the worst.
struct Narrow {
  double limit_mm{};
  std::size_t count{};
  double least_mm{std::numeric_limits<double>::infinity()};
  double u_mm{}, v_mm{};  ///< of the worst

  void look(double mm, double u, double v) {
    if (!(mm < limit_mm - kRounding_mm)) return;
    ++count;
    if (mm < least_mm) least_mm = mm, u_mm = u, v_mm = v;
  }
  void say(const char* code, std::string_view one, std::string_view many,
           std::vector<Warning>& warnings) const {
    if (count > 0)
      warnings.push_back(
          {.code = code,
           .message = fmt::format(
               "{} {} below {:.3g} mm; the least is {:.3g} mm, at u = {:.1f}, v = {:.1f} mm", count,
               count == 1 ? one : many, limit_mm, least_mm, u_mm, v_mm),
           .place = {.u_mm = u_mm, .v_mm = v_mm},
           .spoils = true});
  }
};

double length(const SheetLine& line) { return std::hypot(line.u1 - line.u0, line.v1 - line.v0); }

bool is_fold(const SheetLine& line) {
  return line.role == EdgeRole::Mountain || line.role == EdgeRole::Valley;
}

void check_folds(const Pattern& pattern, double shortest_mm, std::vector<Warning>& warnings) {
  Narrow folds{shortest_mm};
  for (const SheetLine& line : pattern.lines)
    if (is_fold(line))
      folds.look(length(line), 0.5 * (line.u0 + line.u1), 0.5 * (line.v0 + line.v1));
  folds.say("fold_short", "fold is", "folds are", warnings);
}

void check_strips(const Strips& strips, double narrowest_mm, std::vector<Warning>& warnings) {
  Narrow narrow{narrowest_mm};
  for (std::size_t s = 0; s < strips.size(); ++s)
    narrow.look(strips.v_begin[s + 1] - strips.v_begin[s], 0.0,
                0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]));
  narrow.say("strip_narrow", "strip is", "strips are", warnings);
}

/// Slits, and the paper between those on one line along u; facets have others too. Pieces of one
/// cut that turns are judged by no length of theirs.
void check_slits(const Pattern& pattern, double narrowest_mm, std::vector<Warning>& warnings) {
  struct Slit {
    double v{}, from{}, to{};
  };
  std::vector<Slit> slits;
  Narrow narrow{narrowest_mm}, necks{narrowest_mm};
  std::map<std::pair<std::int64_t, std::int64_t>, int> ends;  // how many slits end there
  const auto spot = [](double u, double v) {
    return std::pair<std::int64_t, std::int64_t>(std::llround(u / kRounding_mm),
                                                 std::llround(v / kRounding_mm));
  };
  for (const SheetLine& line : pattern.lines)
    if (line.role == EdgeRole::Slit) ++ends[spot(line.u0, line.v0)], ++ends[spot(line.u1, line.v1)];
  for (const SheetLine& line : pattern.lines) {
    if (line.role != EdgeRole::Slit) continue;
    if (ends[spot(line.u0, line.v0)] > 1 || ends[spot(line.u1, line.v1)] > 1) continue;
    if (line.v0 == line.v1)
      slits.push_back({line.v0, std::min(line.u0, line.u1), std::max(line.u0, line.u1)});
    else
      narrow.look(length(line), 0.5 * (line.u0 + line.u1), 0.5 * (line.v0 + line.v1));
  }
  std::sort(slits.begin(), slits.end(),
            [](const Slit& a, const Slit& b) { return a.v != b.v ? a.v < b.v : a.from < b.from; });
  for (std::size_t i = 0; i < slits.size(); ++i) {
    const Slit& slit = slits[i];
    narrow.look(slit.to - slit.from, 0.5 * (slit.from + slit.to), slit.v);
    if (i == 0 || slits[i - 1].v < slit.v - kRounding_mm) continue;
    const double neck = slit.from - slits[i - 1].to;
    if (neck > kRounding_mm) necks.look(neck, slit.from, slit.v);
  }
  narrow.say("slit_short", "slit is", "slits are", warnings);
  necks.say("neck_narrow", "neck of paper between two slits is",
            "necks of paper between two slits are", warnings);
}

void check_sheet(const Pattern& pattern, const MakeLimits& limits, std::vector<Warning>& warnings) {
  double u_least = std::numeric_limits<double>::infinity(), u_most = -u_least;
  for (const SheetLine& line : pattern.lines) {
    u_least = std::min({u_least, line.u0, line.u1});
    u_most = std::max({u_most, line.u0, line.u1});
  }
  const double u = u_most - u_least, v = pattern.width_mm;
  const double a = limits.sheet_mm[0] + kRounding_mm, b = limits.sheet_mm[1] + kRounding_mm;
  if ((u <= a && v <= b) || (u <= b && v <= a)) return;
  warnings.push_back(
      {.code = "larger_than_sheet",
       .message = fmt::format("the pattern is {:.1f} x {:.1f} mm, larger than {} of {:g} x {:g} "
                              "mm: it must be scaled down, or split and glued",
                              u, v, limits.sheet_name, limits.sheet_mm[0], limits.sheet_mm[1])});
}

}  // namespace

std::vector<Warning> make_warnings(const Strips& strips, const Pattern& pattern,
                                   const MakeLimits& limits) {
  std::vector<Warning> warnings;
  check_folds(pattern, limits.shortest_fold_mm, warnings);
  check_strips(strips, limits.narrowest_mm, warnings);
  check_slits(pattern, limits.narrowest_mm, warnings);
  if (limits.sheet_mm[0] > 0.0 && !pattern.lines.empty()) check_sheet(pattern, limits, warnings);
  return warnings;
}

}  // namespace popcut
