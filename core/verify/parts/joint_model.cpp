// SPDX-License-Identifier: MIT
#include "core/verify/parts/joint_model.hpp"

#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"

namespace popcut::verify {
namespace {

constexpr const char* kJoints = "popcut:joints";
constexpr double kLeastLine_mm = 1e-3;

/// Reads the joints of a card whose parts are known.
class JointReader {
 public:
  explicit JointReader(JointModel& model) : model_(model) {
    for (std::size_t p = 0; p < model.parts.size(); ++p) number_.emplace(model.parts[p].name, p);
  }

  void read(FieldReader& in) {
    CardJoint joint;
    joint.place = in.pointer("");
    joint.place.pop_back();
    joint.kind =
        static_cast<JointKind>(in.word("type", std::nullopt, {"hinge", "glue", "slot", "cross"}));
    in.object("a", [&](FieldReader& side) { read_side(side, true, joint.a); });
    in.object("b",
              [&](FieldReader& side) { read_side(side, joint.kind != JointKind::Slot, joint.b); });
    joint.turned = in.boolean("turned", false);
    joint.angle_deg = in.number("angle_deg", 0.0, -180.0, 180.0);
    if (in.faults().empty() && joint.kind != JointKind::Slot) check_lengths(in, joint);
    if (in.faults().empty() && joint.a.part == joint.b.part && joint.a.face == joint.b.face)
      in.refuse("b", ErrorKind::OutOfRange, "joins a face to itself");
    model_.joints.push_back(std::move(joint));
  }

 private:
  void read_side(FieldReader& in, bool has_line, JointSide& out) {
    const std::string name = in.text("part", std::nullopt);
    const auto found = number_.find(name);
    if (found == number_.end()) {
      in.refuse("part", ErrorKind::OutOfRange,
                fmt::format("names no part; give the frame_title of one of the {} frames",
                            model_.parts.size()));
      return;
    }
    out.part = found->second;
    const std::size_t faces = model_.parts[out.part].sheet.faces();
    out.face =
        static_cast<std::size_t>(in.integer("face", std::nullopt, 0, static_cast<int>(faces) - 1));
    if (!has_line) return;
    const std::vector<double> at = in.numbers("line_mm", 4);
    if (at.size() != 4) return;
    for (const double mm : at)
      if (!(std::abs(mm) <= kMaxCoordinate_mm)) {
        in.refuse("line_mm", ErrorKind::OutOfRange,
                  fmt::format("has {} mm, not within {} mm", mm, kMaxCoordinate_mm));
        return;
      }
    out.line = {Vec2{at[0], at[1]}, Vec2{at[2], at[3]}};
    if (norm(out.line[1] - out.line[0]) < kLeastLine_mm)
      in.refuse("line_mm", ErrorKind::OutOfRange, "has no length; give two different points");
  }

  static void check_lengths(FieldReader& in, const CardJoint& joint) {
    const double a = norm(joint.a.line[1] - joint.a.line[0]),
                 b = norm(joint.b.line[1] - joint.b.line[0]);
    if (std::abs(a - b) > 1e-6 * (a + b))
      in.refuse(
          "b/line_mm", ErrorKind::OutOfRange,
          fmt::format("is {:.6g} mm long, and the line of a {:.6g} mm; they are one line", b, a));
  }

  JointModel& model_;
  std::map<std::string, std::size_t> number_;
};

void read_pages(FieldReader& in, JointModel& model) {
  const std::vector<double> given = in.numbers("popcut:pages", 2);
  if (given.size() != 2) return;
  const auto faces = static_cast<double>(model.parts.front().sheet.faces());
  for (const double face : given)
    if (!(face >= 0.0 && face < faces && face == std::floor(face)) || given[0] == given[1]) {
      in.refuse(
          "popcut:pages", ErrorKind::OutOfRange,
          fmt::format("must be two different faces of the first part, 0 to {:g}", faces - 1.0));
      return;
    }
  model.pages = {static_cast<std::size_t>(given[0]), static_cast<std::size_t>(given[1])};
}

}  // namespace

Result<JointModel> read_joint_model(std::string_view text) {
  constexpr JsonLimits kLimits{64u << 20, 2'000'000, 64};
  const auto json = parse_json_data(text, kLimits);
  if (!json) return tl::unexpected(json.error());
  if (!json->is_object() || !json->contains(kJoints))
    return fail(ErrorKind::Malformed, std::string("/") + kJoints,
                "is missing; a card of several parts lists its joints");
  auto parts = read_fold_parts(text);
  if (!parts) return tl::unexpected(parts.error());
  JointModel model;
  if (const auto title = json->find("file_title"); title != json->end() && title->is_string())
    model.title = title->get<std::string>();
  if (parts->size() > kMostParts)
    return fail(ErrorKind::OutOfRange, "/file_frames",
                fmt::format("{} parts; at most {}", parts->size(), kMostParts));
  std::map<std::string, std::string> seen;
  for (FoldPart& part : *parts) {
    if (part.name.empty())
      return fail(ErrorKind::Malformed, part.place + "/frame_title",
                  "is missing; it is the name of the part");
    const auto [other, is_new] = seen.emplace(part.name, part.place);
    if (!is_new)
      return fail(ErrorKind::Malformed, part.place + "/frame_title",
                  fmt::format("is that of {} too; parts need different names", other->second));
    model.parts.push_back({std::move(part.name), std::move(part.place), std::move(part.sheet)});
  }
  // The rest of the file is FOLD's, so only what is read here may not be wrong.
  nlohmann::json own{{kJoints, (*json)[kJoints]}};
  for (const char* name : {"popcut:thickness_mm", "popcut:opens_deg", "popcut:pages"})
    if (const auto found = json->find(name); found != json->end()) own[name] = *found;
  FieldReader in(own);
  JointReader joints(model);
  in.objects(
      kJoints, [&](FieldReader& joint) { joints.read(joint); }, kMostJoints);
  model.thickness_mm = in.number("popcut:thickness_mm", 0.3, 0.0, 10.0);
  model.opens_deg = in.number("popcut:opens_deg", 180.0, 30.0, 180.0);
  if (in.has("popcut:pages")) read_pages(in, model);
  if (auto done = in.finish(); !done) return tl::unexpected(done.error());
  return model;
}

}  // namespace popcut::verify
