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

/// A corner of a polyline. `bulge` is the tangent of a quarter of the angle of the arc to the next
/// corner.
struct DxfVertex {
  DxfVec at;
  double bulge{};
};

/// One entity as read. Its type decides which members are meaningful.
struct DxfEntity {
  std::string_view type;
  std::size_t line{};
  std::string_view layer{"0"}, linetype{"BYLAYER"}, block;
  int colour{256};         ///< AutoCAD's index; 256: the layer's colour, 0: the insert's
  int rgb{-1};             ///< 420
  bool paper{}, hidden{};  ///< on a paper layout (code 67); invisible (code 60)
  double linetype_scale{1.0};
  double elevation{};
  std::optional<DxfVec> extrusion;
  DxfVec p10, p11, p12, p13;
  std::array<double, 10> real{};      ///< codes 40 to 49
  std::array<bool, 10> given{};       ///< which entries of `real` are set
  double from_deg{}, to_deg{};        ///< 50, 51
  std::array<int, 10> flag{};         ///< codes 70 to 79
  bool tangent_from{}, tangent_to{};  ///< whether codes 12, 13 are set
  std::vector<DxfVertex> vertices;    ///< LWPOLYLINE
  std::vector<double> knots, weights;
  std::vector<DxfVec> control, fit;  ///< SPLINE

  [[nodiscard]] double real_or(std::size_t code, double otherwise) const {
    return given.at(code - 40) ? real.at(code - 40) : otherwise;
  }
};

inline constexpr std::size_t kMostInDxfEntity = 4'000'000;  ///< vertices, knots or points

/// Reads the entity that begins at the group 0 under `cursor`. The cursor ends at the next group 0;
/// at the end of the text or at a fault it returns false. Parses numbers only if `numbers`. Ignores
/// what programs attach (102 { ... }, 101, 1000 and above).
///
/// Overwrites `out`, whose vectors keep their memory. More than `kMostInDxfEntity` items are a
/// fault.
bool read_dxf_entity(DxfCursor& cursor, bool numbers, DxfEntity& out);

}  // namespace popcut
