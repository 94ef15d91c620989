// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_notes.hpp"

#include <fmt/format.h>

namespace popcut {
namespace {

struct Wording {
  const char* code;
  bool spoils;
  const char* one;
  const char* many;
  const char* advice;
};

/// One row per note, in their order.
constexpr std::array<Wording, static_cast<std::size_t>(SvgNote::Count_)> kWordings{{
    {"dashed_line", false, "line has a dashed style and is cut as dashes",
     "lines have a dashed style and are cut as dashes", ""},
    {"dots", true, "line consists of dots without length, which cannot be cut",
     "lines consist of dots without length, which cannot be cut", "give the dashes a length"},
    {"fill_cut", false, "shape has a fill but no stroke and is cut along its outline",
     "shapes have a fill but no stroke and are cut along their outlines", ""},
    {"fill_left_out", true, "shape has a fill but no stroke and is left out",
     "shapes have a fill but no stroke and are left out",
     "give them a stroke, or use `svg-profile` plain"},
    {"fill_background", false,
     "shape filled white or as large as the page counts as background and is left out",
     "shapes filled white or as large as the page count as background and are left out",
     "give them a stroke to cut them"},
    {"fill_unnamed", true,
     "shape with a fill but no stroke and no name is left out because other lines have names",
     "shapes with a fill but no stroke and no name are left out because other lines have "
     "names",
     "give them a stroke or a data-assignment, or use `svg-profile` plain"},
    {"fills_cross", true, "filled shape has lines that lie over what it fills, and they are cut",
     "filled shapes lie over each other or themselves, and each is cut along its whole outline",
     "use `weld` to cut around them together"},
    {"invisible", false, "shape has neither stroke nor fill and is left out",
     "shapes have neither stroke nor fill and are left out", "give them a stroke"},
    {"stroke_left_out", true, "stroke is neither a cut nor a fold and is left out",
     "strokes are neither cuts nor folds and are left out",
     "see `svg-profile` for the meaning of colours and names"},
    {"hidden", false, "hidden layer, group or shape is left out",
     "hidden layers, groups or shapes are left out", "show them to cut them"},
    {"language", true,
     "part of the drawing depends on the reader's language, and popcut reads it as in English",
     "parts of the drawing depend on the reader's language, and popcut reads them as in English",
     "remove its systemLanguage"},
    {"needs_extension", true,
     "element asks for a feature or an extension that popcut does not have, and is left out",
     "elements ask for features or extensions that popcut does not have, and are left out",
     "remove its requiredExtensions or requiredFeatures to cut it"},
    {"moving", true, "part of the drawing moves (animation) and is read as it stands in the file",
     "parts of the drawing move (animation) and are read as they stand in the file",
     "save the drawing as it is to be cut"},
    {"script", true, "script is not run, and the drawing is read without it",
     "scripts are not run, and the drawing is read without them",
     "save the drawing as it is to be cut"},
    {"squashed", false, "shape or group has no size after its transform",
     "shapes or groups have no size after their transforms", ""},
    {"no_size", false, "shape has no size and is left out", "shapes have no size and are left out",
     ""},
    {"clipped", false, "line is cut only inside its clip path",
     "lines are cut only inside their clip paths", ""},
    {"clip_missing", true, "clip path is missing: what it clips is cut whole",
     "clip paths are missing: what they clip is cut whole", ""},
    {"clip_ignored", true, "clip path is not made of shapes: what it clips is cut whole",
     "clip paths are not made of shapes: what they clip is cut whole",
     "apply the clip in the editor"},
    {"mask_ignored", true, "element has a mask, which popcut does not apply: it is cut whole",
     "elements have a mask, which popcut does not apply: they are cut whole",
     "apply the mask in the editor"},
    {"filter_ignored", false, "element has a filter, which popcut does not apply",
     "elements have a filter, which popcut does not apply", ""},
    {"markers_left_out", false, "line has markers (arrow heads), which are left out",
     "lines have markers (arrow heads), which are left out", "turn them into paths"},
    {"paint_ignored", false,
     "stroke is painted with a gradient or pattern and is read as a plain line",
     "strokes are painted with gradients or patterns and are read as plain lines",
     "give them a colour"},
    {"out_of_frame", false,
     "line leaves the frame of its <svg> or <symbol> and is cut only inside it",
     "lines leave the frame of their <svg> or <symbol> and are cut only inside it",
     "set overflow=\"visible\" there to cut them whole"},
    {"beyond_page", true,
     "line lies wholly or partly beyond the page of the drawing, where viewers do not show it, and "
     "is read whole",
     "lines lie wholly or partly beyond the page of the drawing, where viewers do not show them, "
     "and are read whole",
     "remove what is not meant, or make the page as large as the drawing (Inkscape: Edit > Resize "
     "Page to Content), or set overflow=\"visible\" on the root <svg>"},
    {"symbol_point", true,
     "<symbol> has a refX or refY, which popcut does not apply, like most viewers",
     "<symbol> elements have a refX or refY, which popcut does not apply, like most viewers",
     "move their content instead"},
    {"other_file", true, "<use> of another file is left out because popcut fetches nothing",
     "<use> of other files are left out because popcut fetches nothing",
     "copy it into the drawing"},
    {"missing_element", true, "<use> of a missing element is left out",
     "<use> of missing elements are left out", ""},
    {"other_style_sheet", true,
     "style sheet in another file is not read because popcut fetches nothing",
     "style sheets in other files are not read because popcut fetches nothing",
     "put it into a <style> element"},
    {"selector_unknown", true, "selector of a style sheet is unknown and ignored",
     "selectors of style sheets are unknown and ignored",
     "use type, .class, #id, [attribute], descendant or child selectors"},
    {"style_block_unknown", false,
     "block of a style sheet is not for screens or not known, and is ignored",
     "blocks of style sheets are not for screens or not known, and are ignored", ""},
    {"style_unreadable", false, "style cannot be read and is ignored",
     "styles cannot be read and are ignored", ""},
    {"colour_unreadable", true, "colour cannot be read, so a line has that of what is around it",
     "colours cannot be read, so lines have those of what is around them",
     "write them such as #ff0000"},
    {"style_geometry", true,
     "style sets a shape or a transform, which popcut reads from attributes only",
     "styles set a shape or a transform, which popcut reads from attributes only",
     "write them as attributes"},
    {"transform_box", true,
     "transform has a transform-box, which popcut does not read: it turns about the wrong point",
     "transforms have a transform-box, which popcut does not read: they turn about wrong points",
     "give the transform-origin in units of the drawing"},
    {"group_named", false, "group is read by its name as a layer of that name",
     "groups are read by their names as layers of those names",
     "use `svg-profile` plain to ignore names"},
    {"shape_named", false, "line is what its id or class says",
     "lines are what their ids or classes say", "use `svg-profile` plain to ignore names"},
    {"stroke_zero", true, "stroke of width 0, which viewers do not show, is read as any other",
     "strokes of width 0, which viewers do not show, are read as any other",
     "set a stroke-width if it is right, or stroke=\"none\" to leave it out"},
    {"stroke_white", false, "stroke is white, which paper does not show, and is read as any other",
     "strokes are white, which paper does not show, and are read as any other",
     "say what they are for with `colors`, such as \"#ffffff=ignore\""},
    {"assignment_unknown", true, "data-assignment is unknown and ignored",
     "data-assignments are unknown and ignored", "use B, M, V, C, F, U or J"},
}};

std::string sentence(std::size_t count, std::string_view what, const std::string& first,
                     std::string_view advice) {
  std::string text = fmt::format("{} {}", count, what);
  if (!first.empty()) text += fmt::format("; {} {}", count == 1 ? "at" : "the first at", first);
  if (!advice.empty()) text += fmt::format("; {}", advice);
  return text;
}

}  // namespace

std::vector<Warning> SvgNotes::warnings() const {
  std::vector<Warning> out;
  for (const auto& [name, entry] : elements_) {
    const std::string what =
        fmt::format("<{}> cannot be read and {} left out", name, entry.count == 1 ? "is" : "are");
    std::string advice = entry.count == 1 ? "turn it into paths" : "turn them into paths";
    if (name == "text")
      advice += " (Inkscape: Path > Object to Path; Illustrator: Type > Create Outlines)";
    out.push_back({.code = "element_unread",
                   .message = sentence(entry.count, what, entry.first, advice),
                   .place = {.source = entry.first},
                   .spoils = name != "image"});
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.count == 0) continue;
    const Wording& w = kWordings[i];
    out.push_back(
        {.code = w.code,
         .message = sentence(entry.count, entry.count == 1 ? w.one : w.many, entry.first, w.advice),
         .place = {.source = entry.first},
         .spoils = w.spoils});
  }
  return out;
}

}  // namespace popcut
