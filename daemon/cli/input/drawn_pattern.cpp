// SPDX-License-Identifier: MIT
#include "daemon/cli/input/drawn_pattern.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/formats/fold/crease_pattern.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/gzip.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/client/command_words.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/planning/plan_input.hpp"

namespace popcut::cli {

bool is_svg(std::string_view text) {
  if (is_gzip(text)) return true;
  std::string kept;
  text = plain_text(text, kept);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<' && !is_crease_pattern(text);
}

bool is_drawing(std::string_view text, const std::string& file) {
  return is_svg(text) || is_crease_pattern(text) ||
         same_word(std::filesystem::path(file).extension().string(), ".dxf");
}

Result<std::string> fold_of_drawing(const std::string& text, const std::string& file,
                                    const std::string& svg_profile,
                                    std::vector<std::string>& warnings) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected<Error>(tables.error());
  auto profile = find_stroke_profile(svg_profile, tables->texts);
  if (!profile)
    return tl::unexpected<Error>(client::on_command_line(tables->with_file(profile.error())));
  SvgReadOptions how;
  how.profile = std::move(*profile);
  const auto kind = is_crease_pattern(text) ? planning::InputKind::Fold
                    : is_svg(text)          ? planning::InputKind::Svg
                                            : planning::InputKind::Dxf;
  const auto read = [&] { return planning::drawing_from_text(text, kind, how, 1, {}); };
  auto work = read();
  if (!work && work.error().reason == ErrorReason::Unclear) {
    how.profile = find_stroke_profile("origami-sim").value();
    work = read();
    warnings.emplace_back(
        "strokes without a name have several colours: red is read as mountain folds, blue as "
        "valley folds, green and black as cuts; 'popcut plan' reads them so with --svg-profile "
        "origami-sim");
  }
  if (!work) return tl::unexpected<Error>(within(file, work.error()));
  for (const Warning& warning : work->drawing.warnings)
    warnings.push_back(client::in_command_words(warning.message));
  if (work->drawing.lines.empty())
    return fail(ErrorKind::Malformed, file,
                "has no line to cut or fold; draw outline and cuts black or green, mountain folds "
                "red, valley folds blue");
  return fold_from_linework(work->drawing);
}

void add_svg_profile(const Command& command, std::string& svg_profile) {
  command
      .add_option("--svg-profile", svg_profile,
                  "What the strokes of an SVG mean: auto (by their names; several colours without "
                  "names as origami-sim), popcut (by their names; the others are cuts), "
                  "origami-sim (by colour), lightburn, cricut, plain, or another of "
                  "docs/drawings.md, or your own")
      .value_text("NAME [auto]");
}

bool is_design_spec(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  return json.is_object() && (json.contains("surface") || json.contains("patches")) &&
         !json.contains("vertices_coords");
}

Error not_yet_designed(const std::string& file, const std::string& command) {
  const std::string folder = client::quoted(std::filesystem::path(file).stem().string());
  return {
      ErrorKind::Malformed, file,
      fmt::format("is a design spec, and {0} reads the pattern that is made from it: "
                  "'popcut design {1} -o {2}', then 'popcut {0} {2}/pattern.fold{3}'",
                  command, client::quoted(file), folder, command == "deploy" ? " -o poses" : "")};
}

Result<void> check_no_model(const std::string& file, const std::string& command) {
  if (!is_model_file(file)) return {};
  return fail(
      ErrorKind::Malformed, file,
      fmt::format("is a 3D model, and {0} reads a pattern; 'popcut auto {1} -o cards' makes "
                  "cards of it: give the pattern.fold of one",
                  command, client::quoted(file)));
}

bool is_pattern(const std::string& text) {
  if (is_svg(text)) return foreign_advice(text, {}).empty();  // or a model in angle brackets
  const auto json = nlohmann::json::parse(text, nullptr, false);
  return json.is_object() && json.contains("vertices_coords");
}

Error no_design_spec(const std::string& file, const std::string& text, const Error& why) {
  if (is_pattern(text))
    return {ErrorKind::Malformed, file,
            fmt::format("is a pattern or a drawing already, and design makes one from a design "
                        "spec; 'popcut verify {0}' checks it, 'popcut deploy {0} -o poses' opens "
                        "it, 'popcut plan {0} -o plan' lays it out for cutting",
                        client::quoted(file))};
  if (const auto foreign = foreign_kind(text); !foreign.empty())
    return {
        ErrorKind::Malformed, file,
        fmt::format("is {}; give a design (.json) or a 3D model (.stl, .obj, .glb), or start from "
                    "an example: popcut design --example sphere > sphere.json",
                    foreign)};
  return within(file, why);
}

}  // namespace popcut::cli
