// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/planning_queue.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/planning/plan_job.hpp"

namespace popcut::daemon {
namespace {

constexpr const char* kUsualMaterial = "paper-220";
constexpr const char* kUsualMachine = "cameo3";
constexpr std::size_t kMostHurried = 1000;
// Beside a plan's options as they were given: the row that the SVG profile had then.
constexpr const char* kProfileRow = "svg-profile-row";

std::map<std::string, std::string> words_of(const std::string& json) {
  const nlohmann::json object = nlohmann::json::parse(json, nullptr, false);
  if (!object.is_object()) throw StoreFault(FaultKind::Corrupt, "a plan's options are invalid");
  std::map<std::string, std::string> words;
  for (const auto& [name, value] : object.items())
    if (value.is_string()) words[name] = value.get<std::string>();
  return words;
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
          .created = row.created};
}

// The files of a plan, before anyone hears of it. Runs on a thread of the planner's.
Result<PlanningOutcome> with_files_kept(Result<PlanningOutcome> outcome,
                                        const std::string& folder) {
  if (!outcome) return outcome;
  std::vector<std::pair<std::string, std::string_view>> files;
  for (const PlanningFile& file : outcome->files) files.emplace_back(file.name, file.bytes);
  // What is written is what is cut, whatever the worker says of it.
  for (SheetPlan& sheet : outcome->sheets) {
    const auto index = std::find_if(
        outcome->files.begin(), outcome->files.end(),
        [name = index_name(sheet.number)](const PlanningFile& file) { return file.name == name; });
    if (index != outcome->files.end()) sheet.index_sha256 = sha256_hex(index->bytes);
  }
  if (Result<void> kept = write_folder(folder, files); !kept) return tl::unexpected(kept.error());
  outcome->files.clear();
  outcome->files.shrink_to_fit();
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

std::string PlanningQueue::folder_of(const std::string& plan) const {
  return parts_.store.folder().at("plans/" + plan);
}

Answer<PlanningQueue::Machine> PlanningQueue::machine_for(const std::string& device,
                                                          const std::string& machine) {
  std::string name = machine;
  if (!device.empty()) {
    if (!parts_.devices.find(device))
      return tl::unexpected(parts_.devices.unknown(device, "/device"));
    const std::string of_device = parts_.devices.machine_of(device);
    if (!name.empty() && !of_device.empty() && name != of_device)
      return tl::unexpected(invalid_value("/machine", "value",
                                          fmt::format("{} is a {}", device, of_device),
                                          "device and machine do not match"));
    if (name.empty()) name = of_device;
  }
  if (name.empty()) name = parts_.devices.first_machine();
  if (name.empty()) name = kUsualMachine;
  return parts_.materials.machine_row(name).map([&](const std::string& json) {
    return Machine{name, json};
  });
}

Answer<MaterialRecord> PlanningQueue::material_named(const std::string& name) {
  Answer<MaterialRecord> found = parts_.materials.find(name);
  if (found || found.error().kind != ProblemKind::NotFound) return found;
  const std::string detail = found.error().detail;
  return tl::unexpected(invalid_value("/material", "unknown", detail, detail));
}

Answer<PlanRecord> PlanningQueue::request(const Principal& who, const PlanRequest& request) {
  if (who.role < Role::Submitter)
    return refuse(ProblemKind::Forbidden, "only a submitter may plan designs");
  return parts_.store.change([&]() -> Answer<PlanRecord> {
    if (const auto room = parts_.store.accepts_work(); !room) return tl::unexpected(room.error());
    const Answer<PlanRow> plan = plan_for(request);
    if (!plan) return tl::unexpected(plan.error());
    if (plan->state == PlanState::Pending)
      parts_.store.after_commit([this, id = plan->id] {
        hurry(id);
        pump();
      });
    return find(plan->id);
  });
}

Answer<PlanRow> PlanningQueue::plan_for(const PlanRequest& request) {
  const Answer<Design> design = parts_.designs.find(request.design);
  if (!design) {
    if (design.error().kind != ProblemKind::NotFound) return tl::unexpected(design.error());
    return tl::unexpected(invalid_value(
        "/design", "unknown", "must be the id of an uploaded design", design.error().detail));
  }
  std::string material =
      request.material.empty() ? parts_.designs.own_material(*design) : request.material;
  if (material.empty()) material = kUsualMaterial;
  const Answer<MaterialRecord> row = material_named(material);
  if (!row) return tl::unexpected(row.error());
  const Answer<Machine> machine = machine_for(request.device, request.machine);
  if (!machine) return tl::unexpected(machine.error());
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
  return find_or_add({.id = {},
                      .key = {},
                      .kind = "design",
                      .design = design->id,
                      .material = material,
                      .machine = machine->name,
                      .options = nlohmann::json(options).dump(),
                      .machine_json = machine->json,
                      .material_json = row->json});
}

Answer<PlanRow> PlanningQueue::test_plan_for(const std::string& device,
                                             const std::string& material) {
  const Answer<MaterialRecord> row = material_named(material.empty() ? kUsualMaterial : material);
  if (!row) return tl::unexpected(row.error());
  const Answer<Machine> machine = machine_for(device, "");
  if (!machine) return tl::unexpected(machine.error());
  return find_or_add({.id = {},
                      .key = {},
                      .kind = "test",
                      .design = "",
                      .material = row->id,
                      .machine = machine->name,
                      .machine_json = machine->json,
                      .material_json = row->json});
}

Answer<PlanRow> PlanningQueue::find_or_add(PlanRow row) {
  ServiceStore& store = parts_.store;
  Sha256 key;
  for (const std::string* part :
       {&row.kind, &row.design, &row.machine_json, &row.material_json, &row.options}) {
    key.add(*part);
    key.add(std::string_view("\0", 1));
  }
  row.key = key.hex();
  if (auto before = plans_.find_key(row.key)) return *before;
  const std::int64_t waiting = store.db().number("SELECT count(*) FROM plan WHERE state='pending'");
  if (waiting >= parts_.options.queue_jobs) {
    Problem full{ProblemKind::QueueFull,
                 fmt::format("{} plans are waiting; try again later", waiting)};
    full.retry_after_s = 60;
    return tl::unexpected(std::move(full));
  }
  row.id = store.new_id();
  row.created = store.now();
  plans_.insert(row);
  store.after_commit([this] { pump(); });
  return row;
}

void PlanningQueue::hurry(const std::string& plan) {
  if (hurried_.size() >= kMostHurried) return;
  hurried_.push_back(plan);
  asked_.insert(plan);
}

std::string PlanningQueue::next() {
  while (!hurried_.empty()) {
    const std::string id = hurried_.front();
    hurried_.pop_front();
    const auto plan = plans_.find(id);
    if (plan && plan->state == PlanState::Pending && !running_.contains(id)) return id;
  }
  // The first job in the queue waits for it; a job whose plan is being made is not queued any more.
  Rows first = parts_.store.db().rows(
      "SELECT job.plan FROM job JOIN plan ON plan.id=job.plan WHERE job.state='queued' AND "
      "plan.state='pending' ORDER BY job.priority DESC, job.position");
  while (first.next())
    if (!running_.contains(first.text(0))) return first.text(0);
  for (const std::string& id : plans_.pending(static_cast<int>(running_.size()) + 1))
    if (!running_.contains(id)) return id;
  return {};
}

void PlanningQueue::pump() {
  if (stopped_ || parts_.store.degraded() || parts_.store.full()) return;
  try {
    while (running_.size() < static_cast<std::size_t>(parts_.options.plans_at_once)) {
      const std::string id = next();
      if (id.empty() || !start(id)) return;
    }
  } catch (const StoreFault& fault) {
    parts_.store.note(fault);
  }
}

bool PlanningQueue::start(const std::string& id) {
  const auto plan = plans_.find(id);
  if (!plan) return false;
  PlanningTask task;
  if (plan->kind == "test") {
    task.kind = PlanningTask::Kind::TestCut;
  } else {
    const Answer<Design> design = parts_.designs.find(plan->design);
    if (!design) {
      if (design.error().kind != ProblemKind::NotFound) return false;
      fail_plan(id, "its design was deleted");
      return true;
    }
    task = parts_.designs.task_for(*design, PlanningTask::Kind::Plan);
  }
  task.machine_json = plan->machine_json;
  task.material_json = plan->material_json;
  task.options = words_of(plan->options);
  if (auto own = task.options.extract(kProfileRow)) task.profile_json = std::move(own.mapped());
  running_[id] = 0;
  // It may be over before its number is known, but what is posted runs only after this.
  running_[id] = parts_.planner.start(
      std::move(task), [this, id, folder = folder_of(id), thread = &parts_.thread,
                        alive = std::weak_ptr<void>(parts_.alive)](Result<PlanningOutcome> made) {
        auto kept =
            std::make_shared<Result<PlanningOutcome>>(with_files_kept(std::move(made), folder));
        thread->post(ServiceThread::Lane::Asking, [this, id, alive, kept] {
          if (const auto here = alive.lock()) over(id, std::move(*kept));
        });
      });
  if (begun) begun(id);
  return true;
}

void PlanningQueue::over(const std::string& id, Result<PlanningOutcome> outcome) {
  running_.erase(id);
  if (is_removed(id)) {
    remove_tree(folder_of(id));
    return pump();
  }
  if (!outcome && outcome.error().kind == ErrorKind::Unwritable) {
    // It stays pending and is made again once there is room.
    parts_.store.note_full();
    parts_.store.log(message(outcome.error()));
    return;
  }
  if (!outcome) {
    const bool unwanted = outcome.error().kind == ErrorKind::Refused;
    // Cancelled because nobody waited; if somebody does again by now, it is made again.
    if (!unwanted || !awaited(id))
      fail_plan(id, unwanted ? "it was no longer needed" : message(outcome.error()));
    return pump();
  }
  if (const std::string fault = fault_of(*outcome, parts_.options.sheets_per_job); !fault.empty()) {
    remove_tree(folder_of(id));
    fail_plan(id, fault);
    return pump();
  }
  asked_.erase(id);
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    auto plan = plans_.find(id);
    if (!plan || plan->state != PlanState::Pending) return {};
    plan->state = PlanState::Planned;
    plan->sha256 = outcome->sha256;
    plan->warnings = outcome->warnings;
    add_totals(*plan, outcome->sheets);
    plans_.finish(*plan, outcome->sheets);
    parts_.store.emit("notice", "", fmt::format(R"("plan":"{}","state":"planned")", id));
    return {};
  });
  if (stored && ended) ended(id);
  pump();
}

void PlanningQueue::fail_plan(const std::string& id, const std::string& why) {
  asked_.erase(id);
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    auto plan = plans_.find(id);
    if (!plan || plan->state != PlanState::Pending) return {};
    plan->state = PlanState::Failed;
    plan->error = why;
    plans_.finish(*plan, {});
    parts_.store.emit(
        "notice", "",
        fmt::format(R"("plan":"{}","state":"failed","error":{})", id, json_text(why)));
    return {};
  });
  if (stored && ended) ended(id);
}

void PlanningQueue::abandon(const std::string& plan) {
  const auto found = running_.find(plan);
  if (found == running_.end()) return;
  try {
    if (!awaited(plan)) parts_.planner.cancel(found->second);
  } catch (const StoreFault& fault) {
    parts_.store.note(fault);
  }
}

Answer<void> PlanningQueue::remove(const Principal& who, const std::string& id) {
  ServiceStore& store = parts_.store;
  return store.change([&]() -> Answer<void> {
    const auto plan = plans_.find(id);
    if (!plan) return refuse(ProblemKind::NotFound, fmt::format("there is no plan {:?}", id));
    const Answer<Design> design = parts_.designs.find(plan->design);
    if (who.role < Role::Operator && (!design || design->owner != who.name))
      return refuse(ProblemKind::Forbidden,
                    "only an operator may delete plans of someone else's design");
    Rows used =
        store.db().rows("SELECT id, deleted FROM job WHERE plan=? ORDER BY deleted LIMIT 1", id);
    if (used.next())
      return refuse(ProblemKind::StateConflict,
                    used.integer(1) != 0
                        ? std::string("the record of a deleted job refers to this plan; it is kept")
                        : fmt::format("job {} uses this plan; cancel the job to stop planning",
                                      used.text(0)));
    store.audit(who.name, "delete-plan", id, plan->design);
    store.emit("notice", "", fmt::format(R"("plan":"{}","state":"removed")", id));
    forget(id);
    return {};
  });
}

void PlanningQueue::remove_all_of(const std::string& design) {
  for (const std::string& id :
       all_of(parts_.store.db().rows("SELECT id FROM plan WHERE design=? AND id NOT IN (SELECT "
                                     "plan FROM job WHERE job.plan = "
                                     "plan.id)",
                                     design),
              first_text))
    forget(id);
}

void PlanningQueue::forget(const std::string& id) {
  parts_.store.db().run("DELETE FROM plan WHERE id=?", id);
  parts_.store.after_commit([this, id] {
    asked_.erase(id);
    std::erase(hurried_, id);
    // What a planner still makes of it goes when that is over.
    if (const auto found = running_.find(id); found != running_.end())
      parts_.planner.cancel(found->second);
    else
      remove_tree(folder_of(id));
  });
}

bool PlanningQueue::is_removed(const std::string& id) {
  try {
    return !plans_.find(id);
  } catch (const StoreFault& fault) {
    parts_.store.note(fault);
    return false;
  }
}

bool PlanningQueue::awaited(const std::string& plan) {
  return asked_.contains(plan) ||
         parts_.store.db().number(
             "SELECT EXISTS(SELECT 1 FROM job WHERE plan=? AND state IN ('queued', 'planning'))",
             plan) != 0;
}

Answer<PlanRecord> PlanningQueue::find(const std::string& id) {
  return parts_.store.look([&]() -> Answer<PlanRecord> {
    const auto plan = plans_.find(id);
    if (!plan) return refuse(ProblemKind::NotFound, fmt::format("there is no plan {:?}", id));
    return record_of(*plan, plans_.sheets(id));
  });
}

Answer<std::string> PlanningQueue::file(const std::string& id, const std::string& name) {
  return parts_.store.look([&]() -> Answer<std::string> {
    const auto plan = plans_.find(id);
    if (!plan) return refuse(ProblemKind::NotFound, fmt::format("there is no plan {:?}", id));
    if (plan->state != PlanState::Planned)
      return refuse(ProblemKind::StateConflict, plan->state == PlanState::Failed
                                                    ? "this plan failed: " + plan->error
                                                    : "this plan is not finished yet");
    std::string path = folder_of(id) + "/" + name;
    std::error_code ignored;
    if (!is_plain_name(name) || !std::filesystem::is_regular_file(path, ignored))
      return refuse(ProblemKind::NotFound, fmt::format("this plan has no file {:?}", name));
    return path;
  });
}

std::string index_name(int sheet) { return fmt::format("sheet-{:02}.program.json", sheet); }

}  // namespace popcut::daemon
