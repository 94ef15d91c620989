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

/// Who may use the service: tokens, and the sessions of pages. See `Service`.
class Access {
 public:
  virtual ~Access() = default;
  /// The owner of a token; nothing if it is unknown or has expired.
  [[nodiscard]] virtual std::optional<Principal> authenticate(std::string_view bearer) = 0;
  [[nodiscard]] virtual Answer<NewToken> create_token(const Principal&, const std::string& name,
                                                      Role role, std::optional<int> lifetime_s) = 0;
  [[nodiscard]] virtual std::vector<TokenRecord> tokens() = 0;
  [[nodiscard]] virtual Answer<void> delete_token(const Principal&, const std::string& id) = 0;
  /// The sessions that open something now: all of them for an admin, else those of the same root.
  [[nodiscard]] virtual std::vector<SessionRecord> sessions(const Principal&) = 0;
  /// Ends a session, and those that it opened.
  /// @retval Forbidden  it is someone else's, and this is no admin
  [[nodiscard]] virtual Answer<void> end_session(const Principal&, const std::string& id) = 0;
  /// What people call a principal: the name of a token, the login name of a user; the principal's
  /// own name if there is none.
  [[nodiscard]] virtual std::string title_of(const std::string& principal) = 0;
  /// The session with this id, if it is one, and not that of a token.
  [[nodiscard]] virtual std::optional<SessionRecord> session_of(const std::string& credential) = 0;
  /// Ends the session, or deletes the token, that the request came with.
  /// @retval NotFound  it came over the unix socket, with neither
  [[nodiscard]] virtual Answer<void> close_session(const Principal&) = 0;
  /// `listener` is called on the service's thread when credentials have ended or have another role.
  virtual void on_access_change(std::function<void()> listener) = 0;
  /// A word that becomes a session's token once, within 60 s: what `popcut open` gives the page. It
  /// is good only as long as the credential that asked for it.
  [[nodiscard]] virtual Answer<std::string> create_one_shot(const Principal&) = 0;
  [[nodiscard]] virtual Answer<NewToken> open_session(const std::string& one_shot) = 0;
  /// A tablet asks to be paired. It waits five minutes for a person who types its code. If twenty
  /// wait already, the oldest one goes of the `place` (an address) where most of them are.
  /// @retval Unavailable  twenty wait already, no two of them at one place
  [[nodiscard]] virtual Answer<NewPairing> ask_pairing(const std::string& name,
                                                       const std::string& place) = 0;
  /// Lets in the tablet that shows `code`, once. Its session's root is that of `Principal`, whose
  /// session it ends with; its role is at most `role`, and never more than its root has.
  /// @retval Forbidden  `role` is more than one's own
  /// @retval NotFound   no tablet that waits shows this code
  [[nodiscard]] virtual Answer<AllowedPairing> allow_pairing(const Principal&,
                                                             const std::string& code,
                                                             Role role) = 0;
  /// The session of a tablet that was let in, once; nothing while it waits.
  /// @retval NotFound  nobody let it in in time, or it has its session, or who let it in is gone
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
  [[nodiscard]] virtual Page<Asset> assets(const PageRequest&) = 0;
  /// @retval StateConflict  designs refer to it, and are named
  [[nodiscard]] virtual Answer<void> remove_asset(const Principal&, const std::string& id) = 0;
  [[nodiscard]] virtual Page<Design> list(const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Design> find(const std::string& id) = 0;
  /// Path of the stored bytes.
  [[nodiscard]] virtual Answer<std::string> content(const std::string& id) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// The design's preview, drawn again from what was read; never empty bytes.
  virtual void preview(const std::string& id, std::function<void(Answer<std::string>)> done) = 0;

  // What somebody waits for at a screen. Nothing of it is stored. `done` is called once, on any
  // thread, and with Unavailable if it is called off.

  /// Ends what nobody waits for any more. From any thread, at any time.
  using CallOff = std::function<void()>;
  using Shown = std::function<void(Answer<std::string>)>;
  /// The lattice blob of a spec (core/formats/lattice).
  ///
  /// @retval Superseded  a newer one of the same principal and key came
  virtual CallOff show_spec(const Principal&, const PreviewRequest&, Shown done) = 0;
  /// The text of a spec with its shape moved into place, by `place` of the request.
  virtual CallOff place_spec(const Principal&, const PreviewRequest&, Shown done) = 0;
  /// "deployed.svg" (small: the opened card) or "pattern.svg" (flat) of a stored design: made once
  /// and kept, without any text of the file. A design that has no picture gets one that says so.
  /// `done` is called on the service's thread.
  virtual void picture(const Principal&, const std::string& id, const std::string& name,
                       Shown done) = 0;
  /// A file of a stored spec as `popcut design` writes it: "pattern.fold", "pattern.svg",
  /// "cut.svg", "pattern.dxf", "segments.csv", "deploy.glb", "deployed.svg", "poster.svg",
  /// "report.json".
  ///
  /// @param part  from 1: of a design of several parts
  virtual CallOff file(const Principal&, const std::string& id, const std::string& name, int part,
                       Shown done) = 0;
  /// The lattice blob of a stored design.
  virtual CallOff lattice(const Principal&, const std::string& id, Shown done) = 0;
  /// What changes with the material that a stored spec names, for the ETags of what is made of it:
  /// "-" and a few digits; empty for other designs.
  [[nodiscard]] virtual std::string material_mark(const std::string& id) = 0;
};

/// Sheets that are read in one turn of the service's thread.
inline constexpr int kSheetsAtOnce = 500;

/// The sheets that designs become. See `Service`.
class Plans {
 public:
  virtual ~Plans() = default;
  [[nodiscard]] virtual Answer<PlanRecord> request(const Principal&, const PlanRequest&) = 0;
  /// Its sheets only if they are few (`kSheetsAtOnce`); `whole` has them all.
  [[nodiscard]] virtual Answer<PlanRecord> find(const std::string& id) = 0;
  /// With all its sheets, read in several turns; `done` is called on the service's thread.
  virtual void whole(const std::string& id, std::function<void(Answer<PlanRecord>)> done) = 0;
  /// Ends a plan that waits or is being made, and removes one that was made with its files.
  ///
  /// @retval StateConflict  a job uses this plan
  /// @retval Forbidden      it is of someone else's design
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// The machines that sheets can be planned for: popcut's own, and those of users' tables.
  [[nodiscard]] virtual Answer<std::vector<Machine>> machines() = 0;
  /// Path of a file of a plan: "plan.json", "sheet-01.svg", "sheet-01.gpgl", "pattern.svg",
  /// "deploy.glb", "report.json", "preview.svg", "assembly.svg".
  [[nodiscard]] virtual Answer<std::string> file(const std::string& id,
                                                 const std::string& name) = 0;
  /// The page of artwork of a sheet, a PDF: made for who waits for it, and not kept (`Designs`).
  ///
  /// @param sheet  from 1
  /// @retval NotFound       no such plan, sheet or asset; the plan is not of a spec
  /// @retval StateConflict  it is not made
  /// @retval Validation     the model cannot be read; artwork is too near to a mark
  virtual Designs::CallOff artwork(const Principal&, const std::string& id, int sheet,
                                   const ArtworkRequest&, Designs::Shown done) = 0;
};

/// Searches for the best cards of a 3D model. See `Service`.
class Searches {
 public:
  virtual ~Searches() = default;
  /// The search of that model and those words: one that is there, or a new one that is made after
  /// the commit.
  ///
  /// @retval NotFound    there is no such asset
  /// @retval Validation  an option, or there is no such machine or material
  /// @retval QueueFull   too many wait, or too many of theirs
  [[nodiscard]] virtual Answer<SearchRecord> request(const Principal&,
                                                     const CardSearchRequest&) = 0;
  [[nodiscard]] virtual Answer<SearchRecord> find(const std::string& id) = 0;
  /// Ends a search that waits or runs, and removes one that was made with its pictures. Designs
  /// that were made of its cards stay.
  ///
  /// @retval Forbidden  it is someone else's
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;
  /// Path of the picture of a card (PNG): the model, and the card beside it.
  ///
  /// @param card  from 1
  /// @retval NotFound, StateConflict
  [[nodiscard]] virtual Answer<std::string> picture(const std::string& id, int card) = 0;
  /// Makes a design of a card, as `Designs::add` of its spec.
  ///
  /// @param name  empty: that of the model
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
  /// As `find`, without the ways on: for those who hear of a job and did not ask about it.
  [[nodiscard]] virtual Answer<Job> brief(const std::string& id) = 0;
  /// The sheets `first`, ... (from 1), at most `most` of them.
  [[nodiscard]] virtual Answer<std::vector<SheetRecord>> sheets(const std::string& job,
                                                                int first = 1,
                                                                int most = kSheetsAtOnce) = 0;
  [[nodiscard]] virtual Answer<Ledger> ledger(const std::string& job, int sheet) = 0;
  [[nodiscard]] virtual Answer<Job> patch(const Principal&, const std::string& id,
                                          std::int64_t if_match, const JobPatch&) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;

  /// Jobs that have not ended, in the order in which each device will be offered them. A page may
  /// have fewer than its limit and yet another after it.
  [[nodiscard]] virtual Answer<Page<Job>> queue(const std::string& device, const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Job> hold(const Principal&, const std::string& job, bool held) = 0;
  /// Puts `job` before `before` (empty: to the end) among those of its priority.
  [[nodiscard]] virtual Answer<Job> move(const Principal&, const std::string& job,
                                         const std::string& before) = 0;
};

/// What people do with a job's current sheet: arm, start, pause, cancel, ... See `Service`.
class Cutting {
 public:
  virtual ~Cutting() = default;
  [[nodiscard]] virtual Answer<Job> act(const Principal&, const std::string& id,
                                        std::int64_t if_match, const ActionRequest&) = 0;
  /// Pauses or cancels what this popcutd cuts of a job, when the database does not answer.
  virtual void stop_unrecorded(const Principal&, const std::string& /*id*/, JobAction) {}
};

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

struct ServiceHealth {
  bool database{false};
  std::uint64_t disk_free_mb{};
  bool accepts_work{false};
  std::string remark;
  bool waits{false};  ///< for the database that all nodes share; a restart would not help
};

/// What concerns the service as a whole: keys of requests, events, figures, the database. See
/// `Service`.
class Operations {
 public:
  virtual ~Operations() = default;
  /// Runs `effect` and keeps its response under the key, in one transaction. The second time, the
  /// same request is answered with the kept response, and `effect` does not run. A response of
  /// status 500 or above, or 429, is rolled back and not kept.
  [[nodiscard]] virtual Answer<Rendered> once(const Principal&, const IdempotentRequest&,
                                              const std::function<Rendered()>& effect) = 0;

  [[nodiscard]] virtual Answer<std::vector<Event>> events(std::int64_t after, int limit,
                                                          const std::string& job) = 0;
  [[nodiscard]] virtual std::int64_t last_event() = 0;
  [[nodiscard]] virtual std::int64_t first_event() = 0;
  /// `listener` is called on the service's thread for each event after its commit, in order.
  virtual void listen(std::function<void(const Event&)> listener) = 0;

  /// Sums over all that was cut, read in several turns; `done` is called on the service's thread.
  virtual void usage(std::optional<TimeMs> from, std::optional<TimeMs> to, const std::string& by,
                     std::function<void(Answer<std::vector<UsageRow>>)> done) = 0;
  [[nodiscard]] virtual ServiceHealth health() = 0;
  /// OpenMetrics lines of the jobs, devices and the store (HTTP adds its own).
  [[nodiscard]] virtual std::string metrics() = 0;

  /// Copies the database a few pages a turn, and gives the path of the copy. `done` is called on
  /// the service's thread, here as below.
  virtual void backup(const Principal&, std::function<void(Answer<std::string>)> done) = 0;
  /// Checks such a copy on another thread, and removes it: "ok", or what is wrong.
  virtual void check_integrity(const Principal&, std::function<void(Answer<std::string>)> done) = 0;
};

/// All that people may ask of popcutd. HTTP is a shell around it; the store below it is its only
/// memory.
///
/// Every member function is called on the service's thread (see `ServiceThread`), which owns the
/// store. What takes long (checking a design, planning, cutting) runs elsewhere and comes back as
/// an event. Functions that change something run in one transaction; what follows from it (starting
/// a planner, starting a knife) happens after the commit.
///
/// Where an `Answer` is given, a database that cannot be read is a problem (Unavailable, Internal).
/// Functions that give a plain value, and all of them within `Operations::once`, throw something
/// derived from std::exception instead: callers answer 503.
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
