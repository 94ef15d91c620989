// SPDX-License-Identifier: MIT
#include "core/verify/parts/parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/text/json_text.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/motion/crossing.hpp"
#include "core/verify/parts/assembled.hpp"
#include "core/verify/parts/followed.hpp"
#include "core/verify/parts/joint_model.hpp"
#include "core/verify/parts/paper_checks.hpp"
#include "core/verify/verify_json.hpp"

namespace popcut {
namespace {

using namespace verify;
using Json = nlohmann::ordered_json;

constexpr double kShutFrom_deg = 1.0;  ///< the first opening that is looked at; the last as far off
constexpr double kShut_mm = 0.01;      ///< that a shut card may reach beyond its pages
constexpr double kCountAt_rad = 1.1;   ///< a pose without flat and shut folds
constexpr double kWobbleAt_deg = 170.0;
constexpr std::size_t kMostWobbling = 1000;  ///< bodies
constexpr std::size_t kMostCounted = 400;    ///< bodies
constexpr double kStackCell_mm = 2.0;

/// A point of the shut card on the pages: from the spine outward, and along it.
using PagePlace = Vec2;

class PartsJudge {
 public:
  PartsJudge(JointModel model, const PartsVerifyOptions& options)
      : model_(std::move(model)), options_(options) {}

  Result<PartsVerifyReport> run() {
    tell(options_.progress, "checking the parts");
    std::vector<Sheet> sheets = judge_parts();
    VerifyCheck joints = named("joints");
    auto card = assemble(model_, std::move(sheets), joints);
    if (!card) return tl::unexpected(card.error());
    card_ = std::move(*card);
    report_.joints = model_.joints.size(), report_.folds = card_.hinges.size();
    report_.tabs = static_cast<std::size_t>(
        std::count_if(model_.joints.begin(), model_.joints.end(),
                      [](const CardJoint& joint) { return joint.kind == JointKind::Glue; }));
    judge_joints(std::move(joints));
    if (is_whole_) open_card();
    VerifyCheck tabs = named("tabs");
    check_tabs(model_, card_, triangles_,
               motion_.states.empty() ? nullptr : &motion_.states[nearest(kCountAt_rad)], tabs);
    add(std::move(tabs));
    if (is_whole_) judge_motion_of_whole();
    return std::move(report_);
  }

 private:
  void add(VerifyCheck check) { report_.checks.push_back(std::move(check)); }

  std::vector<Sheet> judge_parts() {
    std::vector<Sheet> sheets;
    for (const CardPart& part : model_.parts) {
      Subject subject;
      subject.file = part.sheet;
      subject.limits = limits_of(subject.file);
      VerifyCheck faces = named("faces");
      subject.sheet = make_sheet(subject.file, faces);
      VerifyReport report;
      judge_flat_sheet(subject, std::move(faces), report);
      for (VerifyCheck& check : report.checks)
        for (VerifyFailure& failure : check.failures)
          if (failure.place.starts_with('/')) failure.place = part.place + failure.place;
      report_.names.push_back(part.name);
      report_.parts.push_back(std::move(report));
      triangles_.push_back(std::move(subject.triangles));
      sheets.push_back(std::move(subject.sheet));
    }
    return sheets;
  }

  void judge_joints(VerifyCheck check) {
    std::vector<bool> is_loose(card_.bodies, false);
    for (const std::uint32_t body : loose_bodies(card_)) is_loose[body] = true;
    std::set<std::size_t> loose;
    for (std::size_t p = 0; p < model_.parts.size(); ++p)
      for (std::size_t k = 0; k < card_.sheets[p].panels; ++k)
        if (is_loose[card_.body[card_.first_panel[p] + k]]) loose.insert(p);
    for (const std::size_t p : loose)
      check.fail(model_.parts[p].place,
                 fmt::format("{:?} hangs on nothing that hangs on the pages of {:?}",
                             model_.parts[p].name, model_.parts.front().name));
    is_whole_ = loose.empty();
    check.detail =
        fmt::format("{} parts of {} panels, {} joints, {} bodies on {} hinges", model_.parts.size(),
                    card_.body.size(), model_.joints.size(), card_.bodies, card_.hinges.size());
    add(std::move(check));
  }

  void open_card() {
    tell(options_.progress, "opening the card", 0.1);
    std::vector<double> goals;
    const double first = radians(kShutFrom_deg),
                 last = std::min(radians(model_.opens_deg), std::numbers::pi - first);
    const std::size_t count = std::max<std::size_t>(options_.openings, 3);
    goals.push_back(2.0 * first);
    for (std::size_t k = 0; k < count; ++k)
      goals.push_back(first +
                      (last - first) * static_cast<double>(k) / static_cast<double>(count - 1));
    std::sort(goals.begin(), goals.end());
    motion_ = follow(card_, goals);
  }

  void judge_motion_of_whole() {
    judge_opening_of_whole();
    if (motion_.states.empty()) return;
    judge_rank();
    VerifyCheck slots = named("slots");
    if (std::any_of(model_.joints.begin(), model_.joints.end(), [](const CardJoint& joint) {
          return joint.kind == JointKind::Slot || joint.kind == JointKind::Cross;
        })) {
      check_slots(model_, card_, motion_, slots);
      add(std::move(slots));
    }
    combine();
    judge_crossing_of_whole();
    if (motion_.shut_stopped.empty()) judge_closed();
    measure_play();
  }

  void judge_opening_of_whole() {
    VerifyCheck check = named("opening");
    report_.gap_mm = motion_.gap_mm;
    const std::string& place = model_.parts.front().place;
    if (!motion_.states.empty()) {
      report_.from_deg = degrees(motion_.opening_rad.front());
      report_.to_deg = degrees(motion_.opening_rad.back());
    }
    if (!motion_.shut_stopped.empty())
      check.fail(place, "the card does not shut: " + motion_.shut_stopped);
    if (!motion_.open_stopped.empty() && motion_.open_stopped != motion_.shut_stopped)
      check.fail(place,
                 (model_.opens_deg < 180.0
                      ? fmt::format("the card does not open to {:g} degrees: ", model_.opens_deg)
                      : std::string("the card does not open flat: ")) +
                     motion_.open_stopped);
    if (motion_.first_gap_mm > 1e-3 * card_.reach_mm)
      check.fail(place, fmt::format("the fold angles of the file leave gaps of {:.3g} mm in joints",
                                    motion_.first_gap_mm));
    check.detail = fmt::format(
        "rigid panels move from {:.1f} to {:.1f} degrees with joints closed "
        "within {:.2g} mm",
        report_.from_deg, report_.to_deg, motion_.gap_mm);
    add(std::move(check));
  }

  void judge_rank() {
    VerifyCheck check = named("degrees_of_freedom");
    if (card_.bodies > kMostCounted) {
      check.not_judged(fmt::format("{} panels are more than the {} that are counted", card_.bodies,
                                   kMostCounted));
      return add(std::move(check));
    }
    const JointRank rank = rank_of(card_, motion_.states[nearest(kCountAt_rad)]);
    report_.degrees_of_freedom = rank.degrees_of_freedom;
    report_.largest_zero = rank.largest_zero, report_.smallest_nonzero = rank.smallest_nonzero;
    check.detail = fmt::format("{} degree{} of freedom; singular values {:.2g} | {:.2g}",
                               rank.degrees_of_freedom, rank.degrees_of_freedom == 1 ? "" : "s",
                               rank.largest_zero, rank.smallest_nonzero);
    if (!rank.is_clear)
      check.fail("",
                 "the singular values leave no clear gap, so the degrees of freedom cannot be "
                 "counted");
    else if (rank.degrees_of_freedom != options_.degrees_of_freedom)
      check.fail("", fmt::format("{} degrees of freedom, but {} {} required",
                                 rank.degrees_of_freedom, options_.degrees_of_freedom,
                                 options_.degrees_of_freedom == 1 ? "is" : "are"));
    add(std::move(check));
  }

  [[nodiscard]] std::size_t nearest(double opening_rad) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < motion_.opening_rad.size(); ++k)
      if (std::abs(motion_.opening_rad[k] - opening_rad) <
          std::abs(motion_.opening_rad[best] - opening_rad))
        best = k;
    return best;
  }

  /// All parts as one sheet of many pieces, its panels the bodies.
  void combine() {
    all_.face_first.assign(1, 0);
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const FoldModel& sheet = model_.parts[p].sheet;
      const auto first = static_cast<std::uint32_t>(all_.flat.size());
      all_.flat.insert(all_.flat.end(), sheet.flat.begin(), sheet.flat.end());
      for (std::size_t f = 0; f < sheet.faces(); ++f) {
        for (const std::uint32_t v : face_of(sheet, f)) all_.face_vertices.push_back(first + v);
        all_.face_first.push_back(static_cast<std::uint32_t>(all_.face_vertices.size()));
        all_sheet_.panel_of_face.push_back(card_.body[card_.panel_of(p, f)]);
        face_in_.emplace_back(p, f);
      }
    }
    VerifyCheck known = named("faces");  // the parts' own checks have told of them
    all_triangles_ = check_faces(all_, known);
  }

  [[nodiscard]] Pose pose_of_all(std::size_t k, PoseMotion& motion) const {
    Pose pose;
    pose.place = fmt::format("the pose at {:.1f} degrees", degrees(motion_.opening_rad[k]));
    pose.opened = true;
    pose.psi_rad = motion_.opening_rad[k];
    for (std::size_t p = 0, face = 0; p < model_.parts.size(); ++p) {
      const FoldModel& sheet = model_.parts[p].sheet;
      const std::size_t first = pose.at.size();
      pose.at.resize(first + sheet.flat.size());
      for (std::size_t f = 0; f < sheet.faces(); ++f, ++face)
        for (const std::uint32_t v : face_of(sheet, f))
          pose.at[first + v] = placed(k, card_.panel_of(p, f)) * lifted(sheet.flat[v]);
    }
    motion.panel.resize(card_.bodies);
    for (std::size_t panel = 0; panel < card_.body.size(); ++panel) {
      const Eigen::Isometry3d lay = placed(k, panel);
      motion.panel[card_.body[panel]] = {lay.translation(), lay.linear().col(0),
                                         lay.linear().col(1), lay.linear().col(2)};
    }
    return pose;
  }

  [[nodiscard]] Eigen::Isometry3d placed(std::size_t k, std::size_t panel) const {
    return motion_.states[k][card_.body[panel]] * card_.in_body[panel];
  }

  /// Pairs of bodies that turn about a line of both. Their planes meet in that line at every
  /// opening, on the same paper: once they are found apart there, they stay so, unless they come to
  /// lie in one plane.
  class TurningPairs {
   public:
    explicit TurningPairs(const Assembled& card) {
      for (const BodyHinge& hinge : card.hinges)
        looked_at_.emplace(std::minmax(hinge.right, hinge.left), false);
    }
    bool is_known(const PoseMotion& motion, std::uint32_t a, std::uint32_t b) {
      const auto pair = looked_at_.find(std::minmax(a, b));
      constexpr double kClearSine = 0.02;
      if (pair == looked_at_.end() ||
          norm(cross(motion.panel[a].normal, motion.panel[b].normal)) < kClearSine)
        return false;
      if (!pair->second) seen_now_.push_back(pair);
      return pair->second;
    }
    void next_pose() {
      for (const auto& pair : seen_now_) pair->second = true;
      seen_now_.clear();
    }

   private:
    using Pairs = std::map<std::pair<std::uint32_t, std::uint32_t>, bool>;
    Pairs looked_at_;
    std::vector<Pairs::iterator> seen_now_;
  };

  void judge_crossing_of_whole() {
    constexpr double kSlack_mm = 1e-5;
    TurningPairs turning(card_);
    VerifyCheck check = named("crossing");
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    std::size_t looked_at = 0;
    for (std::size_t k = 0; k < motion_.states.size(); ++k, ++looked_at) {
      tell(options_.progress, "looking for panels that pass through others",
           0.3 + 0.6 * static_cast<double>(k) / static_cast<double>(motion_.states.size()));
      PoseMotion motion;
      const Pose pose = pose_of_all(k, motion);
      const Meetings met = meeting_faces(
          all_, all_sheet_, all_triangles_, pose, motion, kSlack_mm,
          [&](std::uint32_t a, std::uint32_t b) { return turning.is_known(motion, a, b); });
      turning.next_pose();
      if (!met.complete) check.not_judged("too many faces lie in one place to compare them");
      for (const MeetingFaces& pair : met.pairs)
        if (seen.emplace(pair.f, pair.g).second)
          check.fail(name_of(pair.g), fmt::format("{} {} at {:.1f} degrees", name_of(pair.f),
                                                  pair.crosses ? "passes through it" : "lies on it",
                                                  degrees(motion_.opening_rad[k])));
    }
    if (check.ran)
      check.detail =
          check.ok()
              ? fmt::format("no face passes through another at {} openings", looked_at)
              : fmt::format("{} pair{} of faces meet", check.failed, check.failed == 1 ? "" : "s");
    add(std::move(check));
  }

  [[nodiscard]] std::string name_of(std::uint32_t face) const {
    const auto [p, f] = face_in_[face];
    return fmt::format("{}/faces_vertices/{} of {:?}", model_.parts[p].place, f,
                       model_.parts[p].name);
  }

  /// Places of all vertices on the shut page, from the two smallest openings: they are even
  /// functions of the opening near 0, or nearly.
  [[nodiscard]] std::vector<PagePlace> shut_places() const {
    const auto places = [&](std::size_t k) {
      const BodyHinge& spine = card_.hinges[card_.drive];
      const Eigen::Isometry3d& right = motion_.states[k][spine.right];
      const Vec3 at = right * spine.right_at, along = right.linear() * spine.right_along;
      const Vec3 out = bisector(k, along);
      PoseMotion motion;
      std::vector<PagePlace> result;
      for (const Vec3& p : pose_of_all(k, motion).at)
        result.push_back({dot(out, Vec3(p - at)), dot(along, Vec3(p - at))});
      return result;
    };
    std::vector<PagePlace> near = places(0), far = places(1);
    const double ratio = std::pow(motion_.opening_rad[1] / motion_.opening_rad[0], 2);
    for (std::size_t v = 0; v < near.size(); ++v)
      near[v] = (ratio * near[v] - far[v]) / (ratio - 1.0);
    return near;
  }

  /// Between the pages, outward from the spine.
  [[nodiscard]] Vec3 bisector(std::size_t k, const Vec3& along) const {
    const BodyHinge& spine = card_.hinges[card_.drive];
    const auto outward = [&](std::uint32_t body, const Vec3& at, const Vec3& line) {
      const Eigen::Isometry3d& lay = motion_.states[k][body];
      const Vec3 normal = lay.linear() * Vec3(0.0, 0.0, 1.0);
      Vec3 side = unit(cross(normal, Vec3(lay.linear() * line)));
      if (dot(side, Vec3(lay * card_.middle[body] - lay * at)) < 0.0) side = -side;
      return side;
    };
    Vec3 sum = outward(spine.right, spine.right_at, spine.right_along) +
               outward(spine.left, spine.left_at, spine.left_along);
    return unit(Vec3(sum - dot(sum, along) * along));
  }

  void judge_closed() {
    VerifyCheck check = named("closed");
    const std::vector<PagePlace> at = shut_places();
    const FoldModel& card = model_.parts.front().sheet;
    const BodyHinge& spine = card_.hinges[card_.drive];
    constexpr double kFar = std::numeric_limits<double>::infinity();
    std::array<double, 2> reach{0.0, 0.0};
    double begin = -kFar, end = kFar;
    for (const std::uint32_t page : {spine.right, spine.left}) {
      double low = kFar, high = -kFar, far = 0.0;
      for (std::size_t f = 0; f < card.faces(); ++f) {
        if (card_.body[card_.panel_of(0, f)] != page) continue;
        for (const std::uint32_t v : face_of(card, f)) {
          far = std::max(far, at[v].x());
          low = std::min(low, at[v].y()), high = std::max(high, at[v].y());
        }
      }
      reach[page == spine.right ? 0 : 1] = far;
      begin = std::max(begin, low), end = std::min(end, high);
    }
    report_.page_mm = std::min(reach[0], reach[1]);
    std::size_t first = card.flat.size();
    for (std::size_t p = 1; p < model_.parts.size(); ++p) {
      const std::size_t count = model_.parts[p].sheet.flat.size();
      double beyond = 0.0;
      std::string where;
      for (std::size_t v = first; v < first + count; ++v) {
        report_.closed_mm = std::max(report_.closed_mm, at[v].x());
        for (const auto& [off, what] :
             {std::pair(at[v].x() - report_.page_mm, "the open edge"),
              std::pair(-at[v].x(), "the spine"), std::pair(begin - at[v].y(), "one end"),
              std::pair(at[v].y() - end, "the other end")})
          if (off > beyond) beyond = off, where = what;
      }
      if (beyond > kShut_mm)
        check.fail(model_.parts[p].place,
                   fmt::format("shut, {:?} sticks out of the pages by {:.3g} mm, beyond {}",
                               model_.parts[p].name, beyond, where));
      first += count;
    }
    measure_stack(at, begin, end);
    check.detail = fmt::format(
        "shut, the parts reach {:.1f} of {:.1f} mm; the stack is {:.1f} mm "
        "high ({} layers of paper)",
        report_.closed_mm, report_.page_mm, report_.stack_mm, report_.stack_layers);
    add(std::move(check));
  }

  void measure_stack(const std::vector<PagePlace>& at, double begin, double end) {
    constexpr double kMostCells = 4e6;
    const double cell = std::max(
        kStackCell_mm, std::sqrt(report_.page_mm * std::max(0.0, end - begin) / kMostCells));
    const auto count = [&](double mm) {
      return static_cast<std::size_t>(std::max(1.0, std::ceil(mm / cell)));
    };
    const std::size_t across = count(report_.page_mm), along = count(end - begin);
    std::vector<std::uint16_t> layers(across * along, 0);
    const auto clamped = [&](double mm, std::size_t most) {
      return static_cast<std::size_t>(
          std::clamp(std::ceil(mm / cell - 0.5), 0.0, static_cast<double>(most)));
    };
    for (const Triangle& t : all_triangles_.corners) {
      Vec2 a = at[t[0]], b = at[t[1]], c = at[t[2]];
      for (Vec2* p : {&a, &b, &c}) p->y() -= begin;
      const auto [low, high] = std::minmax({a.y(), b.y(), c.y()});
      for (std::size_t row = clamped(low, along); row < clamped(high, along); ++row) {
        const double y = (static_cast<double>(row) + 0.5) * cell;
        double from = std::numeric_limits<double>::infinity(), to = -from;
        for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
          if ((p.y() <= y) == (q.y() <= y)) continue;
          const double x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
          from = std::min(from, x), to = std::max(to, x);
        }
        for (std::size_t k = clamped(from, across); k < clamped(to, across); ++k)
          ++layers[row * across + k];
      }
    }
    report_.stack_layers = *std::max_element(layers.begin(), layers.end());
    report_.stack_mm = static_cast<double>(report_.stack_layers) * model_.thickness_mm;
  }

  void measure_play() {
    if (card_.bodies > kMostWobbling) {
      report_.notes.push_back(fmt::format("wobble is not measured: {} panels", card_.bodies));
      return;
    }
    std::vector<std::vector<Vec3>> points(card_.bodies);
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const FoldModel& sheet = model_.parts[p].sheet;
      for (std::size_t f = 0; f < sheet.faces(); ++f) {
        const std::size_t panel = card_.panel_of(p, f);
        for (const std::uint32_t v : face_of(sheet, f))
          points[card_.body[panel]].push_back(card_.in_body[panel] * lifted(sheet.flat[v]));
      }
    }
    const std::size_t k = nearest(radians(std::min(kWobbleAt_deg, model_.opens_deg)));
    const std::vector<double> play = play_mm(card_, motion_.states[k], points);
    if (play.empty()) return;
    const auto most =
        static_cast<std::size_t>(std::max_element(play.begin(), play.end()) - play.begin());
    report_.wobble_mm = play[most];
    for (std::size_t p = 0; p < model_.parts.size(); ++p)
      for (std::size_t n = 0; n < card_.sheets[p].panels; ++n)
        if (card_.body[card_.first_panel[p] + n] == most && report_.wobbles_most.empty())
          report_.wobbles_most = model_.parts[p].name;
    if (play[most] > kHolds_mm)
      report_.notes.push_back(
          fmt::format("{:?} wobbles by {:.2f} mm where folds are {} mm off their lines; longer "
                      "folds hold it better",
                      report_.wobbles_most, play[most], kLinePlay_mm));
  }

  JointModel model_;
  PartsVerifyOptions options_;
  PartsVerifyReport report_;
  std::vector<Triangles> triangles_;
  Assembled card_;
  bool is_whole_{};
  Followed motion_;
  FoldModel all_;
  Sheet all_sheet_;
  Triangles all_triangles_;
  std::vector<std::pair<std::size_t, std::size_t>> face_in_;  ///< part and its face
};

}  // namespace

bool PartsVerifyReport::ok() const { return failed() == 0; }

std::size_t PartsVerifyReport::failed() const {
  std::size_t sum = 0;
  for (const VerifyReport& part : parts) sum += part.failed();
  for (const VerifyCheck& check : checks) sum += check.failed;
  return sum;
}

Result<PartsVerifyReport> verify_parts(std::string_view fold_text,
                                       const PartsVerifyOptions& options) {
  auto model = read_joint_model(fold_text);
  if (!model) return tl::unexpected(model.error());
  return PartsJudge(std::move(*model), options).run();
}

std::string verify_text(const PartsVerifyReport& report) {
  VerifyReport whole;
  VerifyCheck parts = named("parts");
  parts.detail = fmt::format("{} flat sheets, each one piece", report.parts.size());
  for (const VerifyReport& part : report.parts)
    for (const VerifyCheck& check : part.checks) {
      for (const VerifyFailure& failure : check.failures)
        parts.fail(failure.place, fmt::format("{} ({})", failure.detail, check.name));
    }
  whole.checks.push_back(std::move(parts));
  whole.checks.insert(whole.checks.end(), report.checks.begin(), report.checks.end());
  whole.notes = report.notes;
  std::string text = verify_text(whole);
  if (report.wobble_mm)
    text += fmt::format("wobble  {:.2f} mm at most ({})\n", *report.wobble_mm, report.wobbles_most);
  return text;
}

std::string verify_json(const PartsVerifyReport& report) {
  Json json{
      {"ok", report.ok()},
      {"parts", Json::array()},
      {"joints", report.joints},
      {"tabs", report.tabs},
      {"folds", report.folds},
      {"degrees_of_freedom", report.degrees_of_freedom ? Json(*report.degrees_of_freedom) : Json()},
      {"singular_values",
       {{"largest_zero", report.largest_zero}, {"smallest_nonzero", report.smallest_nonzero}}},
      {"opening_deg", {report.from_deg, report.to_deg}},
      {"gap_mm", report.gap_mm},
      {"page_mm", report.page_mm},
      {"closed_mm", report.closed_mm},
      {"stack", {{"layers", report.stack_layers}, {"height_mm", report.stack_mm}}},
      {"wobble_mm", report.wobble_mm ? Json(*report.wobble_mm) : Json()},
      {"failed", report.failed()},
      {"checks", checks_json(report.checks)},
      {"notes", report.notes}};
  for (std::size_t p = 0; p < report.parts.size(); ++p) {
    const VerifyReport& part = report.parts[p];
    json["parts"].push_back({{"name", report.names[p]},
                             {"ok", part.ok()},
                             {"panels", part.faces},
                             {"sheet_mm", {part.sheet_u_mm, part.sheet_v_mm}},
                             {"checks", checks_json(part.checks)}});
  }
  return json_file(json);
}

}  // namespace popcut
