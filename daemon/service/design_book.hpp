// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/memory.hpp"

namespace popcut::daemon {

/// Designs and what they refer to: files named by the digest of their bytes, and a row for each.
class DesignBook {
 public:
  DesignBook(Memory& memory, ServiceThread& thread, Planner& planner, std::shared_ptr<void> alive)
      : memory_(memory), thread_(thread), planner_(planner), alive_(std::move(alive)) {}

  using Added = std::function<void(Answer<Design>)>;
  void add(const Principal& who, Upload upload, std::string media_type, std::string name,
           Added done);
  [[nodiscard]] Answer<Asset> add_asset(const Principal& who, const Upload& upload);
  [[nodiscard]] Page<Design> list(const PageWish& wish);
  [[nodiscard]] Answer<Design> find(const std::string& id);
  [[nodiscard]] Answer<std::string> content(const std::string& id);
  [[nodiscard]] Answer<void> remove(const Principal& who, const std::string& id);
  void preview(const std::string& id, std::function<void(Answer<std::string>)> done);

  /// The task of a planner for a design that is there: its bytes, kind and assets.
  [[nodiscard]] PlanningTask task_for(const Design& design, PlanningTask::Kind kind);
  /// The material that a spec names; empty: none.
  [[nodiscard]] std::string own_material(const Design& design);

 private:
  void checked(const Principal& who, const Upload& upload, const std::string& media_type,
               const std::string& name, Result<PlanningOutcome> outcome, const Added& done);
  [[nodiscard]] Answer<Design> store(const Principal& who, const Upload& upload,
                                     const std::string& media_type, const std::string& name,
                                     const PlanningOutcome& outcome);
  [[nodiscard]] std::optional<Design> row(const std::string& id, std::string* media_type = nullptr);
  [[nodiscard]] std::map<std::string, std::string> referred_assets(const std::string& path,
                                                                   const std::string& media_type);
  Memory& memory_;
  ServiceThread& thread_;
  Planner& planner_;
  std::shared_ptr<void> alive_;
};

/// Text that people gave: no control characters, at most so many bytes.
[[nodiscard]] Answer<void> check_text(const std::string& text, std::size_t most,
                                      const std::string& pointer, bool lines_allowed = false);

}  // namespace popcut::daemon
