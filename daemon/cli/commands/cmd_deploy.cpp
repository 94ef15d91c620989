// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/deploy/loaded_pattern.hpp"
#include "core/formats/csv/segments_reader.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/judge/sheet_motion.hpp"
#include "core/machines/machine.hpp"
#include "core/picture/poster.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/deploy_book.hpp"
#include "daemon/cli/commands/deploy_files.hpp"
#include "daemon/cli/input/book_input.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/planning/views/book_animation.hpp"

namespace popcut::cli {
namespace deploy_command {
namespace {

struct Options {
  std::string file, folder, convention{"popcut"}, material{"paper-220"};
  std::string svg_profile{"auto"};
  MotionOptions motion;
  bool glb{false}, poster{false}, film{false}, no_stl{false};
};

/// A pattern to open, and what its meshes are made of.
struct Source {
  Pattern pattern;
  bool loose{false};  ///< rectangles from a table of panels, else faces of a sheet
  std::optional<judge::SolvedPoses> motion{};  ///< none: popcut's own law of motion
  std::vector<std::string> notes{};

  [[nodiscard]] const judge::SolvedPoses* solved() const { return motion ? &*motion : nullptr; }
};

bool is_table(const std::string& file, const std::string& text) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".csv") return true;
  if (ending == ".fold" || ending == ".json" || is_drawing(text, file)) return false;
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] != '{';
}

/// A pattern that has to be opened from its flat sheet.
///
/// @param design_psi_rad  the angle that the file says it is designed for
Result<Source> open_sheet(const Options& options, const std::string& fold, double design_psi_rad,
                          const Progress& progress) {
  const auto angles = angles_of(options.motion, design_psi_rad);
  if (!angles) return tl::unexpected(angles.error());
  auto opened = judge::open_flat_sheet(fold, *angles, progress);
  if (!opened) return tl::unexpected(within(options.file, opened.error()));
  Source source{std::move(opened->pattern), false, std::move(opened->motion)};
  source.pattern.design_psi_rad = design_psi_rad;
  if (source.pattern.name.empty())
    source.pattern.name = std::filesystem::path(options.file).stem().string();
  source.notes.emplace_back(
      source.motion ? "opened with rigid panels, turned by the longest fold line: the panels are "
                      "not all parallel to wall or ground"
                    : "the panels were found from the lines of the flat sheet");
  return source;
}

bool is_flat_sheet(const FoldFrame& frame) {
  return !frame.folded_form && !frame.vertices.empty() &&
         std::all_of(frame.vertices.begin(), frame.vertices.end(),
                     [&](const auto& p) { return p[2] == frame.vertices.front()[2]; });
}

/// The pattern of a FOLD file: as its frames show it, else opened from its flat sheet.
Result<Source> read_fold_source(const Options& options, const std::string& text,
                                const Progress& progress) {
  const auto file = read_fold(text);
  if (!file && is_design_spec(text))
    return tl::unexpected(not_yet_designed(options.file, "deploy"));
  if (!file) return tl::unexpected(within(options.file, file.error()));
  auto pattern = pattern_from_fold(*file);
  if (pattern) return Source{std::move(*pattern), false};
  // Without the flat sheet there is nothing to open, and this error says so.
  if (std::none_of(file->frames.begin(), file->frames.end(), is_flat_sheet))
    return tl::unexpected(within(options.file, pattern.error()));
  const double psi = file->design_psi_rad.value_or(0);
  auto opened = open_sheet(
      options, text, psi > 0 && psi < std::numbers::pi ? psi : Pattern().design_psi_rad, progress);
  return opened;
}

Result<Source> read_source(const Options& options, SegmentConvention convention,
                           const Progress& progress) {
  constexpr std::uintmax_t kLimitBytes = 1u << 29;
  if (auto valid = check_no_model(options.file, "deploy"); !valid)
    return tl::unexpected(valid.error());
  const auto text = read_file(options.file, kLimitBytes);
  if (!text) return tl::unexpected(text.error());
  const auto inside = [&](const Error& error) {
    return tl::unexpected<Error>(within(options.file, error));
  };
  if (is_table(options.file, *text)) {
    const auto panels = read_segments_csv(*text, convention);
    if (!panels) return inside(panels.error());
    return Source{
        pattern_from_segments(*panels, std::filesystem::path(options.file).stem().string()), true};
  }
  if (convention == SegmentConvention::Paper) {
    return fail(ErrorKind::Usage, "command line",
                "--convention paper is only for tables (.csv); leave it out for a FOLD file or a "
                "drawing");
  }
  if (!is_drawing(*text, options.file)) return read_fold_source(options, *text, progress);
  std::vector<std::string> warnings;
  const auto fold = fold_of_drawing(*text, options.file, options.svg_profile, warnings);
  if (!fold) return tl::unexpected(fold.error());
  auto source = open_sheet(options, *fold, Pattern().design_psi_rad, progress);
  if (source) source->notes.insert(source->notes.begin(), warnings.begin(), warnings.end());
  return source;
}

Result<SegmentConvention> parse_convention(const std::string& word) {
  if (word == "popcut") return SegmentConvention::Popcut;
  if (word == "paper") return SegmentConvention::Paper;
  return fail(ErrorKind::Usage, "--convention",
              fmt::format("'{}' is not a convention; give popcut or paper", word));
}

Result<SheetMesh> mesh_of(const Source& source, double thickness_mm) {
  if (thickness_mm > 0) return solid_mesh(source.pattern, thickness_mm);
  if (source.loose) return rectangle_mesh(source.pattern);
  return surface_mesh(source.pattern);
}

Result<void> write_all(const Options& options, const Source& source, double thickness_mm,
                       const std::vector<double>& angles, MeshAxes axes, OutputFolder& folder,
                       LongWork& work) {
  if (!options.no_stl) {
    const auto mesh = mesh_of(source, thickness_mm);
    if (!mesh) return tl::unexpected(within(options.file, mesh.error()));
    auto done = add_meshes(source.pattern, *mesh, angles, axes, "", folder, work.progress(),
                           source.solved());
    if (!done) return done;
  }
  work.now("writing deploy.glb");
  if (options.glb) {
    if (auto done = add_glb(source.pattern, angles, thickness_mm, folder, source.solved()); !done)
      return done;
  }
  work.now("drawing the pictures");
  if (options.poster) {
    if (auto done = add_poster(source.pattern, angles, PosterOptions{}.scene, folder); !done)
      return done;
  }
  if (options.film) return add_film(source.pattern, angles, folder);
  return {};
}

void say(const Options& options, const Globals& globals, const Source& source,
         const std::vector<double>& angles, MeshAxes axes) {
  if (globals.json) {
    const nlohmann::ordered_json said{
        {"file", options.file},
        {"faces", source.pattern.faces()},
        {"frames", options.no_stl ? 0 : angles.size()},
        {"psi_from_rad", angles.front()},
        {"psi_to_rad", angles.back()},
        {"axes", axes == MeshAxes::Paper ? "x, 1 - z, v" : "x, v, z"}};
    print_json(said);
  }
  if (globals.quiet) return;
  for (const std::string& note : source.notes) fmt::print(stderr, "  note     {}\n", note);
  fmt::print(
      stderr,
      "{}: {} {}, opening angle (psi) from {:.4g} to {:.4g} rad\n  wrote    {}{}{}{} in {}\n",
      options.file, source.pattern.faces(), source.loose ? "panels" : "rigid faces", angles.front(),
      angles.back(), options.no_stl ? "" : fmt::format("{} meshes (psi_NNN.stl) ", angles.size()),
      options.glb ? "deploy.glb " : "", options.poster ? "poster.svg " : "",
      options.film ? "film.svg " : "", options.folder);
}

/// The poses of a whole book as one mesh.
Result<void> write_book(const Options& options, const DeployedBook& book,
                        const std::vector<double>& angles, double thickness_mm,
                        OutputFolder& folder, LongWork& work) {
  if (!options.no_stl) {
    const auto mesh = book_mesh(book, thickness_mm);
    if (!mesh) return tl::unexpected(within(options.file, mesh.error()));
    auto done = add_book_meshes(book, *mesh, angles, folder, work.progress());
    if (!done) return done;
  }
  if (!options.glb) return {};
  work.now("writing book.glb");
  const auto animation = planning::book_animation_glb(book.pointers(), book.name, thickness_mm);
  if (!animation) return tl::unexpected(within(options.file, animation.error()));
  return folder.add("book.glb", *animation);
}

Result<void> deploy_book(Options options, double thickness_mm, const Globals& globals) {
  for (const auto& [is_given, name] :
       {std::pair{options.poster, "--poster"}, std::pair{options.film, "--film"},
        std::pair{options.convention == "paper", "--convention"}})
    if (is_given)
      return fail(
          ErrorKind::Usage, name,
          fmt::format("is for one card; give one, such as {}/card-01/pattern.fold", options.file));
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the book");
  const auto book = read_deployed_book(options.file);
  if (!book) return tl::unexpected(book.error());
  if (!from_is_given(options.motion)) options.motion.from_psi = "0";
  const double design_psi = book->cards.front().design_psi_rad;
  const auto angles = angles_of(options.motion, design_psi);
  if (!angles) return tl::unexpected(angles.error());
  constexpr double kRounding = 1e-9;
  if (std::max(angles->front(), angles->back()) > design_psi + kRounding)
    return fail(
        ErrorKind::Usage, options.motion.to_psi.empty() ? "--from-psi" : "--to-psi",
        fmt::format(
            "opens each card to more than {:.4g} rad, so that the cards meet; give at most that",
            design_psi));
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = write_book(options, *book, *angles, thickness_mm, *folder, *work); !done)
    return done;
  if (auto done = folder->commit("popcut deploy " POPCUT_VERSION); !done) return done;
  work.reset();
  if (globals.json)
    print_json(nlohmann::ordered_json{{"file", options.file},
                                      {"cards", book->cards.size()},
                                      {"frames", options.no_stl ? 0 : angles->size()},
                                      {"psi_from_rad", angles->front()},
                                      {"psi_to_rad", angles->back()}});
  if (!globals.quiet)
    fmt::print(stderr,
               "{}: a book of {} cards, each from {:.4g} to {:.4g} rad\n  wrote    {}{}in {}\n",
               options.file, book->cards.size(), angles->front(), angles->back(),
               options.no_stl ? "" : fmt::format("{} meshes (psi_NNN.stl) ", angles->size()),
               options.glb ? "book.glb " : "", options.folder);
  return {};
}

Result<void> run_deploy(Options options, const Globals& globals) {
  give_back_file(options.motion, options.file);
  const auto convention = parse_convention(options.convention);
  if (!convention) return tl::unexpected(convention.error());
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto material = find_material(options.material, tables->texts);
  if (!material) {
    const Error error = tables->with_file(material.error());
    if (!error.place.empty()) return tl::unexpected(error);
    return fail(ErrorKind::Usage, "--material", error.detail);
  }
  const auto thickness = thickness_of(options.motion, material->thickness_mm);
  if (!thickness) return tl::unexpected(thickness.error());
  if (options.file.empty()) {
    return fail(ErrorKind::Usage, "command line",
                "FILE is missing; give a pattern (FOLD, SVG, DXF) or a table of panels (.csv)");
  }
  if (names_book(options.file)) return deploy_book(options, *thickness, globals);
  const bool paper = *convention == SegmentConvention::Paper;
  if (paper && !from_is_given(options.motion)) options.motion.from_psi = "0";
  if (const auto valid = angles_of(options.motion, Pattern().design_psi_rad); !valid)
    return tl::unexpected(valid.error());
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the pattern");
  const auto source = read_source(options, *convention, work->progress());
  if (!source) return tl::unexpected(source.error());
  if (source->motion && (options.poster || options.film))
    return fail(ErrorKind::Usage, options.poster ? "--poster" : "--film",
                "draws only patterns whose panels are all parallel to wall or ground, and these "
                "are not; give --glb for an animation");
  const auto angles = angles_of(options.motion, source->pattern.design_psi_rad);
  if (!angles) return tl::unexpected(angles.error());
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  const MeshAxes axes = paper ? MeshAxes::Paper : MeshAxes::Upright;
  if (auto done = write_all(options, *source, *thickness, *angles, axes, *folder, *work); !done)
    return done;
  if (auto done = folder->commit("popcut deploy " POPCUT_VERSION); !done) return done;
  work.reset();
  say(options, globals, *source, *angles, axes);
  return {};
}

constexpr const char* kHelp =
    "Write 3D models (STL) of a pattern as it opens.\n\n"
    "  popcut deploy sphere/pattern.fold -o poses --glb --poster\n"
    "  popcut deploy drawing.svg -o poses --glb\n"
    "  popcut deploy segments.csv --convention paper -o poses\n"
    "  popcut deploy teapot-book -o poses --glb\n\n"
    "FILE is a FOLD file or a drawing (SVG, DXF), from popcut or any other program, or a table of\n"
    "panels with twelve columns, as popcut or the code of the scientific paper writes it. If the\n"
    "file has only the flat sheet, popcut finds the panels and opens them as 'popcut verify'\n"
    "does. popcut writes one mesh (a 3D model) for each pose into DIR: psi_001.stl, psi_002.stl\n"
    "and so on, binary STL in mm. x points away from the wall, v along the spine (the card's\n"
    "main fold; y in a design), z up. The opening angle (psi) is pi for the flat sheet, pi/2 for\n"
    "the designed shape and 0 for the closed card. A design with design_angle_deg has its shape\n"
    "at that angle, and the poses end there. --convention paper reads and writes the axes of the\n"
    "scientific paper (X = x, Z = 1 - y, v = z), from psi = 0 to pi/2. For a book, give\n"
    "its folder: each mesh has all cards around the spine, from shut to open; --glb writes\n"
    "book.glb.";

}  // namespace
}  // namespace deploy_command

void register_deploy(const Command& app, const Globals& globals, Run& run) {
  using namespace deploy_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("deploy", kHelp);
  command.add_option(
      "FILE", options->file,
      "A FOLD file, a drawing (SVG, DXF), a table of panels (CSV, twelve columns), or the folder "
      "of a book");
  command
      .add_option("-o,--output", options->folder,
                  "Folder for the files; created if it does not exist")
      .value_text("DIR")
      .required();
  add_motion_options(command, options->motion);
  command.add_option("--material", options->material, "Material whose thickness --thickness uses")
      .value_text("NAME [paper-220]");
  command
      .add_option("--convention", options->convention,
                  "Axes of the CSV: popcut, or paper for files of the scientific paper's code")
      .value_text("NAME [popcut]");
  add_svg_profile(command, options->svg_profile);
  command.add_flag("--glb", options->glb, "Also write deploy.glb: one animated 3D file (glTF)");
  command.add_flag("--poster", options->poster,
                   "Also write poster.svg: several poses side by side");
  command.add_flag("--film", options->film, "Also write film.svg: an animated drawing");
  command.add_flag("--no-stl", options->no_stl, "Do not write the STL files");
  when_chosen(command, run, [options, &globals] { return run_deploy(*options, globals); });
}

}  // namespace popcut::cli
