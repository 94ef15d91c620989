// SPDX-License-Identifier: MIT
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/design/book_fit.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/plan/plan_options.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/book_files.hpp"
#include "daemon/cli/commands/layer_files.hpp"
#include "daemon/cli/cutter/stop_signals.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/search/front_picture.hpp"
#include "daemon/cli/search/front_report.hpp"
#include "daemon/cli/search/model_search.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/planning/design_export.hpp"
#include "daemon/planning/design_files.hpp"

namespace popcut::cli {
namespace auto_command {
namespace {

struct Options {
  ModelSearchOptions search;
  std::string folder;
};

Result<void> add_pattern(PatchAssembly& made, std::size_t part, const Material& material,
                         OutputFolder& folder) {
  constexpr std::array<std::string_view, 4> kFiles{"pattern.fold", "pattern.svg", "cut.svg",
                                                   "pattern.dxf"};
  for (const std::string_view file : kFiles) {
    const auto text = planning::design_file(made, material, file, part);
    if (!text) return tl::unexpected(text.error());
    if (auto done = folder.add(std::string(file), *text); !done) return done;
  }
  return {};
}

/// The files of one card or book: what makes it again, and its patterns.
Result<void> add_card(SearchedModel& model, std::size_t k, OutputFolder& folder) {
  planning::FoundCard& card = model.found.front[k];
  const std::string name = front_folder(card, k);
  if (const auto spec = parse_design_spec(card.spec))
    for (Design& part : card.made.parts) planning::add_make_warnings(model.material, *spec, part);
  folder.enter(name);
  if (auto done = folder.add("spec.json", card.spec); !done) return done;
  if (card.made.book) {
    card.made.book->fit = book_fit(card.made);
    if (auto done = add_book_files(card.made, {}, folder); !done) return done;
  }
  const auto picture = card_picture(model.found, card,
                                    fmt::format("{}, {:.1f} minutes: error {:.4f}", name,
                                                card.cost.seconds / 60.0, card.error()));
  if (!picture) return tl::unexpected(picture.error());
  if (auto done = folder.add("thumbnail.png", *picture); !done) return done;
  for (std::size_t part = 0; part < card.made.parts.size(); ++part) {
    if (card.made.book) folder.enter(fmt::format("{}/{}", name, part_folder(card.made, part)));
    if (auto done = add_pattern(card.made, part, model.material, folder); !done) return done;
  }
  return {};
}

/// The files of the cards of layers and of boxes.
Result<void> add_glued(const SearchedModel& model, OutputFolder& folder) {
  const auto wants = [](std::string_view name) { return name != "picture"; };
  for (const planning::FoundGlued& one : model.glued) {
    folder.enter(one.style());
    if (auto done = folder.add("spec.json", one.spec); !done) return done;
    const auto files =
        one.layers ? add_layer_files(*one.layers, one.printed, model.material, 0.0, wants, folder)
                   : add_box_files(*one.boxes, one.printed, model.material, 0.0, wants, folder);
    if (!files) return tl::unexpected(files.error());
  }
  return {};
}

Result<void> write_files(const Options& options, SearchedModel& model, OutputFolder& folder,
                         const Globals& globals) {
  LongWork work(!globals.quiet, "writing the cards");
  for (std::size_t k = 0; k < model.found.front.size(); ++k)
    if (auto done = add_card(model, k, folder); !done) return done;
  if (auto done = add_glued(model, folder); !done) return done;
  folder.enter("");
  const auto picture = front_picture(
      model.found,
      fmt::format("{}: {} of up to {:g} minutes of cutting", model.name,
                  options.search.cards > 1 ? fmt::format("books of {} cards", options.search.cards)
                                           : std::string("cards"),
                  options.search.max_minutes),
      model.colours);
  if (!picture) return tl::unexpected(picture.error());
  if (auto done = folder.add("front.svg", *picture); !done) return done;
  const auto sides = sides_picture(model.found.mesh, model.up,
                                   stand_of(model.found.front[model.found.recommended]));
  if (!sides) return tl::unexpected(sides.error());
  if (auto done = folder.add("sides.svg", *sides); !done) return done;
  if (auto done = folder.add("front.json", front_json(options.search, model)); !done) return done;
  return folder.commit("popcut auto " POPCUT_VERSION);
}

/// Ends as a program that Ctrl-C ends, after everything is put away.
[[noreturn]] void end_by_signal(bool quiet) {
  if (!quiet) fmt::print(stderr, "popcut: stopped; nothing was written\n");
  std::fflush(stderr);
  std::signal(SIGINT, SIG_DFL);
  (void)std::raise(SIGINT);
  std::_Exit(128 + SIGINT);
}

Result<void> run_auto(const Options& options, const Globals& globals) {
  if (options.folder.empty())
    return fail(ErrorKind::Usage, "command line",
                "-o DIR is missing; give the folder for the cards");
  std::optional<StopSignals> signals(std::in_place);
  const auto stopped = [] { return StopSignals::stop_asked.load(); };
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  auto model = search_model(options.search, folder->folder() / "card-01", !globals.quiet, stopped);
  if (stopped()) {
    { const OutputFolder put_away = std::move(*folder); }
    signals.reset();
    end_by_signal(globals.quiet);
  }
  if (!model) return tl::unexpected(model.error());
  if (auto done = write_files(options, *model, *folder, globals); !done) return done;
  if (globals.json)
    fmt::print("{}", front_json(options.search, *model));
  else if (!globals.quiet)
    fmt::print("{}", front_text(options.search, *model, options.folder));
  return {};
}

constexpr const char* kHelp =
    "Find the best cards for a 3D model.\n\n"
    "  popcut auto teapot.obj -o teapot\n"
    "  popcut auto house.obj --up y --machine cameo3 --mat A4 --marks -o house    # to print\n\n"
    "MODEL is a mesh (STL, OBJ, GLB). popcut tries styles, orientations, sizes and finenesses. It\n"
    "keeps the best cards: no other card both looks more like the model and is quicker to fold.\n"
    "Each passes 'popcut verify --dof 1'. With --cards it finds books, which show the model from\n"
    "all sides. popcut writes into DIR:\n\n"
    "  front.svg      all cards on one page; look at this first\n"
    "  sides.svg      the model from six sides, each with the options for this side\n"
    "  front.json     figures of each card, and which one popcut recommends\n"
    "  card-NN/       one card: spec.json, from which 'popcut design' makes it again, the\n"
    "                 pattern (FOLD, SVG, DXF), cut.svg, and thumbnail.png beside the model;\n"
    "                 for books: book-NN/, with a folder for each card\n"
    "  layers/        one more card, of several parts, that opens flat ('popcut fold-guide\n"
    "                 layers/spec.json' says how to glue it)\n"
    "  boxes/         a card of walls and roofs that opens flat, if the model is a house\n\n"
    "card-01 is the quickest to fold; the last card looks most like the model. The same seed "
    "gives\n"
    "the same cards on every computer.";

void add_search_options(const Command& command, ModelSearchOptions& search) {
  real_number(command.add_option("--max-minutes", search.max_minutes,
                                 "Longest time that the cutter may take, as popcut estimates it"),
              0.1, 1e5, "minutes")
      .value_text("MINUTES [15]");
  whole_number(
      command.add_option("--max-folds", search.most_folds, "Most folds that a card may have"), 1,
      1'000'000)
      .value_text("N");
  real_number(command.add_option("--min-fold", search.shortest_fold_mm,
                                 "Shortest fold that a card may have"),
              0.1, 1000, "mm")
      .value_text("MM");
  for (const char* label : {"easy", "medium", "hard"})
    command.add_flag(
        fmt::format("--{}", label), [&search, label](bool) { search.label = label; },
        label == std::string("easy")     ? "Only cards of at most 25 folds, none below 8 mm"
        : label == std::string("medium") ? "Only cards of at most 80 folds, none below 5 mm"
                                         : "Cards of any number of folds (the default)");
  command.add_flag("--any-hold", search.any_hold,
                   "Also offer cards whose panels move by more than 1 mm in paper (docs/hands.md)");
  command.add_flag(
      "--plain", search.plain,
      "Judge cards as bare paper, by depths; default: as they look when they are printed");
  command.add_option("--mat", search.mat, "Mat or paper to cut on, such as 12x12 or A4, as in plan")
      .checked([](const std::string& text) {
        const auto read = read_plan_options({{"mat", text}});
        return read ? std::string() : read.error().detail;
      })
      .value_text("NAME|WxH");
  command.add_option("--machine", search.machine, "Machine to cut with, as in plan")
      .value_text("NAME");
  command.add_option("--material", search.material, "Material to cut, as in plan")
      .value_text("NAME [paper-220]");
  command
      .add_option("--cards", search.cards,
                  "Cards of a book around one spine, 3 to 12; 1: a card alone")
      .checked([](const std::string& text) {
        const bool is_number = !text.empty() && text.size() <= 2 &&
                               text.find_first_not_of("0123456789") == std::string::npos;
        const int cards = is_number ? std::stoi(text) : 0;
        const bool is_right = cards == 1 || (cards >= kLeastCards && cards <= kMostCards);
        return is_right ? std::string()
                        : fmt::format("{}: give 1, or {} to {} cards of a book", text, kLeastCards,
                                      kMostCards);
      })
      .value_text("N [1]");
  command.add_flag("--marks", search.marks,
                   "Make cards that fit between the registration marks of popcut print");
  std::vector<std::string> styles;
  for (const StyleChoice& style : style_choices()) styles.emplace_back(style.name);
  one_word(command.add_option(
               "--style", search.style,
               "What cards are made of: any, facets, silhouette (a few upright layers), lattice "
               "(any lattice), or one lattice"),
           styles, "any");
  one_word(command.add_option("--up", search.up,
                              "Which axis of the file points up; usual: y in OBJ and GLB, z in "
                              "STL; any: the one with which the card looks most like the model, so "
                              "a house may lie on its side"),
           up_choices(), kUsualUp);
  one_word(command.add_option("--front", search.front,
                              "Which axis of the file points out of the card, toward you (a house: "
                              "out of its door); any: popcut chooses"),
           up_words(), "any");
  whole_number(
      command.add_option("--seed", search.seed, "Random seed; the same seed gives the same cards"),
      0, std::int64_t{1} << 53)
      .value_text("N [1]");
  real_number(
      command.add_option("--effort", search.effort,
                         "How many cards are tried: 0.02 is a first look, 3 takes three times "
                         "as long; 1 takes up to a minute on two idle cores"),
      0.01, 100)
      .value_text("X [1]");
  whole_number(
      command.add_option("--threads", search.threads,
                         "Threads to use, 0 for all; they change only the time, not the cards"),
      0, 256)
      .value_text("N [0]");
}

}  // namespace
}  // namespace auto_command

void register_auto(const Command& app, const Globals& globals, Run& run) {
  using namespace auto_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("auto", kHelp);
  command.add_option("MODEL", options->search.model, "The model: a mesh (.stl, .obj, .glb, .gltf)")
      .required();
  command
      .add_option("-o,--output", options->folder,
                  "Folder for the cards, required; created if it does not exist")
      .value_text("DIR");
  add_search_options(command, options->search);
  when_chosen(command, run, [options, &globals] { return run_auto(*options, globals); });
}

}  // namespace popcut::cli
