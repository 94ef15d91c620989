// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"
#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// Who may use the service: the tokens of programs and the sessions of pages. Each session has a
/// root: the token, or the user of this system, from which it comes. See `Service`.
class Access {
 public:
  virtual ~Access() = default;
  /// The owner of a token; nothing if it is unknown or has expired.
  [[nodiscard]] virtual std::optional<Principal> authenticate(std::string_view bearer) = 0;
  [[nodiscard]] virtual Answer<NewToken> create_token(const Principal&, const std::string& name,
                                                      Role role, std::optional<int> lifetime_s) = 0;
  [[nodiscard]] virtual std::vector<TokenRecord> tokens() = 0;
  [[nodiscard]] virtual Answer<void> delete_token(const Principal&, const std::string& id) = 0;
  /// The sessions that are valid now: all of them for an admin, else those of the same root.
  [[nodiscard]] virtual std::vector<SessionRecord> sessions(const Principal&) = 0;
  /// Ends a session, and the sessions that it opened.
  /// @retval NotFound  there is no such session, or it belongs to someone else
  [[nodiscard]] virtual Answer<void> end_session(const Principal&, const std::string& id) = 0;
  /// What people call a principal: the name of a token, or the login name of a user. Without one,
  /// the principal itself.
  [[nodiscard]] virtual std::string title_of(const std::string& principal) = 0;
  /// The session with this id; nothing if the id is that of a token.
  [[nodiscard]] virtual std::optional<SessionRecord> session_of(const std::string& credential) = 0;
  /// Ends the session, or deletes the token, of the request.
  /// @retval NotFound  the request came over the unix socket and has neither
  [[nodiscard]] virtual Answer<void> close_session(const Principal&) = 0;
  /// Calls `listener` on the service's thread when credentials have ended or have another role.
  virtual void on_access_change(std::function<void()> listener) = 0;
  /// A code that opens one session within 60 s: `popcut open` gives it to the page. Expires with
  /// the credential that requested it.
  [[nodiscard]] virtual Answer<std::string> create_one_shot(const Principal&) = 0;
  [[nodiscard]] virtual Answer<NewToken> open_session(const std::string& one_shot) = 0;
  /// Starts to pair a tablet, which then waits five minutes for a person to type its code. At most
  /// twenty tablets wait. One more replaces the oldest of the address from which most of them wait.
  ///
  /// @param place  the address of the tablet
  /// @retval Unavailable  twenty wait already, no two of them from one address
  [[nodiscard]] virtual Answer<NewPairing> ask_pairing(const std::string& name,
                                                       const std::string& place) = 0;
  /// Allows the tablet that shows `code` to open one session, with at most `role`. The session gets
  /// the root of `Principal`, and never has a higher role than that root. If `Principal` uses a
  /// session, the new one ends with it.
  /// @retval Forbidden  `role` is higher than that of `Principal`
  /// @retval NotFound   no tablet that waits shows this code
  [[nodiscard]] virtual Answer<AllowedPairing> allow_pairing(const Principal&,
                                                             const std::string& code,
                                                             Role role) = 0;
  /// Opens the session of a tablet that was allowed, once; nothing while the tablet waits.
  /// @retval NotFound  it was not allowed in time, or has its session already, or the credential
  ///                   that allowed it has ended
  [[nodiscard]] virtual Answer<std::optional<NewToken>> collect_pairing(
      const std::string& secret) = 0;
};

/// The designs that were uploaded, and the assets that their specs refer to. See `Service`.
class Designs {
 public:
  virtual ~Designs() = default;
  /// Checks the upload on a planner, which takes time; `done` is called on the service's thread.
  virtual void add(const Principal&, Upload, std::string media_type, std::string name,
                   std::function<void(Answer<Design>)> done) = 0;
  [[nodiscard]] virtual Answer<Asset> add_asset(const Principal&, const Upload&) = 0;
  /// If an asset has several owners, each owner sees the name they gave it.
  [[nodiscard]] virtual Page<Asset> assets(const Principal&, const PageRequest&) = 0;
  /// If you own the asset, this ends your ownership. The asset is deleted with its last owner. If
  /// you are an operator and not an owner, this deletes it for everyone.
  ///
  /// @retval StateConflict  designs of the owner refer to it; the problem names them
  [[nodiscard]] virtual Answer<void> remove_asset(const Principal&, const std::string& id) = 0;
  [[nodiscard]] virtual Page<Design> list(const Principal&, const PageRequest&) = 0;
  /// An owner sees the name that they gave it and when. Everyone else sees those of the first
  /// owner.
  [[nodiscard]] virtual Answer<Design> find(const Principal&, const std::string& id) = 0;
  /// Path of the stored bytes.
  [[nodiscard]] virtual Answer<std::string> content(const std::string& id) = 0;
  /// Like `remove_asset`. The owner's plans of the design go with it.
  ///
  /// @retval StateConflict  a job of the owner uses it
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// The design's preview, drawn again from what was read; never empty bytes.
  virtual void preview(const Principal&, const std::string& id,
                       std::function<void(Answer<std::string>)> done) = 0;

  // Views for a waiting client. They are not stored. `done` is called once, on any thread. It gets
  // Unavailable if the view is cancelled.

  /// Cancels a view. Call it from any thread, at any time.
  using CancelView = std::function<void()>;
  using OnView = std::function<void(Answer<std::string>)>;
  /// The lattice blob of a spec (core/formats/lattice).
  ///
  /// @retval Superseded  a newer request of the same principal and key replaced it
  virtual CancelView show_spec(const Principal&, const PreviewRequest&, OnView done) = 0;
  /// The text of a spec with its shape moved into place, by `place` of the request.
  virtual CancelView place_spec(const Principal&, const PreviewRequest&, OnView done) = 0;
  /// "deployed.svg" (small: the opened card) or "pattern.svg" (flat) of a stored design: made once
  /// and kept, without any text of the file. If there is nothing to draw, the picture says so.
  /// `done` is called on the service's thread.
  virtual void picture(const Principal&, const std::string& id, const std::string& name,
                       OnView done) = 0;
  /// A file of a stored spec as `popcut design` writes it: "pattern.fold", "pattern.svg",
  /// "cut.svg", "pattern.dxf", "segments.csv", "deploy.glb", "deployed.stl", "deployed.svg",
  /// "poster.svg", "report.json".
  ///
  /// @param part  the number of the part, from 1; 1 if the design has one part
  virtual CancelView file(const Principal&, const std::string& id, const std::string& name,
                          int part, OnView done) = 0;
  /// The lattice blob of a stored design.
  ///
  /// @param reading  for a drawing: the options of planning that tell its unit and what its lines
  ///                 are for; ignored for a spec
  virtual CancelView lattice(const Principal&, const std::string& id,
                             const std::map<std::string, std::string>& reading, OnView done) = 0;
  /// A suffix for the ETags of views of a spec, which changes with the row of the spec's material.
  /// Empty for other designs.
  [[nodiscard]] virtual std::string material_etag_suffix(const std::string& id) = 0;
};

/// The most sheets that are read in one turn of the service's thread.
inline constexpr int kSheetsAtOnce = 500;

/// The sheets that designs become. See `Service`.
class Plans {
 public:
  virtual ~Plans() = default;
  [[nodiscard]] virtual Answer<PlanRecord> request(const Principal&, const PlanRequest&) = 0;
  /// Includes the sheets only if there are at most `kSheetsAtOnce`; `whole` includes all.
  [[nodiscard]] virtual Answer<PlanRecord> find(const std::string& id) = 0;
  /// With all its sheets, read in several turns; `done` is called on the service's thread.
  virtual void whole(const std::string& id, std::function<void(Answer<PlanRecord>)> done) = 0;
  /// If you own the plan, this ends your ownership. With its last owner the plan is deleted, or
  /// cancelled if it is not made yet. If you are an operator and not an owner, this happens for
  /// everyone.
  ///
  /// @retval StateConflict  a job of the owner uses this plan
  /// @retval Forbidden      you neither own it nor are an operator
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// The machines that sheets can be planned for: popcut's own, and those of users' tables.
  [[nodiscard]] virtual Answer<std::vector<Machine>> machines() = 0;
  /// Path of a file of a plan: "plan.json", "sheet-01.svg", "sheet-01.gpgl", "pattern.svg",
  /// "deploy.glb", "report.json", "preview.svg", "assembly.svg".
  [[nodiscard]] virtual Answer<std::string> file(const std::string& id,
                                                 const std::string& name) = 0;
  /// The page of artwork of a sheet as a PDF. It is not stored (see `Designs`).
  ///
  /// @param sheet  from 1
  /// @retval NotFound       there is no such plan, sheet or asset, or the plan is not that of a
  /// spec
  /// @retval StateConflict  the plan is not made
  /// @retval Validation     the model cannot be read; artwork is too near to a mark
  virtual Designs::CancelView artwork(const Principal&, const std::string& id, int sheet,
                                      const ArtworkRequest&, Designs::OnView done) = 0;
  /// Makes the sheets of a design without storing them. `way` says for which kind of cutting, for
  /// example "hand" or "laser" (`planning::make_ways`). If `way` is "drawing", returns the
  /// questions about the drawing instead. The answer is the JSON of `planning::make_sheets`.
  ///
  /// @retval NotFound    there is no such design
  /// @retval Validation  as for `request`; the drawing has to be explained first (`Problem::asks`)
  virtual Designs::CancelView make(const Principal&, const std::string& way, const PlanRequest&,
                                   Designs::OnView done) = 0;
};

/// Searches for the best cards of a 3D model. See `Service`.
class Searches {
 public:
  virtual ~Searches() = default;
  /// The search for that model and those options. It exists already, or starts after the commit.
  ///
  /// @retval NotFound    there is no such asset
  /// @retval Validation  an option is not valid, or there is no such machine or material
  /// @retval QueueFull   too many searches wait, of all or of this principal
  [[nodiscard]] virtual Answer<SearchRecord> request(const Principal&,
                                                     const CardSearchRequest&) = 0;
  [[nodiscard]] virtual Answer<SearchRecord> find(const Principal&, const std::string& id) = 0;
  /// All searches, without their cards.
  [[nodiscard]] virtual Page<SearchRecord> list(const Principal&, const PageRequest&) = 0;
  /// Cancels a search that is not finished; removes one that is, with its pictures, as
  /// `Plans::remove` does. Designs that were made from its cards stay.
  ///
  /// @retval Forbidden  it is someone else's
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// Path of a card's PNG. A printed card is shown from the front and from the side. A book or a
  /// bare card is shown beside the model.
  ///
  /// @param card  from 1
  /// @retval NotFound, StateConflict
  [[nodiscard]] virtual Answer<std::string> picture(const std::string& id, int card) = 0;
  /// Path of the lattice blob of a card, as the search designed it.
  ///
  /// @param card  from 1
  /// @retval NotFound, StateConflict
  [[nodiscard]] virtual Answer<std::string> lattice(const std::string& id, int card) = 0;
  /// Makes a design of a card, as `Designs::add` does from its spec.
  ///
  /// @param name  if empty, the name of the model
  virtual void pick(const Principal&, const std::string& id, int card, const std::string& name,
                    std::function<void(Answer<Design>)> done) = 0;
};

/// The jobs and their queue. See `Service`.
class Jobs {
 public:
  virtual ~Jobs() = default;
  [[nodiscard]] virtual Answer<Job> create(const Principal&, const JobCreate&) = 0;
  [[nodiscard]] virtual Answer<Page<Job>> list(const JobFilter&, const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Job> find(const std::string& id) = 0;
  /// As `find`, but without the next actions, which take longer. Events use this.
  [[nodiscard]] virtual Answer<Job> brief(const std::string& id) = 0;
  /// The sheets from `first` on (the first is 1), at most `most` of them and at most
  /// `kSheetsAtOnce`.
  [[nodiscard]] virtual Answer<std::vector<SheetRecord>> sheets(const std::string& job,
                                                                int first = 1,
                                                                int most = kSheetsAtOnce) = 0;
  [[nodiscard]] virtual Answer<Ledger> ledger(const std::string& job, int sheet) = 0;
  [[nodiscard]] virtual Answer<Job> patch(const Principal&, const std::string& id,
                                          std::int64_t if_match, const JobPatch&) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;

  /// Jobs that have not ended, in the order in which a device gets them. If `device` is not empty,
  /// only the jobs that it can cut. A page may have fewer jobs than its limit although another page
  /// follows.
  [[nodiscard]] virtual Answer<Page<Job>> queue(const std::string& device, const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Job> hold(const Principal&, const std::string& job, bool held) = 0;
  /// Puts `job` before `before` (empty: to the end) among those of its priority.
  [[nodiscard]] virtual Answer<Job> move(const Principal&, const std::string& job,
                                         const std::string& before) = 0;
};

/// What people do with the current sheet of a job: arm, start, pause, cancel, ... See `Service`.
class Cutting {
 public:
  virtual ~Cutting() = default;
  [[nodiscard]] virtual Answer<Job> act(const Principal&, const std::string& id,
                                        std::int64_t if_match, const ActionRequest&) = 0;
  /// Pauses or cancels the cut of a job, although nothing can be stored now. Does nothing if this
  /// popcutd does not cut the job.
  virtual void stop_unrecorded(const Principal&, const std::string& /*id*/, JobAction) {}
};

/// The cutters. See `Service`.
class Devices {
 public:
  virtual ~Devices() = default;
  /// All devices, each with the job whose sheet it holds.
  [[nodiscard]] virtual std::vector<DeviceRecord> list() = 0;
  [[nodiscard]] virtual Answer<DeviceRecord> find(const std::string& id) = 0;
  /// enable, disable, reset or test-cut. Nothing moves: a test cut becomes a job that waits for a
  /// person.
  [[nodiscard]] virtual Answer<DeviceRecord> act(const Principal&, const std::string& id,
                                                 std::int64_t if_match, const DeviceRequest&) = 0;
};

/// The materials: built-in, from users' tables, and stored. See `Service`.
class Materials {
 public:
  virtual ~Materials() = default;
  [[nodiscard]] virtual std::vector<MaterialRecord> list() = 0;
  [[nodiscard]] virtual Answer<MaterialRecord> find(const std::string& id) = 0;
  /// With `if_match` 0 the material must not exist yet (If-None-Match: *).
  [[nodiscard]] virtual Answer<MaterialRecord> put(const Principal&, const std::string& id,
                                                   std::int64_t if_match,
                                                   const std::string& json) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id,
                                            std::int64_t if_match) = 0;
};

/// A response, as it is stored with an idempotency key.
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

struct ServiceHealth {
  bool database{false};
  std::uint64_t disk_free_mb{};
  bool accepts_work{false};
  std::string remark;
  bool waits{false};  ///< the shared database does not answer; a restart would not help
};

/// What concerns the service as a whole: idempotency keys, events, metrics, the database. See
/// `Service`.
class Operations {
 public:
  virtual ~Operations() = default;
  /// Runs `effect` and keeps its response under the key, in one transaction. If the same request
  /// comes again, it gets the kept response and `effect` does not run. A response with status 429,
  /// 500 or above is rolled back and not kept.
  [[nodiscard]] virtual Answer<Rendered> once(const Principal&, const IdempotentRequest&,
                                              const std::function<Rendered()>& effect) = 0;

  [[nodiscard]] virtual Answer<std::vector<Event>> events(std::int64_t after, int limit,
                                                          const std::string& job) = 0;
  [[nodiscard]] virtual std::int64_t last_event() = 0;
  [[nodiscard]] virtual std::int64_t first_event() = 0;
  /// Calls `listener` on the service's thread for each event after its commit, in order.
  virtual void listen(std::function<void(const Event&)> listener) = 0;

  /// Sums over all that was cut, in several turns; `done` is called on the service's thread.
  virtual void usage(std::optional<TimeMs> from, std::optional<TimeMs> to, const std::string& by,
                     std::function<void(Answer<std::vector<UsageRow>>)> done) = 0;
  [[nodiscard]] virtual ServiceHealth health() = 0;
  /// OpenMetrics lines about jobs, devices and the store. HTTP adds its own.
  [[nodiscard]] virtual std::string metrics() = 0;

  /// Copies the database, a few pages in each turn. `done` gets the path of the copy, on the
  /// service's thread.
  virtual void backup(const Principal&, std::function<void(Answer<std::string>)> done) = 0;
  /// Checks a copy of the database on another thread. `done` gets "ok" or what is wrong, on the
  /// service's thread.
  virtual void check_integrity(const Principal&, std::function<void(Answer<std::string>)> done) = 0;
};

/// All requests that popcutd can serve. HTTP translates to it, and the store keeps its state.
///
/// Call every member function on the service's thread (see `ServiceThread`), which owns the store.
/// Work that takes long (checking a design, planning, cutting) runs elsewhere, and an event reports
/// its result. A function that changes something uses one transaction. Its effects (to start a
/// planner or a knife) follow after the commit.
///
/// A function that returns an `Answer` reports a database that cannot be read as a problem
/// (Unavailable, Internal). Functions that return a plain value, and all functions within
/// `Operations::once`, throw a std::exception instead; callers answer 503.
struct Service {
  Access& access;
  Designs& designs;
  Plans& plans;
  Searches& searches;
  Jobs& jobs;
  Cutting& cutting;
  Devices& devices;
  Materials& materials;
  Operations& operations;
};

}  // namespace popcut::daemon
