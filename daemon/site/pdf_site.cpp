// SPDX-License-Identifier: MIT
// Part of daemon/pictures/pdf.hpp. Pages as a PDF without librsvg and cairo: a writer for the few
// elements that popcut's own drawings have. Letters are lines, so no font is needed.
#include "daemon/pictures/pdf.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>
#include <pugixml.hpp>

#include "core/print/drawn_letters.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/pictures/artwork_pdf.hpp"

namespace popcut {
namespace {

constexpr double kPoints_per_mm = 72.0 / 25.4;

tl::unexpected<Error> cannot_draw(std::string_view why) {
  return fail(ErrorKind::Internal, "picture", fmt::format("cannot be drawn: {}", why));
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  compress2(reinterpret_cast<Bytef*>(out.data()), &size,
            reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 6);
  out.resize(size);
  return out;
}

/// The next number of a list of them, which commas and spaces part; none at its end.
std::optional<double> next_number(std::string_view& text) {
  const std::size_t begin = text.find_first_of("0123456789+-.");
  if (begin == text.npos) return std::nullopt;
  text.remove_prefix(text[begin] == '+' ? begin + 1 : begin);
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return value;
}

std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> out;
  while (const auto number = next_number(text)) out.push_back(*number);
  return out;
}

/// How a shape is painted; an element takes what it does not say from the one that holds it.
struct Paint {
  std::string fill{"#000000"}, stroke{"none"};
  double width{1}, fill_opacity{1}, stroke_opacity{1};
  std::vector<double> dashes;
  int cap{0}, join{0};
};

Paint painted(Paint paint, const pugi::xml_node& node) {
  const auto number = [&](const char* name, double& value) {
    if (const auto given = node.attribute(name)) value = given.as_double();
  };
  if (const auto fill = node.attribute("fill")) paint.fill = fill.value();
  if (const auto stroke = node.attribute("stroke")) paint.stroke = stroke.value();
  number("stroke-width", paint.width);
  number("fill-opacity", paint.fill_opacity);
  number("stroke-opacity", paint.stroke_opacity);
  if (const auto dashes = node.attribute("stroke-dasharray"))
    paint.dashes = numbers_in(dashes.value());
  const auto word = [&](const char* name, std::array<std::string_view, 3> words, int& value) {
    for (int k = 0; k < 3; ++k)
      if (node.attribute(name).value() == words[static_cast<std::size_t>(k)]) value = k;
  };
  word("stroke-linecap", {"butt", "round", "square"}, paint.cap);
  word("stroke-linejoin", {"miter", "round", "bevel"}, paint.join);
  return paint;
}

/// "#rrggbb", "#rgb", "black" or "white" as three numbers from 0 to 1.
std::string colour_in(std::string_view colour) {
  std::array<int, 3> rgb{};
  const auto hex = [&](std::size_t at, std::size_t digits) {
    int value = 0;
    std::from_chars(colour.data() + at, colour.data() + at + digits, value, 16);
    return digits == 1 ? 17 * value : value;
  };
  if (colour == "white") rgb = {255, 255, 255};
  if (colour.size() == 7)
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = hex(1 + 2 * k, 2);
  if (colour.size() == 4)
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = hex(1 + k, 1);
  return fmt::format("{:.4g} {:.4g} {:.4g}", rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
}

/// The objects of a PDF file.
class PdfFile {
 public:
  /// The number of an object that is given later.
  std::size_t reserve() {
    objects_.emplace_back();
    return objects_.size();
  }
  void set(std::size_t number, std::string object) { objects_[number - 1] = std::move(object); }
  std::size_t add(std::string object) {
    objects_.push_back(std::move(object));
    return objects_.size();
  }
  std::size_t add_stream(std::string_view words, std::string_view bytes) {
    const std::string packed = deflated(bytes);
    return add(fmt::format("<< {} /Filter /FlateDecode /Length {} >>\nstream\n{}\nendstream", words,
                           packed.size(), packed));
  }
  /// The whole file; `catalog` and `about` are objects.
  [[nodiscard]] std::string bytes(std::size_t catalog, std::size_t about) const {
    std::string out = "%PDF-1.5\n%\xE2\xE3\xCF\xD3\n";
    std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects_.size() + 1);
    for (std::size_t k = 0; k < objects_.size(); ++k) {
      table += fmt::format("{:010} 00000 n \n", out.size());
      out += fmt::format("{} 0 obj\n{}\nendobj\n", k + 1, objects_[k]);
    }
    const std::size_t begin = out.size();
    out += table;
    out += fmt::format("trailer\n<< /Size {} /Root {} 0 R /Info {} 0 R >>\nstartxref\n{}\n%%EOF\n",
                       objects_.size() + 1, catalog, about, begin);
    return out;
  }

 private:
  std::vector<std::string> objects_;
};

/// A page while it is drawn: y grows downward until `PdfPages` turns it.
class PdfCanvas {
 public:
  /// Draws a document of popcut's into a part of the page, as large as fits, in the middle.
  Result<void> draw(std::string_view svg, double x, double y, double width, double height) {
    const std::string plain = with_drawn_letters(svg);
    pugi::xml_document document;
    if (!document.load_buffer(plain.data(), plain.size())) return cannot_draw("it is no SVG");
    const pugi::xml_node root = document.document_element();
    const std::vector<double> box = numbers_in(root.attribute("viewBox").value());
    if (box.size() != 4 || !(box[2] > 0) || !(box[3] > 0)) return cannot_draw("it has no viewBox");
    const double scale = std::min(width / box[2], height / box[3]);
    put("q {:.6g} 0 0 {:.6g} {:.6g} {:.6g} cm\n", scale, scale,
        x + (width - scale * box[2]) / 2 - scale * box[0],
        y + (height - scale * box[3]) / 2 - scale * box[1]);
    clips_.clear();
    auto drawn = inside(root, painted({}, root));
    put("Q\n");
    return drawn;
  }
  template <typename... Given>
  void put(fmt::format_string<Given...> words, Given&&... given) {
    fmt::format_to(std::back_inserter(content), words, std::forward<Given>(given)...);
  }

  std::string content;
  std::map<std::string, std::string> opacities;  ///< names of graphics states, and what they hold

 private:
  Result<void> inside(const pugi::xml_node& node, const Paint& paint) {
    for (const pugi::xml_node& child : node.children())
      if (child.type() == pugi::node_element)
        if (auto drawn = element(child, painted(paint, child)); !drawn) return drawn;
    return {};
  }

  Result<void> element(const pugi::xml_node& node, const Paint& paint) {
    const std::string_view name = node.name();
    if (name == "title" || name == "desc" || name == "metadata") return {};
    if (name == "clipPath") {
      clips_[fmt::format("url(#{})", node.attribute("id").value())] =
          node.child("path").attribute("d").value();
      return {};
    }
    if (name == "defs") return inside(node, paint);
    put("q\n");
    if (auto moved = transform(node.attribute("transform").value()); !moved) return moved;
    if (const auto clip = node.attribute("clip-path")) {
      if (auto along = path(clips_[clip.value()]); !along) return along;
      put("W n\n");
    }
    Result<void> drawn = name == "g" ? inside(node, paint) : shape(name, node, paint);
    put("Q\n");
    return drawn;
  }

  Result<void> transform(std::string_view text) {
    while (!text.empty()) {
      const std::size_t open = text.find('('), close = text.find(')');
      if (open == text.npos || close == text.npos) break;
      const std::string_view word = text.substr(0, open);
      const std::vector<double> n = numbers_in(text.substr(open, close - open));
      if (word.ends_with("translate") && !n.empty())
        put("1 0 0 1 {:.6g} {:.6g} cm\n", n[0], n.size() > 1 ? n[1] : 0.0);
      else if (word.ends_with("scale") && !n.empty())
        put("{:.6g} 0 0 {:.6g} 0 0 cm\n", n[0], n.size() > 1 ? n[1] : n[0]);
      else if (word.ends_with("matrix") && n.size() == 6)
        put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} cm\n", n[0], n[1], n[2], n[3], n[4], n[5]);
      else if (word.ends_with("rotate") && !n.empty())
        rotate(n);
      else
        return cannot_draw(fmt::format("transform {:?} is not known", word));
      text.remove_prefix(close + 1);
    }
    return {};
  }
  void rotate(const std::vector<double>& n) {
    const double turn_rad = n[0] * std::acos(-1.0) / 180, c = std::cos(turn_rad),
                 s = std::sin(turn_rad), x = n.size() > 2 ? n[1] : 0, y = n.size() > 2 ? n[2] : 0;
    put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} cm\n", c, s, -s, c, x - c * x + s * y,
        y - s * x - c * y);
  }

  Result<void> shape(std::string_view name, const pugi::xml_node& node, const Paint& paint) {
    const bool fills = paint.fill != "none", strokes = paint.stroke != "none";
    if (!fills && !strokes) return {};
    if (fills) put("{} rg\n", colour_in(paint.fill));
    if (strokes) {
      put("{} RG {:.6g} w {} J {} j [", colour_in(paint.stroke), paint.width, paint.cap,
          paint.join);
      for (const double dash : paint.dashes) put("{:.6g} ", dash);
      put("] 0 d\n");
    }
    if (paint.fill_opacity < 1 || paint.stroke_opacity < 1) {
      const std::string holds =
          fmt::format("<< /ca {:.4g} /CA {:.4g} >>", paint.fill_opacity, paint.stroke_opacity);
      const auto state = opacities.emplace(holds, fmt::format("G{}", opacities.size())).first;
      put("/{} gs\n", state->second);
    }
    const auto at = [&](const char* word) { return node.attribute(word).as_double(); };
    if (name == "path") {
      if (auto along = path(node.attribute("d").value()); !along) return along;
    } else if (name == "rect") {
      put("{:.6g} {:.6g} {:.6g} {:.6g} re\n", at("x"), at("y"), at("width"), at("height"));
    } else if (name == "line") {
      put("{:.6g} {:.6g} m {:.6g} {:.6g} l\n", at("x1"), at("y1"), at("x2"), at("y2"));
    } else if (name == "circle") {
      circle(at("cx"), at("cy"), at("r"));
    } else {
      return cannot_draw(fmt::format("element {:?} is not known", name));
    }
    put("{}\n", fills && strokes ? "B" : fills ? "f" : "S");
    return {};
  }

  void circle(double x, double y, double r) {
    const double k = 0.5522847498 * r;
    put("{:.6g} {:.6g} m ", x + r, y);
    put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} c ", x + r, y + k, x + k, y + r, x, y + r);
    put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} c ", x - k, y + r, x - r, y + k, x - r, y);
    put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} c ", x - r, y - k, x - k, y - r, x, y - r);
    put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} c h\n", x + k, y - r, x + r, y - k, x + r, y);
  }

  Result<void> path(std::string_view d) {
    std::array<double, 2> at{}, begin{};
    char command = 0;
    while (!d.empty()) {
      const std::size_t next = d.find_first_not_of(" ,\n\t\r");
      if (next == d.npos) break;
      d.remove_prefix(next);
      if ((d[0] >= 'A' && d[0] <= 'Z') || (d[0] >= 'a' && d[0] <= 'z')) {
        command = d[0];
        d.remove_prefix(1);
        if (command == 'Z' || command == 'z') {
          put("h\n");
          at = begin;
          continue;
        }
      }
      const bool relative = command >= 'a';
      const char letter = relative ? static_cast<char>(command - 'a' + 'A') : command;
      std::array<double, 6> n{};
      const std::size_t count = letter == 'C' ? 6 : letter == 'H' || letter == 'V' ? 1 : 2;
      if (std::string_view("MLHVC").find(letter) == std::string_view::npos)
        return cannot_draw(fmt::format("path command {:?} is not known", command));
      for (std::size_t k = 0; k < count; ++k) {
        const auto number = next_number(d);
        if (!number) return cannot_draw("a path ends too early");
        const std::size_t axis = letter == 'V' ? 1 : letter == 'H' ? 0 : k % 2;
        n[k] = *number + (relative ? at[axis] : 0);
      }
      if (letter == 'H') n[1] = at[1];
      if (letter == 'V') n[1] = n[0], n[0] = at[0];
      if (letter == 'C') {
        put("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} c\n", n[0], n[1], n[2], n[3], n[4], n[5]);
        at = {n[4], n[5]};
        continue;
      }
      at = {n[0], n[1]};
      put("{:.6g} {:.6g} {}\n", at[0], at[1], letter == 'M' ? 'm' : 'l');
      if (letter == 'M') begin = at, command = relative ? 'l' : 'L';
    }
    return {};
  }

  std::map<std::string, std::string, std::less<>> clips_;
};

/// A document of pages, each in mm from its upper left corner.
class PdfPages {
 public:
  /// @param xobjects  the resources' entries of images
  void add(const PdfCanvas& canvas, double width_mm, double height_mm,
           std::string_view xobjects = {}) {
    const std::string turned = fmt::format("{0:.8g} 0 0 -{0:.8g} 0 {1:.8g} cm\n", kPoints_per_mm,
                                           kPoints_per_mm * height_mm) +
                               canvas.content;
    const std::size_t content = file_.add_stream("", turned);
    std::string states;
    for (const auto& [holds, name] : canvas.opacities)
      states += fmt::format("/{} {} ", name, holds);
    pages_.push_back(file_.add(fmt::format(
        "<< /Type /Page /Parent {} 0 R /MediaBox [0 0 {:.6g} {:.6g}] /Contents {} 0 R /Resources "
        "<< /ExtGState << {}>> /XObject << {}>> >> >>",
        tree_, kPoints_per_mm * width_mm, kPoints_per_mm * height_mm, content, states, xobjects)));
  }
  /// The number of an image: its pixels on white paper.
  std::size_t add_image(const ColourImage& image) {
    std::string rgb;
    rgb.reserve(3 * image.width * image.height);
    for (std::size_t j = 0; j < image.height; ++j)
      for (std::size_t i = 0; i < image.width; ++i) {
        const std::uint8_t* const p = image.at(i, j);
        for (std::size_t k = 0; k < 3; ++k)
          rgb += static_cast<char>((p[k] * p[3] + 255 * (255 - p[3]) + 127) / 255);
      }
    return file_.add_stream(
        fmt::format("/Type /XObject /Subtype /Image /Width {} /Height {} /ColorSpace /DeviceRGB "
                    "/BitsPerComponent 8",
                    image.width, image.height),
        rgb);
  }
  [[nodiscard]] std::string bytes(std::string_view title) {
    std::string kids;
    for (const std::size_t page : pages_) kids += fmt::format("{} 0 R ", page);
    file_.set(tree_, fmt::format("<< /Type /Pages /Kids [{}] /Count {} >>", kids, pages_.size()));
    const std::size_t catalog = file_.add(fmt::format("<< /Type /Catalog /Pages {} 0 R >>", tree_));
    // UTF-16 would be needed for more than ASCII.
    std::string plain;
    for (const char c : title) plain += c >= 0x20 && c < 0x7F && !std::strchr("()\\", c) ? c : '?';
    const std::size_t about = file_.add(fmt::format("<< /Title ({}) /Creator (popcut) >>", plain));
    return file_.bytes(catalog, about);
  }

 private:
  PdfFile file_;
  std::size_t tree_{file_.reserve()};
  std::vector<std::size_t> pages_;
};

/// The bars to measure, and words beside them, as a drawing.
std::string bars_svg(const ArtworkPage& page) {
  const auto [x, y] = page.bar;
  std::string d = fmt::format("M{0} {1}h{2}M{0} {3}v3M{4} {3}v3", x, y, page.bar_across_mm, y - 1.5,
                              x + page.bar_across_mm);
  if (page.bar_down_mm > 0)
    d += fmt::format("M{0} {1}v{2}M{3} {4}h3", x, y, -page.bar_down_mm, x - 1.5,
                     y - page.bar_down_mm);
  return svg_head(fmt::format("viewBox=\"0 0 {} {}\"", page.size_mm[0], page.size_mm[1])) +
         fmt::format(
             "<path d=\"{}\" fill=\"none\" stroke=\"#000000\" stroke-width=\"0.3\"/>\n"
             "<text x=\"{}\" y=\"{}\" font-size=\"2.8\">{}</text>\n</svg>\n",
             d, x + 2, y + 4.2, xml_escaped(page.words));
}

Result<void> add_artwork(const ArtworkPage& page, PdfPages& pages) {
  PdfCanvas canvas;
  std::string xobjects;
  canvas.put("q {:.8g} 0 0 {:.8g} 0 0 cm\n", page.stretch[0], page.stretch[1]);
  if (page.image != nullptr) {
    const std::size_t image = pages.add_image(*page.image);
    xobjects = fmt::format("/Im {} 0 R ", image);
    const double width = page.pixel_mm * static_cast<double>(page.image->width),
                 height = page.pixel_mm * static_cast<double>(page.image->height);
    canvas.put("q {:.8g} 0 0 {:.8g} {:.8g} {:.8g} cm /Im Do Q\n", width, -height, page.shift_mm.x,
               page.shift_mm.y + height);
  }
  for (const std::string& svg : page.svgs)
    if (auto drawn = canvas.draw(svg, 0, 0, page.svg_mm[0], page.svg_mm[1]); !drawn) return drawn;
  canvas.put("0 0 0 rg\n");
  for (const Box& mark : page.marks)
    canvas.put("{:.6g} {:.6g} {:.6g} {:.6g} re f\n", mark.x0, mark.y0, mark.width(), mark.height());
  if (page.bar_across_mm > 0)
    if (auto drawn = canvas.draw(bars_svg(page), 0, 0, page.size_mm[0], page.size_mm[1]); !drawn)
      return drawn;
  canvas.put("Q\n");
  pages.add(canvas, page.size_mm[0], page.size_mm[1], xobjects);
  return {};
}

}  // namespace

Result<std::string> pdf_of_pages(std::span<const PrintedPage> pages, std::string_view title) {
  PdfPages out;
  for (const PrintedPage& page : pages) {
    PdfCanvas canvas;
    const double margin = page.margin_mm;
    if (auto drawn = canvas.draw(page.svg, margin, margin, page.width_mm - 2 * margin,
                                 page.height_mm - 2 * margin);
        !drawn)
      return tl::unexpected(drawn.error());
    out.add(canvas, page.width_mm, page.height_mm);
  }
  return out.bytes(title);
}

Result<std::string> pdf_of_artwork(std::span<const ArtworkPage> pages, std::string_view title) {
  PdfPages out;
  for (const ArtworkPage& page : pages)
    if (auto added = add_artwork(page, out); !added) return tl::unexpected(added.error());
  return out.bytes(title);
}

}  // namespace popcut
