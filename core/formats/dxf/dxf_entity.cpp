// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_entity.hpp"

#include <utility>

#include <fmt/format.h>

namespace popcut {
namespace {

/// Makes it as new, but its lists keep their memory.
void clear(DxfEntity& e) {
  DxfLists lists = std::move(static_cast<DxfLists&>(e));
  lists.vertices.clear();
  for (auto* numbers : {&lists.knots, &lists.weights}) numbers->clear();
  for (auto* points : {&lists.control, &lists.fit}) points->clear();
  e = {};
  static_cast<DxfLists&>(e) = std::move(lists);
}

/// The coordinate that a group code sets: 10 to 19 x, 20 to 29 y, 30 to 39 z.
double& part(Vec3& p, int code) { return p[code / 10 - 1]; }

/// The vector that collects repeated groups of this code, if the entity's type has one.
bool repeated(DxfEntity& e, int code, double value) {
  if (e.type == "LWPOLYLINE") {
    if (code == 10) e.vertices.push_back({{value, 0, 0}, 0});
    if (code == 20 && !e.vertices.empty()) e.vertices.back().at.y() = value;
    if (code == 42 && !e.vertices.empty()) e.vertices.back().bulge = value;
    return code == 10 || code == 20 || code == 42;
  }
  if (e.type != "SPLINE") return false;
  if (code == 40) e.knots.push_back(value);
  if (code == 41) e.weights.push_back(value);
  for (auto* points : {&e.control, &e.fit}) {
    const int x = points == &e.control ? 10 : 11;
    if (code == x) points->push_back({value, 0, 0});
    if ((code == x + 10 || code == x + 20) && !points->empty()) part(points->back(), code) = value;
    if (code == x || code == x + 10 || code == x + 20) return true;
  }
  return code == 40 || code == 41;
}

void put_real(DxfEntity& e, int code, double value) {
  if (repeated(e, code, value)) return;
  const int axis = code % 10;
  if (code >= 210 && code <= 230 && axis == 0) {
    if (!e.extrusion) e.extrusion = Vec3{0, 0, code == 230 ? 0.0 : 1.0};
    part(*e.extrusion, code - 200) = value;
  } else if (code < 40) {
    if (axis == 0) part(e.p10, code) = value;
    if (axis == 1) part(e.p11, code) = value;
    if (axis == 2) part(e.p12, code) = value, e.tangent_from = true;
    if (axis == 3) part(e.p13, code) = value, e.tangent_to = true;
    if (code == 38) e.elevation = value;
  } else if (code < 50) {
    if (code == 48) e.linetype_scale = value;
    e.real.at(static_cast<std::size_t>(code - 40)) = value;
    e.given.at(static_cast<std::size_t>(code - 40)) = true;
  } else {
    (code == 50 ? e.from_deg : e.to_deg) = value;
  }
}

bool put(DxfCursor& cursor, bool numbers, DxfEntity& e) {
  const DxfGroup& group = cursor.group();
  const int code = group.code;
  int whole = 0;
  if (code == 8) e.layer = group.value;
  if (code == 6) e.linetype = group.value;
  if (code == 2) e.block = group.value;
  if (code == 60 || code == 62 || code == 67 || code == 420 || code == 440 ||
      (code >= 70 && code <= 79)) {
    if (!numbers && code >= 70 && code <= 79) return true;
    if (!cursor.integer(whole)) return false;
    if (code == 60 && whole != 0) e.hidden = true;
    if (code == 62) e.colour = whole, e.hidden = e.hidden || whole < 0;
    if (code == 440 && is_dxf_transparent(whole)) e.hidden = true;
    if (code == 67) e.paper = whole != 0;
    if (code == 420) e.rgb = whole & 0xffffff;
    if (code >= 70 && code <= 79) e.flag.at(static_cast<std::size_t>(code - 70)) = whole;
    return true;
  }
  const bool is_real = (code >= 10 && code <= 51) || code == 210 || code == 220 || code == 230;
  if (!numbers || !is_real) return true;
  double value = 0.0;
  if (!cursor.real(value)) return false;
  put_real(e, code, value);
  for (const std::size_t size :
       {e.vertices.size(), e.knots.size(), e.weights.size(), e.control.size(), e.fit.size()})
    if (size > kMostInDxfEntity)
      return cursor.refuse(
          e.line, fmt::format("the {} has more than {} points; split it", e.type, kMostInDxfEntity),
          ErrorKind::OutOfRange);
  return true;
}

}  // namespace

bool read_dxf_entity(DxfCursor& cursor, bool numbers, DxfEntity& out) {
  clear(out);
  out.type = cursor.group().value;
  out.line = cursor.group().line;
  bool attached = false, embedded = false;
  while (cursor.next()) {
    const DxfGroup& group = cursor.group();
    if (group.code == 0) return true;
    if (group.code == 101) embedded = true;
    if (group.code == 102) attached = !group.value.empty() && group.value.front() == '{';
    if (attached || embedded || group.code >= 1000 || group.code == 102) continue;
    if (!put(cursor, numbers, out)) return false;
  }
  return false;
}

}  // namespace popcut
