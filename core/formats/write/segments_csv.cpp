// SPDX-License-Identifier: MIT
#include "core/formats/write/segments_csv.hpp"

#include <cmath>

#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

int tag(StripKind kind, std::int32_t level) {
  if (kind != StripKind::Connector && kind != StripKind::Bridge) return 7;
  return level >= 0 && level % 2 == 1 ? 8 : 6;
}

}  // namespace

void write_segments_csv(const Strips& strips, std::ostream& out) {
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
      text(strips.x[q], ",", v, ",", strips.z[q], ",", strips.x[q + 1], ",", v, ",",
           strips.z[q + 1], ",", length, ",", tag(kind, strips.level[p]), ",", strips.level[p], ",",
           strips.slice[s] + 1, ",", between_branches ? 1 : 0, ",", 2.0 * width, "\n");
    }
  }
}

}  // namespace popcut
