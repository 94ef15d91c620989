// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "daemon/model/limits.hpp"
#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// A cutter that popcutd drives.
struct DeviceConfig {
  std::string id;          ///< "sim:cameo3", "usb:51053P", "serial:/dev/ttyUSB0"
  std::string machine{};   ///< of a port, which does not identify the machine behind it
  std::string treat_as{};  ///< drive an unknown model as this machine
  bool enabled{true};
  std::vector<std::string> materials{};  ///< it is set up for; none: any
  double time_scale{20};  ///< simulated: times as fast as the machine; 0: on a virtual clock
  std::string faults{};   ///< simulated: a fault script's file
  std::string trace{};    ///< simulated: folder for what the knife did, a JSON file a sheet
};

/// Who may use the unix socket, by the peer's credentials: a user or a group.
struct UserRule {
  std::optional<std::uint32_t> uid{}, gid{};
  std::string name{};  ///< as it was written, "alice" or "@popcut"
  Role role{};
};

struct PlannerConfig {
  int processes{1};
  double cpu_s{600};
  double check_s{60};  ///< of a check, for which somebody waits
  double wall_s{1200};
  std::uint64_t memory_bytes{std::uint64_t{2} << 30};
  std::uint64_t output_bytes{std::uint64_t{1} << 30};
  std::uint64_t together_bytes{0};  ///< memory of all workers; 0: what this computer can give
};

/// Where events of jobs are sent; off unless a URL is given.
struct WebhookConfig {
  std::string url{};
  std::string secret_file{};
  std::vector<std::string> allow{};  ///< "host:port" that may be called
};

/// The fleet of which this popcutd is a node; off unless a database is given.
struct FleetConfig {
  std::string database{};  ///< "postgresql://..."
  std::string password_file{};
  std::string node{};  ///< empty: the machine's name
  std::string url{};   ///< where people reach this node's page; empty: its first HTTP address
  std::string site{};  ///< where its cutters stand: "ground floor"
  double lease_s{30};  ///< it is thought lost when it has not answered for so long
  double beat_s{5};    ///< between renewals of the lease
};

enum class LogForm : std::uint8_t { Text, Json };
struct LogConfig {
  LogForm form{LogForm::Text};
  std::string level{"info"};
};

/// popcutd's configuration. Empty members have a default that depends on the user (`paths.hpp`).
struct Config {
  std::vector<std::string> listen{"127.0.0.1:8631", "[::1]:8631"};
  bool listen_given{false};  ///< by the file: each address must then be had
  std::string socket{};
  std::string state{};
  /// Names besides localhost, 127.0.0.1 and [::1] under which it is reached: "cutter.lab:8631".
  std::vector<std::string> allowed_hosts{};
  std::vector<std::string> allowed_origins{};  ///< of its page behind a proxy: "https://cutter.lab"
  bool allow_remote{false};  ///< addresses that others reach; a proxy with TLS must be before them
  LogConfig log{};
  std::vector<DeviceConfig> devices{};  ///< none: one simulated cutter
  HttpLimits limits{};
  std::int64_t queue_jobs{50'000}, jobs_each{25'000}, plans_each{1000};
  int sheets_per_job{10'000};
  PlannerConfig planner{};
  std::vector<UserRule> users{};
  WebhookConfig webhook{};
  FleetConfig fleet{};
};

/// The most bytes that the path of a unix socket may have (sun_path).
constexpr std::size_t kLongestSocket = 107;

/// Reads a configuration in TOML. Strict: an unknown key, another type or a value out of range is
/// an error at its line and column. Users and groups are looked up on this machine.
///
/// @retval Malformed   not TOML, or an unknown key; place is "line:column: key"
/// @retval OutOfRange  an invalid value
[[nodiscard]] Result<Config> parse_config(std::string_view text);

/// Who may use the unix socket if the configuration lists nobody: the members of the
/// groups popcut (operator) and popcut-admin (admin), where there are such groups.
[[nodiscard]] std::vector<UserRule> default_users();

/// The keys in which two configurations differ and that are taken at the next start only, as
/// "listen", "device sim:cameo3", "planner"; what a running popcutd takes on SIGHUP is not among
/// them.
[[nodiscard]] std::vector<std::string> restart_keys(const Config& running, const Config& wanted);
/// What a running popcutd reloads on SIGHUP, for messages.
extern const std::string_view kReloadedKeys;

/// "127.0.0.1:8631", "[::1]:0" or "localhost:8631" as host (without brackets) and port.
struct ListenAddress {
  std::string host;
  std::uint16_t port{};
};
/// @retval OutOfRange  it is none, or is not of this computer alone and `remote` is false
[[nodiscard]] Result<ListenAddress> parse_listen(std::string_view text, bool remote = false);

}  // namespace popcut::daemon
