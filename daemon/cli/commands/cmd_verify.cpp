// SPDX-License-Identifier: MIT
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/text/fold_text.hpp"
#include "core/verify/book.hpp"
#include "core/verify/parts/parts.hpp"
#include "core/verify/verify.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/input/book_input.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace verify_command {
namespace {

constexpr std::uintmax_t kPatternLimitBytes = 1u << 29;

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

/// A book: each card, and the glued whole.
Result<void> verify_cards(const Options& options, const Globals& globals) {
  if (!options.target.empty())
    return fail(ErrorKind::Usage, "--target",
                fmt::format("is for one pattern; to compare a book with its model: 'popcut compare "
                            "{} MODEL --around'",
                            options.pattern));
  if (options.degrees_of_freedom.value_or(1) != 1)
    return fail(ErrorKind::Usage, "--dof",
                fmt::format("is {}; each card of a book has 1", *options.degrees_of_freedom));
  const auto book = read_book(options.pattern);
  if (!book) return tl::unexpected<Error>(book.error());
  std::vector<std::string> texts;
  for (const BookCardFile& card : book->cards) {
    auto text = read_file(card.file, kPatternLimitBytes);
    if (!text) return tl::unexpected<Error>(text.error());
    texts.push_back(std::move(*text));
  }
  std::vector<VerifiedCard> cards;
  for (std::size_t i = 0; i < texts.size(); ++i) cards.push_back({book->cards[i].name, texts[i]});
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the book");
  const auto report = verify_book(cards, work->progress());
  work.reset();
  if (!report) return tl::unexpected<Error>(within(options.pattern, report.error()));
  if (globals.json) {
    fmt::print("{}", verify_json(*report));
  } else if (!globals.quiet) {
    fmt::print("{}", verify_text(*report));
    for (std::size_t i = 0; i < report->cards.size(); ++i)
      if (!report->cards[i].ok())
        fmt::print("\n{}\n{}", report->names[i], verify_text(report->cards[i]));
  }
  if (report->ok()) return {};
  return fail(
      ErrorKind::CheckFailed, options.pattern,
      fmt::format("the book fails {} checks; the report on standard output lists the places",
                  report->failed()));
}

/// A card of several parts.
Result<void> verify_joined(const Options& options, const std::string& text,
                           std::optional<LongWork>& work, const Globals& globals) {
  if (!options.target.empty())
    return fail(ErrorKind::Usage, "--target",
                "is for a pattern of one sheet, not for a card of "
                "several parts; leave it out");
  PartsVerifyOptions verify;
  verify.degrees_of_freedom = options.degrees_of_freedom.value_or(1);
  verify.progress = work->progress();
  const auto report = verify_parts(text, verify);
  work.reset();
  if (!report) return tl::unexpected<Error>(within(options.pattern, report.error()));
  if (globals.json) {
    fmt::print("{}", verify_json(*report));
  } else if (!globals.quiet) {
    fmt::print("{}", verify_text(*report));
  }
  if (report->ok()) return {};
  return fail(
      ErrorKind::CheckFailed, options.pattern,
      fmt::format("the card fails {} checks; the report on standard output lists the places",
                  report->failed()));
}

Result<void> run_verify(const Options& options, const Globals& globals) {
  if (names_book(options.pattern)) return verify_cards(options, globals);
  if (auto valid = check_no_model(options.pattern, "verify"); !valid) return valid;
  constexpr std::uintmax_t kSpecLimitBytes = 4u << 20;
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the pattern");
  auto text = read_file(options.pattern, kPatternLimitBytes);
  if (!text) return tl::unexpected<Error>(text.error());
  if (lists_joints(*text)) return verify_joined(options, *text, work, globals);
  VerifyOptions verify{
      options.degrees_of_freedom, std::nullopt, is_drawing(*text, options.pattern), {}};
  std::vector<std::string> warnings;
  if (verify.page) {
    text = fold_of_drawing(*text, options.pattern, options.svg_profile, warnings);
    if (!text) return tl::unexpected<Error>(text.error());
  }
  if (!options.target.empty()) {
    auto spec = read_file(options.target, kSpecLimitBytes);
    if (!spec) return tl::unexpected<Error>(spec.error());
    for (const std::string& name : target_files_of(*spec)) {
      auto bytes = read_model_file(std::filesystem::path(options.target).parent_path() / name);
      if (!bytes) return tl::unexpected<Error>(within(options.target, bytes.error()));
      verify.target_files.emplace(name, std::move(*bytes));
    }
    verify.target_spec = std::move(*spec);
  }
  verify.progress = work->progress();
  auto report = verify_fold(*text, verify);
  work.reset();
  if (!report) {
    if (is_design_spec(*text)) return tl::unexpected(not_yet_designed(options.pattern, "verify"));
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
    "  popcut verify sphere/pattern.fold --dof 1 --target sphere.json\n"
    "  popcut verify teapot-book\n\n"
    "PATTERN is a FOLD file or a drawing (SVG, DXF), from popcut or any other program. popcut "
    "uses\n"
    "only this file, and checks that the sheet is one piece, that the faces fill it, and that no "
    "lines\n"
    "cross or lie on each other. In every pose no panel may stretch, no hinge may tear, and the\n"
    "fold angles must agree with the pose. The card must move, and no panel may pass through\n"
    "another. If the file has no opened pose, popcut opens the pattern: panels stay rigid, popcut\n"
    "turns the longest fold, and the other folds follow.\n\n"
    "For a book, give its folder: then each card must have one movement, glued pages must be the\n"
    "same rectangle, no two cards may cross at any opening, and the shut book must lie inside\n"
    "its pages.\n"
    "A card of several parts is one FOLD file that lists its joints. Then each part must be "
    "sound,\n"
    "tabs must lie on paper, and the glued card must move from shut to open in one movement and "
    "lie\n"
    "inside its pages when it is shut.\n\n"
    "Exit code 0 if all checks pass, 3 if the file cannot be read, 6 if a check fails.";

}  // namespace
}  // namespace verify_command

void register_verify(const Command& app, const Globals& globals, Run& run) {
  using namespace verify_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("verify", kHelp);
  command
      .add_option("PATTERN", options->pattern,
                  "A FOLD file, a drawing (SVG, DXF), or the folder of a book")
      .required();
  whole_number(command.add_option("--dof", options->degrees_of_freedom,
                                  "Required number of independent movements (degrees of freedom): "
                                  "1 if the card opens in one "
                                  "movement; default: 1 or more"),
               0, 1'000'000)
      .value_text("N");
  command
      .add_option("--target", options->target,
                  "Also measure the distance from the shape of this design")
      .value_text("SPEC");
  add_svg_profile(command, options->svg_profile);
  when_chosen(command, run, [options, &globals] { return run_verify(*options, globals); });
}

}  // namespace popcut::cli
