// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

#include "core/formats/pens/pen_finder.hpp"
#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/svg_names.hpp"
#include "core/formats/svg/svg_profile.hpp"
#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/formats/svg/syntax/svg_css.hpp"
#include "core/formats/svg/syntax/svg_notes.hpp"
#include "core/formats/svg/syntax/svg_text.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {

/// An element, with its most used attributes.
struct SvgElement {
  pugi::xml_node node;
  std::string_view name;  ///< without its prefix; empty: another namespace than SVG's
  std::string_view id, classes, style, transform, d, href, assignment, label;
  std::string_view data_name;   ///< Illustrator's or Affinity's name, if its id is another one
  std::string_view other_name;  ///< in an attribute that some other program uses
  bool has_transform{false};
  bool is_layer{false};  ///< an Inkscape layer
};

/// A transform-origin: x and y from the origin of the user units (SVG's transform-box: view-box).
struct SvgOrigin {
  SvgLength x, y;  ///< percentages of the width and height of the viewport
};

/// Parses a transform-origin of one to three values (CSS Transforms 1, section 6): keywords,
/// lengths and percentages; the third, a depth, has no effect.
[[nodiscard]] std::optional<SvgOrigin> parse_svg_origin(std::string_view text);

/// An element's inherited and own style and meaning.
struct SvgStyle {
  SvgPaint stroke;
  SvgPaint fill{SvgPaint::Kind::Colour, 0};
  std::uint32_t colour{};    ///< value of currentColor
  bool colour_clear{false};  ///< which nothing is seen of
  std::uint32_t dashes{};    ///< for `SvgStyleReader::dashes`; 0: solid
  SvgLength dash_offset;
  SvgFont font;
  bool hidden{false}, transparent{false}, stroke_clear{false}, fill_clear{false};
  bool marked{false}, non_scaling{false};
  bool no_width{false};  ///< stroke-width is 0
  bool fill_even_odd{false}, clip_even_odd{false};
  bool fill_said{false};  ///< the fill is not black because nothing is said
  bool foreign{false};    ///< names without a prefix belong to another namespace than SVG's
  bool has_assignment{false}, has_layer{false};
  StrokeUse assignment;      ///< `data-assignment` of the element or its nearest ancestor with one
  StrokeUse layer;           ///< meaning of the nearest element whose name is known
  std::uint32_t unknown{};   ///< nearest element whose name is not known, see `SvgNames`; 0: none
  std::uint32_t sideless{};  ///< `layer` is a fold of unknown side or a score, see `SvgNames`
  std::uint8_t layer_pen{};  ///< pen of the nearest element whose name a person gave; 0: none

  // Not inherited.
  bool display_none{false}, masked{false}, filtered{false}, overflows{false};
  bool own_box{false};  ///< transform-box: percentages refer to the shape itself
  SvgOrigin origin;
  std::uint32_t clip{};  ///< for `SvgStyleReader::clip`; 0: none
};

/// "line 7 (id "a")" of a node.
[[nodiscard]] std::string svg_where(const SvgText& text, const pugi::xml_node& node);

/// Reads elements and computes their styles from attributes, style sheets by specificity, `style`,
/// and !important declarations.
class SvgStyleReader {
 public:
  /// @param user_mm  size of a user unit; work is taken from `steps`
  /// @param by_illustrator  a group with a known name is a layer, which need not be told
  SvgStyleReader(const SvgText& text, const StrokeProfile& profile, double user_mm,
                 bool by_illustrator, SvgNotes& notes, SvgNames& names, std::size_t& steps,
                 PenFinder& pens)
      : text_(text),
        profile_(profile),
        user_mm_(user_mm),
        by_illustrator_(by_illustrator),
        notes_(notes),
        names_(names),
        steps_(steps),
        pens_(pens) {}

  /// Reads the element `node` and computes its `style`; its parent has `inherited`. Does not do
  /// work beyond the remaining steps, which are then zero. The first element read is the root,
  /// whose namespace counts as SVG's even if its name is wrong or missing.
  /// @retval OutOfRange  a stroke-dasharray with too many numbers
  [[nodiscard]] Result<SvgElement> read(const pugi::xml_node& node, const SvgStyle& inherited,
                                        SvgStyle& style);

  /// The name of `node` without its prefix; empty if the prefix is not that of SVG. Names without
  /// prefix are returned as they are.
  [[nodiscard]] std::string_view svg_name(const pugi::xml_node& node);

  [[nodiscard]] CssSheets& sheets() { return sheets_; }
  [[nodiscard]] std::span<const SvgLength> dashes(std::uint32_t index) const {
    return dash_lists_[index];
  }
  /// The id of a clip path; empty if it is not in the drawing itself: a shape of CSS, another file.
  [[nodiscard]] const std::string& clip(std::uint32_t index) const { return clips_[index]; }

 private:
  enum class Property : std::uint8_t;
  static Property property_of(std::string_view name);
  std::string_view namespace_of(pugi::xml_node node, std::string_view prefix);
  void read_attributes(const SvgStyle& inherited, SvgElement& element, SvgStyle& style);
  void apply_sheets(const SvgStyle& inherited, const SvgElement& element, SvgStyle& style,
                    std::string_view own);
  bool apply_all(std::string_view declarations, bool important, const SvgStyle& inherited,
                 const SvgElement& element, SvgStyle& style);
  void apply(Property property, std::string_view value, const SvgStyle& inherited,
             const SvgElement& element, SvgStyle& style, bool is_attribute);
  static bool sets_shape(Property property, std::string_view value, const SvgElement& element);
  void set_clip(SvgStyle& style, std::string_view value);
  bool set_paint(SvgPaint& paint, std::string_view value);
  bool set_dashes(SvgStyle& style, std::string_view value);
  void set_font(SvgFont& font, const std::optional<SvgLength>& size,
                const SvgFont& inherited) const;
  void read_names(SvgElement& element, SvgStyle& style);
  void read_pen(const SvgElement& element, SvgStyle& style);
  void read_name(const SvgElement& element, SvgStyle& style);
  void read_root_name(const SvgElement& element, SvgStyle& style);
  void set_layer(LayerMeaning meaning, std::string_view name, SvgStyle& style);
  [[nodiscard]] LayerMeaning meaning_of_names(const SvgElement& element, std::string& known,
                                              std::string& unknown);

  const SvgText& text_;
  const StrokeProfile& profile_;
  double user_mm_;
  bool by_illustrator_;
  SvgNotes& notes_;
  SvgNames& names_;
  std::size_t& steps_;
  PenFinder& pens_;
  CssSheets sheets_;
  std::vector<const CssRule*> found_;
  std::vector<std::string> clips_{{}};
  std::vector<std::vector<SvgLength>> dash_lists_{{}};
  std::unordered_map<std::string, std::uint32_t> known_dashes_;
  bool too_many_dashes_{false};
  std::optional<std::string_view> root_namespace_;
  std::string_view root_prefix_;
};

/// Visits `root` and all elements below it in document order, without recursion.
template <typename Visit>
void each_svg_element(const pugi::xml_node& root, Visit visit) {
  pugi::xml_node node = root;
  while (node) {
    if (node.type() == pugi::node_element) visit(node);
    if (node.first_child()) {
      node = node.first_child();
      continue;
    }
    while (node != root && !node.next_sibling()) node = node.parent();
    if (node == root) return;
    node = node.next_sibling();
  }
}

/// Reads all <style> elements of a document; adds a note for what it does not understand.
///
/// @retval OutOfRange  too many selectors; place is that of the <style> element
[[nodiscard]] Result<void> read_svg_sheets(const SvgText& text, const pugi::xml_node& root,
                                           CssSheets& sheets, SvgNotes& notes);

/// What a shape is for.
struct SvgPurpose {
  StrokeUse use;
  bool fill{false};     ///< the shape has no stroke: use the outline of its fill
  std::uint8_t pen{0};  ///< see `PenOperation`
};

/// Decides what the shapes of one drawing are for: by their names, else by the profile.
class SvgPurposes {
 public:
  /// @param looks  collect how strokes look whose purpose is not known
  SvgPurposes(const SvgText& text, const StrokeProfile& profile, SvgNotes& notes, SvgNames& names,
              PenFinder& pens, bool looks)
      : text_(text), profile_(profile), notes_(notes), names_(names), pens_(pens), looks_(looks) {}

  /// What the shape `e` is for. None if it is invisible, or if its fill does not count; this adds a
  /// note.
  [[nodiscard]] std::optional<SvgPurpose> of(const SvgElement& e, const SvgStyle& style,
                                             const SvgDashes& dashes);
  /// Whether any shape so far had a name.
  [[nodiscard]] bool has_names() const { return has_names_; }
  /// What a drawing's strokes are for cannot be told, and the profile `asks`: names are not known
  /// beside names that are, or strokes without a meaning have several colours.
  ///
  /// @retval Malformed  the reason is Unclear; place: the first such name, or the first stroke of a
  ///                    second colour
  [[nodiscard]] Result<void> clear() const;
  /// Moves what was collected to `work`, with the option that `clear` would ask for.
  void tell_looks(LineWork& work);
  /// A warning if strokes of several colours all got the same purpose; else empty.
  [[nodiscard]] std::string colour_warning() const;
  /// A warning if other strokes have names, and those without one look different from the named
  /// cuts, or like named folds; else empty.
  [[nodiscard]] std::string name_warning() const;
  /// A warning if no name of the drawing is known, and its strokes have different ones; else empty.
  [[nodiscard]] std::string unknown_warning() const;
  /// Where the first stroke without a meaning is.
  [[nodiscard]] const std::string& first_unnamed() const { return first_colour_; }

 private:
  const SvgText& text_;
  const StrokeProfile& profile_;
  SvgNotes& notes_;
  SvgNames& names_;
  PenFinder& pens_;
  LookFinder looks_;
  [[nodiscard]] std::string colour_list() const;
  /// Whether strokes have colours that somebody must explain: two, or one that is not
  /// black if cuts have another.
  [[nodiscard]] bool is_open() const;
  [[nodiscard]] std::optional<SvgPurpose> meaning(const SvgElement& e, const SvgStyle& style,
                                                  const SvgDashes& dashes, bool stroked);

  std::vector<std::uint32_t> colours_;        ///< the first colours that no rule knows
  std::string first_colour_, second_colour_;  ///< where the first two of them are first used
  std::vector<std::uint32_t> cut_colours_;    ///< of strokes with names: those that are cut
  std::vector<std::uint32_t> other_colours_;  ///< and the others
  bool has_names_{false};
  bool cut_is_said_{false};                   ///< a rule about colours cuts some strokes
  std::optional<std::uint32_t> first_drawn_;  ///< the name around the first stroke without one
  bool differ_{false};                        ///< another such stroke has another name
};

}  // namespace popcut
