// SPDX-License-Identifier: MIT
#include "daemon/popcutd/options.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include <fmt/format.h>

#include "core/formats/svg/svg_profile.hpp"
#include "core/machines/machine.hpp"
#include "daemon/cli/help/help_pages.hpp"
#include "daemon/cli/help/program.hpp"
#include "daemon/config/default_text.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/popcutd/paths.hpp"

namespace popcut::daemon {
namespace {

constexpr const char* kPurpose =
    "Run the popcut job server. It queues jobs, plans their designs, and cuts each sheet after a "
    "person\nhas armed and started it.\n\n  popcutd                               # one simulated "
    "cutter, this computer only\n  popcutd --sim cameo4 --listen 127.0.0.1:9000\n  popcutd "
    "--config popcutd.toml --check-config\n\nThen, in another terminal: popcut cut sphere.json "
    "--wait\n\nWithout --config, popcutd reads ~/.config/popcut/popcutd.toml or "
    "/etc/popcut/popcutd.toml if one of\nthem exists; --print-config prints every key. Ctrl-C "
    "stops a cut "
    "at the end of its stroke.";
constexpr const char* kFooter =
    "Exit codes: 0 stopped on request; 1 internal error; 2 invalid command line; 5 an address or "
    "the\nstate folder is in use; 7 the state folder cannot be written; 78 a person must "
    "repair\nthe configuration or the database.";

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

/// Users' own tables whole: what is wrong in one must not be an empty table later.
Result<void> check_tables(const cli::UserTables& tables) {
  if (const auto all = all_machines(tables.texts); !all)
    return tl::unexpected(tables.with_file(all.error()));
  if (const auto all = all_materials(tables.texts); !all)
    return tl::unexpected(tables.with_file(all.error()));
  if (const auto all = all_stroke_profiles(tables.texts); !all)
    return tl::unexpected(tables.with_file(all.error()));
  return {};
}

/// What a device of the configuration names must be there. The place begins with the key.
Result<void> check_device(const DeviceConfig& device, const std::vector<std::string>& tables) {
  const bool simulated = device.id.rfind("sim:", 0) == 0;
  const bool by_id = simulated && device.machine.empty();
  const std::pair<const char*, std::string> machines[] = {
      {"machine", device.machine},
      {"treat_as", device.treat_as},
      {"id", by_id ? device.id.substr(4) : std::string()}};
  for (const auto& [key, name] : machines)
    if (!name.empty())
      if (const auto machine = find_driven_machine(name, tables); !machine)
        return tl::unexpected(within(key, machine.error()));
  for (const std::string& name : device.materials)
    if (const auto material = find_material(name, tables); !material)
      return tl::unexpected(within("materials", material.error()));
  if (const auto faults = cli::read_faults(device.faults); !faults)
    return tl::unexpected(within("faults", faults.error()));
  return {};
}

/// Attaches the cutters of --sim.
///
/// @retval Usage  one is no machine, or there already
Result<void> add_simulated(const DaemonOptions& options, const std::vector<std::string>& tables,
                           Config& config) {
  for (const std::string& name : options.simulated) {
    if (const auto machine = find_driven_machine(name, tables); !machine)
      return fail(ErrorKind::Usage, "--sim", machine.error().detail);
    DeviceConfig device;
    device.id = "sim:" + name;
    const bool twice =
        std::any_of(config.devices.begin(), config.devices.end(),
                    [&](const DeviceConfig& other) { return other.id == device.id; });
    if (twice)
      return fail(ErrorKind::Usage, "--sim",
                  fmt::format("{} is attached already; remove this option", device.id));
    config.devices.push_back(std::move(device));
  }
  return {};
}

/// An empty value would be the default in silence.
///
/// @retval Usage  an option is there and names nothing
Result<void> check_given(const cli::Command& app, const DaemonOptions& options) {
  const auto empty = [](const char* option, const char* right) {
    return fail(ErrorKind::Usage, option,
                fmt::format("is empty; as in {} {}, or remove it", option, right));
  };
  if (app.option("--config").is_given() && options.config.empty())
    return empty("--config", "/etc/popcut/popcutd.toml");
  if (app.option("--state").is_given() && options.state.empty())
    return empty("--state", "/var/lib/popcut");
  if (app.option("--socket").is_given() && options.socket.empty())
    return empty("--socket", "/run/popcut.sock");
  for (const std::string& name : options.simulated)
    if (name.empty()) return empty("--sim", "cameo3");
  if (options.socket.size() > kLongestSocket)
    return fail(ErrorKind::Usage, "--socket",
                fmt::format("has {} characters; a socket path has at most {}; name a shorter one",
                            options.socket.size(), kLongestSocket));
  return {};
}

/// A file in the place of the state folder is reported before anything is opened.
bool is_no_folder(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored);
}
constexpr const char* kNoFolder = "is a file; name a folder (it is created if missing)";

/// The options stand over the configuration in `found`.
///
/// @retval Usage       an option is wrong
/// @retval OutOfRange  the configuration
Result<void> take_options(const DaemonOptions& options, const std::string& found, Config& config) {
  if (!options.listen.empty()) {
    config.listen = options.listen;
    config.listen_given = true;
  }
  for (const std::string& address : options.listen)
    if (const auto valid = parse_listen(address, config.allow_remote); !valid)
      return fail(ErrorKind::Usage, "--listen", valid.error().detail);
  if (!options.socket.empty()) config.socket = options.socket;
  if (!options.state.empty()) config.state = options.state;
  if (!is_no_folder(config.state)) return {};
  if (!options.state.empty())
    return fail(ErrorKind::Usage, "--state", fmt::format("{} {}", options.state, kNoFolder));
  return tl::unexpected(within(
      found, {ErrorKind::OutOfRange, "state", fmt::format("{} {}", config.state, kNoFolder)}));
}

}  // namespace

Result<DaemonOptions> parse_options(int argc, const char* const* argv) {
  cli::Program program("popcutd", kPurpose, kFooter, "popcutd " POPCUT_VERSION);
  const cli::Command app = program.command();
  DaemonOptions options;
  app.add_option("--config", options.config, "Read this configuration (TOML)").value_text("FILE");
  app.add_flag("--check-config", options.check_config, "Check the configuration and exit");
  bool print_config = false;
  app.add_flag("--print-config", print_config,
               "Print a configuration with every key and its default, and exit");
  app.add_option("--state", options.state, "Folder for jobs, designs and plans").value_text("DIR");
  app.add_option("--listen", options.listen, "Serve HTTP at this loopback address only")
      .value_text("HOST:PORT [127.0.0.1:8631 [::1]:8631]");
  app.add_option("--socket", options.socket, "Serve HTTP at this unix socket").value_text("PATH");
  app.add_option("--sim", options.simulated, "Attach a simulated cutter; can be repeated")
      .value_text("NAME [cameo3]");
  std::string page;
  app.add_option("--help-page", page, "bash, zsh, fish or man").hidden();
  auto shown = program.read(argc, argv);
  if (!shown) return tl::unexpected(shown.error());
  if (*shown) {
    // CLI11 ends its groups with an empty line and begins the footer with another.
    std::string& help = **shown;
    if (const auto gap = help.find("\n\n\n"); gap != std::string::npos) help.erase(gap, 1);
    std::cout << help << std::flush;
    options.exit = 0;
  }
  if (const auto given = check_given(app, options); !given) return tl::unexpected(given.error());
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
  if (const auto taken = take_options(options, found, *config); !taken)
    return tl::unexpected(taken.error());
  const auto tables = cli::read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  if (const auto sound = check_tables(*tables); !sound) return tl::unexpected(sound.error());
  for (const DeviceConfig& device : config->devices)
    if (const auto right = check_device(device, tables->texts); !right)
      return tl::unexpected(
          within(found, within("device " + device.id, tables->with_file(right.error()))));
  if (const auto added = add_simulated(options, tables->texts, *config); !added)
    return tl::unexpected(added.error());
  if (config->devices.empty()) {
    DeviceConfig device;
    device.id = "sim:cameo3";
    config->devices.push_back(std::move(device));
  }
  if (config->state.empty()) config->state = paths->state;
  if (config->socket.empty() && paths) config->socket = paths->socket;
  return config;
}

}  // namespace popcut::daemon
