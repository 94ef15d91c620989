// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"

namespace popcut::cli {

/// Is it an SVG drawing, in any encoding or packed by gzip, rather than a FOLD file? JSON begins
/// with a brace, XML with an angle.
[[nodiscard]] bool is_svg(std::string_view text);

/// Is it a drawing (SVG and crease patterns by their text, DXF by its name) rather than a FOLD
/// file?
[[nodiscard]] bool is_drawing(std::string_view text, const std::string& file);

/// The lines of an SVG or DXF drawing or a crease pattern (.cp, .opx) as FOLD text without faces
/// (`fold_from_linework`), for `verify` and `deploy` to trace. What the reader has to say is added
/// to `warnings`.
///
/// Where the profile asks what several colours mean, they are read as `origami-sim`, and a warning
/// says so: nothing is cut here.
///
/// @param svg_profile  name of a stroke profile, built in or of the user's tables
/// @param file  its name, for errors
/// @retval Malformed, OutOfRange  the drawing cannot be read or has no line to cut or fold
/// @retval Usage  there is no such profile (`--svg-profile`)
[[nodiscard]] Result<std::string> fold_of_drawing(const std::string& text, const std::string& file,
                                                  const std::string& svg_profile,
                                                  std::vector<std::string>& warnings);

/// Adds `--svg-profile` to a command that reads drawings by `fold_of_drawing`.
void add_svg_profile(const Command& command, std::string& svg_profile);

/// Is it a design spec, which says what to make, rather than a pattern?
[[nodiscard]] bool is_design_spec(const std::string& text);

/// What to say of a design spec where a pattern belongs.
///
/// @param command  the command that was given it: "verify", "deploy"
[[nodiscard]] Error not_yet_designed(const std::string& file, const std::string& command);

/// Refuses a 3D model (by its name) where a pattern belongs, and says how one is made.
///
/// @retval Malformed  it is a model
[[nodiscard]] Result<void> check_no_model(const std::string& file, const std::string& command);

/// Is it a pattern or a drawing (FOLD, SVG) rather than a design spec?
[[nodiscard]] bool is_pattern(const std::string& text);

/// What to say of a text that is no design spec where one belongs: what it is, as far as that can
/// be told, and what to type for it.
///
/// @param why  what the reader of specs said
[[nodiscard]] Error no_design_spec(const std::string& file, const std::string& text,
                                   const Error& why);

}  // namespace popcut::cli
