// SPDX-License-Identifier: MIT
// Part of daemon/planning/work.hpp. The artwork of a sheet that is planned already.
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "daemon/digest/digest.hpp"
#include "daemon/pictures/artwork_pages.hpp"
#include "daemon/planning/task_inputs.hpp"
#include "daemon/planning/views/printed_design.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {
namespace {

using daemon::PlanningOutcome;

/// What is asked of the artwork, taken out of a task's options: the others are those of the plan.
struct Wanted {
  std::size_t sheet{};  ///< from 0
  PrintMode mode{PrintMode::View};
  double dpi{300};
  bool clay{false}, back{false};
  std::string model;   ///< id of an asset, or empty: the mesh of the design
  std::string sha256;  ///< of the sheet's program, as the plan has it
};

Wanted taken_from(std::map<std::string, std::string>& options) {
  const auto take = [&](const char* name) {
    const auto found = options.extract(std::string(kArtworkOption) + name);
    return found ? found.mapped() : std::string();
  };
  const auto whole = [&](const char* name) {
    std::size_t out = 0;
    for (const char digit : take(name))
      out = std::min<std::size_t>(1'000'000, 10 * out + static_cast<std::size_t>(digit - '0'));
    return out;
  };
  Wanted out;
  out.sheet = whole("sheet") - 1;
  out.dpi = std::clamp(static_cast<double>(whole("dpi")), 50.0, 600.0);
  if (take("mode") == "surface") out.mode = PrintMode::Surface;
  out.clay = take("clay") == "true";
  out.back = take("back") == "true";
  out.model = take("model");
  out.sha256 = take("sha256");
  return out;
}

Result<std::optional<ColourMesh>> model_of(const Wanted& wanted, const DesignSpec& spec,
                                           const SurfaceAssets& assets) {
  std::optional<ColourMesh> none;
  const bool is_mesh = spec.surface && std::holds_alternative<MeshSpec>(*spec.surface);
  if (wanted.model.empty() && !is_mesh) return none;
  const std::string id = wanted.model.empty() ? asset_of(spec.surface) : wanted.model;
  const auto bytes = assets.find(id);
  if (bytes == assets.end())
    return fail(ErrorKind::OutOfRange, "?model", fmt::format("there is no asset {}", id));
  auto mesh = asset_colours(wanted.model.empty() ? id : "?model", bytes->second, wanted.clay);
  if (!mesh) return tl::unexpected(mesh.error());
  return std::optional(std::move(*mesh));
}

}  // namespace

Result<PlanningOutcome> draw_artwork(WorkerTask& task, const FileSink& add,
                                     const Progress& progress) {
  const Wanted wanted = taken_from(task.options);
  PrintedDesign design;
  const SurfaceAssets assets = task.assets;  // planning takes those of the spec out of the task
  PlanningOutcome outcome;
  SpecSources sources;
  sources.designed = [&](const DesignSpec& spec, PatchAssembly& made) -> Result<void> {
    if (!spec.patches.empty() && !wanted.model.empty())
      return fail(ErrorKind::OutOfRange, "?model",
                  "is for designs of one surface, and this one has patches; leave it out");
    const auto model = model_of(wanted, spec, assets);
    if (!model) return tl::unexpected(model.error());
    auto printed = printed_design(spec, assets, made, *model);
    if (!printed) return tl::unexpected(printed.error());
    design = std::move(*printed);
    return {};
  };
  sources.layered = [&](const DesignSpec& spec, const LayeredCard& made) -> Result<void> {
    const auto model = model_of(wanted, spec, assets);
    if (!model) return tl::unexpected(model.error());
    design = printed_layers(made, *model);
    return {};
  };
  sources.boxed = [&](const DesignSpec& spec, const BoxedCard& made) -> Result<void> {
    const auto model = model_of(wanted, spec, assets);
    if (!model) return tl::unexpected(model.error());
    design = printed_boxes(made, *model);
    return {};
  };
  bool are_slices = false;  // on their sheets are names, and where tabs go
  sources.sliced = [&]() -> Result<void> {
    are_slices = true;
    return {};
  };
  const auto job = planned(task, outcome, std::move(sources), progress);
  if (!job) return tl::unexpected(job.error());
  if (design.empty() && !are_slices)
    return fail(ErrorKind::OutOfRange, "", "is a drawing, and artwork is laid on a spec's design");
  if (wanted.sheet >= job->plan.sheets.size() ||
      daemon::sha256_hex(job->programs[wanted.sheet].bytes) != wanted.sha256)
    return fail(ErrorKind::Infeasible, "",
                "was planned by another version of popcut, whose cuts would not match this "
                "artwork; plan the design again");
  PrintPageOptions pages;
  pages.pixel_mm = 25.4 / wanted.dpi;
  pages.back = wanted.back;
  pages.words = false;
  ArtworkOptions how;
  how.mode = wanted.mode;
  how.pixel_mm = pages.pixel_mm;
  how.trapping = pages.trapping;
  how.shade = usual_shade(design);
  how.progress = progress;
  const auto artwork =
      are_slices ? Result<Artwork>(Artwork()) : planned_artwork(design, job->plan, nullptr, how);
  if (!artwork) return tl::unexpected(artwork.error());
  auto pdf = artwork_sheet_pdf(*artwork, "", job->plan, wanted.sheet, pages);
  if (!pdf) return tl::unexpected(pdf.error());
  if (auto done = add(kArtworkFile, std::move(*pdf)); !done) return tl::unexpected(done.error());
  return outcome;
}

}  // namespace popcut::planning
