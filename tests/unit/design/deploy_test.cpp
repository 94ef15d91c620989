// SPDX-License-Identifier: MIT
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "core/deploy/glb.hpp"
#include "core/deploy/loaded_pattern.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/deploy/sheet_mesh.hpp"
#include "core/deploy/shut_stack.hpp"
#include "core/deploy/stl.hpp"
#include "core/formats/csv/segments_reader.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/segments_csv.hpp"
#include "core/picture/poster.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/glb_scene.hpp"
#include "tests/support/value.hpp"

namespace deploy_test {

using namespace popcut;
using namespace std::numbers;
using testing::box_card_pattern;
using testing::GlbScene;

namespace {

PoseTable table_of(const Pattern& pattern, std::vector<double> psi_rad) {
  return testing::value(pose_table(pattern, psi_rad));
}

/// Corners of a binary STL, three a triangle, normals first.
struct Stl {
  std::string header;
  std::vector<std::array<std::array<float, 3>, 4>> triangles;
};

Stl parse_stl(const std::string& bytes) {
  Stl stl{bytes.substr(0, 80), {}};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  REQUIRE(bytes.size() == 84 + 50 * static_cast<std::size_t>(count));
  stl.triangles.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(&stl.triangles[i], bytes.data() + 84 + 50 * i, 48);
  return stl;
}

Stl stl_of(const SheetMesh& mesh, const PoseTable& table, std::size_t pose,
           MeshAxes axes = MeshAxes::Upright) {
  std::ostringstream out;
  write_stl(mesh, table, pose, axes, "test", out);
  return parse_stl(out.str());
}

FoldFile fold_file(const Pattern& pattern, std::vector<double> psi_rad) {
  std::ostringstream out;
  REQUIRE(write_fold(pattern, {.psi_rad = std::move(psi_rad)}, out));
  return testing::value(read_fold(out.str()));
}

/// A pattern of one face with the given corners on the ground, counter-clockwise in (u, v).
Pattern one_face(const std::vector<std::array<double, 2>>& corners) {
  Pattern pattern;
  pattern.face_first = {0};
  for (const auto& [u, v] : corners) {
    pattern.face_vertices.push_back(static_cast<std::uint32_t>(pattern.vertices.size()));
    pattern.vertices.push_back({u, 0, v});
  }
  pattern.face_first.push_back(static_cast<std::uint32_t>(corners.size()));
  return pattern;
}

Error error_of(const std::string& text, SegmentConvention convention = SegmentConvention::Popcut) {
  const auto read = read_segments_csv(text, convention);
  REQUIRE_FALSE(read);
  return read.error();
}

}  // namespace

TEST_CASE("angles of frames keep both ends to the digit", "[core][deploy]") {
  const auto angles = testing::value(opening_angles(pi, pi / 2, 60));
  CHECK(angles.size() == 60);
  CHECK(angles.front() == pi);
  CHECK(angles.back() == pi / 2);
  CHECK(angles[1] == Approx(pi - pi / 2 / 59));
  CHECK(opening_angles(1, 1, 1)->size() == 1);
}

TEST_CASE("invalid lists of angles are refused", "[core][deploy]") {
  for (const int frames : {0, -3, kMaxFrames + 1})
    CHECK(opening_angles(pi, 0, frames).error().kind == ErrorKind::Usage);
  CHECK_FALSE(opening_angles(4, 0, 2));
  CHECK_FALSE(opening_angles(pi, std::nan(""), 2));
  CHECK_FALSE(opening_angles(1, 1, 2));
  const Pattern card = box_card_pattern();
  for (const std::vector<double>& wrong :
       {std::vector<double>{1, 2, 1.5}, {1, 1}, {0.5, 7}, {2, std::nan("")}}) {
    const auto table = pose_table(card, wrong);
    REQUIRE_FALSE(table);
    CHECK(table.error().kind == ErrorKind::OutOfRange);
    CHECK(table.error().place.rfind("pose ", 0) == 0);
  }
}

TEST_CASE("the ground is the root and every face hangs on its hinge", "[core][deploy]") {
  const Pattern card = box_card_pattern();
  const PoseTable table = table_of(card, {pi, 2.0, pi / 2, 0.3});
  REQUIRE(table.bodies() == 4);
  // Faces: top and front of the box, wall, ground.
  CHECK(table.parent[3] == -1);
  CHECK(table.parent[2] == 3);
  CHECK(table.order.front() == 3);
  for (std::size_t b = 0; b < table.bodies(); ++b) {
    if (table.parent[b] < 0) continue;
    for (std::size_t k = 0; k < table.poses(); ++k) {
      const Vec3 own = table.at(k, b)(table.pivot[b]);
      const Vec3 held = table.at(k, static_cast<std::size_t>(table.parent[b]))(table.pivot[b]);
      CHECK(norm(own - held) < 1e-10);
    }
  }
}

TEST_CASE("a face that bends is reported by its number", "[core][deploy]") {
  const Pattern card = box_card_pattern();
  const std::vector<double> psi{2.0};
  const auto table = pose_table(card, psi, [&](double angle, std::span<Vec3> places) {
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] = vec3(posed(card.vertices[i], angle));
    places[card.face(1)[2]][1] += 0.1;
  });
  REQUIRE_FALSE(table);
  CHECK(table.error().place == "faces/1");
}

TEST_CASE("parallel panels need few keyframes and others get all of them", "[core][deploy]") {
  const Pattern card = box_card_pattern();
  const auto angles = opening_angles(pi, 0, 61);
  CHECK(animation_keys(table_of(card, *angles)).size() == 4);
  // The same card with a box that lags behind: still rigid and no longer even in psi.
  const auto uneven = pose_table(card, *angles, [&](double psi, std::span<Vec3> places) {
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] = vec3(posed(card.vertices[i], psi * psi / pi));
  });
  REQUIRE(uneven);
  CHECK(animation_keys(*uneven).size() == 61);
}

TEST_CASE("a surface mesh has two triangles a panel and the area of the sheet", "[core][deploy]") {
  const Pattern card = box_card_pattern();
  const Strips strips = testing::box_card_strips();
  const PoseTable table = table_of(card, {pi, pi / 2, 1.2});
  const auto from_strips = surface_mesh(card, strips);
  const auto from_faces = surface_mesh(card);
  REQUIRE(from_strips);
  REQUIRE(from_faces);
  for (const SheetMesh& mesh : {*from_strips, *from_faces}) {
    CHECK(mesh.triangles.size() == 2 * strips.panels());
    for (std::size_t pose = 0; pose < table.poses(); ++pose) {
      double area = 0;
      for (const auto& [normal, a, b, c] : stl_of(mesh, table, pose).triangles) {
        const Vec3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]},
            v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        const Vec3 across = cross(u, v);
        area += norm(across) / 2;
        const Vec3 n{normal[0], normal[1], normal[2]};
        CHECK(norm(n - (1 / norm(across)) * across) < 1e-5);
        if (pose == 0) CHECK(n[2] == Approx(1));  // fronts look up when the sheet lies flat
      }
      CHECK(area == Approx(70.0 * 70.0).epsilon(1e-6));
    }
  }
}

TEST_CASE("an STL is binary and does not begin as the text form does", "[core][deploy]") {
  const Pattern card = box_card_pattern();
  std::ostringstream out;
  write_stl(*surface_mesh(card), table_of(card, {pi}), 0, MeshAxes::Upright, std::string(300, 'x'),
            out);
  CHECK(parse_stl(out.str()).header.rfind("popcut", 0) == 0);
}

TEST_CASE("solids are closed and hold the sheet's area times its thickness", "[core][deploy]") {
  const Pattern card = testing::row_of_boxes(3);
  constexpr double kThickness = 0.27;
  const auto mesh = testing::value(solid_mesh(card, kThickness));
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& side : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++sides[side];
  for (const auto& [side, count] : sides) {
    CHECK(count == 1);
    CHECK(sides.count({side.second, side.first}) == 1);
  }
  const PoseTable table = table_of(card, {1.3});
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](std::uint32_t i) { return table.at(0, mesh.body[i])(mesh.at[i]); };
    volume += dot(at(a), cross(at(b), at(c))) / 6;
  }
  CHECK(volume == Approx(210.0 * 70.0 * kThickness));
  for (const double wrong : {0.0, -1.0, std::nan("")}) CHECK_FALSE(solid_mesh(card, wrong));
}

TEST_CASE("triangles of a face meet corner to corner", "[core][deploy]") {
  // A comb whose corners lie on common lines: each diagonal could pass through one.
  const Pattern comb = one_face({{0, 0},
                                 {4, 0},
                                 {4, 1},
                                 {2, 1},
                                 {2, 2},
                                 {4, 2},
                                 {4, 3},
                                 {2, 3},
                                 {2, 4},
                                 {4, 4},
                                 {4, 5},
                                 {0, 5},
                                 {0, 4},
                                 {1, 4},
                                 {1, 1},
                                 {0, 1}});
  const auto faces = testing::value(triangulate_faces(comb));
  CHECK(faces.triangle.size() == faces.corner.size() - 2);
  for (const auto& triangle : faces.triangle) {
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 &a = faces.corner[triangle[e]], &b = faces.corner[triangle[(e + 1) % 3]];
      for (const Vec3& p : faces.corner) {
        const bool end = norm(p - a) == 0 || norm(p - b) == 0;
        CHECK((end || norm(p - a) + norm(b - p) > norm(b - a) + 1e-9));
      }
    }
  }
}

TEST_CASE("faces that are no polygons are refused by number", "[core][deploy]") {
  for (const auto& wrong :
       {one_face({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), one_face({{0, 0}, {1, 0}, {2, 0}}),
        one_face({{0, 0}, {1, 1}}), one_face({})}) {
    const auto faces = triangulate_faces(wrong);
    REQUIRE_FALSE(faces);
    CHECK(faces.error().place == "faces/0");
  }
  CHECK(triangulate_faces(one_face({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 3}, {2, 1}, {0, 1}})));
}

TEST_CASE("a GLB has a node a face in a hinge tree in metres and y up", "[core][deploy][glb]") {
  const Pattern card = box_card_pattern();
  const PoseTable table = table_of(card, {pi, 2.2, pi / 2});
  const auto bytes = testing::value(glb(card, table, {}));
  const GlbScene scene(bytes);
  REQUIRE(scene.nodes() == 5);
  CHECK(scene.json()["nodes"][2]["name"] == "wall 2");
  CHECK(scene.json()["nodes"][3]["name"] == "ground 3");
  CHECK(scene.json()["nodes"][0]["name"] == "level 0");
  CHECK(scene.json()["nodes"][1]["name"] == "upright 1");
  CHECK(scene.depth(3) == 1);
  CHECK(scene.depth(2) == 2);
  double high = 0, deep = 0, wide = 0;
  for (std::size_t face = 0; face < 4; ++face) {
    for (const Vec3& p : scene.places(face, scene.seconds())) {
      wide = std::max(wide, p[0]);
      high = std::max(high, p[1]);
      deep = std::max(deep, p[2]);
    }
  }
  CHECK(wide == Approx(0.070));
  CHECK(high == Approx(0.040));
  CHECK(deep == Approx(0.030));
  for (const auto& channel : scene.json()["animations"][0]["channels"])
    CHECK(channel["target"]["path"] == "rotation");
}

TEST_CASE("a GLB of one pose has no motion", "[core][deploy][glb]") {
  const Pattern card = box_card_pattern();
  for (const double thickness : {0.0, 0.5}) {
    const auto bytes =
        testing::value(glb(card, table_of(card, {1.0}), {.thickness_mm = thickness}));
    CHECK_FALSE(GlbScene(bytes).json().contains("animations"));
  }
}

TEST_CASE("a pattern comes back from its FOLD file with or without a right angle among its poses",
          "[core][deploy][fold]") {
  const Pattern card = box_card_pattern();
  for (const std::vector<double>& poses : {std::vector<double>{pi, pi / 2}, {1.1}, {0.0, 2.9}}) {
    const auto back = testing::value(pattern_from_fold(fold_file(card, poses)));
    CHECK(back.name == card.name);
    CHECK(back.wall_mm == Approx(card.wall_mm));
    for (std::size_t i = 0; i < card.vertices.size(); ++i) {
      CHECK(back.vertices[i].x == Approx(card.vertices[i].x).margin(1e-9));
      CHECK(back.vertices[i].z == Approx(card.vertices[i].z).margin(1e-9));
      CHECK(back.vertices[i].v == card.vertices[i].v);
    }
    const PoseTable table = table_of(back, {2.0, 1.0});
    CHECK(table.parent == table_of(card, {2.0, 1.0}).parent);
  }
}

TEST_CASE("FOLD files that cannot be deployed are refused with the reason",
          "[core][deploy][fold]") {
  const Pattern card = box_card_pattern();
  CHECK(pattern_from_fold(fold_file(card, {pi})).error().place == "/file_frames");
  FoldFile bent = fold_file(card, {pi / 2, 1.1});
  bent.frames[2].vertices[5][2] += 1;
  CHECK(pattern_from_fold(bent).error().place == "vertex 5");
  FoldFile faceless = fold_file(card, {1.1});
  faceless.frames[0].faces.clear();
  CHECK(pattern_from_fold(faceless).error().place == "/faces_vertices");
  FoldFile far = fold_file(card, {1.1});
  far.frames[1].vertices[0][0] = 1e300;
  CHECK(pattern_from_fold(far).error().kind == ErrorKind::OutOfRange);
  CHECK_FALSE(pattern_from_fold({}));
}

TEST_CASE("popcut's own table of panels gives the design's mesh", "[core][deploy][csv]") {
  const Pattern card = box_card_pattern();
  const Strips strips = testing::box_card_strips();
  std::ostringstream out;
  write_segments_csv(strips, out);
  const auto panels = testing::value(read_segments_csv(out.str(), SegmentConvention::Popcut));
  const Pattern loose = pattern_from_segments(panels, "loose");
  const std::vector<double> psi{pi, 1.0};
  const Stl a = stl_of(rectangle_mesh(loose), table_of(loose, psi), 1);
  const Stl b = stl_of(*surface_mesh(card, strips), table_of(card, psi), 1);
  REQUIRE(a.triangles.size() == b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i)
    for (std::size_t corner = 1; corner < 4; ++corner)
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(a.triangles[i][corner][c] == Approx(b.triangles[i][corner][c]).margin(1e-5));
}

TEST_CASE("loose panels turn about the spine or on a link and never shift", "[core][deploy][csv]") {
  const auto panels = testing::value(read_segments_csv(
      "0,5,30,10,5,30,10,7,1,1,0,8\n10,5,30,10,5,12,18,7,1,1,0,8\n4,25,20,9,25,20,5,6,2,1,0,6\n",
      SegmentConvention::Popcut));
  const Pattern loose = pattern_from_segments(panels, "");
  const auto angles = opening_angles(pi, 0.2, 30);
  const PoseTable table = table_of(loose, *angles);
  REQUIRE(table.bodies() == 4);  // three panels and the link
  CHECK(animation_keys(table).size() < 6);
  const auto bytes = testing::value(glb(loose, table, {}));
  const GlbScene scene(bytes);
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::size_t k = 0; k < table.poses(); ++k) {
      const double at = scene.seconds() * static_cast<double>(k) / 29;
      const auto places = scene.places(f, at);
      for (const Vec3& p : places) {
        double nearest = 1e9;
        for (const std::uint32_t i : loose.face(f)) {
          const Vec3 due = vec3(posed(loose.vertices[i], (*angles)[k]));
          nearest = std::min(nearest, norm(1000.0 * p - Vec3{due[1], due[2], due[0]}));
        }
        CHECK(nearest < 1e-4);
      }
    }
  }
}

TEST_CASE("tables of panels are refused with the line", "[core][deploy][csv]") {
  const std::string good = "0,5,30,10,5,30,10,7,1,1,0,8\n";
  CHECK(error_of("").place == "line 1");
  CHECK(error_of(good + "1,2,3\n").place == "line 2");
  CHECK(error_of(good + "\n" + "0,5,30,10,5,NaN,10,7,1,1,0,8\n").place == "line 3");
  CHECK(error_of("0,5,30,ten,5,30,10,7,1,1,0,8").detail.find("column 4 (x2) is 'ten'") !=
        std::string::npos);
  CHECK(error_of("0,5,30,10,5,30,10,7,1,1,0,-8").kind == ErrorKind::OutOfRange);
  CHECK(error_of("0,5,30,10,5,31,10,7,1,1,0,8").kind == ErrorKind::OutOfRange);  // slanted
  CHECK(error_of("0,5,30,0,9,30,10,7,1,1,0,8").detail.find("--convention paper") !=
        std::string::npos);
  CHECK(error_of("0,5,30,1e9,5,30,10,7,1,1,0,8").kind == ErrorKind::OutOfRange);
  CHECK(error_of("0,5,30,10,5,30,10,7,1,1,0,8,9").place == "line 1");
  const auto read =
      testing::value(read_segments_csv("x1,y1,...\r\n" + good + "\r\n", SegmentConvention::Popcut));
  CHECK(read.size() == 1);
}

TEST_CASE("the paper's convention turns its falling y into z", "[core][deploy][csv]") {
  const auto read =
      read_segments_csv("1,0.25,3,1,0.75,3,0.5,7,1,1,0,0.4", SegmentConvention::Paper);
  REQUIRE(read);
  const SegmentPanel& panel = read->front();
  CHECK(panel.z0 == 0.75);
  CHECK(panel.z1 == 0.25);
  CHECK(panel.v == 3);
  const Pattern loose = pattern_from_segments(*read, "");
  const Stl stl = stl_of(rectangle_mesh(loose), table_of(loose, {pi / 2}), 0, MeshAxes::Paper);
  CHECK(stl.triangles[0][1] == std::array<float, 3>{1, 0.25F, 3.1F});
  CHECK(stl.triangles[0][2] == std::array<float, 3>{1, 0.25F, 2.9F});
}

TEST_CASE("the closed stack is as high as the panels that lie on each other",
          "[core][deploy][thickness]") {
  // The box: top and front lie between wall and ground from 24.5 mm to 37.8 mm off the spine.
  const ShutStack stack = shut_stack(testing::box_card_strips(), 0.3);
  CHECK(stack.layers == 4);
  CHECK(stack.pile_mm == Approx(0.6));
  CHECK(stack.from_spine_mm == Approx(24.5));
  CHECK(stack.v_mm == Approx(32.5));
  CHECK(stack.stays_open_rad == Approx(0.6 / 24.5));
  CHECK_FALSE(thickness_warning(stack, 0.3));
  const auto thick =
      testing::value(thickness_warning(shut_stack(testing::box_card_strips(), 5), 5));
  CHECK(thick.message.find("10.0 mm of paper") != std::string::npos);
  CHECK(thick.message.find("smallest panel") != std::string::npos);
}

TEST_CASE("posters and animations refuse poses that cannot be drawn", "[core][deploy][poster]") {
  const Pattern card = box_card_pattern();
  std::ostringstream out;
  CHECK_FALSE(write_poster_svg(card, {}, {}, out));
  CHECK_FALSE(write_poster_svg(card, std::vector<double>{1, 0}, {}, out));
  CHECK_FALSE(write_film_svg(card, std::vector<double>(101, 1.0), 4, {}, out));
  REQUIRE(write_poster_svg(card, std::vector<double>{pi, 2, 1}, {}, out));
  const std::string text = out.str();
  std::size_t poses = 0;
  for (auto at = text.find("<svg"); at != std::string::npos; at = text.find("<svg", at + 1))
    ++poses;
  CHECK(poses == 4);  // the page and three pictures
}

}  // namespace deploy_test
