// SPDX-License-Identifier: MIT
#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/compare/comparison.hpp"
#include "core/compare/volume.hpp"
#include "core/design/spec/spec.hpp"
#include "core/plan/plan_options.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/input/book_input.hpp"
#include "daemon/cli/input/compared_book.hpp"
#include "daemon/cli/input/compared_pair.hpp"
#include "daemon/cli/input/compared_parts.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/options/angles.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/options/plan_arguments.hpp"
#include "daemon/cli/view/compare_picture.hpp"
#include "daemon/cli/view/compare_report.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace compare_command {
namespace {

struct Options {
  std::string pattern, target, folder;
  std::vector<std::string> more;  ///< files after these two: then all but the last are cards
  std::string psi, rotate, move;
  std::optional<double> scale;
  bool fit{false}, around{false}, printed{false}, no_cost{false};
  int pixels{512};
  std::string machine, material, mat;
};

/// "1,-2.5,3" as three numbers.
std::optional<std::array<double, 3>> three_numbers(std::string_view text) {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (k == 2)) return std::nullopt;
    if (!read_option_number(std::string(text.substr(0, comma)), out[k])) return std::nullopt;
    if (!(std::abs(out[k]) <= 1e7)) return std::nullopt;
    text.remove_prefix(k == 2 ? text.size() : comma + 1);
  }
  return out;
}

Result<std::optional<double>> psi_of(const Options& options) {
  if (options.psi.empty()) return std::nullopt;
  const auto psi = parse_angle(options.psi);
  if (!psi) return tl::unexpected(within("--psi", psi.error()));
  if (!(*psi > 0.0 && *psi < std::numbers::pi))
    return fail(ErrorKind::Usage, "--psi",
                fmt::format("{} is not between 0 (shut) and pi (flat){}", options.psi,
                            degrees_hint(options.psi)));
  return *psi;
}

/// The FOLD files of a book: of its folder, or one after another; empty where one pattern is given.
struct Given {
  std::vector<std::string> cards;
  std::string target;
};

Result<Given> given_files(const Options& options) {
  Given out{{}, options.target};
  if (!options.more.empty()) {
    out.cards = {options.pattern, options.target};
    out.cards.insert(out.cards.end(), options.more.begin(), options.more.end() - 1);
    out.target = options.more.back();
    return out;
  }
  if (!names_book(options.pattern)) return out;
  const auto book = read_book(options.pattern);
  if (!book) return tl::unexpected(book.error());
  for (const BookCardFile& card : book->cards) out.cards.push_back(card.file);
  return out;
}

/// Adds what cutting one pattern takes.
Result<void> add_cost(const Options& options, const std::string& pattern, const Globals& globals,
                      CutCost& out) {
  PlanArguments arguments;
  arguments.input = pattern;
  arguments.machine = options.machine, arguments.material = options.material;
  if (!options.mat.empty()) arguments.options["mat"] = options.mat;
  const auto job = plan_input(arguments, !globals.quiet);
  if (!job) return tl::unexpected(job.error());
  out.machine = job->plan.machine.title, out.material = job->plan.material.title;
  out.sheets += job->plan.sheets.size();
  out.pieces += job->plan.layout ? job->plan.layout->pieces.size() : 0;
  double seconds = 0.0;
  for (const PlannedSheet& sheet : job->plan.sheets) {
    seconds += sheet.seconds;
    for (std::size_t k = 0; k < 2; ++k) out.seconds_range[k] += sheet.seconds_range[k];
    out.cut_mm += sheet.cut_mm, out.fold_mm += sheet.fold_mm;
    out.travel_mm += sheet.travel_mm + sheet.home_mm;
  }
  if (job->plan.machine.driven()) out.seconds = out.seconds.value_or(0.0) + seconds;
  return {};
}

CutCost cost_of(const Options& options, const Given& given, const ComparedStructure& structure,
                const Globals& globals) {
  CutCost out;
  if (structure.is_mesh || options.no_cost) {
    out.why = structure.is_mesh ? "a mesh cannot be cut" : "you asked for none";
    return out;
  }
  const std::vector<std::string> patterns =
      given.cards.empty() ? std::vector{options.pattern} : given.cards;
  for (const std::string& pattern : patterns)
    if (const auto added = add_cost(options, pattern, globals, out); !added) {
      CutCost none;
      none.why = message(added.error());
      return none;
    }
  out.ran = true;
  return out;
}

/// The volumes of model and card, or why there are none.
void add_volumes(const Options& options, const ComparedStructure& structure,
                 const ComparedTarget& target, CompareReport& report) {
  if (options.around) {
    report.model.why = "a volume belongs to one corner, and --around looks at all sides";
    return;
  }
  if (!structure.corner) {
    report.model.why = "the pattern does not stand in a corner of wall and ground";
    return;
  }
  const likeness::Corner& corner = *structure.corner;
  const auto before = [&](likeness::Triangles surface) {
    const double mm3 = likeness::volume_before(surface, corner, options.pixels);
    return likeness::Volume{mm3 > 0.0, mm3, mm3 > 0.0 ? "" : "nothing stands in the corner", false};
  };
  report.model = target.is_solid ? likeness::solid_volume(target.triangles, corner, options.pixels)
                                 : before(target.triangles);
  report.card = before(structure.triangles);
}

Result<void> write_files(const Options& options, const CompareReport& report,
                         const likeness::Target& aim, const ComparedTarget& target,
                         const ComparedStructure& structure) {
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  const auto picture = compare_picture(
      aim, target.triangles, structure.triangles,
      fmt::format("{} against {}: error {:.4f}", report.pattern, report.target, report.error()));
  if (!picture) return tl::unexpected(picture.error());
  if (auto done = folder->add("compare.png", *picture); !done) return done;
  if (auto done = folder->add("compare.json", compare_json(report)); !done) return done;
  return folder->commit("popcut compare " POPCUT_VERSION);
}

/// The cards of a book, or one pattern.
Result<ComparedStructure> read_given(const Options& options, const Given& given,
                                     std::optional<double> psi, const Progress& progress) {
  if (given.cards.empty()) return read_structure(options.pattern, psi, progress);
  if (psi)
    return fail(ErrorKind::Usage, "--psi",
                "is for one pattern; popcut compares a book when it is open all around");
  return read_compared_book(given.cards, progress);
}

/// The colours of a model's triangles; empty: clay.
std::vector<likeness::Rgb> printed_colours(const Options& options, const ComparedTarget& target) {
  constexpr std::size_t kNumbers = 9;  // of a triangle
  std::filesystem::path file(options.target);
  auto bytes = read_model_file(file);
  if (bytes && !is_model_file(file)) {
    const auto spec = parse_design_spec(*bytes);
    const auto* mesh = spec && spec->surface ? std::get_if<MeshSpec>(&*spec->surface) : nullptr;
    if (mesh == nullptr) return {};
    file = file.parent_path() / mesh->file;
    bytes = read_model_file(file);
  }
  const auto model = bytes ? model_in_colours(file, *bytes) : std::nullopt;
  return model ? mean_colours(*model, target.triangles.size() / kNumbers)
               : std::vector<likeness::Rgb>();
}

/// A card of several parts, printed.
Result<void> run_compare_parts(const Options& options, const Globals& globals) {
  if (!options.psi.empty() || options.around || options.fit || options.scale ||
      !options.rotate.empty() || !options.move.empty())
    return fail(ErrorKind::Usage, "command line",
                "a card of several parts is compared as its design opens it; leave out --psi, "
                "--around, --scale, --rotate, --move and --fit");
  std::optional<LongWork> work(std::in_place, !globals.quiet, "making the design");
  const auto found =
      compare_parts(options.pattern, options.target, options.pixels, work->progress());
  work.reset();
  if (!found) return tl::unexpected(found.error());
  const PartsReport report{options.pattern, options.target, options.pixels, found->opens_flat,
                           found->printed};
  if (!options.folder.empty()) {
    auto folder = OutputFolder::open(options.folder);
    if (!folder) return tl::unexpected(folder.error());
    if (auto done = folder->add("compare.json", compare_json(report)); !done) return done;
    if (auto done = folder->commit("popcut compare " POPCUT_VERSION); !done) return done;
  }
  if (!globals.quiet) fmt::print("{}", globals.json ? compare_json(report) : compare_text(report));
  return {};
}

Result<void> run_compare(Options options, const Globals& globals) {
  if (options.more.empty() && is_card_of_parts(options.pattern)) {
    if (options.printed) return run_compare_parts(options, globals);
    return fail(ErrorKind::OutOfRange, options.pattern,
                "is a card of several parts; popcut compares those printed: add --printed, and "
                "give the design as TARGET");
  }
  const auto psi = psi_of(options);
  if (!psi) return tl::unexpected(psi.error());
  const auto files = given_files(options);
  if (!files) return tl::unexpected(files.error());
  options.target = files->target;
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the pattern");
  const auto structure = read_given(options, *files, *psi, work->progress());
  if (!structure) return tl::unexpected(structure.error());
  const GivenPlacement given{
      options.scale, options.rotate.empty() ? std::nullopt : three_numbers(options.rotate),
      options.move.empty() ? std::nullopt : three_numbers(options.move), options.fit};
  options.around = options.around || structure->is_book;
  const auto target = read_compared_target(options.target, *structure, given, work->progress());
  if (!target) return tl::unexpected(target.error());
  constexpr double kRight = std::numbers::pi / 2, kAsRight = 1e-6;
  if (options.printed && (options.around || !structure->corner ||
                          std::abs(structure->corner->opening_rad - kRight) > kAsRight))
    return fail(ErrorKind::Usage, "--printed",
                "is for one card that is open to 90 degrees; leave it out");
  work->now("comparing");
  likeness::Scene scene;
  scene.pixels = options.pixels;
  const likeness::Corner corner = structure->corner.value_or(likeness::Corner{});
  scene.views = options.around ? likeness::round_views() : likeness::cone_views(corner.opening_rad);
  if (!options.around) scene.corner = structure->corner;
  const likeness::Target aim(target->triangles, scene);
  if (aim.is_unseen())
    return fail(ErrorKind::OutOfRange, options.target,
                "no part of the model is in front of the card; place it with --scale, "
                "--rotate and --move, or let popcut search with --fit");
  CompareReport report;
  report.pattern = options.pattern, report.target = options.target;
  report.psi_rad = structure->psi_rad;
  report.around = options.around, report.pixels = options.pixels;
  report.placed_by = target->placed_by;
  report.placement = target->placement, report.misfit = target->misfit;
  report.notes = structure->notes;
  std::vector<float> standing;
  const bool around_card = options.around && structure->corner;
  if (around_card)
    standing = likeness::without_card(structure->triangles, corner, 1e-4 * aim.box().diagonal());
  report.figures = aim.measure(around_card ? standing : structure->triangles);
  if (options.printed)
    report.printed =
        likeness::PrintedTarget(target->triangles, printed_colours(options, *target), scene)
            .measure(structure->triangles);
  add_volumes(options, *structure, *target, report);
  work.reset();
  report.cost = cost_of(options, *files, *structure, globals);
  if (!structure->is_mesh)
    report.paper = {structure->folds, structure->smallest_joint_mm,
                    std::max(structure->pieces, report.cost.pieces)};
  if (!options.folder.empty())
    if (auto done = write_files(options, report, aim, *target, *structure); !done) return done;
  if (globals.json)
    fmt::print("{}", compare_json(report));
  else if (!globals.quiet)
    fmt::print("{}", compare_text(report));
  return {};
}

constexpr const char* kHelp =
    "Measure how much a card looks like the model that it is made from.\n\n"
    "  popcut compare bunny/pattern.fold bunny.stl\n"
    "  popcut compare sphere/pattern.fold sphere.json -o seen --json\n"
    "  popcut compare teapot/pattern.fold teapot.obj --printed\n"
    "  popcut compare teapot-book teapot.obj --around\n\n"
    "PATTERN is a FOLD file or a drawing (SVG, DXF), from popcut or any other program, or a mesh\n"
    "(STL, OBJ, GLB) of an opened card. TARGET is a mesh, heights (CSV) or a design (.json). "
    "popcut\n"
    "draws both from nine directions around the card's diagonal and compares depths, contours,\n"
    "the covered part and the volume; it also says what the card costs to cut. The last line is\n"
    "the error, a number to rank cards: 0 is the model itself. popcut looks at a book (its folder\n"
    "or the FOLD files of its cards) from all around. A card of several parts needs --printed and\n"
    "its design as TARGET.\n\n"
    "A pattern that popcut designed from a mesh says where the mesh stands. Otherwise give\n"
    "--scale, --rotate and --move, as in a design; without them popcut searches for the place.";

void add_place_options(const Command& command, Options& options) {
  real_number(command.add_option("--scale", options.scale, "Size of one unit of the model, in mm"),
              1e-6, 1e6, "mm")
      .value_text("MM [1]");
  const auto triple = [&](const char* name, std::string& into, const char* help) {
    command.add_option(name, into, help)
        .checked([](const std::string& text) {
          return three_numbers(text)
                     ? std::string()
                     : fmt::format("is \"{}\"; give three numbers such as 0,90,0", text);
        })
        .value_text("X,Y,Z [0,0,0]");
  };
  triple("--rotate", options.rotate,
         "Turn the model about x, then y, then z, in degrees; x runs away from the wall, y along "
         "the spine and z up");
  triple("--move", options.move, "Then move it by this distance, in mm");
  command.add_flag(
      "--fit", options.fit,
      "Search for the place where the model fits best; ignore the place that the pattern names");
}

}  // namespace
}  // namespace compare_command

void register_compare(const Command& app, const Globals& globals, Run& run) {
  using namespace compare_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("compare", kHelp);
  command
      .add_option("PATTERN", options->pattern,
                  "A FOLD file, a drawing, a mesh of a card, or the folder of a book")
      .required();
  command
      .add_option("TARGET", options->target,
                  "The model: a mesh (.stl, .obj, .glb, .gltf), heights (.csv) or a design (.json)")
      .required();
  command.add_option("MORE", options->more,
                     "With more than two files, the last is the model, and all others are the "
                     "cards of a book, in order");
  add_place_options(command, *options);
  command
      .add_option("--psi", options->psi,
                  "Opening angle to compare at, such as 90deg or pi/2; default: the one that the "
                  "pattern is designed for")
      .value_text("ANGLE");
  command.add_flag("--around", options->around,
                   "Look from 36 directions all around the spine; books always do");
  command.add_flag("--printed", options->printed,
                   "Compare the card as 'popcut print' prints it, in colours and outlines. The "
                   "error is then that of the picture, and popcut says good, fair or poor");
  whole_number(
      command.add_option("--pixels", options->pixels, "Width and height of each image, in pixels"),
      likeness::kLeastPixels, likeness::kMostPixels)
      .value_text("N [512]");
  command.add_option("--machine", options->machine, "Machine for the time of the cut, as in plan")
      .value_text("NAME");
  command.add_option("--material", options->material, "Material to cut, as in plan")
      .value_text("NAME");
  command.add_option("--mat", options->mat, "Mat to cut on, as in plan")
      .checked([](const std::string& text) {
        const auto read = read_plan_options({{"mat", text}});
        return read ? std::string() : read.error().detail;
      })
      .value_text("NAME|WxH");
  command.add_flag("--no-cost", options->no_cost, "Do not plan the cut");
  command
      .add_option("-o,--output", options->folder,
                  "Folder for compare.png (model, card and difference from three directions) and "
                  "compare.json; created if it does not exist")
      .value_text("DIR");
  when_chosen(command, run, [options, &globals] { return run_compare(*options, globals); });
}

}  // namespace popcut::cli
