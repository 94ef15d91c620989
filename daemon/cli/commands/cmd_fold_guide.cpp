// SPDX-License-Identifier: MIT
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/deploy/loaded_pattern.hpp"
#include "core/design/patches.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/hands/fold_guide.hpp"
#include "core/hands/folding.hpp"
#include "core/judge/glue_guide.hpp"
#include "core/judge/sheet_motion.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/judge/sound_slices.hpp"
#include "core/layout/sheet.hpp"
#include "core/print/fold_guide_pages.hpp"
#include "core/text/fold_text.hpp"
#include "core/text/utf8.hpp"
#include "core/verify/verify.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/deploy_book.hpp"
#include "daemon/cli/input/book_input.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "daemon/cli/input/spec_assets.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/pictures/glue_guide_pages.hpp"
#include "daemon/pictures/pdf.hpp"

namespace popcut::cli {
namespace fold_guide_command {
namespace {

struct Options {
  std::string file, folder, page{"A4"}, svg_profile{"auto"};
};

/// The cards of an input: one, or those of a book or of a design in several parts.
using Cards = std::vector<Pattern>;

Result<Cards> designed_cards(const std::string& file, const std::string& text,
                             const Progress& progress) {
  const auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(within(file, spec.error()));
  const auto assets = load_assets(*spec, file);
  if (!assets) return tl::unexpected(within(file, assets.error()));
  auto made = design_assembly(*spec, *assets, progress);
  if (!made) return tl::unexpected(within(file, made.error()));
  Cards cards;
  for (Design& part : made->parts) cards.push_back(std::move(part.pattern));
  return cards;
}

/// Whether a sheet opens in one movement, as a card does. The net of a box folds up in many.
bool is_card(const std::string& fold) {
  VerifyOptions options;
  options.quick = true;
  options.degrees_of_freedom = 1;
  const auto report = verify_fold(fold, options);
  return !report || report->degrees_of_freedom.value_or(1) == 1;
}

/// A card of which the flat sheet is known, or also how it stands.
Result<Cards> sheet_cards(const std::string& file, const std::string& fold,
                          const Progress& progress) {
  if (const auto read = read_fold(fold))
    if (auto pattern = pattern_from_fold(*read)) return Cards{std::move(*pattern)};
  constexpr std::array kOpen{std::numbers::pi / 2};
  auto opened = judge::open_flat_sheet(fold, kOpen, progress);
  if (!opened) return tl::unexpected(within(file, opened.error()));
  // Sloped panels have no law of motion here: they are shown on the sheet alone.
  if (opened->motion) opened->pattern.card = is_card(fold);
  if (opened->pattern.name.empty())
    opened->pattern.name = std::filesystem::path(file).stem().string();
  return Cards{std::move(opened->pattern)};
}

Result<Cards> read_cards(const Options& options, std::vector<std::string>& notes,
                         const Progress& progress) {
  constexpr std::uintmax_t kLimitBytes = 1u << 29;
  if (names_book(options.file)) {
    auto book = read_deployed_book(options.file);
    if (!book) return tl::unexpected(book.error());
    return std::move(book->cards);
  }
  if (auto valid = check_no_model(options.file, "fold-guide"); !valid)
    return tl::unexpected(valid.error());
  const auto text = read_file(options.file, kLimitBytes);
  if (!text) return tl::unexpected(text.error());
  if (is_design_spec(*text)) return designed_cards(options.file, *text, progress);
  if (!is_drawing(*text, options.file)) return sheet_cards(options.file, *text, progress);
  const auto fold = fold_of_drawing(*text, options.file, options.svg_profile, notes);
  if (!fold) return tl::unexpected(fold.error());
  return sheet_cards(options.file, *fold, progress);
}

Result<void> write_folder(const Options& options, std::span<const PrintedPage> pages,
                          const std::string& title, const std::string& json) {
  const auto pdf = pdf_of_pages(pages, title);
  if (!pdf) return tl::unexpected(pdf.error());
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = folder->add("fold-guide.pdf", *pdf); !done) return done;
  if (auto done = folder->add("fold-guide.json", json); !done) return done;
  return folder->commit("popcut fold-guide " POPCUT_VERSION);
}

void say_written(const Options& options) {
  if (!options.folder.empty())
    fmt::print(stderr, "  wrote    fold-guide.pdf fold-guide.json in {}\n", options.folder);
}

Result<void> write_files(const Options& options, const Cards& cards,
                         const std::vector<hands::FoldGuide>& guides,
                         std::array<double, 2> page_mm) {
  std::vector<PrintedPage> pages;
  for (std::size_t k = 0; k < cards.size(); ++k) {
    auto more = fold_guide_pages(cards[k], guides[k], page_mm);
    if (!more) return fail(ErrorKind::Usage, "--page", more.error().detail);
    pages.insert(pages.end(), std::make_move_iterator(more->begin()),
                 std::make_move_iterator(more->end()));
  }
  return write_folder(options, pages, "How to fold " + cards.front().name,
                      hands::fold_guide_json(guides, cards));
}

void say(const Pattern& card, const hands::FoldGuide& guide, const hands::Hands& own) {
  std::vector<double> lengths_mm;
  for (const hands::GuideFold& fold : guide.folds) lengths_mm.push_back(fold.length_mm());
  fmt::print("{}: {}\n", shown_text(card.name),
             hands::handwork_words(hands::handwork(lengths_mm, guide.waste.size(), 0, own)));
  for (std::size_t k = 0; k < guide.steps.size(); ++k) {
    const hands::GuideStep& step = guide.steps[k];
    fmt::print("{:3}  {}{}\n", k + 1, step.words,
               step.panels.empty() || !guide.stands
                   ? std::string()
                   : fmt::format(" Look from the {}.", name_of(step.look_from)));
  }
}

/// The file of a card of several parts, if the input is or makes one.
Result<std::optional<std::string>> parts_file(const Options& options, const Progress& progress) {
  constexpr std::uintmax_t kLimitBytes = 1u << 29;
  std::optional<std::string> none;
  if (names_book(options.file)) return none;
  auto text = read_file(options.file, kLimitBytes);
  if (!text) return none;  // who reads it says why
  if (lists_joints(*text)) return std::optional(std::move(*text));
  if (!is_design_spec(*text)) return none;
  const auto spec = parse_design_spec(*text);
  if (!spec || !is_of_parts(*spec)) return none;
  const auto assets = load_assets(*spec, options.file);
  if (!assets) return tl::unexpected(within(options.file, assets.error()));
  const auto fold_of = [&](auto sound) -> Result<std::optional<std::string>> {
    if (!sound) return tl::unexpected(within(options.file, sound.error()));
    return std::optional(std::move(sound->fold));
  };
  constexpr const char* kCreator = "popcut " POPCUT_VERSION;
  if (spec->style == DesignStyle::Layers)
    return fold_of(judge::sound_layers(*spec, *assets, kCreator, progress));
  if (spec->style == DesignStyle::Slices)
    return fold_of(judge::sound_slices(*spec, *assets, kCreator, progress));
  return fold_of(judge::sound_boxes(*spec, *assets, kCreator, progress));
}

Result<void> write_parts(const Options& options, const judge::GlueGuide& guide,
                         std::array<double, 2> page_mm) {
  const auto pages = glue_guide_pages(guide, page_mm);
  if (!pages && pages.error().place == "page")
    return fail(ErrorKind::Usage, "--page", pages.error().detail);
  if (!pages) return tl::unexpected(pages.error());
  return write_folder(options, *pages, "How to make " + guide.name, judge::glue_guide_json(guide));
}

/// The guide of a card of several parts: folds and glue in one order.
Result<void> run_parts(const Options& options, const Globals& globals, const std::string& fold,
                       std::array<double, 2> page_mm, const hands::Hands& own,
                       std::optional<LongWork>& work) {
  const auto guide = judge::glue_guide(fold, work->progress());
  if (!guide) return tl::unexpected(within(options.file, guide.error()));
  if (!options.folder.empty()) {
    work->now("drawing the steps");
    if (auto done = write_parts(options, *guide, page_mm); !done) return done;
  }
  work.reset();
  if (globals.json) fmt::print("{}", judge::glue_guide_json(*guide));
  if (!globals.quiet) say_written(options);
  if (globals.json || globals.quiet) return {};
  fmt::print(
      "{}: {} pieces, {}{} tabs; {}\n", shown_text(guide->name), guide->parts.size(),
      guide->slots.empty() ? "" : fmt::format("{} crossings in slots, ", guide->slots.size()),
      guide->tabs.size(), hands::handwork_words(judge::handwork(*guide, own)));
  for (std::size_t k = 0; k < guide->steps.size(); ++k)
    fmt::print("{:3}  {}\n", k + 1, guide->steps[k].words);
  return {};
}

Result<void> run_fold_guide(const Options& options, const Globals& globals) {
  const auto page_mm = parse_size_mm(options.page);
  if (!page_mm) return fail(ErrorKind::Usage, "--page", page_mm.error().detail);
  const auto own = own_hands();
  if (!own) return tl::unexpected(own.error());
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the card");
  const auto parts = parts_file(options, work->progress());
  if (!parts) return tl::unexpected(parts.error());
  if (*parts) return run_parts(options, globals, **parts, *page_mm, *own, work);
  std::vector<std::string> notes;
  const auto cards = read_cards(options, notes, work->progress());
  if (!cards) return tl::unexpected(cards.error());
  std::vector<hands::FoldGuide> guides;
  for (const Pattern& card : *cards) {
    auto guide = hands::fold_guide(card);
    if (!guide) return tl::unexpected(within(options.file, guide.error()));
    guides.push_back(std::move(*guide));
  }
  if (!options.folder.empty()) {
    work->now("drawing the steps");
    if (auto done = write_files(options, *cards, guides, *page_mm); !done) return done;
  }
  work.reset();
  if (globals.json) fmt::print("{}", hands::fold_guide_json(guides, *cards));
  if (!globals.quiet) {
    for (const std::string& note : notes) fmt::print(stderr, "  note     {}\n", note);
    say_written(options);
  }
  if (globals.json || globals.quiet) return {};
  for (std::size_t k = 0; k < cards->size(); ++k) say((*cards)[k], guides[k], *own);
  return {};
}

constexpr const char* kHelp =
    "Show step by step how to fold a card by hand.\n\n"
    "  popcut fold-guide house.json -o house\n"
    "  popcut fold-guide house/pattern.fold --page Letter -o house\n\n"
    "CARD is a design (.json), a pattern (FOLD, SVG, DXF) or the folder of a book. First you take\n"
    "out the waste. Then you crease, at most eight folds a step, from wall and ground inward.\n"
    "Then you push panels while the card shuts. If the card has several parts, you fold each\n"
    "part, push slices together from above, and then glue tab by tab, in an order that leaves\n"
    "room for your fingers. popcut prints the steps, and writes into DIR:\n\n"
    "  fold-guide.pdf   a page for every 40 folds. Each step shows its panels on the standing\n"
    "                   card, and its folds on the sheet (red: mountain, blue: valley)\n"
    "  fold-guide.json  the same for programs";

}  // namespace
}  // namespace fold_guide_command

void register_fold_guide(const Command& app, const Globals& globals, Run& run) {
  using namespace fold_guide_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("fold-guide", kHelp);
  command.add_option("CARD", options->file, "A design, a pattern, or the folder of a book")
      .required();
  command
      .add_option("--page", options->page,
                  "Size of the paper, such as Letter or 148x210 (A6 or larger)")
      .value_text("SIZE [A4]");
  add_svg_profile(command, options->svg_profile);
  command
      .add_option("-o,--output", options->folder,
                  "Folder for the files; created if it does not exist")
      .value_text("DIR");
  when_chosen(command, run, [options, &globals] { return run_fold_guide(*options, globals); });
}

}  // namespace popcut::cli
