// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "core/result.hpp"

namespace CLI {
class App;
}

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
using Register = void (*)(CLI::App& app, const Globals& globals, Run& run);

/// Makes `work` the work to do if the user chooses `command`.
template <typename App, typename Work>
void when_chosen(App* command, Run& run, Work work) {
  command->callback([&run, work] { run = work; });
}

void register_design(CLI::App& app, const Globals& globals, Run& run);
void register_auto(CLI::App& app, const Globals& globals, Run& run);
void register_deploy(CLI::App& app, const Globals& globals, Run& run);
void register_verify(CLI::App& app, const Globals& globals, Run& run);
void register_compare(CLI::App& app, const Globals& globals, Run& run);
void register_plan(CLI::App& app, const Globals& globals, Run& run);
void register_print(CLI::App& app, const Globals& globals, Run& run);
void register_simulate(CLI::App& app, const Globals& globals, Run& run);
void register_cut(CLI::App& app, const Globals& globals, Run& run);
void register_calibrate(CLI::App& app, const Globals& globals, Run& run);
void register_send(CLI::App& app, const Globals& globals, Run& run);
void register_curvature(CLI::App& app, const Globals& globals, Run& run);
void register_figures(CLI::App& app, const Globals& globals, Run& run);
void register_doctor(CLI::App& app, const Globals& globals, Run& run);
void register_fleet(CLI::App& app, const Globals& globals, Run& run);
void register_jobs(CLI::App& app, const Globals& globals, Run& run);
void register_job_actions(CLI::App& app, const Globals& globals, Run& run);
void register_open(CLI::App& app, const Globals& globals, Run& run);
void register_daemon(CLI::App& app, const Globals& globals, Run& run);
void register_machines(CLI::App& app, const Globals& globals, Run& run);

}  // namespace popcut::cli
