// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/compare/printed.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/judge/sound_slices.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// Adds the files of a card of layers: those of `fold svg cut dxf png picture report` that `wants`
/// has; the other formats are for cards of one sheet.
///
/// @return their names, each after a blank
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> add_layer_files(
    const judge::SoundLayers& sound, const likeness::PrintedFigures& printed,
    const Material& material, double seconds, const std::function<bool(std::string_view)>& wants,
    OutputFolder& folder);

/// The same of a card of slices.
[[nodiscard]] Result<std::string> add_slice_files(
    const judge::SoundSlices& sound, const Material& material, double seconds,
    const std::function<bool(std::string_view)>& wants, OutputFolder& folder);

/// The same of a card of boxes.
[[nodiscard]] Result<std::string> add_box_files(const judge::SoundBoxes& sound,
                                                const likeness::PrintedFigures& printed,
                                                const Material& material, double seconds,
                                                const std::function<bool(std::string_view)>& wants,
                                                OutputFolder& folder);

/// What a person wants to know of it first, to standard error.
void say_boxes(const judge::SoundBoxes& sound, const likeness::PrintedFigures& printed);
void say_slices(const judge::SoundSlices& sound);
void say_layers(const judge::SoundLayers& sound, const likeness::PrintedFigures& printed);

}  // namespace popcut::cli
