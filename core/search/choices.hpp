// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// How hard to fold the cards of a search may be, "any" first.
[[nodiscard]] std::vector<std::string> label_words();

/// Whether what is asked of a search goes together.
///
/// @param style      the name of one of `style_choices`
/// @param cards      of a book; 1: a card alone
/// @param up, front  words of `up_words`
/// @retval Usage  it does not; the place is "/cards", "/style" or "/front", and the text names
///                another choice in backquotes, as errors of plans name options
[[nodiscard]] Result<void> check_choices(const std::string& style, int cards, const std::string& up,
                                         const std::string& front);

}  // namespace popcut
