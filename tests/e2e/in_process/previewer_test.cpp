// SPDX-License-Identifier: MIT
#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <new>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "daemon/previews/previewer.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/planner_bench.hpp"
#include "tests/support/rounds.hpp"

namespace previewer_test {

using namespace popcut;
using namespace popcut::testing;
using daemon::Answer;
using daemon::PreviewLimits;
using daemon::PreviewTask;
using daemon::ProblemKind;
using nlohmann::json;
using Kind = PlanningTask::Kind;

namespace {

/// A part of a sphere in so many slices and units.
std::string sphere(int slices, int units, const json& more = json::object()) {
  json spec{{"popcut", 1},
            {"name", "ball"},
            {"surface", {{"type", "revolution"}, {"radius", "sqrt(70^2 - (y - 45)^2)"}}},
            {"units_per_slice", units},
            {"slices", slices},
            {"widths_mm", 90.0 / std::max(1, slices)},
            {"min_panel_mm", 0.2}};
  spec.update(more);
  return spec.dump();
}

const json kConformal{{"lattice", "conformal"}};

PreviewTask preview(const std::string& spec, const std::string& quality, const std::string& who,
                    const std::string& key = "") {
  PreviewTask task;
  task.task.kind = Kind::Preview;
  task.task.design_text = spec;
  task.task.media_type = "application/json";
  task.task.options["quality"] = quality;
  task.who = who;
  task.key = key;
  task.is_patient = quality == "draft";
  return task;
}

/// The head of a blob.
json head_of(const Answer<PlanningOutcome>& outcome) {
  INFO((outcome ? std::string() : outcome.error().detail));
  REQUIRE(outcome);
  REQUIRE(outcome->files.size() == 1);
  const std::string& blob = outcome->files[0].bytes;
  REQUIRE(blob.substr(0, 4) == "PCLB");
  std::uint32_t size = 0;
  std::memcpy(&size, blob.data() + 8, 4);
  return json::parse(blob.substr(12, size));
}

PreviewLimits quick_limits(double wall_s) {
  PreviewLimits limits;
  limits.quick.wall_s = wall_s;
  limits.slow.wall_s = 600;  // on a machine that is busy otherwise
  return limits;
}

/// A previewer, and who waits for it.
struct Bench {
  std::map<std::string, Answer<PlanningOutcome>> answers;
  std::vector<std::string> order;
  std::mutex mutex;
  std::condition_variable came;
  std::unique_ptr<daemon::Previewer> previewer;

  explicit Bench(const PreviewLimits& limits = quick_limits(600),
                 const std::string& program = worker_program())
      : previewer(daemon::make_previewer(limits, program)) {}

  std::uint64_t start(const std::string& name, PreviewTask task) {
    return previewer->start(std::move(task), [this, name](Answer<PlanningOutcome> outcome) {
      const std::lock_guard lock(mutex);
      CHECK(answers.emplace(name, std::move(outcome)).second);  // once
      order.push_back(name);
      came.notify_all();
    });
  }
  Answer<PlanningOutcome> wait(const std::string& name) {
    std::unique_lock lock(mutex);
    REQUIRE(came.wait_for(lock, std::chrono::seconds(600), [&] { return answers.contains(name); }));
    return answers.at(name);
  }
  bool has(const std::string& name) {
    const std::lock_guard lock(mutex);
    return answers.contains(name);
  }
  Answer<PlanningOutcome> run(PreviewTask task) {
    const std::string name = "run " + std::to_string(++count_);
    start(name, std::move(task));
    return wait(name);
  }

 private:
  int count_{0};
};

/// A process that does what its design says, as a task of `who`.
PreviewTask probe(const std::string& word, const std::string& who, const std::string& key = "",
                  bool is_patient = false) {
  PreviewTask task = preview(word, "exact", who, key);
  task.is_patient = is_patient;
  return task;
}

}  // namespace

TEST_CASE("a draft has the plain lattice and an exact preview that of the spec",
          "[daemon][previews]") {
  Bench bench;
  const std::string spec = sphere(6, 5, kConformal);
  const json draft = head_of(bench.run(preview(spec, "draft", "ana")));
  CHECK(draft["quality"] == "draft");
  CHECK(draft["lattice"] == "levels");
  CHECK(draft["name"] == "ball");
  CHECK_FALSE(draft["arrays"].contains("ghost_points"));
  CHECK(draft["report"].contains("handwork"));
  CHECK_FALSE(draft["report"].contains("wobble"));  // took as long as all else of a draft
  const json exact = head_of(bench.run(preview(spec, "exact", "ana")));
  CHECK(exact["quality"] == "exact");
  CHECK(exact["lattice"] == "conformal");
  CHECK(exact["report"]["lattice"] == "conformal");
  CHECK(exact["report"].contains("wobble"));
  CHECK(exact["arrays"].contains("ghost_points"));
  CHECK(exact["arrays"].contains("point_k"));
}

TEST_CASE("one worker serves the previews of one principal and nobody else", "[daemon][previews]") {
  Bench bench;
  const std::string spec = sphere(4, 3);
  CHECK(children().empty());  // none before it is needed
  std::set<int> first;
  for (int k = 0; k < 20; ++k) {
    REQUIRE(bench.run(preview(spec, "draft", "ana")));
    for (const int child : children()) first.insert(child);
  }
  CHECK(first.size() == 1);
  REQUIRE(bench.run(preview(spec, "draft", "ben")));
  CHECK(children().size() == 2);
  REQUIRE(bench.run(preview(spec, "draft", "cy")));  // there are two: one of them makes room
  const std::vector<int> now = children();
  CHECK(now.size() == 2);
}

TEST_CASE("a previewer whose caller throws goes on with the previews of others",
          "[daemon][previews]") {
  Bench bench;
  bench.previewer->start(preview(sphere(4, 3), "draft", "ana"),
                         [](const Answer<PlanningOutcome>&) { throw std::bad_alloc(); });
  for (const char* who : {"ana", "ben"}) CHECK(bench.run(preview(sphere(4, 3), "draft", who)));
}

TEST_CASE("errors of a preview have the places that a design has", "[daemon][previews]") {
  Bench bench;
  const struct {
    std::string spec, pointer, part;
  } cases[] = {
      {sphere(-3, 4), "/slices", "from 1 to"},
      {sphere(4, 4, {{"surface", {{"type", "revolution"}, {"radius", "sqrt("}}}}),
       "/surface/radius", "does not parse"},
      {sphere(4, 4, json{{"colour", 3}}), "/colour", "is not known"},
      {sphere(4, 4, {{"surface", {{"type", "mesh"}, {"file", "../x.obj"}}}}), "/surface/file",
       "not the id of an asset"},
  };
  for (const auto& wrong : cases)
    for (const char* quality : {"draft", "exact"}) {
      CAPTURE(wrong.spec, quality);
      const auto outcome = bench.run(preview(wrong.spec, quality, "ana"));
      REQUIRE_FALSE(outcome);
      CHECK(outcome.error().kind == ProblemKind::Validation);
      REQUIRE(outcome.error().errors.size() == 1);
      CHECK(outcome.error().errors[0].pointer == wrong.pointer);
      CHECK(outcome.error().errors[0].detail.find(wrong.part) != std::string::npos);
    }
  CHECK(children().size() == 1);  // a mistake of a person costs no worker
}

TEST_CASE("a newer preview of the same key ends the older one", "[daemon][previews]") {
  Bench bench({}, probe_program());
  bench.start("at work", probe("sleeps", "ana", "page"));
  bench.start("waits", probe("sleeps", "ana", "page"));
  // An exact one is not worth finishing.
  CHECK(bench.wait("at work").error().kind == ProblemKind::Superseded);
  bench.start("newest", probe("naps", "ana", "page"));
  CHECK(bench.wait("waits").error().kind == ProblemKind::Superseded);
  CHECK(bench.wait("newest"));
  // Another page, and another person with the same key, lose nothing.
  bench.start("page two", probe("naps", "ana", "other"));
  bench.start("page of ben", probe("naps", "ben", "page"));
  bench.start("page one", probe("naps", "ana", "page"));
  for (const char* name : {"page two", "page of ben", "page one"}) CHECK(bench.wait(name));
}

TEST_CASE("a draft at work may finish when a newer one comes, but not for long",
          "[daemon][previews]") {
  PreviewLimits limits;
  SECTION("a short one") {
    limits.grace_s = 100;
    Bench bench(limits, probe_program());
    bench.start("short", probe("naps", "ana", "page", true));
    REQUIRE(comes_true([] { return children().size() == 1; }));
    bench.start("next", probe("naps", "ana", "page", true));
    CHECK(bench.wait("short"));
    CHECK(bench.wait("next"));
  }
  SECTION("a long one") {
    Bench bench(limits, probe_program());
    bench.start("long", probe("sleeps", "ana", "page", true));
    REQUIRE(comes_true([] { return children().size() == 1; }));
    bench.start("newer", probe("naps", "ana", "page", true));
    CHECK(bench.wait("long").error().kind == ProblemKind::Superseded);
    CHECK(bench.wait("newer"));
  }
}

TEST_CASE("a burst of previews of one key makes the last one, and few others",
          "[daemon][previews]") {
  Bench bench;
  const std::string spec = sphere(10, 5);
  constexpr int kMany = 60;
  for (int k = 0; k < kMany; ++k)
    bench.start(std::to_string(k), preview(spec, "draft", "ana", "page"));
  CHECK(bench.wait(std::to_string(kMany - 1)));
  int made = 0;
  for (int k = 0; k < kMany; ++k) {
    const auto outcome = bench.wait(std::to_string(k));
    if (outcome)
      ++made;
    else
      CHECK(outcome.error().kind == ProblemKind::Superseded);
  }
  CHECK(made < kMany);
}

TEST_CASE("a preview that is called off ends wherever it is", "[daemon][previews]") {
  Bench bench({}, probe_program());
  const auto at_work = bench.start("at work", probe("sleeps", "ana"));
  const auto waits = bench.start("waits", probe("sleeps", "ana"));
  REQUIRE(comes_true([] { return children().size() == 1; }));
  bench.previewer->cancel(waits);
  CHECK(bench.wait("waits").error().kind == ProblemKind::Unavailable);
  bench.previewer->cancel(at_work);
  CHECK(bench.wait("at work").error().kind == ProblemKind::Unavailable);
  bench.previewer->cancel(at_work);  // it has ended
  bench.previewer->cancel(12345);
  CHECK(comes_true([] { return children().empty(); }));
  CHECK(bench.run(probe("naps", "ana")));
}

TEST_CASE("each limit of a preview ends it alone and says so", "[daemon][previews]") {
  SECTION("time") {
    PreviewLimits limits = quick_limits(600);
    limits.quick.cpu_s = 0.2;
    limits.slow.cpu_s = 1;
    Bench bench(limits, probe_program());
    const auto late = bench.run(probe("spins", "ana", "", true));
    REQUIRE_FALSE(late);
    CHECK(late.error().kind == ProblemKind::Validation);
    REQUIRE(late.error().errors.size() == 1);
    CHECK(late.error().errors.front().code == "too-long");
    CHECK(late.error().detail.find("0.2 s of processor time that a preview may take") !=
          std::string::npos);
    // Somebody at rest waits longer.
    const auto longer = bench.run(probe("spins", "ana"));
    REQUIRE_FALSE(longer);
    CHECK(longer.error().detail.find("1 s of processor time that a design may take") !=
          std::string::npos);
  }
  SECTION("time on a busy computer is that of the processor") {
    PreviewLimits limits = quick_limits(600);
    limits.quick.cpu_s = 0.2;
    Bench bench(limits, probe_program());
    CHECK(bench.run(probe("naps", "ana")));
  }
  SECTION("exact previews that take longer are made all the same") {
    PreviewLimits limits = quick_limits(600);
    limits.quick.cpu_s = 0.02;
    Bench bench(limits);
    const std::string spec = sphere(25, 20, kConformal);
    CHECK(head_of(bench.run(preview(spec, "exact", "ana")))["quality"] == "exact");
  }
  SECTION("output") {
    PreviewLimits limits;
    limits.quick.output_bytes = 8u << 20;
    Bench bench(limits, probe_program());
    const auto flood = bench.run(probe("flood", "ana"));
    REQUIRE_FALSE(flood);
    CHECK(flood.error().detail.find("a preview may make") != std::string::npos);
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  SECTION("memory") {
    PreviewLimits limits = quick_limits(60);
    limits.quick.memory_bytes = 96u << 20;
    Bench bench(limits);
    REQUIRE(bench.run(preview(sphere(4, 3), "draft", "ana")));
    const auto large = bench.run(preview(sphere(200, 400), "draft", "ana"));
    REQUIRE_FALSE(large);
    INFO(large.error().detail);
    CHECK(large.error().detail.find("memory than a preview may use") != std::string::npos);
    CHECK(bench.run(preview(sphere(4, 3), "draft", "ana")));
  }
  SECTION("memory, wherever it runs out") {
    // With less, there is no room for the libraries of the worker, and it cannot be started.
    const auto apart = static_cast<std::uint64_t>(step_of(8, 4));
    for (std::uint64_t mib = 96; mib <= 192; mib += apart) {
      CAPTURE(mib);
      PreviewLimits limits = quick_limits(60);
      limits.quick.memory_bytes = mib << 20;
      Bench bench(limits);
      const auto large = bench.run(preview(sphere(200, 400), "draft", "ana"));
      if (large) break;
      INFO(large.error().detail);
      CHECK(large.error().detail.find("memory than a preview may use") != std::string::npos);
    }
  }
#endif
  SECTION("what no worker says") {
    for (const char* word : {"garbage", "no head", "twice", "nonsense", "deep"}) {
      Bench bench({}, probe_program());
      CAPTURE(word);
      const auto wrong = bench.run(probe(word, "ana"));
      REQUIRE_FALSE(wrong);
      CHECK(wrong.error().kind == ProblemKind::Internal);
      CHECK(bench.run(probe("naps", "ana")));
    }
  }
}

TEST_CASE("a worker that somebody kills is replaced, between previews and in the middle",
          "[daemon][previews]") {
  Bench bench;
  REQUIRE(bench.run(preview(sphere(4, 3), "draft", "ana")));
  const std::vector<int> warm = children();
  REQUIRE(warm.size() == 1);
  ::kill(warm[0], SIGKILL);
  CHECK(bench.run(preview(sphere(4, 3), "draft", "ana")));
  bench.start("long", preview(sphere(25, 20, kConformal), "exact", "ana"));
  REQUIRE(comes_true([&] { return children().size() == 1 && children()[0] != warm[0]; }));
  const std::vector<int> next = children();
  ::kill(next[0], SIGKILL);
  CHECK(bench.wait("long"));
}

TEST_CASE("a full line refuses more and nobody else's preview waits for a hog",
          "[daemon][previews]") {
  Bench bench({}, probe_program());
  for (int k = 0; k < 17; ++k) bench.start("hog " + std::to_string(k), probe("sleeps", "hog"));
  REQUIRE(comes_true([] { return children().size() == 1; }));
  bench.start("one more", probe("sleeps", "hog"));
  bench.start("and one", probe("sleeps", "hog"));
  const auto full = bench.wait("and one");
  REQUIRE_FALSE(full);
  CHECK(full.error().kind == ProblemKind::Unavailable);
  CHECK(full.error().retry_after_s);
  for (int k = 0; k < 3; ++k) CHECK(bench.run(probe("naps", "ana")));
}

TEST_CASE("nobody's preview waits for the large designs of others", "[daemon][previews]") {
  Bench bench({}, probe_program());
  const auto of_kind = [](Kind kind, const std::string& word, const std::string& who) {
    PreviewTask task = probe(word, who);
    task.task.kind = kind;
    return task;
  };
  int count = 0;
  for (const Kind kind : {Kind::Lattice, Kind::Place, Kind::Picture, Kind::Export})
    for (const char* who : {"hog", "other hog", "third hog"})
      bench.start("hog " + std::to_string(++count), of_kind(kind, "sleeps", who));
  REQUIRE(comes_true([] { return children().size() == 4; }));  // two are opened, two are drawn
  for (const char* who : {"ana", "hog"}) CHECK(bench.run(probe("naps", who)));
}

TEST_CASE("nobody's file waits for the files of somebody else", "[daemon][previews]") {
  Bench bench({}, probe_program());
  const auto file = [](const std::string& word, const std::string& who) {
    PreviewTask task = probe(word, who);
    task.task.kind = Kind::Export;
    return task;
  };
  for (int k = 0; k < 5; ++k) bench.start("hog " + std::to_string(k), file("sleeps", "hog"));
  REQUIRE(comes_true([] { return children().size() == 1; }));
  for (const char* who : {"ana", "ben"}) CHECK(bench.run(file("naps", who)));
}

TEST_CASE("a shape that takes its time is placed, and ends with who waits for it",
          "[daemon][previews]") {
  Bench bench(quick_limits(0.1), probe_program());
  const auto place = [](const std::string& word) {
    PreviewTask task = probe(word, "ana");
    task.task.kind = Kind::Place;
    return task;
  };
  CHECK_FALSE(bench.run(probe("naps", "ana")));  // as long as a preview may not take
  CHECK(bench.run(place("naps")));
  const auto long_one = bench.start("long", place("sleeps"));
  REQUIRE(comes_true([] { return children().size() == 1; }));
  bench.previewer->cancel(long_one);
  CHECK(bench.wait("long").error().kind == ProblemKind::Unavailable);
  CHECK(comes_true([] { return children().empty(); }));
}

TEST_CASE("a worker without work ends after a while, and stopping leaves nothing",
          "[daemon][previews]") {
  PreviewLimits limits;
  limits.idle_s = 0.3;
  const std::size_t before = open_descriptors();
  {
    Bench bench(limits);
    REQUIRE(bench.run(preview(sphere(4, 3), "draft", "ana")));
    CHECK(comes_true([] { return children().empty(); }));
    REQUIRE(bench.run(preview(sphere(4, 3), "draft", "ana")));
    bench.start("long", preview(sphere(50, 60, kConformal), "exact", "ana"));
    bench.start("waits", preview(sphere(4, 3), "draft", "ana"));
    bench.previewer->stop();
    CHECK(children().empty());
    CHECK(bench.has("long"));
    CHECK(bench.has("waits"));
    CHECK_FALSE(bench.run(preview(sphere(4, 3), "draft", "ana")));
  }
  CHECK(open_descriptors() == before);
}

TEST_CASE("many previews leave no descriptors and little memory behind", "[daemon][previews]") {
  Bench bench;
  REQUIRE(bench.run(preview(sphere(4, 3), "draft", "ana")));
  const std::size_t before = open_descriptors();
  for (int k = 0, all = testing::rounds(1000, 10); k < all; ++k)
    REQUIRE(bench.run(preview(sphere(3, 2), "draft", k % 2 == 0 ? "ana" : "ben")));
  CHECK(open_descriptors() <= before + 6);  // the pipes of a second worker
  CHECK(children().size() <= 2);
}

TEST_CASE("patterns from elsewhere open as far as they do, or lie flat", "[daemon][previews]") {
  Bench bench;
  const auto lattice = [&](const std::string& text, const std::string& kind) {
    PreviewTask task;
    task.task.kind = Kind::Lattice;
    task.task.design_text = text;
    task.task.design_kind = kind;
    task.who = "ana";
    return head_of(bench.run(task));
  };
  const std::string head =
      "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>";
  const auto line = [](const char* colour, const char* d) {
    return std::string("<path fill='none' stroke='") + colour + "' d='" + d + "'/>";
  };
  SECTION("a card with one fold moves by popcut's own law") {
    const json card = lattice(
        head + line("black", "M10,10H90V50H10Z") + line("red", "M10,30H90") + "</svg>", "svg");
    CHECK(card["motion"] == "pose");
    CHECK(card["faces"] == 2);
    CHECK(card["kind"] == "svg");
    CHECK(card["judged"].size() > 3);
  }
  SECTION("of cuts alone nothing is said to open, and nothing is wrong") {
    const json cuts = lattice(
        head + line("black", "M10,10H90V50H10Z") + line("black", "M20,20H80") + "</svg>", "svg");
    CHECK(cuts["motion"] == "flat");
    CHECK(cuts["judged"].empty());
    CHECK(cuts["not_judged"].empty());
    CHECK(cuts["warnings"].empty());
  }
  SECTION("the net of a box is no card that opens in one movement") {
    const json net =
        lattice(head + line("black", "M10 40H30V20H50V40H90V60H50V80H30V60H10Z") +
                    line("blue", "M30 40V60M50 40V60M70 40V60M30 40H50M30 60H50") + "</svg>",
                "svg");
    REQUIRE(net["warnings"].size() == 1);
    CHECK(net["warnings"][0]["code"] == "many_ways");
    CHECK_THAT(net["warnings"][0]["message"].get<std::string>(),
               Catch::Contains("moves in 5 ways, as the net of a box does"));
  }
  SECTION("what does not open is said without options of a command") {
    const json half = lattice(head + line("black", "M10,10H90V50H10ZM30,30H70") +
                                  line("red", "M10,30H30M70,30H90M40,20H60") + "</svg>",
                              "svg");
    for (const json& one : half["warnings"]) {
      CAPTURE(one.dump());
      const auto text = one["message"].get<std::string>();
      CHECK(text.find("psi") == std::string::npos);
      CHECK(text.find("--") == std::string::npos);
      CHECK(text.find("edges_") == std::string::npos);
    }
  }
  SECTION("lines without a sheet are shown as lines") {
    const json lines =
        lattice(head + line("black", "M10,10L90,20") + line("red", "M10,30H90") + "</svg>", "svg");
    CHECK(lines["motion"] == "flat");
    CHECK(lines["faces"] == 0);
    CHECK(lines["arrays"]["lines"]["length"] == 8);
  }
  SECTION("a spec as it will be cut") {
    const json spec = lattice(sphere(4, 3), "spec");
    CHECK(spec["quality"] == "stored");
    CHECK(spec["report"].is_object());
  }
}

TEST_CASE("pictures of a design are small and say nothing of their own", "[daemon][previews]") {
  Bench bench;
  const auto pictures = [&](const std::string& text, const std::string& kind) {
    PreviewTask task;
    task.task.kind = Kind::Picture;
    task.task.design_text = text;
    task.task.design_kind = kind;
    task.who = "ana";
    const auto outcome = bench.run(task);
    INFO((outcome ? std::string() : outcome.error().detail));
    REQUIRE(outcome);
    REQUIRE(outcome->files.size() == 2);
    CHECK(outcome->files[0].name == "deployed.svg");
    CHECK(outcome->files[1].name == "pattern.svg");
    for (const PlanningFile& file : outcome->files) {
      CAPTURE(file.name);
      pugi::xml_document svg;
      CHECK(svg.load_string(file.bytes.c_str()));
      CHECK(file.bytes.find("hostile") == std::string::npos);
      CHECK(file.bytes.find("<script") == std::string::npos);
    }
    CHECK(outcome->files[0].bytes.size() < 65'000);
    return *outcome;
  };
  const json named{{"name", "hostile<script>alert(1)</script>"}};
  const auto small = pictures(sphere(6, 5, named), "spec");
  // A spec of many units is drawn coarser, not longer.
  const auto large = pictures(sphere(60, 60, named), "spec");
  CHECK(large.files[0].bytes.size() > 2000);
  const std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' "
      "viewBox='0 0 100 100'><title>hostile</title><script>hostile()</script>";
  const std::string card =
      "<path id='hostile' fill='none' stroke='black' d='M10,10H90V50H10Z'/>"
      "<path fill='none' stroke='red' d='M10,30H90'/></svg>";
  const auto opens = pictures(svg + card, "svg");
  CHECK(opens.files[0].bytes != opens.files[1].bytes);
  const auto flat =
      pictures(svg + "<path fill='none' stroke='black' d='M10,10L90,20'/></svg>", "svg");
  CHECK(flat.files[0].bytes == flat.files[1].bytes);
}

TEST_CASE("a shape is moved into place as on the command line", "[daemon][previews]") {
  Bench bench;
  TempFolder temp;
  // A box that stands elsewhere, as a table of heights would.
  std::string box = "o box\n";
  for (const double x : {20.0, 60.0})
    for (const double y : {20.0, 60.0})
      for (const double z : {20.0, 60.0})
        box += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  box += "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
  const std::string id = "sha256-" + std::string(64, 'a');
  write_file(temp / id, box);
  PreviewTask task;
  task.task.kind = Kind::Place;
  task.task.design_text = R"({"popcut": 1, "surface": {"type": "mesh", "file": ")" + id +
                          R"("}, "units_per_slice": 4, "slices": 4, "widths_mm": 8})";
  task.task.media_type = "application/json";
  task.task.assets_folder = (temp / "").string();
  task.task.options["place"] = "whole";
  task.who = "ana";
  const auto outcome = bench.run(task);
  INFO((outcome ? std::string() : outcome.error().detail));
  REQUIRE(outcome);
  REQUIRE(outcome->files.size() == 1);
  const json spec = json::parse(outcome->files[0].bytes);
  CHECK(spec["surface"]["file"] == id);
  CHECK(spec["translate_mm"].size() == 3);
  CHECK(spec["fit"] == "nearest");
}

}  // namespace previewer_test
