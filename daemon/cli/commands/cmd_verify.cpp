// SPDX-License-Identifier: MIT
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/formats/fold/linework_graph.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/verify/verify.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"

namespace popcut::cli {
namespace verify_command {
namespace {

struct Options {
  std::string pattern;
  std::string target;
  std::string svg_profile{"origami-sim"};
  std::optional<std::size_t> degrees_of_freedom;
};

/// What fails, in one line: the checks by name with a count each.
Error summary(const Options& options, const VerifyReport& report) {
  std::string checks;
  for (const VerifyCheck& check : report.checks) {
    if (!check.ok())
      checks += fmt::format("{}{} ({})", checks.empty() ? "" : ", ", check.name, check.failed);
  }
  return {ErrorKind::CheckFailed, options.pattern,
          fmt::format("the pattern is unsound: {}; the report on standard output lists the places",
                      checks)};
}

/// Is it a drawing rather than a FOLD file? JSON begins with a brace, XML with an angle.
bool is_svg(std::string_view text) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

/// The lines of an SVG drawing as FOLD text, and what the reader has to say.
Result<std::string> fold_of_svg(const std::string& svg, const Options& options,
                                std::vector<std::string>& warnings) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected<Error>(tables.error());
  auto profile = find_stroke_profile(options.svg_profile, tables->texts);
  if (!profile) return tl::unexpected<Error>(tables->with_file(profile.error()));
  SvgReadOptions how;
  how.profile = std::move(*profile);
  auto work = linework_from_svg(svg, how);
  if (!work) return tl::unexpected<Error>(within(options.pattern, work.error()));
  warnings = work->warnings;
  if (work->lines.empty())
    return fail(ErrorKind::Malformed, options.pattern,
                "no line is drawn that is cut or folded; strokes are needed, outline and slits "
                "black or green, mountains red, valleys blue");
  return fold_from_linework(*work);
}

Result<void> run_verify(const Options& options, const Globals& globals) {
  constexpr std::uintmax_t kPatternLimitBytes = 1u << 29;
  constexpr std::uintmax_t kSpecLimitBytes = 4u << 20;
  auto text = read_file(options.pattern, kPatternLimitBytes);
  if (!text) return tl::unexpected<Error>(text.error());
  VerifyOptions verify{options.degrees_of_freedom, std::nullopt, is_svg(*text), {}};
  std::vector<std::string> warnings;
  if (verify.page) {
    text = fold_of_svg(*text, options, warnings);
    if (!text) return tl::unexpected<Error>(text.error());
  }
  if (!options.target.empty()) {
    auto spec = read_file(options.target, kSpecLimitBytes);
    if (!spec) return tl::unexpected<Error>(spec.error());
    if (const std::string name = target_file_of(*spec); !name.empty()) {
      auto bytes = read_file(std::filesystem::path(options.target).parent_path() / name);
      if (!bytes) return tl::unexpected<Error>(within(options.target, bytes.error()));
      verify.target_file = std::move(*bytes);
    }
    verify.target_spec = std::move(*spec);
  }
  auto report = verify_fold(*text, verify);
  if (!report) {
    const bool of_target = report.error().place.rfind("target", 0) == 0;
    return tl::unexpected<Error>(
        within(of_target ? options.target : options.pattern, report.error()));
  }
  report->notes.insert(report->notes.begin(), warnings.begin(), warnings.end());
  if (globals.json) {
    fmt::print("{}", verify_json(*report));
  } else if (!globals.quiet) {
    fmt::print("{}", verify_text(*report));
  }
  if (!report->ok()) return tl::unexpected<Error>(summary(options, *report));
  return {};
}

constexpr const char* kHelp =
    "Is a pattern sound? Recomputed from the file alone.\n\n"
    "  popcut verify sphere/pattern.fold\n"
    "  popcut verify sphere/pattern.fold --dof 1 --target sphere.json\n\n"
    "One piece, faces that tile the sheet, no doubled or crossing lines, lengths kept and hinges\n"
    "closed in every pose, fold angles, degrees of freedom, no face through another. PATTERN is a\n"
    "FOLD file or an SVG drawing. One that shows no pose between flat and shut is opened: rigid\n"
    "panels, closed hinges, driven by the longest fold line. Faces are traced where none are "
    "listed.\n"
    "Exit 0 when sound, 3 when it cannot be read, 6 with the list of what fails.";

}  // namespace
}  // namespace verify_command

void register_verify(CLI::App& app, const Globals& globals, Run& run) {
  using namespace verify_command;
  auto options = std::make_shared<Options>();
  CLI::App* const command = app.add_subcommand("verify", kHelp);
  command->add_option("PATTERN", options->pattern, "A FOLD file or an SVG drawing")->required();
  whole_number(command->add_option("--dof", options->degrees_of_freedom,
                                   "Demand this many degrees of freedom; without it only 0 fails"),
               0, 1'000'000)
      ->option_text("N");
  command
      ->add_option("--target", options->target, "Measure the fold vertices against a design spec")
      ->option_text("SPEC");
  command
      ->add_option("--svg-profile", options->svg_profile,
                   "How an SVG says what its lines are for: origami-sim (by colour, the default),\n"
                   "popcut, lightburn, cricut, plain")
      ->option_text("NAME");
  command->callback([options, &globals, &run] {
    run = [options, &globals] { return run_verify(*options, globals); };
  });
}

}  // namespace popcut::cli
