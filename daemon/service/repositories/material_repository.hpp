// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/service.hpp"
#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// The material if a request names none.
inline constexpr const char* kUsualMaterial = "paper-220";

/// The tables of materials, machines and SVG profiles: the built-in ones, users' own, and materials
/// that were added by a request. Rows are complete: what a row inherits by "like" is filled in.
class MaterialRepository : public Materials {
 public:
  MaterialRepository(ServiceStore& store, const ServiceOptions& options)
      : store_(store), options_(options) {}

  std::vector<MaterialRecord> list() override;
  Answer<MaterialRecord> find(const std::string& id) override;
  Answer<MaterialRecord> put(const Principal& who, const std::string& id, std::int64_t if_match,
                             const std::string& json) override;
  Answer<void> remove(const Principal& who, const std::string& id, std::int64_t if_match) override;
  /// The row of a machine as JSON.
  [[nodiscard]] Answer<std::string> machine_row(const std::string& name);
  /// The row of an SVG profile of a user's table as JSON; empty if no such table has it.
  [[nodiscard]] std::string profile_row(const std::string& name);

 private:
  /// Reads the built-in tables and users' tables, once.
  void load_tables();
  /// The materials of these tables.
  const std::map<std::string, std::string>& materials();
  [[nodiscard]] std::optional<MaterialRecord> stored(const std::string& id);
  ServiceStore& store_;
  const ServiceOptions& options_;
  std::map<std::string, std::string> materials_, machines_, profiles_;
  bool loaded_{false};
};

}  // namespace popcut::daemon
