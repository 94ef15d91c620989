// SPDX-License-Identifier: MIT
// Part of core/formats/svg/svg_style.hpp.
#include <algorithm>

#include <fmt/format.h>

#include "core/formats/svg/svg_style.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostListedColours = 8;

LineStyle line_style(const SvgDashes& dashes) {
  const auto& d = dashes.lengths;
  if (d.empty()) return LineStyle::Solid;
  return d.size() >= 4 && d[0] != d[2] ? LineStyle::DashDot : LineStyle::Dashed;
}

std::uint32_t stroke_rgb(const SvgStyle& style) {
  return style.stroke.kind == SvgPaint::Kind::Current ? style.colour : style.stroke.rgb;
}

bool add_colour(std::vector<std::uint32_t>& colours, std::uint32_t rgb) {
  if (colours.size() >= kMostListedColours ||
      std::find(colours.begin(), colours.end(), rgb) != colours.end())
    return false;
  colours.push_back(rgb);
  return true;
}

/// Some programs write white as #fefefe.
bool is_white(std::uint32_t rgb) {
  return (rgb >> 16) >= 0xFA && (rgb >> 8 & 0xFF) >= 0xFA && (rgb & 0xFF) >= 0xFA;
}

}  // namespace

std::optional<SvgPurpose> SvgPurposes::of(const SvgElement& e, const SvgStyle& style,
                                          const SvgDashes& dashes) {
  const auto here = [&] { return svg_where(text_, e.node); };
  const auto shows = [&](const SvgPaint& paint, bool clear) {
    const bool none = paint.kind == SvgPaint::Kind::None ||
                      (paint.kind == SvgPaint::Kind::Current && style.colour_clear);
    return !none && !clear && !style.transparent;
  };
  const bool stroked = shows(style.stroke, style.stroke_clear);
  const bool filled = shows(style.fill, style.fill_clear) && e.name != "line";
  if (!stroked && !filled) {
    notes_.add(SvgNote::Invisible, here);
    return std::nullopt;
  }
  auto purpose = meaning(e, style, dashes, stroked);
  if (!purpose || !purpose->use || !pens_.any()) return purpose;
  const SvgPaint& paint = purpose->fill ? style.fill : style.stroke;
  const std::uint8_t by_colour =
      pens_.of_colour(paint.kind == SvgPaint::Kind::Current ? style.colour : paint.rgb);
  purpose->pen = style.layer_pen != 0 ? style.layer_pen : by_colour;
  return purpose;
}

std::optional<SvgPurpose> SvgPurposes::meaning(const SvgElement& e, const SvgStyle& style,
                                               const SvgDashes& dashes, bool stroked) {
  const auto here = [&] { return svg_where(text_, e.node); };
  if (stroked && style.no_width) notes_.add(SvgNote::NoWidth, here);
  if (style.has_assignment || style.has_layer) {
    has_names_ = true;
    const StrokeUse use = style.has_assignment ? style.assignment : style.layer;
    if (stroked && use) add_colour(is_cut(*use) ? cut_colours_ : other_colours_, stroke_rgb(style));
    // A person who is asked may say the side, or that a scored line is a fold.
    if (!looks_.any() || style.has_assignment || style.sideless == 0)
      return SvgPurpose{use, !stroked};
    return SvgPurpose{use, !stroked,
                      looks_.of_colour(names_.sideless(style.sideless), stroke_rgb(style))};
  }
  if (!stroked) {
    const bool white = style.fill.kind == SvgPaint::Kind::Colour && is_white(style.fill.rgb);
    if (profile_.fills && !white) return SvgPurpose{profile_.fills, true};
    if (profile_.whites && white) return SvgPurpose{profile_.whites, true};
    notes_.add(profile_.fills ? SvgNote::FillBackground : SvgNote::FillIgnored, here);
    return std::nullopt;
  }
  const std::uint32_t rgb = stroke_rgb(style);
  if (style.stroke.kind == SvgPaint::Kind::Server) notes_.add(SvgNote::PaintServer, here);
  if (const auto ruled = use_of_stroke(profile_, rgb, line_style(dashes), e.classes)) {
    cut_is_said_ = cut_is_said_ || (*ruled && is_cut(**ruled));
    return SvgPurpose{*ruled, false};
  }
  // The dashes of a stroke say what to do with it: cut them.
  const bool said = profile_.asks && line_style(dashes) != LineStyle::Solid;
  if (!said) names_.draw(style.unknown);
  if (!said && !first_drawn_) first_drawn_ = style.unknown;
  if (!said && !differ_ && style.unknown != *first_drawn_)
    differ_ = names_.name(style.unknown) != names_.name(*first_drawn_);
  if (!said && add_colour(colours_, rgb)) {
    if (colours_.size() == 1) first_colour_ = here();
    if (colours_.size() == 2) second_colour_ = here();
  }
  // A person who is asked about colours may say what dashed ones mean, too.
  if (!looks_.any()) return SvgPurpose{profile_.otherwise, false};
  return SvgPurpose{profile_.otherwise, false, looks_.of_colour(names_.name(style.unknown), rgb)};
}

std::string SvgPurposes::colour_list() const {
  std::string list;
  for (const std::uint32_t rgb : colours_) list += (list.empty() ? "" : ", ") + colour_text(rgb);
  return fmt::format(
      "{} colours ({})",
      colours_.size() == kMostListedColours ? "many" : std::to_string(colours_.size()), list);
}

void SvgPurposes::tell_looks(LineWork& work) {
  if (!looks_.any()) return;
  work.unsaid = std::move(looks_.seen());
  if (!names_.asked(has_names_).empty())
    work.asks = "layers";
  else if (is_open())
    work.asks = "colors";
}

bool SvgPurposes::is_open() const {
  // Black beside explained colours is the outline, as programs draw it.
  const bool other_than_black = !colours_.empty() && colours_.front() != 0;
  return colours_.size() > 1 || (profile_.asks && cut_is_said_ && other_than_black);
}

Result<void> SvgPurposes::clear() const {
  if (!profile_.asks || looks_.any()) return {};
  if (const std::vector<std::string> names = names_.asked(has_names_); !names.empty())
    return tl::unexpected(Error{ErrorKind::Malformed,
                                svg_where(text_, names_.first_asked(has_names_)),
                                unknown_names(names), ErrorReason::Unclear});
  if (!is_open()) return {};
  if (colours_.size() == 1)
    return tl::unexpected(
        Error{ErrorKind::Malformed, first_colour_,
              fmt::format(
                  "you said which colours are cut, and solid strokes also have the colour {}; say "
                  "with `colors` what it means, too, such as \"{}=fold-mountain\"",
                  colour_text(colours_.front()), colour_text(colours_.front())),
              ErrorReason::Unclear});
  return tl::unexpected(Error{
      ErrorKind::Malformed, second_colour_,
      fmt::format("solid strokes without a name have {}, and popcut does not guess which of them "
                  "are folds; say it with `colors` such as \"{}=fold-mountain\", or use "
                  "`svg-profile` origami-sim if red is a mountain fold and blue a valley fold, or "
                  "`svg-profile` popcut to cut them all",
                  colour_list(), colour_text(colours_.back())),
      ErrorReason::Unclear});
}

std::string SvgPurposes::colour_warning() const {
  if (!profile_.names || !profile_.rules.empty() || has_names_ || colours_.size() < 2) return {};
  if (pens_.any()) return {};  // the person knows the colours
  return fmt::format(
      "strokes have {} and no names: all are cut; if the colours have a meaning, use `svg-profile` "
      "origami-sim, lightburn or one of your own",
      colour_list());
}

std::string SvgPurposes::unknown_warning() const {
  if (!profile_.asks || has_names_ || looks_.any() || !differ_) return {};
  const std::vector<std::string> names = names_.asked(true);
  return names.empty() ? std::string() : only_unknown_names(names);
}

std::string SvgPurposes::name_warning() const {
  if (!profile_.asks || !has_names_ || colours_.empty()) return {};
  const auto among = [&](const std::vector<std::uint32_t>& list) {
    return std::find(list.begin(), list.end(), colours_.front()) != list.end();
  };
  if (cut_colours_.empty() ? !among(other_colours_) : among(cut_colours_)) return {};
  return fmt::format(
      "other lines have names, but the {} strokes have none that popcut knows: they are cut; if "
      "they are folds, name their layer fold-mountain or fold-valley",
      colour_text(colours_.front()));
}

}  // namespace popcut
