// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/device_registry.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "core/text/near_names.hpp"

namespace popcut::daemon {
namespace {

// What a plan may be larger than its device, for rounding.
constexpr double kAreaSlackMm = 0.05;

bool is_away(const std::string& state) { return state == "absent" || state == "offline"; }

}  // namespace

void DeviceRegistry::load() {
  Rows rows = store_.db().rows(
      "SELECT id, rev, model, title, simulated, width_mm, length_mm, enabled, sheets_done, cut_mm "
      "FROM device ORDER BY id");
  while (rows.next()) {
    DeviceRecord record;
    rows.read(0, std::tie(record.id, record.rev, record.model, record.title, record.simulated,
                          record.width_mm, record.length_mm, record.enabled, record.sheets_done,
                          record.cut_mm));
    record.state = "absent";
    entries_[record.id] = {.record = record, .machine = {}, .sessions = 0, .kept = true};
  }
}

// What the bus knows goes over what the store knows. True if anything that is shown has changed.
bool DeviceRegistry::take_in(Entry& entry, const DeviceRecord& fresh) {
  DeviceRecord& record = entry.record;
  const bool changed = record.state != fresh.state || record.reasons != fresh.reasons ||
                       record.firmware != fresh.firmware || record.model != fresh.model ||
                       record.title != fresh.title || record.width_mm != fresh.width_mm ||
                       record.length_mm != fresh.length_mm;
  // It may have been away for less time than it takes to look.
  if ((is_away(record.state) && !is_away(fresh.state)) || record.plugs != fresh.plugs)
    ++entry.sessions;
  record.plugs = fresh.plugs;
  record.state = fresh.state;
  record.reasons = fresh.reasons;
  record.firmware = fresh.firmware;
  record.model = fresh.model;
  record.title = fresh.title;
  record.simulated = fresh.simulated;
  record.width_mm = fresh.width_mm;
  record.length_mm = fresh.length_mm;
  if (entry.machine.empty())
    if (const auto machine = cutters_.machine(fresh.id)) entry.machine = machine->name;
  return changed;
}

std::vector<std::string> DeviceRegistry::refresh() {
  std::vector<std::string> gone;
  std::vector<Entry*> changed;
  std::set<std::string> listed;
  for (const DeviceRecord& fresh : cutters_.list()) {
    listed.insert(fresh.id);
    const bool is_new = !entries_.contains(fresh.id);
    Entry& entry = entries_[fresh.id];
    if (is_new) {
      entry.record.id = fresh.id;
      entry.record.rev = 0;
      entry.record.state = "absent";
      entry.record.enabled = fresh.enabled;
    }
    const bool was_there = !is_away(entry.record.state);
    if (take_in(entry, fresh) || is_new) changed.push_back(&entry);
    if (was_there && is_away(entry.record.state)) gone.push_back(fresh.id);
  }
  for (auto& [id, entry] : entries_) {
    if (listed.contains(id) || entry.record.state == "absent") continue;
    entry.record.state = "absent";
    entry.record.reasons.clear();
    changed.push_back(&entry);
    gone.push_back(id);
  }
  if (changed.empty()) return gone;
  for (Entry* entry : changed) ++entry->record.rev;
  // If it cannot be stored it is known all the same.
  (void)store_.change([&]() -> Answer<void> {
    for (Entry* entry : changed) {
      keep(*entry);
      store_.emit("device", "",
                  fmt::format(R"("device":{},"state":{},"rev":{})", json_text(entry->record.id),
                              json_text(entry->record.state), entry->record.rev));
    }
    return {};
  });
  return gone;
}

void DeviceRegistry::keep(const Entry& entry) {
  const DeviceRecord& record = entry.record;
  store_.db().put(
      "device(id, rev, model, title, simulated, width_mm, length_mm, enabled, state, sheets_done, "
      "cut_mm)",
      "id", record.id, record.rev, record.model, record.title, record.simulated, record.width_mm,
      record.length_mm, record.enabled, record.state, record.sheets_done, record.cut_mm);
}

DeviceRecord DeviceRegistry::shown(const Entry& entry) const {
  DeviceRecord record = entry.record;
  record.machine = entry.machine;
  if (const auto set_up = options_.device_materials.find(record.id);
      set_up != options_.device_materials.end())
    record.materials = set_up->second;
  return record;
}

std::vector<DeviceRecord> DeviceRegistry::list() const {
  std::vector<DeviceRecord> all;
  for (const auto& [id, entry] : entries_) all.push_back(shown(entry));
  return all;
}

std::optional<DeviceRecord> DeviceRegistry::find(const std::string& id) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return std::nullopt;
  return shown(found->second);
}

Problem DeviceRegistry::unknown(const std::string& id, const std::string& pointer) const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  const std::string advice = names.empty() ? "no cutters are known" : suggestion(id, names);
  return {ProblemKind::Validation,
          fmt::format("there is no device {:?}; {}", id, advice),
          {{pointer, "unknown", advice}}};
}

std::string DeviceRegistry::machine_of(const std::string& id) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? std::string() : found->second.machine;
}

bool DeviceRegistry::is_set_up_for(const std::string& id, const std::string& material) const {
  const auto found = options_.device_materials.find(id);
  return found != options_.device_materials.end() &&
         std::find(found->second.begin(), found->second.end(), material) != found->second.end();
}

DeviceRegistry::MachineChoice DeviceRegistry::machine_for(const std::string& material) const {
  constexpr int kForOthers = 2;
  const auto rank = [&](const std::string& id, const Entry& entry) {
    const int set_up = is_set_up_for(id, material)              ? 0
                       : options_.device_materials.contains(id) ? kForOthers
                                                                : 1;
    return std::pair(set_up, is_away(entry.record.state));
  };
  MachineChoice choice;
  std::pair<int, bool> best{kForOthers + 1, true};
  for (const auto& [id, entry] : entries_) {
    if (entry.machine.empty()) continue;
    if (const auto here = rank(id, entry); here < best)
      best = here, choice = {.device = id, .machine = entry.machine};
  }
  choice.is_set_up = best.first != kForOthers;
  for (const auto& [id, entry] : entries_)
    if (!entry.machine.empty() && entry.machine != choice.machine && rank(id, entry) == best)
      choice.others.push_back(id);
  return choice;
}

bool DeviceRegistry::wants_own_plan(const std::string& id, const PlanRow& plan) const {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.machine.empty()) return false;
  const auto materials = options_.device_materials.find(id);
  return found->second.machine != plan.machine &&
         (materials == options_.device_materials.end() || is_set_up_for(id, plan.material));
}

std::string DeviceRegistry::session_of(const std::string& id) const {
  const auto found = entries_.find(id);
  return fmt::format("{}:{}", store_.invocation(),
                     found == entries_.end() ? 0 : found->second.sessions);
}

std::string DeviceRegistry::misfit(const std::string& id, const PlanRow& plan) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return "it is unknown";
  const Entry& entry = found->second;
  if (!entry.machine.empty() && entry.machine != plan.machine)
    return fmt::format("the sheets are planned for a {}, it is a {}", plan.machine, entry.machine);
  const DeviceRecord& record = entry.record;
  if (record.width_mm > 0 && (plan.width_mm > record.width_mm + kAreaSlackMm ||
                              plan.length_mm > record.length_mm + kAreaSlackMm))
    return fmt::format("the sheets need {:g} x {:g} mm, its area is {:g} x {:g} mm", plan.width_mm,
                       plan.length_mm, record.width_mm, record.length_mm);
  const auto set_up = options_.device_materials.find(id);
  if (set_up == options_.device_materials.end() || is_set_up_for(id, plan.material)) return {};
  return fmt::format("it is set up for {}, not for {}", fmt::join(set_up->second, ", "),
                     plan.material);
}

std::vector<std::string> DeviceRegistry::fitting(const PlanRow& plan) const {
  std::vector<std::string> ids;
  for (const auto& [id, entry] : entries_)
    if (usable(id) && misfit(id, plan).empty()) ids.push_back(id);
  return ids;
}

Answer<void> DeviceRegistry::usable(const std::string& id) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return tl::unexpected(unknown(id, "/device"));
  const DeviceRecord& record = found->second.record;
  if (!record.enabled)
    return refuse(ProblemKind::StateConflict,
                  id + " is disabled; an admin can enable it with the action enable");
  const std::string reasons =
      fmt::format("{}{}", record.reasons.empty() ? "" : ": ", fmt::join(record.reasons, ", "));
  if (record.state == "fault")
    return refuse(ProblemKind::DeviceAbsent,
                  fmt::format("{} is in fault{}; fix the cause, then reset it", id, reasons));
  if (is_away(record.state))
    return refuse(ProblemKind::DeviceAbsent, fmt::format("{} is {}{}; plug it in and switch it on",
                                                         id, record.state, reasons));
  return {};
}

std::vector<Way> DeviceRegistry::cures(const std::string& id) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return {};
  if (!found->second.record.enabled) return {{.action = "enable", .body = "{}", .device = id}};
  if (found->second.record.state != "fault") return {};
  return {{.action = "reset", .body = "{}", .device = id}};
}

void DeviceRegistry::set_enabled(const std::string& id, bool enabled) {
  Entry& entry = entries_.at(id);
  if (entry.record.enabled == enabled) return;
  Entry changed = entry;
  changed.record.enabled = enabled;
  ++changed.record.rev;
  keep(changed);
  store_.emit("device", "",
              fmt::format(R"("device":{},"state":{},"enabled":{},"rev":{})", json_text(id),
                          json_text(changed.record.state), enabled, changed.record.rev));
  store_.after_commit([this, id, enabled, rev = changed.record.rev] {
    entries_.at(id).record.enabled = enabled;
    entries_.at(id).record.rev = rev;
  });
}

void DeviceRegistry::count_sheet(const std::string& id, double cut_mm, bool done) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  store_.db().run("UPDATE device SET sheets_done=sheets_done+?, cut_mm=cut_mm+? WHERE id=?", done,
                  cut_mm, id);
  store_.after_commit([this, id, cut_mm, done] {
    entries_.at(id).record.sheets_done += done ? 1 : 0;
    entries_.at(id).record.cut_mm += cut_mm;
  });
}

}  // namespace popcut::daemon
