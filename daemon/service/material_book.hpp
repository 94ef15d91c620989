// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/memory.hpp"

namespace popcut::daemon {

/// The tables of materials, machines and SVG profiles: the built-in ones, users' own, and the
/// materials that were put into the store. Rows are whole: what a row inherits by "like" is filled
/// in.
class MaterialBook {
 public:
  MaterialBook(Memory& memory, const ServiceOptions& options)
      : memory_(memory), options_(options) {}

  [[nodiscard]] std::vector<MaterialRecord> list();
  [[nodiscard]] Answer<MaterialRecord> find(const std::string& id);
  [[nodiscard]] Answer<MaterialRecord> put(const Principal& who, const std::string& id,
                                           std::int64_t if_match, const std::string& json);
  [[nodiscard]] Answer<void> remove(const Principal& who, const std::string& id,
                                    std::int64_t if_match);
  /// The row of a machine as JSON.
  [[nodiscard]] Answer<std::string> machine_row(const std::string& name);
  /// The row of an SVG profile of a user's table as JSON; empty for one that is built in, or none.
  [[nodiscard]] std::string profile_row(const std::string& name);

 private:
  const std::map<std::string, std::string>& built_in();
  [[nodiscard]] std::optional<MaterialRecord> stored(const std::string& id);
  Memory& memory_;
  const ServiceOptions& options_;
  std::map<std::string, std::string> materials_, machines_, profiles_;
  bool loaded_{false};
};

}  // namespace popcut::daemon
