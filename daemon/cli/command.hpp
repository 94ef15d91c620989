// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "core/result.hpp"
#include "daemon/cli/parsing/command_line.hpp"

namespace popcut::cli {

/// The options that every subcommand accepts.
struct Globals {
  bool json{false};  ///< standard output is one JSON document
  bool quiet{false};
  int verbose{0};
};

/// Adds one subcommand to `app`. If the user chooses it, `run` becomes the work to do, which
/// returns nothing, or the error that main prints and turns into an exit code.
using Run = std::function<Result<void>()>;
using Register = void (*)(const Command& app, const Globals& globals, Run& run);

/// Makes `work` the work to do if the user chooses `command`.
template <typename Work>
void when_chosen(const Command& command, Run& run, Work work) {
  command.on_choice([&run, work] { run = work; });
}

void register_design(const Command& app, const Globals& globals, Run& run);
void register_auto(const Command& app, const Globals& globals, Run& run);
void register_deploy(const Command& app, const Globals& globals, Run& run);
void register_verify(const Command& app, const Globals& globals, Run& run);
void register_compare(const Command& app, const Globals& globals, Run& run);
void register_plan(const Command& app, const Globals& globals, Run& run);
void register_print(const Command& app, const Globals& globals, Run& run);
void register_fold_guide(const Command& app, const Globals& globals, Run& run);
void register_simulate(const Command& app, const Globals& globals, Run& run);
void register_cut(const Command& app, const Globals& globals, Run& run);
void register_calibrate(const Command& app, const Globals& globals, Run& run);
void register_send(const Command& app, const Globals& globals, Run& run);
void register_curvature(const Command& app, const Globals& globals, Run& run);
void register_figures(const Command& app, const Globals& globals, Run& run);
void register_doctor(const Command& app, const Globals& globals, Run& run);
void register_fleet(const Command& app, const Globals& globals, Run& run);
void register_jobs(const Command& app, const Globals& globals, Run& run);
void register_job_actions(const Command& app, const Globals& globals, Run& run);
void register_open(const Command& app, const Globals& globals, Run& run);
void register_daemon(const Command& app, const Globals& globals, Run& run);
void register_machines(const Command& app, const Globals& globals, Run& run);

}  // namespace popcut::cli
