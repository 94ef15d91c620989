// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/service.hpp"

namespace popcut::daemon {

/// What the fake service holds in memory, for tests to look at and change.
class FakeState {
 public:
  FakeState();

  std::vector<std::string> asked;  ///< names of the functions that were called, as in `note`
  std::map<std::string, Job> job_map;
  std::map<std::string, Design> design_map;
  std::map<std::string, PlanRecord> plan_map;
  std::map<std::string, SearchRecord> search_map;
  std::map<std::string, DeviceRecord> device_map;
  std::map<std::string, MaterialRecord> material_map;
  std::map<std::string, TokenRecord> token_map;
  std::map<std::string, SessionRecord> session_map;
  std::map<std::string, Asset> asset_map;
  std::map<std::string, Principal> bearers;  ///< by the token's text
  std::map<std::string, std::string> files;  ///< "PLAN/name" or a design's id -> path
  std::vector<Event> log;
  std::int64_t first_kept{1};
  ActionRequest last_action{};
  JobCreate last_create{};
  JobPatch last_patch{};
  JobFilter last_filter{};
  PlanRequest last_plan{};
  CardSearchRequest last_search{};
  DeviceRequest last_device_request{};
  PageRequest last_page{};
  Upload last_upload{};
  std::string last_upload_text{};
  std::string last_upload_name{}, last_media_type{};
  bool healthy{true}, throws{false}, throws_bad_alloc{false}, drops_replies{false};
  std::optional<Problem> next_problem{};  ///< the next member that can fail fails with it
  std::int64_t made_jobs{0};
  PreviewRequest last_preview{};
  bool holds_previews{false};  ///< they wait in `held_previews` for a test to answer them
  std::vector<Designs::Shown> held_previews{};
  std::atomic<int> previews_called_off{0};
  std::string lattice_blob{"PCLB"};
  std::string preview_svg{"<svg xmlns=\"http://www.w3.org/2000/svg\"/>"};

  /// A job in state `state` that belongs to `owner`.
  Job& add_job(JobState state, const std::string& owner);
  /// Stores an event and tells it to who listens; `members` is JSON without its brackets.
  void tell(const std::string& kind, const std::string& job, const std::string& members);
  /// Tells progress, which is not stored.
  void tell_progress(const std::string& job, const std::string& members);

 protected:
  struct Kept {
    std::string sha256;
    Rendered rendered;
  };
  /// Records that a member was called; throws if `throws` is set.
  void note(const char* name);
  std::optional<Problem> failure(const char* name);
  Job& changed(Job& job);
  std::map<std::string, Kept> kept_;
  std::map<std::string, bool> one_shots_;
  std::map<std::string, std::string> pairings_;  ///< the code of each secret; empty: let in
  std::vector<std::function<void(const Event&)>> listeners_;
  std::vector<std::function<void()>> access_listeners_;
  std::int64_t seq_{0};
  int next_id_{0};
};

class FakeAccess : public Access, public virtual FakeState {
 public:
  std::optional<Principal> authenticate(std::string_view bearer) override;
  Answer<NewToken> create_token(const Principal&, const std::string& name, Role role,
                                std::optional<int> lifetime_s) override;
  std::vector<TokenRecord> tokens() override;
  Answer<void> delete_token(const Principal&, const std::string& id) override;
  std::vector<SessionRecord> sessions(const Principal&) override;
  Answer<void> end_session(const Principal&, const std::string& id) override;
  std::string title_of(const std::string& principal) override;
  std::optional<SessionRecord> session_of(const std::string& credential) override;
  Answer<void> close_session(const Principal&) override;
  void on_access_change(std::function<void()> listener) override;
  Answer<std::string> create_one_shot(const Principal&) override;
  Answer<NewToken> open_session(const std::string& one_shot) override;
  Answer<NewPairing> ask_pairing(const std::string& name, const std::string& place) override;
  Answer<AllowedPairing> allow_pairing(const Principal&, const std::string& code,
                                       Role role) override;
  Answer<std::optional<NewToken>> collect_pairing(const std::string& secret) override;
};

class FakeDesigns : public Designs, public virtual FakeState {
 public:
  void add(const Principal&, Upload, std::string media_type, std::string name,
           std::function<void(Answer<Design>)> done) override;
  Answer<Asset> add_asset(const Principal&, const Upload&) override;
  Page<Asset> assets(const Principal&, const PageRequest&) override;
  Answer<void> remove_asset(const Principal&, const std::string& id) override;
  Page<Design> list(const Principal&, const PageRequest&) override;
  Answer<Design> find(const Principal&, const std::string& id) override;
  Answer<std::string> content(const std::string& id) override;
  Answer<void> remove(const Principal&, const std::string& id) override;
  void preview(const Principal&, const std::string& id,
               std::function<void(Answer<std::string>)> done) override;
  CallOff show_spec(const Principal&, const PreviewRequest&, Shown done) override;
  CallOff place_spec(const Principal&, const PreviewRequest&, Shown done) override;
  CallOff lattice(const Principal&, const std::string& id,
                  const std::map<std::string, std::string>& reading, Shown done) override;
  std::string material_mark(const std::string&) override { return {}; }
  void picture(const Principal&, const std::string& id, const std::string& name,
               Shown done) override;
  CallOff file(const Principal&, const std::string& id, const std::string& name, int part,
               Shown done) override;
};

class FakePlans : public Plans, public virtual FakeState {
 public:
  Answer<PlanRecord> request(const Principal&, const PlanRequest&) override;
  Answer<PlanRecord> find(const std::string& id) override;
  void whole(const std::string& id, std::function<void(Answer<PlanRecord>)> done) override;
  Answer<void> remove(const Principal&, const std::string& id) override;
  Answer<std::vector<Machine>> machines() override;
  Answer<std::string> file(const std::string& id, const std::string& name) override;
  Designs::CallOff artwork(const Principal&, const std::string& id, int sheet,
                           const ArtworkRequest&, Designs::Shown done) override;
  Designs::CallOff make(const Principal&, const std::string& way, const PlanRequest&,
                        Designs::Shown done) override;
};

class FakeSearches : public Searches, public virtual FakeState {
 public:
  Answer<SearchRecord> request(const Principal&, const CardSearchRequest&) override;
  Answer<SearchRecord> find(const Principal&, const std::string& id) override;
  Page<SearchRecord> list(const Principal&, const PageRequest&) override;
  Answer<void> remove(const Principal&, const std::string& id) override;
  Answer<std::string> picture(const std::string& id, int card) override;
  Answer<std::string> lattice(const std::string& id, int card) override;
  void pick(const Principal&, const std::string& id, int card, const std::string& name,
            std::function<void(Answer<Design>)> done) override;
};

class FakeJobs : public Jobs, public virtual FakeState {
 public:
  Answer<Job> create(const Principal&, const JobCreate&) override;
  Answer<Page<Job>> list(const JobFilter&, const PageRequest&) override;
  Answer<Job> find(const std::string& id) override;
  Answer<Job> brief(const std::string& id) override;
  Answer<std::vector<SheetRecord>> sheets(const std::string& job, int first, int most) override;
  Answer<Ledger> ledger(const std::string& job, int sheet) override;
  Answer<Job> patch(const Principal&, const std::string& id, std::int64_t if_match,
                    const JobPatch&) override;
  Answer<void> remove(const Principal&, const std::string& id) override;
  Answer<Page<Job>> queue(const std::string& device, const PageRequest&) override;
  Answer<Job> hold(const Principal&, const std::string& job, bool held) override;
  Answer<Job> move(const Principal&, const std::string& job, const std::string& before) override;
};

class FakeCutting : public Cutting, public virtual FakeState {
 public:
  Answer<Job> act(const Principal&, const std::string& id, std::int64_t if_match,
                  const ActionRequest&) override;
};

class FakeDevices : public Devices, public virtual FakeState {
 public:
  std::vector<DeviceRecord> list() override;
  Answer<DeviceRecord> find(const std::string& id) override;
  Answer<DeviceRecord> act(const Principal&, const std::string& id, std::int64_t if_match,
                           const DeviceRequest&) override;
};

class FakeMaterials : public Materials, public virtual FakeState {
 public:
  std::vector<MaterialRecord> list() override;
  Answer<MaterialRecord> find(const std::string& id) override;
  Answer<MaterialRecord> put(const Principal&, const std::string& id, std::int64_t if_match,
                             const std::string& json) override;
  Answer<void> remove(const Principal&, const std::string& id, std::int64_t if_match) override;
};

class FakeOperations : public Operations, public virtual FakeState {
 public:
  Answer<Rendered> once(const Principal&, const IdempotentRequest&,
                        const std::function<Rendered()>& effect) override;
  Answer<std::vector<Event>> events(std::int64_t after, int limit, const std::string& job) override;
  std::int64_t last_event() override;
  std::int64_t first_event() override;
  void listen(std::function<void(const Event&)> listener) override;
  void usage(std::optional<TimeMs> from, std::optional<TimeMs> to, const std::string& by,
             std::function<void(Answer<std::vector<UsageRow>>)> done) override;
  ServiceHealth health() override;
  std::string metrics() override;
  void backup(const Principal&, std::function<void(Answer<std::string>)> done) override;
  void check_integrity(const Principal&, std::function<void(Answer<std::string>)> done) override;
};

/// A service that holds everything in memory and cuts nothing: what HTTP is tested against. It
/// keeps revisions, idempotency keys and events as the real one does, and knows as much of the
/// states of a job as the tests ask.
class FakeService : public FakeAccess,
                    public FakeDesigns,
                    public FakePlans,
                    public FakeSearches,
                    public FakeJobs,
                    public FakeCutting,
                    public FakeDevices,
                    public FakeMaterials,
                    public FakeOperations,
                    public Service {
 public:
  FakeService() : Service{*this, *this, *this, *this, *this, *this, *this, *this, *this} {}
};

}  // namespace popcut::daemon
