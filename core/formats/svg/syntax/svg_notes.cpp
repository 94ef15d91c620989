// SPDX-License-Identifier: MIT
#include "core/formats/svg/syntax/svg_notes.hpp"

#include <fmt/format.h>

namespace popcut {
namespace {

struct Wording {
  const char* one;
  const char* many;
  const char* advice;
};

/// One row per note, in their order.
constexpr std::array<Wording, static_cast<std::size_t>(SvgNote::Count_)> kWordings{{
    {"line has a dashed style and is cut as dashes",
     "lines have a dashed style and are cut as dashes", ""},
    {"line consists of dots without length, which cannot be cut",
     "lines consist of dots without length, which cannot be cut", "give the dashes a length"},
    {"shape has a fill but no stroke and is cut along its outline",
     "shapes have a fill but no stroke and are cut along their outlines", ""},
    {"shape has a fill but no stroke and is left out",
     "shapes have a fill but no stroke and are left out",
     "give them a stroke, or use `svg-profile` plain"},
    {"shape filled white or as large as the page counts as background and is left out",
     "shapes filled white or as large as the page count as background and are left out",
     "give them a stroke to cut them"},
    {"shape with a fill but no stroke and no name is left out because other lines have names",
     "shapes with a fill but no stroke and no name are left out because other lines have "
     "names",
     "give them a stroke or a data-assignment, or use `svg-profile` plain"},
    {"shape has neither stroke nor fill and is left out",
     "shapes have neither stroke nor fill and are left out", "give them a stroke"},
    {"stroke is neither a cut nor a fold and is left out",
     "strokes are neither cuts nor folds and are left out",
     "see `svg-profile` for the meaning of colours and names"},
    {"hidden layer, group or shape is left out", "hidden layers, groups or shapes are left out",
     "show them to cut them"},
    {"shape or group has no size after its transform",
     "shapes or groups have no size after their transforms", ""},
    {"shape has no size and is left out", "shapes have no size and are left out", ""},
    {"element has a clip path, which popcut does not apply: it is cut whole",
     "elements have a clip path, which popcut does not apply: they are cut whole",
     "apply the clip in the editor"},
    {"element has a mask, which popcut does not apply: it is cut whole",
     "elements have a mask, which popcut does not apply: they are cut whole",
     "apply the mask in the editor"},
    {"element has a filter, which popcut does not apply",
     "elements have a filter, which popcut does not apply", ""},
    {"line has markers (arrow heads), which are left out",
     "lines have markers (arrow heads), which are left out", "turn them into paths"},
    {"stroke is painted with a gradient or pattern and is read as a plain line",
     "strokes are painted with gradients or patterns and are read as plain lines",
     "give them a colour"},
    {"line leaves the frame of its <svg> or <symbol> and is cut only inside it",
     "lines leave the frame of their <svg> or <symbol> and are cut only inside it",
     "set overflow=\"visible\" there to cut them whole"},
    {"<use> of another file is left out because popcut fetches nothing",
     "<use> of other files are left out because popcut fetches nothing",
     "copy it into the drawing"},
    {"<use> of a missing element is left out", "<use> of missing elements are left out", ""},
    {"style sheet in another file is not read because popcut fetches nothing",
     "style sheets in other files are not read because popcut fetches nothing",
     "put it into a <style> element"},
    {"selector of a style sheet is unknown and ignored",
     "selectors of style sheets are unknown and ignored",
     "use type, .class, #id, [attribute], descendant or child selectors"},
    {"block of a style sheet is unknown and ignored",
     "blocks of style sheets are unknown and ignored", ""},
    {"style cannot be read and is ignored", "styles cannot be read and are ignored", ""},
    {"style sets a shape or a transform, which popcut reads from attributes only",
     "styles set a shape or a transform, which popcut reads from attributes only",
     "write them as attributes"},
    {"data-assignment is unknown and ignored", "data-assignments are unknown and ignored",
     "use B, M, V, C, F, U or J"},
}};

std::string sentence(std::size_t count, std::string_view what, const std::string& first,
                     std::string_view advice) {
  std::string text = fmt::format("{} {}", count, what);
  if (!first.empty()) text += fmt::format("; {} {}", count == 1 ? "at" : "the first at", first);
  if (!advice.empty()) text += fmt::format("; {}", advice);
  return text;
}

}  // namespace

std::vector<std::string> SvgNotes::sentences() const {
  std::vector<std::string> out;
  for (const auto& [name, entry] : elements_) {
    const std::string what =
        fmt::format("<{}> cannot be read and {} left out", name, entry.count == 1 ? "is" : "are");
    out.push_back(sentence(entry.count, what, entry.first,
                           entry.count == 1 ? "turn it into paths" : "turn them into paths"));
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.count == 0) continue;
    const Wording& w = kWordings[i];
    out.push_back(sentence(entry.count, entry.count == 1 ? w.one : w.many, entry.first, w.advice));
  }
  return out;
}

}  // namespace popcut
