// SPDX-License-Identifier: MIT
#include "daemon/popcutd/paths.hpp"

namespace popcut::daemon {
namespace {

/// A variable that is an absolute path, else empty. systemd separates several with colons.
std::string folder_of(const client::Environment& environment, const char* name) {
  const char* const value = environment(name);
  if (value == nullptr || *value != '/') return {};
  const std::string text = value;
  return text.substr(0, text.find(':'));
}

}  // namespace

Result<Paths> default_paths(const client::Environment& environment, bool root) {
  Paths paths;
  const std::string service_state = folder_of(environment, "STATE_DIRECTORY");
  const std::string run = folder_of(environment, "XDG_RUNTIME_DIR");
  paths.state = !service_state.empty() ? service_state : client::user_state_folder(environment);
  if (paths.state.empty())
    return fail(
        ErrorKind::Usage, "--state",
        "is missing, and neither HOME nor XDG_STATE_HOME is set; as in --state /var/lib/popcut");
  if (!service_state.empty() || (run.empty() && root))
    paths.socket = "/run/popcut.sock";
  else
    paths.socket = (run.empty() ? paths.state : run) + "/popcut.sock";
  paths.configurations = client::configuration_files(environment);
  return paths;
}

}  // namespace popcut::daemon
