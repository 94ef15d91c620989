// SPDX-License-Identifier: MIT
#include "daemon/cli/drawing_input.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "core/design/patches.hpp"
#include "core/formats/dxf_reader.hpp"
#include "core/formats/fold_reader.hpp"
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
  if (made->parts.size() > 1)
    return fail(ErrorKind::Infeasible, "/patches",
                fmt::format("makes {} patterns with seams between them; run popcut design, then "
                            "plan each part-NN/pattern.fold",
                            made->parts.size()));
  return DrawingInput{linework_from_pattern(made->parts.front().pattern), spec->material};
}

Result<DrawingInput> only_drawing(Result<LineWork> drawing) {
  if (!drawing) return tl::unexpected(drawing.error());
  return DrawingInput{std::move(*drawing), std::nullopt};
}

Result<DrawingInput> from_dxf(const std::string& text, SvgProfile profile) {
  DxfOptions options;
  if (profile == SvgProfile::OrigamiSim) options.colours = DxfColours::OrigamiSim;
  if (profile == SvgProfile::Lightburn) options.colours = DxfColours::Lightburn;
  return only_drawing(linework_from_dxf(text, options));
}

Result<DrawingInput> from_text(const std::string& text, const std::string& file,
                               const std::string& ending, SvgProfile profile) {
  if (ending == ".svg") return only_drawing(linework_from_svg(text, profile));
  if (ending == ".fold") return only_drawing(linework_from_fold(text));
  if (ending == ".json") return from_spec(text, file);
  if (ending == ".dxf") return from_dxf(text, profile);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && text[first] == '<')
    return only_drawing(linework_from_svg(text, profile));
  if (first != std::string::npos && text[first] == '{')
    return text.find("\"vertices_coords\"") == std::string::npos
               ? from_spec(text, file)
               : only_drawing(linework_from_fold(text));
  return fail(ErrorKind::Malformed, "",
              "is neither a spec (.json) nor a drawing (.fold, .svg, .dxf) that popcut reads");
}

}  // namespace

Result<DrawingInput> read_drawing(const std::string& file, SvgProfile profile) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  std::string ending = std::filesystem::path(file).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  auto input = from_text(*text, file, ending, profile);
  if (!input) return tl::unexpected(within(file, input.error()));
  if (input->drawing.name.empty())
    input->drawing.name = std::filesystem::path(file).stem().string();
  return input;
}

}  // namespace popcut::cli
