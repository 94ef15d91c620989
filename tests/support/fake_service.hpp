// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/service.hpp"

namespace popcut::daemon {

/// A service in memory that cuts nothing, for tests of HTTP. It keeps revisions, idempotency keys
/// and events like the real one, and as much of a job's states as the tests need.
class FakeService : public Service {
 public:
  FakeService();

  // What tests look at and change. `asked` holds the names of the members that were called.
  std::vector<std::string> asked;
  std::map<std::string, Job> job_map;
  std::map<std::string, Design> design_map;
  std::map<std::string, PlanRecord> plan_map;
  std::map<std::string, DeviceRecord> device_map;
  std::map<std::string, MaterialRecord> material_map;
  std::map<std::string, TokenRecord> token_map;
  std::map<std::string, Principal> bearers;  ///< by the token's text
  std::map<std::string, std::string> files;  ///< "PLAN/name" or a design's id -> path
  std::vector<Event> log;
  std::int64_t first_kept{1};
  ActionWish last_action{};
  JobCreate last_create{};
  JobPatch last_patch{};
  JobFilter last_filter{};
  PlanWish last_plan{};
  DeviceWish last_device_wish{};
  PageWish last_page{};
  Upload last_upload{};
  std::string last_upload_text{};
  std::string last_upload_name{}, last_media_type{};
  bool healthy{true}, throws{false}, throws_bad_alloc{false}, drops_replies{false};
  std::optional<Problem> next_problem{};  ///< the next member that can fail fails with it
  std::int64_t made_jobs{0};
  std::string preview{"<svg xmlns=\"http://www.w3.org/2000/svg\"/>"};

  /// A job in state `state` that belongs to `owner`.
  Job& add_job(JobState state, const std::string& owner);
  /// Stores an event and tells it to who listens; `members` is JSON without its brackets.
  void tell(const std::string& kind, const std::string& job, const std::string& members);
  /// Tells progress, which is not stored.
  void tell_progress(const std::string& job, const std::string& members);

  std::optional<Principal> authenticate(std::string_view bearer) override;
  Answer<NewToken> create_token(const Principal&, const std::string& name, Role role,
                                std::optional<int> lifetime_s) override;
  std::vector<TokenRecord> tokens() override;
  Answer<void> delete_token(const Principal&, const std::string& id) override;
  Answer<std::string> create_one_shot(const Principal&) override;
  Answer<NewToken> open_session(const std::string& one_shot) override;
  Answer<Rendered> once(const Principal&, const IdempotentRequest&,
                        const std::function<Rendered()>& effect) override;
  void add_design(const Principal&, Upload, std::string media_type, std::string name,
                  std::function<void(Answer<Design>)> done) override;
  Answer<Asset> add_asset(const Principal&, Upload) override;
  Page<Design> designs(const PageWish&) override;
  Answer<Design> design(const std::string& id) override;
  Answer<std::string> design_content(const std::string& id) override;
  Answer<void> delete_design(const Principal&, const std::string& id) override;
  Answer<PlanRecord> plan_design(const Principal&, const PlanWish&) override;
  Answer<PlanRecord> plan(const std::string& id) override;
  Answer<void> delete_plan(const Principal&, const std::string& id) override;
  Answer<std::string> plan_file(const std::string& id, const std::string& name) override;
  void design_preview(const std::string& id,
                      std::function<void(Answer<std::string>)> done) override;
  Answer<Job> create_job(const Principal&, const JobCreate&) override;
  Answer<Page<Job>> jobs(const JobFilter&, const PageWish&) override;
  Answer<Job> job(const std::string& id) override;
  Answer<std::vector<SheetRecord>> sheets(const std::string& job) override;
  Answer<Ledger> ledger(const std::string& job, int sheet) override;
  Answer<Job> patch_job(const Principal&, const std::string& id, std::int64_t if_match,
                        const JobPatch&) override;
  Answer<Job> act(const Principal&, const std::string& id, std::int64_t if_match,
                  const ActionWish&) override;
  Answer<void> delete_job(const Principal&, const std::string& id) override;
  Answer<Page<Job>> queue(const std::string& device, const PageWish&) override;
  Answer<Job> hold(const Principal&, const std::string& job, bool held) override;
  Answer<Job> move(const Principal&, const std::string& job, const std::string& before) override;
  std::vector<DeviceRecord> devices() override;
  Answer<DeviceRecord> device(const std::string& id) override;
  Answer<DeviceRecord> act_on_device(const Principal&, const std::string& id, std::int64_t if_match,
                                     const DeviceWish&) override;
  std::vector<MaterialRecord> materials() override;
  Answer<MaterialRecord> material(const std::string& id) override;
  Answer<MaterialRecord> put_material(const Principal&, const std::string& id,
                                      std::int64_t if_match, const std::string& json) override;
  Answer<void> delete_material(const Principal&, const std::string& id,
                               std::int64_t if_match) override;
  Answer<std::vector<Event>> events(std::int64_t after, int limit, const std::string& job) override;
  std::int64_t last_event() override;
  std::int64_t first_event() override;
  void listen(std::function<void(const Event&)> listener) override;
  std::vector<UsageRow> usage(std::optional<TimeMs> from, std::optional<TimeMs> to,
                              const std::string& by) override;
  Health health() override;
  std::string metrics() override;
  Answer<std::string> backup(const Principal&) override;
  Answer<std::string> check_integrity(const Principal&) override;

 private:
  struct Kept {
    std::string sha256;
    Rendered rendered;
  };
  /// Records that a member was called; throws if `throws` is set.
  void note(const char* name);
  std::optional<Problem> trouble(const char* name);
  Job& changed(Job& job);
  std::map<std::string, Kept> kept_;
  std::map<std::string, bool> one_shots_;
  std::vector<std::function<void(const Event&)>> listeners_;
  std::int64_t seq_{0};
  int next_id_{0};
};

}  // namespace popcut::daemon
