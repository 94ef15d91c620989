// SPDX-License-Identifier: MIT
// What somebody looks at: previews of specs, lattices of stored designs.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/design/patches.hpp"
#include "core/design/placement.hpp"
#include "core/judge/sound_design.hpp"
#include "core/layout/layout.hpp"
#include "core/machines/machine.hpp"
#include "core/search/standing.hpp"
#include "core/text/fold_text.hpp"
#include "daemon/planning/design_export.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/foreign_blob.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/task_inputs.hpp"
#include "daemon/planning/views/parts_card.hpp"
#include "daemon/planning/views/preview.hpp"
#include "daemon/planning/views/small_card.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {
namespace {

using daemon::PlanningOutcome;
using Kind = daemon::PlanningTask::Kind;

/// A spec as it will be designed, and what it needs.
struct WantedDesign {
  DesignSpec spec;
  SurfaceAssets assets;
  Material material{};
  bool has_material{};  ///< false: popcut does not know the one it names
};

Result<WantedDesign> read_wanted(WorkerTask& task) {
  auto spec = parse_design_spec(task.design);
  if (!spec) return tl::unexpected(spec.error());
  const auto tables = tables_of(task);
  if (!tables) return tl::unexpected(tables.error());
  WantedDesign wanted{std::move(*spec), {}};
  if (auto material = find_material(wanted.spec.material, tables->texts)) {
    wanted.material = std::move(*material);
    wanted.has_material = true;
    suit_material(wanted.material, wanted.spec);
  }
  auto assets = assets_for(wanted.spec, task.assets);
  if (!assets) return tl::unexpected(assets.error());
  wanted.assets = std::move(*assets);
  return wanted;
}

void set_lattice(DesignSpec& spec, LatticeMethod lattice) {
  spec.lattice = lattice;
  for (DesignSpec& patch : spec.patches) set_lattice(patch, lattice);
}

/// The quickest pattern of a spec: what is asked of its lattice is left out.
Result<PatchAssembly> draft_of(DesignSpec spec, const SurfaceAssets& assets) {
  spec.is_draft = true;
  set_lattice(spec, LatticeMethod::Levels);
  auto made = design_assembly(spec, assets);
  if (made) return made;
  set_lattice(spec, LatticeMethod::Slices);
  if (auto plain = design_assembly(spec, assets)) return plain;
  return made;
}

Result<PatchAssembly> exact_of(const WantedDesign& wanted) {
  auto made = judge::sound_design(wanted.spec, wanted.assets);
  if (!made) return tl::unexpected(made.error().error);
  add_figures(wanted.has_material ? &wanted.material : nullptr, wanted.spec, *made);
  return std::move(*made);
}

/// Of a card of several parts; verify does not look at a draft.
Result<std::string> shown_parts(const WantedDesign& wanted, LatticeQuality quality) {
  const auto made = parts_card(wanted.spec, wanted.assets, quality != LatticeQuality::Draft);
  if (!made) return tl::unexpected(made.error());
  return shown_blob(*made, quality);
}

Result<std::string> placed(const WorkerTask& task, const WantedDesign& wanted) {
  const bool quarter = task.options.at("place") == "quarter";
  const auto side = [&](const char* name) {
    const auto word = task.options.find(name);
    return word == task.options.end() ? UpSide() : up_side(word->second);
  };
  const UpSide up = side("up"), front = side("front");
  const auto proposed = propose_placement(
      wanted.spec, wanted.assets, quarter ? Stand::Quarter : Stand::Whole,
      up || front ? upright_turns(up, front) : std::vector<std::array<double, 3>>());
  if (!proposed) return tl::unexpected(proposed.error());
  return with_placement(task.design, *proposed);
}

Result<std::string> preview_blob(WorkerTask& task) {
  auto wanted = read_wanted(task);
  if (!wanted) return tl::unexpected(wanted.error());
  if (task.options.contains("place")) {
    auto text = placed(task, *wanted);
    if (!text) return text;
    auto spec = parse_design_spec(*text);
    if (!spec) return tl::unexpected(spec.error());
    wanted->spec = std::move(*spec);
    if (wanted->has_material) suit_material(wanted->material, wanted->spec);
  }
  const auto quality = task.options.find("quality");
  const bool is_draft = quality != task.options.end() && quality->second == "draft";
  if (is_of_parts(wanted->spec))
    return shown_parts(*wanted, is_draft ? LatticeQuality::Draft : LatticeQuality::Exact);
  const auto made = is_draft ? draft_of(wanted->spec, wanted->assets) : exact_of(*wanted);
  if (!made) return tl::unexpected(made.error());
  return shown_blob(*made, is_draft ? LatticeQuality::Draft : LatticeQuality::Exact);
}

/// Of a stored spec: as it will be cut.
Result<std::string> stored_spec_blob(WorkerTask& task) {
  const auto wanted = read_wanted(task);
  if (!wanted) return tl::unexpected(wanted.error());
  if (is_of_parts(wanted->spec)) return shown_parts(*wanted, LatticeQuality::Stored);
  const auto made = exact_of(*wanted);
  if (!made) return tl::unexpected(made.error());
  return shown_blob(*made, LatticeQuality::Stored);
}

/// Of a drawing, read as the task's options say.
Result<std::string> foreign_blob_of(WorkerTask& task, InputKind kind) {
  const auto options = read_plan_options(task.options);
  if (!options) return tl::unexpected(in_request(options.error()));
  const auto how = read_options(*options, {});
  if (!how) return tl::unexpected(in_request(how.error()));
  return foreign_blob(std::move(task.design), kind, *how);
}

/// As it will be cut, or nearly so where that would take long.
Result<PatchAssembly> shown_design(const WantedDesign& wanted) {
  auto made = units_of(wanted.spec) > most_quick_units(wanted.spec)
                  ? draft_of(wanted.spec, wanted.assets)
                  : design_assembly(wanted.spec, wanted.assets);
  // The picture is of what was read; what a file calls it is not shown.
  if (made)
    for (Design& part : made->parts) part.pattern.name = "design";
  return made;
}

Result<void> add_parts_pictures(const std::string& fold, const std::string& flat,
                                const FileSink& add) {
  auto opened = small_parts_svg(fold);
  if (auto done = add("deployed.svg", opened ? std::move(*opened) : flat); !done) return done;
  return add("pattern.svg", flat);
}

Result<void> add_spec_pictures(WorkerTask& task, const FileSink& add) {
  const auto wanted = read_wanted(task);
  if (!wanted) return tl::unexpected(wanted.error());
  if (is_of_parts(wanted->spec)) {
    const auto card = parts_card(wanted->spec, wanted->assets, false);
    if (!card) return tl::unexpected(card.error());
    return add_parts_pictures(card->fold,
                              preview_svg(linework_from_pattern(parts_drawing(card->card()))), add);
  }
  const auto made = shown_design(*wanted);
  if (!made) return tl::unexpected(made.error());
  std::vector<const Pattern*> parts;
  for (const Design& part : made->parts) parts.push_back(&part.pattern);
  if (auto done = add("deployed.svg", small_card_svg(parts)); !done) return done;
  return add("pattern.svg", preview_svg(parts.size() == 1 ? linework_from_pattern(*parts.front())
                                                          : join_parts(parts).drawing));
}

/// "deployed.svg" and "pattern.svg" of a design of any kind.
Result<void> add_pictures(WorkerTask& task, const FileSink& add) {
  const auto kind =
      task.design_kind.empty() ? kind_of_content(task.design) : input_kind_from(task.design_kind);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind == InputKind::Spec) return add_spec_pictures(task, add);
  const std::string joined =
      *kind == InputKind::Fold && lists_joints(task.design) ? task.design : std::string();
  auto drawing = foreign_drawing(std::move(task.design), *kind);
  if (!drawing) return tl::unexpected(drawing.error());
  const std::string flat = preview_svg(drawing->lines);
  if (!joined.empty()) return add_parts_pictures(joined, flat, add);
  if (drawing->pattern) drawing->pattern->name = "design";
  if (auto done =
          add("deployed.svg", drawing->pattern ? small_card_svg({&*drawing->pattern}) : flat);
      !done)
    return done;
  return add("pattern.svg", flat);
}

/// A file of a stored spec, as `popcut design` writes it.
Result<void> add_export(WorkerTask& task, const FileSink& add) {
  const auto kind =
      task.design_kind.empty() ? kind_of_content(task.design) : input_kind_from(task.design_kind);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind != InputKind::Spec)
    return fail(ErrorKind::OutOfRange, "",
                "is no spec, and only specs are designed; get its content instead");
  const auto wanted = read_wanted(task);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!wanted->has_material)
    return fail(ErrorKind::OutOfRange, "/material", "is not known to popcut");
  const std::string& file = task.options.at("file");
  if (is_of_parts(wanted->spec)) {
    const auto card = parts_card(wanted->spec, wanted->assets, true);
    auto text = card ? parts_file(*card, wanted->material, file)
                     : Result<std::string>(tl::unexpected(card.error()));
    return text ? add(file, std::move(*text)) : tl::unexpected(text.error());
  }
  auto made = exact_of(*wanted);
  if (!made) return tl::unexpected(made.error());
  std::size_t part = 0;
  for (const char digit : task.options.at("part"))
    part = std::min<std::size_t>(1'000'000, 10 * part + static_cast<std::size_t>(digit - '0'));
  auto bytes = design_file(*made, wanted->material, file, part - 1);
  if (!bytes) return tl::unexpected(bytes.error());
  return add(file, std::move(*bytes));
}

}  // namespace

Result<PlanningOutcome> show(WorkerTask& task, const FileSink& add) {
  PlanningOutcome outcome;
  if (task.kind == Kind::Place) {
    const auto wanted = read_wanted(task);
    if (!wanted) return tl::unexpected(wanted.error());
    auto text = placed(task, *wanted);
    if (!text) return tl::unexpected(text.error());
    if (auto done = add("spec.json", std::move(*text)); !done) return tl::unexpected(done.error());
    return outcome;
  }
  if (task.kind == Kind::Picture) {
    if (auto done = add_pictures(task, add); !done) return tl::unexpected(done.error());
    return outcome;
  }
  if (task.kind == Kind::Export) {
    if (auto done = add_export(task, add); !done) return tl::unexpected(done.error());
    return outcome;
  }
  Result<std::string> blob;
  if (task.kind == Kind::Preview) {
    blob = preview_blob(task);
  } else {
    const auto kind =
        task.design_kind.empty() ? kind_of_content(task.design) : input_kind_from(task.design_kind);
    if (!kind) return tl::unexpected(kind.error());
    blob = *kind == InputKind::Spec ? stored_spec_blob(task) : foreign_blob_of(task, *kind);
  }
  if (!blob) return tl::unexpected(blob.error());
  if (auto done = add("lattice", std::move(*blob)); !done) return tl::unexpected(done.error());
  return outcome;
}

}  // namespace popcut::planning
