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
/// store keeps of each.
class DeviceRegistry {
 public:
  DeviceRegistry(ServiceStore& store, Cutters& cutters, const ServiceOptions& options)
      : store_(store), cutters_(cutters), options_(options) {}

  /// Reads what is kept. Once.
  void load();
  /// Reads the cutters again; gives the ids of those that went away.
  std::vector<std::string> refresh();

  [[nodiscard]] std::vector<DeviceRecord> list() const;
  [[nodiscard]] std::optional<DeviceRecord> find(const std::string& id) const;
  /// "no device sim:x; did you mean sim:cameo3?"
  [[nodiscard]] Problem unknown(const std::string& id, const std::string& pointer) const;
  /// Name of the machine's row in the table; empty if it is not there.
  [[nodiscard]] std::string machine_of(const std::string& id) const;
  /// The machine of the first connected device.
  [[nodiscard]] std::string first_machine() const;
  /// Changes whenever the device has been away: what was in it may have moved.
  [[nodiscard]] std::string session_of(const std::string& id) const;

  /// Why a plan cannot be cut on a device; empty: it can.
  [[nodiscard]] std::string misfit(const std::string& id, const PlanRow& plan) const;
  /// Devices that are connected, enabled and suitable.
  [[nodiscard]] std::vector<std::string> fitting(const PlanRow& plan) const;
  /// Whether a sheet may be loaded there; if not, the problem.
  [[nodiscard]] Answer<void> usable(const std::string& id) const;
  /// What makes a device usable again, as far as popcutd can: empty if it is usable, or if a person
  /// must plug it in.
  [[nodiscard]] std::vector<Way> cures(const std::string& id) const;

  /// In a transaction.
  void set_enabled(const std::string& id, bool enabled);
  void count_sheet(const std::string& id, double cut_mm, bool done);

 private:
  struct Entry {
    DeviceRecord record;
    std::string machine;
    int sessions{0};
    bool kept{false};  ///< there is a row of it
  };
  [[nodiscard]] DeviceRecord shown(const Entry& entry) const;
  void keep(const Entry& entry);
  bool take_in(Entry& entry, const DeviceRecord& fresh);
  ServiceStore& store_;
  Cutters& cutters_;
  const ServiceOptions& options_;
  std::map<std::string, Entry> entries_;
};

}  // namespace popcut::daemon
