// SPDX-License-Identifier: MIT
#include "daemon/pictures/pdf_page.hpp"

#include <cairo-svg.h>
#include <poppler.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "daemon/files/late_library.hpp"

namespace popcut::pictures {
namespace {

// NOLINTNEXTLINE(bugprone-macro-parentheses): declares the name
#define POPCUT_FUNCTION(name) decltype(&::name) name = function(#name)

/// The functions of poppler, and those of cairo and GLib, which poppler needs itself.
struct PdfReader : LateLibrary {
  PdfReader() : LateLibrary("libpoppler-glib.so.8", "libpoppler-glib8") {}

  POPCUT_FUNCTION(poppler_document_get_n_pages);
  POPCUT_FUNCTION(poppler_document_get_page);
  POPCUT_FUNCTION(poppler_document_new_from_bytes);
  POPCUT_FUNCTION(poppler_error_quark);
  POPCUT_FUNCTION(poppler_layer_get_title);
  POPCUT_FUNCTION(poppler_layer_hide);
  POPCUT_FUNCTION(poppler_layer_is_visible);
  POPCUT_FUNCTION(poppler_layer_show);
  POPCUT_FUNCTION(poppler_layers_iter_free);
  POPCUT_FUNCTION(poppler_layers_iter_get_child);
  POPCUT_FUNCTION(poppler_layers_iter_get_layer);
  POPCUT_FUNCTION(poppler_layers_iter_new);
  POPCUT_FUNCTION(poppler_layers_iter_next);
  POPCUT_FUNCTION(poppler_page_get_size);
  POPCUT_FUNCTION(poppler_page_get_text);
  POPCUT_FUNCTION(poppler_page_render_for_printing);

  POPCUT_FUNCTION(cairo_create);
  POPCUT_FUNCTION(cairo_destroy);
  POPCUT_FUNCTION(cairo_scale);
  POPCUT_FUNCTION(cairo_status);
  POPCUT_FUNCTION(cairo_status_to_string);
  POPCUT_FUNCTION(cairo_surface_destroy);
  POPCUT_FUNCTION(cairo_surface_finish);
  POPCUT_FUNCTION(cairo_surface_status);
  POPCUT_FUNCTION(cairo_svg_surface_create_for_stream);

  POPCUT_FUNCTION(g_bytes_new_static);
  POPCUT_FUNCTION(g_bytes_unref);
  POPCUT_FUNCTION(g_error_free);
  POPCUT_FUNCTION(g_free);
  POPCUT_FUNCTION(g_object_unref);
};

#undef POPCUT_FUNCTION

const PdfReader& reader() {
  static const PdfReader kReader;
  return kReader;
}

struct Release {
  void operator()(PopplerDocument* owned) const { reader().g_object_unref(owned); }
  void operator()(PopplerPage* owned) const { reader().g_object_unref(owned); }
  void operator()(PopplerLayer* owned) const { reader().g_object_unref(owned); }
  void operator()(PopplerLayersIter* owned) const { reader().poppler_layers_iter_free(owned); }
  void operator()(GBytes* owned) const { reader().g_bytes_unref(owned); }
  void operator()(GError* owned) const { reader().g_error_free(owned); }
  void operator()(char* owned) const { reader().g_free(owned); }
  void operator()(cairo_t* owned) const { reader().cairo_destroy(owned); }
  void operator()(cairo_surface_t* owned) const { reader().cairo_surface_destroy(owned); }
};
template <typename T>
using Owned = std::unique_ptr<T, Release>;

struct Layer {
  Owned<PopplerLayer> layer;
  std::string name;
};

/// All layers that the PDF shows, those within others after them.
void add_layers(PopplerLayersIter* at, std::size_t depth, std::vector<Layer>& out) {
  constexpr std::size_t kDeepest = 32, kMost = 10'000;
  const PdfReader& r = reader();
  for (bool more = at != nullptr; more; more = r.poppler_layers_iter_next(at) != 0) {
    Layer one{Owned<PopplerLayer>(r.poppler_layers_iter_get_layer(at)), {}};
    const bool shown = !one.layer || r.poppler_layer_is_visible(one.layer.get()) != 0;
    if (one.layer && shown) {
      if (const char* const name = r.poppler_layer_get_title(one.layer.get())) one.name = name;
      out.push_back(std::move(one));
    }
    if (!shown || depth >= kDeepest || out.size() >= kMost) continue;
    const Owned<PopplerLayersIter> child(r.poppler_layers_iter_get_child(at));
    add_layers(child.get(), depth + 1, out);
  }
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned size) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

using Lines = std::map<std::string, std::size_t, std::less<>>;

/// Calls `line` with each line of what cairo wrote, which is one element or half of one.
template <typename F>
void each_line(std::string_view text, F line) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

bool is_shape(std::string_view line) {
  return (line.starts_with("<path") || line.starts_with("<rect")) && line.ends_with("/>");
}

/// A shape, whatever number cairo gave to its gradient.
std::string key_of(std::string_view line) {
  std::string key(line);
  for (std::size_t at = key.find("url(#"); at != key.npos; at = key.find("url(#", at + 1))
    key.erase(at + 5, key.find(')', at) - at - 5);
  return key;
}

Lines shapes_in(std::string_view elements) {
  Lines out;
  each_line(elements, [&](std::string_view line) {
    if (is_shape(line)) ++out[key_of(line)];
  });
  return out;
}

/// The same without the shapes in `known`, as often as they are there.
std::string without(std::string_view elements, Lines known) {
  std::string out;
  each_line(elements, [&](std::string_view line) {
    const auto found = is_shape(line) ? known.find(key_of(line)) : known.end();
    if (found != known.end() && found->second > 0) {
      --found->second;
      return;
    }
    out.append(line) += '\n';
  });
  return out;
}

/// What of a page is no line, counted.
struct LeftOut {
  std::size_t letters{}, pictures{}, white{};
};

/// Whether an element is a use of something whose name holds `what`, such as "glyph" and "image".
bool is_use_of(std::string_view line, std::string_view what) {
  const std::size_t use = line.find("<use ");
  if (use == line.npos) return false;
  const std::size_t name = line.find("href=\"#", use);
  return name != line.npos &&
         line.substr(name, line.find('"', name + 6) - name).find(what) != line.npos;
}

/// A white area without a line is paper.
bool is_paper(std::string_view line) {
  return is_shape(line) && line.find("stroke:none") != line.npos &&
         line.find("fill:rgb(100%,100%,100%)") != line.npos;
}

/// The same without letters, pictures and white areas.
std::string only_lines(std::string_view elements, LeftOut& left_out) {
  std::string out;
  bool in_letter = false;
  each_line(elements, [&](std::string_view line) {
    if (line.starts_with("<symbol") && line.find("glyph") != line.npos) in_letter = true;
    const bool skipped = in_letter;
    if (line.starts_with("</symbol>")) in_letter = false;
    if (skipped || line.starts_with("<image ")) return;
    const bool letter = is_use_of(line, "glyph"), picture = is_use_of(line, "image");
    left_out.letters += letter ? 1 : 0;
    left_out.pictures += picture ? 1 : 0;
    left_out.white += is_paper(line) ? 1 : 0;
    if (!letter && !picture && !is_paper(line)) out.append(line) += '\n';
  });
  return out;
}

/// The same with names that no other layer has, and that say nothing (`LayerWords`): "g3-12".
std::string with_own_names(std::string_view elements, std::size_t number) {
  constexpr std::array<std::string_view, 3> kMarks{"id=\"", "href=\"#", "url(#"};
  std::map<std::string, std::size_t, std::less<>> names;
  std::string out;
  for (std::size_t at = 0; at < elements.size();) {
    std::size_t next = elements.npos, size = 0;
    for (const std::string_view mark : kMarks)
      if (const std::size_t found = elements.find(mark, at); found < next)
        next = found, size = mark.size();
    if (next == elements.npos) {
      out += elements.substr(at);
      break;
    }
    const std::size_t from = next + size;
    const std::size_t end = std::min(elements.find_first_of("\")", from), elements.size());
    const auto found =
        names.try_emplace(std::string(elements.substr(from, end - from)), names.size()).first;
    out += elements.substr(at, from - at);
    out += fmt::format("g{}-{}", number, found->second);
    at = end;
  }
  return out;
}

std::string escaped(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      out += c;
  }
  return out;
}

std::string layer_group(std::string_view name, std::string_view elements, std::size_t number) {
  return fmt::format(
      "<g xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
      "inkscape:groupmode=\"layer\" inkscape:label=\"{}\">\n{}</g>\n",
      escaped(name), with_own_names(elements, number));
}

class Drawn {
  /// Units of the SVG in a point: cairo keeps 256 parts of a unit.
  static constexpr double kFine = 16;

 public:
  explicit Drawn(PopplerPage* page) : page_(page) {
    reader().poppler_page_get_size(page_, &width_, &height_);
  }

  /// What the page shows now, as the elements within <svg>, without what is no line.
  Result<std::string> lines(LeftOut& left_out) const {
    const PdfReader& r = reader();
    std::string svg;
    const Owned<cairo_surface_t> surface(
        r.cairo_svg_surface_create_for_stream(append, &svg, kFine * width_, kFine * height_));
    const Owned<cairo_t> cairo(r.cairo_create(surface.get()));
    r.cairo_scale(cairo.get(), kFine, kFine);
    // Else lines are moved to whole points.
    r.poppler_page_render_for_printing(page_, cairo.get());
    cairo_status_t status = r.cairo_status(cairo.get());
    r.cairo_surface_finish(surface.get());
    if (status == CAIRO_STATUS_SUCCESS) status = r.cairo_surface_status(surface.get());
    const std::size_t head = svg.find('>', std::min(svg.find("<svg"), svg.size()));
    const std::size_t end = svg.rfind("</svg>");
    if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
    if (status != CAIRO_STATUS_SUCCESS || head == svg.npos || end == svg.npos || end < head)
      return fail(ErrorKind::Internal, "PDF",
                  fmt::format("cannot be drawn: {}", r.cairo_status_to_string(status)));
    return only_lines(std::string_view(svg).substr(head + 1, end - head - 1), left_out);
  }

  [[nodiscard]] std::string around(std::string_view elements) const {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
        "width=\"{}pt\" height=\"{}pt\" viewBox=\"0 0 {} {}\">{}</svg>\n",
        width_, height_, kFine * width_, kFine * height_, elements);
  }

 private:
  PopplerPage* page_;
  double width_{}, height_{};
};

/// Shows one layer after another, so that what comes with each has its name. A shape on a layer
/// within another one comes with the inner one.
///
/// @param left_out  gets what is left out of the whole page
Result<std::string> layer_by_layer(const Drawn& page, const std::vector<Layer>& layers,
                                   LeftOut& left_out) {
  const PdfReader& r = reader();
  for (const Layer& one : layers) r.poppler_layer_hide(one.layer.get());
  auto drawn = page.lines(left_out);
  if (!drawn) return drawn;
  std::string out = layer_group("no layer", *drawn, 0);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const Lines before = shapes_in(*drawn);
    r.poppler_layer_show(layers[k].layer.get());
    left_out = {};
    drawn = page.lines(left_out);
    if (!drawn) return drawn;
    out += layer_group(layers[k].name, without(*drawn, before), k + 1);
  }
  return out;
}

tl::unexpected<Error> unreadable(Owned<GError> error) {
  const bool locked = error && error->domain == reader().poppler_error_quark() &&
                      error->code == POPPLER_ERROR_ENCRYPTED;
  if (locked)
    return fail(ErrorKind::Malformed, "", "is a PDF with a password; save it without one");
  return fail(ErrorKind::Malformed, "",
              fmt::format("is a PDF that cannot be read ({}); export it again, or save it as SVG",
                          error ? error->message : "poppler does not say why"));
}

}  // namespace

bool is_pdf(std::string_view bytes) { return bytes.starts_with("%PDF-"); }

Result<void> load_pdf_reader() {
  if (reader().fault().empty()) return {};
  return fail(ErrorKind::Internal, "PDF", "cannot be read: " + reader().fault());
}

Result<PdfPage> pdf_page(std::string_view pdf, std::uint64_t page) {
  constexpr std::size_t kMostLayers = 64;
  if (auto loaded = load_pdf_reader(); !loaded) return tl::unexpected(loaded.error());
  const PdfReader& r = reader();
  const Owned<GBytes> bytes(r.g_bytes_new_static(pdf.data(), pdf.size()));
  GError* error = nullptr;
  const Owned<PopplerDocument> document(
      r.poppler_document_new_from_bytes(bytes.get(), nullptr, &error));
  if (!document) return unreadable(Owned<GError>(error));
  const auto pages =
      static_cast<std::uint64_t>(std::max(0, r.poppler_document_get_n_pages(document.get())));
  if (page < 1 || page > pages)
    return fail(ErrorKind::OutOfRange, "/options/pdf-page",
                pages > 1 ? fmt::format("is {}; the PDF has the pages 1 to {}", page, pages)
                          : fmt::format("is {}; the PDF has one page", page));
  const Owned<PopplerPage> wanted(
      r.poppler_document_get_page(document.get(), static_cast<int>(page - 1)));
  if (!wanted) return unreadable(nullptr);
  const Owned<char> text(r.poppler_page_get_text(wanted.get()));
  if (text && std::string_view(text.get()).find("saved without PDF Content") != std::string::npos)
    return fail(ErrorKind::Malformed, "",
                "is an Illustrator file without its drawing as PDF; in Illustrator, save it with "
                "Create PDF Compatible File, or use File > Export > SVG");
  std::vector<Layer> layers;
  const Owned<PopplerLayersIter> first(r.poppler_layers_iter_new(document.get()));
  add_layers(first.get(), 0, layers);
  const Drawn drawn(wanted.get());
  LeftOut left_out;
  const bool has_names = !layers.empty() && layers.size() <= kMostLayers;
  auto elements = has_names ? layer_by_layer(drawn, layers, left_out) : drawn.lines(left_out);
  if (!elements) return tl::unexpected(elements.error());
  PdfPage out;
  out.svg = drawn.around(has_names ? std::move(*elements) : with_own_names(*elements, 0));
  const auto warn = [&](const char* code, std::string message) {
    out.warnings.push_back({code, std::move(message)});
  };
  if (pages > 1)
    warn("other_pages",
         fmt::format("page {} of {} is read; for another one use `pdf-page`", page, pages));
  if (layers.size() > kMostLayers)
    warn("layers_ignored", fmt::format("the PDF has {} layers, and popcut tells at most {} apart: "
                                       "their names are not used",
                                       layers.size(), kMostLayers));
  const auto left = [&](const char* code, std::size_t count, const char* one, const char* several,
                        const char* advice) {
    if (count > 0)
      warn(code, fmt::format("{} {} left out{}", count, count == 1 ? one : several, advice));
  };
  left("text_left_out", left_out.letters, "letter of text is", "letters of text are",
       "; turn text that is to be cut into paths in the program that made the PDF");
  left("pictures_left_out", left_out.pictures, "picture is", "pictures are",
       "; a picture has no lines to cut");
  left("white_left_out", left_out.white, "white area is", "white areas are",
       ", since it has no line");
  return out;
}

}  // namespace popcut::pictures
