// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/text/text_sink.hpp"

namespace popcut {

/// A number of an attribute, as `append_rounded` writes it.
[[nodiscard]] inline std::string rounded(double number) {
  std::string text;
  append_rounded(text, number);
  return text;
}

/// Whether an SVG is a file of its own or stands inside HTML or another SVG, where an XML
/// declaration may not.
enum class SvgPlace { File, Inside };

/// The attribute that layers of Inkscape need.
inline constexpr std::string_view kInkscape =
    "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\"";

/// What a drawing says whose folds are dashes already.
inline constexpr std::string_view kDashed = "version=\"1.1\" data-popcut=\"dashes\"";

/// The beginning of an SVG document: the XML declaration, `<svg` with SVG's namespace and
/// `attributes` (width, height, viewBox and others, as they are written), and the title, which is
/// escaped; an empty one is left out. It ends with "</svg>".
[[nodiscard]] inline std::string svg_head(std::string_view attributes, std::string_view title = {},
                                          SvgPlace place = SvgPlace::File) {
  std::string head;
  if (place == SvgPlace::File) head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  head.append("<svg xmlns=\"http://www.w3.org/2000/svg\" ").append(attributes).append(">\n");
  if (!title.empty()) head.append("<title>").append(xml_escaped(title)).append("</title>\n");
  return head;
}

}  // namespace popcut
