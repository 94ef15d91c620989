// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/deploy/loaded_pattern.hpp"
#include "core/formats/csv/segments_reader.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/machines/machine.hpp"
#include "core/picture/poster.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/deploy_files.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"

namespace popcut::cli {
namespace deploy_command {
namespace {

struct Options {
  std::string file, folder, convention{"popcut"}, material{"paper-220"};
  MotionOptions motion;
  bool glb{false}, poster{false}, film{false}, no_stl{false};
};

/// A pattern to open, and what its meshes are made of.
struct Source {
  Pattern pattern;
  bool loose{false};  ///< rectangles from a table of panels, else faces from a FOLD file
};

bool is_table(const std::string& file, const std::string& text) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".csv") return true;
  if (ending == ".fold" || ending == ".json") return false;
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] != '{';
}

Result<Source> read_source(const Options& options, SegmentConvention convention) {
  constexpr std::uintmax_t kLimitBytes = 1u << 29;
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
                "--convention paper is only for tables (.csv); leave it out for a FOLD file");
  }
  const auto file = read_fold(*text);
  if (!file) return inside(file.error());
  auto pattern = pattern_from_fold(*file);
  if (!pattern) return inside(pattern.error());
  return Source{std::move(*pattern), false};
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
    auto done = add_meshes(source.pattern, *mesh, angles, axes, "", folder, work.progress());
    if (!done) return done;
  }
  work.now("writing deploy.glb");
  if (options.glb) {
    if (auto done = add_glb(source.pattern, angles, thickness_mm, folder); !done) return done;
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
    fmt::print("{}\n", said.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }
  if (globals.quiet) return;
  fmt::print(
      stderr,
      "{}: {} {}, opening angle (psi) from {:.4g} to {:.4g} rad\n  wrote    {}{}{}{} in {}\n",
      options.file, source.pattern.faces(), source.loose ? "panels" : "rigid faces", angles.front(),
      angles.back(), options.no_stl ? "" : fmt::format("{} meshes (psi_NNN.stl) ", angles.size()),
      options.glb ? "deploy.glb " : "", options.poster ? "poster.svg " : "",
      options.film ? "film.svg " : "", options.folder);
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
                "FILE is missing; give a pattern.fold or a table of panels (.csv)");
  }
  const bool paper = *convention == SegmentConvention::Paper;
  if (paper && !from_is_given(options.motion)) options.motion.from_psi = "0";
  if (const auto valid = angles_of(options.motion, Pattern().design_psi_rad); !valid)
    return tl::unexpected(valid.error());
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the pattern");
  const auto source = read_source(options, *convention);
  if (!source) return tl::unexpected(source.error());
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
    "  popcut deploy segments.csv --convention paper -o poses\n\n"
    "FILE is a pattern.fold, or a table of panels with twelve columns, as popcut or the code of\n"
    "the scientific paper writes it. popcut writes one mesh (a 3D model) for each pose into DIR:\n"
    "psi_001.stl, psi_002.stl and so on, binary STL in mm. x points away from the wall, v along\n"
    "the spine (the card's main fold; y in a design), z up. The opening angle (psi) is pi for\n"
    "the flat sheet, pi/2 for the designed shape and 0 for the closed card. A design with\n"
    "design_angle_deg has its shape at that angle, and the poses end there. --convention paper\n"
    "reads and writes the axes of the scientific paper (X = x, Z = 1 - y, v = z), from psi = 0\n"
    "to pi/2.";

}  // namespace
}  // namespace deploy_command

void register_deploy(CLI::App& app, const Globals& globals, Run& run) {
  using namespace deploy_command;
  auto options = std::make_shared<Options>();
  CLI::App* const command = app.add_subcommand("deploy", kHelp);
  command->add_option("FILE", options->file,
                      "A FOLD file, or a table of panels (CSV, twelve columns)");
  command
      ->add_option("-o,--output", options->folder,
                   "Folder for the files; created if it does not exist")
      ->option_text("DIR")
      ->required();
  add_motion_options(*command, options->motion);
  command->add_option("--material", options->material, "Material whose thickness --thickness uses")
      ->option_text("NAME [paper-220]");
  command
      ->add_option("--convention", options->convention,
                   "Axes of the CSV: popcut, or paper for files of the scientific paper's code")
      ->option_text("NAME [popcut]");
  command->add_flag("--glb", options->glb, "Also write deploy.glb: one animated 3D file (glTF)");
  command->add_flag("--poster", options->poster,
                    "Also write poster.svg: several poses side by side");
  command->add_flag("--film", options->film, "Also write film.svg: an animated drawing");
  command->add_flag("--no-stl", options->no_stl, "Do not write the STL files");
  when_chosen(command, run, [options, &globals] { return run_deploy(*options, globals); });
}

}  // namespace popcut::cli
