// SPDX-License-Identifier: MIT
#include "daemon/planning/search/search_task.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/model/model.hpp"
#include "core/search/choices.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/plan_job.hpp"
#include "daemon/planning/search/card_search.hpp"
#include "daemon/planning/search/found_front.hpp"
#include "daemon/planning/search/search_steps.hpp"
#include "daemon/planning/search/search_words.hpp"
#include "daemon/planning/search/thumbnail.hpp"
#include "daemon/planning/task_inputs.hpp"
#include "daemon/planning/views/parts_card.hpp"
#include "daemon/planning/views/preview.hpp"
#include "daemon/planning/views/printed_design.hpp"

namespace popcut::planning {
namespace search_task_parts {
namespace {

constexpr double kSecondsAMinute = 60.0;
constexpr const char* kUsualPaper = "paper-220";

/// The model in its colours for pictures of printed cards; clay where they cannot be read. None: it
/// cannot be read at all.
std::optional<ColourMesh> colours_of(const std::string& bytes) {
  auto model = asset_colours("model", bytes, false);
  if (!model) model = asset_colours("model", bytes, true);
  if (!model) return std::nullopt;
  return std::move(*model);
}

/// What a page shows of a card that was found. Empty: it can be designed, but not be shown.
std::string shown_card(const std::string& spec, const Material& material, PatchAssembly& made) {
  auto wanted = parse_design_spec(spec);
  if (!wanted) return {};
  Material suited = material;
  suit_material(suited, *wanted);
  add_figures(&suited, *wanted, made);
  return shown_blob(made, LatticeQuality::Exact).value_or(std::string());
}

/// A card of layers or of boxes, with what a page shows of it.
Result<void> add_glued(const FoundGlued& found, const std::optional<ColourMesh>& model, int number,
                       const FileSink& add) {
  auto png = thumbnail_png(found, model);
  if (!png) return tl::unexpected(png.error());
  if (auto done = add(thumbnail_file(number), std::move(*png)); !done) return done;
  PartsCard card;
  if (found.layers)
    card.layers = found.layers->made, card.fold = found.layers->fold;
  else
    card.boxes = found.boxes->made, card.fold = found.boxes->fold;
  auto shown = shown_blob(card, LatticeQuality::Exact);
  return shown ? add(lattice_file(number), std::move(*shown)) : Result<void>();
}

/// The model, if its colours are wanted.
std::optional<ColourMesh> printed_colours(const SearchRequest& request, const std::string& bytes) {
  return request.plain ? std::nullopt : colours_of(bytes);
}

/// Cards as files of an outcome; `number` from 1.
Result<void> add_card(FoundCard& card, int number, const FileSink& add) {
  if (auto done = add(thumbnail_file(number), card.picture); !done) return done;
  return card.shown.empty() ? Result<void>() : add(lattice_file(number), card.shown);
}

Result<daemon::PlanningOutcome> finish_some(SearchRequest& request, const WantedCards& wanted,
                                            const std::string& model, const FileSink& add) {
  if (!wanted.drawn) request.show = nullptr;
  auto finished = finish_cards(request, wanted);
  if (!finished) return tl::unexpected(in_request(finished.error()));
  if (auto done = add(kFinishedFile, finished_text(*finished)); !done)
    return tl::unexpected(done.error());
  if (!wanted.drawn) return daemon::PlanningOutcome{};
  const std::optional<ColourMesh> colours = printed_colours(request, model);
  int number = 0;
  for (FinishedCard& one : *finished) {
    ++number;
    if (!one.card) continue;
    auto png = thumbnail_png(request.mesh, *one.card, colours);
    if (!png) return tl::unexpected(png.error());
    one.card->picture = std::move(*png);
    if (auto done = add_card(*one.card, number, add); !done) return tl::unexpected(done.error());
  }
  return daemon::PlanningOutcome{};
}

/// Takes the picture and the lattice of each card that others drew from the assets of a task.
void take_pictures(SurfaceAssets& assets, std::vector<FinishedCard>& drawn) {
  int number = 0;
  const auto taken = [&](const std::string& name) {
    const auto at = assets.find(name);
    return at == assets.end() ? std::string() : std::move(at->second);
  };
  for (FinishedCard& one : drawn) {
    ++number;
    if (!one.card) continue;
    one.card->picture = taken(thumbnail_file(number)),
    one.card->shown = taken(lattice_file(number));
  }
}

/// One step of a search: see planning/search/search_steps.
Result<daemon::PlanningOutcome> judge_some(SearchRequest& request, const std::string& text,
                                           const std::string& model, const FileSink& add) {
  auto wanted = read_wanted(text);
  if (!wanted) return tl::unexpected(wanted.error());
  request.memory.ways = wanted->ways;
  if (!wanted->finals.empty()) return finish_some(request, *wanted, model, add);
  request.show = nullptr;
  const auto judged = judge_cards(request, *wanted);
  if (!judged) return tl::unexpected(in_request(judged.error()));
  if (auto done = add(kJudgedFile, judged_text(judged->cards)); !done)
    return tl::unexpected(done.error());
  if (judged->finished.empty()) return daemon::PlanningOutcome{};
  if (auto done = add(kFinishedFile, finished_text(judged->finished)); !done)
    return tl::unexpected(done.error());
  return daemon::PlanningOutcome{};
}

}  // namespace
}  // namespace search_task_parts

Result<daemon::PlanningOutcome> search(WorkerTask& task, const FileSink& add,
                                       const Progress& progress) {
  using namespace search_task_parts;
  const auto given = task.options.find(kSearchWords);
  if (given == task.options.end() || task.options.size() != 1)
    return fail(ErrorKind::Malformed, "options", "must be those of a search");
  const auto wanted = read_search_words(given->second);
  if (!wanted) return tl::unexpected(wanted.error());
  const auto tables = tables_of(task);
  if (!tables) return tl::unexpected(tables.error());
  const std::string name = tables->material.empty() ? kUsualPaper : tables->material;
  const auto material = find_material(name, tables->texts);
  if (!material) return tl::unexpected(within("/material", material.error()));
  planning::SearchRequest request;
  auto mesh = read_mesh("", task.design);
  if (!mesh) return tl::unexpected(within(wanted->name, mesh.error()));
  request.mesh = std::move(*mesh);
  // Pictures read them again: the model's own pictures would take memory during the search.
  if (!wanted->plain && wanted->cards == 1)
    if (const auto colours = colours_of(task.design))
      request.colours = mean_colours(*colours, request.mesh.size());
  request.model = {wanted->name, wanted->model, name};
  request.material = *material;
  request.plan.machine = tables->machine, request.plan.material = name;
  request.plan.mat = wanted->mat, request.plan.marks = wanted->marks;
  request.tables = tables->texts;
  request.styles = style_choice(wanted->style), request.up = up_side(wanted->up);
  request.front = up_side(wanted->front), request.cards = wanted->cards;
  if (const auto fit = check_choices(wanted->style, wanted->cards, wanted->up, wanted->front); !fit)
    return tl::unexpected(in_request(fit.error()));
  request.most_s = kSecondsAMinute * wanted->max_minutes;
  if (wanted->max_folds > 0) request.hands.most_folds = static_cast<std::size_t>(wanted->max_folds);
  request.hands.shortest_mm = wanted->min_fold_mm;
  if (wanted->label != label_words().front()) request.hands.label = wanted->label;
  request.plain = wanted->plain;
  request.effort = wanted->effort, request.seed = static_cast<std::uint64_t>(wanted->seed);
  request.threads = 1;  // a worker may start none
  request.show = [&](const std::string& spec, PatchAssembly& made) {
    return shown_card(spec, *material, made);
  };
  request.progress = progress;
  TriangleMesh searched = std::move(request.mesh);
  const SearchRequest asked = request;
  request.mesh = std::move(searched);
  if (const auto judges = task.assets.find(kJudgeFile); judges != task.assets.end())
    return judge_some(request, judges->second, task.design, add);
  std::optional<WantedCards> more;
  if (const auto memory = task.assets.find(kMemoryFile); memory != task.assets.end()) {
    auto known = read_memory(memory->second);
    if (!known) return tl::unexpected(known.error());
    take_pictures(task.assets, known->drawn);
    request.memory = std::move(*known);
    request.wanted = [&](WantedCards cards) { more = std::move(cards); };
  }
  auto found = search_cards(std::move(request));
  if (more) {
    if (auto done = add(kWantedFile, wanted_text(*more)); !done)
      return tl::unexpected(done.error());
    return daemon::PlanningOutcome{};
  }
  if (!found) return tl::unexpected(in_request(found.error()));
  const std::vector<FoundGlued> glued = glued_beside(asked, *found);
  tell(progress, "drawing the cards");
  daemon::PlanningOutcome outcome;
  outcome.design_kind = "spec";
  outcome.assets = {wanted->model};
  if (auto done = add(kFrontFile, front_text(figures_of(*found, glued))); !done)
    return tl::unexpected(done.error());
  const bool are_drawn = std::all_of(found->front.begin(), found->front.end(),
                                     [](const FoundCard& card) { return !card.picture.empty(); });
  const std::optional<ColourMesh> colours = wanted->plain || (are_drawn && glued.empty())
                                                ? std::nullopt
                                                : colours_of(std::exchange(task.design, {}));
  for (std::size_t k = 0; k < found->front.size(); ++k) {
    FoundCard& card = found->front[k];
    if (card.picture.empty()) {
      auto png = thumbnail_png(found->mesh, card, colours);
      if (!png) return tl::unexpected(png.error());
      card.picture = std::move(*png);
    }
    if (auto done = add_card(card, static_cast<int>(k) + 1, add); !done)
      return tl::unexpected(done.error());
  }
  int number = static_cast<int>(found->front.size());
  for (const FoundGlued& card : glued)
    if (auto done = add_glued(card, colours, ++number, add); !done)
      return tl::unexpected(done.error());
  return outcome;
}

}  // namespace popcut::planning
