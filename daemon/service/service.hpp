// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// A response as it is kept with an idempotency key.
struct Rendered {
  int status{200};
  std::string body;
  std::string etag{}, location{};
  bool replayed{false};
};

/// A request that may arrive twice and must take effect once.
struct IdempotentRequest {
  std::string key;     ///< empty: the request names none
  std::string sha256;  ///< of method, path, body and principal
};

/// The jobs, and everything that is lawful to ask of them. The heart of popcutd: HTTP is a shell
/// around it, the store below it is its only memory.
///
/// Every member is called on the service's thread (see `ServiceThread`), which owns the store.
/// What takes long (checking a design, planning, cutting) goes on elsewhere and comes back as an
/// event. Members that change something run in one transaction; what follows from it (starting a
/// planner, starting a knife) happens after the commit.
///
/// A database that cannot be read is told as a problem (Unavailable, Internal) where an `Answer` is
/// given. Members that give a plain value, and all of them within `once`, throw instead, something
/// derived from std::exception: callers answer 503.
class Service {
 public:
  virtual ~Service() = default;

  // Who asks
  [[nodiscard]] virtual std::optional<Principal> authenticate(std::string_view bearer) = 0;
  [[nodiscard]] virtual Answer<NewToken> create_token(const Principal&, const std::string& name,
                                                      Role role, std::optional<int> lifetime_s) = 0;
  [[nodiscard]] virtual std::vector<TokenRecord> tokens() = 0;
  [[nodiscard]] virtual Answer<void> delete_token(const Principal&, const std::string& id) = 0;
  /// A word that becomes a session's token once, within 60 s: what `popcut open` hands the page.
  [[nodiscard]] virtual Answer<std::string> create_one_shot(const Principal&) = 0;
  [[nodiscard]] virtual Answer<NewToken> open_session(const std::string& one_shot) = 0;

  /// Runs `effect` and keeps its response under the key, in one transaction; the second time the
  /// same request answers with what is kept, and `effect` does not run. A response of status 500
  /// or above, or 429, is rolled back and not kept.
  [[nodiscard]] virtual Answer<Rendered> once(const Principal&, const IdempotentRequest&,
                                              const std::function<Rendered()>& effect) = 0;

  // Designs and plans
  virtual void add_design(const Principal&, Upload, std::string media_type, std::string name,
                          std::function<void(Answer<Design>)> done) = 0;
  [[nodiscard]] virtual Answer<Asset> add_asset(const Principal&, Upload) = 0;
  [[nodiscard]] virtual Page<Design> designs(const PageWish&) = 0;
  [[nodiscard]] virtual Answer<Design> design(const std::string& id) = 0;
  /// Path of the stored bytes.
  [[nodiscard]] virtual Answer<std::string> design_content(const std::string& id) = 0;
  [[nodiscard]] virtual Answer<void> delete_design(const Principal&, const std::string& id) = 0;
  [[nodiscard]] virtual Answer<PlanRecord> plan_design(const Principal&, const PlanWish&) = 0;
  [[nodiscard]] virtual Answer<PlanRecord> plan(const std::string& id) = 0;
  /// Ends a plan that waits or is being made, removes one that was made; none that a job is of.
  [[nodiscard]] virtual Answer<void> delete_plan(const Principal&, const std::string& id) = 0;
  /// A file of a plan: "plan.json", "sheet-01.svg", "sheet-01.gpgl", "pattern.svg", "deploy.glb",
  /// "report.json", "preview.svg", "assembly.svg".
  [[nodiscard]] virtual Answer<std::string> plan_file(const std::string& id,
                                                      const std::string& name) = 0;
  /// The design's preview, drawn anew from what was read; empty bytes never.
  virtual void design_preview(const std::string& id,
                              std::function<void(Answer<std::string>)> done) = 0;

  // Jobs
  [[nodiscard]] virtual Answer<Job> create_job(const Principal&, const JobCreate&) = 0;
  [[nodiscard]] virtual Answer<Page<Job>> jobs(const JobFilter&, const PageWish&) = 0;
  [[nodiscard]] virtual Answer<Job> job(const std::string& id) = 0;
  [[nodiscard]] virtual Answer<std::vector<SheetRecord>> sheets(const std::string& job) = 0;
  [[nodiscard]] virtual Answer<Ledger> ledger(const std::string& job, int sheet) = 0;
  [[nodiscard]] virtual Answer<Job> patch_job(const Principal&, const std::string& id,
                                              std::int64_t if_match, const JobPatch&) = 0;
  [[nodiscard]] virtual Answer<Job> act(const Principal&, const std::string& id,
                                        std::int64_t if_match, const ActionWish&) = 0;
  [[nodiscard]] virtual Answer<void> delete_job(const Principal&, const std::string& id) = 0;

  // The queue
  /// Jobs that are not ended, in the order in which each device will be offered them. A page may
  /// have fewer than its limit and yet another after it.
  [[nodiscard]] virtual Answer<Page<Job>> queue(const std::string& device, const PageWish&) = 0;
  [[nodiscard]] virtual Answer<Job> hold(const Principal&, const std::string& job, bool held) = 0;
  /// Puts `job` before `before` (empty: to the end) among those of its priority.
  [[nodiscard]] virtual Answer<Job> move(const Principal&, const std::string& job,
                                         const std::string& before) = 0;

  // Devices and materials
  [[nodiscard]] virtual std::vector<DeviceRecord> devices() = 0;
  [[nodiscard]] virtual Answer<DeviceRecord> device(const std::string& id) = 0;
  /// enable, disable, reset, test-cut. Nothing moves: a test cut is a job that waits for a person.
  [[nodiscard]] virtual Answer<DeviceRecord> act_on_device(const Principal&, const std::string& id,
                                                           std::int64_t if_match,
                                                           const DeviceWish&) = 0;
  [[nodiscard]] virtual std::vector<MaterialRecord> materials() = 0;
  [[nodiscard]] virtual Answer<MaterialRecord> material(const std::string& id) = 0;
  /// `if_match` 0: it must not be there yet (If-None-Match: *).
  [[nodiscard]] virtual Answer<MaterialRecord> put_material(const Principal&, const std::string& id,
                                                            std::int64_t if_match,
                                                            const std::string& json) = 0;
  [[nodiscard]] virtual Answer<void> delete_material(const Principal&, const std::string& id,
                                                     std::int64_t if_match) = 0;

  // Events, figures, health
  [[nodiscard]] virtual Answer<std::vector<Event>> events(std::int64_t after, int limit,
                                                          const std::string& job) = 0;
  [[nodiscard]] virtual std::int64_t last_event() = 0;
  [[nodiscard]] virtual std::int64_t first_event() = 0;
  /// `listener` is called on the service's thread for each event after its commit, in order.
  virtual void listen(std::function<void(const Event&)> listener) = 0;
  [[nodiscard]] virtual std::vector<UsageRow> usage(std::optional<TimeMs> from,
                                                    std::optional<TimeMs> to,
                                                    const std::string& by) = 0;
  struct Health {
    bool database{false};
    std::uint64_t disk_free_mb{};
    bool accepts_work{false};
    std::string remark;
  };
  [[nodiscard]] virtual Health health() = 0;
  /// OpenMetrics lines of the jobs, devices and the store (HTTP adds its own).
  [[nodiscard]] virtual std::string metrics() = 0;

  // Operating it
  /// A copy of the database by VACUUM INTO; gives its path.
  [[nodiscard]] virtual Answer<std::string> backup(const Principal&) = 0;
  [[nodiscard]] virtual Answer<std::string> check_integrity(const Principal&) = 0;
};

}  // namespace popcut::daemon
