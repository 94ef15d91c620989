// SPDX-License-Identifier: MIT
// Part of core/plan/plan.hpp.
#include <cmath>
#include <iterator>

#include <fmt/compile.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hands/handwork_json.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "core/text/json_text.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

// Round to nanometres: more digits would only make files differ between machines.
double rounded(double mm) { return std::round(mm * 1e6) / 1e6; }

Json blade_tools(const KnifeWork& knife) {
  Json tools = Json::array();
  for (int tool = 1; tool < 16; ++tool)
    if (knife.blade(tool)) tools.push_back(tool);
  return tools;
}

// Runs of consecutive strokes of one operation, in the order of cutting.
Json operations(const Toolpath& path, const std::vector<PenSettings>& pens) {
  Json list = Json::array();
  for (std::size_t i = 0; i < path.strokes.size();) {
    const Operation operation = path.strokes[i].operation;
    const auto kind = [](Operation o) { return is_fold(o) ? Operation::FoldMountain : o; };
    double mm = 0.0;
    std::size_t j = i;
    const auto goes_on = [&](const Stroke& stroke) {
      return kind(stroke.operation) == kind(operation) && stroke.pen == path.strokes[i].pen;
    };
    for (; j < path.strokes.size() && goes_on(path.strokes[j]); ++j)
      mm += length(path.points_of(path.strokes[j]));
    const Stroke& first = path.strokes[i];
    list.push_back({{"operation", is_fold(operation) ? "fold" : operation_name(operation)},
                    {"strokes", j - i},
                    {"mm", rounded(mm)},
                    {"tool", first.tool},
                    {"force_gf", first.force_gf},
                    {"speed_mm_s", first.speed_mm_s}});
    if (first.pen > 0) list.back()["pen"] = pens.at(first.pen - 1u).name;
    i = j;
  }
  return list;
}

Json transform_json(const Placement& t) { return {{t.xx, t.xy, t.x0}, {t.yx, t.yy, t.y0}}; }

// A piece's part of the pattern without tabs, in pattern mm.
Json share_json(const SheetPiece& piece) {
  return json_list(piece.share, [](const PagePoint& p) { return Json{p.x, p.y}; });
}

// The registration marks of a printed sheet.
Json registration_json(const std::optional<MarkLayout>& marks) {
  if (!marks) return {};
  return {{"left_mm", marks->left_mm},     {"top_mm", marks->top_mm},
          {"width_mm", marks->width_mm},   {"height_mm", marks->height_mm},
          {"arm_mm", marks->arm_mm},       {"line_mm", marks->line_mm},
          {"square_mm", marks->square_mm}, {"corners", marks->four_corners ? 4 : 3}};
}

// The pieces of a sheet. Numbers count from 1 over the whole plan.
Json pieces_json(const Plan& plan, const PlannedSheet& sheet) {
  Json list = Json::array();
  if (!plan.layout) list.push_back({{"piece", 1}, {"transform", transform_json(sheet.transform)}});
  for (const std::uint32_t piece : sheet.pieces)
    list.push_back({{"piece", piece + 1},
                    {"transform", transform_json(plan.layout->pieces[piece].transform)},
                    {"share", share_json(plan.layout->pieces[piece])}});
  return list;
}

Json sheet_json(const Plan& plan, const PlannedSheet& sheet, std::size_t number) {
  const KnifeWork& knife = sheet.knife;
  const bool driven = plan.machine.driven();
  Json json{
      {"name", fmt::format("sheet-{:02}", number)},
      {"mat", sheet.mat.name},
      {"area_mm", sheet.area_mm},
      {"cut_mm", rounded(sheet.cut_mm)},
      {"fold_mm", rounded(sheet.fold_mm)},
      {"fold_line_mm", rounded(sheet.fold_line_mm)},
      {"travel_mm", rounded(sheet.travel_mm)},
      {"travel_s", rounded(sheet.travel_s)},
      {"feed_out_mm", sheet.feed_out_mm ? Json(rounded(*sheet.feed_out_mm)) : Json()},
      {"travel_input_mm", rounded(sheet.travel_input_mm)},
      {"home_mm", rounded(sheet.home_mm)},
      {"lifts", sheet.path.strokes.size()},
      {"paths", sheet.paths},
      {"order_moves", sheet.order_moves},
      {"order_finished", sheet.order_finished},
      {"seconds", driven ? Json(rounded(sheet.seconds)) : Json()},
      {"seconds_range",
       driven ? Json{rounded(sheet.seconds_range[0]), rounded(sheet.seconds_range[1])} : Json()},
      {"transform", sheet.pieces.size() > 1 ? Json() : transform_json(sheet.transform)},
      {"pieces", pieces_json(plan, sheet)},
      {"operations", operations(sheet.sent_path(), plan.material.pens)},
      {"overcut_mm", knife.overcut_mm},
      {"blade_offset_mm", knife.blade_offset_mm},
      {"blade_tools", blade_tools(knife)},
      {"registration", registration_json(sheet.registration)},
      {"tabs", Json::array()},
      {"seams", Json::array()},
      {"marks", Json::array()},
      {"scored", Json::array()},
      {"overcuts", Json::array()},
      {"lead_ins", Json::array()}};
  if (!plan.parts.empty()) {
    json["parts"] = Json::array();
    for (const PartOnSheet& part : parts_on_sheet(plan, number - 1))
      json["parts"].push_back({{"name", part.name},
                               {"box",
                                {rounded(part.box.x0), rounded(part.box.y0), rounded(part.box.x1),
                                 rounded(part.box.y1)}}});
  }
  return json;
}

Json points_json(std::span<const PagePoint> points, const Placement& to_sheet) {
  return json_list(points, [&](const PagePoint& p) {
    const PagePoint q = to_sheet(p);
    return Json{rounded(q.x), rounded(q.y)};
  });
}

// A long list with one entry per line; it ends when this goes.
class EntryLines {
 public:
  explicit EntryLines(std::string& text) : text_(text) { text_ += '['; }
  EntryLines(const EntryLines&) = delete;
  EntryLines& operator=(const EntryLines&) = delete;
  ~EntryLines() { text_ += any_ ? "\n      ]" : "]"; }
  void next() {
    text_ += any_ ? ",\n        " : "\n        ";
    any_ = true;
  }

 private:
  std::string& text_;
  bool any_{false};
};

// Writes long lists with one entry per line; `put` appends an entry to the text.
template <typename Entry, typename Put>
void append_lines(std::string& text, const std::vector<Entry>& entries, Put&& put) {
  EntryLines lines(text);
  for (const Entry& entry : entries) {
    lines.next();
    put(text, entry);
  }
}
void append_lines(std::string& text, const std::vector<Json>& entries) {
  append_lines(text, entries, [](std::string& out, const Json& entry) { out += entry.dump(); });
}

// Marks and borders that splitting put on a sheet, in sheet mm.
struct SplitLists {
  std::vector<Json> tabs, seams, marks;
};

SplitLists split_lists(const Layout& layout, const PlannedSheet& sheet) {
  SplitLists out;
  const auto here = [&](std::uint32_t piece) { return layout.pieces[piece].sheet; };
  const std::uint32_t number = here(sheet.pieces.front());
  for (const Tab& tab : layout.tabs)
    if (here(tab.on) == number)
      out.tabs.push_back({{"seam", layout.seams[layout.runs[tab.run].seam].label},
                          {"piece", tab.on + 1},
                          {"under", tab.under + 1},
                          {"points", points_json(tab.corners, layout.pieces[tab.on].transform)}});
  for (const SeamRun& run : layout.runs)
    for (const auto& [piece, other] :
         {std::pair{run.lower, run.upper}, std::pair{run.upper, run.lower}}) {
      if (here(piece) != number) continue;
      const AxisLine line{run.vertical, run.at};
      Json glued = Json::array();
      for (const SeamStretch& s : run.uncut)
        glued.push_back(points_json(std::array{line.point(s.from, 0), line.point(s.to, 0)},
                                    layout.pieces[piece].transform));
      out.seams.push_back(
          {{"seam", layout.seams[run.seam].label},
           {"piece", piece + 1},
           {"other", other + 1},
           {"points", points_json(std::array{line.point(run.from, 0), line.point(run.to, 0)},
                                  layout.pieces[piece].transform)},
           {"glued", std::move(glued)}});
    }
  for (const std::uint32_t i : sheet.pieces) {
    const SheetPiece& piece = layout.pieces[i];
    for (std::size_t l = piece.first_mark; l < piece.work.lines.size(); ++l)
      out.marks.push_back(
          {{"piece", i + 1},
           {"points", points_json(piece.work.points_of(piece.work.lines[l]), piece.transform)}});
  }
  return out;
}

// How to glue the pieces together.
void add_layout(const Layout& layout, Json& json) {
  Json seams = json_list(layout.seams, [](const PieceSeam& seam) {
    return Json{{"seam", seam.label},
                {"pieces", {seam.lower + 1, seam.upper + 1}},
                {"glue_mm", rounded(seam.glue_mm)}};
  });
  Json steps = json_list(layout.steps, [&](const std::vector<std::uint32_t>& step) {
    return json_list(step, [&](std::uint32_t seam) { return layout.seams[seam].label; });
  });
  json["layout"] = {{"pieces", layout.pieces.size()},     {"least_sheets", layout.least_sheets},
                    {"glue_mm", rounded(layout.glue_mm)}, {"tabs", layout.tabs.size()},
                    {"seams", std::move(seams)},          {"steps", std::move(steps)}};
  const SheetUse& use = layout.use;
  json["layout"]["use"] = {{"paper_mm2", std::round(use.paper_mm2)},
                           {"share", std::round(use.share() * 1e4) / 1e4},
                           {"rows_share", std::round(use.rows_share() * 1e4) / 1e4},
                           {"rows_sheets", use.rows_sheets}};
}

void append_entry(std::string& text, const KnifeMarks& marks, const KnifeMarks::Mark& mark) {
  fmt::format_to(std::back_inserter(text), FMT_COMPILE("{{\"stroke\":{},\"points\":["),
                 mark.stroke);
  for (const PagePoint& p : marks.points_of(mark)) {
    text += text.back() == ']' ? ",[" : "[";
    append_rounded(text, p.x);
    text += ',';
    append_rounded(text, p.y);
    text += ']';
  }
  text += "]}";
}

// There may be a hundred thousand entries: they are made some at a time and written without
// building a JSON tree.
void append_entries(std::string& text, const PlannedSheet& sheet,
                    std::vector<KnifeMarks::Mark> KnifeMarks::*list) {
  constexpr std::size_t kAtOnce = 4096;
  EntryLines lines(text);
  for (std::size_t first = 0; first < sheet.path.strokes.size(); first += kAtOnce) {
    const KnifeMarks marks = knife_marks(sheet.path, sheet.knife, first, kAtOnce);
    for (const KnifeMarks::Mark& mark : marks.*list) {
      lines.next();
      append_entry(text, marks, mark);
    }
  }
}

void append_entries(std::string& text, const Polylines& polylines) {
  std::vector<Json> list;
  for (std::size_t i = 0; i < polylines.size(); ++i)
    list.push_back({{"points", points_json(polylines[i], {})}});
  append_lines(text, list);
}

// Copies a text and fills its empty lists, in their order.
class ListFiller {
 public:
  explicit ListFiller(std::string text) : text_(std::move(text)) {
    from_ = text_.find("\"sheets\": [");
    out_.reserve(text_.size());
    out_.assign(text_, 0, from_);
  }

  // `append(out)` writes what stands in place of the next empty list of this name.
  template <typename Append>
  void fill(const char* name, Append&& append) {
    const std::string empty = fmt::format("\"{}\": []", name);
    const std::size_t at = text_.find(empty, from_) + empty.size();
    out_.append(text_, from_, at - 2 - from_);
    from_ = at;
    append(out_);
  }

  std::string rest() && {
    out_.append(text_, from_);
    return std::move(out_);
  }

 private:
  std::string text_, out_;
  std::size_t from_{};
};

Json copies_json(const std::vector<PagePoint>& copies) {
  Json list = Json::array();
  for (const PagePoint& at : copies) list.push_back({at.x, at.y});
  return list;
}

const ToolSettings& fold_tool(const Plan& plan) {
  const Material& material = plan.material;
  if (plan.folds == FoldMode::Score && material.score) return *material.score;
  if (plan.folds == FoldMode::Light && material.light) return *material.light;
  return material.fold;
}

Json passes_json(const Plan& plan) {
  const Material& material = plan.material;
  return {{"cut", material.cut.passes},
          {"fold", fold_tool(plan).passes},
          {"score", material.score.value_or(material.draw).passes},
          {"draw", material.draw.passes}};
}

// The pens of colours, layers and operations, with the passes that each gives its lines.
Json pens_json(const Plan& plan) {
  Json list = Json::array();
  for (const PenSettings& pen : plan.material.pens)
    list.push_back({{"name", pen.name}, {"passes", pen.passes ? Json(*pen.passes) : Json()}});
  return list;
}

}  // namespace

std::string plan_json(const Plan& plan) {
  Json json{{"name", plan.name},
            {"machine", plan.machine.name},
            {"material", plan.material.name},
            {"gap_mm", plan.material.dashes.gap_mm},
            {"folds", fold_mode_name(plan.folds)},
            {"snap_mm", plan.snap_mm},
            {"one_pass_mm", plan.one_pass_mm},
            {"weld", plan.weld},
            {"svg_profile", plan.svg_profile},
            {"layers", plan.layers},
            {"colors", plan.colors},
            {"drawing_transform", transform_json(plan.drawing_transform)},
            {"copies", copies_json(plan.copies)},
            {"weed_box_mm", plan.weed_box_mm},
            {"clip", plan.clip},
            {"passes", passes_json(plan)},
            {"pens", pens_json(plan)},
            {"unit_mm", plan.unit_mm ? Json(*plan.unit_mm) : Json()},
            {"svg_dpi", plan.svg_dpi},
            {"pdf_page", plan.pdf_page},
            {"curve_tolerance_mm", plan.curve_tolerance_mm},
            {"sheets", Json::array()},
            {"handwork", plan.handwork ? hands::handwork_json(*plan.handwork) : Json()},
            {"warnings", messages_of(plan.warnings)},
            {"seed", plan.seed}};
  if (plan.layout) add_layout(*plan.layout, json);
  for (std::size_t i = 0; i < plan.sheets.size(); ++i)
    json["sheets"].push_back(sheet_json(plan, plan.sheets[i], i + 1));
  ListFiller text(json_file(json));
  for (const PlannedSheet& sheet : plan.sheets) {
    if (plan.layout) {
      const SplitLists split = split_lists(*plan.layout, sheet);
      text.fill("tabs", [&](std::string& out) { append_lines(out, split.tabs); });
      text.fill("seams", [&](std::string& out) { append_lines(out, split.seams); });
      text.fill("marks", [&](std::string& out) { append_lines(out, split.marks); });
    }
    text.fill("scored", [&](std::string& out) { append_entries(out, sheet.scored); });
    text.fill("overcuts",
              [&](std::string& out) { append_entries(out, sheet, &KnifeMarks::overcuts); });
    text.fill("lead_ins",
              [&](std::string& out) { append_entries(out, sheet, &KnifeMarks::lead_ins); });
  }
  return std::move(text).rest();
}

}  // namespace popcut
