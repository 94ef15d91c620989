// SPDX-License-Identifier: MIT
#include "core/search/standing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/compare/printed.hpp"
#include "core/design/facets/roofs.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/kite.hpp"

namespace popcut {
namespace {

constexpr double kTargetSize_mm = 100.0;
constexpr int kMisfitPixels = 64, kNet = 72;

/// A corner of the mesh as it is turned, in units of the model.
struct Turned {
  TurnMatrix turn;
  [[nodiscard]] std::array<double, 3> operator()(const float* p) const {
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) out[i] += turn[i][k] * static_cast<double>(p[k]);
    return out;
  }
};

/// Four neighbouring points of the net make two triangles, unless the depth jumps between them: a
/// slope of more than 80 degrees counts as a jump.
bool is_torn(float a, float b, float c, float d, double pitch_mm) {
  const auto [low, high] = std::minmax({a, b, c, d});
  if (low == likeness::kNothing) return true;
  constexpr double kSteep = 5.67;
  return static_cast<double>(high - low) > 2.0 * kSteep * pitch_mm;
}

}  // namespace

double Way::to_target() const {
  return kTargetSize_mm /
         std::hypot(box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]);
}

Way way_of(const TriangleMesh& model, const std::array<double, 3>& rotate_deg) {
  Way way;
  way.rotate_deg = rotate_deg;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  way.box.low.fill(kFar), way.box.high.fill(-kFar);
  double reach = -kFar;
  const Turned turned{turn_of(rotate_deg)};
  for (std::size_t k = 0; k + 2 < model.corners.size(); k += 3) {
    const auto p = turned(&model.corners[k]);
    for (std::size_t i = 0; i < 3; ++i) {
      way.box.low[i] = std::min(way.box.low[i], p[i]);
      way.box.high[i] = std::max(way.box.high[i], p[i]);
    }
    reach = std::max(reach, p[0] + p[2]);
  }
  way.shut_reach = reach - way.box.low[0] - way.box.low[2];
  return way;
}

std::vector<float> standing_model(const TriangleMesh& model, const Way& way) {
  std::vector<float> out(model.corners.size());
  const Turned turned{turn_of(way.rotate_deg)};
  const double by = way.to_target();
  for (std::size_t k = 0; k + 2 < out.size(); k += 3) {
    const auto p = turned(&model.corners[k]);
    for (std::size_t i = 0; i < 3; ++i)
      out[k + i] = static_cast<float>(by * (p[i] - way.box.low[i]));
  }
  return out;
}

std::optional<double> roof_off_of(const TriangleMesh& model, const Way& way) {
  constexpr std::size_t kRoofs = 3;
  constexpr double kFarthest = 0.6 * kTargetSize_mm, kRoom = 1.01;
  const std::vector<float> standing = standing_model(model, way);
  const TriangleSoup soup{{standing.begin(), standing.end()}};
  for (const RoofPlane& roof : roofs_of(soup, kRoofs)) {
    const double far =
        kRoom * roof.length_mm() / std::tan(0.25 * kPi - 0.5 * roof.slope_rad) - roof.eave.x;
    if (far <= kFarthest) return std::max(0.0, far) / way.to_target();
    if (roof.length_mm() <= longest_at_ridge_mm(roof.top.z, roof.slope_rad)) return 0.0;
  }
  return std::nullopt;
}

Way off_wall(Way way) {
  const double off = way.roof_off.value_or(0.0);
  way.box.low[0] -= off, way.shut_reach += off;
  return way;
}

std::vector<float> seen_along_diagonal(const std::vector<float>& standing, int points) {
  likeness::Scene scene;
  scene.views = {likeness::cone_views().front()};
  scene.pixels = points;
  scene.corner = likeness::Corner{};
  const likeness::Target target(standing, scene);
  const likeness::DepthImage& image = target.image(0);
  const likeness::Frame frame = target.frame(0);
  const double pitch = frame.pitch_mm();
  std::vector<float> out;
  const auto put = [&](int column, int row) {
    const double right = pitch * (column + 0.5) - 0.5 * frame.side_mm,
                 up = pitch * (row + 0.5) - 0.5 * frame.side_mm,
                 toward = static_cast<double>(image.at(column, row));
    const Vec3 p =
        frame.centre + right * frame.view.right + up * frame.view.up + toward * frame.view.toward;
    for (int i = 0; i < 3; ++i) out.push_back(static_cast<float>(p[i]));
  };
  for (int row = 0; row + 1 < points; ++row)
    for (int column = 0; column + 1 < points; ++column) {
      if (is_torn(image.at(column, row), image.at(column + 1, row), image.at(column, row + 1),
                  image.at(column + 1, row + 1), pitch))
        continue;
      put(column, row), put(column + 1, row), put(column + 1, row + 1);
      put(column, row), put(column + 1, row + 1), put(column, row + 1);
    }
  return out;
}

double misfit_of(const TriangleMesh& model, const Way& way) {
  const std::vector<float> standing = standing_model(model, way);
  likeness::Scene scene;
  scene.views = likeness::cone_views();
  scene.pixels = kMisfitPixels;
  scene.corner = likeness::Corner{};
  const likeness::Target target(standing, scene);
  if (target.is_unseen()) return std::numeric_limits<double>::infinity();
  return target.measure(seen_along_diagonal(standing, kNet)).error();
}

double detail_of(const TriangleMesh& model, std::span<const likeness::Rgb> colours,
                 const Way& way) {
  constexpr double kRise_deg = 30.0;
  constexpr int kPixels = 128;
  const std::vector<float> standing = standing_model(model, way);
  likeness::Scene scene;
  scene.views = {likeness::risen_view(0.0, radians(kRise_deg))};
  scene.pixels = kPixels;
  return likeness::PrintedTarget(standing, colours, scene).detail();
}

std::vector<Way> telling_ways(std::vector<Way> ways) {
  constexpr double kNearly = 0.85, kAsMuch = 0.97;
  double most = 0.0;
  for (const Way& way : ways) most = std::max(most, way.detail);
  // Turned by half a turn about the vertical, so that one shows the other's back.
  const auto is_back_of = [](const Way& way, const Way& other) {
    const TurnMatrix a = turn_of(way.rotate_deg), b = turn_of(other.rotate_deg);
    double front = 0.0, up = 0.0;
    for (std::size_t k = 0; k < 3; ++k) front += a[0][k] * b[0][k], up += a[2][k] * b[2][k];
    return front < -0.999 && up > 0.999;
  };
  std::vector<Way> out;
  for (const Way& way : ways) {
    const bool shows_back = std::any_of(ways.begin(), ways.end(), [&](const Way& other) {
      return way.detail < kAsMuch * other.detail && is_back_of(way, other);
    });
    if (way.detail >= kNearly * most && !shows_back) out.push_back(way);
  }
  return out;
}

std::vector<std::array<double, 3>> upright_turns(const UpSide& up, const FrontSide& front) {
  std::vector<std::array<double, 3>> out;
  for (const auto& degrees : right_turns()) {
    const TurnMatrix turn = turn_of(degrees);
    const auto leads = [&](const UpSide& side, std::size_t axis) {
      if (!side) return true;
      double along = 0.0;
      for (std::size_t k = 0; k < 3; ++k) along += turn[axis][k] * (*side)[k];
      return along > 0.5;
    };
    if (leads(up, 2) && leads(front, 0)) out.push_back(degrees);
  }
  return out;
}

const std::vector<std::string>& up_words() {
  static const std::vector<std::string> words{"any", "x", "y", "z", "-x", "-y", "-z"};
  return words;
}

const std::vector<std::string>& up_choices() {
  static const std::vector<std::string> choices = [] {
    std::vector<std::string> out{kUsualUp};
    out.insert(out.end(), up_words().begin(), up_words().end());
    return out;
  }();
  return choices;
}

std::string up_for_file(const std::string& up, std::string_view file, const std::string& front) {
  if (up != kUsualUp) return up;
  std::string ending(file.substr(std::min(file.size(), file.find_last_of('.'))));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const std::string usual = ending == ".obj" || ending == ".glb" || ending == ".gltf" ? "y"
                            : ending == ".stl"                                        ? "z"
                                                                                      : "any";
  return front == usual || front == "-" + usual ? "any" : usual;
}

UpSide up_side(const std::string& word) {
  if (word == "any") return std::nullopt;
  std::array<int, 3> out{};
  out.at(static_cast<std::size_t>(word.back() - 'x')) = word.front() == '-' ? -1 : 1;
  return out;
}

std::vector<std::array<double, 3>> turns_near(const std::array<double, 3>& turn, bool tilts) {
  constexpr std::array kYaws{-30.0, -15.0, 15.0, 30.0, 45.0};
  constexpr std::array kTilts{-20.0, -10.0, 10.0, 20.0};
  std::vector<std::array<double, 3>> out;
  for (const double yaw : kYaws) out.push_back(turned_on(turn, 2, yaw));
  if (!tilts) return out;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
    for (const double tilt : kTilts) out.push_back(turned_on(turn, axis, tilt));
  out.push_back(turned_on(turn, 1, 45.0));
  return out;
}

std::vector<Way> best_ways(std::vector<Way> ways, std::size_t count) {
  constexpr double kAlike = 1e-4;  // the last pixels differ where triangles come in another order
  std::stable_sort(ways.begin(), ways.end(),
                   [](const Way& a, const Way& b) { return a.misfit < b.misfit; });
  std::vector<Way> out;
  for (Way& way : ways) {
    if (out.size() == count) break;
    const bool is_alike = std::any_of(out.begin(), out.end(), [&](const Way& other) {
      return std::abs(other.misfit - way.misfit) <= kAlike &&
             std::abs(other.shut_reach - way.shut_reach) <= kAlike * way.shut_reach &&
             std::abs(other.length() - way.length()) <= kAlike * way.shut_reach;
    });
    if (!is_alike) out.push_back(std::move(way));
  }
  return out;
}

}  // namespace popcut
