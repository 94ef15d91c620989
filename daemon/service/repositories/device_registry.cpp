// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/device_registry.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "core/text/near_names.hpp"

namespace popcut::daemon {
namespace {

// A plan may exceed the device's area by this much, because of rounding.
constexpr double kAreaSlackMm = 0.05;

bool is_away(const std::string& state) { return state == "absent" || state == "offline"; }

// A cutter that is carried to this node stays disabled, and keeps its counters. Its revision grows,
// so that no earlier ETag is valid again. Returns whether anything has changed.
bool inherit(DeviceRecord& record, const DeviceRecord& earlier) {
  if (std::tie(record.enabled, record.sheets_done, record.cut_mm) ==
          std::tie(earlier.enabled, earlier.sheets_done, earlier.cut_mm) &&
      record.rev > earlier.rev)
    return false;
  record.enabled = earlier.enabled;
  record.sheets_done = earlier.sheets_done;
  record.cut_mm = earlier.cut_mm;
  record.rev = std::max(record.rev, earlier.rev) + 1;
  return true;
}

}  // namespace

void DeviceRegistry::load() {
  Rows rows = store_.db().rows(
      "SELECT id, rev, model, title, simulated, width_mm, length_mm, enabled, sheets_done, cut_mm, "
      "node, site FROM device WHERE node=? ORDER BY id",
      store_.node().name);
  while (rows.next()) {
    DeviceRecord record;
    rows.read(0, std::tie(record.id, record.rev, record.model, record.title, record.simulated,
                          record.width_mm, record.length_mm, record.enabled, record.sheets_done,
                          record.cut_mm, record.node, record.site));
    record.state = "absent";
    // The site was changed in the configuration: store it, because other nodes read it from the
    // database.
    if (record.site != options_.fleet.site) {
      unstored_ = true;
      ++record.rev;
    }
    Entry& entry = entries_[record.id];
    entry = {.record = record, .machine = {}, .sessions = entry.sessions};
  }
}

void DeviceRegistry::load_others() {
  std::set<std::string> seen;
  Rows rows = store_.db().rows(
      "SELECT device.id, rev, model, title, simulated, width_mm, length_mm, enabled, sheets_done, "
      "cut_mm, node, state, reasons, firmware, machine, materials, site, node.url, "
      "node.lease_until>clock_timestamp() FROM device LEFT JOIN node ON node.name=device.node "
      "WHERE "
      "device.node!=? ORDER BY device.id",
      store_.node().name);
  while (rows.next()) {
    DeviceRecord record;
    std::string reasons, machine, materials, url;
    bool lives = false;
    rows.read(0, std::tie(record.id, record.rev, record.model, record.title, record.simulated,
                          record.width_mm, record.length_mm, record.enabled, record.sheets_done,
                          record.cut_mm, record.node, record.state, reasons, record.firmware,
                          machine, materials, record.site, url, lives));
    seen.insert(record.id);
    record.reasons = list_from_json(reasons);
    if (!materials.empty()) record.materials = list_from_json(materials);
    record.node_url = url;
    if (!lives && !is_away(record.state)) {
      record.state = "offline";
      record.reasons = {fmt::format("node {} does not answer", record.node)};
    }
    Entry& entry = entries_[record.id];
    // If a device of this id is plugged in here, keep its entry. If not, it was carried to the
    // other node.
    const bool is_here =
        !entry.record.id.empty() && !entry.is_remote && entry.record.state != "absent";
    if (is_here) {
      // If the other node does not answer, or the device is unplugged there, only this node has it.
      const std::string taken_by = is_away(record.state) ? std::string() : record.node;
      if (taken_by.empty() && !entry.taken_by.empty()) unstored_ = true;
      if (taken_by.empty() && inherit(entry.record, record)) unstored_ = true;
      entry.taken_by = taken_by;
      continue;
    }
    entry = {.record = std::move(record), .machine = machine, .sessions = 0, .is_remote = true};
  }
  std::erase_if(entries_,
                [&](const auto& one) { return one.second.is_remote && !seen.contains(one.first); });
}

bool DeviceRegistry::is_elsewhere(const std::string& id) const {
  const auto found = entries_.find(id);
  return found != entries_.end() && found->second.is_remote;
}

Problem DeviceRegistry::elsewhere(const std::string& id, std::string_view advice) const {
  const DeviceRecord& record = entries_.at(id).record;
  return {ProblemKind::StateConflict,
          fmt::format("{} is at {}; {}{}{}", id, record.node, advice,
                      record.node_url.empty() ? "" : ": ", record.node_url)};
}

const std::string& DeviceRegistry::site_of(const Entry& entry) const {
  return entry.is_remote ? entry.record.site : options_.fleet.site;
}

bool DeviceRegistry::has_site(const std::string& site) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const auto& one) { return site_of(one.second) == site; });
}

std::string DeviceRegistry::wrong_site(const std::string& id, const std::string& site) const {
  const auto found = entries_.find(id);
  if (site.empty() || found == entries_.end() || site_of(found->second) == site) return {};
  const std::string& here = site_of(found->second);
  return fmt::format("is at {}{}; the job is for site {}", here.empty() ? "no site" : "site ", here,
                     site);
}

const std::vector<std::string>* DeviceRegistry::materials_of(const std::string& id) const {
  if (const auto found = entries_.find(id); found != entries_.end() && found->second.is_remote)
    return found->second.record.materials.empty() ? nullptr : &found->second.record.materials;
  const auto set_up = options_.device_materials.find(id);
  return set_up == options_.device_materials.end() ? nullptr : &set_up->second;
}

// Copies what `Cutters` reports. True if anything has changed that people see.
bool DeviceRegistry::update_entry(Entry& entry, const DeviceRecord& fresh) {
  DeviceRecord& record = entry.record;
  const bool changed = record.state != fresh.state || record.reasons != fresh.reasons ||
                       record.firmware != fresh.firmware || record.model != fresh.model ||
                       record.title != fresh.title || record.width_mm != fresh.width_mm ||
                       record.length_mm != fresh.length_mm;
  // `plugs` also shows that it was away between two calls.
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
    if (!is_new && entry.is_remote) {
      // It was carried here from another node, or two cutters have the same id.
      const DeviceRecord before = std::move(entry.record);
      entry = {};
      entry.record.id = fresh.id;
      entry.record.state = "absent";
      (void)inherit(entry.record, before);
      if (!is_away(before.state)) entry.taken_by = before.node;
    }
    if (is_new) {
      entry.record.id = fresh.id;
      entry.record.rev = 0;
      entry.record.state = "absent";
      entry.record.enabled = fresh.enabled;
    }
    const bool was_there = !is_away(entry.record.state);
    const int session = entry.sessions;
    if (update_entry(entry, fresh) || is_new) changed.push_back(&entry);
    // With another session it was away for a moment, in which its sheet may have moved.
    if (was_there && (is_away(entry.record.state) || entry.sessions != session))
      gone.push_back(fresh.id);
  }
  for (auto& [id, entry] : entries_) {
    if (listed.contains(id) || entry.record.state == "absent" || entry.is_remote) continue;
    entry.record.state = "absent";
    entry.record.reasons.clear();
    changed.push_back(&entry);
    gone.push_back(id);
  }
  if (!unstored_ && changed.empty()) return gone;
  for (Entry* entry : changed) ++entry->record.rev;
  if (unstored_)
    for (auto& [id, entry] : entries_)
      if (!entry.is_remote && std::find(changed.begin(), changed.end(), &entry) == changed.end())
        changed.push_back(&entry);
  // If this cannot be stored, the next call stores all devices of this node.
  const Answer<void> stored = store_.change([&]() -> Answer<void> {
    for (Entry* entry : changed) {
      store_entry(*entry);
      store_.emit("device", "",
                  JsonObject()
                      .text("device", entry->record.id)
                      .text("state", entry->record.state)
                      .number("rev", entry->record.rev));
    }
    return {};
  });
  unstored_ = !stored;
  return gone;
}

void DeviceRegistry::store_entry(const Entry& entry) {
  const DeviceRecord& record = entry.record;
  if (!entry.taken_by.empty()) return;
  const auto* const materials = materials_of(record.id);
  store_.db().put(
      "device(id, rev, model, title, simulated, width_mm, length_mm, enabled, state, sheets_done, "
      "cut_mm, node, machine, materials, reasons, firmware, site)",
      "id", record.id, record.rev, record.model, record.title, record.simulated, record.width_mm,
      record.length_mm, record.enabled, record.state, record.sheets_done, record.cut_mm,
      store_.node().name, entry.machine, materials == nullptr ? "" : json_list(*materials),
      json_list(record.reasons), record.firmware, options_.fleet.site);
}

DeviceRecord DeviceRegistry::shown(const Entry& entry) const {
  DeviceRecord record = entry.record;
  record.machine = entry.machine;
  if (!entry.is_remote) record.node = store_.node().name;
  record.site = site_of(entry);
  if (const auto* const materials = materials_of(record.id)) record.materials = *materials;
  if (!entry.taken_by.empty()) {
    record.state = "fault";
    record.reasons = {fmt::format("node {} has a cutter of this id, too", entry.taken_by)};
  }
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
  const auto* const set_up = materials_of(id);
  return set_up != nullptr && std::find(set_up->begin(), set_up->end(), material) != set_up->end();
}

DeviceRegistry::MachineChoice DeviceRegistry::machine_for(const std::string& material,
                                                          const std::string& site) const {
  constexpr int kForOthers = 2;
  const auto rank = [&](const std::string& id, const Entry& entry) {
    const int set_up = is_set_up_for(id, material)   ? 0
                       : materials_of(id) != nullptr ? kForOthers
                                                     : 1;
    return std::tuple(!wrong_site(id, site).empty(), set_up, is_away(entry.record.state));
  };
  MachineChoice choice;
  std::tuple<bool, int, bool> best{true, kForOthers + 1, true};
  for (const auto& [id, entry] : entries_) {
    if (entry.machine.empty()) continue;
    if (const auto here = rank(id, entry); here < best)
      best = here, choice = {.device = id, .machine = entry.machine};
  }
  choice.is_set_up = std::get<1>(best) != kForOthers;
  for (const auto& [id, entry] : entries_)
    if (!entry.machine.empty() && entry.machine != choice.machine && rank(id, entry) == best)
      choice.others.push_back(id);
  return choice;
}

bool DeviceRegistry::needs_other_plan(const std::string& id, const PlanRow& plan) const {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.machine.empty()) return false;
  return found->second.machine != plan.machine &&
         (materials_of(id) == nullptr || is_set_up_for(id, plan.material));
}

std::string DeviceRegistry::session_of(const std::string& id) const {
  const auto found = entries_.find(id);
  return fmt::format("{}:{}", store_.invocation(),
                     found == entries_.end() ? 0 : found->second.sessions);
}

std::string DeviceRegistry::misfit(const std::string& id, const PlanRow& plan,
                                   const std::string& site) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return "it is unknown";
  if (const std::string why = wrong_site(id, site); !why.empty()) return "it " + why;
  const Entry& entry = found->second;
  if (!entry.machine.empty() && entry.machine != plan.machine)
    return fmt::format("the sheets are planned for a {}, it is a {}", plan.machine, entry.machine);
  const DeviceRecord& record = entry.record;
  if (record.width_mm > 0 && (plan.width_mm > record.width_mm + kAreaSlackMm ||
                              plan.length_mm > record.length_mm + kAreaSlackMm))
    return fmt::format("the sheets need {:g} x {:g} mm, its area is {:g} x {:g} mm", plan.width_mm,
                       plan.length_mm, record.width_mm, record.length_mm);
  const auto* const set_up = materials_of(id);
  if (set_up == nullptr || is_set_up_for(id, plan.material)) return {};
  return fmt::format("it is set up for {}, not for {}", fmt::join(*set_up, ", "), plan.material);
}

std::vector<std::string> DeviceRegistry::fitting(const PlanRow& plan,
                                                 const std::string& site) const {
  std::vector<std::string> ids;
  for (const auto& [id, entry] : entries_)
    if (usable(id) && misfit(id, plan, site).empty()) ids.push_back(id);
  return ids;
}

Answer<void> DeviceRegistry::usable(const std::string& id) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return tl::unexpected(unknown(id, "/device"));
  const DeviceRecord& record = found->second.record;
  if (found->second.is_remote) return tl::unexpected(elsewhere(id));
  if (!found->second.taken_by.empty())
    return refuse(ProblemKind::StateConflict,
                  fmt::format("node {} has a cutter of the id {}, too; unplug one of them, or give "
                              "one another id in its configuration",
                              found->second.taken_by, id));
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

std::vector<NextAction> DeviceRegistry::remedies(const std::string& id) const {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.is_remote) return {};
  if (!found->second.record.enabled) return {{.action = "enable", .device = id}};
  if (found->second.record.state != "fault") return {};
  return {{.action = "reset", .device = id}};
}

void DeviceRegistry::set_enabled(const std::string& id, bool enabled) {
  Entry& entry = entries_.at(id);
  if (entry.record.enabled == enabled) return;
  Entry changed = entry;
  changed.record.enabled = enabled;
  ++changed.record.rev;
  store_entry(changed);
  store_.emit("device", "",
              JsonObject()
                  .text("device", id)
                  .text("state", changed.record.state)
                  .flag("enabled", enabled)
                  .number("rev", changed.record.rev));
  store_.after_commit_before_events([this, id, enabled, rev = changed.record.rev] {
    entries_.at(id).record.enabled = enabled;
    entries_.at(id).record.rev = rev;
  });
}

void DeviceRegistry::count_sheet(const std::string& id, double cut_mm, bool done) {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  store_.db().later("UPDATE device SET sheets_done=sheets_done+?, cut_mm=cut_mm+? WHERE id=?", done,
                    cut_mm, id);
  store_.after_commit([this, id, cut_mm, done] {
    entries_.at(id).record.sheets_done += done ? 1 : 0;
    entries_.at(id).record.cut_mm += cut_mm;
  });
}

}  // namespace popcut::daemon
