// SPDX-License-Identifier: MIT
// Part of core/formats/write/pattern_files.hpp.
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "core/formats/write/pattern_files.hpp"
#include "core/geometry/page_point.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

struct DxfLayer {
  std::string_view name;
  int colour;  // AutoCAD's index
};

constexpr std::array<DxfLayer, 4> kDxfLayers{
    {{"CUT", 7}, {"FOLD_M", 1}, {"FOLD_V", 5}, {"MARK", 8}}};
// What cutting programs sort by.
constexpr std::array<DxfLayer, 4> kSheetLayers{
    {{"DRAW", 3}, {"SCORE", 4}, {"FOLD", 1}, {"CUT", 7}}};

// In cutting order: no part may move before it is cut.
constexpr std::array<EdgeRole, 4> kDxfOrder{EdgeRole::Mountain, EdgeRole::Valley, EdgeRole::Slit,
                                            EdgeRole::Outline};

std::string_view layer_of(EdgeRole role) {
  if (role == EdgeRole::Mountain) return "FOLD_M";
  return role == EdgeRole::Valley ? "FOLD_V" : "CUT";
}

/// Writes groups: a code on one line and its value on the next.
class Groups {
 public:
  explicit Groups(std::ostream& out) : text_(out) {}

  void put(int code, std::string_view value) { text_(code, "\n", value, "\n"); }
  void put(int code, int value) { text_(code, "\n", value, "\n"); }
  void put_all(std::initializer_list<std::pair<int, std::string_view>> groups) {
    for (const auto& [code, value] : groups) put(code, value);
  }
  void put_point(int code, double x, double y) {
    for (const double value : {x, y, 0.0}) {
      text_(code, "\n");
      text_.put_rounded(value);
      text_.put("\n");
      code += 10;
    }
  }

 private:
  TextSink text_;
};

void put_header(Groups& groups, Box box) {
  if (box.empty()) box = {0, 0, 0, 0};
  groups.put_all({{0, "SECTION"},
                  {2, "HEADER"},
                  {9, "$ACADVER"},
                  {1, "AC1009"},
                  {9, "$INSUNITS"},
                  {70, "4"},
                  {9, "$MEASUREMENT"},
                  {70, "1"},
                  {9, "$EXTMIN"}});
  groups.put_point(10, box.x0, box.y0);
  groups.put(9, "$EXTMAX");
  groups.put_point(10, box.x1, box.y1);
  groups.put(0, "ENDSEC");
}

void put_tables(Groups& groups, std::span<const DxfLayer> layers) {
  groups.put_all({{0, "SECTION"},
                  {2, "TABLES"},
                  {0, "TABLE"},
                  {2, "LTYPE"},
                  {70, "1"},
                  {0, "LTYPE"},
                  {2, "CONTINUOUS"},
                  {70, "0"},
                  {3, "Solid line"},
                  {72, "65"},
                  {73, "0"},
                  {40, "0.0"},
                  {0, "ENDTAB"},
                  {0, "TABLE"},
                  {2, "LAYER"}});
  groups.put(70, static_cast<int>(layers.size()));
  for (const DxfLayer& layer : layers) {
    groups.put(0, "LAYER");
    groups.put(2, layer.name);
    groups.put(70, 0);
    groups.put(62, layer.colour);
    groups.put(6, "CONTINUOUS");
  }
  groups.put(0, "ENDTAB");
  groups.put(0, "ENDSEC");
}

std::string_view layer_of(Operation operation) {
  switch (operation) {
    case Operation::Draw:
      return "DRAW";
    case Operation::Score:
      return "SCORE";
    case Operation::FoldMountain:
    case Operation::FoldValley:
      return "FOLD";
    default:
      return "CUT";
  }
}

}  // namespace

void write_sheet_dxf(const LineWork& drawing, const std::array<double, 2>& page_mm,
                     std::ostream& out) {
  const double height = page_mm[1];  // the y axis goes up, from the lower edge
  Box box;
  for (const DrawnLine& line : drawing.lines)
    for (const PagePoint& p : drawing.points_of(line)) box.add({p.x, height - p.y});
  Groups groups(out);
  put_header(groups, box);
  put_tables(groups, kSheetLayers);
  groups.put_all({{0, "SECTION"}, {2, "ENTITIES"}});
  for (const DrawnLine& line : drawing.lines) {
    const auto points = drawing.points_of(line);
    const std::string_view layer = layer_of(line.operation);
    if (points.size() == 2) {
      groups.put_all({{0, "LINE"}, {8, layer}});
      groups.put_point(10, points[0].x, height - points[0].y);
      groups.put_point(11, points[1].x, height - points[1].y);
      continue;
    }
    const bool ring = points.size() > 3 && closed(points);
    groups.put_all({{0, "POLYLINE"}, {8, layer}, {66, "1"}, {70, ring ? "1" : "0"}});
    groups.put_point(10, 0, 0);
    for (const PagePoint& p : points.first(points.size() - (ring ? 1 : 0))) {
      groups.put_all({{0, "VERTEX"}, {8, layer}});
      groups.put_point(10, p.x, height - p.y);
    }
    groups.put_all({{0, "SEQEND"}, {8, layer}});
  }
  groups.put_all({{0, "ENDSEC"}, {0, "EOF"}});
}

void write_pattern_dxf(const Pattern& pattern, std::ostream& out) {
  Groups groups(out);
  Box box;
  for (const SheetLine& line : pattern.lines) {
    box.add({line.v0, -line.u0});
    box.add({line.v1, -line.u1});
  }
  put_header(groups, box);
  put_tables(groups, kDxfLayers);
  groups.put(0, "SECTION");
  groups.put(2, "ENTITIES");
  for (const EdgeRole role : kDxfOrder) {
    for (const SheetLine& line : pattern.lines) {
      if (line.role != role) continue;
      groups.put(0, "LINE");
      groups.put(8, layer_of(role));
      groups.put_point(10, line.v0, -line.u0);
      groups.put_point(11, line.v1, -line.u1);
    }
  }
  groups.put(0, "ENDSEC");
  groups.put(0, "EOF");
}

}  // namespace popcut
