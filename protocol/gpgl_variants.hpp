// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace popcut {

inline constexpr char kEtx = '\x03';
inline constexpr char kEsc = '\x1b';

/// A variant of GPGL as data: what is sent, and in which order. A line holds commands separated by
/// blanks; " / " parts blocks. `{name}` stands for a value; a command whose value the machine or
/// the job does not have is left out.
struct GpglVariant {
  std::string_view name;
  std::string_view start;   ///< mat, orientation, window, first tool
  std::string_view blade;   ///< all settings of a holder with a blade
  std::string_view pen;     ///< all settings of a holder with a pen
  std::string_view select;  ///< another holder, between strokes
  std::string_view force;   ///< another force, between strokes
  std::string_view speed;   ///< another speed, between strokes
  std::string_view trailer;
  bool binary_draw;   ///< draws with BE
  int corner_tenths;  ///< corner extension of its own software, 0.1 mm
};

/// All variants, in the order in which they came up.
[[nodiscard]] std::span<const GpglVariant> gpgl_variants();
/// Null if there is none of that name.
[[nodiscard]] const GpglVariant* find_gpgl_variant(std::string_view name);

/// The values that `{name}` stands for.
class SettingValues {
 public:
  void set(std::string_view name, std::optional<std::int64_t> value);
  [[nodiscard]] std::optional<std::int64_t> get(std::string_view name) const;

 private:
  std::vector<std::pair<std::string_view, std::optional<std::int64_t>>> values_;
};

/// Writes a variant's line into `bytes`, each command with its ETX.
///
/// @return the ends of its blocks in `bytes`, without empty blocks
std::vector<std::uint64_t> write_settings(std::string& bytes, std::string_view line,
                                          const SettingValues& values);

}  // namespace popcut
