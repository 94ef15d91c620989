// SPDX-License-Identifier: MIT
#include "core/verify/target.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut::verify {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxSpecBytes = 1 << 22;
constexpr int kMaxSpecDepth = 32;
constexpr double kMostSlices = 1e6;
constexpr double kDefaultMargin_mm = 15.0;

tl::unexpected<Error> wrong(std::string place, std::string detail) {
  return fail(ErrorKind::Malformed, std::move(place), std::move(detail));
}

Result<Json> parse_spec(std::string_view text) {
  if (text.size() > kMaxSpecBytes)
    return fail(ErrorKind::OutOfRange, "", "the spec is larger than 4 MiB");
  bool deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    deep = deep || depth > kMaxSpecDepth;
    return !deep;
  };
  Json spec = Json::parse(text, watch, false);
  if (deep || spec.is_discarded()) return wrong("", "the spec is not JSON, or nested too deep");
  if (!spec.is_object()) return wrong("/", "a design spec is an object");
  return spec;
}

Result<double> number_at(const Json& spec, const char* pointer, std::optional<double> otherwise) {
  const Json::json_pointer at(pointer);
  if (!spec.contains(at)) {
    if (otherwise) return *otherwise;
    return wrong(pointer, "missing; verify needs it to find the slices");
  }
  if (!spec.at(at).is_number()) return wrong(pointer, "it must be a number");
  return spec.at(at).get<double>();
}

Result<std::unique_ptr<TargetSurface>> read_surface(const Json& spec, double scale_mm) {
  const Json& surface = spec.contains("surface") ? spec["surface"] : Json();
  if (!surface.is_object() || !surface.contains("type") || !surface["type"].is_string()) {
    return wrong("/surface", "it must be an object with a type");
  }
  const std::string type = surface["type"].get<std::string>();
  const char* member = type == "revolution" ? "radius" : type == "profile" ? "z" : nullptr;
  if (member == nullptr) {
    return fail(
        ErrorKind::OutOfRange, "/surface/type",
        fmt::format(
            "verify does not measure \"{}\" targets yet; it measures revolution and profile",
            type.substr(0, 40)));
  }
  const std::string place = std::string("/surface/") + member;
  if (!surface.contains(member) || !surface[member].is_string())
    return wrong(place, "it must be an expression");
  auto made = make_surface(type == "profile" ? TargetKind::Profile : TargetKind::Revolution,
                           surface[member].get<std::string>(), scale_mm);
  if (!made) return wrong(place, made.error().detail);
  return made;
}

Result<std::vector<double>> read_widths(const Json& spec, std::size_t slices) {
  std::vector<double> widths;
  if (spec.contains("widths_mm") && spec["widths_mm"].is_array()) {
    for (const Json& width : spec["widths_mm"]) {
      if (!width.is_number()) return wrong("/widths_mm", "widths must be numbers");
      widths.push_back(width.get<double>());
    }
    if (widths.size() != slices) {
      return wrong("/widths_mm", fmt::format("{} widths for {} slices", widths.size(), slices));
    }
  } else {
    const auto width = number_at(spec, "/widths_mm", std::nullopt);
    if (!width) return tl::unexpected<Error>(width.error());
    widths.assign(slices, *width);
  }
  for (const double width : widths) {
    if (!(width > 0.0) || width > kMaxCoordinate_mm) {
      return fail(ErrorKind::OutOfRange, "/widths_mm", "widths must be positive");
    }
  }
  return widths;
}

/// Where a fold that crosses the line v = const does so, as its place in the pose at a right angle.
struct FoldVertex {
  double x{}, z{};
};

/// Undoes the pose: the point (X, Z) from (X + Z cos psi, v, Z sin psi).
FoldVertex unposed(Vec3 p, double psi_rad) {
  const double z = p.z / std::sin(psi_rad);
  return {p.x - z * std::cos(psi_rad), z};
}

const Pose* pose_to_measure(const FoldFile& file) {
  const Pose* best = nullptr;
  for (const Pose& pose : file.poses) {
    if (!pose.psi_rad || !(std::sin(*pose.psi_rad) > 0.1)) continue;
    if (best == nullptr || std::sin(*pose.psi_rad) > std::sin(*best->psi_rad)) best = &pose;
  }
  return best;
}

void add(TargetDistance& to, double distance_mm) {
  ++to.vertices;
  to.rms_mm += distance_mm * distance_mm;  // the sum of squares, until it is closed
  to.max_mm = std::max(to.max_mm, distance_mm);
}

TargetDistance closed(TargetDistance sum) {
  if (sum.vertices > 0) {
    sum.rms_mm = std::sqrt(sum.rms_mm / static_cast<double>(sum.vertices));
  }
  return sum;
}

/// Where the slices and the connectors between them lie (design reference, section 3). Slices of a
/// single unit are boxes of their full width, without connectors.
void place_slices(const std::vector<double>& widths, double margin_mm, bool boxes, Target& target) {
  double s = 0.0;
  double begin = margin_mm;  // where a box begins
  for (std::size_t j = 0; j < widths.size(); ++j) {
    const double w = widths[j];
    target.slices.push_back({boxes ? begin + 0.5 * w : s + margin_mm + widths[0] / 4.0, s});
    begin += w;
    if (j + 1 == widths.size()) break;
    const double middle = s + (3.0 * w + widths[j + 1]) / 8.0;
    if (!boxes) target.connectors.push_back({middle + margin_mm + widths[0] / 4.0, middle});
    s += 0.5 * (w + widths[j + 1]);
  }
}

/// The places where valley folds cross the lines v = `stations[k].v_mm`, as (X, Z).
std::vector<std::vector<FoldVertex>> valleys_at(const FoldFile& file, const Pose& pose,
                                                const std::vector<TargetStation>& stations) {
  std::vector<std::vector<FoldVertex>> found(stations.size());
  for (std::size_t e = 0; e < file.edges.size(); ++e) {
    if (file.assignment[e] != Assignment::Valley) continue;
    const auto [a, b] = file.edges[e];
    const double va = file.flat[a].v;
    const double vb = file.flat[b].v;
    if (va == vb) continue;
    auto at = std::lower_bound(stations.begin(), stations.end(), std::min(va, vb),
                               [](const TargetStation& s, double v) { return s.v_mm < v; });
    for (; at != stations.end() && at->v_mm <= std::max(va, vb); ++at) {
      const double t = (at->v_mm - va) / (vb - va);
      const Vec3 p = pose.at[a] + t * (pose.at[b] - pose.at[a]);
      found[static_cast<std::size_t>(at - stations.begin())].push_back(unposed(p, *pose.psi_rad));
    }
  }
  return found;
}

/// The outermost fold on the wall and on the ground among those at one station; negative for none.
CurveEnds outermost(const std::vector<FoldVertex>& folds, double on_card) {
  CurveEnds ends{-1.0, -1.0};
  for (const FoldVertex& p : folds) {
    if (std::abs(p.x) <= on_card && p.z > on_card) ends.wall = std::max(ends.wall, p.z);
    if (std::abs(p.z) <= on_card && p.x > on_card) ends.ground = std::max(ends.ground, p.x);
  }
  return ends;
}

/// How far a connector's end is from the target's end on the slice that it came from: the one
/// beside it that ends at the same place.
double end_error(double end, double left, double right, double left_target, double right_target,
                 double same) {
  const double from_left = std::abs(end - left_target);
  const double from_right = std::abs(end - right_target);
  const bool at_left = std::abs(end - left) <= same;
  const bool at_right = std::abs(end - right) <= same;
  if (at_left != at_right) return at_left ? from_left : from_right;
  return std::min(from_left, from_right);
}

/// Collects distances station by station.
class Measurement {
 public:
  Measurement(const TargetSurface& surface, const Pose& pose, VerifyCheck& check)
      : surface_(surface), check_(check) {
    double reach = 0.0;
    for (const Vec3& p : pose.at) reach = std::max({reach, std::abs(p.x), std::abs(p.z)});
    on_card_ = 1e-9 * reach;
  }

  void inner_folds(const std::vector<FoldVertex>& folds, double s_mm) {
    for (const FoldVertex& p : folds) {
      if (std::abs(p.x) <= on_card_ || std::abs(p.z) <= on_card_) continue;
      const double off = surface_.distance_mm(s_mm, p.x, p.z);
      if (!take(off, s_mm)) return;
      add(inner, off);
    }
  }

  /// The ends of a connector against the target's on the two slices beside it.
  void ends(const std::vector<FoldVertex>& folds,
            std::array<const std::vector<FoldVertex>*, 2> beside, std::array<double, 2> s_mm) {
    const CurveEnds here = outermost(folds, on_card_);
    const CurveEnds left = outermost(*beside[0], on_card_);
    const CurveEnds right = outermost(*beside[1], on_card_);
    const CurveEnds a = surface_.ends_mm(s_mm[0]);
    const CurveEnds b = surface_.ends_mm(s_mm[1]);
    if (here.wall > 0.0) {
      (void)take(end_error(here.wall, left.wall, right.wall, a.wall, b.wall, on_card_), s_mm[0]);
    }
    if (here.ground > 0.0) {
      (void)take(end_error(here.ground, left.ground, right.ground, a.ground, b.ground, on_card_),
                 s_mm[0]);
    }
  }

  TargetDistance inner, all;  ///< with sums of squares, see `closed`

 private:
  bool take(double off, double s_mm) {
    if (!(off >= 0.0) || !std::isfinite(off)) {
      check_.fail("", fmt::format("the target has no curve at s = {:.6g} mm", s_mm));
      return false;
    }
    add(all, off);
    return true;
  }

  const TargetSurface& surface_;
  VerifyCheck& check_;
  double on_card_{};
};

}  // namespace

Result<Target> read_target(std::string_view spec_json) {
  const auto spec = parse_spec(spec_json);
  if (!spec) return tl::unexpected<Error>(spec.error());
  if (spec->contains("regions")) {
    return fail(ErrorKind::OutOfRange, "/regions",
                "verify does not measure targets with regions yet");
  }
  for (const char* member : {"rotate_deg", "translate_mm"}) {
    if (spec->contains(member)) {
      return fail(ErrorKind::OutOfRange, std::string("/") + member,
                  "verify does not measure moved targets yet");
    }
  }
  for (const char* moved : {"rotate_deg", "translate_mm"}) {
    const std::vector<double> nowhere(3, 0.0);
    if (spec->contains(moved) && (*spec)[moved] != Json(nowhere))
      return fail(ErrorKind::OutOfRange, std::string("/") + moved,
                  "verify does not measure targets that are turned or shifted yet");
  }
  const auto scale = number_at(*spec, "/scale_mm", 1.0);
  if (!scale) return tl::unexpected<Error>(scale.error());
  if (!(*scale > 0.0)) return fail(ErrorKind::OutOfRange, "/scale_mm", "it must be positive");
  const auto slices = number_at(*spec, "/slices", std::nullopt);
  if (!slices) return tl::unexpected<Error>(slices.error());
  if (!(*slices >= 1.0) || *slices > kMostSlices) {
    return fail(ErrorKind::OutOfRange, "/slices", "it must be between 1 and a million");
  }
  const bool plain =
      spec->contains("card") && (*spec)["card"].is_boolean() && !(*spec)["card"].get<bool>();
  const auto margin =
      plain ? Result<double>(0.0) : number_at(*spec, "/card/margin_mm", kDefaultMargin_mm);
  if (!margin) return tl::unexpected<Error>(margin.error());
  const auto units = number_at(*spec, "/units_per_slice", 2.0);
  if (!units) return tl::unexpected<Error>(units.error());
  const auto widths = read_widths(*spec, static_cast<std::size_t>(*slices));
  if (!widths) return tl::unexpected<Error>(widths.error());
  auto surface = read_surface(*spec, *scale);
  if (!surface) return tl::unexpected<Error>(surface.error());

  Target target;
  target.surface = std::move(*surface);
  place_slices(*widths, *margin, *units == 1.0, target);
  return target;
}

void measure_target(const FoldFile& file, const Target& target, VerifyReport& report,
                    VerifyCheck& check) {
  const Pose* pose = pose_to_measure(file);
  if (pose == nullptr) {
    check.fail("/file_frames",
               "no frame tells its opening angle in frame_popcut:psi_rad; the distance from the "
               "target needs it");
    return;
  }
  Measurement measured(*target.surface, *pose, check);
  const auto on_slices = valleys_at(file, *pose, target.slices);
  const auto on_connectors = valleys_at(file, *pose, target.connectors);
  for (std::size_t k = 0; k < target.connectors.size(); ++k) {
    measured.inner_folds(on_connectors[k], target.connectors[k].s_mm);
    measured.ends(on_connectors[k], {&on_slices[k], &on_slices[k + 1]},
                  {target.slices[k].s_mm, target.slices[k + 1].s_mm});
  }
  // Boxes have no inner folds; one slice alone has its connector in its own middle.
  for (std::size_t j = 0; target.connectors.empty() && j < target.slices.size(); ++j) {
    const double s = target.slices[j].s_mm;
    measured.inner_folds(on_slices[j], s);
    measured.ends(on_slices[j], {&on_slices[j], &on_slices[j]}, {s, s});
  }
  const TargetDistance inner = closed(measured.inner);
  const TargetDistance all = closed(measured.all);
  if (all.vertices == 0) {
    check.fail(
        "",
        "no fold of the pattern lies on a slice or connector of the spec; they do not belong "
        "together");
  }
  report.target_inner = inner;
  report.target_all = all;
  check.detail = fmt::format(
      "{} inner fold vertices: rms {:.3g} mm, max {:.3g} mm; {} with the ends: rms {:.3g} mm, "
      "max {:.3g} mm",
      inner.vertices, inner.rms_mm, inner.max_mm, all.vertices, all.rms_mm, all.max_mm);
}

}  // namespace popcut::verify
