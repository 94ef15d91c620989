// SPDX-License-Identifier: MIT
#include "core/judge/sheet_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/deploy/loaded_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/geometry/angle.hpp"
#include "core/rigid/motion.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/motion/motion.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/planar.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::judge {
namespace {

using verify::Assignment;
using verify::FoldModel;
using verify::Pose;
using verify::Sheet;

constexpr const char* kAskVerify = "'popcut verify' lists the places";

/// A flat sheet that is one sound piece, and how exact it is.
struct Ready {
  FoldModel model;
  Sheet sheet;
  verify::Limits limits;
};

/// The frames of the file must show the sheet that is opened: edges keep their lengths.
Result<void> check_frames(const FoldModel& model) {
  const double limit_mm = verify::limits_of(model).isometry_mm;
  for (const Pose& pose : model.poses) {
    for (std::size_t e = 0; e < model.edges.size(); ++e) {
      const auto [a, b] = model.edges[e];
      const double off =
          std::abs((pose.at[a] - pose.at[b]).norm() - (model.flat[a] - model.flat[b]).norm());
      if (off <= limit_mm) continue;
      return fail(ErrorKind::OutOfRange, pose.place + "/vertices_coords",
                  fmt::format("the frame stretches the sheet by {:.2g} mm at edge {}; {}", off, e,
                              kAskVerify));
    }
  }
  return {};
}

/// The sheet with its faces, separated along its cuts.
Result<Ready> ready_sheet(FoldModel model) {
  const auto frames_fit = check_frames(model);
  if (!frames_fit) return tl::unexpected(frames_fit.error());
  model.poses.clear();  // tracing joins vertices that poses have apart
  if (!model.faces_given) {
    if (auto done = verify::planarise(model); !done) return tl::unexpected(done.error());
  }
  if (model.faces() == 0)
    return fail(ErrorKind::OutOfRange, "/faces_vertices",
                "the edges enclose no face, so there is no sheet; close the outline");
  Ready ready{std::move(model), {}, {}};
  ready.limits = verify::limits_of(ready.model);
  VerifyCheck faces = verify::named("faces");
  ready.sheet = verify::make_sheet(ready.model, faces);
  if (!faces.ok())
    return fail(ErrorKind::OutOfRange, faces.failures.front().place,
                fmt::format("{}; {}", faces.failures.front().detail, kAskVerify));
  for (std::size_t f = 0; f < ready.model.faces(); ++f)
    if (!(verify::area(ready.model, f) > 0))
      return fail(ErrorKind::OutOfRange, fmt::format("/faces_vertices/{}", f),
                  "runs clockwise or has no area; list its vertices counter-clockwise");
  if (ready.sheet.hinges.empty())
    return fail(ErrorKind::OutOfRange, "/edges_assignment",
                "no fold joins two faces, so nothing opens; draw mountains (M, red) and valleys "
                "(V, blue) between the faces");
  if (ready.sheet.pieces != 1)
    return fail(ErrorKind::OutOfRange, "/faces_vertices",
                fmt::format("the sheet is {} separate pieces, so no fold moves them all; give a "
                            "file with one piece",
                            ready.sheet.pieces));
  if (verify::part_at_cuts(ready.model, ready.sheet) > 0) {
    VerifyCheck reported_before;
    ready.sheet = verify::make_sheet(ready.model, reported_before);
  }
  return ready;
}

/// The driving fold, and coordinates of the sheet in which it runs along v at u = 0.
struct Spine {
  Vec2 on, along{0, 1};
  std::uint32_t edge{}, near_panel{};  ///< the panel at smaller u
  bool is_valley{true};
  std::array<std::uint32_t, 3> anchors{};  ///< vertices of the panel, far apart

  [[nodiscard]] Vec2 laid(const Vec2& p) const {
    const Vec2 across{along.y(), -along.x()};
    return {across.dot(p - on), along.dot(p - on)};
  }
};

/// @param edge  a fold of the driving line, as the opening found it
Spine spine_of(const Ready& ready, std::uint32_t edge) {
  const auto& hinges = ready.sheet.hinges;
  const auto hinge = std::find_if(hinges.begin(), hinges.end(),
                                  [&](const verify::Hinge& h) { return h.edge == edge; });
  const auto [from, to] = ready.model.edges[edge];
  Spine spine;
  spine.edge = edge;
  Vec2 way = (ready.model.flat[to] - ready.model.flat[from]).normalized();
  constexpr double kStraight = 1e-6;  // what rounding tilts a line by
  if (std::abs(way.x()) < kStraight) way = {0, way.y() < 0 ? -1 : 1};
  if (std::abs(way.y()) < kStraight) way = {way.x() < 0 ? -1 : 1, 0};
  if (way.y() < 0 || (way.y() == 0 && way.x() < 0)) way = -way;
  spine.along = way;
  double least = 0;
  spine.on = ready.model.flat[from];
  for (const auto& e : ready.model.edges)
    for (const std::uint32_t v : e) least = std::min(least, spine.laid(ready.model.flat[v]).y());
  spine.on += least * way;  // v = 0 is where the sheet begins
  // Left of the way along the fold is where u is smaller.
  const bool forth = way.dot(ready.model.flat[hinge->to] - ready.model.flat[hinge->from]) > 0;
  spine.near_panel = ready.sheet.panel_of_face[forth ? hinge->left : hinge->right];
  spine.anchors = verify::make_panels(ready.model, ready.sheet).anchors[spine.near_panel];
  return spine;
}

/// Carries a solved pose to where popcut's law of motion has the panel beside the spine.
std::vector<Vec3> laid_pose(const Ready& ready, const Spine& spine, const Pose& pose) {
  const double psi = *pose.psi_rad;
  std::array<Vec3, 3> is, due;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 p = spine.laid(ready.model.flat[spine.anchors[k]]);
    is[k] = pose.at[spine.anchors[k]];
    due[k] = spine.is_valley ? Vec3(-p.x() * std::cos(psi), p.y(), -p.x() * std::sin(psi))
                             : Vec3(p.x(), p.y(), 0);
  }
  const rigid::Motion carry = rigid::motion_of(is, due);
  std::vector<Vec3> places;
  places.reserve(pose.at.size());
  for (const Vec3& p : pose.at) places.push_back(carry(p));
  return places;
}

/// Folds as mountains and valleys, also those that the file leaves open: by how they turn.
std::vector<char> letters_of(const Ready& ready, const Pose& pose) {
  static constexpr std::string_view kLetters = "BMVFUCJ";
  std::vector<char> letters;
  for (const Assignment a : ready.model.assignment)
    letters.push_back(kLetters[static_cast<std::size_t>(a)]);
  const auto motion = verify::measure(ready.model, ready.sheet,
                                      verify::make_panels(ready.model, ready.sheet), pose);
  for (std::size_t k = 0; k < ready.sheet.hinges.size(); ++k) {
    char& letter = letters[ready.sheet.hinges[k].edge];
    if (letter == 'U') letter = motion.hinge_angle_deg[k] < 0 ? 'M' : 'V';
  }
  return letters;
}

/// The flat sheet in the coordinates of its spine, as a frame of a FOLD file.
FoldFrame flat_frame_of(const Ready& ready, const Spine& spine, std::vector<char> letters) {
  FoldFrame frame;
  frame.unit = "mm";
  for (const Vec2& at : ready.model.flat) {
    const Vec2 p = spine.laid(at);
    frame.vertices.push_back({p.x(), p.y(), 0});
  }
  frame.edges = ready.model.edges;
  frame.assignments = std::move(letters);
  frame.fold_angles_deg.assign(frame.edges.size(), 0.0);
  for (std::size_t f = 0; f < ready.model.faces(); ++f) {
    const auto corners = verify::face_of(ready.model, f);
    frame.faces.emplace_back(corners.begin(), corners.end());
  }
  return frame;
}

/// A pattern with the flat sheet for its pose: the meshes of a solved motion start from it.
Pattern flat_pattern(const FoldFrame& frame) {
  Pattern pattern;
  pattern.card = false;
  for (const auto& [u, v, z] : frame.vertices) {
    pattern.vertices.push_back({u, 0, v});
    pattern.width_mm = std::max(pattern.width_mm, v);
    pattern.ground_mm = std::max(pattern.ground_mm, u);
  }
  add_faces_and_edges(frame, pattern);
  return pattern;
}

/// What to say of a sheet that does not open as far as asked.
Error too_far(const verify::Trajectory& opening, double asked_rad) {
  const double reached = opening.reached_psi_rad;
  if (opening.poses.empty() && reached > std::numbers::pi - 0.01)
    return {ErrorKind::OutOfRange, "",
            fmt::format("{}; 'popcut verify' checks its folds and cuts", opening.stopped)};
  // Rounded away from shut, so that the angle can be given as it stands.
  const double least_deg = std::ceil(10 * degrees(reached)) / 10;
  return {ErrorKind::OutOfRange, "",
          fmt::format("opens only to psi = {:.1f} degrees ({}), and {:.1f} degrees are asked for; "
                      "give --to-psi {:.1f}deg or more",
                      least_deg, opening.stopped, degrees(asked_rad), least_deg)};
}

Result<verify::Trajectory> opened(const Ready& ready, std::span<const double> psi_rad) {
  verify::Trajectory opening =
      verify::open_sheet(ready.model, ready.sheet, psi_rad, 0.5 * ready.limits.isometry_mm);
  if (opening.poses.size() < psi_rad.size() || !opening.stopped.empty())
    return tl::unexpected(
        too_far(opening, psi_rad[std::min(opening.poses.size(), psi_rad.size() - 1)]));
  if (opening.reversed > 0)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("does not open with its mountains and valleys as they are: {} of its folds "
                    "turn the other way in the best motion found; {}",
                    opening.reversed, kAskVerify));
  return opening;
}

/// Lays the spine where wall and ground meet, wherever the driving fold is: nothing of a card lies
/// behind its wall or below its ground. The sheet begins at u = 0.
void lay_on_card(Pattern& pattern) {
  double x = INFINITY, z = INFINITY;
  for (const PatternVertex& p : pattern.vertices) x = std::min(x, p.x), z = std::min(z, p.z);
  for (PatternVertex& p : pattern.vertices) p.x -= x, p.z -= z;
  pattern.wall_mm = pattern.ground_mm = 0;
  for (const PatternVertex& p : pattern.vertices) {
    pattern.wall_mm = std::max(pattern.wall_mm, p.z - p.x);
    pattern.ground_mm = std::max(pattern.ground_mm, p.x - p.z);
  }
}

/// The pattern whose law of motion is popcut's own, if this pose is one of it.
Result<Pattern> pattern_of_law(const FoldFrame& flat, const std::vector<Vec3>& places,
                               double psi_rad) {
  FoldFile file;
  FoldFrame deployed;
  deployed.unit = flat.unit;
  deployed.folded_form = true;
  deployed.psi_rad = psi_rad;
  for (const Vec3& p : places) deployed.vertices.push_back({p.x(), p.y(), p.z()});
  file.frames = {flat, std::move(deployed)};
  auto pattern = pattern_from_fold(file);
  if (pattern) lay_on_card(*pattern);
  return pattern;
}

/// Opens to each angle, each flat one being the sheet itself.
Result<SolvedPoses> solve(const Ready& ready, const Spine& spine, std::span<const double> psi_rad,
                          const FoldFrame& flat) {
  constexpr double kFlatWithinRad = 1e-9;
  SolvedPoses motion;
  motion.psi_rad.assign(psi_rad.begin(), psi_rad.end());
  std::sort(motion.psi_rad.begin(), motion.psi_rad.end(), std::greater<>());
  motion.slack_mm = ready.limits.isometry_mm;
  std::vector<double> bent;
  for (const double psi : motion.psi_rad) {
    if (psi < std::numbers::pi - kFlatWithinRad) {
      bent.push_back(std::max(psi, 1e-6));
      continue;
    }
    motion.places.emplace_back();
    for (const auto& [u, v, z] : flat.vertices) motion.places.back().emplace_back(u, v, z);
  }
  if (bent.empty()) return motion;
  // Shut panels lie on each other, and a solver cannot tell which way they go on.
  constexpr double kLeastDeg = 2;
  if (bent.back() < radians(kLeastDeg) * (1 - 1e-9))
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("opens only to psi = {0} degrees: its panels are not all parallel to "
                            "wall or ground, and such a pattern is not followed until it is shut; "
                            "give --to-psi {0}deg or more",
                            kLeastDeg));
  const auto opening = opened(ready, bent);
  if (!opening) return tl::unexpected(opening.error());
  if (opening->driver_edge != spine.edge)
    return fail(ErrorKind::OutOfRange, "",
                "another fold than the longest one moves this pattern at these angles; give "
                "--from-psi and --to-psi between 90deg and 180deg");
  for (const Pose& pose : opening->poses) motion.places.push_back(laid_pose(ready, spine, pose));
  return motion;
}

}  // namespace

Result<PoseTable> SolvedPoses::table(const Pattern& pattern,
                                     std::span<const double> asked_rad) const {
  return pose_table(
      pattern, asked_rad,
      [&](double psi, std::span<Vec3> into) {
        const auto at = std::find(psi_rad.begin(), psi_rad.end(), psi) - psi_rad.begin();
        const auto& from = places.at(static_cast<std::size_t>(at));
        std::copy(from.begin(), from.end(), into.begin());
      },
      slack_mm);
}

Result<SheetMotion> open_flat_sheet(std::string_view fold_text, std::span<const double> psi_rad,
                                    const Progress& progress) {
  auto model = verify::read_fold_model(fold_text);
  if (!model) return tl::unexpected(std::move(model.error()));
  tell(progress, "rebuilding the sheet", 0.1);
  const auto ready = ready_sheet(std::move(*model));
  if (!ready) return tl::unexpected(ready.error());
  tell(progress, "opening the pattern", 0.3);
  // The pose in which all lengths of popcut's law are known best.
  const std::array<double, 1> upright{std::numbers::pi / 2};
  const auto opening = opened(*ready, upright);
  if (!opening) return tl::unexpected(opening.error());
  const Pose& pose = opening->poses.front();
  Spine spine = spine_of(*ready, static_cast<std::uint32_t>(opening->driver_edge));
  auto letters = letters_of(*ready, pose);
  spine.is_valley = letters[spine.edge] != 'M';
  const FoldFrame flat = flat_frame_of(*ready, spine, std::move(letters));
  if (auto pattern = pattern_of_law(flat, laid_pose(*ready, spine, pose), upright[0]); pattern)
    return SheetMotion{std::move(*pattern), std::nullopt};
  tell(progress, "opening it to each angle", 0.5);
  auto motion = solve(*ready, spine, psi_rad, flat);
  if (!motion) return tl::unexpected(motion.error());
  return SheetMotion{flat_pattern(flat), std::move(*motion)};
}

}  // namespace popcut::judge
