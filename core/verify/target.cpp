// SPDX-License-Identifier: MIT
#include "core/verify/target.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <muParser.h>
#include <nlohmann/json.hpp>

namespace popcut::verify {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxSpecBytes = 1 << 22;
constexpr int kMaxSpecDepth = 32;
constexpr double kMostSlices = 1e6;
constexpr double kDefaultMargin_mm = 15.0;

/// An expression of x and y.
class Expression {
 public:
  explicit Expression(const std::string& text) {
    parser_.DefineVar("x", &x_);
    parser_.DefineVar("y", &y_);
    parser_.DefineConst("pi", 3.14159265358979323846);
    parser_.SetExpr(text);
    (void)parser_.Eval();  // throws on what it cannot read
  }
  Expression(const Expression&) = delete;
  Expression& operator=(const Expression&) = delete;

  [[nodiscard]] double operator()(double x, double y) const {
    x_ = x;
    y_ = y;
    return parser_.Eval();
  }

 private:
  mutable double x_{0.25}, y_{0.25};
  mu::Parser parser_;
};

/// Quarter circles about the spine.
class Revolution : public TargetSurface {
 public:
  Revolution(const std::string& radius, double scale_mm) : radius_(radius), scale_(scale_mm) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const double r_mm = scale_ * radius_(0.0, s_mm / scale_);
    return r_mm > 0.0 ? std::abs(std::hypot(x_mm, z_mm) - r_mm) : -1.0;
  }

 private:
  Expression radius_;
  double scale_;
};

/// A profile z(x, y), for x from 0 to where it comes down to 0.
class Profile : public TargetSurface {
 public:
  Profile(const std::string& z, double scale_mm) : z_(z), scale_(scale_mm) {}
  [[nodiscard]] double distance_mm(double s_mm, double x_mm, double z_mm) const override {
    const double y = s_mm / scale_;
    const auto away = [&](double x) {
      return std::hypot(x - x_mm / scale_, z_(x, y) - z_mm / scale_);
    };
    const double end = ground_end(y);
    if (!(end > 0.0)) return -1.0;
    // Sampled, then narrowed about the nearest sample. Near the ground the curve can be steep, so
    // samples thicken towards both ends.
    constexpr int kSamples = 400;
    const auto at = [&](double t) {
      return end * 0.5 * (1.0 - std::cos(3.14159265358979323846 * t));
    };
    int nearest = 0;
    for (int k = 1; k <= kSamples; ++k) {
      const double candidate = away(at(static_cast<double>(k) / kSamples));
      if (candidate < away(at(static_cast<double>(nearest) / kSamples))) nearest = k;
    }
    double low = static_cast<double>(std::max(0, nearest - 1)) / kSamples;
    double high = static_cast<double>(std::min(kSamples, nearest + 1)) / kSamples;
    for (int step = 0; step < 100; ++step) {
      const double a = low + (high - low) / 3.0;
      const double b = high - (high - low) / 3.0;
      away(at(a)) < away(at(b)) ? high = b : low = a;
    }
    const double found = scale_ * away(at(0.5 * (low + high)));
    return std::isfinite(found) ? found : -1.0;
  }

 private:
  /// Smallest x > 0 at which the profile is down at 0; negative if it never is.
  [[nodiscard]] double ground_end(double y) const {
    const double height = z_(0.0, y);
    if (!(height > 0.0)) return -1.0;
    double step = height / 256.0;
    double above = 0.0;
    double below = step;
    for (int k = 0; k < 8192 && z_(below, y) > 0.0; ++k) {
      above = below;
      below += step;
      if (k % 1024 == 1023) step *= 2.0;
    }
    if (z_(below, y) > 0.0) return -1.0;
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (above + below);
      (z_(middle, y) > 0.0 ? above : below) = middle;
    }
    return above;
  }

  Expression z_;
  double scale_;
};

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
  const std::string text = surface[member].get<std::string>();
  try {
    if (type == "revolution") return std::make_unique<Revolution>(text, scale_mm);
    return std::make_unique<Profile>(text, scale_mm);
  } catch (const mu::Parser::exception_type& why) {
    return wrong(place, "the expression cannot be read: " + why.GetMsg());
  }
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

void close(TargetDistance& distance) {
  if (distance.vertices > 0)
    distance.rms_mm = std::sqrt(distance.rms_mm / static_cast<double>(distance.vertices));
}

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
  const auto scale = number_at(*spec, "/scale_mm", 1.0);
  if (!scale) return tl::unexpected<Error>(scale.error());
  if (!(*scale > 0.0)) return fail(ErrorKind::OutOfRange, "/scale_mm", "it must be positive");
  const bool by_list = spec->contains("widths_mm") && (*spec)["widths_mm"].is_array();
  const std::optional<double> listed =
      by_list ? std::optional(static_cast<double>((*spec)["widths_mm"].size())) : std::nullopt;
  const auto slices = number_at(*spec, "/slices", listed);
  if (!slices) return tl::unexpected<Error>(slices.error());
  if (!(*slices >= 1.0) || *slices > kMostSlices) {
    return fail(ErrorKind::OutOfRange, "/slices", "it must be between 1 and a million");
  }
  const bool plain =
      spec->contains("card") && (*spec)["card"].is_boolean() && !(*spec)["card"].get<bool>();
  const auto margin =
      plain ? Result<double>(0.0) : number_at(*spec, "/card/margin_mm", kDefaultMargin_mm);
  if (!margin) return tl::unexpected<Error>(margin.error());
  const auto widths = read_widths(*spec, static_cast<std::size_t>(*slices));
  if (!widths) return tl::unexpected<Error>(widths.error());
  auto surface = read_surface(*spec, *scale);
  if (!surface) return tl::unexpected<Error>(surface.error());

  Target target;
  target.surface = std::move(*surface);
  const double offset = *margin + widths->front() / 4.0;  // v = s + offset
  double s = 0.0;
  for (std::size_t j = 0; j + 1 < widths->size(); ++j) {
    const double w = (*widths)[j];
    const double next = (*widths)[j + 1];
    target.connector_s_mm.push_back(s + (3.0 * w + next) / 8.0);
    target.connector_v_mm.push_back(target.connector_s_mm.back() + offset);
    s += 0.5 * (w + next);
  }
  return target;
}

void measure_target(const FoldFile& file, const Target& target, VerifyReport& report,
                    VerifyCheck& check) {
  const Pose* pose = pose_to_measure(file);
  if (pose == nullptr) {
    check.fail("/file_frames",
               "no frame tells its opening angle in frame_popcut:psi_rad; the distance "
               "from the target needs it");
    return;
  }
  TargetDistance inner;
  TargetDistance all;
  double reach = 0.0;
  for (const Vec3& p : pose->at) reach = std::max({reach, std::abs(p.x), std::abs(p.z)});
  const double on_card = 1e-9 * reach;
  for (std::size_t e = 0; e < file.edges.size(); ++e) {
    if (file.assignment[e] != Assignment::Valley) continue;
    const auto [a, b] = file.edges[e];
    const double va = file.flat[a].v;
    const double vb = file.flat[b].v;
    const auto& middles = target.connector_v_mm;
    auto at = std::lower_bound(middles.begin(), middles.end(), std::min(va, vb));
    for (; at != middles.end() && *at <= std::max(va, vb); ++at) {
      const double t = (*at - va) / (vb - va);
      const FoldVertex p = unposed(pose->at[a] + t * (pose->at[b] - pose->at[a]), *pose->psi_rad);
      const bool wall = std::abs(p.x) <= on_card;
      const bool ground = std::abs(p.z) <= on_card;
      if ((wall && ground) || !std::isfinite(t)) continue;  // the spine
      const double s = target.connector_s_mm[static_cast<std::size_t>(at - middles.begin())];
      const double off = target.surface->distance_mm(s, p.x, p.z);
      if (off < 0.0) {
        check.fail(fmt::format("/edges_vertices/{}", e),
                   fmt::format("the target has no curve at s = {:.6g} mm", s));
        continue;
      }
      add(all, off);
      if (!wall && !ground) add(inner, off);
    }
  }
  close(inner);
  close(all);
  if (all.vertices == 0) {
    check.fail("",
               "no fold vertex of the pattern lies on a connector of the spec; they do not belong "
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
