// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>

#include <catch2/catch.hpp>

#include "core/machines/machine.hpp"
#include "core/plan/pens.hpp"
#include "core/text/near_names.hpp"
#include "core/text/words.hpp"
#include "tests/support/value.hpp"

namespace tables_test {

using namespace popcut;

TEST_CASE("the built-in tables have every documented machine and material",
          "[core][plan][tables]") {
  for (const char* name : {"cameo", "cameo2", "cameo3", "cameo4", "cameo5", "portrait", "portrait2",
                           "portrait3", "portrait4", "curio", "hpgl-generic"}) {
    CAPTURE(name);
    const auto machine = testing::value(find_machine(name));
    CHECK(machine.name == name);
    CHECK(machine.motion.accel_mm_s2 > 0.0);
  }
  for (const char* name : {"paper-220", "paper-160", "pp-150", "vinyl"}) {
    CAPTURE(name);
    REQUIRE(find_material(name));
  }
  const auto paper = find_material("paper-220");
  CHECK(paper->dashes.dash_mm == 1.5);
  CHECK(paper->dashes.gap_mm == 1.0);
  CHECK(paper->dashes.clearance_mm == 0.5);
}

TEST_CASE("the Cameo 3's row matches its recordings", "[core][plan][tables]") {
  const auto machine = testing::value(find_machine("cameo3"));
  CHECK(machine.identity == "CAMEO 3 V1.60    ");
  CHECK(machine.unit_mm == 0.05);
  CHECK(machine.tool_holders == 2);
  CHECK(machine.autoblade);
  CHECK(machine.usb_vendor == 0x0b4d);
  CHECK(machine.usb_product == 0x112f);
  CHECK(machine.force_gf.max_step * machine.force_gf.per_step == 231.0);
  REQUIRE(machine.mats.size() >= 2);
  CHECK(machine.mats[0].width_mm == 304.8);
  CHECK(machine.mats[0].length_mm == 304.8);
  CHECK(machine.mats[1].length_mm == 609.6);
  const auto portrait = testing::value(find_machine("portrait3"));
  CHECK(portrait.variant == "cameo4");
  CHECK(portrait.tool_holders == 1);
}

TEST_CASE("no two built-in machines share a name or a USB id", "[core][plan][tables]") {
  const auto machines = testing::value(all_machines());
  std::set<std::string> names;
  std::set<std::pair<int, int>> ids;
  for (const Machine& machine : machines) {
    CAPTURE(machine.name);
    CHECK(names.insert(machine.name).second);
    if (machine.usb_vendor != 0)
      CHECK(ids.insert({machine.usb_vendor, machine.usb_product}).second);
    for (const Mat& mat : machine.mats) CHECK(mat.width_mm <= machine.width_mm + 1e-9);
  }
}

TEST_CASE("a user's row replaces a built-in one and can extend another", "[core][plan][tables]") {
  const std::string table = R"({"popcut": 1,
    "machines": [{"name": "workshop", "like": "cameo3", "title": "Ours", "length_mm": 6000}],
    "materials": [{"name": "paper-220", "like": "paper-220", "autoblade_depth": 7}]})";
  const auto machine = testing::value(find_machine("workshop", {table}));
  CHECK(machine.length_mm == 6000.0);
  CHECK(machine.unit_mm == 0.05);
  CHECK(find_material("paper-220", {table})->autoblade_depth == 7);
  CHECK(find_material("paper-220")->autoblade_depth == 5);
  CHECK(all_materials({table})->size() == all_materials()->size());
}

TEST_CASE("a wrong name or field is answered with the nearest right one", "[core][plan][tables]") {
  const auto name = find_machine("camoe3");
  REQUIRE_FALSE(name);
  CHECK(name.error().kind == ErrorKind::OutOfRange);
  CHECK(name.error().detail.find("did you mean cameo3?") != std::string::npos);
  const auto field =
      find_machine("a", {R"({"popcut":1,"machines":[{"name":"a","like":"cameo3","widht_mm":3}]})"});
  REQUIRE_FALSE(field);
  CHECK(field.error().kind == ErrorKind::Malformed);
  CHECK(field.error().place == "table 1: /machines/0/widht_mm");
  CHECK(field.error().detail.find("did you mean width_mm?") != std::string::npos);
}

TEST_CASE("two letters that swapped places are one slip", "[core][plan][tables]") {
  const std::vector<std::string> names{"cut", "plan", "best"};
  CHECK(nearest_word("ctu", names) == "cut");
  CHECK(nearest_word("paln", names) == "plan");
  CHECK(nearest_word("bset", names) == "best");
  CHECK(nearest_word("tuc", names).empty());
  CHECK(nearest_word("fast", names).empty());
}

TEST_CASE("a number has one sign at most", "[core][plan][tables]") {
  double value = 0.0;
  CHECK((read_number("+5", value) && value == 5.0));
  CHECK((read_number("-5", value) && value == -5.0));
  for (const char* const text : {"+-5", "++5", "-+5", "--5", "+", "-", "", " 5", "5 "}) {
    CAPTURE(text);
    CHECK_FALSE(read_number(text, value));
  }
}

TEST_CASE("an object of a row replaces only what it names", "[core][machines]") {
  const auto found = testing::value(find_machine(
      "a", {R"({"popcut":1,"machines":[{"name":"a","like":"cameo3","motion":{"spread":0.3}}]})"}));
  CHECK(found.motion.spread == 0.3);
  CHECK(found.motion.travel_mm_s == find_machine("cameo3")->motion.travel_mm_s);
}

TEST_CASE("an invalid user's table is refused with its place", "[core][plan][tables]") {
  const auto place = [](const std::string& table) {
    const auto machines = all_machines({table});
    REQUIRE_FALSE(machines);
    return machines.error().place;
  };
  CHECK(place("{\"popcut\": 1,\n \"machines\": [}") == "table 1: line 2, column 15");
  CHECK(place("[]") == "table 1: /");
  CHECK(place(R"({"popcut":2})") == "table 1: /popcut");
  CHECK(place(R"({"popcut":1,"machine":[]})") == "table 1: /machine");
  CHECK(place(R"({"popcut":1,"machines":[{"name":"a"}]})") == "table 1: /machines/0/title");
  CHECK(place(R"({"popcut":1,"machines":[{"name":"a","like":"b"}]})") ==
        "table 1: /machines/0/like");
  CHECK(place(R"({"popcut":1,"machines":[{"name":"a","like":"cameo3","unit_mm":-1}]})") ==
        "table 1: /machines/0/unit_mm");
  CHECK(
      place(
          R"({"popcut":1,"machines":[{"name":"a","like":"cameo3","motion":{"accel_mm_s2":0}}]})") ==
      "table 1: /machines/0/motion/accel_mm_s2");
  CHECK_FALSE(all_machines({std::string(100'000, '[')}));
}

TEST_CASE("a user's HPGL machine names its habits as words joined by plus signs",
          "[core][plan][tables]") {
  const auto with = [](const std::string& variant) {
    return find_machine("mine", {R"j({"popcut": 1, "machines": [{"name": "mine", "title": "Mine",
      "like": "hpgl-generic", "variant": ")j" +
                                 variant + R"j("}]})j"});
  };
  const auto clone = testing::value(with("pa+newline+plain"));
  CHECK(clone.variant == "pa+newline+plain");
  for (const char* wrong : {"cameo3", "pa+", "", "+pa", "pa newline"}) {
    CAPTURE(wrong);
    const auto refused = with(wrong);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().place, Catch::Contains("/machines/0/variant"));
    CHECK_THAT(refused.error().detail, Catch::Contains("camm2 (join several with +)"));
  }
  const auto machines = testing::value(all_machines());
  CHECK(std::count_if(machines.begin(), machines.end(),
                      [](const Machine& m) { return m.language == "hpgl"; }) >= 6);
}

TEST_CASE("a job's own settings replace the material's and wrong ones are named", "[core][plan]") {
  const Material paper = *find_material("paper-220");
  const auto changed =
      testing::value(with_pens(paper, " cut: force=90 passes=2 step=7 ;fold: speed=20 tool=2;"));
  CHECK(changed.cut.force_gf == 90);
  CHECK(changed.cut.passes == 2);
  CHECK(changed.cut.force_step_gf == 7);
  CHECK(changed.cut.speed_mm_s == paper.cut.speed_mm_s);
  CHECK(changed.fold.speed_mm_s == 20);
  CHECK(changed.fold.tool == 2);
  CHECK(changed.draw.force_gf == paper.draw.force_gf);
  CHECK(with_pens(paper, "")->cut.force_gf == paper.cut.force_gf);
  const auto error = [&](std::string_view pens) {
    const auto made = with_pens(paper, pens);
    return made ? std::string("accepted") : message(made.error());
  };
  CHECK_THAT(error(": force=90"), Catch::Contains("/options/pen") && Catch::Contains("no name"));
  CHECK_THAT(error("cut force=90"), Catch::Contains("colon"));
  CHECK_THAT(error("cut: forse=90"), Catch::Contains("did you mean force"));
  CHECK_THAT(error("cut: force"), Catch::Contains("no setting of cut"));
  CHECK_THAT(error("cut: force=much"), Catch::Contains("\"much\"; give a number from 0 to 10000"));
  CHECK_THAT(error("cut: force=-1"), Catch::Contains("from 0 to 10000"));
  CHECK_THAT(error("cut: passes=1.5"), Catch::Contains("whole number from 1 to 20"));
  CHECK_THAT(error("cut: force=9; cut: force=8"), Catch::Contains("twice"));
  CHECK_THAT(error("cut: force=nan"), Catch::Contains("\"nan\""));
  Material plain = paper;
  plain.light.reset();
  CHECK_FALSE(with_pens(plain, "light: force=9"));
}

TEST_CASE("what was found for a material on a machine is used there", "[core][machines]") {
  const Machine tried = *find_machine("cameo3", {R"({"popcut": 1, "machines": [{"name": "cameo3",
      "like": "cameo3", "forces": [{"material": "paper-220", "cut_gf": 100, "depth": 7}]}]})"});
  const Material paper = *find_material("paper-220");
  const Material here = on_machine(paper, tried);
  CHECK(here.cut.force_gf == Approx(100));
  CHECK(here.fold.force_gf == Approx(100 * paper.fold.force_gf / paper.cut.force_gf));
  CHECK(here.draw.force_gf == paper.draw.force_gf);  // a pen
  CHECK(here.autoblade_depth == 7);
  CHECK(on_machine(*find_material("card-300"), tried).cut.force_gf ==
        find_material("card-300")->cut.force_gf);
  const auto wrong = find_machine("c", {R"({"popcut": 1, "machines": [{"name": "c",
      "like": "cameo3", "forces": [{"material": "paper-220", "cut_gf": 0}]}]})"});
  REQUIRE_FALSE(wrong);
  CHECK_THAT(message(wrong.error()), Catch::Contains("/machines/0/forces/0/cut_gf"));
}

}  // namespace tables_test
