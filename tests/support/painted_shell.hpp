// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/artwork/colour_mesh_reader.hpp"

namespace popcut::testing {

/// A quarter shell about the spine, painted: an OBJ with its MTL and a texture of `paint`.
struct PaintedShell {
  std::function<double(double y)> radius;  ///< of y from -1 to 1
  double flattened{1};                     ///< z over x
  std::function<Colour(double s, double t)> paint;
  int along{24}, around{36};

  [[nodiscard]] std::string obj() const {
    std::string text = "mtllib shell.mtl\n";
    for (int i = 0; i <= along; ++i)
      for (int j = 0; j <= around; ++j) {
        const double y = -1 + 2.0 * i / along, a = std::numbers::pi / 2 * j / around;
        text += fmt::format("v {:.6f} {:.6f} {:.6f}\nvt {:.6f} {:.6f}\n", radius(y) * std::cos(a),
                            y, flattened * radius(y) * std::sin(a), static_cast<double>(j) / around,
                            static_cast<double>(i) / along);
      }
    text += "usemtl skin\n";
    for (int i = 0; i < along; ++i)
      for (int j = 0; j < around; ++j) {
        const int a = i * (around + 1) + j + 1, c = a + around + 1;
        text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, a + 1, c + 1, c);
      }
    return text;
  }

  [[nodiscard]] ColourImage texture(std::size_t size = 256) const {
    ColourImage image(size, size);
    for (std::size_t j = 0; j < size; ++j)
      for (std::size_t i = 0; i < size; ++i)
        image.set(i, j,
                  paint((static_cast<double>(i) + 0.5) / static_cast<double>(size),
                        (static_cast<double>(j) + 0.5) / static_cast<double>(size)));
    return image;
  }

  /// The MTL, and the texture under the name that it gives it.
  [[nodiscard]] ModelFiles files() const {
    return {[](const std::string& name) -> Result<std::string> {
              return name == "shell.mtl" ? std::string("newmtl skin\nmap_Kd skin.png\n")
                                         : std::string("pixels");
            },
            [image = texture()](const std::string&, std::string_view,
                                std::size_t) -> Result<ColourImage> { return image; }};
  }

  [[nodiscard]] static std::string spec(int units, int slices, double scale_mm) {
    return fmt::format(
        R"({{"popcut": 1, "name": "shell", "surface": {{"type": "mesh", "file": "shell.obj"}},
            "scale_mm": {}, "units_per_slice": {}, "slices": {}, "widths_mm": {:.4f},
            "translate_mm": [0, {}, 0], "fit": "nearest"}})",
        scale_mm, units, slices, 1.6 * scale_mm / slices, 0.8 * scale_mm);
  }

  [[nodiscard]] static std::string facet_spec(double scale_mm) {
    return fmt::format(
        R"({{"popcut": 1, "name": "shell", "style": "facets", "scale_mm": {},
            "surface": {{"type": "mesh", "file": "shell.obj"}}}})",
        scale_mm);
  }
};

/// Five shells of different shapes and paints, no paint near white.
[[nodiscard]] inline std::array<PaintedShell, 5> painted_shells() {
  const auto byte = [](double share) { return static_cast<float>(30 + 170 * share); };
  const auto waves = [byte](double s, double t) {
    return Colour{byte(s), byte(t), byte(0.5 + 0.5 * std::sin(20 * s) * std::cos(15 * t)), 255};
  };
  const auto rings = [byte](double s, double t) {
    const double r = std::hypot(s - 0.5, t - 0.5);
    return Colour{byte(0.5 + 0.5 * std::cos(25 * r)), byte(r), byte(1 - r), 255};
  };
  const auto stripes = [byte](double s, double t) {
    return Colour{byte(0.5 + 0.5 * std::sin(40 * (s + t))), byte(s * t), byte(0.3), 255};
  };
  return {PaintedShell{[](double y) { return std::sqrt(1.3 - y * y); }, 1, waves},
          PaintedShell{[](double y) { return 0.7 * std::sqrt(1 + 0.6 * y * y); }, 1, rings},
          PaintedShell{[](double y) { return 0.9 + 0.12 * std::sin(3 * y); }, 1, stripes},
          PaintedShell{[](double) { return 0.8; }, 1.25, rings},
          PaintedShell{[](double y) { return 0.7 + 0.2 * y; }, 0.8, waves}};
}

}  // namespace popcut::testing
