// SPDX-License-Identifier: MIT
#include "daemon/config/config.hpp"

#include <grp.h>
#include <pwd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>

#include <fmt/format.h>

#include "daemon/config/toml_document.hpp"
#include "device/port/device_id.hpp"

namespace popcut::daemon {
namespace {

constexpr std::int64_t kMib = 1 << 20;
constexpr double kDay = 86'400;

const std::vector<std::string> kRoles{"viewer", "submitter", "operator", "admin"};

// A key that is absent leaves `value` as it is.
void read(FieldReader& fields, const char* key, double& value, double low, double high) {
  value = fields.number(key, value, low, high);
}
template <std::integral Integer>
void read(FieldReader& fields, const char* key, Integer& value, std::int64_t low,
          std::int64_t high) {
  if (const auto found = fields.optional_integer(key, low, high))
    value = static_cast<Integer>(*found);
}
void read(FieldReader& fields, const char* key, std::string& value) {
  value = fields.text(key, value, {.controls = TextRule::Controls::None});
}
void read(FieldReader& fields, const char* key, bool& value) { value = fields.boolean(key, value); }
void read(FieldReader& fields, const char* key, std::vector<std::string>& value) {
  if (auto found = fields.optional_texts(key)) value = std::move(*found);
}
void read(FieldReader& fields, const char* key, std::string& value,
          const std::vector<std::string>& words) {
  if (const auto found = fields.optional_word(key, words)) value = words[*found];
}

void read_log(FieldReader& fields, LogConfig& log) {
  std::string form = log.form == LogForm::Json ? "json" : "text";
  read(fields, "form", form, {"text", "json"});
  log.form = form == "json" ? LogForm::Json : LogForm::Text;
  read(fields, "level", log.level, {"debug", "info", "warning", "error"});
}

void read_limits(FieldReader& fields, Config& config) {
  HttpLimits& limits = config.limits;
  read(fields, "header_bytes", limits.header_bytes, 1024, 64 << 10);
  read(fields, "json_bytes", limits.json_bytes, 1024, 64 * kMib);
  read(fields, "json_depth", limits.json_depth, 4, 64);
  read(fields, "design_bytes", limits.design_bytes, 1024, 1024 * kMib);
  read(fields, "asset_bytes", limits.asset_bytes, 1024, 4096 * kMib);
  read(fields, "connections", limits.connections, 4, 10'000);
  read(fields, "reserved_connections", limits.reserved_connections, 1, 100);
  read(fields, "streams", limits.streams, 1, 1000);
  read(fields, "uploads", limits.uploads, 1, 1000);
  read(fields, "rate_per_s", limits.rate_per_s, 0.1, 1e6);
  read(fields, "rate_burst", limits.rate_burst, 1, 1e6);
  read(fields, "previews_per_s", limits.previews_per_s, 0.1, 1e6);
  read(fields, "pictures_per_s", limits.pictures_per_s, 0.1, 1e6);
  read(fields, "failed_logins_per_minute", limits.failed_logins_per_minute, 1, 1000);
  read(fields, "header_s", limits.header_s, 0.1, 600);
  read(fields, "body_s", limits.body_s, 0.1, 3600);
  read(fields, "body_bytes_per_s", limits.body_bytes_per_s, 1, 1e9);
  read(fields, "upload_s", limits.upload_s, 1, 86'400);
  read(fields, "idle_s", limits.idle_s, 0.1, 3600);
  read(fields, "answer_s", limits.answer_s, 1, 3600);
  read(fields, "design_answer_s", limits.design_answer_s, 1, 86'400);
  read(fields, "heartbeat_s", limits.heartbeat_s, 0.1, 3600);
  read(fields, "answer_bytes", limits.answer_bytes, 16 * kMib, 65'536 * kMib);
  read(fields, "stream_events", limits.stream_events, 16, 100'000);
  read(fields, "stream_bytes", limits.stream_bytes, 4096, 64 * kMib);
  read(fields, "queue_jobs", config.queue_jobs, 1, 10'000'000);
  read(fields, "jobs_each", config.jobs_each, 1, 10'000'000);
  read(fields, "plans_each", config.plans_each, 1, 10'000'000);
  read(fields, "sheets_per_job", config.sheets_per_job, 1, 1'000'000);
}

void read_planner(FieldReader& fields, PlannerConfig& planner) {
  read(fields, "processes", planner.processes, 1, 64);
  read(fields, "cpu_s", planner.cpu_s, 1, kDay);
  read(fields, "check_s", planner.check_s, 1, kDay);
  read(fields, "wall_s", planner.wall_s, 1, kDay);
  std::int64_t memory_mib = static_cast<std::int64_t>(planner.memory_bytes) / kMib;
  std::int64_t output_mib = static_cast<std::int64_t>(planner.output_bytes) / kMib;
  read(fields, "memory_mib", memory_mib, 128, 1 << 20);
  read(fields, "output_mib", output_mib, 1, 64 << 10);
  std::int64_t together_mib = static_cast<std::int64_t>(planner.together_bytes) / kMib;
  read(fields, "together_mib", together_mib, 0, 1 << 20);
  planner.together_bytes = static_cast<std::uint64_t>(together_mib * kMib);
  planner.memory_bytes = static_cast<std::uint64_t>(memory_mib * kMib);
  planner.output_bytes = static_cast<std::uint64_t>(output_mib * kMib);
}

void check_device_id(FieldReader& fields, const DeviceConfig& device) {
  if (device.id.empty())
    return fields.refuse("id", ErrorKind::Malformed,
                         "is missing; as in id = \"sim:cameo3\" or id = \"usb:51053P\"");
  const auto parsed = parse_device_id(device.id);
  if (!parsed) return fields.refuse("id", ErrorKind::OutOfRange, parsed.error().detail);
  if (parsed->kind == DeviceKind::File)
    return fields.refuse("id", ErrorKind::OutOfRange,
                         "is a file; popcutd cannot cut on a file; use 'popcut cut --direct "
                         "--device file:NAME' to write one");
  const bool simulated = parsed->kind == DeviceKind::Simulated;
  for (const char* key : {"time_scale", "faults", "trace"})
    if (!simulated && fields.has(key))
      fields.refuse(key, ErrorKind::OutOfRange,
                    fmt::format("is only for simulated cutters; {} is not simulated", device.id));
  const bool port = parsed->kind == DeviceKind::Serial || parsed->kind == DeviceKind::Printer;
  if (port && device.machine.empty() && device.treat_as.empty())
    fields.refuse(
        "machine", ErrorKind::Malformed,
        fmt::format("is missing: {} does not identify itself; as in machine = \"hpgl-generic\"",
                    device.id));
}

void read_device(FieldReader& fields, std::vector<DeviceConfig>& devices) {
  DeviceConfig device;
  read(fields, "id", device.id);
  read(fields, "machine", device.machine);
  read(fields, "treat_as", device.treat_as);
  read(fields, "enabled", device.enabled);
  read(fields, "materials", device.materials);
  read(fields, "time_scale", device.time_scale, 0, 1e6);
  read(fields, "faults", device.faults);
  read(fields, "trace", device.trace);
  check_device_id(fields, device);
  for (const DeviceConfig& other : devices)
    if (other.id == device.id)
      fields.refuse("id", ErrorKind::OutOfRange, fmt::format("{} occurs twice", device.id));
  devices.push_back(std::move(device));
}

std::optional<std::uint32_t> uid_of(const std::string& name) {
  std::array<char, 4096> room{};
  passwd row{};
  passwd* found = nullptr;
  if (::getpwnam_r(name.c_str(), &row, room.data(), room.size(), &found) != 0 || found == nullptr)
    return std::nullopt;
  return row.pw_uid;
}

std::optional<std::uint32_t> gid_of(const std::string& name) {
  std::array<char, 16384> room{};
  group row{};
  group* found = nullptr;
  if (::getgrnam_r(name.c_str(), &row, room.data(), room.size(), &found) != 0 || found == nullptr)
    return std::nullopt;
  return row.gr_gid;
}

void read_user(FieldReader& fields, std::vector<UserRule>& users) {
  UserRule rule;
  std::string user, group, role;
  std::int64_t uid = -1, gid = -1;
  constexpr std::int64_t kMostId = 4'294'967'294;
  read(fields, "user", user);
  read(fields, "group", group);
  read(fields, "uid", uid, 0, kMostId);
  read(fields, "gid", gid, 0, kMostId);
  read(fields, "role", role, kRoles);
  const int named = static_cast<int>(!user.empty()) + static_cast<int>(!group.empty()) +
                    static_cast<int>(uid >= 0) + static_cast<int>(gid >= 0);
  if (named != 1)
    fields.refuse("user", ErrorKind::Malformed, "set one of user, group, uid and gid");
  if (role.empty())
    fields.refuse("role", ErrorKind::Malformed,
                  fmt::format("is missing; must be one of {}", fmt::join(kRoles, ", ")));
  if (uid >= 0) rule.uid = static_cast<std::uint32_t>(uid);
  if (gid >= 0) rule.gid = static_cast<std::uint32_t>(gid);
  if (!user.empty() && !(rule.uid = uid_of(user)))
    fields.refuse("user", ErrorKind::OutOfRange,
                  fmt::format("there is no user \"{}\" on this computer", user));
  if (!group.empty() && !(rule.gid = gid_of(group)))
    fields.refuse("group", ErrorKind::OutOfRange,
                  fmt::format("there is no group \"{}\" on this computer", group));
  rule.name = !user.empty()    ? user
              : !group.empty() ? "@" + group
              : rule.uid       ? fmt::format("uid {}", *rule.uid)
                               : fmt::format("gid {}", *rule.gid);
  rule.role = static_cast<Role>(std::find(kRoles.begin(), kRoles.end(), role) - kRoles.begin());
  users.push_back(std::move(rule));
}

void read_webhook(FieldReader& fields, WebhookConfig& webhook) {
  read(fields, "url", webhook.url);
  read(fields, "secret_file", webhook.secret_file);
  read(fields, "allow", webhook.allow);
  if (!webhook.url.empty() && webhook.url.rfind("http://", 0) != 0)
    fields.refuse("url", ErrorKind::OutOfRange,
                  "must begin with http://; for https put a proxy of your own before it");
  if (!webhook.url.empty() && webhook.secret_file.empty())
    fields.refuse("secret_file", ErrorKind::Malformed,
                  "is missing; it must name a file with the secret that signs each request");
  if (!webhook.url.empty() && webhook.allow.empty())
    fields.refuse(
        "allow", ErrorKind::Malformed,
        "is missing; list the hosts that popcutd may call, as in allow = [\"localhost:9000\"]");
}

void read_fleet(FieldReader& fields, FleetConfig& fleet) {
  constexpr std::string_view kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  constexpr std::size_t kLongestName = 48, kLongestSite = 64;
  read(fields, "database", fleet.database);
  read(fields, "password_file", fleet.password_file);
  read(fields, "node", fleet.node);
  read(fields, "url", fleet.url);
  fleet.site = fields.text("site", "", {1, kLongestSite, TextRule::Controls::None});
  read(fields, "lease_s", fleet.lease_s, 1, 3600);
  read(fields, "beat_s", fleet.beat_s, 0.1, 600);
  if (fleet.lease_s < 3 * fleet.beat_s)
    fields.refuse("lease_s", ErrorKind::OutOfRange,
                  "must be at least three times beat_s, so that one lost beat costs nothing");
  if (fields.has("database") && fleet.database.rfind("postgresql://", 0) != 0 &&
      fleet.database.rfind("postgres://", 0) != 0 && fleet.database.find('=') == std::string::npos)
    fields.refuse("database", ErrorKind::OutOfRange,
                  "must be the address of a PostgreSQL, as in "
                  "\"postgresql://popcut@db.lab/popcut\"");
  if (!fleet.url.empty() && fleet.url.rfind("http://", 0) != 0 &&
      fleet.url.rfind("https://", 0) != 0)
    fields.refuse("url", ErrorKind::OutOfRange,
                  "must be the address of this node's page, as in \"https://room-1.lab\"");
  if (fields.has("node") && (fleet.node.empty() || fleet.node.size() > kLongestName ||
                             fleet.node.find_first_not_of(kLetters) != std::string::npos))
    fields.refuse("node", ErrorKind::OutOfRange,
                  "must have 1 to 48 letters, digits, '-', '_' and '.'");
  const bool is_told = fields.has("node") || fields.has("url") || fields.has("site") ||
                       fields.has("lease_s") || fields.has("beat_s") || fields.has("password_file");
  if (fleet.database.empty() && is_told)
    fields.refuse("database", ErrorKind::Malformed,
                  "is missing; name the fleet's PostgreSQL, or remove [fleet]");
}

/// Whether two devices differ in what is taken at the start.
bool same_device(const DeviceConfig& a, const DeviceConfig& b) {
  return a.id == b.id && a.machine == b.machine && a.treat_as == b.treat_as &&
         a.enabled == b.enabled && a.time_scale == b.time_scale && a.faults == b.faults &&
         a.trace == b.trace;
}

void add_devices(const std::vector<DeviceConfig>& from, const std::vector<DeviceConfig>& to,
                 std::vector<std::string>& keys) {
  for (const DeviceConfig& device : from) {
    const bool same = std::any_of(to.begin(), to.end(), [&](const DeviceConfig& other) {
      return same_device(device, other);
    });
    const std::string key = "device " + device.id;
    if (!same && std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  }
}

}  // namespace

const std::string_view kReloadedKeys =
    "log.level, allowed_hosts, allowed_origins, user, limits, webhook, and materials of a device";

std::vector<std::string> restart_keys(const Config& running, const Config& wanted) {
  std::vector<std::string> keys;
  const auto add = [&](const char* key, bool same) {
    if (!same) keys.emplace_back(key);
  };
  add("listen", running.listen == wanted.listen);
  add("allow_remote", running.allow_remote == wanted.allow_remote);
  add("socket", running.socket == wanted.socket);
  add("state", running.state == wanted.state);
  add("log.form", running.log.form == wanted.log.form);
  const PlannerConfig &a = running.planner, &b = wanted.planner;
  add("planner", a.processes == b.processes && a.cpu_s == b.cpu_s && a.wall_s == b.wall_s &&
                     a.memory_bytes == b.memory_bytes && a.output_bytes == b.output_bytes);
  const FleetConfig &c = running.fleet, &d = wanted.fleet;
  add("fleet", c.database == d.database && c.password_file == d.password_file && c.node == d.node &&
                   c.url == d.url && c.site == d.site && c.lease_s == d.lease_s &&
                   c.beat_s == d.beat_s);
  add_devices(running.devices, wanted.devices, keys);
  add_devices(wanted.devices, running.devices, keys);
  return keys;
}

std::vector<UserRule> default_users() {
  std::vector<UserRule> rules;
  if (const auto gid = gid_of("popcut"))
    rules.push_back({std::nullopt, gid, "@popcut", Role::Operator});
  if (const auto gid = gid_of("popcut-admin"))
    rules.push_back({std::nullopt, gid, "@popcut-admin", Role::Admin});
  return rules;
}

Result<ListenAddress> parse_listen(std::string_view text, bool remote) {
  const auto wrong = [&](const char* why) {
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("\"{}\" {}; as in \"127.0.0.1:8631\" or \"[::1]:8631\"", text, why));
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return wrong("has no port");
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  ListenAddress address{std::string(host), 0};
  const auto [end, bad] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (bad != std::errc() || end != port.data() + port.size()) return wrong("has an invalid port");
  if (host == "localhost") address.host = "127.0.0.1";
  if (!remote && address.host.rfind("127.", 0) != 0 && address.host != "::1")
    return wrong(
        "can be reached from other computers; put a TLS proxy in front of popcutd and use a "
        "loopback address, or set allow_remote = true");
  return address;
}

Result<Config> parse_config(std::string_view text) {
  constexpr std::size_t kMostBytes = 1 << 20;
  if (text.size() > kMostBytes)
    return fail(ErrorKind::OutOfRange, "", "is larger than 1 MiB; a configuration is smaller");
  toml::table parsed;
  try {
    parsed = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    return fail(ErrorKind::Malformed, fmt::format("{}:{}", at.line, at.column),
                fmt::format("is not TOML: {}", error.description()));
  }
  Config config;
  const TomlDocument document(parsed);
  FieldReader fields(document.root(), "", document);
  read(fields, "allow_remote", config.allow_remote);
  read(fields, "listen", config.listen);
  config.listen_given = fields.has("listen");
  for (const std::string& address : config.listen)
    if (const auto valid = parse_listen(address, config.allow_remote); !valid)
      fields.refuse("listen", valid.error().kind, valid.error().detail);
  read(fields, "socket", config.socket);
  read(fields, "state", config.state);
  for (const auto& [key, value] : {std::pair{"socket", &config.socket}, {"state", &config.state}})
    if (fields.has(key) && value->empty())
      fields.refuse(key, ErrorKind::OutOfRange, "is empty; name a path or remove the key");
  if (config.socket.size() > kLongestSocket)
    fields.refuse("socket", ErrorKind::OutOfRange,
                  fmt::format("has {} characters; a socket path has at most {}; name a shorter one",
                              config.socket.size(), kLongestSocket));
  read(fields, "allowed_hosts", config.allowed_hosts);
  read(fields, "allowed_origins", config.allowed_origins);
  fields.optional_object("log", [&](FieldReader& log) { read_log(log, config.log); });
  fields.optional_objects("device", [&](FieldReader& one) { read_device(one, config.devices); });
  fields.optional_object("limits", [&](FieldReader& some) { read_limits(some, config); });
  fields.optional_object("planner", [&](FieldReader& some) { read_planner(some, config.planner); });
  fields.optional_object("fleet", [&](FieldReader& some) { read_fleet(some, config.fleet); });
  fields.optional_objects("user", [&](FieldReader& one) { read_user(one, config.users); });
  fields.optional_object("webhook", [&](FieldReader& some) { read_webhook(some, config.webhook); });
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return config;
}

}  // namespace popcut::daemon
