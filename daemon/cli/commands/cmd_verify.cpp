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

#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/verify/verify.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/client/command_words.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"

namespace popcut::cli {
namespace verify_command {
namespace {

struct Options {
  std::string pattern;
  std::string target;
  std::string svg_profile{"auto"};
  std::optional<std::size_t> degrees_of_freedom;
};

/// What fails, in one line: the checks by name with a count each.
Error summary(const Options& options, const VerifyReport& report) {
  std::string checks;
  for (const VerifyCheck& check : report.checks) {
    if (!check.ok())
      checks += fmt::format("{}{} ({})", checks.empty() ? "" : ", ", check.name, check.failed);
  }
  return {
      ErrorKind::CheckFailed, options.pattern,
      fmt::format("the pattern fails checks: {}; the report on standard output lists the places",
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
  if (!profile)
    return tl::unexpected<Error>(client::on_command_line(tables->with_file(profile.error())));
  SvgReadOptions how;
  how.profile = std::move(*profile);
  auto work = linework_from_svg(svg, how);
  if (!work && work.error().reason == ErrorReason::Unclear) {
    work = linework_from_svg(svg, SvgProfile::OrigamiSim);
    warnings.emplace_back(
        "strokes without a name have several colours: red is read as mountain folds, blue as "
        "valley folds, green and black as cuts; 'popcut plan' reads them so with --svg-profile "
        "origami-sim");
  }
  if (!work) return tl::unexpected<Error>(within(options.pattern, work.error()));
  for (const Warning& warning : work->warnings)
    warnings.push_back(client::in_command_words(warning.message));
  if (work->lines.empty())
    return fail(ErrorKind::Malformed, options.pattern,
                "has no line to cut or fold; draw outline and cuts black or green, mountain folds "
                "red, valley folds blue");
  return fold_from_linework(*work);
}

Result<void> run_verify(const Options& options, const Globals& globals) {
  constexpr std::uintmax_t kPatternLimitBytes = 1u << 29;
  constexpr std::uintmax_t kSpecLimitBytes = 4u << 20;
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the pattern");
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
    for (const std::string& name : target_files_of(*spec)) {
      auto bytes = read_file(std::filesystem::path(options.target).parent_path() / name);
      if (!bytes) return tl::unexpected<Error>(within(options.target, bytes.error()));
      verify.target_files.emplace(name, std::move(*bytes));
    }
    verify.target_spec = std::move(*spec);
  }
  verify.progress = work->progress();
  auto report = verify_fold(*text, verify);
  work.reset();
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
    "Check that a pattern can be cut, and that it opens and closes.\n\n"
    "  popcut verify sphere/pattern.fold\n"
    "  popcut verify sphere/pattern.fold --dof 1 --target sphere.json\n\n"
    "PATTERN is a FOLD file or an SVG drawing, from popcut or any other program. popcut uses only\n"
    "this file, and checks that the sheet is one piece, that the faces fill it, and that no lines\n"
    "cross or lie on each other. In every pose no panel may stretch, no hinge may tear, and the\n"
    "fold angles must agree with the pose. The card must move, and no panel may pass through\n"
    "another. If the file has no opened pose, popcut opens the pattern: panels stay rigid, popcut\n"
    "turns the longest fold, and the other folds follow.\n"
    "Exit code 0 if all checks pass, 3 if the file cannot be read, 6 if a check fails.";

}  // namespace
}  // namespace verify_command

void register_verify(CLI::App& app, const Globals& globals, Run& run) {
  using namespace verify_command;
  auto options = std::make_shared<Options>();
  CLI::App* const command = app.add_subcommand("verify", kHelp);
  command->add_option("PATTERN", options->pattern, "A FOLD file or an SVG drawing")->required();
  whole_number(command->add_option("--dof", options->degrees_of_freedom,
                                   "Required number of independent movements (degrees of freedom): "
                                   "1 if the card opens in one "
                                   "movement; default: 1 or more"),
               0, 1'000'000)
      ->option_text("N");
  command
      ->add_option("--target", options->target,
                   "Also measure the distance from the shape of this design")
      ->option_text("SPEC");
  command
      ->add_option("--svg-profile", options->svg_profile,
                   "What the strokes of an SVG mean: auto (by their names; several colours without "
                   "names as origami-sim), popcut (by their names; the others are cuts), "
                   "origami-sim (by colour), lightburn, cricut, plain, or a profile of your own")
      ->option_text("NAME [auto]");
  when_chosen(command, run, [options, &globals] { return run_verify(*options, globals); });
}

}  // namespace popcut::cli
