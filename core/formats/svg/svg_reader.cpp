// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <deque>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "core/formats/svg/svg_shape.hpp"
#include "core/formats/svg/svg_strokes.hpp"
#include "core/formats/svg/svg_style.hpp"
#include "core/formats/svg/svg_weld.hpp"
#include "core/formats/svg/syntax/svg_transform.hpp"

namespace popcut {
namespace {

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Elements that draw nothing where they are defined.
bool is_definition(std::string_view name) {
  return is_one_of(name, {"defs", "title", "desc", "metadata", "symbol", "clipPath", "mask",
                          "marker", "pattern", "linearGradient", "radialGradient", "meshgradient",
                          "filter", "style", "view", "hatch", "cursor", "color-profile"});
}

// Whether a fill is nearer to black than to white.
bool is_dark(const SvgStyle& style) {
  const std::uint32_t rgb =
      style.fill.kind == SvgPaint::Kind::Current ? style.colour : style.fill.rgb;
  return (rgb >> 16) + (rgb >> 8 & 0xFF) + (rgb & 0xFF) < 3 * 0x80;
}

bool is_animation(std::string_view name) {
  return is_one_of(
      name, {"animate", "set", "animateTransform", "animateMotion", "animateColor", "discard"});
}

// What keeps viewers from showing an element.
enum class Unmet { Nothing, Language, Needs };

// Whether a list of languages has English: "de, en-US".
bool has_english(std::string_view list) {
  while (!list.empty()) {
    const std::string_view one = trimmed(take_word(list, ","));
    if (same_word(one.substr(0, 2), "en") && (one.size() == 2 || one[2] == '-')) return true;
  }
  return false;
}

// Whether SVG 1.0, 1.1 or Tiny 1.2 names a feature (SVG 1.1, appendix N). What is not asked for by
// its full name is none.
bool is_feature(std::string_view name) {
  constexpr std::string_view
      kSvg11 = "http://www.w3.org/TR/SVG11/feature#",
      kNames =
          " SVG SVGDOM SVG-static SVGDOM-static SVG-animation SVGDOM-animation SVG-dynamic "
          "SVGDOM-dynamic CoreAttribute Structure BasicStructure ContainerAttribute "
          "ConditionalProcessing Image Style ViewportAttribute Shape Text BasicText PaintAttribute "
          "BasicPaintAttribute OpacityAttribute GraphicsAttribute BasicGraphicsAttribute Marker "
          "ColorProfile Gradient Pattern Clip BasicClip Mask Filter BasicFilter "
          "DocumentEventsAttribute GraphicalEventsAttribute AnimationEventsAttribute Cursor "
          "Hyperlinking XlinkAttribute ExternalResourcesRequired View Script Animation Font "
          "BasicFont "
          "Extensibility ";
  if (name.starts_with(kSvg11)) {
    const std::string_view own = name.substr(kSvg11.size());
    const std::size_t at = own.empty() ? own.npos : kNames.find(fmt::format(" {} ", own));
    return at != own.npos;
  }
  return name.starts_with("http://www.w3.org/Graphics/SVG/feature/") ||
         name.starts_with("org.w3c.svg") || name.starts_with("org.w3c.dom.svg");
}

// Whether an element is shown to readers of English by a viewer without extensions, in a <switch>
// or not (SVG 2, section 5.8). Only SVG 1.1 has features; those that it names are taken as met.
Unmet unmet_of(const pugi::xml_node& node) {
  if (node.attribute("requiredExtensions")) return Unmet::Needs;
  if (const auto features = node.attribute("requiredFeatures")) {
    std::string_view rest = features.value();
    for (std::string_view one; !(one = take_word(rest = trimmed(rest), kBlanks)).empty();)
      if (!is_feature(one)) return Unmet::Needs;
  }
  const auto language = node.attribute("systemLanguage");
  return language && !has_english(language.value()) ? Unmet::Language : Unmet::Nothing;
}

bool is_before_0_92(std::string_view version) {
  if (!version.starts_with("0.")) return false;
  int minor = 0;
  const std::string_view digits = version.substr(2);
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), minor);
  return read.ec == std::errc() && minor < 92;
}

// Where an element is drawn.
struct Place {
  SvgTransform to_page;
  SvgFrame frame;
  const SvgClip* clip{};  ///< frames
  const SvgClipPath* clips{};
  int depth{};
};

class SvgReader {
 public:
  SvgReader(const SvgText& text, const SvgReadOptions& options)
      : text_(text),
        options_(options),
        user_mm_(25.4 / options.dpi),
        steps_(options.limits.steps),
        pens_(options.pens),
        styles_(text, options.profile, user_mm_, text.by_illustrator, notes_, names_, steps_,
                pens_),
        purposes_(text, options.profile, notes_, names_, pens_, options.looks),
        strokes_(work_, options.limits.points) {}

  Result<LineWork> read(const pugi::xml_node& root, bool has_sheets) {
    const std::string_view name = root.name();
    const std::string prefix(name.substr(0, name.size() - 3));  // with its colon
    work_.has_page = true;
    work_.name = root.child_value((prefix + "title").c_str());
    work_.dashed = std::string_view(root.attribute("data-popcut").value()) == "dashes";
    if (text_.has_foreign_sheet) notes_.add(SvgNote::ForeignSheet, [] { return std::string(); });
    if (has_sheets)
      if (auto done = read_svg_sheets(text_, root, styles_.sheets(), notes_); !done)
        return tl::unexpected(done.error());
    Place place;
    if (auto done = read_page(root, place); !done) return tl::unexpected(done.error());
    SvgStyle style;
    const auto element = styles_.read(root, SvgStyle{}, style);
    if (!element) return tl::unexpected(element.error());
    if (style.display_none) note(SvgNote::Hidden, root);
    tell_motion(root);
    if (!style.overflows) sheet_mm_ = page_mm_;
    if (auto done = transform(*element, style, place); !done) return tl::unexpected(done.error());
    SvgClipPath clip;
    if (auto done = enter_clip(*element, style, place, clip); !done)
      return tl::unexpected(done.error());
    if (!style.display_none)
      if (auto done = children(root, place, style); !done) return tl::unexpected(done.error());
    if (auto clear = purposes_.clear(); !clear) return tl::unexpected(clear.error());
    purposes_.tell_looks(work_);
    if (auto done = settle_fills(root); !done) return tl::unexpected(done.error());
    add_warnings();
    work_.looks = pens_.seen();
    return std::move(work_);
  }

 private:
  void note(SvgNote what, const pugi::xml_node& node, std::size_t count = 1) {
    notes_.add(
        what, [&] { return svg_where(text_, node); }, count);
  }

  [[nodiscard]] tl::unexpected<Error> wrong(const pugi::xml_node& node, const Error& error) const {
    std::string place = svg_place(text_, node.offset_debug() - 1);
    const std::string_view id = node.attribute("id").value();
    if (!id.empty()) place += fmt::format(", id \"{}\"", id.substr(0, 60));
    return fail(error.kind, std::move(place), error.detail, error.reason);
  }
  [[nodiscard]] tl::unexpected<Error> wrong(const pugi::xml_node& node, std::string detail,
                                            ErrorKind kind = ErrorKind::Malformed) const {
    return wrong(node, Error{kind, "", std::move(detail)});
  }

  // What an element takes, as characters: one that is repeated takes longer than what it repeats
  // has bytes.
  static constexpr std::size_t kElement = 16, kClip = 100, kRepeated = 400;
  [[nodiscard]] std::size_t steps_of_element() const {
    return used_.empty() ? kElement : kRepeated;
  }

  // Uses up work. If none is left, something in the drawing repeats far too often.
  Result<void> spend(const pugi::xml_node& node, std::size_t steps) {
    if (steps < steps_) {
      steps_ -= steps;
      return {};
    }
    steps_ = 0;
    return wrong(node, too_much("the drawing repeats or compares too much here; use fewer <use> "
                                "elements, selectors and classes"));
  }

  // Before 0.92, a user unit of Inkscape was 1/90 inch; a viewBox says what it is.
  void tell_old_inkscape(const pugi::xml_node& root) {
    const std::string_view version = root.attribute("inkscape:version").value();
    const bool older = version.empty() && root.attribute("sodipodi:version");
    const auto box = parse_svg_view_box(root.attribute("viewBox").value());
    const auto width = parse_svg_length(root.attribute("width").value());
    // With a viewBox and a size in px, the size is what was meant otherwise.
    if (box && (!width || width->unit != SvgLength::Unit::User)) return;
    if (options_.dpi != 96.0 || !(older || is_before_0_92(version))) return;
    work_.warnings.push_back(
        {.code = "old_inkscape",
         .message = fmt::format(
             "Inkscape {} made the drawing, and before 0.92 it made 90 units of an inch, not 96; "
             "use `svg-dpi` 90 for its true size",
             older ? "before 0.4" : version.substr(0, version.find(' '))),
         .spoils = true});
  }

  // Animations and scripts count wherever they stand, in shapes and definitions too.
  void tell_motion(const pugi::xml_node& root) {
    each_svg_element(root, [&](const pugi::xml_node& node) {
      std::string_view name = node.name();
      const std::size_t colon = name.find(':');
      if (colon != std::string_view::npos) name.remove_prefix(colon + 1);
      const bool moves = is_animation(name);
      if (!moves && name != "script") return;
      if (colon == std::string_view::npos || !styles_.svg_name(node).empty())
        note(moves ? SvgNote::Moving : SvgNote::Scripted, node);
    });
  }

  // Finds the map from user units of the root to mm on the page.
  Result<void> read_page(const pugi::xml_node& root, Place& place) {
    bool has_unit = false;
    const auto size = [&](const char* name) -> std::optional<double> {
      const auto length = parse_svg_length(root.attribute(name).value());
      if (!length || length->unit == SvgLength::Unit::Percent) return std::nullopt;
      has_unit = has_unit || length->unit == SvgLength::Unit::Mm;
      return user_units(*length, {user_mm_, 0.0, {}}) * user_mm_;
    };
    const auto width = size("width"), height = size("height");
    if (!has_unit)
      work_.warnings.push_back(
          {.code = "no_unit",
           .message = fmt::format(
               "the drawing gives no unit of length; {:g} user units are read as one inch{}",
               options_.dpi,
               text_.by_illustrator && options_.dpi == 96.0
                   ? ", but Illustrator makes 72 of an inch; use `svg-dpi` 72 for its true size"
                   : ""),
           .spoils = true});
    if ((width && !(*width > 0.0)) || (height && !(*height > 0.0)))
      return wrong(root, "width and height must be positive");
    tell_old_inkscape(root);
    place.to_page = {user_mm_, 0, 0, user_mm_, 0, 0};
    place.frame = {width.value_or(100.0) / user_mm_, height.value_or(100.0) / user_mm_};
    page_mm_ = {width.value_or(0.0), height.value_or(0.0)};
    if (!root.attribute("viewBox")) return {};
    const auto box = parse_svg_view_box(root.attribute("viewBox").value());
    if (!box) return wrong(root, "viewBox: must be four numbers");
    const auto& v = *box;
    if (!(v[2] > 0.0 && v[3] > 0.0))
      return wrong(root, "viewBox: its width and height must be positive");
    const double unit = width ? *width / v[2] : height ? *height / v[3] : user_mm_;
    page_mm_ = {width.value_or(unit * v[2]), height.value_or(unit * v[3])};
    place.to_page = fit_svg_view_box(v, page_mm_[0], page_mm_[1],
                                     root.attribute("preserveAspectRatio").value());
    place.frame = {v[2], v[3]};
    return {};
  }

  Result<void> children(const pugi::xml_node& parent, const Place& place, const SvgStyle& style) {
    if (place.depth > options_.limits.depth)
      return wrong(
          parent,
          fmt::format("groups or <use> elements are nested more than {} deep; ungroup some",
                      options_.limits.depth),
          ErrorKind::OutOfRange);
    for (const pugi::xml_node& node : parent.children()) {
      if (node.type() != pugi::node_element) continue;
      if (auto done = element(node, place, style); !done) return done;
    }
    return {};
  }

  Result<void> element(const pugi::xml_node& node, const Place& outer, const SvgStyle& inherited) {
    if (auto done = spend(node, steps_of_element()); !done) return done;
    SvgStyle style;
    const auto read = styles_.read(node, inherited, style);
    if (!read) return wrong(node, read.error());
    const SvgElement& e = *read;
    if (e.name.empty() || is_definition(e.name)) return {};
    if (is_animation(e.name) || e.name == "script") return {};
    if (style.display_none) {
      note(SvgNote::Hidden, node);
      return {};
    }
    if (!is_shown(node)) return {};
    const bool is_shape = is_svg_shape(e.name);
    if (!is_shape && !is_one_of(e.name, {"g", "a", "switch", "svg", "use"})) {
      if (!style.hidden) notes_.add_element(e.name, [&] { return svg_where(text_, node); });
      return {};
    }
    if (style.masked) note(SvgNote::Masked, node);
    if (style.filtered) note(SvgNote::Filtered, node);
    Place place = outer;
    place.depth += is_shape ? 0 : 1;
    if (auto done = transform(e, style, place); !done) return done;
    SvgClipPath clip;
    if (auto done = enter_clip(e, style, place, clip); !done) return done;
    return content(e, place, style);
  }

  // Whether viewers show an element; if not, this adds a note.
  bool is_shown(const pugi::xml_node& node) {
    const Unmet unmet = unmet_of(node);
    if (unmet == Unmet::Nothing) return true;
    note(unmet == Unmet::Needs ? SvgNote::Needs : SvgNote::Language, node);
    return false;
  }

  // Applies an element's own transform to its place.
  Result<void> transform(const SvgElement& e, const SvgStyle& style, Place& place) {
    if (!e.has_transform) return {};
    const auto own = parse_svg_transform(e.transform);
    if (!own)
      return wrong(e.node,
                   fmt::format("the transform \"{}\" cannot be read; use matrix, translate, "
                               "scale, rotate, skewX or skewY with numbers",
                               e.transform.substr(0, 60)));
    const double x = user_units(style.origin.x, {user_mm_, place.frame.width, style.font});
    const double y = user_units(style.origin.y, {user_mm_, place.frame.height, style.font});
    if (style.own_box) note(SvgNote::OwnBox, e.node);
    place.to_page =
        place.to_page * SvgTransform{1, 0, 0, 1, x, y} * *own * SvgTransform{1, 0, 0, 1, -x, -y};
    return {};
  }

  Result<void> content(const SvgElement& e, const Place& place, const SvgStyle& style) {
    if (is_svg_shape(e.name)) return shape(e, place, style);
    if (e.name == "use") return use(e, place, style);
    if (e.name == "svg") return framed(e.node, e.node, place, style);
    if (e.name == "switch") return chosen(e.node, place, style);
    return children(e.node, place, style);
  }

  // Adds the clip path of an element, if it has one, to its place; `clip` must live as long.
  Result<void> enter_clip(const SvgElement& e, const SvgStyle& style, Place& place,
                          SvgClipPath& clip) {
    if (style.clip == 0 || measured_ != nullptr) return {};
    auto region = clip_region(e, style, place);
    if (!region) return tl::unexpected(region.error());
    if (*region == nullptr) return {};
    clip = {*region, place.clips};
    place.clips = &clip;
    return {};
  }

  // The clip path of an element on the page; null if it cannot be applied, which is noted.
  Result<const SvgRegion*> clip_region(const SvgElement& e, const SvgStyle& style,
                                       const Place& place) {
    const SvgTransform& t = place.to_page;
    const std::string key =
        fmt::format("{} {} {} {} {} {} {} {} {}", t.a, t.b, t.c, t.d, t.e, t.f, place.frame.width,
                    place.frame.height, styles_.clip(style.clip));
    if (const auto known = known_clips_.find(key); known != known_clips_.end())
      return known->second;
    SvgRegion region;
    bool depends = false;  // on the element
    const auto part = clip_part(e, style, place, region, depends);
    if (!part) return tl::unexpected(part.error());
    if (!*part) return nullptr;
    region.finish(**part);
    const SvgRegion* found = &regions_.emplace_back(std::move(region));
    if (!depends) known_clips_.emplace(key, found);
    return found;
  }

  using ClipPart = std::optional<SvgRegion::Part>;

  // Adds the clip path that an element refers to to `region`; no part if it cannot be applied.
  Result<ClipPart> clip_part(const SvgElement& e, const SvgStyle& style, const Place& outer,
                             SvgRegion& region, bool& depends) {
    const std::string id = styles_.clip(style.clip);
    const pugi::xml_node* found = id.empty() ? nullptr : find_id(id, e.node);
    if (found == nullptr || styles_.svg_name(*found) != "clipPath") {
      note(id.empty() ? SvgNote::ClipUnread : SvgNote::ClipMissing, e.node);
      return ClipPart{};
    }
    const pugi::xml_node target = *found;
    if (auto done = spend(target, kClip); !done) return tl::unexpected(done.error());
    if (std::find(used_.begin(), used_.end(), target) != used_.end() ||
        outer.depth > options_.limits.depth)
      return wrong(
          e.node, fmt::format("clip path {} refers to itself; break the circle", id.substr(0, 60)));
    SvgStyle own;
    const auto read = styles_.read(target, style_around(target), own);
    if (!read) return wrong(target, read.error());
    Place place = outer;
    ++place.depth;
    if (std::string_view(target.attribute("clipPathUnits").value()) == "objectBoundingBox") {
      depends = true;
      const auto box = measure(e, outer, style);
      if (!box) return tl::unexpected(box.error());
      if (!(box->x1 > box->x0 && box->y1 > box->y0)) return ClipPart{region.add_any({})};
      place.to_page =
          place.to_page * SvgTransform{box->width(), 0, 0, box->height(), box->x0, box->y0};
    }
    if (auto done = transform(*read, own, place); !done) return tl::unexpected(done.error());
    used_.push_back(target);
    auto part = clip_content(*read, own, place, region, depends);
    used_.pop_back();
    return part;
  }

  // The shapes in a <clipPath>, within its own clip path.
  Result<ClipPart> clip_content(const SvgElement& e, const SvgStyle& style, const Place& place,
                                SvgRegion& region, bool& depends) {
    std::vector<SvgRegion::Part> shapes;
    for (const pugi::xml_node& node : e.node.children()) {
      if (node.type() != pugi::node_element) continue;
      auto part = clip_shape(node, place, style, region, depends);
      if (!part || !*part) return part;
      shapes.push_back(**part);
    }
    return within_clip(e, style, place, region.add_any(std::move(shapes)), region, depends);
  }

  // `part` within the clip path that an element in a clip path has itself.
  Result<ClipPart> within_clip(const SvgElement& e, const SvgStyle& style, const Place& place,
                               SvgRegion::Part part, SvgRegion& region, bool& depends) {
    if (style.clip == 0) return ClipPart{part};
    auto around = clip_part(e, style, place, region, depends);
    if (!around || !*around) return around;
    return ClipPart{region.add_all({part, **around})};
  }

  // A shape in a <clipPath>, or the <use> of one.
  Result<ClipPart> clip_shape(const pugi::xml_node& node, Place place, const SvgStyle& inherited,
                              SvgRegion& region, bool& depends) {
    if (auto done = spend(node, kClip); !done) return tl::unexpected(done.error());
    SvgStyle style;
    const auto read = styles_.read(node, inherited, style);
    if (!read) return wrong(node, read.error());
    const SvgElement& e = *read;
    if (e.name.empty() || is_definition(e.name) || is_animation(e.name) || style.display_none ||
        !is_shown(node))
      return ClipPart{region.add_any({})};
    if (auto done = transform(e, style, place); !done) return tl::unexpected(done.error());
    if (e.name == "use") {
      const std::string_view href = trimmed(e.href);
      const pugi::xml_node* target =
          href.starts_with('#') ? find_id(href.substr(1), node) : nullptr;
      if (target == nullptr || !is_svg_shape(styles_.svg_name(*target))) {
        note(SvgNote::ClipUnread, node);
        return ClipPart{};
      }
      const auto at = use_offset(e, place, style);
      if (!at) return tl::unexpected(at.error());
      Place inner = place;
      inner.to_page = place.to_page * *at;
      auto part = clip_shape(*target, inner, style, region, depends);
      if (!part || !*part) return part;
      return within_clip(e, style, place, **part, region, depends);
    }
    if (!is_svg_shape(e.name)) {
      note(SvgNote::ClipUnread, node);
      return ClipPart{};
    }
    if (style.hidden || !place.to_page.inverse()) return ClipPart{region.add_any({})};
    SvgLines lines;
    if (auto done = outline(e, place, style, true, lines); !done)
      return tl::unexpected(done.error());
    if (region.edges() + lines.points.size() > SvgRegion::kMostEdges)
      return wrong(node,
                   fmt::format("a clip path has more than {} points; simplify it in the editor",
                               SvgRegion::kMostEdges),
                   ErrorKind::OutOfRange);
    return within_clip(e, style, place,
                       region.add_shape(moved(lines, place.to_page), style.clip_even_odd), region,
                       depends);
  }

  // The style that `node` inherits where it stands.
  SvgStyle style_around(const pugi::xml_node& node) {
    std::vector<pugi::xml_node> parents;
    for (auto parent = node.parent(); parent.type() == pugi::node_element; parent = parent.parent())
      parents.push_back(parent);
    const SvgNotes before = notes_;  // they are noted where they are drawn
    SvgStyle style;
    for (auto parent = parents.rbegin(); parent != parents.rend(); ++parent) {
      SvgStyle own;
      if (const auto read = styles_.read(*parent, style, own); read && !read->name.empty())
        style = own;
    }
    notes_ = before;
    return style;
  }

  // The bounding box of an element's content in its own user units, without strokes and clips.
  Result<Box> measure(const SvgElement& e, const Place& place, const SvgStyle& style) {
    const auto back = place.to_page.inverse();
    Box box;
    if (!back) return box;
    const SvgNotes before = notes_;
    measured_ = &box;
    to_measured_ = *back;
    auto done = content(e, place, style);
    measured_ = nullptr;
    notes_ = before;
    if (!done) return tl::unexpected(done.error());
    return box;
  }

  Result<double> scale_of(const SvgElement& e, const Place& place) {
    const double scale = place.to_page.largest_scale();
    if (!std::isfinite(scale))
      return wrong(e.node, "the transform is too large; use numbers below 1e100",
                   ErrorKind::OutOfRange);
    return scale;
  }

  // The outline of a shape in its own units; `closes`: as a fill.
  Result<void> outline(const SvgElement& e, const Place& place, const SvgStyle& style, bool closes,
                       SvgLines& lines) {
    const auto scale = scale_of(e, place);
    if (!scale) return tl::unexpected(scale.error());
    const std::string_view points = e.node.attribute("points").value();
    if (auto done = spend(e.node, e.d.size() + points.size()); !done) return done;
    const SvgOutlining how{
        place.frame, user_mm_, style.font, options_.tolerance_mm / *scale, options_.limits.points,
        closes};
    if (auto done = outline_of(e.node, e.name, e.d, how, lines); !done)
      return wrong(e.node, done.error());
    return spend(e.node, lines.points.size());
  }

  // The first child of a <switch> that viewers show. A note tells of children for other languages.
  // None tells of children that need an extension: programs put these before what viewers can show.
  Result<void> chosen(const pugi::xml_node& parent, const Place& place, const SvgStyle& style) {
    for (const pugi::xml_node& node : parent.children()) {
      if (node.type() != pugi::node_element) continue;
      const Unmet unmet = unmet_of(node);
      if (unmet == Unmet::Language) note(SvgNote::Language, node);
      if (unmet == Unmet::Nothing) return element(node, place, style);
    }
    return {};
  }

  // The content of an <svg> or <symbol>; `sized` has its width and height.
  Result<void> framed(const pugi::xml_node& node, const pugi::xml_node& sized, Place place,
                      const SvgStyle& style) {
    std::array<double, 4> v{};  // x, y, width, height
    constexpr std::array<const char*, 4> kNames{"x", "y", "width", "height"};
    for (std::size_t i = 0; i < 4; ++i) {
      const double whole = i % 2 == 0 ? place.frame.width : place.frame.height;
      const pugi::xml_node& from = i >= 2 && sized.attribute(kNames[i]) ? sized : node;
      const auto value =
          svg_attribute(from, kNames[i], i < 2 ? 0.0 : whole, {user_mm_, whole, style.font});
      if (!value) return wrong(from, value.error());
      v[i] = *value;
    }
    if (!(v[2] > 0.0 && v[3] > 0.0)) {
      note(SvgNote::Empty, node);
      return {};
    }
    place.to_page = place.to_page * SvgTransform{1, 0, 0, 1, v[0], v[1]};
    place.frame = {v[2], v[3]};
    Box box{0, 0, v[2], v[3]};
    const SvgTransform frame_to_page = place.to_page;
    if (const auto attribute = node.attribute("viewBox")) {
      const auto view = parse_svg_view_box(attribute.value());
      if (!view || (*view)[2] < 0.0 || (*view)[3] < 0.0)
        return wrong(node, "viewBox: must be four numbers with a positive width and height");
      if ((*view)[2] == 0.0 || (*view)[3] == 0.0) {
        note(SvgNote::Empty, node);
        return {};
      }
      place.to_page =
          place.to_page *
          fit_svg_view_box(*view, v[2], v[3], node.attribute("preserveAspectRatio").value());
      place.frame = {(*view)[2], (*view)[3]};
    }
    SvgClip clip;
    const auto back = frame_to_page.inverse();
    if (back && !style.overflows) {
      clip = {frame_to_page, *back, box, place.clip};
      place.clip = &clip;
    }
    return children(node, place, style);
  }

  const pugi::xml_node* find_id(std::string_view id, const pugi::xml_node& any) {
    if (!std::exchange(ids_read_, true))
      each_svg_element(any.root(), [&](const pugi::xml_node& node) {
        if (const auto attribute = node.attribute("id")) ids_.try_emplace(attribute.value(), node);
      });
    const auto found = ids_.find(id);
    return found == ids_.end() ? nullptr : &found->second;
  }

  Result<void> use(const SvgElement& e, Place place, const SvgStyle& style) {
    const std::string_view href = trimmed(e.href);
    if (!href.empty() && href[0] != '#') {
      note(SvgNote::ForeignUse, e.node);
      return {};
    }
    const pugi::xml_node* target = href.empty() ? nullptr : find_id(href.substr(1), e.node);
    if (target == nullptr) {
      note(SvgNote::MissingUse, e.node);
      return {};
    }
    if (std::find(used_.begin(), used_.end(), *target) != used_.end())
      return wrong(e.node, fmt::format("<use> of {} refers to itself; break the circle",
                                       href.substr(0, 60)));
    if (place.depth > options_.limits.depth)
      return wrong(e.node,
                   fmt::format("<use> elements are nested more than {} deep; ungroup some",
                               options_.limits.depth),
                   ErrorKind::OutOfRange);
    const auto at = use_offset(e, place, style);
    if (!at) return tl::unexpected(at.error());
    place.to_page = place.to_page * *at;
    used_.push_back(*target);
    auto done = used(*target, e.node, place, style);
    used_.pop_back();
    return done;
  }

  // By how much a <use> moves what it shows.
  Result<SvgTransform> use_offset(const SvgElement& e, const Place& place, const SvgStyle& style) {
    SvgTransform at;
    for (const bool is_x : {true, false}) {
      const double whole = is_x ? place.frame.width : place.frame.height;
      const auto value =
          svg_attribute(e.node, is_x ? "x" : "y", 0.0, {user_mm_, whole, style.font});
      if (!value) return wrong(e.node, value.error());
      (is_x ? at.e : at.f) = *value;
    }
    return at;
  }

  Result<void> used(const pugi::xml_node& target, const pugi::xml_node& use_node, Place place,
                    const SvgStyle& inherited) {
    const std::string_view name = styles_.svg_name(target);
    if (name != "symbol" && name != "svg") return element(target, place, inherited);
    if (auto done = spend(target, steps_of_element()); !done) return done;
    SvgStyle style;
    const auto read = styles_.read(target, inherited, style);
    if (!read) return wrong(target, read.error());
    if (style.display_none && name == "svg") {
      note(SvgNote::Hidden, target);
      return {};
    }
    if (!is_shown(target)) return {};
    if (style.masked) note(SvgNote::Masked, target);
    if (has_point(target)) note(SvgNote::SymbolPoint, target);
    if (auto done = transform(*read, style, place); !done) return done;
    SvgClipPath clip;
    if (auto done = enter_clip(*read, style, place, clip); !done) return done;
    return framed(target, use_node, place, style);
  }

  // Whether a symbol has a point that is to lie where it is used (SVG 2, section 5.6).
  static bool has_point(const pugi::xml_node& symbol) {
    const auto is_set = [&](const char* name) {
      const auto point = parse_svg_length(symbol.attribute(name).value());
      return symbol.attribute(name) && (!point || point->value != 0.0);
    };
    return is_set("refX") || is_set("refY");
  }

  Result<void> shape(const SvgElement& e, const Place& place, const SvgStyle& style) {
    if (measured_ != nullptr) {
      lines_.clear();
      if (auto done = outline(e, place, style, false, lines_); !done) return done;
      const SvgTransform to_measured = to_measured_ * place.to_page;
      for (const PagePoint& p : lines_.points) measured_->add(to_measured(p));
      return {};
    }
    if (style.hidden) {
      note(SvgNote::Hidden, e.node);
      return {};
    }
    SvgDashes dashes;
    if (style.dashes != 0)
      dashes = svg_dashes(styles_.dashes(style.dashes), style.dash_offset,
                          {user_mm_, frame_diagonal(place.frame), style.font});
    auto purpose = purposes_.of(e, style, dashes);
    if (!purpose) return {};
    if (!purpose->use) {
      note(SvgNote::LeftOut, e.node);
      return {};
    }
    if (const auto scale = scale_of(e, place); !scale) return tl::unexpected(scale.error());
    if (!place.to_page.inverse()) {
      note(SvgNote::Squashed, e.node);
      return {};
    }
    if (style.marked && !is_one_of(e.name, {"rect", "circle", "ellipse"}))
      note(SvgNote::Marked, e.node);
    // What a fill hides of other shapes, its stroke does not bring back.
    const bool stroked = !purpose->fill;
    const bool white = style.stroke.kind == SvgPaint::Kind::Colour && style.stroke.rgb == 0xFFFFFF;
    if (stroked && white && options_.profile.asks && !style.has_layer && !style.has_assignment)
      note(SvgNote::White, e.node);
    if (options_.weld && purpose->use && is_cut(*purpose->use) && is_area(e, style))
      purpose->fill = true;
    lines_.clear();
    if (auto done = outline(e, place, style, purpose->fill, lines_); !done) return done;
    const PenOperation operation{*purpose->use, purpose->pen};
    if (purpose->fill) return add_fill(e, place, style, operation, stroked);
    const std::size_t first = work_.lines.size();
    // Many programs leave the fill out and mean the stroke alone.
    const bool area =
        is_area(e, style) && style.fill_said && is_cut(operation) && dashes.lengths.empty();
    auto done = add_stroke(e, place, style, operation, std::move(dashes));
    const bool closed =
        std::all_of(work_.lines.begin() + static_cast<std::ptrdiff_t>(first), work_.lines.end(),
                    [&](const DrawnLine& line) { return popcut::closed(work_.points_of(line)); });
    if (done && area && closed && work_.lines.size() > first) add_shape(e, style, first);
    return done;
  }

  static bool is_area(const SvgElement& e, const SvgStyle& style) {
    return !style.fill_clear && style.fill.kind != SvgPaint::Kind::None && e.name != "line";
  }

  // A filled shape that is cut, of the lines from `first`.
  void add_shape(const SvgElement& e, const SvgStyle& style, std::size_t first) {
    if (shapes_.empty()) first_shape_ = svg_where(text_, e.node);
    shapes_.push_back({first, work_.lines.size() - first, style.fill_even_odd});
  }

  Result<void> add(const SvgElement& e, const Place& place, const SvgLines& lines,
                   const SvgTransform& to_page, PenOperation operation) {
    const std::size_t first = work_.lines.size();
    const auto added = strokes_.add(lines, to_page, operation);
    if (!added) return wrong(e.node, added.error());
    if (*added == 0) note(SvgNote::Empty, e.node);
    if (place.clip != nullptr && *added > 0)
      if (const std::size_t count = strokes_.clip(*place.clip, first); count > 0)
        note(SvgNote::OutOfFrame, e.node, count);
    std::size_t clipped = 0;
    for (const SvgClipPath* clip = place.clips; clip != nullptr; clip = clip->around)
      clipped = std::max(clipped, strokes_.clip(*clip->region, first, steps_));
    if (clipped > 0) note(SvgNote::Clipped, e.node, clipped);
    // Dashes are parts of one line.
    if (const std::size_t count = std::min(beyond_page(first), lines_.size()); count > 0)
      note(SvgNote::BeyondPage, e.node, count);
    return place.clips == nullptr ? Result<void>{} : spend(e.node, 0);
  }

  Result<void> add_stroke(const SvgElement& e, const Place& place, const SvgStyle& style,
                          PenOperation operation, SvgDashes dashes) {
    const bool whole = is_fold(operation) || operation == Operation::Score;
    if (dashes.lengths.empty() || whole || lines_.size() == 0)
      return add(e, place, lines_, place.to_page, operation);
    SvgTransform to_page = place.to_page;
    double scale = 1.0;
    if (style.non_scaling) {
      // Dashes are lengths on the page: the pen does not scale with the shape.
      lines_ = moved(lines_, to_page);
      to_page = {};
      scale = user_mm_;
    }
    if (const auto said = parse_svg_length(e.node.attribute("pathLength").value());
        said && said->unit == SvgLength::Unit::User && said->value >= 0.0) {
      // Dashes are parts of the length that the author gives to the shape (SVG 2, section 9.6.1).
      double all = 0.0;
      for (std::size_t i = 0; i < lines_.size(); ++i) all += length(lines_[i]);
      scale = all / said->value;
      if (!std::isfinite(scale)) return add(e, place, lines_, to_page, operation);
    }
    for (double& length : dashes.lengths) length *= scale;
    dashes.offset *= scale;
    dashed_.clear();
    if (auto done = strokes_.dash(lines_, dashes, steps_, dashed_); !done)
      return wrong(e.node, done.error());
    const bool dots =
        std::all_of(dashes.lengths.begin(), dashes.lengths.end(),
                    [i = 0](double length) mutable { return i++ % 2 == 1 || length == 0.0; });
    note(dots ? SvgNote::Dots : SvgNote::Dashed, e.node);
    if (dashed_.size() == 0) return {};
    return add(e, place, dashed_, to_page, operation);
  }

  // How many lines from `first` leave the page.
  [[nodiscard]] std::size_t beyond_page(std::size_t first) const {
    const double touches_mm = kTouchesPage_mm / options_.enlarged;
    const auto leaves = [&](double value, double size) {
      return size > 0.0 && (value < -touches_mm || value > size + touches_mm);
    };
    return static_cast<std::size_t>(
        std::count_if(work_.lines.begin() + static_cast<std::ptrdiff_t>(first), work_.lines.end(),
                      [&](const DrawnLine& line) {
                        const auto points = work_.points_of(line);
                        return std::any_of(points.begin(), points.end(), [&](const PagePoint& p) {
                          return leaves(p.x, sheet_mm_[0]) || leaves(p.y, sheet_mm_[1]);
                        });
                      }));
  }

  // Whether a fill is the page's background: one line around (nearly) all of it. A drawing that
  // only reaches to all sides of its page, as programs crop it, is none.
  [[nodiscard]] bool fills_page(const Polylines& lines) const {
    constexpr double kAll = 0.95;  // of the page: a background may have round corners
    if (lines.size() != 1 || !(page_mm_[0] > 0.0) || !(page_mm_[1] > 0.0)) return false;
    Box box;
    for (const PagePoint& p : lines[0]) box.add(p);
    const double margin = 0.001 * (page_mm_[0] + page_mm_[1]);
    return box.x0 <= margin && box.y0 <= margin && box.x1 >= page_mm_[0] - margin &&
           box.y1 >= page_mm_[1] - margin &&
           0.5 * std::abs(twice_area(lines[0])) >= kAll * page_mm_[0] * page_mm_[1];
  }

  // The outline of a fill. Only at the end is it known whether fills without a name are kept; those
  // with a stroke are.
  Result<void> add_fill(const SvgElement& e, const Place& place, const SvgStyle& style,
                        PenOperation operation, bool stroked) {
    const bool named = style.has_assignment || style.has_layer || stroked;
    remove_thin_lines(lines_);
    if (lines_.size() == 0) {
      note(SvgNote::Invisible, e.node);
      return {};
    }
    // What a frame or clip path hides of a fill leaves a smaller fill: it is closed along them.
    lines_ = moved(lines_, place.to_page);
    if (auto shown = clipped_fill(lines_, style.fill_even_odd, place.clip, place.clips, steps_)) {
      note(place.clips != nullptr ? SvgNote::Clipped : SvgNote::OutOfFrame, e.node);
      lines_ = std::move(*shown);
      if (auto done = spend(e.node, 0); !done || lines_.size() == 0) return done;
    }
    if (!named && fills_page(lines_)) {
      if (!options_.profile.pages || !is_dark(style)) {
        note(SvgNote::FillBackground, e.node);
        return {};
      }
      operation = {*options_.profile.pages, operation.pen};
    }
    const std::size_t first = work_.lines.size();
    const auto added = strokes_.add(lines_, {}, operation);
    if (!added) return wrong(e.node, added.error());
    if (*added == 0) note(SvgNote::Empty, e.node);
    if (work_.lines.size() == first) return {};
    if (is_cut(operation)) add_shape(e, style, first);
    const std::size_t beyond = beyond_page(first);
    if (named && beyond > 0) note(SvgNote::BeyondPage, e.node, beyond);
    if (named) return {};
    if (fills_.empty()) first_fill_ = svg_where(text_, e.node);
    if (fills_beyond_ == 0 && beyond > 0) first_beyond_ = svg_where(text_, e.node);
    fills_beyond_ += beyond;
    ++filled_shapes_;
    for (std::size_t i = first; i < work_.lines.size(); ++i) fills_.push_back(i);
    return {};
  }

  // What is cut along its outline because of its fill, and where such outlines cross.
  Result<void> settle_fills(const pugi::xml_node& root) {
    const auto first = [&] { return first_fill_; };
    const bool named = purposes_.has_names();
    if (!fills_.empty())
      notes_.add(named ? SvgNote::FillUnnamed : SvgNote::FillCut, first, filled_shapes_);
    if (!named && fills_beyond_ > 0)
      notes_.add(
          SvgNote::BeyondPage, [&] { return first_beyond_; }, fills_beyond_);
    if (named && !fills_.empty()) {
      // Line `i` becomes line `i` less those that go before it.
      std::erase_if(shapes_, [&](FilledShape& shape) {
        const auto before = std::lower_bound(fills_.begin(), fills_.end(), shape.first);
        const bool gone = before != fills_.end() && *before == shape.first;
        shape.first -= static_cast<std::size_t>(before - fills_.begin());
        return gone;
      });
      remove_lines(work_, fills_);
    }
    if (shapes_.empty()) return {};
    constexpr std::size_t kStepsToCompare = 10;
    const auto crossing =
        crossing_shapes(work_, shapes_, steps_ / kStepsToCompare, options_.enlarged);
    if (options_.weld) {
      weld_shapes(work_, shapes_, crossing, steps_);
      if (steps_ > 0) return {};
      return wrong(root, too_much("too many filled shapes lie over each other to be welded here; "
                                  "join them in the editor (Inkscape: Path > Union)"));
    }
    const auto count = std::count(crossing.begin(), crossing.end(), 1);
    if (count > 0)
      notes_.add(
          SvgNote::FillsCross, [&] { return first_shape_; }, static_cast<std::size_t>(count));
    return {};
  }

  void add_warnings() {
    for (Warning& warning : notes_.warnings()) work_.warnings.push_back(std::move(warning));
    if (std::string warning = purposes_.colour_warning(); !warning.empty())
      work_.warnings.push_back(
          {.code = "colours_without_meaning", .message = std::move(warning), .spoils = true});
    if (std::string warning = purposes_.unknown_warning(); !warning.empty())
      work_.warnings.push_back({.code = "names_unknown", .message = std::move(warning)});
    if (std::string warning = purposes_.name_warning(); !warning.empty())
      work_.warnings.push_back({.code = "strokes_without_name",
                                .message = std::move(warning),
                                .place = {.source = purposes_.first_unnamed()},
                                .spoils = true});
  }

  const SvgText& text_;
  const SvgReadOptions& options_;
  double user_mm_;
  std::size_t steps_;
  LineWork work_;
  SvgNotes notes_;
  SvgNames names_;
  PenFinder pens_;
  SvgStyleReader styles_;
  SvgPurposes purposes_;
  SvgStrokes strokes_;
  static constexpr double kTouchesPage_mm = 0.1;  ///< lines so near beside the page are on it
  std::array<double, 2> page_mm_{};               ///< 0: not known
  std::array<double, 2> sheet_mm_{};              ///< the page, if lines beyond it are not shown
  std::unordered_map<std::string_view, pugi::xml_node> ids_;
  bool ids_read_{false};  ///< a drawing may have none
  std::vector<pugi::xml_node> used_;
  std::deque<SvgRegion> regions_;  ///< of clip paths
  std::unordered_map<std::string, const SvgRegion*> known_clips_;
  Box* measured_{};  ///< not null: shapes are not drawn but measured
  SvgTransform to_measured_;
  SvgLines lines_, dashed_;
  std::vector<std::size_t> fills_;   ///< lines of fills without a name
  std::vector<FilledShape> shapes_;  ///< fills that are cut
  std::size_t filled_shapes_{};
  std::size_t fills_beyond_{};  ///< lines of fills without a name beyond the page
  std::string first_fill_, first_shape_, first_beyond_;
};

bool is_svg(std::string_view name) {
  return name == "svg" || (name.size() > 4 && name.substr(name.size() - 4) == ":svg");
}

}  // namespace

const char* svg_profile_name(SvgProfile profile) {
  constexpr std::array kNames{"popcut", "origami-sim", "lightburn", "cricut", "plain"};
  return kNames.at(static_cast<std::size_t>(profile));
}

Result<LineWork> linework_from_svg(std::string text, const SvgReadOptions& options) {
  auto ready = prepare_svg_text(std::move(text), options.limits);
  if (!ready) return tl::unexpected(ready.error());
  const bool has_sheets = ready->text.find("<style") != std::string::npos ||
                          ready->text.find(":style") != std::string::npos;
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer_inplace(
      ready->text.data(), ready->text.size(), pugi::parse_cdata | pugi::parse_escapes);
  if (!parsed)
    return fail(ErrorKind::Malformed, svg_place(*ready, parsed.offset),
                fmt::format("not XML: {}; is the file complete?", parsed.description()));
  for (const pugi::xml_node& root : document.children()) {
    if (root.type() != pugi::node_element || !is_svg(root.name())) continue;
    for (pugi::xml_node next = root.next_sibling(); next; next = next.next_sibling())
      if (next.type() == pugi::node_element)
        return fail(ErrorKind::Malformed, svg_place(*ready, next.offset_debug() - 1),
                    fmt::format("<{}> follows the drawing's end; give one drawing, or put both "
                                "into one <svg>",
                                std::string_view(next.name()).substr(0, 60)));
    // Illustrator exports the name of a layer as data-name of the root.
    ready->by_illustrator = ready->by_illustrator || root.attribute("data-name");
    return SvgReader(*ready, options).read(root, has_sheets);
  }
  return fail(ErrorKind::Malformed, "line 1, column 1",
              "the root element is not <svg>; is this an SVG file?");
}

Result<LineWork> linework_from_svg(std::string_view text, SvgProfile profile) {
  SvgReadOptions options;
  auto found = find_stroke_profile(svg_profile_name(profile));
  if (!found) return tl::unexpected(found.error());
  options.profile = std::move(*found);
  return linework_from_svg(std::string(text), options);
}

}  // namespace popcut
