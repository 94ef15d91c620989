// SPDX-License-Identifier: MIT
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "daemon/digest/digest.hpp"
#include "daemon/planning/frames.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/program_file.hpp"
#include "daemon/planning/task_json.hpp"
#include "daemon/planning/work.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/planner_bench.hpp"
#include "tests/support/value.hpp"

namespace planner_test {

using namespace popcut;
using namespace popcut::testing;
using nlohmann::json;
using Kind = PlanningTask::Kind;

namespace {

const std::string kExamples = source_file("examples/");
const std::string kSvg =
    "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>"
    "<script>alert(1)</script><path fill='none' stroke='black' d='M10,10H90V50H10Z'/>"
    "<path fill='none' stroke='black' d='M10,30H90'/></svg>";

struct Bench {
  TempFolder temp;
  Outcomes outcomes;
  std::unique_ptr<daemon::Planner> planner;

  explicit Bench(const PlanningLimits& limits = {}, const std::string& program = worker_program()) {
    planner = daemon::make_planner(limits, program);
  }
  [[nodiscard]] PlanningTask task(Kind kind, const std::string& design,
                                  const std::string& design_kind = "") const {
    static int number = 0;
    PlanningTask task;
    task.kind = kind;
    task.design_path = (temp / ("design-" + std::to_string(++number))).string();
    task.design_kind = design_kind;
    write_file(task.design_path, design);
    return task;
  }
  Result<PlanningOutcome> run(PlanningTask task) {
    const std::string name = task.design_path + std::to_string(++count_);
    planner->start(std::move(task), outcomes.slot(name));
    return outcomes.wait(name);
  }
  void refused(PlanningTask task, ErrorKind kind, const std::string& place,
               const std::string& part) {
    const auto outcome = run(std::move(task));
    REQUIRE_FALSE(outcome);
    INFO(message(outcome.error()));
    CHECK(outcome.error().kind == kind);
    CHECK(outcome.error().place == place);
    CHECK(outcome.error().detail.find(part) != std::string::npos);
  }

 private:
  int count_{};
};

/// A task about the sheets of a spec that have marks for print.
planning::WorkerTask marked_sheet(Kind kind, const std::string& spec) {
  planning::WorkerTask task{.kind = kind, .design_kind = "spec"};
  task.machine_json = R"({"name": "ours", "like": "cameo3", "title": "T"})";
  task.material_json = R"({"name": "m", "like": "paper-220", "title": "M"})";
  task.design = spec;
  task.options = {{"marks", "true"}};
  return task;
}

}  // namespace

TEST_CASE("a check detects the kind of a file by its content and redraws it", "[daemon][planner]") {
  Bench bench;
  const struct {
    std::string design, kind;
  } files[] = {{kSvg, "svg"},
               {text_of_file(kExamples + "sphere.json"), "spec"},
               {R"j({"file_spec": 1.1, "vertices_coords": [[0,0],[50,0],[50,50],[0,50]],
                  "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[0,2]],
                  "edges_assignment": ["B","B","B","B","M"]})j",
                "fold"},
               {"0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n30\n21\n40\n0\nENDSEC\n"
                "0\nEOF\n",
                "dxf"}};
  for (const auto& file : files) {
    CAPTURE(file.kind);
    const auto outcome = bench.run(bench.task(Kind::Check, file.design));
    INFO(why(outcome));
    REQUIRE(outcome);
    CHECK(outcome->design_kind == file.kind);
    CHECK(outcome->sheets.empty());
    REQUIRE(outcome->files.size() == 1);
    CHECK(outcome->files[0].name == "preview.svg");
    const std::string& svg = outcome->files[0].bytes;
    pugi::xml_document document;
    REQUIRE(document.load_string(svg.c_str()));
    CHECK(document.child("svg").child("path"));
    CHECK(svg.find("script") == std::string::npos);
    CHECK(svg.find("<text") == std::string::npos);
  }
}

TEST_CASE("a slow design is drawn when it is planned and not when it is checked",
          "[daemon][planner]") {
  Bench bench;
  const std::string surface =
      R"j({"popcut": 1, "widths_mm": 1,
           "surface": {"type": "revolution", "radius": "sqrt(400^2 - (y - 150)^2)"}, )j";
  for (const char* more :
       {R"j("slices": 300, "units_per_slice": 40})j",
        R"j("slices": 40, "units_per_slice": 10, "curvature": {"K_area": 0.0002}})j"}) {
    const auto outcome = bench.run(bench.task(Kind::Check, surface + more));
    INFO(why(outcome));
    REQUIRE(outcome);
    CHECK(outcome->files.at(0).bytes.find("popcut draws it when you") != std::string::npos);
  }
}

TEST_CASE("an invalid design is reported with the place", "[daemon][planner]") {
  Bench bench;
  const auto check = [&](const std::string& text) { return bench.task(Kind::Check, text); };
  bench.refused(check(""), ErrorKind::Malformed, "", "empty");
  bench.refused(check("hello"), ErrorKind::Malformed, "", "is not a design");
  bench.refused(check("{\"a\": 1}"), ErrorKind::Malformed, "", "is not a design");
  bench.refused(check("{\"popcut\": 1, \n \"slices\": }"), ErrorKind::Malformed,
                "line 2, column 12", "");
  json spec = json::parse(text_of_file(kExamples + "sphere.json"));
  spec["slices"] = -3;
  bench.refused(check(spec.dump()), ErrorKind::OutOfRange, "/slices", "");
  spec["slices"] = 10;
  spec["slize"] = 1;
  bench.refused(check(spec.dump()), ErrorKind::Malformed, "/slize", "slices");
  // A path is no asset, whatever it says.
  for (const char* path :
       {"/etc/passwd", "../secret.stl", "sha256-00", "file:///etc/passwd",
        "sha256-00000000000000000000000000000000000000000000000000000000000000/."}) {
    const json mesh{{"popcut", 1},
                    {"surface", {{"type", "mesh"}, {"file", path}}},
                    {"units_per_slice", 5},
                    {"slices", 9},
                    {"widths_mm", 6.5}};
    bench.refused(check(mesh.dump()), ErrorKind::OutOfRange, "/surface/file",
                  "not the id of an asset");
    bench.refused(bench.task(Kind::Plan, mesh.dump()), ErrorKind::OutOfRange, "/surface/file",
                  "not the id of an asset");
  }
  auto options = bench.task(Kind::Plan, kSvg);
  options.options["mat"] = "lots";
  bench.refused(options, ErrorKind::OutOfRange, "/options/mat", "");
  options.options = {{"matt", "12x12"}};
  bench.refused(options, ErrorKind::OutOfRange, "/options/matt", "mat");
  options.options = {{"clip", "perhaps"}};
  bench.refused(options, ErrorKind::OutOfRange, "/options/clip", "true or false");
  options.options = {{"seam-x", "10,,20"}};
  bench.refused(options, ErrorKind::OutOfRange, "/options/seam-x", "numbers");
  options.options = {{"order", "random"}};
  bench.refused(options, ErrorKind::OutOfRange, "/options/order", "one of quick, best, keep");
  options.options.clear();
  options.design_path = (bench.temp / "absent").string();
  bench.refused(options, ErrorKind::Internal, options.design_path, "cannot be read");
}

TEST_CASE("a planner whose caller throws goes on with the tasks of others", "[daemon][planner]") {
  Bench bench;
  for (int k = 0; k < 3; ++k)
    bench.planner->start(bench.task(Kind::Check, kSvg),
                         [](const Result<PlanningOutcome>&) { throw std::bad_alloc(); });
  for (int k = 0; k < 4; ++k) CHECK(bench.run(bench.task(Kind::Check, kSvg)));
}

TEST_CASE("a plan has the same bytes as popcut plan every time", "[daemon][planner]") {
  Bench bench;
  for (const char* example : {"sphere", "packaging", "facade"}) {
    CAPTURE(example);
    const std::string spec = kExamples + example + ".json";
    const auto first = bench.run(bench.task(Kind::Plan, text_of_file(spec), "spec"));
    INFO(why(first));
    REQUIRE(first);
    const Ran ran =
        run_program({popcut_program(), "plan", spec, "-o", "cli", "-q"}, bench.temp.path());
    REQUIRE(ran.exit == 0);
    std::string all;
    for (const daemon::SheetPlan& sheet : first->sheets) {
      const std::string name = fmt::format("sheet-{:02}", sheet.number);
      const PlanningFile* program = file_of(*first, name + ".gpgl");
      const PlanningFile* index = file_of(*first, name + ".program.json");
      REQUIRE(program);
      REQUIRE(index);
      CHECK(program->bytes == text_of_file(bench.temp / ("cli/" + name + ".gpgl")));
      CHECK(sheet.program_sha256 == daemon::sha256_hex(program->bytes));
      CHECK(sheet.cut_mm > 0);
      CHECK(sheet.seconds_range[0] < sheet.seconds);
      CHECK(sheet.area_mm[0] > 100);
      const auto read = value(planning::read_program(index->bytes, program->bytes));
      CHECK(static_cast<int>(read.strokes.size()) == sheet.paths);
      CHECK(file_of(*first, name + ".svg"));
      all += program->bytes;
    }
    CHECK(first->sha256 == daemon::sha256_hex(all));
    for (const char* name : {"plan.json", "assembly.svg", "pattern.svg", "pattern.fold",
                             "deploy.glb", "report.json"}) {
      CAPTURE(name);
      REQUIRE(file_of(*first, name));
      CHECK(file_of(*first, name)->bytes.size() > 100);
    }
    const auto second = value(bench.run(bench.task(Kind::Plan, text_of_file(spec), "spec")));
    CHECK(second.sha256 == first->sha256);
    REQUIRE(second.files.size() == first->files.size());
    for (std::size_t k = 0; k < first->files.size(); ++k) {
      CAPTURE(first->files[k].name);
      CHECK(second.files[k].name == first->files[k].name);
      CHECK(second.files[k].bytes == first->files[k].bytes);
    }
  }
}

TEST_CASE("a spec's mesh is an asset named by its id", "[daemon][planner]") {
  Bench bench;
  // An id has no ending: the bytes tell what they are.
  const auto mesh = testing::sphere_mesh(70, 40, 60);
  const std::string stl =
      GENERATE_REF(testing::binary_stl(mesh), testing::text_stl(mesh), testing::obj(mesh));
  const std::string id = "sha256-" + daemon::sha256_hex(stl);
  write_file(bench.temp / "asset", stl);
  const json spec{{"popcut", 1},          {"surface", {{"type", "mesh"}, {"file", id}}},
                  {"units_per_slice", 5}, {"slices", 8},
                  {"widths_mm", 6},       {"fit", "nearest"}};
  auto task = bench.task(Kind::Check, spec.dump());
  const auto known = bench.run(task);
  INFO(why(known));
  REQUIRE(known);
  CHECK(known->assets == std::vector<std::string>{id});
  CHECK(known->files.at(0).bytes.find("is not uploaded") != std::string::npos);
  task.kind = Kind::Plan;
  bench.refused(task, ErrorKind::OutOfRange, "/surface/file", "no asset " + id);
  task.asset_paths[id] = (bench.temp / "asset").string();
  const auto planned = bench.run(task);
  INFO(why(planned));
  REQUIRE(planned);
  CHECK(planned->assets == std::vector<std::string>{id});
  CHECK(planned->sheets.size() == 1);
  task.kind = Kind::Check;
  const auto seen = value(bench.run(task));
  CHECK(seen.files.at(0).bytes.find("<path") != std::string::npos);
}

TEST_CASE("machine material and options of a task are obeyed", "[daemon][planner]") {
  Bench bench;
  auto task = bench.task(Kind::Plan, kSvg);
  const auto usual = bench.run(task);
  INFO(why(usual));
  REQUIRE(usual);
  task.machine_json = R"j({"name": "ours", "like": "portrait", "title": "Ours"})j";
  task.material_json = R"j({"name": "felt", "like": "paper-220", "title": "Felt"})j";
  task.options = {{"order", "best"}, {"effort", "0.1"}, {"split", "false"}, {"at", "20,30"}};
  const auto own = bench.run(task);
  INFO(why(own));
  REQUIRE(own);
  CHECK(own->sha256 != usual->sha256);
  const json plan = json::parse(file_of(*own, "plan.json")->bytes);
  CHECK(plan.dump().find("\"felt\"") != std::string::npos);
  CHECK(plan.dump().find("\"ours\"") != std::string::npos);
  task.machine_json = R"j({"name": "hpgl", "like": "hpgl-generic", "title": "H"})j";
  const auto hpgl = value(bench.run(task));
  CHECK(file_of(hpgl, "sheet-01.hpgl"));
  auto test_cut = bench.task(Kind::TestCut, "");
  const auto tried = bench.run(test_cut);
  INFO(why(tried));
  REQUIRE(tried);
  CHECK(tried->sheets.size() == 1);
  CHECK(tried->sheets[0].paths > 3);
}

TEST_CASE("a person says where the search for marks begins, and the plan's time includes it",
          "[daemon][planner]") {
  Bench bench;
  const auto planned = [&](std::map<std::string, std::string> options) {
    auto task = bench.task(Kind::Plan, kSvg);
    task.options = std::move(options);
    task.options["at"] = "30,30";
    auto outcome = bench.run(task);
    if (!outcome) FAIL(why(outcome));
    return std::move(*outcome);
  };
  const auto plain = planned({}), marked = planned({{"marks", "true"}});
  // A rectangle of 284.8 x 264.8 mm on the mat of 12 x 12 inches, at 40 mm/s, twice along each
  // side.
  const double search_s = 2 * (284.8 + 264.8) / 40;
  CHECK(marked.sheets[0].seconds - plain.sheets[0].seconds == Approx(search_s).margin(0.01));
  CHECK(marked.sheets[0].seconds_range[1] - plain.sheets[0].seconds_range[1] > search_s);
  const auto chosen =
      planned({{"marks", "true"}, {"mark-start", "0,-2.5"}, {"mark-again", "-4,8"}});
  const std::string& bytes = file_of(chosen, "sheet-01.gpgl")->bytes;
  CHECK_THAT(bytes, Catch::Contains(",250,200\x03"));
  const auto program =
      planning::read_program(file_of(chosen, "sheet-01.program.json")->bytes, bytes);
  REQUIRE(program);
  CHECK(program->search_again == std::vector<std::int64_t>{-80, 160});
  auto task = bench.task(Kind::Plan, kSvg);
  task.options = {{"mark-start", "10,7"}};
  bench.refused(task, ErrorKind::OutOfRange, "/options/mark-start", "add `marks`");
  task.options = {{"marks", "true"}, {"mark-start", "10"}};
  bench.refused(task, ErrorKind::OutOfRange, "/options/mark-start", "give two");
  task.options = {{"marks", "true"}, {"mark-again", "70"}};
  bench.refused(task, ErrorKind::OutOfRange, "/options/mark-again", "50");
}

TEST_CASE("a stored program is read back unchanged and refused if anything is wrong",
          "[daemon][planner]") {
  Bench bench;
  auto task = bench.task(Kind::Plan, kSvg);
  task.options["marks"] = "true";
  task.options["finish"] = "below";
  const auto outcome = bench.run(task);
  INFO(why(outcome));
  REQUIRE(outcome);
  const std::string index = file_of(*outcome, "sheet-01.program.json")->bytes;
  const std::string bytes = file_of(*outcome, "sheet-01.gpgl")->bytes;
  const auto program = planning::read_program(index, bytes);
  INFO((program ? "" : message(program.error())));
  REQUIRE(program);
  CHECK(program->search.begin < program->search.end);
  CHECK(program->geometry.begin == program->search.end);
  CHECK(program->feed_out == ByteRange{program->trailer.end, bytes.size()});
  CHECK(bytes.substr(program->feed_out.begin).find("SO0") != std::string::npos);
  CHECK(planning::program_index(*program) == index);
  CHECK(program->search_again == std::vector<std::int64_t>{60});
  auto wrong_search = nlohmann::json::parse(index);
  for (const nlohmann::json& wrong :
       {nlohmann::json(3), nlohmann::json({1.5}), nlohmann::json({1e9})}) {
    wrong_search["search_again"] = wrong;
    CHECK(planning::read_program(wrong_search.dump(), bytes).error().place == "/search_again");
  }
  auto older = nlohmann::json::parse(index);
  older.erase("trailer");
  CHECK(planning::read_program(older.dump(), bytes)->trailer.end == bytes.size());
  older["trailer"] = program->geometry.end - 1;
  CHECK(planning::read_program(older.dump(), bytes).error().place == "/trailer");
  std::string changed = bytes;
  changed[changed.size() / 2] ^= 1;
  CHECK(planning::read_program(index, changed).error().kind == ErrorKind::CheckFailed);
  CHECK_FALSE(planning::read_program(index, bytes + " "));
  CHECK_FALSE(planning::read_program(index, ""));
  // Any one change of the index is an error, or it is the same program all the same.
  std::mt19937 random(7);
  std::size_t refused = 0;
  for (int k = 0; k < 2000; ++k) {
    CAPTURE(k);
    std::string wrong = index;
    const std::size_t at = random() % wrong.size();
    switch (random() % 3) {
      case 0:
        wrong[at] = "0123456789,[]{}\"-e."[random() % 19];
        break;
      case 1:
        wrong.erase(at, 1 + random() % 8);
        break;
      default:
        wrong.insert(at, 1, "0123456789,[]"[random() % 13]);
    }
    const auto read = planning::read_program(wrong, bytes);
    if (!read) {
      ++refused;
      continue;
    }
    // Whatever is read fills the bytes without gaps.
    std::uint64_t last = 0;
    for (const ByteRange& block : read->setup) {
      CHECK(block.begin == last);
      CHECK(block.end >= block.begin);
      last = block.end;
    }
    last = read->geometry.begin;
    for (const ByteRange& stroke : read->strokes) {
      CHECK(stroke.begin == last);
      last = stroke.end;
    }
    CHECK(last == read->geometry.end);
    CHECK(read->trailer.begin == last);
    CHECK(read->trailer.end >= last);
    CHECK(read->feed_out == ByteRange{read->trailer.end, bytes.size()});
  }
  CHECK(refused > 1000);
}

TEST_CASE("frames arrive in pieces of any size and invalid ones are refused", "[daemon][planner]") {
  using planning::FrameKind;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::vector<planning::Frame> sent;
    std::string all;
    for (std::size_t k = random() % 5 + 1; k-- > 0;) {
      planning::Frame frame{static_cast<FrameKind>(1 + random() % 7),
                            random() % 2 ? "" : "file-" + std::to_string(k),
                            std::string(random() % 300, 'x')};
      all += planning::frame_head(frame.kind, frame.name, frame.bytes.size()) + frame.bytes;
      sent.push_back(std::move(frame));
    }
    planning::FrameReader reader(1 << 20);
    std::vector<planning::Frame> got;
    const auto take = [&](planning::Frame frame) -> Result<void> {
      got.push_back(std::move(frame));
      return {};
    };
    for (std::string_view left = all; !left.empty();) {
      const std::size_t piece = std::min<std::size_t>(left.size(), 1 + random() % 40);
      REQUIRE(reader.feed(left.substr(0, piece), take));
      left.remove_prefix(piece);
    }
    CHECK(reader.at_rest());
    REQUIRE(got.size() == sent.size());
    for (std::size_t k = 0; k < got.size(); ++k) {
      CHECK(got[k].kind == sent[k].kind);
      CHECK(got[k].name == sent[k].name);
      CHECK(got[k].bytes == sent[k].bytes);
    }
    // One wrong byte never makes it take more than was sent.
    planning::FrameReader other(1 << 20);
    std::string broken = all;
    broken[random() % broken.size()] = static_cast<char>(random());
    std::size_t taken = 0;
    const auto counted = [&](planning::Frame frame) -> Result<void> {
      taken += frame.bytes.size();
      return {};
    };
    (void)other.feed(broken, counted);
    CHECK(taken <= all.size());
  }
}

TEST_CASE("a plan says what it is at, phase by phase", "[daemon][planning]") {
  planning::WorkerTask task{.kind = Kind::Plan, .design_kind = "spec"};
  task.machine_json = R"({"name": "ours", "like": "cameo3", "title": "T"})";
  task.material_json = R"({"name": "m", "like": "paper-220", "title": "M"})";
  task.design = text_of_file(kExamples + "sphere.json");
  std::set<std::string> phases;
  const auto outcome = planning::perform(
      std::move(task), [](const std::string&, const std::string&) -> Result<void> { return {}; },
      [&](std::string_view doing, double done) {
        CAPTURE(doing);
        CHECK(planning::phase_of(doing) != "planning");
        const auto read = value(planning::read_phase(planning::phase_json(doing, done)));
        CHECK(read.doing == doing);
        CHECK(read.done == done);
        phases.insert(read.phase);
      });
  REQUIRE(outcome);
  CHECK(phases == std::set<std::string>{"reading", "slicing", "lattice", "checking", "cleaning",
                                        "toolpath", "writing"});
}

TEST_CASE("the artwork of a sheet is drawn only for the program that its plan gave",
          "[daemon][planning][artwork]") {
  const auto task_of = [](Kind kind) {
    return marked_sheet(kind, text_of_file(kExamples + "village.json"));
  };
  std::map<std::string, std::string> files;
  const auto keep = [&](const std::string& name, const std::string& bytes) -> Result<void> {
    files[name] = bytes;
    return {};
  };
  const auto plan = value(planning::perform(task_of(Kind::Plan), keep));
  REQUIRE(plan.sheets.size() == 1);
  files.clear();
  auto task = task_of(Kind::Artwork);
  task.options.insert({{"artwork-sheet", "1"},
                       {"artwork-mode", "view"},
                       {"artwork-dpi", "50"},
                       {"artwork-sha256", plan.sheets[0].program_sha256}});
  const auto drawn = value(planning::perform(task, keep));
  REQUIRE(files.size() == 1);
  CHECK(files["artwork.pdf"].starts_with("%PDF"));
  files.clear();
  task.options["at"] = "17,16";  // as if the plan were made in another way
  const auto other = planning::perform(task, keep);
  REQUIRE_FALSE(other);
  CHECK(other.error().kind == ErrorKind::Infeasible);
  CHECK_THAT(other.error().detail, Catch::Contains("plan the design again"));
  CHECK(files.empty());
}

TEST_CASE("the artwork of cards of layers and of boxes is drawn in a worker",
          "[daemon][planning][artwork]") {
  json house = json::parse(text_of_file(source_file("docs/parts/box-house.json")));
  const std::string style = GENERATE("boxes", "layers");
  CAPTURE(style);
  const std::string glb = text_of_file(kExamples + "house.glb");
  const std::string id = "sha256-" + daemon::sha256_hex(glb);
  house["surface"]["file"] = id;
  house["style"] = style;
  const auto task_of = [&](Kind kind) {
    planning::WorkerTask task = marked_sheet(kind, house.dump());
    task.assets[id] = glb;
    return task;
  };
  std::map<std::string, std::string> files;
  const auto keep = [&](const std::string& name, const std::string& bytes) -> Result<void> {
    files[name] = bytes;
    return {};
  };
  const auto plan = value(planning::perform(task_of(Kind::Plan), keep));
  REQUIRE_FALSE(plan.sheets.empty());
  files.clear();
  auto task = task_of(Kind::Artwork);
  task.options.insert({{"artwork-sheet", "1"},
                       {"artwork-mode", "view"},
                       {"artwork-dpi", "50"},
                       {"artwork-sha256", plan.sheets[0].program_sha256}});
  const auto drawn = planning::perform(task, keep);
  INFO((drawn ? "" : message(drawn.error())));
  REQUIRE(drawn);
  CHECK(files["artwork.pdf"].starts_with("%PDF"));
}

TEST_CASE("what a worker says it is at is told now and then, and as plain text",
          "[daemon][planning]") {
  Bench bench({}, probe_program());
  std::mutex mutex;
  std::vector<daemon::PlanningPhase> told;
  auto task = bench.task(Kind::Plan, "tells");
  task.progress = [&](const daemon::PlanningPhase& phase) {
    const std::lock_guard lock(mutex);
    told.push_back(phase);
  };
  const auto begun = std::chrono::steady_clock::now();
  REQUIRE(bench.run(std::move(task)));
  const double seconds = seconds_since(begun);
  const std::lock_guard lock(mutex);
  REQUIRE_FALSE(told.empty());
  CHECK(static_cast<double>(told.size()) <= 2 + 2 * seconds);  // of ten thousand
  for (const daemon::PlanningPhase& phase : told) {
    CHECK(phase.phase == "reading");
    CHECK(phase.doing == "reading ?[31m?\?<b>");
    CHECK(phase.done == 0.5);
  }
}

TEST_CASE("sheets are made for people without a cutter, and a drawing is asked about as data",
          "[daemon][planning][make]") {
  const auto made = [](std::map<std::string, std::string> options, std::string machine = "") {
    planning::WorkerTask task{.kind = Kind::Make, .design_kind = "svg"};
    task.machine_json = std::move(machine);
    task.design =
        "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='80mm' viewBox='0 0 100 80' "
        "fill='none'><path d='M5 5H95V75H5Z' stroke='#000'/><path d='M5 40H95' "
        "stroke='red'/></svg>";
    task.options = std::move(options);
    std::string document;
    const auto keep = [&](const std::string& name, const std::string& bytes) -> Result<void> {
      CHECK(name == planning::kMakeFile);
      document = bytes;
      return {};
    };
    const auto outcome = value(planning::perform(std::move(task), keep));
    return nlohmann::json::parse(document);
  };
  const std::string paper = R"({"name": "page", "like": "none"})";
  const auto question = made({{"make-way", "hand"}}, paper)["asks"];
  CHECK(question == made({{"make-way", "drawing"}}));
  CHECK(question["asks"] == "colors");
  CHECK(question["size_mm"] == nlohmann::json::array({90.0, 70.0}));
  REQUIRE(question["looks"].size() == 2);
  CHECK(question["looks"][1]["name"] == "#ff0000");
  CHECK(question["looks"][1]["length_mm"] == Approx(90));
  CHECK(question["looks"][1]["path"] == "M0 35L90 35");
  CHECK(question["folds"].empty());
  const std::string colours = "red=fold-valley; black=cut";
  const auto hand = made({{"make-way", "hand"}, {"colors", colours}, {"mat", "letter"}}, paper);
  REQUIRE(hand["files"].size() == 1);
  CHECK(hand["files"][0]["page_mm"] == nlohmann::json::array({215.9, 279.4}));
  CHECK(hand["sheets"][0]["picture"].get<std::string>().find("<text") == std::string::npos);
  CHECK_THAT(hand["command"].get<std::string>(), Catch::Contains("--colors \"" + colours + "\""));
  const auto laser = made({{"make-way", "laser"}, {"colors", colours}});
  CHECK(laser["files"][0]["name"] == "sheet-01-lightburn.svg");
  const auto studio = made({{"make-way", "silhouette"}, {"colors", colours}},
                           R"({"name": "ours", "like": "cameo3"})");
  CHECK(studio["files"][0]["name"] == "sheet-01.dxf");
  CHECK(studio["files"][1]["name"] == "sheet-01.svg");
}

TEST_CASE("folds whose side a drawing does not say can be told apart by their layers",
          "[daemon][planning][make]") {
  const auto asked = [](std::string kind, std::string design,
                        std::map<std::string, std::string> options) {
    planning::WorkerTask task{.kind = Kind::Make, .design_kind = std::move(kind)};
    task.design = std::move(design);
    task.options = std::move(options);
    task.options["make-way"] = "drawing";
    std::string document;
    const auto outcome =
        planning::perform(std::move(task), [&](const std::string&, const std::string& bytes) {
          document = bytes;
          return Result<void>{};
        });
    if (!outcome) FAIL(message(outcome.error()));
    return nlohmann::json::parse(document);
  };
  const std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='80mm' viewBox='0 0 100 80' "
      "fill='none' stroke='#000'><g id='CUT'><path d='M5 5H95V75H5Z'/></g>"
      "<g id='Folds'><path d='M5 40H95'/></g><g id='Score'><path d='M5 20H95'/></g></svg>";
  auto question = asked("svg", svg, {});
  CHECK(question["asks"].is_null());
  REQUIRE(question["folds"].size() == 2);
  CHECK(question["folds"][0]["name"] == "Folds");
  CHECK(question["folds"][0]["option"] == "layers");
  CHECK(question["folds"][0]["length_mm"] == Approx(90));
  CHECK(question["folds"][1]["name"] == "Score");
  CHECK(asked("svg", svg, {{"layers", "Folds=fold-mountain; Score=fold-valley"}})["folds"].empty());

  const auto line = [](std::string layer, int y) {
    return "0\nLINE\n8\n" + layer + "\n10\n0\n20\n" + std::to_string(y) + "\n11\n90\n21\n" +
           std::to_string(y) + "\n";
  };
  const std::string dxf = "0\nSECTION\n2\nENTITIES\n" + line("CUT", 0) + line("FOLD", 30) +
                          line("MOUNTAIN", 40) + line("CUT", 60) + "0\nENDSEC\n0\nEOF\n";
  question = asked("dxf", dxf, {});
  CHECK(question["unit"] == "guessed");
  REQUIRE(question["folds"].size() == 1);
  CHECK(question["folds"][0]["name"] == "FOLD");
  CHECK(asked("dxf", dxf, {{"layers", "FOLD=fold-mountain"}})["folds"].empty());
}

}  // namespace planner_test
