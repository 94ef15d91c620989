// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/dxf/dxf_curves.hpp"
#include "core/formats/dxf/dxf_groups.hpp"

namespace popcut {

/// A corner of a polyline. `bulge` is the tangent of a quarter of the angle of the arc to the next
/// corner.
struct DxfVertex {
  Vec3 at;
  double bulge{};
};

/// What an entity has many of.
struct DxfLists {
  std::vector<DxfVertex> vertices{};  ///< LWPOLYLINE
  std::vector<double> knots{}, weights{};
  std::vector<Vec3> control{}, fit{};  ///< SPLINE
};

/// One entity as read. Its type decides which members are meaningful.
struct DxfEntity : DxfLists {
  std::string_view type;
  std::size_t line{};
  std::string_view layer{"0"}, linetype{"BYLAYER"}, block;
  int colour{256};  ///< AutoCAD's index; 256: the layer's colour, 0: the insert's
  int rgb{-1};      ///< 420
  bool paper{};     ///< on a paper layout (code 67)
  bool hidden{};    ///< invisible (code 60), wholly transparent (440), or of a colour below 0
  double linetype_scale{1.0};
  double elevation{};
  std::optional<Vec3> extrusion;
  Vec3 p10, p11, p12, p13;
  std::array<double, 10> real{};      ///< codes 40 to 49
  std::array<bool, 10> given{};       ///< which entries of `real` are set
  double from_deg{}, to_deg{};        ///< 50, 51
  std::array<int, 10> flag{};         ///< codes 70 to 79
  bool tangent_from{}, tangent_to{};  ///< whether codes 12, 13 are set

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

/// How an INSERT places its block in the drawing around it, for one cell of its array. The insert's
/// rotation applies to the spacings, its scale does not.
[[nodiscard]] DxfFrame insert_frame(const DxfEntity& insert, const Vec3& base, double across,
                                    double up);

/// What became of an entity that was outlined.
enum class DxfShape {
  Flat,
  Tilted,  ///< the extrusion is neither up nor down
  Mesh,    ///< a POLYLINE that is a mesh: nothing is drawn
};

/// Appends the outline of an entity in page mm; `frame` maps drawing units to mm. `wrong` gets a
/// sentence on what is not valid in the entity.
[[nodiscard]] DxfShape outline_of(const DxfEntity& entity, const DxfFrame& frame, double tolerance,
                                  std::size_t most, std::vector<PagePoint>& line,
                                  std::string& wrong);

}  // namespace popcut
