// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/meshes.hpp"

namespace compare_command_test {

using namespace popcut::testing;
using Catch::WithinAbs;
using Catch::WithinRel;
using nlohmann::json;

namespace {

const char* const kBall =
    R"({"popcut":1,"name":"ball","surface":{"type":"mesh","file":"ball.stl"},"scale_mm":1.5,)"
    R"("rotate_deg":[0,0,90],"translate_mm":[0,30,0],"units_per_slice":4,"slices":7,"widths_mm":8})";

const char* const kSphere =
    R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(40^2-(y-20)^2)"},)j"
    R"j("units_per_slice":4,"slices":6,"widths_mm":8})j";

/// A folder with a ball, its card, and the card's opened surface at 90 degrees.
struct CompareBench : CommandBench {
  CompareBench() {
    write_file(temp / "ball.stl", binary_stl(icosphere(30.0, 3)));
    write_file(temp / "ball.json", kBall);
    write_file(temp / "sphere.json", kSphere);
    make("ball.json", "ball");
  }
  void make(const std::string& spec, const std::string& folder) const {
    const Ran made = popcut({"design", spec, "-o", folder, "-q", "--formats", "fold,report"});
    CAPTURE(made.err);
    REQUIRE(made.exit == 0);
  }
  [[nodiscard]] json compared(std::vector<std::string> words) const {
    words.insert(words.begin(), "compare");
    words.insert(words.end(), {"--json", "--pixels", "256"});
    const Ran ran = popcut(words);
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    return json::parse(ran.out);
  }
  [[nodiscard]] double error_of(std::vector<std::string> words) const {
    words.emplace_back("--no-cost");
    return compared(std::move(words))["error"].get<double>();
  }
};

}  // namespace

TEST_CASE("compare knows where the mesh stands that a card was designed from",
          "[cli][e2e][compare]") {
  const CompareBench bench;
  const json found = bench.compared({"ball/pattern.fold", "ball.stl", "-o", "seen"});
  CHECK(found["placement"]["from"] == "pattern");
  CHECK(found["placement"]["scale_mm"] == 1.5);
  CHECK(found["placement"]["rotate_deg"][2].get<double>() == 90.0);
  const double error = found["error"].get<double>();
  CHECK(error > 0.05);
  CHECK(error < 1.2);
  CHECK_THAT(error, WithinAbs(found["surface"]["mean"].get<double>() +
                                  found["contour"]["mean"].get<double>() + 1.0 -
                                  found["cover"].get<double>(),
                              1e-12));
  CHECK(found["views"].size() == 9);
  REQUIRE(found["volume"]["ran"] == true);
  // A quarter of the ball stands in the corner.
  CHECK_THAT(found["volume"]["model_mm3"].get<double>(),
             WithinRel(M_PI / 3.0 * std::pow(45.0, 3), 0.03));
  REQUIRE(found["cost"]["ran"] == true);
  CHECK(found["cost"]["seconds"].get<double>() > 10.0);
  CHECK(found["cost"]["cut_m"].get<double>() > 0.1);
  const json report = bench.read_json("ball/report.json");
  CHECK(found["folds"].get<int>() > report["folds"].get<int>() / 2);
  CHECK(found["folds"].get<int>() <= report["folds"].get<int>());
  CHECK(found["smallest_joint_mm"].get<double>() > 1.0);
  CHECK(found["parts_to_glue"] == 0);
  // Its own design says the same.
  CHECK_THAT(bench.error_of({"ball/pattern.fold", "ball.json"}), WithinAbs(error, 0.002));
  CHECK(bench.read_json("seen/compare.json")["error"].get<double>() == error);
  CHECK(text_of_file(bench.temp / "seen/compare.png").rfind("\x89PNG", 0) == 0);
  // Said by hand, it is the same; 20 mm aside, it is worse.
  const auto at = found["placement"]["translate_mm"];
  const auto by_hand = [&](double aside) {
    return bench.error_of(
        {"ball/pattern.fold", "ball.stl", "--scale", "1.5", "--rotate", "0,0,90", "--move",
         std::to_string(at[0].get<double>()) + "," + std::to_string(at[1].get<double>() + aside) +
             "," + std::to_string(at[2].get<double>())});
  };
  CHECK_THAT(by_hand(0.0), WithinAbs(error, 0.002));
  CHECK(by_hand(20.0) > error + 0.1);
  const Ran words = bench.popcut({"compare", "ball/pattern.fold", "ball.stl", "--no-cost"});
  const std::size_t last = words.out.rfind("\n  ") + 3;
  CHECK(words.out.substr(last, 5) == "error");
}

TEST_CASE("a card against its own opened surface has no error", "[cli][e2e][compare]") {
  const CompareBench bench;
  REQUIRE(bench
              .popcut({"deploy", "ball/pattern.fold", "-o", "poses", "-q", "--frames", "1",
                       "--from-psi", "90deg", "--to-psi", "90deg"})
              .exit == 0);
  const std::vector<std::string> itself{"ball/pattern.fold", "poses/psi_001.stl", "--scale", "1"};
  CHECK_THAT(bench.error_of(itself), WithinAbs(0.0, 1e-6));
  const json meshes = bench.compared({"poses/psi_001.stl", "poses/psi_001.stl"});
  CHECK(meshes["error"].get<double>() == 0.0);
  CHECK(meshes["placement"]["from"] == "file");
  CHECK(meshes["cost"]["ran"] == false);
  CHECK_FALSE(meshes.contains("folds"));
  CHECK(meshes["volume"]["ran"] == false);  // a sheet has no inside

  // The flat sheet alone is opened first.
  json fold = json::parse(text_of_file(bench.temp / "ball/pattern.fold"));
  json flat = fold;
  flat.erase("file_frames");
  write_file(bench.temp / "flat.fold", flat.dump());
  CHECK_THAT(bench.error_of({"flat.fold", "poses/psi_001.stl", "--scale", "1"}),
             WithinAbs(0.0, 1e-3));
  // A pose of somebody else's stands anywhere in space, and does not say how far it is opened.
  json other = fold;
  other.erase("popcut:model_placement");
  json frame;
  for (const json& one : fold["file_frames"])
    if (std::abs(one["frame_popcut:psi_rad"].get<double>() - M_PI / 2) < 1e-9) frame = one;
  REQUIRE(frame.is_object());
  frame.erase("frame_popcut:psi_rad");
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (json& p : frame["vertices_coords"]) {
    const double x = p[0], v = p[1], z = p[2];
    p = {c * x - s * z + 50.0, s * x + c * z - 20.0, 70.0 - v};
  }
  other["file_frames"] = json::array({frame});
  write_file(bench.temp / "other.fold", other.dump());
  CHECK_THAT(bench.error_of({"other.fold", "poses/psi_001.stl", "--scale", "1"}),
             WithinAbs(0.0, 0.01));
  // A folded form without any flat sheet stands as it is, and what reaches behind wall or ground is
  // no card.
  const auto folded = [&](double lower_mm) {
    json form{{"frame_classes", {"foldedForm"}}, {"frame_unit", "mm"}};
    for (const char* list : {"edges_vertices", "faces_vertices", "edges_assignment"})
      form[list] = fold[list];
    for (const json& one : fold["file_frames"])
      if (std::abs(one["frame_popcut:psi_rad"].get<double>() - M_PI / 2) < 1e-9)
        form["vertices_coords"] = one["vertices_coords"];
    for (json& p : form["vertices_coords"]) p[2] = p[2].get<double>() - lower_mm;
    return form.dump();
  };
  write_file(bench.temp / "folded.fold", folded(0.0));
  write_file(bench.temp / "lower.fold", folded(30.0));
  CHECK_THAT(bench.error_of({"folded.fold", "poses/psi_001.stl"}), WithinAbs(0.0, 1e-6));
  const json lower = bench.compared({"lower.fold", "poses/psi_001.stl", "--move", "0,0,-30"});
  CHECK_THAT(lower["error"].get<double>(), WithinAbs(0.0, 1e-6));
  CHECK(lower["volume"]["ran"] == false);
  CHECK(says(lower["notes"].dump(), "does not stand in a corner"));
}

TEST_CASE("a formula is as far from its card as the design says", "[cli][e2e][compare]") {
  const CompareBench bench;
  bench.make("sphere.json", "sphere");
  const json found = bench.compared({"sphere/pattern.fold", "sphere.json", "--no-cost"});
  const json fit = bench.read_json("sphere/report.json")["fit"];
  CHECK(found["placement"]["from"] == "spec");
  // The design measures the nearest distance in space, compare along the eye: depths are larger by
  // 1 / cos of the slope, which is below 2 for most of what nine views show.
  const double nearest = fit["structure_to_target_mm"]["mean"].get<double>();
  const double along_the_eye = found["surface"]["mean_mm"].get<double>();
  CHECK(along_the_eye > 0.9 * nearest);
  CHECK(along_the_eye < 2.0 * nearest);
  CHECK_THAT(found["diagonal_mm"].get<double>(), WithinRel(fit["size_mm"].get<double>(), 0.02));
  CHECK(found["cover"].get<double>() < fit["share_within"]["2_percent"].get<double>());
  CHECK(found["volume"]["error"].get<double>() < 0.2);
}

TEST_CASE("compare searches the place of a model that nobody gives", "[cli][e2e][compare]") {
  const CompareBench bench;
  const double known = bench.error_of({"ball/pattern.fold", "ball.stl"});
  const json found = bench.compared({"ball/pattern.fold", "ball.stl", "--fit", "--no-cost"});
  CHECK(found["placement"]["from"] == "fit");
  CHECK(found["error"].get<double>() < known + 0.1);
  CHECK(found["placement"]["misfit"].get<double>() < 0.7);
  // The same twice.
  CHECK(bench.error_of({"ball/pattern.fold", "ball.stl", "--fit"}) == found["error"].get<double>());
}

TEST_CASE("compare says what it cannot measure", "[cli][e2e][compare]") {
  const CompareBench bench;
  write_file(bench.temp / "open.stl", binary_stl(box_mesh({0, 0, 0}, {30, 50, 20}, true)));
  const json open = bench.compared({"ball/pattern.fold", "open.stl", "--scale", "1", "--no-cost"});
  CHECK(open["volume"]["ran"] == false);
  CHECK(says(open["volume"]["why"].get<std::string>(), "not closed"));
  CHECK(open["cost"]["ran"] == false);
  const json round = bench.compared({"ball/pattern.fold", "ball.stl", "--around", "--no-cost"});
  CHECK(round["views"].size() == 36);
  CHECK(round["volume"]["ran"] == false);
  // What does not fit on the mat is still compared.
  const json small = bench.compared({"ball/pattern.fold", "ball.stl", "--machine", "no-such"});
  CHECK(small["cost"]["ran"] == false);
  CHECK(says(small["cost"]["why"].get<std::string>(), "no-such"));
}

TEST_CASE("compare refuses bad input in one line", "[cli][e2e][compare]") {
  const CompareBench bench;
  const auto refused = [&](std::vector<std::string> words, int exit, const std::string& part) {
    words.insert(words.begin(), "compare");
    words.emplace_back("--no-cost");
    const Ran ran = bench.popcut(words);
    check_refused(ran, exit, part);
    CHECK(ran.out.empty());
    CHECK_FALSE(says(ran.err, words[2] + ": " + words[2]));  // a file is named once
  };
  refused({"absent.fold", "ball.stl"}, 3, "absent.fold");
  refused({"ball/pattern.fold", "absent.stl"}, 3, "absent.stl");
  refused({"ball.json", "ball.stl"}, 3, "design");
  refused({"ball/pattern.fold", "ball/pattern.fold"}, 3, "is a pattern");
  write_file(bench.temp / "empty.stl", "solid nothing\nendsolid nothing\n");
  refused({"ball/pattern.fold", "empty.stl"}, 3, "empty.stl");
  write_file(bench.temp / "point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  refused({"ball/pattern.fold", "point.obj"}, 3, "no size");
  // 20 million triangles are said in the header of 84 bytes.
  std::string many(84, '\0');
  many[80] = '\x00', many[81] = '\x2d', many[82] = '\x31', many[83] = '\x01';
  write_file(bench.temp / "many.stl", many);
  refused({"ball/pattern.fold", "many.stl"}, 3, "many.stl");
  json fold = json::parse(text_of_file(bench.temp / "ball/pattern.fold"));
  json torn = fold;
  for (json& frame : torn["file_frames"]) frame["vertices_coords"][5][2] = 55.5;
  write_file(bench.temp / "torn.fold", torn.dump());
  refused({"torn.fold", "ball.stl"}, 3, "torn.fold: /file_frames/");
  json bare = fold;
  bare.erase("faces_vertices"), bare.erase("file_frames");
  bare["edges_vertices"] = json::array({json::array({0, 1}), json::array({1, 2})});
  for (const char* list :
       {"edges_assignment", "edges_foldAngle", "edges_faces", "edges_popcut:role"})
    bare.erase(list);
  write_file(bench.temp / "bare.fold", bare.dump());
  refused({"bare.fold", "ball.stl"}, 3, "bare.fold");
  json odd = fold;
  odd["popcut:model_placement"] = {1, 2, 3};
  write_file(bench.temp / "odd.fold", odd.dump());
  refused({"odd.fold", "ball.stl"}, 3, "/popcut:model_placement");
  write_file(bench.temp / "plain.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='80mm' viewBox='0 0 100 "
             "80'><path d='M0 0H100V80H0Z' stroke='black' fill='none'/>"
             "<path d='M0 40H100' stroke='blue' fill='none' id='valley'/></svg>");
  refused({"plain.svg", "ball.stl"}, 3, "plain.svg");
  refused({"ball/pattern.fold", "ball.stl", "--move", "-900,0,-900"}, 3, "in front of the card");
  refused({"ball/pattern.fold", "ball.stl", "--move", "1,2"}, 2, "three numbers");
  refused({"ball/pattern.fold", "ball.stl", "--pixels", "5"}, 2, "--pixels");
  refused({"ball/pattern.fold", "ball.stl", "--psi", "200deg"}, 2, "--psi");
  refused({"ball/pattern.fold", "ball.json", "--scale", "2"}, 2, "leave out --scale");
  // Nothing is half written.
  CHECK(bench.popcut({"compare", "torn.fold", "ball.stl", "-o", "never"}).exit == 3);
  CHECK_FALSE(std::filesystem::exists(bench.temp / "never"));
}

}  // namespace compare_command_test
