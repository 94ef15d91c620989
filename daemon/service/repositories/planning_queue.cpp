// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/planning_queue.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/model/warnings.hpp"
#include "daemon/planning/make/make_ways.hpp"
#include "daemon/planning/plan_job.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::daemon {
namespace {

/// Refuses unless the plan exists and is made.
template <typename Row>
Answer<void> check_planned(const std::optional<Row>& plan, const std::string& id) {
  if (!plan) return refuse(ProblemKind::NotFound, fmt::format("there is no plan {:?}", id));
  if (plan->state == PlanState::Planned) return {};
  return refuse(ProblemKind::StateConflict, plan->state == PlanState::Failed
                                                ? "this plan failed: " + plan->error
                                                : "this plan is not finished yet");
}

// Whether somebody owns the plan and its design. A test cut has no design.
#define POPCUT_PLAN_HAS_OWNER                                                              \
  "EXISTS (SELECT 1 FROM ownership AS own WHERE own.kind='plan' AND own.id=plan.id AND "   \
  "(plan.design='' OR EXISTS (SELECT 1 FROM ownership AS too WHERE too.kind='design' AND " \
  "too.id=plan.design AND too.owner=own.owner)))"

constexpr const char* kUsualMachine = "cameo3";
constexpr std::size_t kMostHurried = 1000;
constexpr std::size_t kMostWarnings = 200, kLongestWarning = 1000;
// How many plans of a principal are read to find one that is not being made already.
constexpr int kLooked = 8;
// An option that popcutd adds to those of a plan: the row of its SVG profile at that time.
constexpr const char* kProfileRow = "svg-profile-row";

std::map<std::string, std::string> words_of(const std::string& json) {
  const nlohmann::json object = nlohmann::json::parse(json, nullptr, false);
  if (!object.is_object()) throw StoreFault(FaultKind::Corrupt, "a plan's options are invalid");
  std::map<std::string, std::string> words;
  for (const auto& [name, value] : object.items())
    if (value.is_string()) words[name] = value.get<std::string>();
  return words;
}

// The options and tables of a plan.
void fill_in(PlanningTask& task, const PlanRow& plan) {
  task.machine_json = plan.machine_json;
  task.material_json = plan.material_json;
  task.options = words_of(plan.options);
  if (auto own = task.options.extract(kProfileRow)) task.profile_json = std::move(own.mapped());
}

PlanRecord record_of(const PlanRow& row, std::vector<SheetPlan> sheets) {
  return {.id = row.id,
          .design = row.design,
          .material = row.material,
          .machine = row.machine,
          .state = row.state,
          .sha256 = row.sha256,
          .sheets = std::move(sheets),
          .warnings = row.warnings,
          .error = row.error,
          .created = row.created,
          .sheets_total = row.sheets,
          .paths = row.paths,
          .length_mm = row.cut_mm,
          .est_s = {row.low_s, row.high_s},
          .handwork = row.handwork};
}

// Writes the files of a plan to the disk. The plan is stored after that, so that whoever sees the
// plan finds its files. Runs on a thread of the planner.
Result<PlanningOutcome> with_files_kept(Result<PlanningOutcome> outcome, const std::string& folder,
                                        SharedFiles& shared, const std::string& plan) {
  if (!outcome) return outcome;
  std::vector<std::pair<std::string, std::string_view>> files;
  for (const PlanningFile& file : outcome->files) files.emplace_back(file.name, file.bytes);
  // Compute the digest of the bytes that are written. What the worker reports does not count.
  for (SheetPlan& sheet : outcome->sheets) {
    const auto index = std::find_if(
        outcome->files.begin(), outcome->files.end(),
        [name = index_name(sheet.number)](const PlanningFile& file) { return file.name == name; });
    if (index != outcome->files.end()) sheet.index_sha256 = sha256_hex(index->bytes);
  }
  if (Result<void> kept = write_folder(folder, files); !kept) return tl::unexpected(kept.error());
  if (Result<void> kept = shared.keep("plans/" + plan); !kept) return tl::unexpected(kept.error());
  outcome->files.clear();
  outcome->files.shrink_to_fit();
  shorten(outcome->warnings, kMostWarnings, kLongestWarning);
  return outcome;
}

std::string fault_of(const PlanningOutcome& outcome, int most_sheets) {
  if (outcome.sheets.empty()) return "the design contains nothing to cut";
  if (outcome.sheets.size() > static_cast<std::size_t>(most_sheets))
    return fmt::format("the design needs {} sheets; a job has at most {}", outcome.sheets.size(),
                       most_sheets);
  for (std::size_t i = 0; i < outcome.sheets.size(); ++i)
    if (outcome.sheets[i].number != static_cast<int>(i) + 1 ||
        outcome.sheets[i].program_sha256.size() != 64 ||
        outcome.sheets[i].index_sha256.size() != 64 || outcome.sha256.size() != 64)
      return "the planner returned sheets that are not numbered from 1, or have no digests";
  return {};
}

/// What differs between two rows of a table: "force_gf 120, now 150; scale_x 1, now 1.002".
std::string changes_of(const std::string& before, const std::string& now) {
  constexpr std::size_t kNamed = 3;
  using Json = nlohmann::json;
  if (before == now) return {};
  const Json old = Json::parse(before, nullptr, false), fresh = Json::parse(now, nullptr, false);
  if (!old.is_structured() || !fresh.is_structured()) return "another row";
  const Json was = old.flatten(), is = fresh.flatten();
  std::vector<std::string> changes;
  const auto look = [&](const Json& all, const Json& other, bool is_gone) {
    for (const auto& [pointer, value] : all.items()) {
      const std::string name = pointer.substr(1);
      if (!other.contains(pointer))
        changes.push_back(is_gone ? fmt::format("{} {}, now none", name, value.dump())
                                  : fmt::format("{} none, now {}", name, value.dump()));
      else if (is_gone && other[pointer] != value)
        changes.push_back(fmt::format("{} {}, now {}", name, value.dump(), other[pointer].dump()));
    }
  };
  look(was, is, true);
  look(is, was, false);
  const std::size_t all = changes.size();
  if (all > kNamed) {
    changes.resize(kNamed);
    changes.push_back(fmt::format("and {} more", all - kNamed));
  }
  return fmt::format("{}", fmt::join(changes, "; "));
}

void add_totals(PlanRow& row, const std::vector<SheetPlan>& sheets) {
  row.sheets = static_cast<int>(sheets.size());
  for (const SheetPlan& sheet : sheets) {
    row.paths += sheet.paths;
    row.cut_mm += sheet.cut_mm + sheet.fold_mm;
    row.low_s += sheet.seconds_range[0];
    row.high_s += sheet.seconds_range[1];
    row.width_mm = std::max(row.width_mm, sheet.area_mm[0]);
    row.length_mm = std::max(row.length_mm, sheet.area_mm[1]);
  }
}

}  // namespace

Answer<void> PlanningQueue::fetch_sheet(const std::string& plan, int sheet) {
  const std::string stem = fmt::format("plans/{}/sheet-{:02}.", plan, sheet);
  return parts_.store.read([&]() -> Answer<void> {
    for (const std::string& name : parts_.store.files().names(stem))
      if (const auto here = parts_.store.fetch_file(name); !here) return here;
    return {};
  });
}

std::string PlanningQueue::folder_of(const std::string& plan) const {
  return parts_.store.folder().at("plans/" + plan);
}

Answer<PlanningQueue::MachineRow> PlanningQueue::machine_for(const std::string& device,
                                                             const std::string& machine,
                                                             const std::string& material,
                                                             const std::string& site) {
  std::string name = machine;
  if (!device.empty()) {
    if (!parts_.devices.find(device))
      return tl::unexpected(parts_.devices.unknown(device, "/device"));
    const std::string of_device = parts_.devices.machine_of(device);
    if (!name.empty() && !of_device.empty() && name != of_device)
      return refuse_value("/machine", "value", fmt::format("{} is a {}", device, of_device),
                          "device and machine do not match");
    if (name.empty()) name = of_device;
  }
  if (name.empty()) name = parts_.devices.machine_for(material, site).machine;
  if (name.empty()) name = kUsualMachine;
  return parts_.materials.machine_row(name).map([&](const std::string& json) {
    return MachineRow{name, json};
  });
}

Answer<std::vector<popcut::Machine>> PlanningQueue::machines() {
  const Result<std::vector<popcut::Machine>> all = all_machines(parts_.options.tables);
  if (!all) return tl::unexpected(problem_from(all.error()));
  return *all;
}

Answer<MaterialRecord> PlanningQueue::material_named(const std::string& name) {
  Answer<MaterialRecord> found = parts_.materials.find(name);
  if (found || found.error().kind != ProblemKind::NotFound) return found;
  const std::string detail = found.error().detail;
  return refuse_value("/material", "unknown", detail, detail);
}

Answer<PlanRecord> PlanningQueue::request(const Principal& who, const PlanRequest& request) {
  if (who.role < Role::Submitter)
    return refuse(ProblemKind::Forbidden, "planning a design requires the role submitter");
  return parts_.store.change([&]() -> Answer<PlanRecord> {
    if (const auto room = parts_.store.accepts_work(); !room) return tl::unexpected(room.error());
    const Answer<PlanRow> plan = plan_for(who, request);
    if (!plan) return tl::unexpected(plan.error());
    if (plan->state == PlanState::Pending)
      parts_.store.after_commit([this, id = plan->id, owner = who.name] {
        hurry(id, owner);
        pump();
      });
    return find(plan->id);
  });
}

Answer<PlanRow> PlanningQueue::plan_for(const Principal& who, const PlanRequest& request) {
  // Fetch the file, because a spec may name its material.
  const Answer<Design> design = parts_.designs.find_and_fetch(request.design);
  if (!design) {
    if (design.error().kind != ProblemKind::NotFound) return tl::unexpected(design.error());
    return refuse_value("/design", "unknown", "must be the id of an uploaded design",
                        design.error().detail);
  }
  const Answer<MaterialRecord> material = material_of(request, *design);
  if (!material) return tl::unexpected(material.error());
  const Answer<MachineRow> machine =
      machine_for(request.device, request.machine, material->id, request.site);
  if (!machine) return tl::unexpected(machine.error());
  const Answer<PlanRow> row = rows_of(request, *design, *material, *machine);
  if (!row) return tl::unexpected(row.error());
  return find_or_add(who, *row);
}

Answer<MaterialRecord> PlanningQueue::material_of(const PlanRequest& request,
                                                  const Design& design) {
  const std::string own =
      request.material.empty() ? parts_.designs.material_in_spec(design) : request.material;
  return material_named(own.empty() ? kUsualMaterial : own);
}

Answer<PlanRow> PlanningQueue::rows_of(const PlanRequest& request, const Design& design,
                                       const MaterialRecord& material, const MachineRow& machine) {
  std::map<std::string, std::string> options = request.options;
  if (options.contains(kProfileRow))
    return tl::unexpected(Problem{
        ProblemKind::Validation,
        "the options are not valid",
        {{fmt::format("/options/{}", kProfileRow), "option", "must be absent; use svg-profile"}}});
  if (const auto read = read_plan_options(options); !read)
    return tl::unexpected(problem_from(planning::in_request(read.error())));
  if (const auto named = options.find("svg-profile"); named != options.end())
    if (std::string own = parts_.materials.profile_row(named->second); !own.empty())
      options[kProfileRow] = std::move(own);
  return PlanRow{.id = {},
                 .key = {},
                 .kind = "design",
                 .design = design.id,
                 .material = material.id,
                 .machine = machine.name,
                 .options = nlohmann::json(options).dump(),
                 .machine_json = machine.json,
                 .material_json = material.json};
}

Answer<PlanRow> PlanningQueue::plan_again(const Principal& who, const PlanRow& before,
                                          const std::string& device, const std::string& material,
                                          const std::string& site) {
  const std::string& wanted = material.empty() ? before.material : material;
  if (before.kind == "test") return test_plan_for(who, device, wanted, site);
  std::map<std::string, std::string> options = words_of(before.options);
  options.erase(kProfileRow);
  return plan_for(who, {.design = before.design,
                        .material = wanted,
                        .device = device,
                        .machine = {},
                        .options = std::move(options),
                        .site = site});
}

std::vector<Warning> PlanningQueue::changed_since(const PlanRow& plan) {
  std::vector<Warning> all;
  const auto compare = [&](const char* what, const std::string& name, const std::string& before,
                           const std::string& now) {
    if (const std::string changes = changes_of(before, now); !changes.empty())
      all.push_back({.code = fmt::format("{}_changed", what),
                     .message = fmt::format("the {} {} has changed since the sheets were planned "
                                            "({}); plan the job again with plan_again",
                                            what, name, changes),
                     .place = {},
                     .spoils = true});
  };
  if (const auto machine = parts_.materials.machine_row(plan.machine))
    compare("machine", plan.machine, plan.machine_json, *machine);
  if (const auto material = parts_.materials.find(plan.material))
    compare("material", plan.material, plan.material_json, material->json);
  return all;
}

Answer<PlanRow> PlanningQueue::test_plan_for(const Principal& who, const std::string& device,
                                             const std::string& material, const std::string& site) {
  const Answer<MaterialRecord> row = material_named(material.empty() ? kUsualMaterial : material);
  if (!row) return tl::unexpected(row.error());
  const Answer<MachineRow> machine = machine_for(device, "", row->id, site);
  if (!machine) return tl::unexpected(machine.error());
  return find_or_add(who, {.id = {},
                           .key = {},
                           .kind = "test",
                           .design = "",
                           .material = row->id,
                           .machine = machine->name,
                           .machine_json = machine->json,
                           .material_json = row->json});
}

Answer<void> PlanningQueue::add_waiting(const Principal& who, const PlanRow& plan) {
  if (!plan.design.empty())
    if (const Answer<Design> design = parts_.designs.find(plan.design))
      parts_.designs.add_owner(who, *design, design->name);
  OwnershipTable& owners = parts_.designs.owners();
  owners.hold(Owned::Plan, plan.id);
  owners.add(Owned::Plan, plan.id, {who.name, "", parts_.store.now()});
  if (plan.state != PlanState::Pending || plans_.has_asked(plan.id, who.name)) return {};
  if (const std::int64_t own = plans_.asked_by(who.name); own >= parts_.options.plans_each)
    return refuse(
        ProblemKind::QueueFull,
        fmt::format("{} plans of yours are waiting; try again when some of them are made", own),
        /*retry_after_s=*/60);
  plans_.ask(plan.id, who.name);
  return {};
}

Answer<PlanRow> PlanningQueue::find_or_add(const Principal& who, PlanRow row) {
  ServiceStore& store = parts_.store;
  Sha256 key;
  for (const std::string* part :
       {&row.kind, &row.design, &row.machine_json, &row.material_json, &row.options}) {
    key.add(*part);
    key.add(std::string_view("\0", 1));
  }
  row.key = key.hex();
  store.db().hold("plan " + row.key);
  if (auto before = plans_.find_key(row.key)) {
    if (const auto waits = add_waiting(who, *before); !waits) return tl::unexpected(waits.error());
    return *before;
  }
  const std::int64_t waiting = store.db().number("SELECT count(*) FROM plan WHERE state='pending'");
  if (waiting >= parts_.options.queue_jobs) {
    return refuse(ProblemKind::QueueFull,
                  fmt::format("{} plans are waiting; try again later", waiting),
                  /*retry_after_s=*/60);
  }
  row.id = store.new_id();
  row.created = store.now();
  plans_.insert(row);
  if (const auto fine = add_waiting(who, row); !fine) return tl::unexpected(fine.error());
  store.after_commit([this] { pump(); });
  return row;
}

void PlanningQueue::hurry(const std::string& plan, const std::string& owner) {
  if (hurried_.size() >= kMostHurried) return;
  hurried_.push_back({plan, owner});
  requested_.insert(plan);
}

// The next plan of `owner`: first those that were requested themselves, then those for which jobs
// wait, in the order of the queue.
std::string PlanningQueue::next_of(const std::string& owner) {
  const auto is_free = [&](const std::string& id) {
    if (running_.contains(id)) return false;
    const auto plan = plans_.find(id);
    return plan && plan->state == PlanState::Pending && plan->planner.empty();
  };
  for (auto one = hurried_.begin(); one != hurried_.end();) {
    if (one->owner != owner) {
      ++one;
      continue;
    }
    const std::string id = one->plan;
    one = hurried_.erase(one);
    if (is_free(id)) return id;
  }
  for (const std::string& id :
       plans_.wanted_by(owner, std::max(kLooked, static_cast<int>(running_.size()) + 1)))
    if (is_free(id)) return id;
  return {};
}

// Principals take turns, however many plans one of them waits for.
std::string PlanningQueue::next() {
  const std::string first = turn_of_;
  for (bool wrapped = false;;) {
    const auto owner = plans_.asker_after(turn_of_);
    if (owner && !(wrapped && *owner > first)) {
      turn_of_ = *owner;
      if (std::string id = next_of(*owner); !id.empty()) return id;
    } else if (wrapped) {
      break;
    } else {
      wrapped = true;
      turn_of_.clear();
    }
  }
  // Last, plans for which nobody waits. They come from a salvaged database.
  for (const std::string& id : plans_.pending(static_cast<int>(running_.size()) + 1))
    if (!running_.contains(id)) return id;
  return {};
}

// In a fleet another node may have taken over a plan, because this node did not answer.
bool PlanningQueue::is_claimed_here(const PlanRow& plan) const {
  return plan.state == PlanState::Pending && plan.planner == parts_.store.node().name;
}

// Releases a plan that this node claimed and does not make. Until then no node can make it. If the
// release cannot be stored, the next `pump` tries again.
void PlanningQueue::release(const std::string& id) {
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    const auto plan = plans_.find(id);
    if (plan && is_claimed_here(*plan)) plans_.give_back(id, 0);
    return {};
  });
  if (!stored) to_release_.insert(id);
}

void PlanningQueue::pump() {
  if (stopped_ || parts_.store.degraded() || parts_.store.full()) return;
  for (const auto& [id, made] : std::exchange(unstored_, {})) store_sheets(id, made, 0);
  for (const std::string& id : std::exchange(to_release_, {})) release(id);
  for (const std::string& design : std::exchange(partly_removed_, {})) remove_more_of(design);
  try {
    while (running_.size() < static_cast<std::size_t>(parts_.options.plans_at_once)) {
      const std::string id = next();
      if (id.empty() || start(id) == Begun::Later) return;
    }
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
  }
}

PlanningTask PlanningQueue::task_of(const PlanRow& plan, const Design& design,
                                    PlanningTask::Kind kind) {
  PlanningTask task = parts_.designs.task_for(design, kind);
  fill_in(task, plan);
  return task;
}

Begun PlanningQueue::start(const std::string& id) {
  const auto plan = plans_.find(id);
  if (!plan) return Begun::Later;
  // If the failure cannot be stored, stop: `next` would return this plan again.
  const auto failed = [&](const std::string& why) {
    return fail_plan(id, why) ? Begun::Not : Begun::Later;
  };
  if (plan->begun >= most_begun(parts_.store.in_fleet()))
    return failed(fmt::format("popcutd ended {} times while it was made; please report the design",
                              plan->begun));
  PlanningTask task;
  if (plan->kind == "test") {
    task.kind = PlanningTask::Kind::TestCut;
  } else {
    const Answer<Design> design = parts_.designs.find_and_fetch(plan->design);
    if (!design) {
      if (design.error().kind != ProblemKind::NotFound) return Begun::Later;
      return failed("its design was deleted");
    }
    task = parts_.designs.task_for(*design, PlanningTask::Kind::Plan);
  }
  fill_in(task, *plan);
  if (const auto owner = parts_.designs.owners().first(Owned::Plan, id)) task.who = owner->owner;
  // Claim the plan first: this counts how often it was begun, and no other node begins it.
  bool is_mine = false;
  const Answer<void> noted = parts_.store.change([&]() -> Answer<void> {
    is_mine = plans_.claim(id, parts_.store.node());
    return {};
  });
  if (!noted) return Begun::Later;
  if (!is_mine) return Begun::Not;
  running_[id] = 0;
  task.progress = [this, id, post = parts_.post](const PlanningPhase& phase) {
    post([this, id, phase] {
      name_turn("phase of a plan");
      if (progressed && running_.contains(id)) progressed(id, phase);
    });
  };
  // The task may end before `start` returns. That is safe: its callback is posted and runs after
  // this turn.
  try {
    running_[id] = parts_.planner.start(
        std::move(task), [this, id, folder = folder_of(id), files = &parts_.store.files(),
                          post = parts_.post](Result<PlanningOutcome> made) {
          auto kept = std::make_shared<Result<PlanningOutcome>>(
              with_files_kept(std::move(made), folder, *files, id));
          post([this, id, kept] { task_ended(id, std::move(*kept)); });
        });
  } catch (...) {  // no memory; the plan is released, and made later
    running_.erase(id);
    to_release_.insert(id);
    throw;
  }
  if (begun) begun(id);
  return Begun::Yes;
}

void PlanningQueue::task_ended(const std::string& id, Result<PlanningOutcome> outcome) {
  name_turn("plan ended");
  if (is_removed(id)) {
    running_.erase(id);
    parts_.side_thread.remove(folder_of(id));
    return pump();
  }
  if (!outcome && outcome.error().kind == ErrorKind::Unwritable) {
    running_.erase(id);
    // The disk is full. The plan stays pending, and is made again when there is space.
    release(id);
    parts_.store.note_full();
    parts_.store.log(message(outcome.error()));
    return;
  }
  if (!outcome) {
    running_.erase(id);
    const bool is_cancelled = outcome.error().kind == ErrorKind::Refused;
    // It was cancelled because nobody waited. If somebody waits again by now, or if the store
    // cannot say, it is made again.
    if (is_cancelled &&
        parts_.store.read([&]() -> Answer<bool> { return is_awaited(id); }).value_or(true))
      release(id);
    else if (!fail_plan(id, is_cancelled ? "it was no longer needed" : message(outcome.error())))
      to_release_.insert(id);
    return pump();
  }
  if (const std::string fault = fault_of(*outcome, parts_.options.sheets_per_job); !fault.empty()) {
    running_.erase(id);
    parts_.side_thread.remove(folder_of(id));
    if (!fail_plan(id, fault)) to_release_.insert(id);
    return pump();
  }
  store_sheets(id, std::make_shared<PlanningOutcome>(std::move(*outcome)), 0);
}

// Stores a part of the sheets in each turn. With the last part the plan is made. If a part cannot
// be stored, the next `pump` begins with the first part again, because the sheets took long to
// make.
void PlanningQueue::store_sheets(const std::string& id,
                                 const std::shared_ptr<PlanningOutcome>& made, std::size_t from) {
  name_turn("plan ended");
  const std::span<const SheetPlan> sheets(made->sheets);
  const std::size_t count = std::min<std::size_t>(kSheetsAtOnce, sheets.size() - from);
  const bool is_last = from + count == sheets.size();
  bool is_gone = false;
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    auto plan = plans_.find(id);
    is_gone = !plan || !is_claimed_here(*plan);
    if (is_gone) return {};
    plans_.put_sheets(id, sheets.subspan(from, count));
    if (!is_last) return {};
    plan->state = PlanState::Planned;
    plan->sha256 = made->sha256;
    plan->warnings = made->warnings;
    plan->handwork = made->handwork;
    add_totals(*plan, made->sheets);
    plans_.finish(*plan);
    parts_.store.emit("notice", "", JsonObject().text("plan", id).text("state", "planned"));
    return {};
  });
  if (!stored) {
    unstored_[id] = made;
    return;
  }
  if (!is_gone && !is_last)
    return parts_.post([this, id, made, next = from + count] { store_sheets(id, made, next); });
  running_.erase(id);
  requested_.erase(id);
  if (is_gone && is_removed(id)) parts_.side_thread.remove(folder_of(id));
  if (!is_gone && ended) ended(id);
  pump();
}

bool PlanningQueue::fail_plan(const std::string& id, const std::string& why) {
  requested_.erase(id);
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    auto plan = plans_.find(id);
    if (!plan || plan->state != PlanState::Pending) return {};
    if (!plan->planner.empty() && !is_claimed_here(*plan)) return {};
    plan->state = PlanState::Failed;
    plan->error = why;
    plan->sheets = 0;
    plans_.finish(*plan);
    parts_.store.emit("notice", "",
                      JsonObject().text("plan", id).text("state", "failed").text("error", why));
    return {};
  });
  if (stored && ended) ended(id);
  return stored.has_value();
}

void PlanningQueue::cancel_if_unwanted(const std::string& plan) {
  const auto found = running_.find(plan);
  if (found == running_.end()) return;
  try {
    if (!is_awaited(plan)) parts_.planner.cancel(found->second);
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
  }
}

bool PlanningQueue::is_owned(const PlanRow& plan, const std::string& owner) {
  OwnershipTable& owners = parts_.designs.owners();
  return owners.has(Owned::Plan, plan.id, owner) &&
         (plan.design.empty() || owners.has(Owned::Design, plan.design, owner));
}

bool PlanningQueue::is_owned(const std::string& plan) {
  return parts_.store.db().number(
             "SELECT EXISTS(SELECT 1 FROM plan WHERE id=? AND " POPCUT_PLAN_HAS_OWNER ")", plan) !=
         0;
}

Answer<void> PlanningQueue::check_jobs(const std::string& plan, const std::string& owner) {
  Rows used = parts_.store.db().rows(
      "SELECT id, deleted FROM job WHERE plan=?1 AND (owner=?2 OR ?2='') ORDER BY deleted LIMIT 1",
      plan, owner);
  if (!used.next()) return {};
  return refuse(
      ProblemKind::StateConflict,
      used.integer(1) != 0
          ? std::string("the record of a deleted job refers to this plan; it is kept")
          : fmt::format("job {} uses this plan; cancel the job to stop planning", used.text(0)));
}

Answer<void> PlanningQueue::remove(const Principal& who, const std::string& id) {
  ServiceStore& store = parts_.store;
  return store.change([&]() -> Answer<void> {
    OwnershipTable& owners = parts_.designs.owners();
    owners.hold(Owned::Plan, id);
    const auto plan = plans_.find(id);
    if (!plan) return refuse(ProblemKind::NotFound, fmt::format("there is no plan {:?}", id));
    const bool is_mine = is_owned(*plan, who.name);
    if (!is_mine && who.role < Role::Operator)
      return refuse(ProblemKind::Forbidden, "only an operator may delete someone else's plan");
    if (const auto free = check_jobs(id, is_mine ? who.name : ""); !free) return free;
    store.audit(who.name, "delete-plan", id, plan->design);
    if (is_mine) {
      owners.remove(Owned::Plan, id, who.name);
      plans_.unask(id, who.name);
      // Others own the plan too, or a job of theirs refers to it.
      if (is_owned(id) || !check_jobs(id, "")) return {};
    }
    store.emit("notice", "", JsonObject().text("plan", id).text("state", "removed"));
    delete_plan(id);
    return {};
  });
}

void PlanningQueue::remove_unowned(const std::string& design) {
  if (!remove_some_of(design))
    parts_.store.after_commit([this, design] { remove_more_of(design); });
}

// Removes a few plans, and not too many sheets, so that the turn is short. True if none is left.
bool PlanningQueue::remove_some_of(const std::string& design) {
  constexpr int kPlansRemoved = 50, kSheetsRemoved = 2000;  // in one transaction
  std::vector<std::string> ids;
  std::int64_t sheets = 0;
  Rows rows = parts_.store.db().rows(
      "SELECT id, sheets FROM plan WHERE design=? AND NOT EXISTS (SELECT 1 FROM job WHERE "
      "job.plan=plan.id) AND NOT " POPCUT_PLAN_HAS_OWNER " LIMIT ?",
      design, kPlansRemoved + 1);
  bool more = false;
  while (rows.next()) {
    more =
        !ids.empty() && (ids.size() == kPlansRemoved || sheets + rows.integer(1) > kSheetsRemoved);
    if (more) break;
    sheets += rows.integer(1);
    ids.push_back(rows.text(0));
  }
  for (const std::string& id : ids) delete_plan(id);
  return !more;
}

void PlanningQueue::remove_more_of(const std::string& design) {
  parts_.post([this, design] {
    name_turn("plans of a removed design");
    bool all = true;
    const Answer<void> removed = parts_.store.change([&]() -> Answer<void> {
      all = remove_some_of(design);
      return {};
    });
    if (!removed)
      partly_removed_.insert(design);  // the next `pump` tries again
    else if (!all)
      remove_more_of(design);
  });
}

void PlanningQueue::delete_plan(const std::string& id) {
  parts_.designs.owners().remove_all(Owned::Plan, id);
  parts_.store.db().run("DELETE FROM plan WHERE id=?", id);
  parts_.store.files().forget("plans/" + id + "/");
  parts_.store.after_commit([this, id] {
    requested_.erase(id);
    std::erase_if(hurried_, [&](const Hurried& one) { return one.plan == id; });
    // If the planner still makes it, `task_ended` removes its files.
    if (const auto found = running_.find(id); found != running_.end())
      parts_.planner.cancel(found->second);
    else
      parts_.side_thread.remove(folder_of(id));
  });
}

bool PlanningQueue::is_removed(const std::string& id) {
  try {
    return !plans_.find(id);
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
    return false;
  }
}

// After a restart and at other nodes, `requested_` does not have the plan. So this also counts a
// principal who waits for the plan and has no job with it: they must have requested the plan
// itself.
bool PlanningQueue::is_awaited(const std::string& plan) {
  return requested_.contains(plan) ||
         parts_.store.db().number(
             "SELECT EXISTS(SELECT 1 FROM job WHERE plan=?1 AND state IN ('queued', 'planning')) "
             "OR EXISTS(SELECT 1 FROM plan_asker WHERE plan=?1 AND NOT EXISTS (SELECT 1 FROM job "
             "WHERE job.plan=plan_asker.plan AND job.owner=plan_asker.owner))",
             plan) != 0;
}

Answer<PlanRecord> PlanningQueue::find(const std::string& id) {
  return parts_.store.read([&]() -> Answer<PlanRecord> {
    const auto plan = plans_.find(id);
    if (!plan) return refuse(ProblemKind::NotFound, fmt::format("there is no plan {:?}", id));
    const bool few = plan->sheets <= kSheetsAtOnce;
    return record_of(*plan, few ? plans_.sheets(id, 0, kSheetsAtOnce) : std::vector<SheetPlan>());
  });
}

void PlanningQueue::whole(const std::string& id, std::function<void(Answer<PlanRecord>)> done) {
  Answer<PlanRecord> found = find(id);
  if (!found || found->sheets_total <= kSheetsAtOnce || found->state != PlanState::Planned)
    return done(std::move(found));
  read_on(std::make_shared<PlanRecord>(std::move(*found)), done);
}

void PlanningQueue::read_on(const std::shared_ptr<PlanRecord>& record,
                            const std::function<void(Answer<PlanRecord>)>& done) {
  name_turn("sheets of a plan");
  const Answer<bool> more = parts_.store.read([&]() -> Answer<bool> {
    std::vector<SheetPlan> some =
        plans_.sheets(record->id, static_cast<int>(record->sheets.size()), kSheetsAtOnce);
    std::move(some.begin(), some.end(), std::back_inserter(record->sheets));
    return static_cast<int>(record->sheets.size()) < record->sheets_total && !some.empty();
  });
  if (!more) return done(tl::unexpected(more.error()));
  if (!*more) return done(std::move(*record));
  parts_.post([this, record, done] { read_on(record, done); });
}

Answer<std::string> PlanningQueue::file(const std::string& id, const std::string& name) {
  return parts_.store.read([&]() -> Answer<std::string> {
    const auto plan = plans_.find(id);
    if (auto ready = check_planned(plan, id); !ready) return tl::unexpected(ready.error());
    std::string path = folder_of(id) + "/" + name;
    std::error_code ignored;
    if (is_plain_name(name))
      if (const auto here = parts_.store.fetch_file("plans/" + id + "/" + name); !here)
        return tl::unexpected(here.error());
    if (!is_plain_name(name) || !std::filesystem::is_regular_file(path, ignored))
      return refuse(ProblemKind::NotFound, fmt::format("this plan has no file {:?}", name));
    return path;
  });
}

Answer<PreviewTask> PlanningQueue::artwork_task(const Principal& who, const std::string& id,
                                                int sheet, const ArtworkRequest& wanted) {
  const auto plan = plans_.find(id);
  if (auto ready = check_planned(plan, id); !ready) return tl::unexpected(ready.error());
  const auto of_plan = plans_.sheet(id, sheet);
  if (!of_plan)
    return refuse(ProblemKind::NotFound, fmt::format("this plan has no sheet {}", sheet));
  if (plan->kind == "test") return refuse(ProblemKind::NotFound, "a test cut has no artwork");
  const Answer<Design> design = parts_.designs.find_and_fetch(plan->design);
  if (!design) return tl::unexpected(design.error());
  if (design->kind != "spec")
    return refuse(ProblemKind::NotFound,
                  "only plans of specs have artwork; this plan is of a drawing");
  PreviewTask task{task_of(*plan, *design, PlanningTask::Kind::Artwork), who.name};
  if (!wanted.model.empty()) {
    Answer<std::string> place = parts_.designs.asset_path(wanted.model);
    if (!place) return tl::unexpected(place.error());
    task.task.asset_paths[wanted.model] = std::move(*place);
  }
  const auto set = [&](const char* name, std::string value) {
    task.task.options[std::string(planning::kArtworkOption) + name] = std::move(value);
  };
  set("sheet", std::to_string(sheet));
  set("mode", wanted.mode);
  set("dpi", std::to_string(wanted.dpi));
  set("clay", wanted.clay ? "true" : "false");
  set("back", wanted.back ? "true" : "false");
  set("model", wanted.model);
  set("sha256", of_plan->program_sha256);
  return task;
}

Designs::CancelView PlanningQueue::artwork(const Principal& who, const std::string& id, int sheet,
                                           const ArtworkRequest& wanted, Designs::OnView done) {
  Answer<PreviewTask> task =
      parts_.store.read([&] { return artwork_task(who, id, sheet, wanted); });
  if (task) return parts_.designs.show(std::move(*task), planning::kArtworkFile, std::move(done));
  done(tl::unexpected(task.error()));
  return [] {};
}

Answer<PreviewTask> PlanningQueue::make_task(const Principal& who, const std::string& way,
                                             const PlanRequest& request) {
  const Answer<Design> design = parts_.designs.find_and_fetch(request.design);
  if (!design) return tl::unexpected(design.error());
  const Answer<MaterialRecord> material = material_of(request, *design);
  if (!material) return tl::unexpected(material.error());
  const planning::MakeWay* const named = planning::find_make_way(way);
  MachineRow machine;
  if (!request.machine.empty() || (named != nullptr && !named->machine.empty())) {
    machine.name = request.machine.empty() ? std::string(named->machine) : request.machine;
    Answer<std::string> row = parts_.materials.machine_row(machine.name);
    if (!row) return tl::unexpected(row.error());
    machine.json = std::move(*row);
  }
  const Answer<PlanRow> row = rows_of(request, *design, *material, machine);
  if (!row) return tl::unexpected(row.error());
  PreviewTask task{task_of(*row, *design, PlanningTask::Kind::Make), who.name};
  task.task.options[std::string(planning::kMakeOption) + "way"] = way;
  return task;
}

Designs::CancelView PlanningQueue::make(const Principal& who, const std::string& way,
                                        const PlanRequest& request, Designs::OnView done) {
  Answer<PreviewTask> task = parts_.store.read([&] { return make_task(who, way, request); });
  if (!task) {
    done(tl::unexpected(task.error()));
    return [] {};
  }
  return parts_.designs.show(
      std::move(*task), planning::kMakeFile, [done = std::move(done)](Answer<std::string> made) {
        constexpr std::string_view kAsks = R"({"asks":)";
        if (!made || !made->starts_with(kAsks)) return done(std::move(made));
        const auto answer = nlohmann::ordered_json::parse(*made, nullptr, false);
        if (answer.is_discarded())
          return done(refuse(ProblemKind::Internal, "the worker's question cannot be read"));
        Problem problem = invalid_value(
            fmt::format("/options/{}", answer["asks"].value("asks", std::string("layers"))),
            "unclear", "must say what the lines of `asks` are for",
            answer.value("detail", std::string()));
        problem.asks = answer["asks"].dump();
        done(tl::unexpected(std::move(problem)));
      });
}

std::string index_name(int sheet) { return fmt::format("sheet-{:02}.program.json", sheet); }

}  // namespace popcut::daemon
