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

Wording wording(SvgNote note) {
  switch (note) {
    case SvgNote::Dashed:
      return {"line is dashed by its style and is cut as those dashes",
              "lines are dashed by their style and are cut as those dashes", ""};
    case SvgNote::Dots:
      return {"line is dashed into dots without length, which cannot be cut",
              "lines are dashed into dots without length, which cannot be cut",
              "give the dashes a length"};
    case SvgNote::FillCut:
      return {"shape has a fill but no stroke and is cut along its outline",
              "shapes have a fill but no stroke and are cut along their outlines", ""};
    case SvgNote::FillIgnored:
      return {"shape has a fill but no stroke and is left out",
              "shapes have a fill but no stroke and are left out",
              "give them a stroke, or use `svg-profile` plain"};
    case SvgNote::FillBackground:
      return {"shape filled white or as large as the page is taken for background and left out",
              "shapes filled white or as large as the page are taken for background and left out",
              "give them a stroke to cut them"};
    case SvgNote::FillUnnamed:
      return {
          "shape with a fill but no stroke and no name is left out, for other lines have names",
          "shapes with a fill but no stroke and no name are left out, for other lines have names",
          "give them a stroke or a data-assignment, or use `svg-profile` plain"};
    case SvgNote::Invisible:
      return {"shape has neither stroke nor fill and is left out",
              "shapes have neither stroke nor fill and are left out", "give them a stroke"};
    case SvgNote::LeftOut:
      return {"stroke is for nothing that is cut or folded and is left out",
              "strokes are for nothing that is cut or folded and are left out",
              "`svg-profile` says what colours and names mean"};
    case SvgNote::Hidden:
      return {"hidden layer, group or shape is left out",
              "hidden layers, groups or shapes are left out", "show them to cut them"};
    case SvgNote::Squashed:
      return {"shape or group is squashed to nothing by its transform",
              "shapes or groups are squashed to nothing by their transforms", ""};
    case SvgNote::Empty:
      return {"shape has no size and is left out", "shapes have no size and are left out", ""};
    case SvgNote::Clipped:
      return {"element has a clip path, which is not applied: it is cut whole",
              "elements have a clip path, which is not applied: they are cut whole",
              "apply the clip in the editor"};
    case SvgNote::Masked:
      return {"element has a mask, which is not applied: it is cut whole",
              "elements have a mask, which is not applied: they are cut whole",
              "apply the mask in the editor"};
    case SvgNote::Filtered:
      return {"element has a filter, which is not applied",
              "elements have a filter, which is not applied", ""};
    case SvgNote::Marked:
      return {"line has markers (arrow heads), which are left out",
              "lines have markers (arrow heads), which are left out", "turn them into paths"};
    case SvgNote::PaintServer:
      return {"stroke is painted with a gradient or pattern and is read as a plain line",
              "strokes are painted with gradients or patterns and are read as plain lines",
              "give them a colour"};
    case SvgNote::OutOfFrame:
      return {"line leaves the frame of its <svg> or <symbol> and is cut inside it only",
              "lines leave the frame of their <svg> or <symbol> and are cut inside it only",
              "set overflow=\"visible\" there to cut them whole"};
    case SvgNote::ForeignUse:
      return {"<use> of another file is left out, for nothing is fetched",
              "<use> of other files are left out, for nothing is fetched",
              "copy it into the drawing"};
    case SvgNote::MissingUse:
      return {"<use> of something that is not there is left out",
              "<use> of something that is not there are left out", ""};
    case SvgNote::ForeignSheet:
      return {"style sheet of another file is not read, for nothing is fetched",
              "style sheets of other files are not read, for nothing is fetched",
              "put it into a <style> element"};
    case SvgNote::Selector:
      return {"selector of a style sheet is not known and is passed over",
              "selectors of style sheets are not known and are passed over",
              "type, .class, #id, [attribute], descendant and child are"};
    case SvgNote::SheetBlock:
      return {"block of a style sheet is not known and is passed over",
              "blocks of style sheets are not known and are passed over", ""};
    case SvgNote::Value:
      return {"style is not understood and is passed over",
              "styles are not understood and are passed over", ""};
    case SvgNote::SheetGeometry:
      return {"style sets a shape or a transform, which is read from attributes only",
              "styles set a shape or a transform, which are read from attributes only",
              "write them as attributes"};
    case SvgNote::Assignment:
      return {"data-assignment is not known and is passed over",
              "data-assignments are not known and are passed over", "B M V C F U J are"};
    case SvgNote::Count_:
      break;
  }
  return {"", "", ""};
}

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
    const Wording w = wording(static_cast<SvgNote>(i));
    out.push_back(sentence(entry.count, entry.count == 1 ? w.one : w.many, entry.first, w.advice));
  }
  return out;
}

}  // namespace popcut
