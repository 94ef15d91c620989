// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/hands/hands.hpp"
#include "core/result.hpp"
#include "device/sim/sim_faults.hpp"

namespace popcut::cli {

/// The users' own tables of machines, materials and SVG profiles as texts, with the files they came
/// from.
struct UserTables {
  std::vector<std::string> texts;
  std::vector<std::string> files;

  /// The same error with the file's name where it says "table N".
  [[nodiscard]] Error with_file(Error error) const;
  /// The same for a row that an option names: `option` is the place of an error that has none.
  [[nodiscard]] Error with_file(Error error, const char* option) const;
};

/// Reads `machines.json`, `materials.json`, `svg_profiles.json` and `hands.json` of /etc/popcut and
/// then of $XDG_CONFIG_HOME/popcut (~/.config/popcut), whose rows win. Files that are not there are
/// passed over.
///
/// @retval Malformed  one is there and cannot be read
[[nodiscard]] Result<UserTables> read_user_tables();

/// How long this user takes to fold (`hands::hands_of` their tables).
///
/// @retval Malformed, OutOfRange  a table cannot be read; with its file
[[nodiscard]] Result<hands::Hands> own_hands();

/// A table of the user's own ("machines.json"): where it is, and its text; empty if there is none.
///
/// @retval Unwritable  there is no home to keep it in
struct OwnTable {
  std::string file, text;
};
[[nodiscard]] Result<OwnTable> own_table(const char* name);
/// Writes it, whole or not at all.
///
/// @retval Unwritable  the file or its folder
[[nodiscard]] Result<void> write_own_table(const char* name, const std::string& text);

/// Reads a fault script, which without a file has no faults; its errors name the file.
[[nodiscard]] Result<std::vector<SimFault>> read_faults(const std::string& file);

}  // namespace popcut::cli
