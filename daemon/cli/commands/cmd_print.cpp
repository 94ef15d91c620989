// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/artwork/pattern_lines.hpp"
#include "core/deploy/glb.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/layout/sheet.hpp"
#include "core/machines/machine.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/plan_options.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "core/print/pages.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/program_sheet_file.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/options/plan_arguments.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/pictures/artwork_pages.hpp"
#include "daemon/pictures/image_reader.hpp"
#include "daemon/pictures/pdf.hpp"
#include "daemon/planning/views/print_picture.hpp"
#include "daemon/planning/views/printed_design.hpp"

namespace popcut::cli {
namespace print_command {
namespace {

using planning::PrintedDesign;

struct Options {
  PlanArguments plan;
  std::string folder, mode{"view"}, image, model, page;
  double dpi{300}, trap_mm{0.3}, bleed_mm{1}, shade{}, scale_x{100}, scale_y{100};
  Option shade_option{};
  bool clay{false}, bare_card{false}, back{false}, preview{false}, no_marks{false};
  bool cut_lines{false};
};

/// The model of a design: the one that was asked for, else the mesh that the spec names.
Result<std::optional<ColourMesh>> model_of(const Options& options, const DesignSpec& spec,
                                           const SurfaceAssets& assets) {
  std::optional<ColourMesh> none;
  const bool is_mesh = spec.surface && std::holds_alternative<MeshSpec>(*spec.surface);
  if (options.model.empty() && !is_mesh) return none;
  const std::filesystem::path spec_folder = std::filesystem::path(options.plan.input).parent_path();
  const std::filesystem::path path = options.model.empty() ? spec_folder / asset_of(spec.surface)
                                                           : std::filesystem::path(options.model);
  Result<std::string> bytes = std::string();
  if (options.model.empty())
    bytes = assets.at(asset_of(spec.surface));
  else
    bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  auto mesh = read_colour_mesh(path.string(), *bytes, files_beside(path), !options.clay);
  if (!mesh) return tl::unexpected(mesh.error());
  if (options.clay) make_clay(*mesh);
  return std::optional(std::move(*mesh));
}

Result<void> keep_design(const Options& options, PrintMode mode, const DesignSpec& spec,
                         const SurfaceAssets& assets, const PatchAssembly& made,
                         PrintedDesign& design) {
  if (mode == PrintMode::Flat) {
    for (const Design& part : made.parts) design.parts.push_back(part.pattern);
    design.around = made.book.has_value();
    return {};
  }
  if (!spec.patches.empty() && !options.model.empty())
    return fail(ErrorKind::Usage, "--model",
                "is only for designs of one surface, but this one has patches; leave it out");
  const auto model = model_of(options, spec, assets);
  if (!model) return tl::unexpected(model.error());
  auto printed = planning::printed_design(spec, assets, made, *model);
  if (!printed) return tl::unexpected(printed.error());
  design = std::move(*printed);
  return {};
}

Result<void> keep_layers(const Options& options, PrintMode mode, const DesignSpec& spec,
                         const SurfaceAssets& assets, const LayeredCard& made,
                         PrintedDesign& design) {
  if (mode == PrintMode::Flat || mode == PrintMode::Lines)
    return fail(
        ErrorKind::Usage, "--mode",
        "must be view for a card of layers: each layer shows the model as you see it when you "
        "look down on the card");
  const auto model = model_of(options, spec, assets);
  if (!model) return tl::unexpected(model.error());
  design = planning::printed_layers(made, *model);
  return {};
}

Result<void> keep_boxes(const Options& options, PrintMode mode, const DesignSpec& spec,
                        const SurfaceAssets& assets, const BoxedCard& made, PrintedDesign& design) {
  if (mode == PrintMode::Flat || mode == PrintMode::Lines)
    return fail(ErrorKind::Usage, "--mode",
                "must be view for a card of boxes: they are printed with the model's colours");
  const auto model = model_of(options, spec, assets);
  if (!model) return tl::unexpected(model.error());
  design = planning::printed_boxes(made, *model);
  return {};
}

/// Slices show the shape by their outlines: on their sheets are names, letters and outlines alone.
Result<void> check_no_artwork(const Options& options, PrintMode mode) {
  for (const auto& [is_given, name] :
       {std::pair(mode != PrintMode::View, "--mode"), std::pair(!options.model.empty(), "--model"),
        std::pair(options.clay, "--clay"), std::pair(options.back, "--back"),
        std::pair(options.shade_option.is_given(), "--shade"),
        std::pair(options.bare_card, "--bare-card"), std::pair(options.preview, "--preview")})
    if (is_given)
      return fail(ErrorKind::Usage, name,
                  "is for artwork, and slices carry none: their sheets show names, and where tabs "
                  "go; leave it out");
  return {};
}

Result<PrintMode> mode_of(const Options& options) {
  constexpr std::array<std::pair<const char*, PrintMode>, 4> kModes{
      {{"view", PrintMode::View},
       {"surface", PrintMode::Surface},
       {"flat", PrintMode::Flat},
       {"lines", PrintMode::Lines}}};
  PrintMode mode = PrintMode::View;
  for (const auto& [name, value] : kModes)
    if (options.mode == name) mode = value;
  if (mode == PrintMode::Flat && options.image.empty())
    return fail(ErrorKind::Usage, "--mode",
                "flat prints a picture of your own; give it with --image FILE");
  if (mode != PrintMode::Flat && !options.image.empty())
    return fail(ErrorKind::Usage, "--image", "is for --mode flat; add it, or leave --image out");
  if (mode == PrintMode::Lines && options.back)
    return fail(ErrorKind::Usage, "--back", "prints pictures; leave it out with --mode lines");
  return mode;
}

/// The first option that was given and that plans of marked sheets refuse; empty: none.
std::string unmarked_option(const PlanArguments& plan) {
  for (const char* name : {"per-sheet", "weed-box", "clip", "scale", "width", "rotate", "mirror"}) {
    const auto given = plan.options.find(name);
    if (given == plan.options.end()) continue;
    if (read_plan_options({*given}) && !read_plan_options({*given, {"marks", "true"}})) return name;
  }
  return {};
}

/// Marks are printed where the cutter looks for them, unless a person says otherwise.
Result<void> choose_marks(const Options& options, PlanArguments& plan) {
  if (options.no_marks || plan.options.contains("marks")) return {};
  if (plan.machine.empty() && plan.options.contains("mat")) return {};
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto machine = find_machine(plan.machine.empty() ? "cameo3" : plan.machine, tables->texts);
  // A machine that is not known is an error of the plan.
  if (!machine || !machine->driven() || machine->language != "gpgl") return {};
  if (const std::string name = unmarked_option(plan); !name.empty())
    return fail(ErrorKind::Usage, "--" + name,
                fmt::format("and registration marks exclude each other, and popcut prints marks "
                            "for {}; leave it out, or print without marks (--no-marks)",
                            machine->title));
  plan.options["marks"] = "true";
  return {};
}

Result<PrintPageOptions> page_options(const Options& options) {
  PrintPageOptions out;
  out.pixel_mm = 25.4 / options.dpi;
  out.trapping = {options.trap_mm, std::max(options.bleed_mm, options.trap_mm)};
  out.back = options.back;
  out.cut_lines = options.cut_lines;
  out.bars_mm = {options.scale_x, options.scale_y};
  if (options.page.empty()) return out;
  const auto size = parse_size_mm(options.page);
  if (!size) return fail(ErrorKind::Usage, "--page", size.error().detail);
  out.page_mm = *size;
  return out;
}

Result<Artwork> artwork_of(const Options& options, PrintMode mode, const PrintedDesign& design,
                           const PlanJob& job, const PrintPageOptions& pages, LongWork& work) {
  std::optional<Texture> image;
  if (mode == PrintMode::Flat) {
    const auto bytes = read_file(options.image);
    if (!bytes) return tl::unexpected(bytes.error());
    auto pixels = read_image(options.image, *bytes);
    if (!pixels) return tl::unexpected(pixels.error());
    image.emplace(std::move(*pixels));
    image->wraps.fill(PictureWrap::Clamp);
  }
  ArtworkOptions how;
  how.mode = mode;
  how.pixel_mm = pages.pixel_mm;
  how.trapping = pages.trapping;
  how.shade = options.shade_option.is_given() ? options.shade : planning::usual_shade(design);
  how.bare_card = options.bare_card;
  how.progress = work.progress();
  return planning::planned_artwork(design, job.plan, image ? &*image : nullptr, how);
}

/// The pattern opened with its artwork on it. `part` counts from 0.
Result<void> add_animation(const PrintedDesign& design, const Artwork& artwork, std::size_t part,
                           OutputFolder& folder) {
  const Pattern& pattern = design.parts[part];
  auto png = png_of_image(on_paper(artwork.image));
  if (!png) return tl::unexpected(png.error());
  const PixelFrame& frame = artwork.frame;
  const auto angles = opening_angles(std::numbers::pi, pattern.design_psi_rad, 60);
  if (!angles) return tl::unexpected(angles.error());
  const auto table = pose_table(pattern, *angles);
  if (!table) return tl::unexpected(table.error());
  GlbOptions how;
  how.creator = "popcut " POPCUT_VERSION;
  how.front = {std::move(*png), frame.left_mm - pattern.place.v_mm,
               frame.top_mm - pattern.place.u_mm, static_cast<double>(frame.width) * frame.pixel_mm,
               static_cast<double>(frame.height) * frame.pixel_mm};
  const auto bytes = glb(pattern, *table, how);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::string name =
      design.parts.size() == 1 ? "preview.glb" : fmt::format("preview-{:02}.glb", part + 1);
  return folder.add(name, *bytes);
}

/// What to do with the pages, and the command that cuts them.
void say_next(const Options& options, const PlanJob& job) {
  const std::size_t sheets = job.plan.sheets.size();
  const auto page = [&](std::size_t sheet) {
    return options.folder + "/" + PlanJob::sheet_file(sheet, "pdf");
  };
  fmt::print(stderr,
             "  next     print {}{} at actual size (100 %, not \"fit to page\"), and measure the "
             "bar of 100 mm\n",
             page(0), sheets == 1 ? "" : " to " + page(sheets - 1));
  if (job.plan.machine.language == "hand")
    fmt::print(
        stderr,
        "           press the dashed lines, cut the solid ones, the outline last, and fold{}\n",
        job.plan.layout && !job.plan.layout->seams.empty()
            ? fmt::format("; {}/assembly.pdf shows how to glue the pieces", options.folder)
            : "");
  say_guide(job.plan, options.plan.input, 11);
  if (job.plan.machine.language == "cricut")
    fmt::print(
        stderr,
        "           or let the Cricut print and cut: in Design Space upload {0}/{1} as a Print "
        "Then Cut\n           image and {0}/sheet-01-cricut.svg, select both, Align, Center, "
        "and Attach\n",
        options.folder, PlanJob::sheet_file(0, "png"));
  if (!job.plan.machine.driven()) return;
  if (!job.marks.empty())
    fmt::print(
        stderr,
        "           load {}, printed side up, with the black square at the upper left, and cut "
        "('popcut devices' lists cutters):\n"
        "           popcut cut {} --direct --device usb:SERIAL\n",
        sheets == 1 ? "the page" : "each page when popcut asks for it", typed_plan(options.plan));
  else if (options.plan.machine.empty() && !options.no_marks)
    fmt::print(
        stderr,
        "  note     without marks: no cutter is named. Name yours, such as --machine cameo3; "
        "'popcut machines' lists them\n");
  else if (!options.no_marks)
    fmt::print(
        stderr,
        "  note     without marks: {} does not look for them, so the sheet's edges alone say "
        "where the print is\n",
        job.plan.machine.title);
}

/// What the printed design will look like: a picture, and each part as it opens.
Result<void> add_preview(const PrintedDesign& design, const Plan& plan, const Artwork& artwork,
                         OutputFolder& folder) {
  const auto picture = design.layers  ? print_picture(*design.layers, plan.parts, artwork)
                       : design.boxes ? print_picture(*design.boxes, plan.parts, artwork)
                                      : print_picture(design, artwork);
  if (!picture) return tl::unexpected(picture.error());
  if (auto done = folder.add("preview.png", *picture); !done) return done;
  for (std::size_t k = 0; k < design.parts.size(); ++k)
    if (auto done = add_animation(design, artwork, k, folder); !done) return done;
  return {};
}

void say(const Options& options, const PlanJob& job, const PrintedDesign& design, PrintMode mode) {
  const std::size_t sheets = job.plan.sheets.size();
  if (design.empty())
    fmt::print(stderr, "{}: {} {} of slices, with their names and where tabs go\n", job.plan.name,
               sheets, sheets == 1 ? "sheet" : "sheets");
  else
    fmt::print(stderr, "{}: {} {} at {:g} dots per inch{}\n", job.plan.name, sheets,
               sheets == 1 ? "sheet" : "sheets", options.dpi,
               mode == PrintMode::Flat ? ", your picture laid flat"
               : design.coloured       ? ", in the model's colours"
                                       : ", as clay: the model has no colours");
  for (std::size_t i = 0; i < sheets; ++i)
    if (const std::string names = part_names(parts_on_sheet(job.plan, i)); !names.empty())
      fmt::print(stderr, "  sheet {}  {}\n", i + 1, names);
  for (const Warning& warning : job.plan.warnings)
    fmt::print(stderr, "  warning  {}\n", warning.message);
  say_next(options, job);
}

/// What is printed: pixels, or lines where there are some.
struct Printed {
  const Artwork& artwork;
  const std::string& lines;
};

/// What other programs than popcut take: the artwork with lines to cut, and for Design Space each
/// of them alone.
Result<void> add_for_programs(PlanJob& job, const Printed& printed, const PrintPageOptions& pages,
                              std::size_t i, OutputFolder& folder) {
  const auto svg = artwork_sheet_svg(printed.artwork, printed.lines, job.plan, i, pages);
  if (!svg) return tl::unexpected(svg.error());
  if (auto done = folder.add(PlanJob::sheet_file(i, "svg"), *svg); !done) return done;
  if (job.plan.machine.language != "cricut") return {};
  const std::string title = page_name(fmt::format("{}: sheet {}", job.plan.name, i + 1));
  if (auto done = add_program_sheet(job.plan, i + 1, "cricut", title, folder); !done) return done;
  const auto png = artwork_sheet_png(printed.artwork, job.plan, i, pages);
  if (!png) return tl::unexpected(png.error());
  return folder.add(PlanJob::sheet_file(i, "png"), *png);
}

Result<void> add_sheets(const Options& options, PlanJob& job, const Printed& printed,
                        const PrintPageOptions& pages, LongWork& work, OutputFolder& folder) {
  Plan& plan = job.plan;
  const std::size_t sheets = plan.sheets.size();
  std::vector<PrintedPage> lined;  // by hand: with margins, a legend, and how to glue
  if (plan.machine.language == "hand") {
    auto made =
        sheet_pages(plan, is_blank(printed.artwork) ? PageGround::Paper : PageGround::Artwork);
    if (!made) return tl::unexpected(made.error());
    lined = std::move(*made);
    if (auto warning = font_warning(plan.name, PlanJob::sheet_file(0, "pdf")))
      plan.warnings.push_back(std::move(*warning));
  }
  for (std::size_t i = 0; i < sheets; ++i) {
    work.now("writing the pages", static_cast<double>(i) / static_cast<double>(sheets));
    const auto pdf = artwork_sheet_pdf(printed.artwork, printed.lines, plan, i, pages,
                                       lined.empty() ? nullptr : &lined[i]);
    if (!pdf) return tl::unexpected(pdf.error());
    if (auto done = folder.add(PlanJob::sheet_file(i, "pdf"), *pdf); !done) return done;
    if (options.cut_lines || !plan.machine.driven())
      if (auto done = add_for_programs(job, printed, pages, i, folder); !done) return done;
    if (job.programs.empty()) continue;
    if (auto done = folder.add(job.program_file(i), job.programs[i].bytes); !done) return done;
  }
  if (lined.size() <= sheets) return {};
  const auto more = pdf_of_pages(std::span(lined).subspan(sheets), plan.name);
  if (!more) return tl::unexpected(more.error());
  return folder.add("assembly.pdf", *more);
}

Result<void> run_print(Options options, const Globals& globals) {
  if (options.folder.empty())
    return fail(ErrorKind::Usage, "command line",
                "-o DIR is missing; give the folder for the pages");
  const auto mode = mode_of(options);
  if (!mode) return tl::unexpected(mode.error());
  const auto pages = page_options(options);
  if (!pages) return tl::unexpected(pages.error());
  const bool asked_for_marks = options.plan.options.contains("marks");
  options.plan.keep_lines = options.cut_lines;
  if (auto chosen = choose_marks(options, options.plan); !chosen) return chosen;
  PrintedDesign design;
  bool has_artwork = true;
  auto job = plan_input(
      options.plan, !globals.quiet,
      {[&](const DesignSpec& spec, const SurfaceAssets& assets, const PatchAssembly& made) {
         return keep_design(options, *mode, spec, assets, made, design);
       },
       [&](const DesignSpec& spec, const SurfaceAssets& assets, const LayeredCard& made) {
         return keep_layers(options, *mode, spec, assets, made, design);
       },
       [&] {
         has_artwork = false;
         return check_no_artwork(options, *mode);
       },
       [&](const DesignSpec& spec, const SurfaceAssets& assets, const BoxedCard& made) {
         return keep_boxes(options, *mode, spec, assets, made, design);
       }});
  if (!job && !asked_for_marks && job.error().place == "--marks")
    return fail(job.error().kind, "--marks",
                job.error().detail + "; or print without marks (--no-marks)");
  if (!job) return tl::unexpected(job.error());
  if (design.empty() && has_artwork)
    return fail(ErrorKind::Malformed, options.plan.input,
                "is a pattern without its design, and artwork is laid on a design; give its spec "
                "(.json)");
  LongWork work(!globals.quiet, "drawing the artwork");
  const auto artwork = has_artwork ? artwork_of(options, *mode, design, *job, *pages, work)
                                   : Result<Artwork>(Artwork{});
  if (!artwork) return tl::unexpected(artwork.error());
  std::string lines;
  if (*mode == PrintMode::Lines) {
    auto drawn = pattern_lines(design.parts, design.models, artwork->frame, options.trap_mm);
    if (!drawn) return tl::unexpected(drawn.error());
    lines = std::move(*drawn);
  }
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = add_sheets(options, *job, {*artwork, lines}, *pages, work, *folder); !done)
    return done;
  const auto scale = scale_page_pdf(*pages);
  if (!scale) return tl::unexpected(scale.error());
  if (auto done = folder->add("scale.pdf", *scale); !done) return done;
  if (options.preview)
    if (auto done = add_preview(design, job->plan, *artwork, *folder); !done) return done;
  const std::string json = plan_json(job->plan);
  if (auto done = folder->add("plan.json", json); !done) return done;
  if (auto done = folder->commit("popcut print " POPCUT_VERSION); !done) return done;
  if (globals.json) fmt::print("{}", json);
  if (!globals.quiet) say(options, *job, design, *mode);
  return {};
}

constexpr const char* kHelp =
    "Print artwork on the sheets of a design, in register with the cut.\n\n"
    "  popcut print cat.json -o pages --machine cameo3 --preview\n"
    "  popcut print cat.json -o pages --mode flat --image sky.png\n"
    "  popcut print cat.json -o pages --machine none --mat A4\n\n"
    "INPUT is a design (.json). From half way between ground and wall, the printed card looks\n"
    "like the model itself, even if its panels are coarse. Colours come from the mesh of the\n"
    "design (OBJ with MTL) or from --model (also .glb, .gltf), in the same units and axes; popcut\n"
    "prints a model without colours as clay. It plans the sheets as 'popcut plan' does and writes\n"
    "into DIR:\n\n"
    "  sheet-NN.pdf            the page of each sheet, with the marks that the cutter looks for\n"
    "  sheet-NN.gpgl or .hpgl  the program that cuts it\n"
    "  sheet-NN.svg            with --cut-lines: artwork and lines as layers, for other programs\n"
    "  sheet-NN.png, sheet-NN-cricut.svg  for a Cricut: the artwork and the lines, to upload\n"
    "  assembly.pdf            to cut by hand: how to glue the pieces, if there are several\n"
    "  plan.json               lengths, time and warnings\n"
    "  scale.pdf               two bars of 100 mm, to measure the scale of your printer\n"
    "  preview.glb             with --preview: the card as it opens, with its artwork (one sheet)\n"
    "  preview.png             with --preview: the model, and the printed card from two sides\n\n"
    "On a card of layers, each layer shows the model as you see it when you look down on the open\n"
    "card. Boxes show the model's colours on their walls and roofs. Outlines and letters say "
    "where\n"
    "tabs are glued; 'popcut fold-guide' gives the order. Sheets of slices have no artwork: they\n"
    "show the name of each slice, and where tabs are glued.\n\n"
    "Print at actual size. Load the sheet with the printed side up and the black square at the\n"
    "upper left. popcut prints the command that cuts it: 'popcut cut' with the same options and\n"
    "--marks. Marks need a cutter that looks for them (Silhouette, Graphtec); name yours with\n"
    "--machine. To cut by hand, give --machine none and your paper (--mat): the pages then have\n"
    "the lines to cut and to fold over the artwork, and a legend.";

void add_options(const Command& command, Options& options) {
  one_word(command.add_option("--mode", options.mode,
                              "What is printed: the model as seen (view), the colour of its "
                              "nearest point (surface), a picture of your own over the flat sheet "
                              "(flat), or its edges and shades as lines (lines)"),
           {"view", "surface", "flat", "lines"})
      .value_text("view|surface|flat|lines [view]");
  command.add_option("--image", options.image, "The picture of --mode flat: PNG or JPEG")
      .value_text("FILE");
  command
      .add_option("--model", options.model,
                  "Model whose colours are printed: OBJ, GLB, glTF or STL, in the units and axes "
                  "of the design's mesh; default: that mesh")
      .value_text("FILE");
  command.add_flag("--clay", options.clay, "Leave the model's colours out");
  options.shade_option =
      real_number(command.add_option("--shade", options.shade,
                                     "How much of the colour depends on the light (0 to 1); "
                                     "default: 0.6 for clay, 0 for models with colours"),
                  0, 1);
  options.shade_option.value_text("X");
  real_number(command.add_option("--dpi", options.dpi, "Dots per inch (50 to 1200)"), 50, 1200)
      .value_text("N [300]");
  real_number(command.add_option("--trap", options.trap_mm,
                                 "How far colours extend over each side of a cut (0 to 5 mm)"),
              0, 5, "mm")
      .value_text("MM [0.3]");
  real_number(command.add_option("--bleed", options.bleed_mm,
                                 "How far colours extend beyond the outline (0 to 10 mm)"),
              0, 10, "mm")
      .value_text("MM [1]");
  command.add_flag("--bare-card", options.bare_card,
                   "With --mode surface: leave wall and ground white");
  command.add_flag("--cut-lines", options.cut_lines,
                   "Draw the lines to cut (solid) and to fold (dashed) over the artwork, and write "
                   "sheet-NN.svg; always on with --machine none and Cricuts");
  command.add_flag("--back", options.back,
                   "Add a second, mirrored page for the back of each sheet");
  command.add_flag("--no-marks", options.no_marks, "Print no registration marks");
  real_number(
      command.add_option("--scale-x", options.scale_x,
                         "Length of the horizontal bar of 100 mm on your print (90 to 110 mm)"),
      90, 110, "mm")
      .value_text("MM [100]");
  real_number(
      command.add_option("--scale-y", options.scale_y,
                         "Length of the vertical bar of 100 mm on your print (90 to 110 mm)"),
      90, 110, "mm")
      .value_text("MM [100]");
  command
      .add_option("--page", options.page,
                  "Size of the printer's paper, such as A4 or 330x483; default: that of the sheet")
      .value_text("SIZE");
  command.add_flag("--preview", options.preview, "Also write preview.glb and preview.png");
  command
      .add_option("-o,--output", options.folder,
                  "Folder for the files; created if it does not exist")
      .value_text("DIR");
}

}  // namespace
}  // namespace print_command

void register_print(const Command& app, const Globals& globals, Run& run) {
  using namespace print_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("print", kHelp);
  add_plan_arguments(command, options->plan);
  command.option("INPUT").help("The design (.json) of a card, of layers or of a book");
  add_options(command, *options);
  when_chosen(command, run, [options, &globals] { return run_print(*options, globals); });
}

}  // namespace popcut::cli
