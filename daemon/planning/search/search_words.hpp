// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"
#include "daemon/model/model.hpp"

namespace popcut::planning {

// What popcutd and the worker of a search tell each other, as JSON. popcutd stores both, too.

/// A design's name of what a file is called: without its folders and its ending. "model" where that
/// is too long or no plain text.
[[nodiscard]] std::string design_name(const std::string& file);

/// The one option of the task of a search: `search_words`.
inline constexpr const char* kSearchWords = "search";
/// What a search is asked for, without machine and material: the members of the request by their
/// names.
[[nodiscard]] std::string search_words(const daemon::CardSearchRequest& request);
/// The request that such words say.
///
/// @retval Malformed, OutOfRange  they are not of that form
[[nodiscard]] Result<daemon::CardSearchRequest> read_search_words(std::string_view words);

/// The file of an outcome that has the figures of what was found: `front_text`.
inline constexpr const char* kFrontFile = "front.json";
/// The picture of a card (`thumbnail_png`): "card-01.png". @param card  from 1
[[nodiscard]] std::string thumbnail_file(int card);
/// A card in three dimensions (`shown_blob`): "card-01.lattice". @param card  from 1
[[nodiscard]] std::string lattice_file(int card);
[[nodiscard]] std::string front_text(const daemon::SearchFront& front);
/// Figures from `front_text`. A worker is not trusted: numbers are finite and in their ranges,
/// texts are printable and short, and a spec is an object.
///
/// @retval Malformed, OutOfRange  they are not of that form
[[nodiscard]] Result<daemon::SearchFront> read_front(std::string_view text);

}  // namespace popcut::planning
