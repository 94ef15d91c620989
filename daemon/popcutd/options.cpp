// SPDX-License-Identifier: MIT
#include "daemon/popcutd/options.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/formats/svg_profile.hpp"
#include "core/plan/machine.hpp"
#include "daemon/cli/help_pages.hpp"
#include "daemon/cli/output_folder.hpp"
#include "daemon/cli/user_tables.hpp"
#include "daemon/config/default_text.hpp"
#include "daemon/popcutd/paths.hpp"

namespace popcut::daemon {
namespace {

constexpr const char* kPurpose =
    "popcutd keeps the jobs: it designs, plans, waits for a person at each sheet, and cuts.\n\n"
    "  popcutd                               # one simulated cutter, this computer only\n"
    "  popcutd --sim cameo4 --listen 127.0.0.1:9000\n"
    "  popcutd --config popcutd.toml --check-config\n\n"
    "Then, in another terminal: popcut cut sphere.json --wait\n\n"
    "Without --config it reads ~/.config/popcut/popcutd.toml or /etc/popcut/popcutd.toml, if one "
    "is\nthere; --print-config prints every key. Ctrl-C stops a cut at the end of its stroke.";
constexpr const char* kFooter =
    "Exit codes: 0 stopped as asked; 1 a fault in popcutd; 2 wrong command line; 5 an address or "
    "the\nstate folder is in use; 7 the state folder cannot be written; 78 the configuration or "
    "the\ndatabase needs a person.";

const char* variable(const char* name) { return std::getenv(name); }

Result<std::string> config_text(const DaemonOptions& options, const Paths& paths,
                                std::string& found) {
  std::error_code ignored;
  found = options.config;
  if (found.empty())
    for (const std::string& file : paths.configurations)
      if (found.empty() && std::filesystem::exists(file, ignored)) found = file;
  if (found.empty()) return std::string();
  return cli::read_file(found, 1 << 20);
}

/// @param file  of the configuration; empty: there is none
Result<void> check_tables(const Config& config, const std::string& file) {
  const auto tables = cli::read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  // Users' own tables whole: what is wrong in one must not be an empty table later.
  if (const auto all = all_machines(tables->texts); !all)
    return tl::unexpected(tables->with_file(all.error()));
  if (const auto all = all_materials(tables->texts); !all)
    return tl::unexpected(tables->with_file(all.error()));
  if (const auto all = all_stroke_profiles(tables->texts); !all)
    return tl::unexpected(tables->with_file(all.error()));
  for (const DeviceConfig& device : config.devices) {
    const bool simulated = device.id.rfind("sim:", 0) == 0;
    const bool by_id = simulated && device.machine.empty();
    for (const std::string& name :
         {device.machine, device.treat_as, by_id ? device.id.substr(4) : std::string()}) {
      if (name.empty()) continue;
      if (const auto machine = find_machine(name, tables->texts); !machine) {
        Error error = within("device " + device.id, tables->with_file(machine.error()));
        return tl::unexpected(file.empty() ? error : within(file, std::move(error)));
      }
    }
  }
  return {};
}

}  // namespace

Result<DaemonOptions> parse_options(int argc, const char* const* argv) {
  CLI::App app{kPurpose, "popcutd"};
  DaemonOptions options;
  app.set_version_flag("--version", "popcutd " POPCUT_VERSION);
  app.add_option("--config", options.config, "Read this configuration (TOML)")->option_text("FILE");
  app.add_flag("--check-config", options.check_config,
               "Say whether the configuration is right, and end");
  bool print_config = false;
  app.add_flag("--print-config", print_config,
               "Print a configuration with every key and its default, and end");
  app.add_option("--state", options.state, "Keep jobs, designs and plans there")
      ->option_text("DIR");
  app.add_option("--listen", options.listen, "Serve HTTP at this loopback address, and no other")
      ->option_text("HOST:PORT [127.0.0.1:8631 [::1]:8631]");
  app.add_option("--socket", options.socket, "Unix socket to serve at")->option_text("PATH");
  app.add_option("--sim", options.simulated, "Attach a simulated cutter; may stand several times")
      ->option_text("NAME [cameo3]");
  std::string page;
  app.add_option("--help-page", page, "bash, zsh, fish or man")->group("");  // hidden
  app.footer(kFooter);
  try {
    app.parse(argc, const_cast<char**>(argv));
  } catch (const CLI::ParseError& refused) {
    if (refused.get_exit_code() != 0)
      return fail(ErrorKind::Usage, "command line",
                  fmt::format("{}; 'popcutd --help' lists what is right", refused.what()));
    app.exit(refused);
    std::cout.flush();
    options.exit = 0;
  }
  if (!page.empty()) {
    const auto text = cli::help_page(app, page, 8);
    if (!text) return tl::unexpected(text.error());
    std::cout << *text << std::flush;
    options.exit = std::cout ? 0 : exit_code(ErrorKind::Unwritable);
  }
  if (print_config) {
    std::cout << kConfigText << std::flush;
    options.exit = std::cout ? 0 : exit_code(ErrorKind::Unwritable);
  }
  return options;
}

Result<Config> load_config(const DaemonOptions& options, std::string& found) {
  const auto paths = default_paths(variable, ::geteuid() == 0);
  // Where the state is named, nothing else has to be known.
  if (!paths && options.state.empty()) return tl::unexpected(paths.error());
  const auto text = config_text(options, paths.value_or(Paths{}), found);
  if (!text) return tl::unexpected(text.error());
  auto config = parse_config(*text);
  if (!config) return tl::unexpected(within(found, config.error()));
  if (!options.listen.empty()) {
    config->listen = options.listen;
    config->listen_given = true;
  }
  for (const std::string& address : config->listen)
    if (const auto lawful = parse_listen(address, config->allow_remote); !lawful)
      return tl::unexpected(within("--listen", lawful.error()));
  for (const std::string& name : options.simulated) {
    DeviceConfig device;
    device.id = "sim:" + name;
    config->devices.push_back(std::move(device));
  }
  if (config->devices.empty()) {
    DeviceConfig device;
    device.id = "sim:cameo3";
    config->devices.push_back(std::move(device));
  }
  if (!options.state.empty()) config->state = options.state;
  if (config->state.empty()) config->state = paths->state;
  if (!options.socket.empty()) config->socket = options.socket;
  if (config->socket.empty() && paths) config->socket = paths->socket;
  if (auto known = check_tables(*config, found); !known) return tl::unexpected(known.error());
  return config;
}

}  // namespace popcut::daemon
