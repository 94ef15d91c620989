// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/devices/cutters.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/store/plan_table.hpp"

namespace popcut::daemon {

/// The cutters that are connected, and those that were: what the bus reports, joined with what the
/// store keeps of each. In a fleet also those of the other nodes, as these last told.
class DeviceRegistry {
 public:
  DeviceRegistry(ServiceStore& store, Cutters& cutters, const ServiceOptions& options)
      : store_(store), cutters_(cutters), options_(options) {}

  /// Reads what is kept of one's own. Once.
  void load();
  /// Reads those of the other nodes.
  void load_others();
  /// Whether another node has it.
  [[nodiscard]] bool is_elsewhere(const std::string& id) const;
  /// Why it can only be used at its node, with the way there.
  [[nodiscard]] Problem elsewhere(const std::string& id) const;
  /// Reads the cutters again; gives the ids of those that went away.
  std::vector<std::string> refresh();

  [[nodiscard]] std::vector<DeviceRecord> list() const;
  [[nodiscard]] std::optional<DeviceRecord> find(const std::string& id) const;
  /// "no device sim:x; did you mean sim:cameo3?"
  [[nodiscard]] Problem unknown(const std::string& id, const std::string& pointer) const;
  /// Name of the machine's row in the table; empty if it is not there.
  [[nodiscard]] std::string machine_of(const std::string& id) const;
  /// For which machine to plan when nobody names a device.
  struct MachineChoice {
    std::string device{}, machine{};    ///< empty: no device is known
    bool is_set_up{true};               ///< false: all devices are set up for other materials
    std::vector<std::string> others{};  ///< devices of other models that would do as well
  };
  /// A device that is set up for the material, else one that is set up for nothing special; among
  /// them one that is connected, the first by its id. Those at `site` before all others.
  [[nodiscard]] MachineChoice machine_for(const std::string& material,
                                          const std::string& site) const;
  /// Whether any device stands there.
  [[nodiscard]] bool has_site(const std::string& site) const;
  /// Why a device does not stand where a job is to be cut: "is at site a; the job is for site b";
  /// empty: it does, or the job may be cut anywhere.
  [[nodiscard]] std::string wrong_site(const std::string& id, const std::string& site) const;
  /// Changes whenever the device has been away: what was in it may have moved.
  [[nodiscard]] std::string session_of(const std::string& id) const;

  /// Whether a plan for this device would remedy why that one cannot be cut on it.
  [[nodiscard]] bool wants_own_plan(const std::string& id, const PlanRow& plan) const;
  /// Why a plan cannot be cut on a device for a job of that site (empty: any); empty: it can.
  [[nodiscard]] std::string misfit(const std::string& id, const PlanRow& plan,
                                   const std::string& site) const;
  /// Devices that are connected, enabled and suitable.
  [[nodiscard]] std::vector<std::string> fitting(const PlanRow& plan,
                                                 const std::string& site) const;
  /// Whether a sheet may be loaded there; if not, the problem.
  [[nodiscard]] Answer<void> usable(const std::string& id) const;
  /// What makes a device usable again, as far as popcutd can: empty if it is usable, or if a person
  /// must plug it in.
  [[nodiscard]] std::vector<NextAction> remedies(const std::string& id) const;

  /// In a transaction.
  void set_enabled(const std::string& id, bool enabled);
  void count_sheet(const std::string& id, double cut_mm, bool done);

 private:
  struct Entry {
    DeviceRecord record;
    std::string machine;
    int sessions{0};
    bool kept{false};        ///< there is a row of it
    bool remote{false};      ///< of another node
    std::string taken_by{};  ///< a node that has a cutter of the same id, and had it first
  };
  [[nodiscard]] static bool is_remote(const Entry& entry) { return entry.remote; }
  [[nodiscard]] const std::string& site_of(const Entry& entry) const;
  [[nodiscard]] const std::vector<std::string>* materials_of(const std::string& id) const;
  [[nodiscard]] bool is_set_up_for(const std::string& id, const std::string& material) const;
  [[nodiscard]] DeviceRecord shown(const Entry& entry) const;
  void keep(const Entry& entry);
  bool take_in(Entry& entry, const DeviceRecord& fresh);
  ServiceStore& store_;
  Cutters& cutters_;
  const ServiceOptions& options_;
  std::map<std::string, Entry> entries_;
  bool unstored_{false};  ///< what changed could not be stored yet
};

}  // namespace popcut::daemon
