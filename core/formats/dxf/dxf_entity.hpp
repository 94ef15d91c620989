// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "core/formats/dxf/dxf_curves.hpp"
#include "core/formats/dxf/dxf_groups.hpp"

namespace popcut {

/// A corner of a polyline: `bulge` is the tangent of a quarter of the angle of the arc to the next.
struct DxfVertex {
  DxfVec at;
  double bulge{};
};

/// One entity as it stands. Which members mean something depends on its type.
struct DxfEntity {
  std::string_view type;
  std::size_t line{};
  std::string_view layer{"0"}, linetype{"BYLAYER"}, block;
  int colour{256};         ///< AutoCAD's index; 256 that of the layer, 0 that of the insert
  int rgb{-1};             ///< 420
  bool paper{}, hidden{};  ///< on a paper layout (67); invisible (60)
  double linetype_scale{1.0};
  double elevation{};
  std::optional<DxfVec> extrusion;
  DxfVec p10, p11, p12, p13;
  std::array<double, 10> real{};      ///< codes 40 to 49
  std::array<bool, 10> given{};       ///< those of `real` that are there
  double from_deg{}, to_deg{};        ///< 50, 51
  std::array<int, 10> flag{};         ///< codes 70 to 79
  bool tangent_from{}, tangent_to{};  ///< 12, 13 are there
  std::vector<DxfVertex> vertices;    ///< LWPOLYLINE
  std::vector<double> knots, weights;
  std::vector<DxfVec> control, fit;  ///< SPLINE

  [[nodiscard]] double real_or(std::size_t code, double otherwise) const {
    return given.at(code - 40) ? real.at(code - 40) : otherwise;
  }
};

inline constexpr std::size_t kMostInDxfEntity = 4'000'000;  ///< vertices, knots or points

/// Reads the entity whose group 0 `cursor` stands on; the cursor ends at the next group 0, or at
/// the end of the text or a fault: then false. Numbers are read only if `numbers` says so. What
/// programs attach (102 { ... }, 101, 1000 and above) is passed over.
///
/// `out` is filled anew; its vectors keep their memory. More than `kMostInDxfEntity` is a fault.
bool read_dxf_entity(DxfCursor& cursor, bool numbers, DxfEntity& out);

}  // namespace popcut
