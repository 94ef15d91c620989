// SPDX-License-Identifier: MIT
#include "daemon/cli/input/expectation.hpp"

#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/drawing/clean.hpp"
#include "core/plan/drawing_transform.hpp"
#include "core/plan/knife/blade.hpp"
#include "core/plan/pens.hpp"
#include "core/text/json_text.hpp"
#include "daemon/cli/input/drawing_input.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace {

const nlohmann::json* find(const nlohmann::json& from, const std::string& pointer) {
  const nlohmann::json::json_pointer at(pointer);
  return from.contains(at) ? &from.at(at) : nullptr;
}

// Reads lists of a plan; the first thing that is not as it should be is kept.
class Reader {
 public:
  explicit Reader(const nlohmann::json& plan) : plan_(plan) {}

  const nlohmann::json& list(const std::string& pointer) {
    static const nlohmann::json kNone = nlohmann::json::array();
    const nlohmann::json* found = find(plan_, pointer);
    if (found != nullptr && found->is_array()) return *found;
    fault(pointer, "give a list");
    return kNone;
  }

  std::size_t piece(const std::string& pointer) {
    const nlohmann::json* found = find(plan_, pointer);
    if (found != nullptr && found->is_number_unsigned() && *found >= 1)
      return found->get<std::size_t>();
    fault(pointer, "give the number of a piece");
    return 0;
  }

  std::vector<PagePoint> points(const std::string& pointer, std::size_t least) {
    std::vector<PagePoint> out;
    for (const nlohmann::json& point : list(pointer)) {
      if (!point.is_array() || point.size() != 2 || !point[0].is_number() ||
          !point[1].is_number()) {
        fault(pointer, "give points as [x, y] in mm");
        return std::vector<PagePoint>(least);
      }
      out.push_back({point[0].get<double>(), point[1].get<double>()});
    }
    if (out.size() < least) {
      fault(pointer, "give more points");
      out.resize(least);
    }
    return out;
  }

  Placement placement(const std::string& pointer) {
    Placement t;
    const std::pair<const char*, double*> numbers[] = {{"/0/0", &t.xx}, {"/0/1", &t.xy},
                                                       {"/0/2", &t.x0}, {"/1/0", &t.yx},
                                                       {"/1/1", &t.yy}, {"/1/2", &t.y0}};
    for (const auto& [at, value] : numbers) {
      const nlohmann::json* found = find(plan_, pointer + at);
      if (found != nullptr && found->is_number())
        *value = found->get<double>();
      else
        fault(pointer + at, "give a number");
    }
    return t;
  }

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  void fault(const std::string& pointer, const char* right) {
    if (!error_)
      error_ = Error{ErrorKind::Malformed, pointer, fmt::format("is missing or wrong; {}", right)};
  }

  const nlohmann::json& plan_;
  std::optional<Error> error_;
};

// Reads the pieces that lie on a sheet of a split plan, with their seams and tabs. `sheet` is the
// sheet's JSON pointer, as in "/sheets/0".
//
// @retval Malformed  not of a plan's form; place is a JSON pointer
Result<std::vector<PlannedPiece>> read_split_facts(const nlohmann::json& plan,
                                                   const std::string& sheet) {
  Reader reader(plan);
  std::map<std::size_t, PlannedPiece> pieces;
  const std::string all = sheet + "/pieces", seams = sheet + "/seams", tabs = sheet + "/tabs";
  for (std::size_t i = 0; i < reader.list(all).size(); ++i) {
    const std::string at = fmt::format("{}/{}", all, i);
    PlannedPiece& piece = pieces[reader.piece(at + "/piece")];
    piece.to_sheet = reader.placement(at + "/transform");
    piece.share = reader.points(at + "/share", 3);
  }
  for (std::size_t i = 0; i < reader.list(seams).size(); ++i) {
    const std::string at = fmt::format("{}/{}", seams, i);
    const std::vector<PagePoint> ends = reader.points(at + "/points", 2);
    PlannedPiece::Seam seam{{ends[0], ends[1]}, {}};
    for (std::size_t k = 0; k < reader.list(at + "/glued").size(); ++k) {
      const auto glued = reader.points(fmt::format("{}/glued/{}", at, k), 2);
      seam.glued.push_back({glued[0], glued[1]});
    }
    pieces[reader.piece(at + "/piece")].seams.push_back(std::move(seam));
  }
  for (std::size_t i = 0; i < reader.list(tabs).size(); ++i) {
    const std::string at = fmt::format("{}/{}", tabs, i);
    const std::vector<PagePoint> corners = reader.points(at + "/points", 4);
    pieces[reader.piece(at + "/piece")].tabs.push_back(
        {corners[0], corners[1], corners[2], corners[3]});
  }
  if (reader.error()) return tl::unexpected(*reader.error());
  std::vector<PlannedPiece> out;
  for (auto& [number, piece] : pieces) {
    if (piece.share.empty())
      return fail(ErrorKind::Malformed, all,
                  fmt::format("has no piece {}, which has seams or tabs on this sheet", number));
    out.push_back(std::move(piece));
  }
  return out;
}

constexpr std::uintmax_t kLimitBytes = 256u << 20;

Error wrong(const std::string& pointer, const char* right) {
  return {ErrorKind::Malformed, pointer, fmt::format("is missing or wrong; {}", right)};
}

Result<double> number_at(const nlohmann::json& json, const std::string& pointer) {
  const nlohmann::json* found = find(json, pointer);
  if (found == nullptr || !found->is_number())
    return tl::unexpected(wrong(pointer, "give a number"));
  return found->get<double>();
}

Result<std::string> text_at(const nlohmann::json& json, const std::string& pointer) {
  const nlohmann::json* found = find(json, pointer);
  if (found == nullptr || !found->is_string()) return tl::unexpected(wrong(pointer, "give a name"));
  return found->get<std::string>();
}

Result<void> read_allowed(const nlohmann::json& json, const std::string& pointer, LineWork& into) {
  const nlohmann::json* list = find(json, pointer);
  if (list == nullptr) return {};
  if (!list->is_array()) return tl::unexpected(wrong(pointer, "give a list"));
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string at = fmt::format("{}/{}/points", pointer, i);
    const nlohmann::json* points = find(json, at);
    if (points == nullptr) continue;
    std::vector<PagePoint> line;
    for (const nlohmann::json& point : *points) {
      if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number())
        return tl::unexpected(wrong(at, "give points as [x, y] in mm"));
      line.push_back({point[0].get<double>(), point[1].get<double>()});
    }
    into.append(Operation::Cut, line);
  }
  return {};
}

Result<PlanFacts> facts_of(const nlohmann::json& json, std::size_t number) {
  const nlohmann::json* sheets = json.is_object() ? find(json, "/sheets") : nullptr;
  if (sheets == nullptr || !sheets->is_array())
    return tl::unexpected(wrong("/sheets", "give the plan.json that popcut plan wrote"));
  if (number < 1 || number > sheets->size())
    return fail(ErrorKind::OutOfRange, "/sheets",
                fmt::format("there is no sheet {}; the plan has {}", number, sheets->size()));
  PlanFacts facts;
  const auto machine = text_at(json, "/machine");
  if (!machine) return tl::unexpected(machine.error());
  const auto material = text_at(json, "/material");
  if (!material) return tl::unexpected(material.error());
  facts.machine = *machine;
  facts.material = *material;
  const std::string sheet = fmt::format("/sheets/{}", number - 1);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto side = number_at(json, fmt::format("{}/area_mm/{}", sheet, k));
    if (!side) return tl::unexpected(side.error());
    facts.area_mm[k] = *side;
  }
  Reader reader(json);
  if (find(json, "/layout") != nullptr) {
    auto pieces = read_split_facts(json, sheet);
    if (!pieces) return tl::unexpected(pieces.error());
    facts.pieces = std::move(*pieces);
  } else {
    facts.transform = reader.placement(sheet + "/transform");
  }
  if (find(json, "/drawing_transform") != nullptr)  // plans of before have none
    facts.drawing_transform = reader.placement("/drawing_transform");
  if (find(json, "/copies") != nullptr) facts.copies = reader.points("/copies", 0);
  if (reader.error()) return tl::unexpected(*reader.error());
  if (const auto folds = text_at(json, "/folds")) facts.folds = *folds;
  if (const auto snap = number_at(json, "/snap_mm")) facts.snap_mm = *snap;
  if (const auto most = number_at(json, "/one_pass_mm"); most && *most > 0)
    facts.one_pass_mm = *most;
  if (const nlohmann::json* weld = find(json, "/weld")) facts.weld = *weld == true;
  if (const auto profile = text_at(json, "/svg_profile")) facts.svg_profile = *profile;
  if (const auto layers = text_at(json, "/layers")) {
    auto uses = parse_layer_uses(*layers);
    if (!uses) return tl::unexpected(wrong("/layers", "give names and uses such as \"Wing=fold\""));
    facts.layers = std::move(*uses);
  }
  if (const auto colours = text_at(json, "/colors")) {
    auto uses = parse_colour_uses(*colours);
    if (!uses)
      return tl::unexpected(wrong("/colors", "give colours and uses such as \"red=fold\""));
    facts.colours = std::move(*uses);
  }
  if (const auto dpi = number_at(json, "/svg_dpi"); dpi && *dpi > 0) facts.svg_dpi = *dpi;
  if (const auto page = number_at(json, "/pdf_page"); page && *page >= 1 && *page <= 100'000)
    facts.pdf_page = static_cast<std::uint64_t>(*page);
  if (const auto box = number_at(json, "/weed_box_mm"); box && *box > 0) facts.weed_box_mm = *box;
  if (const nlohmann::json* clip = find(json, "/clip")) facts.clip = *clip == true;
  if (const auto unit = number_at(json, "/unit_mm"); unit && *unit > 0) facts.unit_mm = *unit;
  if (const auto most = number_at(json, "/curve_tolerance_mm"); most && *most > 0)
    facts.curve_tolerance_mm = *most;
  const auto passes = [&](const char* pointer) -> std::optional<int> {
    const auto found = number_at(json, pointer);
    if (!found || !(*found >= 1 && *found <= 20)) return std::nullopt;
    return static_cast<int>(*found);
  };
  facts.cut_passes = passes("/passes/cut");
  facts.fold_passes = passes("/passes/fold");
  facts.score_passes = passes("/passes/score");
  facts.draw_passes = passes("/passes/draw");
  if (find(json, "/pens") != nullptr)
    for (std::size_t i = 0; i < reader.list("/pens").size() && i < kMostPens; ++i) {
      const std::string pen = fmt::format("/pens/{}", i);
      const auto name = text_at(json, pen + "/name");
      if (!name) return tl::unexpected(name.error());
      facts.pens.push_back({.name = *name, .passes = passes((pen + "/passes").c_str())});
    }
  if (const auto offset = number_at(json, sheet + "/blade_offset_mm"))
    facts.blade_offset_mm = *offset;
  if (const nlohmann::json* tools = find(json, sheet + "/blade_tools"); tools && tools->is_array())
    for (const nlohmann::json& tool : *tools)
      if (tool.is_number_integer() && tool >= 1 && tool <= 15)
        facts.blade_tools = static_cast<std::uint16_t>(facts.blade_tools | 1u << tool.get<int>());
  // Marks are listed as they are drawn, but their ends are joined as those of all lines.
  LineWork marks;
  if (auto read = read_allowed(json, sheet + "/marks", marks); !read)
    return tl::unexpected(read.error());
  facts.also_allowed = with_ends_snapped(marks, facts.snap_mm);
  for (const char* list : {"/overcuts", "/lead_ins", "/labels", "/scored"})
    if (auto read = read_allowed(json, sheet + list, facts.also_allowed); !read)
      return tl::unexpected(read.error());
  return facts;
}

/// What the root of a sheet's SVG says of the knife.
KnifeWork sheet_knife(const pugi::xml_node& root) {
  const auto length = [&](const char* name) {
    const double mm = root.attribute(name).as_double();
    return mm > 0.0 && mm < 100.0 ? mm : 0.0;
  };
  KnifeWork knife;
  knife.overcut_mm = length("data-overcut");
  knife.rounds = root.attribute("data-rounds").as_int(1);
  knife.blade_offset_mm = length("data-blade-offset");
  knife.blade_tools =
      static_cast<std::uint16_t>(root.attribute("data-blade-tools").as_uint() & 0xFFFFu);
  return knife;
}

/// The size of an SVG's page where it is in mm, as that of a sheet is.
std::optional<std::array<double, 2>> svg_page_mm(const pugi::xml_document& document) {
  const auto side = [&](const char* name) {
    const std::string_view value = document.document_element().attribute(name).value();
    if (value.size() < 3 || value.substr(value.size() - 2) != "mm") return 0.0;
    return std::strtod(value.data(), nullptr);
  };
  const std::array<double, 2> size{side("width"), side("height")};
  if (!(size[0] > 0 && size[1] > 0)) return std::nullopt;
  return size;
}

// The pattern where the plan puts it: whole, or the pieces that lie on the sheet.
LineWork drawing_on_sheet(const LineWork& pattern, const PlanFacts& plan) {
  const bool whole_drawing = plan.pieces.empty();
  if (whole_drawing && !(plan.one_pass_mm > 0.0))
    return with_ends_snapped(placed(pattern, plan.transform), plan.snap_mm);
  CleanOptions how;
  how.snap_mm = plan.snap_mm;
  how.one_pass_mm = plan.one_pass_mm;
  if (whole_drawing) return clean(placed(pattern, plan.transform), how);
  const LineWork whole = clean(pattern, how);
  const LineIndex lines(whole, 10.0);
  LineWork out;
  for (const PlannedPiece& piece : plan.pieces) {
    const LineWork part = lines_of_piece(whole, lines, piece);
    for (const DrawnLine& line : part.lines) out.append(line.operation, part.points_of(line));
  }
  return out;
}

// A pattern means what it meant to the plan.
Result<SvgReadOptions> reading_of(const PlanFacts& plan, const UserTables& tables) {
  auto profile = find_stroke_profile(plan.svg_profile, tables.texts);
  if (!profile) return tl::unexpected(within("--plan", tables.with_file(profile.error())));
  SvgReadOptions how;
  how.profile = std::move(*profile);
  for (const auto& [name, use] : plan.layers) how.profile.labels[name] = use;
  how.profile.colours = plan.colours;
  how.dpi = plan.svg_dpi;
  how.pdf_page = plan.pdf_page;
  how.weld = plan.weld;
  how.unit_mm = plan.unit_mm;
  for (const PenSettings& pen : plan.pens) how.pens.push_back(pen.name);
  how.tolerance_mm = plan.curve_tolerance_mm;
  how.enlarged = std::hypot(plan.drawing_transform.xx, plan.drawing_transform.yx);
  return how;
}

}  // namespace

void add_knife(const KnifeWork& knife, Expected& expected) {
  expected.blade_offset_mm = knife.blade_offset_mm;
  expected.blade_tools = knife.blade_tools;
  if (!(knife.overcut_mm > 0.0) || knife.blade_tools == 0) return;
  std::vector<PagePoint> part;
  for (const DrawnLine& line : expected.drawing.lines) {
    const auto points = expected.drawing.points_of(line);
    if (!takes_overcut(line.operation, points)) continue;
    const double mm = overcut_for(round_mm(points, knife.rounds), knife.overcut_mm);
    part.clear();
    append_head(points, mm, part);
    expected.also_allowed.append(Operation::Cut, part);
    part.clear();
    append_tail(points, mm, part);
    expected.also_allowed.append(Operation::Cut, part);
  }
}

Result<PlanFacts> read_plan_facts(const std::string& file, std::size_t number) {
  const auto text = read_file(file, kLimitBytes);
  if (!text) return tl::unexpected(text.error());
  const auto json = parse_json_data(*text);
  if (!json) return tl::unexpected(within(file, json.error()));
  auto facts = facts_of(*json, number);
  if (!facts) return tl::unexpected(within(file, facts.error()));
  return facts;
}

Result<Expectation> read_expectation(const std::string& file, const std::optional<PlanFacts>& plan,
                                     const UserTables& tables) {
  const auto how = reading_of(plan.value_or(PlanFacts{}), tables);
  if (!how) return tl::unexpected(how.error());
  auto input = read_drawing(file, *how, tables.texts);
  if (!input) return tl::unexpected(input.error());
  Expectation out;
  if (plan) out.expected.also_allowed = plan->also_allowed;
  pugi::xml_document document;
  const auto text = read_file(file, kLimitBytes);
  const bool is_svg = text && document.load_buffer(text->data(), text->size());
  const bool is_sheet = is_svg && document.document_element().attribute("data-popcut").value() ==
                                      std::string("sheet");
  if (input->drawing.dashed || is_sheet) {
    // A sheet stands where it is cut, line by line as it is drawn.
    out.expected.drawing = std::move(input->drawing);
    out.expected.drawing.dashed = true;
    if (is_svg) {
      out.page_mm = svg_page_mm(document);
      add_knife(sheet_knife(document.document_element()), out.expected);
    }
    return out;
  }
  if (!plan)
    return fail(
        ErrorKind::Usage, "--expect",
        fmt::format("{} is a pattern without a place on the sheet and a material; add --plan "
                    "plan.json, or give the sheet-NN.svg",
                    file));
  const auto material = find_material(plan->material, tables.texts);
  if (!material) return tl::unexpected(within("--plan", tables.with_file(material.error())));
  give_pens(input->drawing, plan->pens);
  for (const PenSettings& pen : plan->pens)
    out.expected.pen_passes.push_back(pen.passes.value_or(0));
  out.expected.drawing = drawing_on_sheet(
      with_weed_box(
          copied(transformed(std::move(input->drawing), plan->drawing_transform), plan->copies),
          plan->weed_box_mm),
      *plan);
  if (plan->clip)
    out.expected.drawing = clipped(out.expected.drawing, plan->area_mm, plan->blade_offset_mm);
  out.expected.folds_whole = plan->folds != "perforate";
  out.expected.blade_offset_mm = plan->blade_offset_mm;
  out.expected.blade_tools = plan->blade_tools;
  out.expected.dashes = material->dashes;
  out.expected.cut_passes = material->cut.passes;
  out.expected.fold_passes = material->fold.passes;
  if (plan->folds == "score" && material->score) out.expected.fold_passes = material->score->passes;
  if (plan->folds == "light" && material->light) out.expected.fold_passes = material->light->passes;
  out.expected.cut_passes = plan->cut_passes.value_or(out.expected.cut_passes);
  out.expected.fold_passes = plan->fold_passes.value_or(out.expected.fold_passes);
  out.expected.draw_passes = plan->draw_passes.value_or(material->draw.passes);
  out.expected.score_passes =
      plan->score_passes.value_or(material->score.value_or(material->draw).passes);
  return out;
}

}  // namespace popcut::cli
