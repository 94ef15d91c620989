// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/devices/cutters.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/store/plan_table.hpp"

namespace popcut::daemon {

/// The cutters that are connected, and those that were. Joins what `Cutters` reports of each with
/// what is stored. In a fleet it also has the cutters of other nodes, as these nodes last stored
/// them.
class DeviceRegistry {
 public:
  DeviceRegistry(ServiceStore& store, Cutters& cutters, const ServiceOptions& options)
      : store_(store), cutters_(cutters), options_(options) {}

  /// Reads what the store keeps of the devices of this node. Call this when the service begins, and
  /// again only if the store failed meanwhile.
  void load();
  /// In a fleet: reads the devices of the other nodes.
  void load_others();
  /// Whether the device is at another node.
  [[nodiscard]] bool is_elsewhere(const std::string& id) const;
  /// The problem for an action that only the device's own node may do. It names that node.
  ///
  /// @param advice  what to do there
  [[nodiscard]] Problem elsewhere(
      const std::string& id,
      std::string_view advice = "only a person there may arm, start and resume") const;
  /// Reads the cutters again. Returns the ids of those that went away, and of those that were away
  /// for a moment since the last call.
  std::vector<std::string> refresh();

  [[nodiscard]] std::vector<DeviceRecord> list() const;
  [[nodiscard]] std::optional<DeviceRecord> find(const std::string& id) const;
  /// "there is no device sim:x; did you mean sim:cameo3?"
  [[nodiscard]] Problem unknown(const std::string& id, const std::string& pointer) const;
  /// The name of its machine in the table; empty if the table does not have it.
  [[nodiscard]] std::string machine_of(const std::string& id) const;
  /// The machine to plan for if a request names no device.
  struct MachineChoice {
    std::string device{}, machine{};    ///< empty: no device is known
    bool is_set_up{true};               ///< false: all devices are set up for other materials
    std::vector<std::string> others{};  ///< equally suitable devices of other models
  };
  /// Prefers, in this order: a device at `site`; one that is set up for the material, else one that
  /// is set up for no special material; one that is connected; the first by id.
  [[nodiscard]] MachineChoice machine_for(const std::string& material,
                                          const std::string& site) const;
  /// Whether any device is at this site.
  [[nodiscard]] bool has_site(const std::string& site) const;
  /// Why a job of `site` cannot use a device: "is at site a; the job is for site b"; empty: it can,
  /// or the job may be cut anywhere.
  [[nodiscard]] std::string wrong_site(const std::string& id, const std::string& site) const;
  /// An id that changes when the device was away, because its sheet may have moved then.
  [[nodiscard]] std::string session_of(const std::string& id) const;

  /// Whether the device cannot cut this plan, but could cut the design with a plan for its machine.
  [[nodiscard]] bool needs_other_plan(const std::string& id, const PlanRow& plan) const;
  /// Why a device cannot cut a plan; empty: it can.
  ///
  /// @param site  of the job; empty: any site
  [[nodiscard]] std::string misfit(const std::string& id, const PlanRow& plan,
                                   const std::string& site) const;
  /// Devices that are connected, enabled and suitable.
  [[nodiscard]] std::vector<std::string> fitting(const PlanRow& plan,
                                                 const std::string& site) const;
  /// Refuses unless a sheet may be loaded into the device.
  [[nodiscard]] Answer<void> usable(const std::string& id) const;
  /// Requests that make a device usable again. None if it is usable, if a person must plug it in,
  /// or if it is at another node, which alone may do this.
  [[nodiscard]] std::vector<NextAction> remedies(const std::string& id) const;

  /// In a transaction.
  void set_enabled(const std::string& id, bool enabled);
  void count_sheet(const std::string& id, double cut_mm, bool done);

 private:
  struct Entry {
    DeviceRecord record;
    std::string machine;
    int sessions{0};
    bool is_remote{false};   ///< it is at another node
    std::string taken_by{};  ///< another node that has a cutter of the same id, and had it first
  };
  [[nodiscard]] const std::string& site_of(const Entry& entry) const;
  [[nodiscard]] const std::vector<std::string>* materials_of(const std::string& id) const;
  [[nodiscard]] bool is_set_up_for(const std::string& id, const std::string& material) const;
  [[nodiscard]] DeviceRecord shown(const Entry& entry) const;
  void store_entry(const Entry& entry);
  bool update_entry(Entry& entry, const DeviceRecord& fresh);
  ServiceStore& store_;
  Cutters& cutters_;
  const ServiceOptions& options_;
  std::map<std::string, Entry> entries_;
  bool unstored_{false};  ///< a change could not be stored yet
};

}  // namespace popcut::daemon
