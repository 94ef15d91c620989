// SPDX-License-Identifier: MIT
#include "core/picture/picture_words.hpp"

#include <cmath>

#include <fmt/format.h>

namespace popcut {

std::string picture_text(double x, double y, std::string_view words, std::string_view anchor,
                         const PictureText& how) {
  if (words.empty()) return {};
  const std::string turn =
      how.degrees == 0
          ? ""
          : fmt::format(" transform=\"rotate({:.2f} {:.2f} {:.2f})\"", how.degrees, x, y);
  return fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"{}\" font-family=\"sans-serif\" "
      "font-size=\"{}\" fill=\"{}\"{}>{}</text>\n",
      x, y, anchor, how.size, kPictureInk, turn, xml_escaped(words));
}

void put_rectangle(TextSink& text, double x, double y, double width, double height,
                   std::string_view colour) {
  text("<rect x=\"", x, "\" y=\"", y, "\" width=\"", width, "\" height=\"", height, "\" fill=\"",
       colour, "\"/>\n");
}

double round_length(double most) {
  if (!(most > 0)) return 0;
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double times : {5.0, 2.0})
    if (times * power <= most) return times * power;
  return power;
}

}  // namespace popcut
