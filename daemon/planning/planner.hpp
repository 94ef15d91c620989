// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/model/model.hpp"
#include "daemon/planning/worker_memory.hpp"

namespace popcut::daemon {

/// What a plan is at.
struct PlanningPhase {
  std::string phase;  ///< one word, see `planning::phase_of`
  std::string doing;  ///< in words
  double done{-1};    ///< the part of `doing` that is done, 0 to 1; below 0: not known
};

/// A task of a worker process.
struct PlanningTask {
  enum class Kind : std::uint8_t {
    Check,    ///< read it and say what it is; the preview comes along
    Plan,     ///< design if it is a spec, then plan and encode for the machine
    TestCut,  ///< the material's small test shape, planned and encoded
    Preview,  ///< a spec's lattice blob; options: "quality" (draft, exact), "place"
    Lattice,  ///< the lattice blob of a design of any kind
    Picture,  ///< a design's "deployed.svg" and "pattern.svg", without any text of its own
    Export,   ///< one file of a spec as popcut design writes it; options: "file", "part" (from 1)
    Place,  ///< a spec with its shape moved into place; options: "place" (whole, quarter), "up" and
            ///< "front" (`up_words`)
    Artwork,  ///< the artwork of a sheet of a plan of a spec, as a page; see `ArtworkRequest`
    Svg,      ///< a page of a PDF as "drawing.svg"; options: "page" (from 1)
    Make,     ///< sheets for a way of making, or what a drawing asks: see `planning::make_sheets`
    Search,   ///< the best cards of a mesh, which is the design; see planning/search/search_task
  };
  Kind kind{};
  std::string who{};          ///< the principal for whom it is done
  std::string design_path;    ///< stored bytes; read by the daemon and sent through the pipe
  std::string design_text{};  ///< the bytes themselves, where there is no path
  std::string design_kind;    ///< see `planning::name_of`; empty in Check: the media type decides
  std::string media_type{};
  std::map<std::string, std::string> asset_paths{};  ///< by id
  /// If not empty: where the assets lie that the design refers to, for `find_assets`.
  std::string assets_folder{};
  std::string machine_json, material_json;       ///< rows of the tables
  std::string profile_json{};                    ///< row of svg_profiles; empty: a built-in one
  std::map<std::string, std::string> options{};  ///< as in `PlanRequest`
  /// Told while a plan is made what it is at: at most twice a second, and at least every two
  /// seconds once there is something to tell. On a thread of the planner; may be empty.
  std::function<void(const PlanningPhase&)> progress{};
};

struct PlanningFile {
  std::string name;  ///< "sheet-01.gpgl", "sheet-01.program.json", "plan.json", "pattern.svg", ...
  std::string bytes;
};

struct PlanningOutcome {
  std::string design_kind;
  std::vector<std::string> assets{};  ///< ids that the spec refers to
  std::vector<SheetPlan> sheets{};
  std::vector<Warning> warnings{};
  std::optional<Handwork> handwork{};  ///< of its sheets, where they are folded
  std::string sha256{};                ///< over all programs in order
  std::vector<PlanningFile> files{};
};

struct PlanningLimits {
  int processes{1};  ///< at once; two more do only checks, so that no plan delays them, and one
                     ///< more only searches
  double cpu_s{600};
  double check_s{60};  ///< processor time of a check, for which somebody waits
  double wall_s{1200};
  std::uint64_t memory_bytes{std::uint64_t{2} << 30};
  std::uint64_t output_bytes{std::uint64_t{1} << 30};
  bool is_preview{false};                              ///< no key of the configuration raises them
  bool is_check{false};                                ///< `cpu_s` is that of a check
  std::shared_ptr<planning::WorkerMemory> together{};  ///< of all workers; null: not limited
  /// Told of each worker that crashed, in a line for an administrator; on any thread.
  std::function<void(const std::string& line)> report{};
};

/// Runs designs in separate processes (`popcutd --worker`, pipes only), a bounded number at once,
/// so that a hostile one disturbs nothing. Checks, for which a client waits, run beside the plans:
/// principals take turns, and one of them never has all processes for checks. Searches, which take
/// minutes, run beside both, one after another. `done` is called once for each task, on a thread of
/// the planner: with Refused if it was cancelled, with Infeasible if a limit was hit or the worker
/// died. A worker that was killed by somebody else (signals 9, 15, 2, 1, 3: a person, or the kernel
/// for want of memory) is replaced twice; one that crashed or hit its limits is not, since it would
/// do so again.
class Planner {
 public:
  virtual ~Planner() = default;
  using Done = std::function<void(Result<PlanningOutcome>)>;
  /// Number of the task, for `cancel`.
  virtual std::uint64_t start(PlanningTask task, Done done) = 0;
  /// Kills it, if it has not ended.
  virtual void cancel(std::uint64_t task) = 0;
};

/// Adds to `task` the assets that its design names by id and that lie in its `assets_folder`: at
/// most 64. Reads the design once and looks for at most 1000 different ids, whatever it holds; what
/// it means only a worker reads. Takes time: for a planner's own thread.
void find_assets(PlanningTask& task);

/// A planner whose tasks run in processes of `program`, which must do `planning::run_worker(0, 1)`
/// when its first argument is `--worker` (/proc/self/exe for popcutd itself). Plans and searches
/// start in the order they came. Its destructor kills running tasks and reports them as Refused.
[[nodiscard]] std::unique_ptr<Planner> make_planner(const PlanningLimits& limits,
                                                    std::string program);

}  // namespace popcut::daemon
