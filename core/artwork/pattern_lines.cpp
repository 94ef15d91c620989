// SPDX-License-Identifier: MIT
#include "core/artwork/pattern_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/artwork/pixel_frame.hpp"
#include "core/geometry/design_angle.hpp"
#include "core/geometry/vec.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

/// A model as it is seen: places of the page, and how near each is.
class SeenModel {
 public:
  SeenModel(const ColourMesh& mesh, const Pattern& pattern, const PixelFrame& frame)
      : mesh_(mesh),
        opening_(DesignAngle::of_rad(pattern.design_psi_rad)),
        wall_mm_(pattern.wall_mm),
        at_(pattern.place),
        frame_(frame),
        nearest_(frame.pixels(), -std::numeric_limits<float>::infinity()) {
    for (std::size_t t = 0; t < mesh.size(); ++t) {
      const std::array<Vec3, 3> c{mesh.soup.corner(t, 0), mesh.soup.corner(t, 1),
                                  mesh.soup.corner(t, 2)};
      each_pixel(frame_, {page(c[0]), page(c[1]), page(c[2])},
                 [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
                   float& before = nearest_[j * frame_.width + i];
                   before =
                       std::max(before, static_cast<float>(w[0] * depth(c[0]) + w[1] * depth(c[1]) +
                                                           w[2] * depth(c[2])));
                 });
    }
  }

  /// Appends the seen parts of the model's edges as path data.
  void append_edges(std::string& path) const {
    for (const auto& [ends, sides] : edges())
      if (is_drawn(sides)) append_seen(ends[0], ends[1], path);
  }

 private:
  using Corner = std::array<float, 3>;  // corners of the same place are one
  struct Sides {
    std::array<Vec3, 2> normal{};
    int count{0};
  };

  [[nodiscard]] static Vec3 vec(const Corner& c) {
    return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
  }
  [[nodiscard]] PagePoint page(const Vec3& p) const {
    return {p[1] + at_.v_mm, wall_mm_ + p[0] - p[2] + at_.u_mm};
  }
  [[nodiscard]] static double depth(const Vec3& p) { return p[0] + p[2]; }

  [[nodiscard]] std::map<std::array<Corner, 2>, Sides> edges() const {
    std::map<std::array<Corner, 2>, Sides> out;
    for (std::size_t t = 0; t < mesh_.size(); ++t) {
      std::array<Corner, 3> corner;
      std::array<Vec3, 3> place;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = mesh_.soup.corner(t, k);
        for (std::size_t c = 0; c < 3; ++c)
          corner[k][c] = static_cast<float>(p[static_cast<Eigen::Index>(c)]);
        place[k] = p;
        opening_.to_space(place[k][0], place[k][2]);
      }
      const Vec3 normal = unit(cross(place[1] - place[0], place[2] - place[0]));
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<Corner, 2> ends{corner[k], corner[(k + 1) % 3]};
        if (ends[0] == ends[1]) continue;
        if (ends[1] < ends[0]) std::swap(ends[0], ends[1]);
        Sides& sides = out[ends];
        if (sides.count < 2) sides.normal[static_cast<std::size_t>(sides.count)] = normal;
        ++sides.count;
      }
    }
    return out;
  }

  [[nodiscard]] bool is_drawn(const Sides& sides) const {
    if (sides.count != 2) return true;
    const Vec3 toward{1 + opening_.cosine, 0, opening_.sine};
    const double a = dot(sides.normal[0], toward), b = dot(sides.normal[1], toward);
    constexpr double kCos30 = 0.8660254037844386;
    return (a > 0) != (b > 0) || dot(sides.normal[0], sides.normal[1]) < kCos30;
  }

  [[nodiscard]] bool is_seen(const Vec3& p) const {
    const PagePoint at = frame_.in_pixels(page(p));
    const double x = std::round(at.x), y = std::round(at.y);
    // Beside an outline is nothing, so all pixels around are asked.
    const double slack = 4 * frame_.pixel_mm;
    for (const double dx : {0.0, -1.0, 1.0})
      for (const double dy : {0.0, -1.0, 1.0}) {
        const double i = x + dx, j = y + dy;
        if (!(i >= 0 && j >= 0 && i < static_cast<double>(frame_.width) &&
              j < static_cast<double>(frame_.height)))
          continue;
        const auto there = static_cast<double>(
            nearest_[static_cast<std::size_t>(j) * frame_.width + static_cast<std::size_t>(i)]);
        if (depth(p) + slack >= there) return true;
      }
    return false;
  }

  void append_seen(const Corner& from, const Corner& to, std::string& path) const {
    const Vec3 a = vec(from), b = vec(to);
    const double length = distance(page(a), page(b));
    const auto steps =
        static_cast<std::size_t>(std::clamp(std::ceil(length / frame_.pixel_mm), 1.0, 100'000.0));
    bool down = false;
    std::size_t begun = 0;
    const auto end = [&](std::size_t last) {
      if (!down || last == begun) return;
      const auto point = [&](std::size_t k) {
        const double share = static_cast<double>(k) / static_cast<double>(steps);
        return page(a + share * (b - a));
      };
      const PagePoint p = point(begun), q = point(last);
      path += 'M';
      append_rounded(path, p.x), path += ' ', append_rounded(path, p.y);
      path += 'L';
      append_rounded(path, q.x), path += ' ', append_rounded(path, q.y);
    };
    for (std::size_t k = 0; k <= steps; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(steps);
      const bool seen = is_seen(a + share * (b - a));
      if (seen && !down) begun = k, down = true;
      if (!seen && down) end(k - 1), down = false;
    }
    end(steps);
  }

  const ColourMesh& mesh_;
  DesignAngle opening_;
  double wall_mm_;
  PatternPlace at_;
  PixelFrame frame_;
  std::vector<float> nearest_;
};

/// A face's outline and grey; no path for wall and ground.
struct Panel {
  const char* grey{};
  std::string path;
};
Panel panel(const Pattern& pattern, std::size_t f) {
  const auto face = pattern.face(f);
  bool upright = true, level = true;
  for (const std::uint32_t i : face) {
    upright = upright && pattern.vertices[i].x == pattern.vertices[face[0]].x;
    level = level && pattern.vertices[i].z == pattern.vertices[face[0]].z;
  }
  const PatternVertex& first = pattern.vertices[face[0]];
  if ((upright && first.x == 0) || (level && first.z == 0)) return {};
  Panel out{upright ? "#c4c4c4" : level ? "#ececec" : "#d8d8d8", {}};
  for (std::size_t k = 0; k < face.size(); ++k) {
    const PatternVertex& p = pattern.vertices[face[k]];
    out.path += k == 0 ? 'M' : 'L';
    append_rounded(out.path, p.v + pattern.place.v_mm), out.path += ' ';
    append_rounded(out.path, pattern.u(p) + pattern.place.u_mm);
  }
  out.path += 'Z';
  return out;
}

}  // namespace

Result<std::string> pattern_lines(std::span<const Pattern> parts,
                                  std::span<const ColourMesh> models, const PixelFrame& frame,
                                  double trap_mm) {
  // Below the panels the same ones, wider by the trap: so no paper shows beside a cut that is off.
  std::string wide =
      fmt::format("<g stroke-linejoin=\"round\" stroke-width=\"{:g}\">\n", 2 * trap_mm);
  std::string svg = "<g stroke=\"none\">\n";
  for (const Pattern& part : parts)
    for (std::size_t f = 0; f < part.faces(); ++f) {
      const Panel drawn = panel(part, f);
      if (drawn.path.empty()) continue;
      wide += fmt::format("<path fill=\"none\" stroke=\"{}\" d=\"{}\"/>\n", drawn.grey, drawn.path);
      svg += fmt::format("<path fill=\"{}\" d=\"{}\"/>\n", drawn.grey, drawn.path);
    }
  svg = wide + "</g>\n" + svg + "</g>\n";
  for (std::size_t k = 0; k < parts.size() && k < models.size(); ++k) {
    std::string path;
    SeenModel(models[k], parts[k], frame).append_edges(path);
    if (!path.empty())
      svg += fmt::format(
          "<path fill=\"none\" stroke=\"#000000\" stroke-width=\"0.25\" stroke-linecap=\"round\" "
          "d=\"{}\"/>\n",
          path);
  }
  return svg;
}

}  // namespace popcut
