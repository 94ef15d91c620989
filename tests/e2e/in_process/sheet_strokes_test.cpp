// SPDX-License-Identifier: MIT
// The strokes of a sheet, for those who draw them: the same as in its program, its drawing, and
// what a simulated cutter does with it.
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "daemon/planning/program_file.hpp"
#include "daemon/planning/work.hpp"
#include "device/sim/simulate.hpp"
#include "tests/support/paths.hpp"

namespace sheet_strokes_test {

using namespace popcut;
using Catch::Matchers::WithinAbs;
using nlohmann::json;
using popcut::testing::source_file;
using popcut::testing::text_of_file;
using Files = std::map<std::string, std::string>;
using Points = std::vector<PagePoint>;

namespace {

struct Case {
  const char* name;
  std::string design, kind;
  std::map<std::string, std::string> options{};
  std::string machine{"cameo3"}, material{"paper-220"};
  std::string material_json{};  ///< members beyond those of `material`
  int sheets{1};
};

struct Made {
  daemon::PlanningOutcome outcome;
  Files files;
};

Made planned(const Case& c) {
  planning::WorkerTask task{.kind = daemon::PlanningTask::Kind::Plan, .design_kind = c.kind};
  task.material_json =
      fmt::format(R"({{"name": "m", "like": "{}", "title": "M"{}}})", c.material, c.material_json);
  task.machine_json = fmt::format(R"({{"name": "ours", "like": "{}", "title": "T"}})", c.machine);
  task.options = c.options;
  if (c.kind == "svg") task.options["svg-profile"] = "origami-sim";  // red and blue are folds
  task.design = c.design;
  Made made;
  const auto outcome = planning::perform(
      std::move(task), [&](const std::string& name, std::string bytes) -> Result<void> {
        made.files[name] = std::move(bytes);
        return {};
      });
  INFO(c.name << ": " << (outcome ? "" : message(outcome.error())));
  REQUIRE(outcome);
  made.outcome = *outcome;
  return made;
}

struct Drawn {
  json text;
  std::vector<Points> strokes;
};

Drawn strokes_of(const std::string& file) {
  Drawn out{json::parse(file), {}};
  std::size_t at = 0;
  const json& xy = out.text.at("xy_mm");
  for (const json& count : out.text.at("stroke").at("points")) {
    Points points;
    for (int i = 0; i < count.get<int>(); ++i, at += 2)
      points.push_back({xy.at(at).get<double>(), xy.at(at + 1).get<double>()});
    out.strokes.push_back(std::move(points));
  }
  CHECK(at == xy.size());
  return out;
}

// The paths of the sheet's drawing by their place in the order of cutting.
std::vector<Points> paths_of(const std::string& svg) {
  pugi::xml_document document;
  REQUIRE(document.load_string(svg.c_str()));
  std::map<int, Points> sorted;
  for (const pugi::xpath_node& node : document.select_nodes("//*[@data-order]")) {
    std::string data = node.node().attribute("d").value();
    for (char& c : data)
      if (c == 'M' || c == 'L' || c == ',') c = ' ';
    std::istringstream numbers(data);
    Points& points = sorted[node.node().attribute("data-order").as_int()];
    for (PagePoint p; numbers >> p.x >> p.y;) points.push_back(p);
  }
  std::vector<Points> out;
  for (auto& [order, points] : sorted) out.push_back(std::move(points));
  return out;
}

// Whether `a` goes through the points of `b` in their order, and through no other place: points
// that fall together in steps of the machine are one.
bool same_way(const Points& a, const Points& b, double within_mm) {
  const auto near = [&](const PagePoint& p, const PagePoint& q) {
    return std::abs(p.x - q.x) <= within_mm && std::abs(p.y - q.y) <= within_mm;
  };
  // Where `b` may be when `a` is at a point: a tie may have been rounded to either side.
  std::set<std::size_t> at{0};
  for (const PagePoint& p : a) {
    std::set<std::size_t> then;
    for (const std::size_t i : at)
      for (const std::size_t k : {i, i + 1})
        if (k < b.size() && near(p, b[k])) then.insert(k);
    at = std::move(then);
  }
  return at.contains(b.size() - 1);
}

void compare(const Case& c, const Made& made, int sheet) {
  const std::string name = fmt::format("sheet-{:02}", sheet);
  CAPTURE(c.name, name);
  const Drawn drawn = strokes_of(made.files.at(name + ".strokes.json"));
  const daemon::SheetPlan& plan = made.outcome.sheets.at(static_cast<std::size_t>(sheet - 1));
  const bool is_hpgl = made.files.contains(name + ".hpgl");
  const std::string bytes = made.files.at(name + (is_hpgl ? ".hpgl" : ".gpgl"));
  const auto program = planning::read_program(made.files.at(name + ".program.json"), bytes);
  REQUIRE(program);
  // 1. The program: path i is stroke i.
  const json& lists = drawn.text.at("stroke");
  REQUIRE(drawn.strokes.size() == program->strokes.size());
  REQUIRE(static_cast<int>(drawn.strokes.size()) == plan.paths);
  for (const char* list : {"kind", "piece", "pass", "start_s", "end_s", "points"})
    REQUIRE(lists.at(list).size() == drawn.strokes.size());
  CHECK(drawn.text.at("sheet") == sheet);
  CHECK_THAT(drawn.text.at("width_mm").get<double>(), WithinAbs(plan.area_mm[0], 1e-6));
  CHECK_THAT(drawn.text.at("length_mm").get<double>(), WithinAbs(plan.area_mm[1], 1e-6));
  CHECK((drawn.text.at("mat").is_null() ? "" : drawn.text.at("mat").get<std::string>()) ==
        plan.mat);
  CHECK(drawn.text.at("side") == plan.side);
  // 2. The drawing of the sheet: the same strokes in the same order, without what the knife adds.
  const std::vector<Points> paths = paths_of(made.files.at(name + ".svg"));
  REQUIRE(paths.size() == drawn.strokes.size());
  const json sheet_json =
      json::parse(made.files.at("plan.json")).at("sheets").at(static_cast<std::size_t>(sheet - 1));
  const bool adds = sheet_json.at("overcut_mm").get<double>() > 0 ||
                    sheet_json.at("blade_offset_mm").get<double>() > 0;
  int longer = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    CAPTURE(i);
    const auto near = [&](const PagePoint& p) {
      return std::any_of(drawn.strokes[i].begin(), drawn.strokes[i].end(), [&](const PagePoint& q) {
        return std::abs(p.x - q.x) < 2 && std::abs(p.y - q.y) < 2;
      });
    };
    if (!adds) {
      REQUIRE(paths[i].size() == drawn.strokes[i].size());
      // Both are rounded, to 1e-6 and to 1e-3 mm.
      REQUIRE(same_way(paths[i], drawn.strokes[i], 0.000502));
    } else {
      REQUIRE(std::all_of(paths[i].begin(), paths[i].end(), near));
      if (drawn.strokes[i].size() != paths[i].size()) ++longer;
    }
  }
  if (std::string_view(c.name).starts_with("overcut")) CHECK(longer > 0);
  // 3. What a cutter does.
  const auto machine = find_machine(c.machine);
  REQUIRE(machine);
  const auto trace =
      simulate(std::as_bytes(std::span(bytes)), *machine,
               {.page_width_mm = plan.area_mm[0], .page_length_mm = plan.area_mm[1]});
  REQUIRE(trace);
  REQUIRE(trace->strokes.size() + program->dots.size() == drawn.strokes.size());
  PagePoint shift{};
  if (!sheet_json.at("registration").is_null())
    shift = {sheet_json.at("registration").at("left_mm").get<double>(),
             sheet_json.at("registration").at("top_mm").get<double>()};
  const double within = machine->unit_mm / 2 + 0.000501;
  std::size_t next = 0;
  const std::set<std::uint32_t> dots(program->dots.begin(), program->dots.end());
  bool shifted = true;
  for (std::size_t i = 0; i < drawn.strokes.size(); ++i) {
    if (dots.contains(static_cast<std::uint32_t>(i))) continue;
    const auto cut = trace->points_of(trace->strokes[next++]);
    Points moved(cut.begin(), cut.end());
    CAPTURE(i, moved.front().x, moved.front().y, drawn.strokes[i].front().x,
            drawn.strokes[i].front().y);
    // The simulator says where the sheet is cut, with marks too.
    shifted = shifted && same_way(drawn.strokes[i], moved, within);
    REQUIRE(shifted);
  }
  CHECK(next == trace->strokes.size());
  // 4. Times: one after the other, within the time of the sheet.
  double before = 0;
  for (std::size_t i = 0; i < drawn.strokes.size(); ++i) {
    const double start = lists.at("start_s").at(i), end = lists.at("end_s").at(i);
    REQUIRE(start >= before - 0.0011);
    REQUIRE(end > start);
    before = end;
  }
  CHECK(before < plan.seconds);
  CHECK(before > 0.5 * plan.seconds);
  // The first stroke begins after the settings, the last ends before the tool goes home.
  CHECK(lists.at("start_s").at(0) >= machine->motion.setup_s);
  CHECK(plan.seconds - before >= machine->motion.trailer_s - 0.001);
  // 5. The box.
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  for (const Points& points : drawn.strokes)
    for (const PagePoint& p : points)
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y),
      y1 = std::max(y1, p.y);
  const json& box = drawn.text.at("drawing_mm");
  CHECK_THAT(box.at(0).get<double>(), WithinAbs(x0, 0.0011));
  CHECK_THAT(box.at(1).get<double>(), WithinAbs(y0, 0.0011));
  CHECK_THAT(box.at(2).get<double>(), WithinAbs(x1 - x0, 0.0021));
  CHECK_THAT(box.at(3).get<double>(), WithinAbs(y1 - y0, 0.0021));
}

std::string example(const char* name) {
  return text_of_file(source_file(fmt::format("examples/{}.json", name)));
}

const std::string kRing =
    "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>"
    "<path fill='none' stroke='black' d='M10,10H90V50H10Z'/>"
    "<path fill='none' stroke='black' d='M20,20C30,10 40,40 50,20'/>"
    "<path fill='none' stroke='#ff0000' d='M10,30H90'/>"
    "<path fill='none' stroke='#0000ff' d='M10,40H90'/></svg>";

std::map<std::string, int> kinds_in(const Drawn& drawn) {
  std::map<std::string, int> counts;
  for (const json& kind : drawn.text.at("stroke").at("kind"))
    ++counts[drawn.text.at("kinds").at(kind.get<std::size_t>()).get<std::string>()];
  return counts;
}

}  // namespace

TEST_CASE("a sheet's strokes are those of its program, its drawing and the simulated cutter",
          "[daemon][strokes]") {
  const Case cases[] = {
      {"cuts and folds", example("sphere"), "spec"},
      {"a card with many folds", example("facade"), "spec"},
      {"overcut of closed lines", kRing, "svg", {{"overcut", "1.5"}}},
      {"passes", kRing, "svg", {{"pen", "cut: passes=3; fold: passes=2"}}},
      {"passes with more force each", kRing, "svg", {{"folds", "score"}}},
      {"marks", kRing, "svg", {{"marks", "true"}, {"at", "40,40"}}},
      {"a roll", kRing, "svg", {{"mat", "roll"}, {"finish", "below"}}},
      {"free of a mat", kRing, "svg", {{"mat-free", "true"}}},
      {"HPGL with the blade's offset", kRing, "svg", {}, "hpgl-generic"},
      {"many on a sheet", kRing, "svg", {{"per-sheet", "4"}}},
  };
  for (const Case& c : cases) {
    const Made made = planned(c);
    REQUIRE(made.outcome.sheets.size() == 1);
    compare(c, made, 1);
  }
}

TEST_CASE("the strokes of a drawing that is split tell their piece and their marks",
          "[daemon][strokes]") {
  for (const char* labels : {"pen", "cut", "none"}) {
    const Case c{
        "split", example("sphere"), "spec", {{"mat", "80x110"}, {"labels", labels}}, "cameo3"};
    const Made made = planned(c);
    REQUIRE(made.outcome.sheets.size() > 1);
    const json plan = json::parse(made.files.at("plan.json"));
    int marks = 0;
    for (const daemon::SheetPlan& sheet : made.outcome.sheets) {
      compare(c, made, sheet.number);
      const Drawn drawn =
          strokes_of(made.files.at(fmt::format("sheet-{:02}.strokes.json", sheet.number)));
      marks += kinds_in(drawn)["mark"];
      std::set<int> known, seen;
      const json& of_plan = plan.at("sheets").at(static_cast<std::size_t>(sheet.number - 1));
      for (const json& piece : of_plan.at("pieces")) known.insert(piece.at("piece").get<int>());
      for (const json& piece : drawn.text.at("stroke").at("piece")) seen.insert(piece.get<int>());
      CHECK(seen == known);
    }
    CAPTURE(labels);
    CHECK((marks > 0) == (labels != std::string("none")));
  }
}

TEST_CASE("the strokes tell what each is for and which pass it is", "[daemon][strokes]") {
  const Drawn plain = strokes_of(planned({"", kRing, "svg"}).files.at("sheet-01.strokes.json"));
  auto kinds = kinds_in(plain);
  CHECK(kinds["mountain"] > 10);  // dashes
  CHECK(kinds["valley"] > 10);
  CHECK(kinds["cut"] + kinds["outline"] == 2);
  for (const json& pass : plain.text.at("stroke").at("pass")) CHECK(pass == 1);
  for (const json& piece : plain.text.at("stroke").at("piece")) CHECK(piece == 1);
  // Three passes of an open line go there, back and there again; those of a closed one are a
  // stroke.
  const Drawn thrice = strokes_of(
      planned({"", kRing, "svg", {{"pen", "cut: passes=3"}}}).files.at("sheet-01.strokes.json"));
  std::map<int, int> passes;
  for (std::size_t i = 0; i < thrice.strokes.size(); ++i)
    if (thrice.text.at("kinds").at(thrice.text.at("stroke").at("kind").at(i).get<std::size_t>()) ==
        "outline")
      ++passes[thrice.text.at("stroke").at("pass").at(i).get<int>()];
  CHECK(passes == std::map<int, int>{{1, 2}, {2, 1}, {3, 1}});
}

TEST_CASE("a hundred thousand strokes are written in a few megabytes", "[daemon][strokes]") {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='300mm' height='300mm' viewBox='0 0 300 300'>";
  for (int y = 0; y < 317; ++y)
    for (int x = 0; x < 317; ++x)
      svg += fmt::format("<path fill='none' stroke='black' d='M{:.2f},{:.2f}h.5'/>", 1 + 0.94 * x,
                         1 + 0.94 * y);
  const Made made = planned({"many", svg + "</svg>", "svg", {{"order", "quick"}}});
  const std::string& text = made.files.at("sheet-01.strokes.json");
  const Drawn drawn = strokes_of(text);
  CHECK(drawn.strokes.size() == 317 * 317);
  CHECK(text.size() < 8'000'000);
}

}  // namespace sheet_strokes_test
