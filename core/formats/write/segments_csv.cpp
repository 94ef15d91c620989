// SPDX-License-Identifier: MIT
#include "core/formats/write/segments_csv.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

int tag(StripKind kind, std::int32_t level) {
  if (kind != StripKind::Connector && kind != StripKind::Bridge) return 7;
  return level >= 0 && level % 2 == 1 ? 8 : 6;
}

/// Where the ends of a panel are in the designed pose.
std::pair<KitePoint, KitePoint> ends_of(const KitePoint& a, const KitePoint& b, double v_mm,
                                        std::span<const Kite> kites) {
  for (const Kite& kite : kites)
    if (v_mm > kite.v0_mm && v_mm < kite.v1_mm &&
        kite.section.has(0.5 * (a.x + b.x), 0.5 * (a.z + b.z)))
      return {kite.section.posed(a.x, a.z, 0.5 * std::numbers::pi),
              kite.section.posed(b.x, b.z, 0.5 * std::numbers::pi)};
  return {a, b};
}

}  // namespace

void write_segments_csv(const Strips& strips, std::ostream& out, std::span<const Kite> kites) {
  TextSink text(out);
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const double v = 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]);
    const double width = strips.v_begin[s + 1] - strips.v_begin[s];
    const StripKind kind = strips.kind[s];
    const bool between_branches = kind == StripKind::Connector && strips.slice[s] % 2 == 1;
    for (std::size_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
      if (strips.is_cut(p)) continue;
      const std::size_t q = p + s;
      const double length =
          std::hypot(strips.x[q + 1] - strips.x[q], strips.z[q + 1] - strips.z[q]);
      const auto [a, b] =
          ends_of({strips.x[q], strips.z[q]}, {strips.x[q + 1], strips.z[q + 1]}, v, kites);
      text(a.x, ",", v, ",", a.z, ",", b.x, ",", v, ",", b.z, ",", length, ",",
           tag(kind, strips.level[p]), ",", strips.level[p], ",", strips.slice[s] + 1, ",",
           between_branches ? 1 : 0, ",", 2.0 * width, "\n");
    }
  }
}

}  // namespace popcut
