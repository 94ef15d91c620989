// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// The designs that were uploaded, and the assets that their specs refer to. See `Service`.
class Designs {
 public:
  virtual ~Designs() = default;
  /// Checks the upload on a planner, which takes time; `done` is called on the service's thread.
  virtual void add(const Principal&, Upload, std::string media_type, std::string name,
                   std::function<void(Answer<Design>)> done) = 0;
  [[nodiscard]] virtual Answer<Asset> add_asset(const Principal&, const Upload&) = 0;
  [[nodiscard]] virtual Page<Design> list(const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Design> find(const std::string& id) = 0;
  /// Path of the stored bytes.
  [[nodiscard]] virtual Answer<std::string> content(const std::string& id) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// The design's preview, drawn again from what was read; never empty bytes.
  virtual void preview(const std::string& id, std::function<void(Answer<std::string>)> done) = 0;
};

/// The sheets that designs become. See `Service`.
class Plans {
 public:
  virtual ~Plans() = default;
  [[nodiscard]] virtual Answer<PlanRecord> request(const Principal&, const PlanRequest&) = 0;
  [[nodiscard]] virtual Answer<PlanRecord> find(const std::string& id) = 0;
  /// Ends a plan that waits or is being made, and removes one that was made with its files.
  ///
  /// @retval StateConflict  a job uses this plan
  /// @retval Forbidden      it is of someone else's design
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// Path of a file of a plan: "plan.json", "sheet-01.svg", "sheet-01.gpgl", "pattern.svg",
  /// "deploy.glb", "report.json", "preview.svg", "assembly.svg".
  [[nodiscard]] virtual Answer<std::string> file(const std::string& id,
                                                 const std::string& name) = 0;
};

}  // namespace popcut::daemon
