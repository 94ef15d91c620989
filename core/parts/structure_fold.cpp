// SPDX-License-Identifier: MIT
#include "core/parts/structure_fold.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFlat_rad = 1e-9;
constexpr double kHalfOpen_rad = 1.9, kHalfOpen = 0.7;  ///< at most, and of the open card

Json line_json(const FlatLine& line) {
  return {line[0].x(), line[0].y(), line[1].x(), line[1].y()};
}

Json side_json(const Structure& card, const PartSide& side, bool has_line) {
  Json json{{"part", card.parts[side.part].name}, {"face", side.face}};
  if (has_line) json["line_mm"] = line_json(side.line);
  return json;
}

/// By how much the second face of a hinge or crossing is turned, as a valley fold turns what is
/// left of its line.
double turn_of(const PartJoint& joint, const PartPoses& pose) {
  const Eigen::Isometry3d turn = pose[joint.a.part][joint.a.face].inverse() *
                                 pose[joint.b.part][joint.b.face] *
                                 glued(joint.b.line, joint.a.line, joint.turned).inverse();
  const Vec2 along = unit(Vec2(joint.a.line[1] - joint.a.line[0]));
  const Eigen::Matrix3d& r = turn.linear();
  const Vec3 twice_sine{r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)};
  return std::atan2(dot(Vec3{along.x(), along.y(), 0.0}, twice_sine), r.trace() - 1.0);
}

Result<Json> frame_json(const SheetPart& part, std::span<const Eigen::Isometry3d> pose) {
  for (const auto& one : pose)
    if (!one.matrix().allFinite())
      return fail(ErrorKind::Infeasible, part.name, "has no place at the opening of the file");
  Json vertices = Json::array(), edges = Json::array(), letters = Json::array(),
       angles = Json::array();
  for (const Vec2& p : part.vertices) vertices.push_back({p.x(), p.y()});
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> done;
  for (const PartFold& fold : folds_of(part, pose)) {
    const bool slit = part.is_slit(fold.from, fold.to);
    done[{fold.from, fold.to}] = true;
    edges.push_back({fold.from, fold.to});
    letters.push_back(slit                                   ? "C"
                      : std::abs(fold.angle_rad) < kFlat_rad ? "F"
                      : fold.angle_rad > 0.0                 ? "V"
                                                             : "M");
    angles.push_back(slit ? 0.0 : degrees(fold.angle_rad));
  }
  for (const auto& face : part.faces)
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
      if (done.contains(std::minmax(a, b))) continue;
      done[std::minmax(a, b)] = true;
      edges.push_back({a, b});
      letters.push_back("B");
      angles.push_back(0.0);
    }
  return Json{{"frame_title", part.name},
              {"frame_classes", {"creasePattern"}},
              {"frame_attributes", {"2D"}},
              {"frame_unit", "mm"},
              {"frame_inherit", false},
              {"vertices_coords", std::move(vertices)},
              {"edges_vertices", std::move(edges)},
              {"edges_assignment", std::move(letters)},
              {"edges_foldAngle", std::move(angles)},
              {"faces_vertices", part.faces}};
}

}  // namespace

Result<std::string> structure_fold(const Structure& card, const std::string& creator,
                                   std::optional<double> pose_rad) {
  const double opening_rad =
      pose_rad.value_or(std::min(kHalfOpen_rad, kHalfOpen * radians(card.opens_deg)));
  static constexpr std::array kKinds{"hinge", "glue", "slot", "cross"};
  const PartPoses pose = posed(card, opening_rad);
  Json joints = Json::array(), frames = Json::array();
  for (const PartJoint& joint : card.joints) {
    Json json{{"type", kKinds[static_cast<std::size_t>(joint.kind)]},
              {"a", side_json(card, joint.a, true)},
              {"b", side_json(card, joint.b, joint.kind != PartJointKind::Slot)}};
    if (joint.turned) json["turned"] = true;
    if (joint.kind == PartJointKind::Hinge || joint.kind == PartJointKind::Cross)
      json["angle_deg"] = degrees(turn_of(joint, pose));
    joints.push_back(std::move(json));
  }
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    auto frame = frame_json(card.parts[p], pose[p]);
    if (!frame) return tl::unexpected(frame.error());
    frames.push_back(std::move(*frame));
  }
  Json file{{"file_spec", 1.2},
            {"file_creator", creator},
            {"file_classes", {"multiModel"}},
            {"file_title", card.name},
            {"popcut:opening_deg", degrees(opening_rad)}};
  if (card.opens_deg < 180.0) file["popcut:opens_deg"] = card.opens_deg;
  if (!card.planes.empty()) file["popcut:pages"] = card.pages;
  file["popcut:thickness_mm"] = card.thickness_mm;
  file["popcut:joints"] = std::move(joints);
  file["file_frames"] = std::move(frames);
  return json_line(file) + "\n";
}

}  // namespace popcut
