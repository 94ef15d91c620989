// SPDX-License-Identifier: MIT
#include "daemon/planning/plan_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/formats/dxf/dxf_binary.hpp"
#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/fold/crease_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/judge/glue_guide.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_design.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/judge/sound_slices.hpp"
#include "core/layout/layout.hpp"
#include "core/layout/marks.hpp"
#include "core/plan/plan.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/gzip.hpp"
#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"
#include "daemon/pictures/pdf_page.hpp"
#include "daemon/planning/design_files.hpp"

namespace popcut::planning {
namespace {

void add_warnings(const PatchAssembly& made, LineWork& drawing) {
  for (const Design& part : made.parts)
    drawing.warnings.insert(drawing.warnings.end(), part.report.warnings.begin(),
                            part.report.warnings.end());
}

/// The outline of a tab or of its place, a little within it, so that the glued tab hides it.
std::vector<Vec2> within_outline(const std::vector<Vec2>& outline) {
  constexpr double kWithin_mm = 0.5;
  std::vector<Vec2> out;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 p = outline[k];
    const Vec2 before = unit(Vec2(p - outline[(k + outline.size() - 1) % outline.size()])),
               after = unit(Vec2(outline[(k + 1) % outline.size()] - p));
    const double turn = cross(before, after);
    // Square to the sides where it is straight on; else where both moved sides meet.
    out.push_back(std::abs(turn) < 1e-6 ? Vec2(p + kWithin_mm * Vec2(-after.y(), after.x()))
                                        : Vec2(p + kWithin_mm / turn * (after - before)));
  }
  return out;
}

/// Draws the letter of a tab in the middle of an outline, u to the right and v up.
void add_letter(const std::string& letter, const std::vector<Vec2>& outline,
                std::vector<std::vector<Vec2>>& lines) {
  constexpr double kMost_mm = 3.0, kOfDepth = 0.45;
  Vec2 middle{0.0, 0.0};
  double twice = 0.0, longest = 1e-9;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vec2 &p = outline[k], &q = outline[(k + 1) % outline.size()];
    middle += p / static_cast<double>(outline.size());
    twice += cross(p, q), longest = std::max(longest, norm(Vec2(q - p)));
  }
  const double high = std::min(kMost_mm, kOfDepth * 0.5 * std::abs(twice) / longest);
  const PagePoint size = single_stroke_size(letter, high);
  for (const auto& stroke : single_stroke(letter, high)) {
    auto& line = lines.emplace_back();
    for (const PagePoint& p : stroke)
      line.push_back(middle + Vec2{p.x - 0.5 * size.x, 0.5 * size.y - high - p.y});
  }
}

/// What is printed on the parts for who glues them. On a part's page x is v and y is u.
void add_glue_marks(const judge::GlueGuide& guide, std::span<const LineWork> sheets,
                    DrawingInput& out) {
  const auto add = [&](std::size_t part, const std::vector<std::vector<Vec2>>& lines) {
    const double by = out.parts[part].box.x0 - bounds(sheets[part]).x0;
    for (const auto& line : lines) {
      for (const Vec2& p : line) out.glue_marks.points.push_back({p.y() + by, p.x()});
      out.glue_marks.ends.push_back(static_cast<std::uint32_t>(out.glue_marks.points.size()));
    }
  };
  for (const judge::GlueTab& tab : guide.tabs) {
    std::vector<std::vector<Vec2>> on_tab, on_place;
    add_letter(tab.letter, tab.outline, on_tab);
    add(tab.part, on_tab);
    // Corners of a tab that is turned over run the other way round.
    std::vector<Vec2> place = tab.place;
    if (cross(Vec2(place[1] - place[0]), Vec2(place[2] - place[1])) < 0.0)
      std::reverse(place.begin(), place.end());
    on_place.push_back(within_outline(place));
    on_place.back().push_back(on_place.back().front());
    add_letter(tab.letter, tab.place, on_place);
    add(tab.on_part, on_place);
  }
}

/// The parts of a card of several parts, each a piece of its own, with its letters.
Result<DrawingInput> from_parts(const std::string& text, const FoldLimits& limits,
                                const SvgReadOptions& how) {
  auto sheets = sheets_from_fold(text, limits, how.unit_mm, how.enlarged);
  if (!sheets) return tl::unexpected(sheets.error());
  DrawingInput out = side_by_side(*sheets);
  const auto guide = judge::glue_guide(text);
  if (!guide) {
    out.drawing.warnings.push_back(
        {.code = "no_glue_guide",
         .message = fmt::format("nothing says where the parts are glued: {}",
                                popcut::message(guide.error()))});
    return out;
  }
  out.drawing.name = guide->name;
  out.tabs = guide->tabs.size();
  for (const judge::GluePart& part : guide->parts) out.waste += part.folds.waste.size();
  if (!how.unit_mm) add_glue_marks(*guide, *sheets, out);
  return out;
}

/// The parts of a card that was designed, with its warnings.
template <typename Sound>
Result<DrawingInput> from_sound(const DesignSpec& spec, const Result<Sound>& sound,
                                const SvgReadOptions& how) {
  if (!sound) return tl::unexpected(sound.error());
  auto out = from_parts(sound->fold, FoldLimits{}, how);
  if (!out) return out;
  std::vector<Warning>& warnings = out->drawing.warnings;
  warnings.insert(warnings.end(), sound->made.warnings.begin(), sound->made.warnings.end());
  out->drawing.name = spec.name;
  out->material = spec.material, out->pens = spec.pens;
  return out;
}

Result<DrawingInput> from_layers(const DesignSpec& spec, const SpecSources& sources,
                                 const SurfaceAssets& assets, const SvgReadOptions& how) {
  const auto sound = judge::sound_layers(spec, assets, "popcut", sources.progress);
  if (sound && sources.layered)
    if (const auto kept = sources.layered(spec, sound->made); !kept)
      return tl::unexpected(kept.error());
  return from_sound(spec, sound, how);
}

Result<DrawingInput> from_slices(const DesignSpec& spec, const SpecSources& sources,
                                 const SurfaceAssets& assets, const SvgReadOptions& how) {
  if (sources.sliced)
    if (const auto wanted = sources.sliced(); !wanted) return tl::unexpected(wanted.error());
  return from_sound(spec, judge::sound_slices(spec, assets, "popcut", sources.progress), how);
}

Result<DrawingInput> from_boxes(const DesignSpec& spec, const SpecSources& sources,
                                const SurfaceAssets& assets, const SvgReadOptions& how) {
  const auto sound = judge::sound_boxes(spec, assets, "popcut", sources.progress);
  if (sound && sources.boxed)
    if (const auto kept = sources.boxed(spec, sound->made); !kept)
      return tl::unexpected(kept.error());
  return from_sound(spec, sound, how);
}

Result<DrawingInput> from_spec(const std::string& text, const SpecSources& sources,
                               const SvgReadOptions& how) {
  auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(spec.error());
  // An unknown material is an error of the plan, which may name another one.
  if (const auto own = find_material(spec->material, sources.tables)) suit_material(*own, *spec);
  const auto assets = sources.assets(*spec);
  if (!assets) return tl::unexpected(assets.error());
  if (spec->style == DesignStyle::Layers) return from_layers(*spec, sources, *assets, how);
  if (spec->style == DesignStyle::Slices) return from_slices(*spec, sources, *assets, how);
  if (is_of_boxes(*spec)) return from_boxes(*spec, sources, *assets, how);
  auto made = judge::sound_design(*spec, *assets, sources.progress);
  if (!made) return tl::unexpected(made.error().error);
  const std::string& cut_from = sources.material.empty() ? spec->material : sources.material;
  if (const auto material = find_material(cut_from, sources.tables))
    for (Design& part : made->parts) add_make_warnings(*material, *spec, part);
  if (sources.designed)
    if (const auto kept = sources.designed(*spec, *made); !kept)
      return tl::unexpected(kept.error());
  if (made->parts.size() > 1) {
    std::vector<const Pattern*> parts;
    for (const Design& part : made->parts) parts.push_back(&part.pattern);
    JoinedParts joined = join_parts(parts);
    joined.drawing.name = made->name;
    // The cards of a book lie side by side; each is a piece of its own.
    for (std::size_t p = 1; made->book && p < parts.size(); ++p)
      joined.seams_x.push_back(
          0.5 * (parts[p - 1]->place.v_mm + parts[p - 1]->width_mm + parts[p]->place.v_mm));
    add_warnings(*made, joined.drawing);
    DrawingInput out{std::move(joined.drawing), spec->material, spec->pens,
                     std::move(joined.seams_x)};
    for (const Design& part : made->parts) out.waste += part.report.handwork.waste;
    for (std::size_t p = 0; made->book && p < parts.size(); ++p) {
      const Pattern& card = *parts[p];
      const double x = card.place.v_mm, y = card.place.u_mm;
      out.parts.push_back({fmt::format("card {}", p + 1),
                           {x, y, x + card.width_mm, y + card.wall_mm + card.ground_mm}});
    }
    return out;
  }
  LineWork drawing = linework_from_pattern(made->parts.front().pattern);
  add_warnings(*made, drawing);
  DrawingInput out{std::move(drawing), spec->material, spec->pens};
  out.waste = made->parts.front().report.handwork.waste;
  return out;
}

Result<DrawingInput> only_drawing(Result<LineWork> drawing) {
  if (!drawing) return tl::unexpected(drawing.error());
  return DrawingInput{std::move(*drawing), std::nullopt};
}

Result<DrawingInput> from_dxf(const std::string& text, const SvgReadOptions& how, unsigned factor) {
  DxfOptions options = DxfOptions{}.raised(factor);
  if (how.profile.asks) options.colours = DxfColours::Asked;
  if (how.profile.name == "origami-sim") options.colours = DxfColours::OrigamiSim;
  if (how.profile.name == "lightburn") options.colours = DxfColours::Lightburn;
  options.tolerance_mm = how.tolerance_mm;
  options.unit_mm = how.unit_mm;
  options.pens = how.pens;
  options.layers = how.profile.labels;
  options.said = how.profile.colours;
  options.looks = how.looks;
  return only_drawing(linework_from_dxf(text, options));
}

Result<DrawingInput> from_fold(const std::string& text, const SvgReadOptions& how,
                               unsigned factor) {
  if (is_crease_pattern(text)) {
    const auto fold = fold_of_crease_pattern(text);
    if (!fold) return tl::unexpected(fold.error());
    return only_drawing(
        linework_from_fold(*fold, FoldLimits{}.raised(factor), how.unit_mm, how.enlarged));
  }
  const FoldLimits limits = FoldLimits{}.raised(factor);
  if (lists_joints(text)) return from_parts(text, limits, how);
  return only_drawing(linework_from_fold(text, limits, how.unit_mm, how.enlarged));
}

Result<DrawingInput> from_pdf(const std::string& text, const SvgReadOptions& how) {
  auto page = pictures::pdf_page(text, how.pdf_page);
  if (!page) return tl::unexpected(page.error());
  auto drawing = linework_from_svg(std::move(page->svg), how);
  if (!drawing) return tl::unexpected(drawing.error());
  drawing->warnings.insert(drawing->warnings.begin(), page->warnings.begin(), page->warnings.end());
  return only_drawing(std::move(drawing));
}

/// Looks at the keys of the outermost object until one decides; never keeps a value.
class TopKeys : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::optional<InputKind> kind;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kDeepest; }
  bool end_object() override { return --depth_ >= 0; }
  bool start_array(std::size_t) override { return ++depth_ <= kDeepest; }
  bool end_array() override { return --depth_ >= 0; }
  bool key(string_t& name) override {
    if (depth_ != 1) return true;
    if (name == "popcut") kind = InputKind::Spec;
    if (name == "file_spec" || name == "vertices_coords") kind = InputKind::Fold;
    return !kind;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  static constexpr int kDeepest = 64;
  int depth_{0};
};

}  // namespace

Result<DrawingInput> drawing_from_text(std::string text, InputKind kind, const SvgReadOptions& how,
                                       unsigned factor, const SpecSources& sources) {
  if (how.unit_mm && (kind == InputKind::Spec || kind == InputKind::Svg || kind == InputKind::Pdf))
    return fail(ErrorKind::Usage, "/options/units",
                kind == InputKind::Spec
                    ? "is for DXF and FOLD files, and a design is in mm; use `scale` or `width`"
                : kind == InputKind::Pdf
                    ? "is for DXF and FOLD files, and a PDF has its size; use `scale` or `width`"
                    : "is for DXF and FOLD files; for an SVG use `svg-dpi`, `scale` or `width`");
  switch (kind) {
    case InputKind::Spec:
      return from_spec(text, sources, how);
    case InputKind::Fold:
      return from_fold(text, how, factor);
    case InputKind::Dxf:
      return from_dxf(text, how, factor);
    case InputKind::Pdf:
      return from_pdf(text, how);
    case InputKind::Svg:
      break;
  }
  return only_drawing(linework_from_svg(std::move(text), how));
}

DrawingInput side_by_side(std::span<const LineWork> sheets) {
  constexpr double kApart_mm = 10.0;
  DrawingInput out;
  double end = 0.0;
  std::vector<PagePoint> moved;
  for (const LineWork& sheet : sheets) {
    const Box box = bounds(sheet);
    const bool is_first = out.parts.empty();
    if (!is_first) out.seams_x.push_back(end + 0.5 * kApart_mm);
    const double by = is_first ? -box.x0 : end + kApart_mm - box.x0;
    for (const DrawnLine& line : sheet.lines) {
      const auto points = sheet.points_of(line);
      moved.assign(points.begin(), points.end());
      for (PagePoint& p : moved) p.x += by;
      out.drawing.append(line.operation, moved);
    }
    out.parts.push_back({sheet.name, {box.x0 + by, box.y0, box.x1 + by, box.y1}});
    out.drawing.warnings.insert(out.drawing.warnings.end(), sheet.warnings.begin(),
                                sheet.warnings.end());
    end = box.x0 + by + box.width();
  }
  return out;
}

DrawingInput test_shape_input() { return {test_shape(), std::nullopt, {}, {}, PagePoint{5, 5}}; }

Result<InputKind> kind_of_content(std::string_view text) {
  constexpr const char* kRight =
      "is not a design (JSON with \"popcut\") or a FOLD (\"file_spec\"), SVG, DXF or PDF "
      "file";
  std::string kept;
  text = plain_text(text, kept);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return fail(ErrorKind::Malformed, "", "is empty");
  if (is_binary_dxf(text)) return InputKind::Dxf;
  if (is_gzip(text)) return InputKind::Svg;
  if (pictures::is_pdf(text)) return InputKind::Pdf;
  if (is_crease_pattern(text)) return InputKind::Fold;
  if (const std::string foreign = foreign_advice(text); !foreign.empty())
    return fail(ErrorKind::Malformed, "", foreign);
  if (text[first] == '<') return InputKind::Svg;
  if (text[first] >= '0' && text[first] <= '9') return InputKind::Dxf;
  if (text[first] != '{') return fail(ErrorKind::Malformed, "", kRight);
  TopKeys keys;
  nlohmann::json::sax_parse(text.begin(), text.end(), &keys);
  if (keys.kind) return *keys.kind;
  if (const auto whole = parse_json(text); !whole) return tl::unexpected(whole.error());
  return fail(ErrorKind::Malformed, "", kRight);
}

std::string_view name_of(InputKind kind) {
  constexpr std::array<std::string_view, 5> kNames{"spec", "fold", "svg", "dxf", "pdf"};
  return kNames.at(static_cast<std::size_t>(kind));
}

Result<InputKind> input_kind_from(std::string_view name) {
  for (const InputKind kind :
       {InputKind::Spec, InputKind::Fold, InputKind::Svg, InputKind::Dxf, InputKind::Pdf})
    if (name_of(kind) == name) return kind;
  return fail(ErrorKind::OutOfRange, "/design_kind",
              fmt::format("is \"{}\"; give spec, fold, svg, dxf or pdf", name.substr(0, 40)));
}

}  // namespace popcut::planning
