// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/text/text_sink.hpp"

namespace popcut {

/// The colour of words and lines of pictures.
inline constexpr std::string_view kPictureInk = "#3d3a36";

struct PictureText {
  double size{14};    ///< px
  double degrees{0};  ///< turned clockwise about its place
};

/// `words`, escaped, at (x, y) of their base line; `anchor` is start, middle or
/// end. Nothing where there are no words.
[[nodiscard]] std::string picture_text(double x, double y, std::string_view words,
                                       std::string_view anchor, const PictureText& how = {});

void put_rectangle(TextSink& text, double x, double y, double width, double height,
                   std::string_view colour);

/// The largest of 1, 2 and 5 times a power of ten that is at most `most`; 0 if that is not
/// positive.
[[nodiscard]] double round_length(double most);

}  // namespace popcut
