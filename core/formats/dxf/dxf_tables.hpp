// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/formats/dxf/dxf_curves.hpp"
#include "core/formats/dxf/dxf_groups.hpp"
#include "core/drawing/toolpath.hpp"

namespace popcut {

/// What a layer's name says its lines are for.
enum class DxfMeaning : std::uint8_t {
  Unknown,
  Ignore,
  Draw,
  Score,
  Fold,  ///< a fold, of no side
  FoldMountain,
  FoldValley,
  Cut,
  Outline,
};

/// By the words in a layer's name, whatever their case: CUT, SLIT, OUTLINE, SCORE, ENGRAVE, MARK,
/// FOLD, CREASE, MOUNTAIN, VALLEY, FOLD_M, FOLD_V and the like; "no cut", GUIDE and DEFPOINTS are
/// for nothing. A fold wins over a cut, since paper that is cut through cannot be mended.
[[nodiscard]] DxfMeaning dxf_meaning(std::string_view layer);

inline constexpr std::size_t kMostDxfNames = 100'000;  ///< layers, line types, blocks, each

struct DxfLayer {
  std::string name;  ///< as it may be shown
  std::string linetype{"CONTINUOUS"};
  DxfMeaning meaning{};
  int colour{7};
  bool off{}, frozen{}, unplotted{};
};

/// Dashes (above 0), gaps (below 0) and dots (0) in drawing units.
struct DxfLinetype {
  std::vector<double> elements;
};

struct DxfBlock {
  std::string name;  ///< as it may be shown
  DxfVec base;
  DxfCursor at;  ///< stands before its first entity
  bool external{};
};

/// What stands before the entities, and where they are. Keys are names in capitals.
struct DxfTables {
  double unit_mm{1.0};
  std::string unit_name{"mm"};  ///< for messages
  double linetype_scale{1.0};
  std::vector<std::string> warnings;
  std::unordered_map<std::string, DxfLayer> layers;
  std::unordered_map<std::string, DxfLinetype> linetypes;
  std::unordered_map<std::string, DxfBlock> blocks;
  std::vector<DxfCursor> entities;  ///< each stands before the first entity of such a section
};

/// A name in capitals (ASCII only), as the keys of `DxfTables` are.
[[nodiscard]] std::string dxf_key(std::string_view name);

/// A name that can be shown: UTF-8 as it stands, other bytes as Windows-1252 has them.
[[nodiscard]] std::string dxf_name(std::string_view name);

/// Walks over the whole text once: its sections are closed, its groups are groups; header, layers,
/// line types and blocks are kept.
///
/// @retval Malformed   no sections, a section that does not end, a wrong group; place is the line
/// @retval OutOfRange  more than 100 000 layers, line types or blocks
[[nodiscard]] Result<DxfTables> read_dxf_tables(std::string_view text);

}  // namespace popcut
