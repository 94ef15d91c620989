// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/deploy/sheet_mesh.hpp"
#include "core/deploy/shut_stack.hpp"
#include "core/design/book_fit.hpp"
#include "core/design/boxes/boxed_report.hpp"
#include "core/design/layers/layered_report.hpp"
#include "core/design/patches.hpp"
#include "core/design/shape_fit.hpp"
#include "core/design/slices/sliced_report.hpp"
#include "core/drawing/clean.hpp"
#include "core/drawing/linework.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/formats/write/profile_svg.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/formats/write/segments_csv.hpp"
#include "core/judge/boxes_likeness.hpp"
#include "core/judge/layers_likeness.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_design.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/judge/sound_slices.hpp"
#include "core/machines/machine.hpp"
#include "core/picture/deployed_svg.hpp"
#include "core/picture/sheet_picture.hpp"
#include "core/picture/target_on_sheet.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/print/pages.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/book_files.hpp"
#include "daemon/cli/commands/deploy_files.hpp"
#include "daemon/cli/commands/layer_files.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/input/spec_assets.hpp"
#include "daemon/cli/options/angles.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/search/model_search.hpp"
#include "daemon/cli/view/around_card.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/examples/examples.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/pictures/pdf.hpp"
#include "daemon/pictures/png.hpp"
#include "daemon/planning/design_export.hpp"
#include "daemon/planning/design_files.hpp"

namespace popcut::cli {
namespace design_command {
namespace {

using planning::dashed_page;
using planning::Scenery;
using planning::write_csv_file;
using planning::write_cut_file;
using planning::write_deployed_file;
using planning::write_dxf_file;
using planning::write_fold_file;
using planning::write_glb_file;
using planning::write_poster_file;
using planning::write_report_file;
using planning::write_svg_file;
using Job = planning::ExportJob;

struct Options {
  std::string spec, folder, formats{"fold,svg,cut,dxf,csv,glb,png,poster,report"},
      fold_cuts{"split"}, example;
  std::optional<std::string> fold_frames;
  MotionOptions motion;
  bool schema{false}, list{false};
  std::string place, colour{"paper"};
  AroundCard around;
};

// 1. The files of a design: a row a format.

using Streamed = std::function<Result<void>(std::ostream&)>;

Result<void> add_fold(const Job& job, OutputFolder& folder) {
  return folder.add("pattern.fold",
                    Streamed([&](std::ostream& out) { return write_fold_file(job, out); }));
}

Result<void> add_svg(const Job& job, OutputFolder& folder) {
  return folder.add("pattern.svg",
                    Streamed([&](std::ostream& out) { return write_svg_file(job, out); }));
}

Result<void> add_dxf(const Job& job, OutputFolder& folder) {
  return folder.add("pattern.dxf",
                    Streamed([&](std::ostream& out) { return write_dxf_file(job, out); }));
}

Result<void> add_cut(const Job& job, OutputFolder& folder) {
  return folder.add("cut.svg",
                    Streamed([&](std::ostream& out) { return write_cut_file(job, out); }));
}

Result<void> add_cricut(const Job& job, OutputFolder& folder) {
  // Its stylus presses whole folds.
  const LineWork whole = clean(linework_from_pattern(job.made.pattern), {});
  return folder.add("cricut.svg", Streamed([&](std::ostream& out) {
                      return write_cricut_svg(whole, CricutMat{}, out);
                    }));
}

Result<void> add_csv(const Job& job, OutputFolder& folder) {
  return folder.add("segments.csv",
                    Streamed([&](std::ostream& out) { return write_csv_file(job, out); }));
}

Result<void> add_pdf(const Job& job, OutputFolder& folder) {
  const auto pages = pattern_pages(job.made.pattern);
  if (!pages) return tl::unexpected(pages.error());
  const auto pdf = pdf_of_pages(*pages, job.made.pattern.name);
  if (!pdf) return tl::unexpected(pdf.error());
  return folder.add("pattern.pdf", *pdf);
}

Result<void> add_picture(const Job& job, OutputFolder& folder) {
  return folder.add("deployed.svg",
                    Streamed([&](std::ostream& out) { return write_deployed_file(job, out); }));
}

Result<void> add_png(const Job& job, OutputFolder& folder) {
  constexpr int kLargestPx = 1200;
  std::ostringstream pattern, card;
  write_sheet_picture(job.made.pattern, pattern);
  if (auto done = write_deployed_file(job, card); !done) return done;
  for (const auto& [name, svg] :
       {std::pair("pattern.png", pattern.str()), std::pair("deployed.png", card.str())}) {
    const auto png = png_of_svg(svg, kLargestPx);
    if (!png) return tl::unexpected(png.error());
    if (auto done = folder.add(name, *png); !done) return done;
  }
  return {};
}

Result<void> add_stl(const Job& job, OutputFolder& folder) {
  const Design& made = job.made;
  const auto mesh = job.thickness_mm > 0 ? solid_mesh(made.pattern, job.thickness_mm)
                                         : surface_mesh(made.pattern, made.strips);
  if (!mesh) return tl::unexpected(mesh.error());
  return add_meshes(made.pattern, *mesh, job.psi_rad, MeshAxes::Upright, "deploy/", folder);
}

Result<void> add_animation(const Job& job, OutputFolder& folder) {
  return folder.add("deploy.glb",
                    Streamed([&](std::ostream& out) { return write_glb_file(job, out); }));
}

Result<void> add_poses(const Job& job, OutputFolder& folder) {
  return folder.add("poster.svg",
                    Streamed([&](std::ostream& out) { return write_poster_file(job, out); }));
}

Result<void> add_report(const Job& job, OutputFolder& folder) {
  return folder.add("report.json",
                    Streamed([&](std::ostream& out) { return write_report_file(job, out); }));
}

struct Format {
  std::string_view name;
  std::string_view file;
  Result<void> (*add)(const Job&, OutputFolder&);
};

constexpr std::array kFormats{
    Format{"fold", "pattern.fold", add_fold},
    Format{"svg", "pattern.svg", add_svg},
    Format{"cut", "cut.svg", add_cut},
    Format{"dxf", "pattern.dxf", add_dxf},
    Format{"csv", "segments.csv", add_csv},
    Format{"pdf", "pattern.pdf", add_pdf},
    Format{"cricut", "cricut.svg", add_cricut},
    Format{"png", "pattern.png deployed.png", add_png},
    Format{"picture", "deployed.svg", add_picture},
    Format{"poster", "poster.svg", add_poses},
    Format{"glb", "deploy.glb", add_animation},
    Format{"stl", "deploy/psi_NNN.stl", add_stl},
    Format{"report", "report.json", add_report},
};

Result<std::vector<Format>> parse_formats(std::string_view text) {
  std::vector<Format> chosen;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), part.size() + 1));
    const std::string_view name = trimmed(part);
    const auto* const found = std::find_if(kFormats.begin(), kFormats.end(),
                                           [&](const Format& f) { return f.name == name; });
    if (found == kFormats.end()) {
      std::string known;
      for (const Format& format : kFormats) known += fmt::format(" {}", format.name);
      return fail(ErrorKind::Usage, "--formats",
                  fmt::format("'{}' is not a format; give some of:{}", name, known));
    }
    const auto same = [&](const Format& f) { return f.name == name; };
    if (std::none_of(chosen.begin(), chosen.end(), same)) chosen.push_back(*found);
  }
  return chosen;
}

bool are_drawn(const std::vector<Format>& formats) {
  return std::any_of(formats.begin(), formats.end(), [](const Format& f) {
    return f.name == "png" || f.name == "picture" || f.name == "poster";
  });
}

// 2. What is said about it.

void say_figures(const DesignReport& report) {
  const auto count = [](auto n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  fmt::print(stderr, "{}: {}\n", shown_text(report.name),
             report.surface_fit ? fit_in_words(*report.surface_fit) : "nothing stands up");
  const std::string moves = report.degrees_of_freedom == 1
                                ? "opens in one movement"
                                : fmt::format("moves in {} ways", report.degrees_of_freedom);
  if (report.facets)
    fmt::print(stderr, "  made of  {}, {}; seen along the diagonal {:.2g} mm off on average\n",
               count(report.facets->patches, "facet"), moves, report.facets->depth_mean_mm);
  else
    fmt::print(stderr, "  made of  {}, {} lattice, {}\n", count(report.slices.size(), "slice"),
               report.lattice, moves);
  if (report.design_angle_deg != 90.0)
    fmt::print(stderr, "  shape    right when the card is open to {:g} degrees\n",
               report.design_angle_deg);
  fmt::print(stderr, "  sheet    {:.1f} mm across the main fold x {:.1f} mm along it\n",
             report.sheet_u_mm, report.sheet_v_mm);
  fmt::print(stderr, "  lines    {} cuts, {:.0f} mm; folds, {:.0f} mm; {} panels\n", report.cuts,
             report.cut_length_mm, report.fold_length_mm, report.faces);
  fmt::print(stderr, "  by hand  {}\n", hands::handwork_words(report.handwork));
  if (report.wobble)
    fmt::print(stderr,
               "  holds    panels move {:.2g} mm on average, {:.2g} mm at most, when folds are 0.1 "
               "mm off\n",
               report.wobble->mean_mm, report.wobble->largest_mm);
}

void say_remarks(const DesignReport& report, bool all) {
  constexpr std::size_t kFirst = 3;
  if (!report.lattice_note.empty())
    fmt::print(stderr, "  note     {}\n", shown_text(report.lattice_note));
  for (const std::string& note : report.notes)
    fmt::print(stderr, "  note     {}\n", shown_text(note));
  for (const Warning& warning : report.warnings)
    fmt::print(stderr, "  warning  {}\n", shown_text(warning.message));
  for (std::size_t i = 0; i < report.merged.size() && (all || i < kFirst); ++i) {
    const MergedPlace& place = report.merged[i];
    fmt::print(stderr, "  merged   {} {}, level {}: {}\n", place.where, place.slice, place.level,
               place.reason);
  }
  if (!all && report.merged.size() > kFirst) {
    fmt::print(stderr, "  merged   {} more places; use -v, or see report.json\n",
               report.merged.size() - kFirst);
  }
}

/// Models come in all units: one whose numbers are centimetres or metres makes a tiny card.
void say_small_model(const DesignSpec& spec, const DesignReport& report) {
  constexpr double kSmall_mm = 40.0, kUsual_mm = 120.0;
  if (!spec.surface || !std::holds_alternative<MeshSpec>(*spec.surface)) return;
  if (spec.placement.scale_mm != 1.0 || !report.surface_fit) return;
  const double size = report.surface_fit->size_mm;
  if (!(size > 0.0 && size < kSmall_mm)) return;
  fmt::print(
      stderr,
      "  note     the 3D model is {:.3g} mm from corner to corner; \"scale_mm\": {:.0f} makes "
      "it about {:g} mm\n",
      size, kUsual_mm / size, kUsual_mm);
}

void say_joins(const PatchAssembly& made) {
  for (const JoinReport& join : made.joins)
    fmt::print(stderr, "  {:<8} {} and {} at v = {:.1f} mm: {}; profiles {:.3g} mm apart\n",
               join.is_seam ? "seam" : "joined", made.patches[join.left].name,
               made.patches[join.left + 1].name, join.v_mm, join.reason, join.misfit_mm);
}

// 3. The work.

std::string about(const SurfaceSpec& surface) {
  const auto words = [](const FormulaOrPoints& curve) {
    if (const auto* formula = std::get_if<std::string>(&curve)) return *formula;
    return fmt::format("through {} points", std::get<CurvePoints>(curve).size());
  };
  if (const auto* s = std::get_if<RevolutionSpec>(&surface)) return "radius " + words(s->radius);
  if (const auto* s = std::get_if<ProfileSpec>(&surface)) return "profile " + words(s->z);
  if (const auto* s = std::get_if<LoftSpec>(&surface))
    return fmt::format("loft of {} curves", s->stations.size());
  constexpr std::size_t kMostShown = 60;
  if (const auto* s = std::get_if<ImplicitSpec>(&surface))
    return s->f.size() > kMostShown ? "a solid given by a formula" : "solid " + s->f;
  if (const auto* s = std::get_if<TextSpec>(&surface)) return "the text " + s->text;
  return "file " + asset_of(surface);
}

Result<void> list_examples(const Globals& globals) {
  auto list = nlohmann::ordered_json::array();
  for (const Example& example : examples()) {
    const auto spec = parse_design_spec(example.json);
    if (!spec) return tl::unexpected(within(std::string(example.name), spec.error()));
    const std::string target = spec->surface ? about(*spec->surface) : "several regions";
    std::vector<std::string> sizes;
    for (const RegionSpec& region : spec->regions)
      sizes.push_back(fmt::format("{} x {}", region.slices, region.units_per_slice));
    std::string what =
        spec->style == DesignStyle::Layers
            ? fmt::format("layers, {} on a card that opens flat, {}", spec->layers.layers, target)
        : spec->style == DesignStyle::Slices
            ? fmt::format("slices, {} x {} on a card that opens flat, {}", spec->sliced.x_slices,
                          spec->sliced.y_slices, target)
        : spec->style == DesignStyle::Boxes
            ? fmt::format("boxes, at most {} on a card that opens flat, {}", spec->boxes.most,
                          target)
        : spec->style == DesignStyle::Silhouette
            ? fmt::format("silhouette, {} layer{}, {}", spec->facets.layers,
                          spec->facets.layers == 1 ? "" : "s", target)
        : is_of_facets(spec->style)
            ? fmt::format("facets, strips of {:g} mm, {}", spec->facets.strip_mm, target)
            : fmt::format("{}, {} units", target, fmt::join(sizes, " + "));
    if (spec->book) what += fmt::format(", a book of {} cards", spec->book->cards);
    if (globals.json)
      list.push_back({{"name", example.name}, {"what", what}});
    else
      fmt::print("{:<10} {}\n", example.name, what);
  }
  if (globals.json) print_json(nlohmann::ordered_json{{"examples", list}});
  return {};
}

Result<void> print_example(const std::string& name) {
  std::string known;
  for (const Example& example : examples()) {
    if (example.name == name) {
      fmt::print("{}", example.json);
      return {};
    }
    known += fmt::format(" {}", example.name);
  }
  return fail(ErrorKind::Usage, "--example",
              fmt::format("'{}' is not an example; give one of:{}", name, known));
}

/// The files of a whole book that come with these formats.
std::string files_of_book(const std::vector<Format>& formats) {
  const bool moves = std::any_of(formats.begin(), formats.end(),
                                 [](const Format& format) { return format.name == "glb"; });
  return fmt::format("book.json{}{}", moves ? " book.glb" : "",
                     are_drawn(formats) ? " book.svg" : "");
}

/// The seconds of an assembly of several parts are those of all together.
tl::expected<PatchAssembly, judge::DesignFault> timed_design(const DesignSpec& spec,
                                                             const SurfaceAssets& assets,
                                                             const hands::Hands& hands,
                                                             const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  auto made = judge::sound_design(spec, assets, progress);
  if (made) tell(progress, "measuring the distance from your shape");
  if (made)
    for (Design& part : made->parts) part.report.surface_fit = surface_fit(part);
  if (made && made->book) made->book->fit = book_fit(*made);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  if (made)
    for (Design& part : made->parts) {
      part.report.seconds = took.count();
      part.report.handwork = hands::handwork(part.pattern, hands);
    }
  return made;
}

/// The text of SPEC.
Result<std::string> spec_text(const std::string& spec) {
  constexpr std::uintmax_t kMost = 64u << 20;
  return read_file(spec == "-" ? "/dev/stdin" : spec, kMost);
}

/// Leaves only the file that says what is wrong, so that no older pattern is taken for this one.
Error report_unsound(OutputFolder folder, judge::DesignFault fault) {
  constexpr const char* kFile = "unsound.json";
  auto done = folder.add(kFile, judge::unsound_json(fault.parts));
  if (done) done = folder.commit("popcut design " POPCUT_VERSION);
  fault.error.detail +=
      done ? fmt::format("; {} in {} says what is wrong and where", kFile, folder.folder().string())
           : fmt::format("; {}", message(done.error()));
  return std::move(fault.error);
}

/// A design as it comes: a spec, or a 3D model of which the best card is taken.
struct GivenDesign {
  std::string text;
  std::optional<SurfaceAssets> assets;  ///< none: they lie beside the spec
  bool of_model{};
};

/// How hard the best card of a model is searched, where nothing is said about it.
constexpr double kModelEffort = 0.25;

Result<GivenDesign> given_design(const Options& options, const Globals& globals) {
  GivenDesign out;
  if (!is_model_file(options.spec)) {
    auto text = spec_text(options.spec);
    if (!text) return tl::unexpected(text.error());
    out.text = std::move(*text);
    return out;
  }
  ModelSearchOptions search;
  search.model = options.spec, search.effort = kModelEffort;
  auto model = search_model(search, options.folder, !globals.quiet, {});
  if (!model) return tl::unexpected(model.error());
  out.of_model = true;
  out.text = std::move(model->found.front[model->found.recommended].spec);
  out.assets.emplace();
  out.assets->emplace(model->file, std::move(model->bytes));
  if (globals.quiet) return out;
  for (const std::string& note : model->found.notes)
    fmt::print(stderr, "{}: {}\n", shown_text(options.spec), note);
  fmt::print(stderr,
             "an easy card is taken that looks about as much like the model as any of {}; "
             "'popcut auto {} "
             "-o DIR' tries more, and shows cards that are easier to fold\n",
             model->found.counts.designed, shown_text(options.spec));
  return out;
}

/// The spec of a model's card, beside the pattern. As files of `popcut auto`, so that a design that
/// is made from it in the same folder does not remove it.
Result<void> keep_spec(const Options& options, const GivenDesign& given) {
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = folder->add("spec.json", given.text); !done) return done;
  return folder->commit("popcut auto " POPCUT_VERSION);
}

/// A card of several parts that was made, and what its files are made of.
struct PartsInto {
  const Options& options;
  const Globals& globals;
  const Material& material;
  const std::function<bool(std::string_view)>& wants;
  OutputFolder& folder;
  std::optional<LongWork>& work;
  std::chrono::steady_clock::time_point begun{std::chrono::steady_clock::now()};

  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  }
};

/// Keeps the files of a card of several parts. `report` and `say` tell what it is.
template <typename Sound>
Result<void> keep_parts(const PartsInto& into, const char* what, double seconds, const Sound& sound,
                        const Result<std::string>& files, const std::string& report,
                        const std::function<void()>& say) {
  if (!files) return tl::unexpected(files.error());
  if (files->empty())
    return fail(ErrorKind::Usage, "--formats",
                fmt::format("has nothing that {} have; give some of: fold svg cut dxf png picture "
                            "report",
                            what));
  const Structure& card = sound.made.card;
  const hands::ShutCard shut{card.length_mm, card.page_mm, sound.report.stack_mm};
  const AroundCard& around = into.options.around;
  const auto more = add_envelope_files(around, shut, into.wants, into.folder);
  if (!more) return tl::unexpected(more.error());
  if (auto done = into.folder.commit("popcut design " POPCUT_VERSION); !done) return done;
  into.work.reset();
  if (into.globals.json) fmt::print("{}", report);
  if (into.globals.quiet) return {};
  say();
  fmt::print(stderr, "{}  wrote   {}{} in {} ({:.2f} s)\n", envelope_words(around, shut), *files,
             *more, into.options.folder, seconds);
  return {};
}

/// A card of layers: several parts, in files of its own.
Result<void> layers_into(const PartsInto& into, const DesignSpec& spec,
                         const SurfaceAssets& assets) {
  const auto made =
      judge::sound_layers(spec, assets, "popcut " POPCUT_VERSION, into.work->progress());
  if (!made) return tl::unexpected(within(into.options.spec, made.error()));
  const double seconds = into.seconds();
  into.work->now("drawing the pictures");
  const likeness::PrintedFigures printed = judge::layers_likeness(
      made->made, asset_colours(into.options.spec, assets, made->made.target.size()));
  return keep_parts(
      into, "layers", seconds, *made,
      add_layer_files(*made, printed, into.material, seconds, into.wants, into.folder),
      layered_report_json(made->made, printed, seconds), [&] { say_layers(*made, printed); });
}

/// A card of slices: several parts, in files of its own.
Result<void> slices_into(const PartsInto& into, const DesignSpec& spec,
                         const SurfaceAssets& assets) {
  const auto made =
      judge::sound_slices(spec, assets, "popcut " POPCUT_VERSION, into.work->progress());
  if (!made) return tl::unexpected(within(into.options.spec, made.error()));
  const double seconds = into.seconds();
  into.work->now("drawing the pictures");
  return keep_parts(into, "slices", seconds, *made,
                    add_slice_files(*made, into.material, seconds, into.wants, into.folder),
                    sliced_report_json(made->made, seconds), [&] { say_slices(*made); });
}

/// A card of boxes: several parts, in files of its own.
Result<void> boxes_into(const PartsInto& into, const DesignSpec& spec,
                        const SurfaceAssets& assets) {
  const auto made =
      judge::sound_boxes(spec, assets, "popcut " POPCUT_VERSION, into.work->progress());
  if (!made) return tl::unexpected(within(into.options.spec, made.error()));
  const double seconds = into.seconds();
  into.work->now("drawing the pictures");
  const likeness::PrintedFigures printed = judge::boxes_likeness(
      made->made, asset_colours(into.options.spec, assets, made->made.target.size()));
  return keep_parts(into, "boxes", seconds, *made,
                    add_box_files(*made, printed, into.material, seconds, into.wants, into.folder),
                    boxed_report_json(made->made, printed, seconds),
                    [&] { say_boxes(*made, printed); });
}

Result<void> design_into(const Options& options, const Globals& globals) {
  const auto formats = parse_formats(options.formats);
  if (!formats) return tl::unexpected(formats.error());
  std::optional<std::vector<double>> fold_frames;
  if (options.fold_frames) {
    const auto given = parse_opening_angles(*options.fold_frames);
    if (!given) return fail(given.error().kind, "--fold-frames", given.error().detail);
    fold_frames = *given;
  }
  if (const auto valid = angles_of(options.motion, Pattern().design_psi_rad); !valid)
    return tl::unexpected(valid.error());
  if (auto valid = options.around.check(); !valid) return valid;
  const auto given = given_design(options, globals);
  if (!given) return tl::unexpected(given.error());
  std::optional<LongWork> work(std::in_place, !globals.quiet, "reading the design");
  auto spec = parse_design_spec(given->text);
  if (!spec) return tl::unexpected(no_design_spec(options.spec, given->text, spec.error()));
  const auto material = material_of(*spec, options.spec);
  if (!material) return tl::unexpected(material.error());
  planning::suit_material(*material, *spec);
  const auto hands = own_hands();
  if (!hands) return tl::unexpected(hands.error());
  const auto thickness = thickness_of(options.motion, material->thickness_mm);
  if (!thickness) return tl::unexpected(thickness.error());
  const auto assets =
      given->assets ? Result<SurfaceAssets>(*given->assets) : load_assets(*spec, options.spec);
  if (!assets) return tl::unexpected(within(options.spec, assets.error()));
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  const auto wants = [&](std::string_view name) {
    return std::any_of(formats->begin(), formats->end(),
                       [&](const Format& format) { return format.name == name; });
  };
  const std::function<bool(std::string_view)> wanted = wants;
  const PartsInto into{options, globals, *material, wanted, *folder, work};
  if (spec->style == DesignStyle::Layers) return layers_into(into, *spec, *assets);
  if (spec->style == DesignStyle::Slices) return slices_into(into, *spec, *assets);
  if (is_of_boxes(*spec)) return boxes_into(into, *spec, *assets);
  auto made = timed_design(*spec, *assets, *hands, work->progress());
  if (!made) {
    judge::DesignFault& fault = made.error();
    if (fault.error.reason == ErrorReason::Misplaced && spec->placement.design_angle_deg == 90.0)
      fault.error.detail += ", or see 'popcut design --place'";
    fault.error = within(options.spec, fault.error);
    if (fault.parts.empty()) return tl::unexpected(fault.error);
    return tl::unexpected(report_unsound(std::move(*folder), std::move(fault)));
  }

  if (options.around.any() && made->parts.size() > 1)
    return fail(ErrorKind::Usage, options.around.cover ? "--cover" : "--envelope",
                "is for cards of one sheet, of layers, of slices and of boxes; leave it out");
  std::vector<LineWork> dashed;
  const bool prints = std::any_of(formats->begin(), formats->end(),
                                  [](const Format& format) { return format.name == "pdf"; });
  for (Design& part : made->parts) {
    planning::add_make_warnings(*material, *spec, part);
    dashed.push_back(dashed_page(*material, part));
    if (prints)
      if (auto warning = font_warning(part.pattern.name, "pattern.pdf"))
        part.report.warnings.push_back(std::move(*warning));
  }

  const bool is_one = made->parts.size() == 1;
  work->now("drawing the pictures");
  const bool has_pictures = are_drawn(*formats), has_errors = options.colour == "error";
  const auto angles = angles_of(options.motion, made->parts.front().pattern.design_psi_rad);
  if (!angles) return tl::unexpected(angles.error());
  for (std::size_t p = 0; p < made->parts.size(); ++p) {
    const Design& part = made->parts[p];
    Scenery scenery;
    if (has_pictures && !has_errors) scenery.ghost = target_on_sheet(part, true);
    if (has_pictures && has_errors) scenery.target = target_on_sheet(part, false);
    const Job job{part,      is_one ? &*made : nullptr,
                  dashed[p], {"popcut " POPCUT_VERSION, fold_frames, options.fold_cuts == "split"},
                  *angles,   *thickness,
                  scenery};
    folder->enter(is_one ? "" : part_folder(*made, p));
    for (const Format& format : *formats) {
      work->now(fmt::format("writing {}", format.file));
      if (auto done = format.add(job, *folder); !done) return done;
    }
  }
  folder->enter("");
  if (made->book) {
    work->now("drawing the book");
    const BookFiles files{wants("glb"), has_pictures, *thickness};
    if (auto done = add_book_files(*made, files, *folder); !done) return done;
  } else if (!is_one) {
    if (auto done = folder->add("report.json", report_json(*made)); !done) return done;
  }
  const Design& first = made->parts.front();
  const ShutStack stack = shut_stack(first.strips, material->thickness_mm);
  const hands::ShutCard shut{first.pattern.width_mm,
                             std::max(first.pattern.wall_mm, first.pattern.ground_mm),
                             stack.pile_mm + 2.0 * material->thickness_mm};
  const auto around = add_envelope_files(options.around, shut, wants, *folder);
  if (!around) return tl::unexpected(around.error());
  if (auto done = folder->commit("popcut design " POPCUT_VERSION); !done) return done;
  if (given->of_model) {
    folder = tl::unexpected(Error{});  // it is locked
    if (auto done = keep_spec(options, *given); !done) return done;
  }
  work.reset();
  if (globals.json) fmt::print("{}", report_json(*made));
  if (globals.quiet) return {};
  if (made->book) say_book(*made);
  for (const Design& part : made->parts) {
    if (!made->book) say_figures(part.report);
    if (!made->book || globals.verbose > 0) say_remarks(part.report, globals.verbose > 0);
    if (!made->book) say_small_model(*spec, part.report);
  }
  say_joins(*made);
  std::string files;
  for (const Format& format : *formats) files += fmt::format(" {}", format.file);
  files += *around;
  fmt::print(stderr, "{}", envelope_words(options.around, shut));
  const std::string where =
      is_one ? options.folder
             : fmt::format("{0}/{1} to {0}/{2}, {3} in {0}", options.folder, part_folder(*made, 0),
                           part_folder(*made, made->parts.size() - 1),
                           made->book ? files_of_book(*formats) : "report.json");
  fmt::print(stderr, "  wrote   {} in {} ({:.2f} s)\n", files, where,
             made->parts.front().report.seconds);
  return {};
}

Result<void> place(const Options& options, const Globals& globals) {
  if (is_model_file(options.spec))
    return fail(ErrorKind::Usage, "command line",
                fmt::format("--place moves the shape of a design, and {} is a 3D model; type: "
                            "popcut design {} -o DIR",
                            options.spec, options.spec));
  const auto text = spec_text(options.spec);
  if (!text) return tl::unexpected(text.error());
  auto spec = parse_design_spec(*text);
  if (!spec) return tl::unexpected(no_design_spec(options.spec, *text, spec.error()));
  const auto material = material_of(*spec, options.spec);
  if (!material) return tl::unexpected(material.error());
  planning::suit_material(*material, *spec);  // what is tried is what will be designed
  const auto assets = load_assets(*spec, options.spec);
  if (!assets) return tl::unexpected(within(options.spec, assets.error()));
  if (auto done =
          print_placed_spec(*spec, *text, *assets, options.place == "quarter", globals.quiet);
      !done)
    return tl::unexpected(within(options.spec, done.error()));
  return {};
}

Result<void> run_design(Options options, const Globals& globals) {
  give_back_file(options.motion, options.spec);
  if (options.schema) {
    fmt::print("{}", design_spec_schema());
    return {};
  }
  if (options.list) return list_examples(globals);
  if (!options.example.empty()) return print_example(options.example);
  if (options.spec.empty()) {
    return fail(ErrorKind::Usage, "command line",
                "SPEC.json is missing; 'popcut design --example sphere' prints one to start from");
  }
  if (!options.place.empty()) return place(options, globals);
  if (options.folder.empty()) {
    return fail(ErrorKind::Usage, "command line",
                "-o DIR is missing; give the folder for the pattern");
  }
  return design_into(options, globals);
}

constexpr const char* kHelp =
    "Design a pop-up pattern for a shape.\n\n"
    "  popcut design --example sphere > sphere.json\n"
    "  popcut design sphere.json -o sphere\n\n"
    "SPEC describes the shape (a formula, a table of heights or a 3D model) and how finely to\n"
    "slice it; - reads it from standard input. It can also be a 3D model (STL, OBJ, GLB): then "
    "popcut\n"
    "makes the best card that a short search finds, and writes its design too (spec.json);\n"
    "'popcut auto' searches longer. The lengths of a design are mm, and its axes are:\n\n"
    "      z\n"
    "      |  wall: x = 0\n"
    "      |\n"
    "      +-------- x\n"
    "     /  ground: z = 0\n"
    "    y  along the main fold; the first slice is at y = 0\n\n"
    "The picture docs/words/axes.svg (in docs/designs.md) shows them on an opened card.\n"
    "Formulas can use + - * / ^, pi, e, comparisons, a ? b : c, and sin cos tan asin acos atan\n"
    "atan2 sinh cosh tanh asinh acosh atanh sqrt exp ln log log2 log10 abs sign min max sum avg\n"
    "floor ceil round rint mod; docs/designs.md describes them. popcut writes into DIR:\n\n"
    "  pattern.png   a picture of the sheet\n"
    "  deployed.png  a picture of the opened card, your shape around it in blue\n"
    "  poster.svg    pictures of the card as it opens\n"
    "  pattern.svg   the pattern, to look at\n"
    "  cut.svg       the pattern, to cut: each dash of a fold is a path\n"
    "  pattern.fold  the flat sheet and its opened poses, for origami programs\n"
    "  pattern.dxf   the pattern for CAD programs\n"
    "  segments.csv  one row for each panel\n"
    "  deploy.glb    an animation of the card as it opens\n"
    "  report.json   sizes, and the distance from your shape\n\n"
    "A SPEC with \"book\" makes a book of cards around one spine: each card gets these files in "
    "its\n"
    "own folder card-01, card-02 and so on, and DIR gets book.json (sizes, distance from your\n"
    "shape, what is glued), book.glb (an animation) and book.svg (pictures from all sides).\n\n"
    "A SPEC with the style layers, slices or boxes makes a card of several pieces.\n"
    "pattern.fold has all pieces and their joints; the other drawings show them side by side.\n"
    "There is no csv, glb or poster.\n\n"
    "--formats also knows pdf (pattern.pdf, to print), cricut (cricut.svg, for Design Space),\n"
    "picture (deployed.svg) and stl (deploy/psi_NNN.stl, a 3D model of each pose).\n"
    "manifest.json lists the files of the last run; a new run removes those that it does not\n"
    "write, and keeps all other files in DIR.";

}  // namespace
}  // namespace design_command

void register_design(const Command& app, const Globals& globals, Run& run) {
  using namespace design_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("design", kHelp);
  command.add_option("SPEC", options->spec,
                     "The design: a JSON file, or -; --schema prints its format. Or a 3D model "
                     "(.stl, .obj, .glb, .gltf)");
  command
      .add_option("-o,--output", options->folder,
                  "Folder for the files; created if it does not exist")
      .value_text("DIR");
  command
      .add_option(
          "--formats", options->formats,
          "Files to write, separated by commas: fold svg cut dxf csv pdf cricut png picture "
          "poster glb stl report")
      .value_text("LIST [fold,svg,cut,dxf,csv,glb,png,poster,report]");
  one_word(command.add_option("--colour", options->colour,
                              "Colours of the panels in pictures of the opened card: paper, or "
                              "error (how far each panel is from your shape)"),
           {"paper", "error"}, "paper");
  command
      .add_option(
          "--fold-frames", options->fold_frames,
          "Opening angles (psi) of the poses in pattern.fold, in radians or as 90deg; pi is flat, "
          "pi/2 the designed shape (or design_angle_deg of SPEC)")
      .value_text("LIST [pi,pi/2,1.1]");
  one_word(command.add_option("--fold-cuts", options->fold_cuts,
                              "How pattern.fold stores a cut: split (as two border edges B) or C "
                              "(as one edge C; only for "
                              "the flat sheet)"),
           {"split", "C"}, "split");
  command
      .add_option(
          "--envelope", options->around.envelope,
          "Also write envelope.svg, which holds the shut card: fit, A2, A6, A7, 5x7, DL, C6, "
          "C5, or width and height in mm")
      .value_text("SIZE");
  command.add_flag("--cover", options->around.cover,
                   "Also write cover.svg, which the card's pages are glued into");
  add_motion_options(command, options->motion);
  command.add_flag("--schema", options->schema, "Print the JSON Schema of a SPEC");
  one_word(
      command.add_option("--place", options->place,
                         "Do not design; print SPEC with its 3D model or table of heights moved "
                         "into place: whole (all of it in the corner) or quarter (its middle on "
                         "the spine, the main fold)"),
      {"whole", "quarter"});
  command.add_option("--example", options->example, "Print an example design").value_text("NAME");
  command.add_flag("--list", options->list, "List the example designs");
  when_chosen(command, run, [options, &globals] { return run_design(*options, globals); });
}

}  // namespace popcut::cli
