// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/search_repository.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/search/choices.hpp"
#include "core/search/standing.hpp"
#include "daemon/planning/search/search_words.hpp"
#include "daemon/planning/search/searched_mat.hpp"
#include "daemon/planning/task_inputs.hpp"

namespace popcut::daemon {
namespace search_repository_parts {
namespace {

#define POPCUT_SEARCH_COLUMNS                                                                    \
  "state, id, key, owner, model, words, machine, material, machine_json, material_json, front, " \
  "error, created, begun, planner"

constexpr std::array<std::string_view, 3> kSearchStates{"pending", "found", "failed"};
constexpr std::int64_t kMostWaiting = 1000;
constexpr int kRetry_s = 60;

template <typename Row>
auto values_of(Row& row) {
  return std::tie(row.id, row.key, row.owner, row.model, row.words, row.machine, row.material,
                  row.machine_json, row.material_json, row.front, row.error, row.created, row.begun,
                  row.planner);
}

std::string_view word_of(SearchState state) {
  return kSearchStates.at(static_cast<std::size_t>(state));
}

SearchState state_from(const std::string& word) {
  const auto found = std::find(kSearchStates.begin(), kSearchStates.end(), word);
  if (found == kSearchStates.end())
    throw StoreFault(FaultKind::Corrupt, "the state of a search is invalid");
  return static_cast<SearchState>(found - kSearchStates.begin());
}

/// Writes the pictures that a worker made, and returns its figures. On a thread of the planner.
Result<SearchFront> with_pictures_kept(Result<PlanningOutcome> outcome, const std::string& folder,
                                       SharedFiles& shared, const std::string& id) {
  if (!outcome) return tl::unexpected(outcome.error());
  Result<SearchFront> front = fail(ErrorKind::Internal, "worker", "it made no figures");
  for (const PlanningFile& file : outcome->files)
    if (file.name == planning::kFrontFile) front = planning::read_front(file.bytes);
  if (!front) return front;
  std::vector<std::pair<std::string, std::string_view>> pictures;
  for (std::size_t k = 0; k < front->cards.size(); ++k) {
    const std::string name = planning::thumbnail_file(static_cast<int>(k) + 1);
    const auto file = std::find_if(outcome->files.begin(), outcome->files.end(),
                                   [&](const PlanningFile& one) { return one.name == name; });
    if (file == outcome->files.end())
      return fail(ErrorKind::Internal, "worker", "it made no picture of a card");
    pictures.emplace_back(name, file->bytes);
    const std::string lattice = planning::lattice_file(static_cast<int>(k) + 1);
    for (const PlanningFile& one : outcome->files)
      if (one.name == lattice) pictures.emplace_back(lattice, one.bytes);
  }
  if (Result<void> kept = write_folder(folder, pictures); !kept)
    return tl::unexpected(kept.error());
  if (Result<void> kept = shared.keep("searches/" + id); !kept) return tl::unexpected(kept.error());
  return front;
}

tl::unexpected<Problem> too_many(std::string detail) {
  return refuse(ProblemKind::QueueFull, std::move(detail), /*retry_after_s=*/kRetry_s);
}

Problem not_valid(const Error& error) {
  return invalid_value(error.place, "value", error.detail, "the search is not valid");
}

/// Refuses if no card can be planned with these options.
Answer<void> check_plan(const CardSearchRequest& request, const std::string& machine_json,
                        const std::string& material_json) {
  planning::WorkerTask rows;
  rows.machine_json = machine_json, rows.material_json = material_json;
  const auto tables = planning::tables_of(rows);
  if (!tables) return tl::unexpected(problem_from(tables.error()));
  PlanOptions options;
  options.machine = tables->machine, options.material = tables->material;
  options.mat = request.mat, options.marks = request.marks;
  const auto mat = planning::searched_mat(options, tables->texts);
  if (mat) return {};
  Error error = mat.error();
  // In a search, these options are members of the request itself.
  constexpr std::string_view kPlan = "/options";
  if (error.place.starts_with(kPlan)) error.place.erase(0, kPlan.size());
  return tl::unexpected(not_valid(error));
}

tl::unexpected<Problem> no_search(const std::string& id) {
  return refuse(ProblemKind::NotFound, fmt::format("there is no search {:?}", id));
}

}  // namespace
}  // namespace search_repository_parts

using namespace search_repository_parts;

std::string SearchRepository::folder_of(const std::string& id) const {
  return parts_.store.folder().at("searches/" + id);
}

SearchRepository::Row SearchRepository::row_of(const Rows& rows) {
  Row row;
  row.state = state_from(rows.text(0));
  rows.read(1, values_of(row));
  return row;
}

std::optional<SearchRepository::Row> SearchRepository::row(const std::string& id) {
  return first_of(
      parts_.store.db().rows("SELECT " POPCUT_SEARCH_COLUMNS " FROM search WHERE id=?", id),
      row_of);
}

std::optional<SearchRepository::Row> SearchRepository::row_of_key(const std::string& key) {
  return first_of(
      parts_.store.db().rows("SELECT " POPCUT_SEARCH_COLUMNS
                             " FROM search WHERE key=? AND state IN ('pending', 'found')",
                             key),
      row_of);
}

bool SearchRepository::is_owned(const Row& row, const std::string& owner) const {
  OwnershipTable& owners = parts_.designs.owners();
  return owners.has(Owned::Search, row.id, owner) && owners.has(Owned::Asset, row.model, owner);
}

SearchRecord SearchRepository::record_of(const Principal& who, const Row& row) const {
  SearchRecord record{
      .id = row.id, .owner = is_owned(row, who.name) ? who.name : row.owner, .state = row.state};
  const auto words = planning::read_search_words(row.words);
  if (!words) throw StoreFault(FaultKind::Corrupt, "the stored options of a search are invalid");
  record.request = *words;
  record.request.machine = row.machine, record.request.material = row.material;
  if (row.state == SearchState::Found && !row.front.empty()) {
    auto front = planning::read_front(row.front);
    if (!front) throw StoreFault(FaultKind::Corrupt, "what a search found is invalid");
    record.front = std::move(*front);
  }
  record.error = row.error;
  record.created = row.created;
  if (running_ && running_->id == row.id && row.state == SearchState::Pending) {
    record.doing = running_->phase.doing.empty() ? "reading the model" : running_->phase.doing;
    if (running_->phase.done >= 0) record.share = running_->phase.done;
  } else if (row.state == SearchState::Pending && !row.planner.empty() &&
             row.planner != parts_.store.node().name) {
    record.doing = fmt::format("searching at node {}", row.planner);
  }
  return record;
}

Answer<SearchRecord> SearchRepository::request(const Principal& who,
                                               const CardSearchRequest& request) {
  if (who.role < Role::Submitter)
    return refuse(ProblemKind::Forbidden, "a search for cards requires the role submitter");
  return parts_.store.change([&]() -> Answer<SearchRecord> {
    if (const auto room = parts_.store.accepts_work(); !room) return tl::unexpected(room.error());
    const Answer<Row> row = row_for(who, request);
    if (!row) return tl::unexpected(row.error());
    return record_of(who, *row);
  });
}

Answer<SearchRepository::Row> SearchRepository::row_for(const Principal& who,
                                                        const CardSearchRequest& request) {
  const auto label = first_of(
      parts_.store.db().rows("SELECT coalesce(own.name, asset.name) FROM asset LEFT JOIN ownership "
                             "AS own ON own.kind='asset' AND own.id=asset.id AND own.owner=? WHERE "
                             "asset.id=?",
                             who.name, request.model),
      first_text);
  if (!label)
    return refuse(ProblemKind::NotFound, fmt::format("there is no asset {:?}", request.model));
  const std::string up = up_for_file(request.up, *label, request.front);
  if (const auto fit = check_choices(request.style, request.cards, up, request.front); !fit)
    return tl::unexpected(not_valid(fit.error()));
  const Answer<MaterialRecord> material = parts_.plans.material_named(
      request.material.empty() ? std::string(kUsualMaterial) : request.material);
  if (!material) return tl::unexpected(material.error());
  const auto machine = parts_.plans.machine_for(request.device, request.machine, material->id, "");
  if (!machine) return tl::unexpected(machine.error());
  if (const auto fits = check_plan(request, machine->json, material->json); !fits)
    return tl::unexpected(fits.error());
  CardSearchRequest wanted = request;
  wanted.name = planning::design_name(*label), wanted.up = up;
  Row row;
  row.owner = who.name, row.model = request.model;
  row.words = planning::search_words(wanted);
  row.machine = machine->name, row.machine_json = machine->json;
  row.material = material->id, row.material_json = material->json;
  return find_or_add(who, std::move(row), *label);
}

Answer<SearchRepository::Row> SearchRepository::find_or_add(const Principal& who, Row fresh,
                                                            const std::string& label) {
  ServiceStore& store = parts_.store;
  Sha256 key;
  for (const std::string* part : {&fresh.words, &fresh.machine_json, &fresh.material_json}) {
    key.add(*part);
    key.add(std::string_view("\0", 1));
  }
  fresh.key = key.hex();
  store.db().hold("search " + fresh.key);
  const auto own_it = [&](const Row& row) {
    OwnershipTable& owners = parts_.designs.owners();
    owners.hold(Owned::Search, row.id);
    parts_.designs.add_asset_owner(who, row.model, label);
    owners.add(Owned::Search, row.id, {who.name, "", store.now()});
  };
  const auto before = row_of_key(fresh.key);
  if (before && (before->state != SearchState::Pending || is_owned(*before, who.name))) {
    own_it(*before);
    return *before;
  }
  const std::int64_t waiting =
      store.db().number("SELECT count(*) FROM search WHERE state='pending'");
  const std::int64_t own = store.db().number(
      "SELECT count(*) FROM ownership AS own JOIN search ON search.id=own.id WHERE "
      "own.kind='search' AND own.owner=? AND search.state='pending'",
      who.name);
  if (own >= parts_.options.searches_each)
    return too_many(
        fmt::format("{} searches of yours are waiting; try again when one of them is made", own));
  if (before) {
    own_it(*before);
    return *before;
  }
  if (waiting >= kMostWaiting)
    return too_many(fmt::format("{} searches are waiting; try again later", waiting));
  fresh.id = store.new_id();
  fresh.created = store.now();
  store.db().insert("search(" POPCUT_SEARCH_COLUMNS ")",
                    std::tuple_cat(std::tuple(word_of(fresh.state)), values_of(fresh)));
  own_it(fresh);
  store.audit(who.name, "search", fresh.id, fresh.model);
  store.after_commit([this] { pump(); });
  return fresh;
}

Answer<SearchRecord> SearchRepository::find(const Principal& who, const std::string& id) {
  return parts_.store.read([&]() -> Answer<SearchRecord> {
    const auto found = row(id);
    if (!found) return no_search(id);
    return record_of(who, *found);
  });
}

Page<SearchRecord> SearchRepository::list(const Principal& who, const PageRequest& request) {
  const std::vector<Row> rows = all_of(
      parts_.store.db().rows("SELECT state, id, key, owner, model, words, machine, material, "
                             "'' AS machine_json, '' AS material_json, '' AS front, error, "
                             "created, begun, planner FROM search WHERE id>? ORDER BY id "
                             "LIMIT ?",
                             request.cursor, request.limit + 1),
      row_of);
  Page<SearchRecord> page;
  for (const Row& row : rows) page.items.push_back(record_of(who, row));
  if (page.items.size() > static_cast<std::size_t>(request.limit)) {
    page.items.pop_back();
    page.next_cursor = page.items.back().id;
  }
  return page;
}

Answer<SearchRepository::Row> SearchRepository::found_row(const std::string& id) {
  auto found = row(id);
  if (!found) return no_search(id);
  if (found->state == SearchState::Found) return std::move(*found);
  return refuse(ProblemKind::StateConflict, found->state == SearchState::Failed
                                                ? "this search failed: " + found->error
                                                : "this search is not finished yet");
}

Answer<SearchRepository::Picked> SearchRepository::card_of(const std::string& id, int card) {
  const Answer<Row> found = found_row(id);
  if (!found) return tl::unexpected(found.error());
  SearchRecord record = record_of({}, *found);
  std::vector<FoundCardRecord>& cards = record.front.cards;
  if (card >= 1 && card <= static_cast<int>(cards.size()))
    return Picked{record.request.name, std::move(cards[static_cast<std::size_t>(card) - 1])};
  return refuse(ProblemKind::NotFound,
                fmt::format("this search found {} cards, and no card {}", cards.size(), card));
}

Answer<std::string> SearchRepository::picture(const std::string& id, int card) {
  return file_of(id, card, planning::thumbnail_file(card), "picture");
}

Answer<std::string> SearchRepository::lattice(const std::string& id, int card) {
  return file_of(id, card, planning::lattice_file(card), "lattice blob");
}

Answer<std::string> SearchRepository::file_of(const std::string& id, int card,
                                              const std::string& name, std::string_view what) {
  return parts_.store.read([&]() -> Answer<std::string> {
    if (const auto there = card_of(id, card); !there) return tl::unexpected(there.error());
    if (const auto here = parts_.store.fetch_file("searches/" + id + "/" + name); !here)
      return tl::unexpected(here.error());
    std::string path = folder_of(id) + "/" + name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) return path;
    return refuse(
        ProblemKind::NotFound,
        fmt::format("the {} of this card is not here; delete the search and search again", what));
  });
}

void SearchRepository::pick(const Principal& who, const std::string& id, int card,
                            const std::string& name, std::function<void(Answer<Design>)> done) {
  const Answer<Picked> picked = parts_.store.read([&] { return card_of(id, card); });
  if (!picked) return done(tl::unexpected(picked.error()));
  const std::string& spec = picked->card.spec;
  Upload upload{parts_.store.folder().at("incoming/" + parts_.store.new_id()), sha256_hex(spec),
                spec.size()};
  if (const Result<void> written = write_file(upload.path, spec); !written)
    return done(tl::unexpected(parts_.store.file_problem(written.error())));
  parts_.designs.add(who, std::move(upload), "application/json", name.empty() ? picked->name : name,
                     std::move(done));
}

Answer<void> SearchRepository::remove(const Principal& who, const std::string& id) {
  ServiceStore& store = parts_.store;
  return store.change([&]() -> Answer<void> {
    OwnershipTable& owners = parts_.designs.owners();
    owners.hold(Owned::Search, id);
    const auto found = row(id);
    if (!found) return no_search(id);
    const bool is_mine = is_owned(*found, who.name);
    if (!is_mine && who.role < Role::Operator)
      return refuse(ProblemKind::Forbidden, "only an operator may delete someone else's search");
    store.audit(who.name, "delete-search", id, found->model);
    if (is_mine) owners.remove(Owned::Search, id, who.name);
    if (!is_mine || !pass_to_next_owner(id)) delete_search(id);
    return {};
  });
}

// Makes the owner since the longest time the main owner. Returns false if nobody owns the search.
bool SearchRepository::pass_to_next_owner(const std::string& id) {
  Database& db = parts_.store.db();
  const auto other = first_of(
      db.rows("SELECT own.owner FROM search JOIN ownership AS own ON own.kind='search' AND "
              "own.id=search.id JOIN ownership AS too ON too.kind='asset' AND too.id=search.model "
              "AND too.owner=own.owner WHERE search.id=? ORDER BY own.created, own.owner LIMIT 1",
              id),
      first_text);
  if (other) db.run("UPDATE search SET owner=? WHERE id=?", *other, id);
  return other.has_value();
}

void SearchRepository::remove_unowned(const std::string& model) {
  for (const std::string& id :
       all_of(parts_.store.db().rows("SELECT id FROM search WHERE model=?", model), first_text))
    if (!pass_to_next_owner(id)) delete_search(id);
}

void SearchRepository::delete_search(const std::string& id) {
  parts_.designs.owners().remove_all(Owned::Search, id);
  parts_.store.db().run("DELETE FROM search WHERE id=?", id);
  parts_.store.files().forget("searches/" + id + "/");
  parts_.store.emit("notice", "", JsonObject().text("search", id).text("state", "removed"));
  parts_.store.after_commit([this, id] {
    // If the planner still makes it, `task_ended` removes its files.
    if (running_ && running_->id == id)
      parts_.planner.cancel(running_->task);
    else
      parts_.side_thread.remove(folder_of(id));
  });
}

// Owners take turns. If this node claimed a search that is not running, its end could not be
// stored, so it runs again.
std::string SearchRepository::next() {
  struct Waiting {
    std::string id, owner;
  };
  const auto first = first_of(
      parts_.store.db().rows("SELECT search.id, coalesce(own.owner, search.owner) AS asker FROM "
                             "search LEFT JOIN ownership AS own ON own.kind='search' AND "
                             "own.id=search.id WHERE state='pending' AND planner IN ('', ?1) ORDER "
                             "BY CASE WHEN coalesce(own.owner, search.owner)>?2 THEN 0 ELSE 1 END, "
                             "asker, search.id LIMIT 1",
                             parts_.store.node().name, turn_of_),
      [](const Rows& rows) {
        return Waiting{rows.text(0), rows.text(1)};
      });
  if (!first) return {};
  turn_of_ = first->owner;
  return first->id;
}

void SearchRepository::pump() {
  if (stopped_ || parts_.store.degraded() || parts_.store.full()) return;
  if (const auto found = std::exchange(unstored_, std::nullopt))
    return task_ended(std::string(running_->id), *found);
  if (running_) return;
  try {
    for (;;) {
      const std::string id = next();
      if (id.empty() || start(id) != Begun::Not) return;
    }
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
  }
}

Answer<PlanningTask> SearchRepository::task_of(const Row& row) {
  Answer<std::string> model = parts_.designs.asset_path(row.model);
  if (!model) return tl::unexpected(model.error());
  PlanningTask task;
  task.kind = PlanningTask::Kind::Search;
  task.who = row.owner;
  task.design_path = std::move(*model);
  task.machine_json = row.machine_json;
  task.material_json = row.material_json;
  task.options = {{planning::kSearchWords, row.words}};
  return task;
}

Begun SearchRepository::start(const std::string& id) {
  const auto waiting = row(id);
  if (!waiting) return Begun::Not;
  if (waiting->begun >= most_begun(parts_.store.in_fleet())) {
    const std::string why = fmt::format(
        "popcutd ended {} times while it was made; please report the model", waiting->begun);
    // If the failure cannot be stored, stop: `next` would return this search again.
    return finish(id, SearchState::Failed, "", why) ? Begun::Not : Begun::Later;
  }
  Answer<PlanningTask> task = task_of(*waiting);
  if (!task && task.error().kind == ProblemKind::NotFound)
    return finish(id, SearchState::Failed, "", "its model was deleted") ? Begun::Not : Begun::Later;
  if (!task) return Begun::Later;  // its model is being fetched; the next tick tries again
  bool is_mine = false;
  // Claim the search first: this counts how often it was begun, and no other node begins it.
  const Answer<void> noted = parts_.store.change([&]() -> Answer<void> {
    is_mine =
        parts_.store.db().run(
            "UPDATE search SET begun=begun+1, planner=?, planner_epoch=? WHERE id=? AND "
            "state='pending' AND planner IN ('', ?)",
            parts_.store.node().name, parts_.store.node().epoch, id, parts_.store.node().name) == 1;
    return {};
  });
  if (!noted) return Begun::Later;
  if (!is_mine) return Begun::Not;
  running_ = Running{.id = id};
  task->progress = [this, id, post = parts_.post](const PlanningPhase& phase) {
    post([this, id, phase] {
      name_turn("phase of a search");
      if (running_ && running_->id == id) running_->phase = phase;
    });
  };
  // The task may end before `start` returns. That is safe: its callback is posted and runs after
  // this turn.
  try {
    running_->task = parts_.planner.start(
        std::move(*task), [this, id, folder = folder_of(id), files = &parts_.store.files(),
                           post = parts_.post](Result<PlanningOutcome> made) {
          post([this, id, found = with_pictures_kept(std::move(made), folder, *files, id)] {
            task_ended(id, found);
          });
        });
  } catch (...) {  // no memory; `next` gives it again
    running_.reset();
    throw;
  }
  return Begun::Yes;
}

void SearchRepository::task_ended(const std::string& id, const Result<SearchFront>& found) {
  name_turn("search ended");
  // If the result cannot be stored, the next `pump` tries again, because it took long to find.
  if (found && !finish(id, SearchState::Found, planning::front_text(*found), "")) {
    unstored_ = *found;
    return;
  }
  running_.reset();
  const bool waits_for_room = !found && found.error().kind == ErrorKind::Unwritable;
  const bool is_stopping = !found && found.error().kind == ErrorKind::Refused;
  if (waits_for_room) {
    // The disk is full. The search stays pending, and runs again when there is space.
    parts_.store.note_full();
    parts_.store.log(message(found.error()));
  }
  if (waits_for_room || is_stopping)
    (void)parts_.store.change([&]() -> Answer<void> {
      parts_.store.db().run(
          "UPDATE search SET begun=0, planner='', planner_epoch=0 WHERE id=? AND planner=?", id,
          parts_.store.node().name);
      return {};
    });
  else if (!found)
    finish(id, SearchState::Failed, "", message(found.error()));
  // If the search was deleted meanwhile, remove its pictures, too.
  const Answer<bool> is_there =
      parts_.store.read([&]() -> Answer<bool> { return row(id).has_value(); });
  if (is_there && !*is_there) {
    (void)parts_.store.change([&]() -> Answer<void> {
      parts_.store.files().forget("searches/" + id + "/");
      return {};
    });
    parts_.side_thread.remove(folder_of(id));
  }
  pump();
}

// Changes nothing if another node has taken over the search, because this one did not answer.
bool SearchRepository::finish(const std::string& id, SearchState state, const std::string& front,
                              const std::string& error) {
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    const int changed = parts_.store.db().run(
        "UPDATE search SET state=?, front=?, error=?, begun=0, planner='', planner_epoch=0 WHERE "
        "id=? AND state='pending' AND planner IN ('', ?)",
        word_of(state), front, error, id, parts_.store.node().name);
    if (changed == 0) return {};
    JsonObject members;
    members.text("search", id).text("state", word_of(state));
    if (!error.empty()) members.text("error", error);
    parts_.store.emit("notice", "", members);
    return {};
  });
  return stored.has_value();
}

}  // namespace popcut::daemon
