// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/warning.hpp"

namespace popcut::daemon {

/// What a principal may do; each role may do what those before it may.
enum class Role : std::uint8_t { Viewer, Submitter, Operator, Admin };
[[nodiscard]] std::string_view name_of(Role role);
[[nodiscard]] std::optional<Role> role_from(std::string_view name);

/// Milliseconds since 1970, UTC, of the store's clock.
using TimeMs = std::int64_t;

/// A user of the unix socket, as the kernel knows the process there.
struct LocalUser {
  uid_t uid{};
  std::vector<gid_t> groups{};
};

/// The identity behind a request.
struct Principal {
  std::string name;  ///< "uid:1000", "token:01J..."; of a session: that of its root
  Role role{};
  std::string credential{};         ///< id of the token or session that it came with
  std::optional<LocalUser> user{};  ///< unix socket: who it is
  /// How long the credential is good for if it is not used again; nothing: until it is taken away.
  std::optional<std::int64_t> left_ms{};
};

enum class JobState : std::uint8_t {
  Queued,
  Planning,
  Ready,
  Armed,
  Cutting,
  Paused,
  Interrupted,
  Done,
  Failed,
  Cancelled
};
[[nodiscard]] std::string_view name_of(JobState state);
[[nodiscard]] std::optional<JobState> job_state_from(std::string_view name);
[[nodiscard]] bool is_terminal(JobState state);

/// What a person may do with a job.
enum class JobAction : std::uint8_t {
  Arm,
  Disarm,
  Start,
  Pause,
  Resume,
  Cancel,
  ConfirmResult,
  RetrySheet,
  SkipSheet,
  ResumeFrom
};
/// "arm", "confirm-result", ...: as in the URL.
[[nodiscard]] std::string_view name_of(JobAction action);
[[nodiscard]] std::optional<JobAction> job_action_from(std::string_view name);

/// Part of a list, in the order of ids; `cursor` is what the page before gave, or empty.
struct PageRequest {
  int limit{50};
  std::string cursor{};
};
template <typename T>
struct Page {
  std::vector<T> items;
  std::string next_cursor;  ///< empty: that was the last page
};

/// A file that was received, lying in the state's folder for incoming files. Whoever receives it
/// syncs it (fsync), so that the service's thread need not wait for the disk. It is gone
/// afterwards.
struct Upload {
  std::string path;
  std::string sha256;  ///< 64 hexadecimal digits
  std::uint64_t bytes{};
  std::string name{};  ///< that the sender gave it
};

struct Asset {
  std::string id{};  ///< "sha256-..."
  std::string name{}, owner{};
  std::uint64_t bytes{};
  TimeMs created{};
  bool is_new{true};
  std::vector<std::string> designs{};  ///< some of those that refer to it
  std::int64_t designs_total{};        ///< all of them
};

struct Design {
  std::string id;  ///< "sha256-..."
  std::string name;
  std::string kind;  ///< "spec", "fold", "svg", "dxf", "pdf"
  std::string owner;
  std::uint64_t bytes{};
  TimeMs created{};
  std::vector<std::string> assets{};  ///< what a spec refers to
  bool is_new{true};
};

/// A spec to show while it is designed.
struct PreviewRequest {
  std::string spec;   ///< JSON
  std::string key{};  ///< a newer one of the same principal and key takes its place; may be empty
  bool is_draft{false};  ///< quickly, whatever lattice it asks for; else as it will be cut
  std::string place{};   ///< "whole" or "quarter": with its shape moved into place; empty: as it is
  std::string material{};               ///< that the spec names; empty: none
  std::string up{"any"}, front{"any"};  ///< with `place`: axes of the file, as `up_words`
};

/// What is printed on a sheet of a plan.
struct ArtworkRequest {
  std::string mode{"view"};  ///< or "surface", see `PrintMode`
  int dpi{300};
  bool clay{false};     ///< without the model's colours
  bool back{false};     ///< a second page for the other side
  std::string model{};  ///< id of an asset; empty: the mesh of the spec
};

/// How a design becomes sheets: the options of `popcut plan`, checked by the planner.
struct PlanRequest {
  std::string design;
  std::string material;  ///< empty: the design's own, else paper-220
  std::string device;    ///< empty: any; the machine is the device's
  std::string machine;   ///< empty: that of the device, else of the first device
  std::map<std::string, std::string>
      options{};       ///< "mat", "order", "at", "split", ... without dashes
  std::string site{};  ///< without a device: where the cutter is to stand; empty: anywhere
};

/// What keeps a worker from doing anything but plan, by its name.
struct WorkerWall {
  std::string name;       ///< "seccomp", "landlock", "namespaces"
  std::string why_not{};  ///< empty: it holds on this machine
  [[nodiscard]] bool holds() const { return why_not.empty(); }
};

struct SheetPlan {
  int number{};  ///< from 1
  int paths{};
  double cut_mm{}, fold_mm{}, travel_mm{};
  double seconds{};
  std::array<double, 2> seconds_range{};
  std::array<double, 2> area_mm{};
  std::string program_sha256;  ///< of `EncodedProgram::bytes`; checked again at START
  /// Of the file that says what these bytes are for; checked again too. Not shown.
  std::string index_sha256{};
  std::string mat{};   ///< that it lies on: "12x12"; empty: none, or one without a name
  std::string side{};  ///< that is up: "pop-up", "printed" or "drawn"; empty: not known
};

enum class PlanState : std::uint8_t { Pending, Planned, Failed };
[[nodiscard]] std::string_view name_of(PlanState state);
[[nodiscard]] std::optional<PlanState> plan_state_from(std::string_view name);

/// What it takes to fold all sheets of a plan by hand (docs/hands.md).
struct Handwork {
  std::int64_t folds{};
  double shortest_fold_mm{};
  std::int64_t waste{}, tabs{};  ///< pieces to take out, tabs to glue
  double fold_s{};
  std::string label{};  ///< "easy", "medium" or "hard"
};

struct PlanRecord {
  std::string id;  ///< ULID
  std::string design, material, machine;
  PlanState state{};
  std::string sha256;  ///< of all programs; the same design and words give the same
  std::vector<SheetPlan> sheets{};
  std::vector<Warning> warnings{};
  std::string error{};  ///< if it failed
  TimeMs created{};
  /// Of all its sheets, also where `sheets` does not have them.
  int sheets_total{};
  std::int64_t paths{};
  double length_mm{};
  std::array<double, 2> est_s{};
  std::optional<Handwork> handwork{};  ///< none: nothing is folded, or folds are not known
};

/// The most work that one search may do (`CardSearchRequest::effort`): it has the processor time of
/// a plan.
inline constexpr double kLeastEffort = 0.01, kMostEffort = 4.0;
/// Bounds of the time of cutting that a search may ask for, and of its seed.
inline constexpr double kLeastMinutes = 0.1, kMostMinutes = 1e5;
inline constexpr std::int64_t kMostSeed = std::int64_t{1} << 53;
/// Bounds of the folds that a search may ask for.
inline constexpr int kMostFolds = 1'000'000;
inline constexpr double kMostFold_mm = 1000.0;

/// A search for the best cards of a 3D model.
struct CardSearchRequest {
  std::string model;   ///< id of an asset, a mesh
  std::string name{};  ///< of the designs of its cards; the service takes that of the asset
  std::string material{}, device{}, machine{}, mat{};
  std::string style{"any"}, up{"any"}, front{"any"};  ///< words of core/search
  int cards{1};                                       ///< of a book; 1: a card alone
  bool marks{false};       ///< cards fit between the registration marks of a printed sheet
  double max_minutes{15};  ///< of cutting
  double effort{1};        ///< `kLeastEffort` to `kMostEffort`
  std::int64_t seed{1};
  int max_folds{};           ///< at most `kMostFolds`; 0: any number
  double min_fold_mm{};      ///< no fold is shorter; at most `kMostFold_mm`
  std::string label{"any"};  ///< no harder to fold: one of `label_words`
  bool plain{};              ///< cards are judged as bare paper
};

/// A card that a search found.
struct FoundCardRecord {
  std::string style;     ///< "facets", "silhouette", the name of a lattice, or "layers"
  std::string settings;  ///< in words: "facets in strips of 2 mm, planes 1 mm apart"
  /// As `likeness::Figures`: without a unit, 0 is the model itself.
  double error{}, surface{}, contour{}, cover{}, excess{};
  double seconds{};  ///< of cutting, by the model of the machine
  std::array<double, 2> seconds_range{};
  double cut_mm{}, fold_mm{};
  std::array<double, 2> sheet_mm{};  ///< across and along the spine, of a book each of its sheets
  std::optional<double> page_mm{};   ///< of a book: how far a page reaches from the spine
  int folds{};
  int tabs{};  ///< of a card of layers: what is glued
  double shortest_fold_mm{};
  double hand_seconds{};  ///< to fold it, and to glue its tabs
  std::string label{};    ///< "easy", "medium", "hard"
  double wobble_mm{};     ///< of the panel that moves most in paper
  std::string looks{};    ///< printed: "good", "fair", "poor"; empty: judged as bare paper
  std::vector<Warning> warnings{};
  std::string spec;  ///< JSON; its mesh is the id of the asset
};

/// What a search found, by growing time of folding; the error falls from each to the next. A card
/// of layers, if there is one, comes last.
struct SearchFront {
  std::vector<FoundCardRecord> cards{};
  int designed{}, planned{}, verified{};  ///< how many were tried
  double seen_share{};                    ///< of the model's area, along the diagonal
  std::array<double, 2> mat_mm{};         ///< that the tool reaches
  std::vector<std::string> notes{};       ///< about the mesh and the search, a sentence each
  int recommended{};  ///< number of the card to make, from 1; 0: a search of an older version
  std::string better_front{};  ///< that would look clearly better than the one asked for, or empty
};

enum class SearchState : std::uint8_t { Pending, Found, Failed };

struct SearchRecord {
  std::string id;  ///< ULID
  std::string owner;
  CardSearchRequest request{};  ///< with its machine and material filled in
  SearchState state{};
  SearchFront front{};  ///< if it is found
  std::string error{};  ///< if it failed
  TimeMs created{};
  std::string doing{};            ///< while it runs, in words; empty: it waits
  std::optional<double> share{};  ///< of the whole search that is done, 0 to 1
};

struct Attention {
  std::string kind;  ///< load_sheet, confirm_result, device_absent, device_fault, device_busy,
                     ///< media_out, in_doubt
  int sheet{}, total{};
  std::string text;
  TimeMs since{};
  std::vector<std::string> actions{};
};

struct JobProgress {
  std::int64_t paths_certain{}, paths_sent{}, paths_total{};
  std::int64_t paths_done{};  ///< probably cut, by the model of the machine's motion
  double cut_mm{};
};

struct JobEstimate {
  std::array<double, 2> remaining_s{};  ///< shortest and longest
};

/// What to put into the cutter for a sheet.
struct LoadedSheet {
  std::string material, machine;
  std::string mat{};  ///< name; empty: none, or one without a name
  double width_mm{}, length_mm{};
  std::string side{};  ///< that is up: "pop-up", "printed" or "drawn"; empty: not known
};

struct JobCreate {
  std::string design, plan;  ///< one of the two
  std::string material{}, device{}, site{};
  std::map<std::string, std::string> options{};
  int copies{1}, priority{0};
  std::string name{}, note{};
  std::vector<std::string> tags{};
};

struct JobPatch {
  std::optional<int> priority{};
  std::optional<std::string> name{}, note{}, device{}, site{};
  std::optional<std::string> material{};  ///< needs `plan_again`
  bool plan_again{false};                 ///< for the device and the material; before a cut only
};

struct JobFilter {
  std::vector<JobState> states{};
  std::string owner{}, device{}, site{};
  std::optional<TimeMs> since{};
  bool newest_first{false};  ///< else in the order of their ids, the oldest first
};

/// The words of an action. Which are needed depends on the action; others must be absent.
struct ActionRequest {
  JobAction action{};
  std::optional<int> sheet{}, blank{};
  std::string device{}, plan_sha256{};
  std::optional<bool> good{};               ///< confirm-result
  std::optional<std::int64_t> from_path{};  ///< resume-from
  std::string registration{};               ///< resume-from: "kept" or "re-registered"
  bool accept_double_cut{false}, skip_in_doubt{false};
  std::vector<std::string> accept_warnings{};  ///< arm: codes
  std::string reason{};
};

/// The body of a request to the queue.
struct QueueRequest {
  std::string job;
};

/// A complete request that would pass now.
struct NextAction {
  /// As in the URL: "arm", "release", "reset"; "change" is a PATCH of the job.
  std::string action;
  std::variant<ActionRequest, JobPatch, QueueRequest> body{};
  std::string device{};  ///< of an action of a device (reset, enable)
  std::string job{};     ///< of an action of another job than the one that was asked about
};

/// An action of a job, with its body; `job` as in `NextAction`.
[[nodiscard]] NextAction next_action(JobAction action, ActionRequest body = {},
                                     std::string job = {});

/// A job as it is stored.
struct JobRow {
  std::string id;  ///< ULID
  std::int64_t rev{0};
  JobState state{};
  std::string reason{};
  std::string asked{};  ///< of a job that is cut: "", "pause", "cancel"
  std::string name{}, note{}, owner{}, operator_name{};
  std::string requested_device{};
  std::string device{};  ///< that holds the sheet; empty: none
  std::string site{};    ///< only cutters there cut it; empty: any
  std::string design{}, plan{}, material{};
  int priority{};
  std::int64_t position{};  ///< in the queue, among jobs of the same priority
  int copies{1};
  bool held{false};
  int sheets_total{};
  int sheet{};  ///< the current one, from 1; 0: none
  int blank{1}, segment{1};
  std::int64_t first_stroke{0};
  std::int64_t paths_certain{}, paths_sent{};  ///< of the current sheet
  std::int64_t paths_total{};                  ///< of all sheets
  std::int64_t done_paths{};                   ///< of the sheets before the current one
  double done_mm{};
  double low_s{}, high_s{};  ///< estimate of what is left, with the whole current sheet
  TimeMs created{};
  std::optional<TimeMs> started{}, finished{};
  std::string outcome{};
  std::vector<std::string> tags{};
  std::optional<LoadedSheet> load{};      ///< what the current sheet needs
  std::optional<Handwork> handwork{};     ///< of one copy
  std::vector<Warning> warnings{};        ///< its own and those of its plan
  std::vector<std::string> unaccepted{};  ///< codes of warnings that `arm` must accept
  std::string attention_kind{}, attention_text{};
  TimeMs attention_since{};
  bool is_deleted{false};
};

/// A job as the API shows it: what is stored, and what follows from that now. `device` is the
/// requested one as long as no cutter holds the sheet. Its fields are listed in
/// daemon/model/fields.hpp.
struct Job : JobRow {
  std::string kind{"job"};                      ///< or "test-cut"
  std::string owner_title{}, operator_title{};  ///< what people call these principals
  JobProgress progress{};
  JobEstimate est{};
  std::optional<Attention> attention{};
  std::optional<TimeMs> armed_until{};     ///< while it is armed: when that lapses
  std::vector<std::string> actions{};      ///< allowed now
  std::vector<NextAction> next_actions{};  ///< only of one job that was asked for
};

struct SheetRecord {
  int number{}, copy{1}, blank{1}, segment{1};
  std::string state;  ///< waiting, ready, armed, cutting, interrupted, done, skipped
  SheetPlan plan{};
  std::optional<TimeMs> started{}, finished{};
};

/// Strokes `first .. last`, counted from 0; `last < first`: none.
struct PathRange {
  std::int64_t first{0}, last{-1};
};

struct Attempt {
  std::string id;
  int blank{1}, segment{1};
  TimeMs started{};
  std::optional<TimeMs> ended{};
  std::string
      end_kind{};  ///< done, cancelled, device_gone, stall, panel_stop, crash, shutdown, ...
  std::string operator_name{};
  std::uint64_t bytes_taken{};
};

struct Ledger {
  int sheet{}, blank{1}, segment{1};
  std::int64_t certain_upto{-1};  ///< last stroke of the run of certain ones from the start
  std::vector<PathRange> certain{}, in_doubt{}, not_sent{};
  std::string last_status{};
  std::vector<Attempt> attempts{};
};

struct Event {
  std::int64_t seq{};  ///< 0: progress, which is not stored
  std::string kind;    ///< job, sheet, device, queue, progress, notice
  TimeMs time{};
  std::string job{};
  std::string data;  ///< as it is stored: compact JSON with "seq", "kind" and what changed
};
/// A text that the event says under this name; empty: none.
[[nodiscard]] std::string text_in(const Event& event, std::string_view name);

struct DeviceRecord {
  std::string id;  ///< "sim:cameo3", "usb:51053P"
  std::int64_t rev{1};
  std::string model, title;
  std::string state;  ///< absent, offline, idle, busy, attention, fault
  std::vector<std::string> reasons{};
  bool enabled{true}, simulated{false};
  double width_mm{}, length_mm{};
  std::string firmware{};
  std::string job{};
  /// Grows whenever it was plugged in again or lost: a sheet keeps its place only while this stays.
  std::int64_t plugs{};
  std::int64_t sheets_done{};
  double cut_mm{};
  std::string machine{};                 ///< row of the table that it is driven as
  std::vector<std::string> materials{};  ///< it is set up for; none: any
  std::string test_job{};                ///< in the answer to test-cut: the job that was made
  std::string node{};                    ///< of a fleet: whose cutter it is
  std::string node_url{};                ///< where that node's page is; empty: it is this node
  std::string site{};                    ///< where it stands; empty: nobody said
};

/// What a person asks of a device.
struct DeviceRequest {
  std::string action;      ///< enable, disable, reset, test-cut
  std::string material{};  ///< of a test cut; empty: the usual one
};

struct MaterialRecord {
  std::string id;
  std::int64_t rev{1};
  std::string json;  ///< the material's row as in materials.json
  bool built_in{true};
};

struct TokenRecord {
  std::string id;
  std::string name;
  Role role{};
  TimeMs created{};
  std::optional<TimeMs> expires{};
};
/// A session of a page. Its root is the token or the user of the unix socket that opened the page,
/// and it is never more than that: it has the root's role of now and ends with it.
struct SessionRecord {
  std::string id;
  std::string root;  ///< "token:01J...", "uid:1000": the name of its principal
  std::string via;   ///< the session that opened it, if one did; it ends with that
  Role role{};       ///< that of the root now
  TimeMs created{};
  TimeMs expires{};    ///< when it ends unless it is used
  TimeMs ends{};       ///< when it ends however it is used
  std::string name{};  ///< of a tablet that was paired, as it called itself
};
/// What a tablet that wants to be paired has: the code is for a person to type, the secret is its
/// own.
struct NewPairing {
  std::string id, code, secret;
  TimeMs expires{};
};
/// A tablet that a person let in.
struct AllowedPairing {
  std::string name;
  Role role{};
};
/// A token at the only moment when it is known whole.
struct NewToken {
  TokenRecord record;
  std::string text;  ///< "pc_<id>_<43 base64url>"
};

struct UsageRow {
  std::string key;  ///< owner, device or material
  double seconds{}, cut_mm{};
  std::int64_t sheets{};
};

}  // namespace popcut::daemon
