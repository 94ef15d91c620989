// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace popcut {

/// A variant of GPGL as data: what is sent, and in which order. A line holds commands separated by
/// blanks; " / " separates blocks. `{name}` stands for a value; a command is left out if the
/// machine or the job does not have its value. The defaults are what all variants share.
struct GpglVariant {
  std::string_view name;
  /// Orientation, window, first tool; before them the mat, where there is one.
  std::string_view start{R"(FN0 TB50,0 \{top},{left} Z{bottom},{right} J{holder})"};
  std::string_view blade{"FX{force} !{speed}"};  ///< all settings of a holder with a blade
  std::string_view pen{"FX{force} !{speed}"};    ///< all settings of a holder with a pen
  std::string_view select{"J{holder}"};          ///< another holder, between strokes
  std::string_view force{"FX{force}"};           ///< another force, between strokes
  std::string_view speed{"!{speed}"};            ///< another speed, between strokes
  std::string_view trailer{R"(L0 \0,0 M0,0 J{park} FN0 TB50,0)"};
  bool binary_draw{false};  ///< draws with BE
  int corner_tenths{0};     ///< corner extension of its own software, 0.1 mm
};

/// All variants, oldest first.
[[nodiscard]] std::span<const GpglVariant> gpgl_variants();
/// Null if there is no variant of that name.
[[nodiscard]] const GpglVariant* find_gpgl_variant(std::string_view name);

/// The values that `{name}` stands for; those that the machine or the job does not have are absent.
using SettingValues = std::map<std::string_view, std::optional<std::int64_t>>;

/// Writes a variant's line into `bytes`, each command with its ETX.
///
/// @return the end of each block in `bytes`; empty blocks are left out
std::vector<std::uint64_t> write_settings(std::string& bytes, std::string_view line,
                                          const SettingValues& values);

}  // namespace popcut
