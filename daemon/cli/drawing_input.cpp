// SPDX-License-Identifier: MIT
#include "daemon/cli/drawing_input.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "core/design/patches.hpp"
#include "core/formats/dxf_reader.hpp"
#include "core/formats/fold_reader.hpp"
#include "core/layout/joined_parts.hpp"
#include "daemon/cli/output_folder.hpp"
#include "daemon/cli/spec_assets.hpp"

namespace popcut::cli {
namespace {

Result<DrawingInput> from_spec(const std::string& text, const std::string& file) {
  const auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(spec.error());
  const auto assets = load_assets(*spec, file);
  if (!assets) return tl::unexpected(assets.error());
  const auto made = design_assembly(*spec, *assets);
  if (!made) return tl::unexpected(made.error());
  if (made->parts.size() > 1) {
    std::vector<const Pattern*> parts;
    for (const Design& part : made->parts) parts.push_back(&part.pattern);
    JoinedParts joined = join_parts(parts);
    joined.drawing.name = made->name;
    return DrawingInput{std::move(joined.drawing), spec->material, std::move(joined.seams_x)};
  }
  return DrawingInput{linework_from_pattern(made->parts.front().pattern), spec->material, {}};
}

Result<DrawingInput> only_drawing(Result<LineWork> drawing) {
  if (!drawing) return tl::unexpected(drawing.error());
  return DrawingInput{std::move(*drawing), std::nullopt, {}};
}

Result<DrawingInput> from_dxf(const std::string& text, const SvgReadOptions& how, unsigned factor) {
  DxfOptions options = DxfOptions{}.raised(factor);
  if (how.profile.name == "origami-sim") options.colours = DxfColours::OrigamiSim;
  if (how.profile.name == "lightburn") options.colours = DxfColours::Lightburn;
  options.tolerance_mm = how.tolerance_mm;
  return only_drawing(linework_from_dxf(text, options));
}

Result<DrawingInput> from_fold(const std::string& text, unsigned factor) {
  return only_drawing(linework_from_fold(text, FoldLimits{}.raised(factor)));
}

Result<DrawingInput> from_text(std::string text, const std::string& file, const std::string& ending,
                               const SvgReadOptions& how, unsigned factor) {
  if (ending == ".svg") return only_drawing(linework_from_svg(std::move(text), how));
  if (ending == ".fold") return from_fold(text, factor);
  if (ending == ".json") return from_spec(text, file);
  if (ending == ".dxf") return from_dxf(text, how, factor);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && text[first] == '<')
    return only_drawing(linework_from_svg(std::move(text), how));
  if (first != std::string::npos && text[first] == '{')
    return text.find("\"vertices_coords\"") == std::string::npos ? from_spec(text, file)
                                                                 : from_fold(text, factor);
  return fail(ErrorKind::Malformed, "",
              "is neither a spec (.json) nor a drawing (.fold, .svg, .dxf) that popcut reads");
}

// What is read of a file before it is known what is in it; a spec is small.
std::size_t most_bytes(const std::string& ending, const SvgReadOptions& how, unsigned factor) {
  if (ending == ".svg") return how.limits.bytes;
  if (ending == ".dxf") return DxfOptions{}.raised(factor).most_bytes;
  return FoldLimits{}.raised(factor).bytes;
}

// How much more than usual a drawing may take.
Result<unsigned> raised_limits() {
  const char* const text = std::getenv("POPCUT_RAISE_LIMITS");
  if (text == nullptr || *text == '\0') return 1u;
  char* end = nullptr;
  const long factor = std::strtol(text, &end, 10);
  if (*end == '\0' && factor >= 1 && factor <= 100) return static_cast<unsigned>(factor);
  return fail(ErrorKind::Usage, "POPCUT_RAISE_LIMITS",
              fmt::format("is \"{}\"; a whole number from 1 to 100 is needed, as 4",
                          std::string_view(text).substr(0, 40)));
}

}  // namespace

Result<DrawingInput> read_drawing(const std::string& file, SvgReadOptions how) {
  const auto factor = raised_limits();
  if (!factor) return tl::unexpected(factor.error());
  how.limits = how.limits.raised(*factor);
  std::string ending = std::filesystem::path(file).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const std::size_t most = most_bytes(ending, how, *factor);
  auto text = read_file(file, most);
  if (!text && text.error().detail.find("is larger than") == 0)
    return fail(ErrorKind::OutOfRange, file,
                fmt::format("is larger than {} bytes; simplify it, or set POPCUT_RAISE_LIMITS={}",
                            most, std::min(100u, 4 * *factor)));
  if (!text) return tl::unexpected(text.error());
  auto input = from_text(std::move(*text), file, ending, how, *factor);
  if (!input) return tl::unexpected(within(file, input.error()));
  if (input->drawing.name.empty())
    input->drawing.name = std::filesystem::path(file).stem().string();
  return input;
}

Result<DrawingInput> read_drawing(const std::string& file, SvgProfile profile) {
  auto found = find_stroke_profile(svg_profile_name(profile));
  if (!found) return tl::unexpected(found.error());
  SvgReadOptions how;
  how.profile = std::move(*found);
  return read_drawing(file, std::move(how));
}

}  // namespace popcut::cli
