// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_style.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "core/formats/svg/svg_shape.hpp"
#include "core/text/words.hpp"

namespace popcut {

enum class SvgStyleReader::Property : std::uint8_t {
  None,
  Stroke,
  Fill,
  Colour,
  Display,
  Visibility,
  Dashes,
  DashOffset,
  StrokeOpacity,
  StrokeWidth,
  FillOpacity,
  Opacity,
  Font,
  FontSize,
  Clip,
  ClipPath,
  ClipRule,
  FillRule,
  Mask,
  Filter,
  Marker,
  Overflow,
  VectorEffect,
  TransformOrigin,
  TransformBox,
  Geometry,  ///< this and the next three are read from attributes only
  Width,
  Height,
  Transform,
  Animation,
};

namespace {

constexpr std::string_view kSvgNamespace = "http://www.w3.org/2000/svg";

// Whether nothing is seen of what is so opaque, as a number or a percentage.
std::optional<bool> is_zero(std::string_view value) {
  constexpr double kLeast = 0.5 / 255;  // that a picture of 8 bits shows
  const auto length = parse_svg_length(value);
  if (!length ||
      (length->unit != SvgLength::Unit::User && length->unit != SvgLength::Unit::Percent))
    return std::nullopt;
  return length->value < (length->unit == SvgLength::Unit::Percent ? 100 * kLeast : kLeast);
}

bool cuts(LayerMeaning meaning) {
  return meaning == LayerMeaning::Cut || meaning == LayerMeaning::Outline;
}

// Classes that programs number: "cls-1", "st0", "fil2". They make up those of one letter too.
bool is_made_up(std::string_view name) {
  return name.size() < 2 ||
         std::any_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// Attributes beside label, data-name and id in which programs write names.
bool is_name(std::string_view attribute) {
  attribute.remove_prefix(attribute.find(':') + 1);
  for (const std::string_view name : {"aria-label", "data-label", "data-layer", "data-layer-name",
                                      "data-title", "layerName", "layer-name", "name", "title"})
    if (same_word(attribute, name)) return true;
  return false;
}

// Whether an element draws, so that its names are those of lines.
bool is_drawn(std::string_view name) {
  if (is_svg_shape(name)) return true;
  for (const std::string_view group : {"g", "a", "switch", "svg", "use", "symbol"})
    if (name == group) return true;
  return false;
}

std::string_view title_of(const pugi::xml_node& node) {
  for (const pugi::xml_node& child : node.children()) {
    std::string_view name = child.name();
    name.remove_prefix(name.find(':') + 1);
    if (name == "title") return child.child_value();
  }
  return {};
}

}  // namespace

std::optional<SvgOrigin> parse_svg_origin(std::string_view text) {
  struct Value {
    SvgLength length;
    char axis{};  // x, y; c: center; 0: a length
  };
  constexpr std::array<std::pair<std::string_view, Value>, 5> kWords{
      {{"left", {{0, SvgLength::Unit::Percent}, 'x'}},
       {"right", {{100, SvgLength::Unit::Percent}, 'x'}},
       {"top", {{0, SvgLength::Unit::Percent}, 'y'}},
       {"bottom", {{100, SvgLength::Unit::Percent}, 'y'}},
       {"center", {{50, SvgLength::Unit::Percent}, 'c'}}}};
  std::array<Value, 3> values{};
  std::size_t count = 0;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::string_view word = take_word(text, kBlanks);
    if (count == values.size()) return std::nullopt;
    Value& value = values[count++];
    bool known = false;
    for (const auto& [name, is] : kWords)
      if (same_word(word, name)) {
        value = is;
        known = true;
      }
    if (known) continue;
    const auto length = parse_svg_length(word);
    if (!length) return std::nullopt;
    value.length = *length;
  }
  if (count == 0 || (count == 3 && values[2].axis != 0)) return std::nullopt;
  Value& first = values[0];
  Value& second = values[1];
  if (count == 1) second = kWords[4].second;
  if (first.axis == 'y' || second.axis == 'x') {
    // Only two words can change places, as in "top left".
    if (first.axis == 0 || second.axis == 0) return std::nullopt;
    std::swap(first, second);
  }
  if (first.axis == 'y' || second.axis == 'x') return std::nullopt;
  return SvgOrigin{first.length, second.length};
}

std::string svg_where(const SvgText& text, const pugi::xml_node& node) {
  std::string where = fmt::format("line {}", svg_line(text, node.offset_debug()));
  const std::string_view id = node.attribute("id").value();
  if (!id.empty()) where += fmt::format(" (id \"{}\")", id.substr(0, 60));
  return where;
}

SvgStyleReader::Property SvgStyleReader::property_of(std::string_view name) {
  using P = Property;
  // Static: it is asked for each attribute, and a table on the stack would be filled each time.
  static constexpr std::array<std::pair<std::string_view, P>, 48> kNames{
      // in alphabetical order
      {{"-webkit-mask", P::Mask},
       {"-webkit-mask-image", P::Mask},
       {"animation", P::Animation},
       {"animation-name", P::Animation},
       {"clip", P::Clip},
       {"clip-path", P::ClipPath},
       {"clip-rule", P::ClipRule},
       {"color", P::Colour},
       {"cx", P::Geometry},
       {"cy", P::Geometry},
       {"d", P::Geometry},
       {"display", P::Display},
       {"fill", P::Fill},
       {"fill-opacity", P::FillOpacity},
       {"fill-rule", P::FillRule},
       {"filter", P::Filter},
       {"font", P::Font},
       {"font-size", P::FontSize},
       {"height", P::Height},
       {"marker", P::Marker},
       {"marker-end", P::Marker},
       {"marker-mid", P::Marker},
       {"marker-start", P::Marker},
       {"mask", P::Mask},
       {"mask-image", P::Mask},
       {"offset-path", P::Transform},
       {"opacity", P::Opacity},
       {"overflow", P::Overflow},
       {"r", P::Geometry},
       {"rotate", P::Transform},
       {"rx", P::Geometry},
       {"ry", P::Geometry},
       {"scale", P::Transform},
       {"stroke", P::Stroke},
       {"stroke-dasharray", P::Dashes},
       {"stroke-dashoffset", P::DashOffset},
       {"stroke-opacity", P::StrokeOpacity},
       {"stroke-width", P::StrokeWidth},
       {"transform", P::Transform},
       {"transform-box", P::TransformBox},
       {"transform-origin", P::TransformOrigin},
       {"translate", P::Transform},
       {"vector-effect", P::VectorEffect},
       {"visibility", P::Visibility},
       {"width", P::Width},
       {"x", P::Geometry},
       {"y", P::Geometry},
       {"zoom", P::Transform}}};
  static_assert(std::is_sorted(kNames.begin(), kNames.end(),
                               [](const auto& a, const auto& b) { return a.first < b.first; }));
  if (name.empty()) return P::None;
  const char first = name.front();
  const auto before = [](const auto& row, char letter) { return row.first.front() < letter; };
  auto row = std::lower_bound(kNames.begin(), kNames.end(), first, before);
  for (; row != kNames.end() && row->first.front() == first; ++row)
    if (row->first == name) return row->second;
  return P::None;
}

void SvgStyleReader::set_clip(SvgStyle& style, std::string_view value) {
  if (same_word(value, "none")) {
    style.clip = 0;
    return;
  }
  std::string id;
  if (value.size() > 4 && same_word(value.substr(0, 4), "url(")) {
    std::string_view address = value.substr(4, value.find(')') - 4);
    address = trimmed(trimmed(address), "\"'");
    if (address.starts_with('#')) id = address.substr(1);
  }
  style.clip = static_cast<std::uint32_t>(clips_.size());
  clips_.push_back(std::move(id));
}

// Whether a style gives an element another shape or place than its attributes do. Pages stretch an
// <svg> to their own size, which says nothing of the drawing.
bool SvgStyleReader::sets_shape(Property property, std::string_view value,
                                const SvgElement& element) {
  if (value == "none" || value == "auto") return false;
  if (element.name != "svg" || property == Property::Transform) return true;
  if (property == Property::Geometry) return element.node.parent().type() != pugi::node_document;
  const auto size = parse_svg_length(value);
  if (!size || (size->unit != SvgLength::Unit::User && size->unit != SvgLength::Unit::Mm))
    return false;
  const char* const name = property == Property::Width ? "width" : "height";
  const auto own = parse_svg_length(element.node.attribute(name).value());
  return !own || own->unit != size->unit || own->value != size->value;
}

bool SvgStyleReader::set_paint(SvgPaint& paint, std::string_view value) {
  const auto parsed = parse_svg_paint(value);
  if (parsed) paint = *parsed;
  return parsed.has_value();
}

bool SvgStyleReader::set_dashes(SvgStyle& style, std::string_view value) {
  if (value == "none") {
    style.dashes = 0;
    return true;
  }
  auto known = known_dashes_.find(std::string(value));
  if (known == known_dashes_.end()) {
    auto list = parse_svg_dashes(value);
    if (!list) {
      too_many_dashes_ = true;
      return true;
    }
    const bool solid = list->empty();
    const auto index = solid ? 0u : static_cast<std::uint32_t>(dash_lists_.size());
    if (!solid) dash_lists_.push_back(std::move(*list));
    known = known_dashes_.emplace(value, index).first;
  }
  // An unreadable list is ignored; the inherited value stays.
  if (known->second == 0) return same_word(value, "none");
  style.dashes = known->second;
  return true;
}

void SvgStyleReader::set_font(SvgFont& font, const std::optional<SvgLength>& size,
                              const SvgFont& inherited) const {
  if (size) font.own = user_units(*size, {user_mm_, inherited.own, inherited});
}

void SvgStyleReader::apply(Property property, std::string_view value, const SvgStyle& inherited,
                           const SvgElement& element, SvgStyle& style, bool is_attribute) {
  using P = Property;
  value = trimmed(value);
  static const SvgStyle kInitial;
  const bool initial = value == "initial";
  if (initial || value == "inherit" || value == "unset" || value == "revert") {
    const SvgStyle& from = initial ? kInitial : inherited;
    if (property == P::Stroke) style.stroke = from.stroke;
    if (property == P::Fill) style.fill = from.fill;
    if (property == P::Colour) style.colour = from.colour, style.colour_clear = from.colour_clear;
    if (property == P::Visibility) style.hidden = from.hidden;
    if (property == P::Dashes) style.dashes = from.dashes;
    if (property == P::DashOffset) style.dash_offset = from.dash_offset;
    if (property == P::Display) style.display_none = value == "inherit" && from.display_none;
    if (property == P::StrokeOpacity) style.stroke_clear = from.stroke_clear;
    if (property == P::StrokeWidth) style.no_width = from.no_width;
    if (property == P::FillOpacity) style.fill_clear = from.fill_clear;
    if (property == P::FontSize) style.font.own = from.font.own;
    if (property == P::ClipRule) style.clip_even_odd = from.clip_even_odd;
    if (property == P::FillRule) style.fill_even_odd = from.fill_even_odd;
    if (property == P::ClipPath) style.clip = value == "inherit" ? from.clip : 0;
    if (property == P::TransformOrigin)
      style.origin = value == "inherit" ? from.origin : SvgOrigin{};
    if (property == P::TransformBox) style.own_box = value == "inherit" && from.own_box;
    return;
  }
  if (property == P::Display) style.display_none = same_word(value, "none");
  if (property == P::Visibility)
    style.hidden = same_word(value, "hidden") || same_word(value, "collapse");
  if (property == P::ClipPath) set_clip(style, value);
  if (property == P::ClipRule) style.clip_even_odd = same_word(value, "evenodd");
  if (property == P::FillRule) style.fill_even_odd = same_word(value, "evenodd");
  if (property == P::StrokeWidth)
    if (const auto width = parse_svg_length(value)) style.no_width = width->value == 0.0;
  if (property == P::Mask) style.masked = value != "none";
  if (property == P::Filter) style.filtered = value != "none";
  if (property == P::Marker) style.marked = value != "none";
  if (property == P::Overflow) style.overflows = value == "visible" || value == "auto";
  if (property == P::VectorEffect) style.non_scaling = value == "non-scaling-stroke";
  if (property == P::TransformBox) style.own_box = value != "view-box";
  bool understood = true;
  const auto zero = [&](bool& clear) {
    const auto is = is_zero(value);
    understood = is.has_value();
    if (is) clear = *is;
  };
  switch (property) {
    case P::Stroke:
      understood = set_paint(style.stroke, value);
      break;
    case P::Fill:
      understood = set_paint(style.fill, value);
      style.fill_said = true;
      break;
    case P::Colour: {
      SvgPaint paint{SvgPaint::Kind::Current, 0};
      understood = set_paint(paint, value);
      if (paint.kind == SvgPaint::Kind::Colour) style.colour = paint.rgb;
      if (understood && paint.kind != SvgPaint::Kind::Current)
        style.colour_clear = paint.kind == SvgPaint::Kind::None;
      break;
    }
    case P::Dashes:
      understood = set_dashes(style, value);
      break;
    case P::DashOffset: {
      const auto length = parse_svg_length(value);
      understood = length.has_value();
      if (length) style.dash_offset = *length;
      break;
    }
    case P::StrokeOpacity:
      zero(style.stroke_clear);
      break;
    case P::FillOpacity:
      zero(style.fill_clear);
      break;
    case P::Opacity: {
      bool clear = false;
      zero(clear);
      style.transparent = inherited.transparent || clear;
      break;
    }
    case P::TransformOrigin: {
      const auto origin = parse_svg_origin(value);
      understood = origin.has_value();
      if (origin) style.origin = *origin;
      break;
    }
    case P::FontSize:
      set_font(style.font, parse_svg_font_size(value), inherited.font);
      break;
    case P::Font:
      if (!is_attribute) set_font(style.font, font_size_of_shorthand(value), inherited.font);
      break;
    case P::Geometry:
    case P::Width:
    case P::Height:
    case P::Transform:
      if (!is_attribute && sets_shape(property, value, element))
        notes_.add(SvgNote::SheetGeometry, [&] { return svg_where(text_, element.node); });
      break;
    case P::Clip:
      if (!same_word(value, "auto"))
        notes_.add(SvgNote::ClipUnread, [&] { return svg_where(text_, element.node); });
      break;
    case P::Animation:
      if (!is_attribute && value != "none")
        notes_.add(SvgNote::Moving, [&] { return svg_where(text_, element.node); });
      break;
    default:
      break;
  }
  const bool is_colour = property == P::Stroke || property == P::Colour;
  if (!understood)
    notes_.add(is_colour ? SvgNote::ColourUnread : SvgNote::Value, [&] {
      return fmt::format("{}: \"{}\"", svg_where(text_, element.node), value.substr(0, 60));
    });
}

bool SvgStyleReader::apply_all(std::string_view declarations, bool important,
                               const SvgStyle& inherited, const SvgElement& element,
                               SvgStyle& style) {
  steps_ -= std::min(steps_, declarations.size());
  bool other_kind = false;
  CssDeclaration one;
  while (next_declaration(declarations, one)) {
    if (one.important != important) {
      other_kind = true;
      continue;
    }
    Property property = property_of(one.name);
    if (property == Property::None) property = property_of(lower(one.name));
    apply(property, one.value, inherited, element, style, false);
  }
  return other_kind;
}

void SvgStyleReader::read_attributes(const SvgStyle& inherited, SvgElement& element,
                                     SvgStyle& style) {
  for (const pugi::xml_attribute& attribute : element.node.attributes()) {
    const std::string_view name = attribute.name(), value = attribute.value();
    if (steps_ > 0) --steps_;
    if (name == "d") {
      element.d = value;
    } else if (name == "style") {
      element.style = value;
    } else if (name == "id") {
      element.id = value;
    } else if (name == "class") {
      element.classes = value;
    } else if (name == "transform") {
      element.transform = value;
      element.has_transform = true;
    } else if (name == "data-assignment") {
      element.assignment = value;
    } else if (name == "data-name") {
      element.data_name = value;
    } else if (name == "href") {
      element.href = value;
    } else if (name == "xmlns") {
      style.foreign = value != kSvgNamespace && value != root_namespace_;
    } else if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) {
      const std::string_view local = name.substr(colon + 1);
      if (local == "label") element.label = value;
      if (name == "serif:id") element.data_name = value;
      if (is_name(local)) element.other_name = value;
      if (local == "groupmode") element.is_layer = value == "layer";
      if (local == "href" && element.href.empty()) element.href = value;
    } else if (const Property property = property_of(name); property != Property::None) {
      apply(property, value, inherited, element, style, true);
    } else if (is_name(name)) {
      element.other_name = value;
    }
  }
  // Inkscape puts the letters of a text there that became paths.
  if (element.style.find("font-size") != std::string_view::npos &&
      element.other_name == element.node.attribute("aria-label").value())
    element.other_name = {};
}

void SvgStyleReader::apply_sheets(const SvgStyle& inherited, const SvgElement& element,
                                  SvgStyle& style, std::string_view own) {
  found_.clear();
  if (!sheets_.empty() &&
      !sheets_.find(element.node, element.name, element.id, element.classes, steps_, found_))
    return;
  bool important = false;
  for (const CssRule* rule : found_)
    important |= apply_all(rule->declarations, false, inherited, element, style);
  const bool own_important = apply_all(own, false, inherited, element, style);
  if (important)
    for (const CssRule* rule : found_)
      apply_all(rule->declarations, true, inherited, element, style);
  if (own_important) apply_all(own, true, inherited, element, style);
}

void SvgStyleReader::read_pen(const SvgElement& element, SvgStyle& style) {
  const bool group = element.name == "g";
  for (const std::string_view name :
       {element.label, element.data_name, element.other_name, element.id}) {
    // Only groups and layers are told to a person who asks for what is not there.
    const std::uint8_t pen = name.empty() ? std::uint8_t{0} : pens_.of_layer(name, group);
    if (pen != 0) style.layer_pen = pen;
    if (pen != 0) return;
  }
}

void SvgStyleReader::read_names(SvgElement& element, SvgStyle& style) {
  if (pens_.any()) read_pen(element, style);
  if (!profile_.names) return;
  if (!element.assignment.empty()) {
    const auto use = use_of_assignment(element.assignment);
    if (use) {
      style.assignment = *use;
      style.has_assignment = true;
    } else {
      notes_.add(SvgNote::Assignment, [&] {
        return fmt::format("{}: \"{}\"", svg_where(text_, element.node),
                           element.assignment.substr(0, 40));
      });
    }
  }
  const bool root = element.node.parent().type() == pugi::node_document;
  if (root && by_illustrator_) read_root_name(element, style);
  if (!root && is_drawn(element.name)) read_name(element, style);
}

// Illustrator gives the name of its only layer to the root. One that cuts says nothing of lines
// of other colours.
void SvgStyleReader::read_root_name(const SvgElement& element, SvgStyle& style) {
  const std::string name =
      element.data_name.empty() ? illustrator_name(element.id) : std::string(element.data_name);
  const LayerMeaning meaning = meaning_of_label(profile_, name);
  if (!is_known(meaning) || meaning == LayerMeaning::Ignore || cuts(meaning)) return;
  names_.see_known(name);
  set_layer(meaning, name, style);
}

void SvgStyleReader::set_layer(LayerMeaning meaning, std::string_view name, SvgStyle& style) {
  const bool has_no_side = meaning == LayerMeaning::Fold || meaning == LayerMeaning::Score;
  style.layer = use_of(meaning);
  style.has_layer = true;
  style.sideless = has_no_side ? names_.add_sideless(name) : 0;
}

// What the names of an element say. A label that a person wrote counts first; then an id and the
// classes together, of which what does not cut counts; then a title, which shapes have of their
// own.
LayerMeaning SvgStyleReader::meaning_of_names(const SvgElement& e, std::string& known,
                                              std::string& unknown) {
  LayerMeaning all = LayerMeaning::Wordless;
  const auto look_at = [&](std::string_view name) {
    const LayerMeaning meaning = meaning_of_label(profile_, name);
    if (is_known(meaning)) names_.see_known(name);
    if (is_known(meaning) && (!is_known(all) || cuts(all))) all = meaning, known = name;
    if (meaning == LayerMeaning::Unknown && !is_known(all)) {
      if (unknown.empty()) unknown = name;
      all = meaning;
    }
  };
  for (const std::string_view label : {e.label, e.data_name, e.other_name}) {
    if (!label.empty()) look_at(label);
    if (is_known(all) || e.is_layer) return all;
  }
  if (!e.id.empty()) look_at(illustrator_name(e.id));
  if (!e.classes.empty()) {
    if (const LayerMeaning meaning = meaning_of_label(profile_, e.classes);
        is_known(meaning) && (!is_known(all) || cuts(all)))
      all = meaning, known = e.classes;
    else if (!is_known(all))
      for (std::string_view rest = e.classes, one; !(one = take_word(rest, kBlanks)).empty();)
        if (!is_made_up(one)) look_at(one);
  }
  if (!is_known(all)) look_at(title_of(e.node));
  return all;
}

// Layers, groups and shapes mean what their names say.
void SvgStyleReader::read_name(const SvgElement& element, SvgStyle& style) {
  std::string known, unknown;
  const LayerMeaning meaning = meaning_of_names(element, known, unknown);
  if (meaning == LayerMeaning::Unknown)
    style.unknown = names_.add(element.node, style.unknown, unknown);
  if (!is_known(meaning)) return;
  const bool is_shape = is_svg_shape(element.name);
  // No line of a fold is cut because of its own id.
  if (is_shape && cuts(meaning) && style.has_layer && (!style.layer || !is_cut(*style.layer)))
    return;
  set_layer(meaning, known, style);
  if (!by_illustrator_ && !element.is_layer && element.assignment.empty())
    notes_.add(is_shape ? SvgNote::NamedShape : SvgNote::NamedGroup,
               [&] { return svg_where(text_, element.node); });
}

// The namespace of a prefix, or the default namespace; empty if none is declared.
std::string_view SvgStyleReader::namespace_of(pugi::xml_node node, std::string_view prefix) {
  for (; node; node = node.parent())
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      if (steps_ > 0) --steps_;
      std::string_view name = attribute.name();
      if (!name.starts_with("xmlns")) continue;
      name.remove_prefix(5);
      if (!name.empty()) name.remove_prefix(1);
      if (name == prefix) return attribute.value();
    }
  return {};
}

std::string_view SvgStyleReader::svg_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos) return name;
  const std::string_view prefix = name.substr(0, colon);
  const std::string_view space = namespace_of(node, prefix);
  const bool known =
      space.empty() ? prefix == root_prefix_ : space == kSvgNamespace || space == root_namespace_;
  if (!known) return {};
  return name.substr(colon + 1);
}

Result<SvgElement> SvgStyleReader::read(const pugi::xml_node& node, const SvgStyle& inherited,
                                        SvgStyle& style) {
  SvgElement element;
  element.node = node;
  if (!root_namespace_) {
    const std::string_view name = node.name();
    const std::size_t colon = name.find(':');
    if (colon != std::string_view::npos) root_prefix_ = name.substr(0, colon);
    root_namespace_ = namespace_of(node, root_prefix_);
  }
  element.name = svg_name(node);
  if (element.name.empty()) return SvgElement{};
  style = inherited;
  style.display_none = style.masked = style.filtered = style.overflows = style.own_box = false;
  style.clip = 0;
  style.origin = {};
  read_attributes(inherited, element, style);
  // A name without a prefix belongs to the default namespace, which a group can change.
  if (style.foreign && element.name == node.name()) return SvgElement{};
  if (!sheets_.empty() || !element.style.empty()) {
    if (element.style.find("/*") != std::string_view::npos) {
      const std::string plain = without_css_comments(element.style);
      apply_sheets(inherited, element, style, plain);
    } else {
      apply_sheets(inherited, element, style, element.style);
    }
  }
  if (node.parent().type() == pugi::node_document) style.font.root = style.font.own;
  read_names(element, style);
  if (too_many_dashes_)
    return fail(
        ErrorKind::OutOfRange, svg_where(text_, node),
        fmt::format("stroke-dasharray has more than {} numbers; write fewer", kMaxDashNumbers));
  return element;
}

Result<void> read_svg_sheets(const SvgText& text, const pugi::xml_node& root, CssSheets& sheets,
                             SvgNotes& notes) {
  Result<void> all;
  each_svg_element(root, [&](const pugi::xml_node& node) {
    std::string_view name = node.name();
    name.remove_prefix(std::min(name.rfind(':') + 1, name.size()));
    if (name != "style" || !all) return;
    const std::string_view type = node.attribute("type").value();
    const std::string_view media = node.attribute("media").value();
    if (!type.empty() && !same_word(type, "text/css")) return;
    std::string sheet;
    for (const pugi::xml_node& part : node.children()) sheet += part.value();
    if (!trimmed(media).empty()) sheet = fmt::format("@media {}{{{}}}", media, sheet);
    if (auto done = sheets.add(sheet); !done)
      all = fail(done.error().kind, svg_place(text, node.offset_debug() - 1), done.error().detail,
                 done.error().reason);
  });
  const auto first = [&] { return fmt::format("\"{}\"", sheets.first_unknown()); };
  const auto none = [] { return std::string(); };
  if (sheets.unknown_selectors() > 0)
    notes.add(SvgNote::Selector, first, sheets.unknown_selectors());
  if (sheets.unknown_blocks() > 0) notes.add(SvgNote::SheetBlock, first, sheets.unknown_blocks());
  if (sheets.imports() > 0) notes.add(SvgNote::ForeignSheet, none, sheets.imports());
  return all;
}

}  // namespace popcut
