// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// The cutters. See `Service`.
class Devices {
 public:
  virtual ~Devices() = default;
  /// All, each with the job whose sheet lies in it.
  [[nodiscard]] virtual std::vector<DeviceRecord> list() = 0;
  [[nodiscard]] virtual Answer<DeviceRecord> find(const std::string& id) = 0;
  /// enable, disable, reset, test-cut. Nothing moves: a test cut is a job that waits for a person.
  [[nodiscard]] virtual Answer<DeviceRecord> act(const Principal&, const std::string& id,
                                                 std::int64_t if_match, const DeviceRequest&) = 0;
};

/// The materials: built-in ones, those of users' tables, and those that were stored. See `Service`.
class Materials {
 public:
  virtual ~Materials() = default;
  [[nodiscard]] virtual std::vector<MaterialRecord> list() = 0;
  [[nodiscard]] virtual Answer<MaterialRecord> find(const std::string& id) = 0;
  /// `if_match` 0: it must not exist yet (If-None-Match: *).
  [[nodiscard]] virtual Answer<MaterialRecord> put(const Principal&, const std::string& id,
                                                   std::int64_t if_match,
                                                   const std::string& json) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id,
                                            std::int64_t if_match) = 0;
};

}  // namespace popcut::daemon
