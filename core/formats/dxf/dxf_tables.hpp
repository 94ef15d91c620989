// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/formats/dxf/dxf_curves.hpp"
#include "core/formats/dxf/dxf_groups.hpp"
#include "core/warning.hpp"

namespace popcut {

/// Limit for each of layers, line types and blocks.
inline constexpr std::size_t kMostDxfNames = 100'000;

/// A layer of the LAYER table.
struct DxfLayer {
  std::string name;  ///< for messages
  std::string linetype{"CONTINUOUS"};
  int colour{7};
  int rgb{-1};  ///< in place of `colour`, if it is not negative
  bool off{}, frozen{};
  bool unplotted{};  ///< or wholly transparent
};

/// Dashes (above 0), gaps (below 0) and dots (0) in drawing units.
struct DxfLinetype {
  std::vector<double> elements;
};

/// A block of the BLOCKS section.
struct DxfBlock {
  std::string name;  ///< for messages
  Vec3 base;
  DxfCursor at;  ///< just before its first entity
  bool external{};
};

/// The tables before the entities, and where entities begin. Keys are those of `dxf_key`.
struct DxfTables {
  double unit_mm{1.0};
  std::string unit_name{"mm"};  ///< for messages
  double linetype_scale{1.0};
  std::vector<Warning> warnings;
  std::unordered_map<std::string, DxfLayer> layers;
  std::unordered_map<std::string, DxfLinetype> linetypes;
  std::unordered_map<std::string, DxfBlock> blocks;
  bool foreign_names{};  ///< bytes above 127 belong to another code page than Windows-1252
  std::vector<DxfCursor> entities;  ///< just before the first entity of each ENTITIES section
};

/// A name without case, however its characters are written (`dxf_name`); ASCII letters are
/// capitals: the keys of `DxfTables`.
[[nodiscard]] std::string dxf_key(std::string_view name);

/// A name for messages: valid UTF-8 unchanged, \U+XXXX as that character, other bytes read as
/// Windows-1252.
[[nodiscard]] std::string dxf_name(std::string_view name);

/// Walks over the whole text once. Checks that sections are closed and groups are valid. Keeps the
/// header, layers, line types and blocks.
///
/// @retval Malformed   no sections, a section that does not end, or an invalid group; place is the
///                     line
/// @retval OutOfRange  more than 100 000 layers, line types or blocks
[[nodiscard]] Result<DxfTables> read_dxf_tables(std::string_view text);

}  // namespace popcut
