// SPDX-License-Identifier: MIT
#include <random>
#include <string>

#include <catch2/catch.hpp>

#include "daemon/config/config.hpp"
#include "daemon/config/default_text.hpp"
#include "tests/support/process.hpp"

namespace config_test {

using namespace popcut;
using namespace popcut::daemon;

namespace {

void refused(const std::string& text, const std::string& place, const std::string& telling) {
  CAPTURE(text);
  const auto config = parse_config(text);
  REQUIRE_FALSE(config);
  CHECK(config.error().place == place);
  CAPTURE(config.error().detail);
  CHECK(config.error().detail.find(telling) != std::string::npos);
}

}  // namespace

TEST_CASE("an empty configuration means loopback and the documented limits", "[daemon][config]") {
  const auto config = parse_config("");
  REQUIRE(config);
  CHECK(config->listen == std::vector<std::string>{"127.0.0.1:8631", "[::1]:8631"});
  CHECK_FALSE(config->listen_given);
  CHECK(config->devices.empty());
  CHECK(config->limits.header_bytes == 8192);
  CHECK(config->limits.json_bytes == 262'144);
  CHECK(config->limits.json_depth == 32);
  CHECK(config->limits.design_bytes == 33'554'432);
  CHECK(config->limits.connections == 64);
  CHECK(config->limits.streams == 16);
  CHECK(config->limits.rate_per_s == 20);
  CHECK(config->limits.rate_burst == 60);
  CHECK(config->queue_jobs == 50'000);
  CHECK(config->sheets_per_job == 10'000);
  CHECK(config->planner.memory_bytes == std::uint64_t{2} << 30);
  CHECK(config->webhook.url.empty());
}

TEST_CASE("a node's lease is at least three beats", "[daemon][config]") {
  const std::string fleet = "[fleet]\ndatabase = \"postgresql://db/popcut\"\n";
  const auto usual = parse_config(fleet);
  REQUIRE(usual);
  CHECK(usual->fleet.lease_s == 30);
  CHECK(usual->fleet.beat_s == 5);
  const auto quick = parse_config(fleet + "lease_s = 2\nbeat_s = 0.5\n");
  REQUIRE(quick);
  CHECK(quick->fleet.lease_s == 2);
  CHECK(quick->fleet.beat_s == 0.5);
  CHECK(restart_keys(*usual, *quick) == std::vector<std::string>{"fleet"});
  refused(fleet + "lease_s = 10", "3:11: fleet.lease_s", "at least three times beat_s");
  refused(fleet + "lease_s = 0.5", "3:11: fleet.lease_s", "");
  refused(fleet + "lease_s = 4000", "3:11: fleet.lease_s", "");
  refused(fleet + "beat_s = 0", "3:10: fleet.beat_s", "");
  refused("[fleet]\nlease_s = 30", "1:1: fleet.database", "is missing");
}

TEST_CASE("the site of a node's cutters is one line", "[daemon][config]") {
  const std::string fleet = "[fleet]\ndatabase = \"postgresql://db/popcut\"\n";
  const auto there = parse_config(fleet + "site = \"ground floor\"");
  REQUIRE(there);
  CHECK(there->fleet.site == "ground floor");
  CHECK(parse_config(fleet)->fleet.site.empty());
  CHECK(restart_keys(*parse_config(fleet), *there) == std::vector<std::string>{"fleet"});
  CHECK(parse_config(fleet + "site = \"" + std::string(64, 'x') + "\""));
  refused(fleet + "site = \"" + std::string(65, 'x') + "\"", "3:8: fleet.site", "64");
  refused(fleet + "site = \"\"", "3:8: fleet.site", "");
  refused(fleet + "site = \"a\\nb\"", "3:8: fleet.site", "");
  refused(fleet + "site = 3", "3:8: fleet.site", "text");
  refused("[fleet]\nsite = \"a\"", "1:1: fleet.database", "is missing");
}

TEST_CASE("every key of the configuration is read", "[daemon][config]") {
  const auto config = parse_config(R"(
listen = ["127.0.0.1:0"]
socket = "/run/popcut.sock"
state = "/var/lib/popcut"
allowed_hosts = ["localhost", "cutter.lab"]
[log]
form = "json"
level = "debug"
[[device]]
id = "sim:cameo3"
time_scale = 0
trace = "/tmp/traces"
[[device]]
id = "serial:/dev/ttyUSB0,baud=38400"
machine = "hpgl-generic"
enabled = false
[limits]
json_depth = 16
rate_per_s = 1000
[planner]
processes = 2
memory_mib = 512
[[user]]
user = "root"
role = "admin"
[[user]]
gid = 1000
role = "operator"
[webhook]
url = "http://localhost:9000/hook"
secret_file = "/etc/popcut/hook"
allow = ["localhost:9000"]
)");
  INFO((config ? "" : message(config.error())));
  REQUIRE(config);
  CHECK(config->listen_given);
  CHECK(config->log.form == LogForm::Json);
  REQUIRE(config->devices.size() == 2);
  CHECK(config->devices[0].time_scale == 0);
  CHECK_FALSE(config->devices[1].enabled);
  CHECK(config->limits.json_depth == 16);
  CHECK(config->planner.memory_bytes == 512u << 20);
  REQUIRE(config->users.size() == 2);
  CHECK(config->users[0].uid == 0u);
  CHECK(config->users[0].role == Role::Admin);
  CHECK(config->users[1].gid == 1000u);
  CHECK(config->users[1].role == Role::Operator);
}

TEST_CASE("an invalid configuration is refused with line and column and the valid form",
          "[daemon][config]") {
  refused("listn = []", "1:1: listn", "did you mean listen?");
  refused("[limits]\njson_dept = 3", "2:1: limits.json_dept", "did you mean json_depth?");
  refused("[limits]\njson_depth = 3", "2:14: limits.json_depth",
          "must be a whole number from 4 to 64");
  refused("[limits]\njson_depth = \"3\"", "2:14: limits.json_depth", "must be a whole number");
  refused("[limits]\nrate_per_s = nan", "2:14: limits.rate_per_s", "must be");
  refused("limits = 3", "1:10: limits", "must be a table, [limits]");
  refused("device = {id = \"sim:cameo3\"}", "1:10: device", "[[device]]");
  refused("[[device]]\nmachine = \"cameo3\"", "1:1: device.id", "is missing");
  refused("[[device]]\nid = \"what\"", "2:6: device.id", "sim:");
  refused("[[device]]\nid = \"file:x\"", "2:6: device.id", "file");
  refused("[[device]]\nid = \"usb:1\"\ntime_scale = 2", "3:14: device.time_scale", "simulated");
  refused("[[device]]\nid = \"serial:/dev/ttyUSB0\"", "1:1: device.machine", "hpgl-generic");
  refused("[[device]]\nid = \"sim:cameo3\"\n[[device]]\nid = \"sim:cameo3\"", "4:6: device.id",
          "twice");
  refused("[[user]]\nuser = \"nobody-of-that-name\"\nrole = \"admin\"", "2:8: user.user",
          "no user");
  refused("[[user]]\nuid = 1\nrole = \"admn\"", "3:8: user.role", "did you mean admin?");
  refused("[[user]]\nrole = \"admin\"", "1:1: user.user", "one of user, group, uid and gid");
  refused("listen = [\"0.0.0.0:8631\"]", "1:10: listen", "TLS proxy");
  refused("listen = [\"127.0.0.1:99999\"]", "1:10: listen", "port");
  refused("[webhook]\nurl = \"http://x\"", "1:1: webhook.secret_file", "is missing");
  refused("[log]\nform = \"xml\"", "2:8: log.form", "one of text, json");
  refused("state = \"a\\u0007b\"", "1:9: state", "control character");
  refused("state = \"\"", "1:9: state", "is empty; name a path");
  refused("socket = \"\"", "1:10: socket", "is empty; name a path");
  refused("socket = \"/" + std::string(107, 'x') + "\"", "1:10: socket",
          "has 108 characters; a socket path has at most 107");
  refused("listen = [", "1:11", "is not TOML");
  refused("listen = []\nlisten = []", "2:10", "is not TOML");
}

TEST_CASE("the printed configuration names every key with its default", "[daemon][config]") {
  CHECK(parse_config(kConfigText));
  // Without the #, all but the examples of what has no default must read as the defaults do.
  std::string text(kConfigText);
  for (std::size_t at = 0; (at = text.find("\n#", at)) != std::string::npos; ++at)
    if (text[at + 2] != ' ') text.erase(at + 1, 1);
  const std::size_t group = text.find("group = \"popcut\"");
  text.replace(group, 16, "gid = 1234       ");
  const auto config = parse_config(text);
  INFO((config ? "" : message(config.error())));
  REQUIRE(config);
  const Config usual;
  CHECK(config->listen == usual.listen);
  CHECK(config->log.level == usual.log.level);
  CHECK(config->queue_jobs == usual.queue_jobs);
  CHECK(config->sheets_per_job == usual.sheets_per_job);
  CHECK(config->planner.processes == usual.planner.processes);
  CHECK(config->planner.memory_bytes == usual.planner.memory_bytes);
  CHECK(config->planner.output_bytes == usual.planner.output_bytes);
  CHECK(config->planner.cpu_s == usual.planner.cpu_s);
  CHECK(config->planner.wall_s == usual.planner.wall_s);
  REQUIRE(config->devices.size() == 3);
  CHECK(config->devices[0].time_scale == DeviceConfig{}.time_scale);
  const HttpLimits& a = config->limits;
  const HttpLimits b;
  CHECK(a.header_bytes == b.header_bytes);
  CHECK(a.json_bytes == b.json_bytes);
  CHECK(a.json_depth == b.json_depth);
  CHECK(a.design_bytes == b.design_bytes);
  CHECK(a.asset_bytes == b.asset_bytes);
  CHECK(a.connections == b.connections);
  CHECK(a.reserved_connections == b.reserved_connections);
  CHECK(a.streams == b.streams);
  CHECK(a.uploads == b.uploads);
  CHECK(a.rate_per_s == b.rate_per_s);
  CHECK(a.rate_burst == b.rate_burst);
  CHECK(a.failed_logins_per_minute == b.failed_logins_per_minute);
  CHECK(a.header_s == b.header_s);
  CHECK(a.body_s == b.body_s);
  CHECK(a.body_bytes_per_s == b.body_bytes_per_s);
  CHECK(a.idle_s == b.idle_s);
  CHECK(a.answer_s == b.answer_s);
  CHECK(a.design_answer_s == b.design_answer_s);
  CHECK(a.heartbeat_s == b.heartbeat_s);
  CHECK(a.answer_bytes == b.answer_bytes);
  CHECK(a.stream_events == b.stream_events);
  CHECK(a.stream_bytes == b.stream_bytes);
}

TEST_CASE("keys that apply while popcutd runs are distinguished from those that need a restart",
          "[daemon][config]") {
  const auto config = [](const std::string& text) { return parse_config(text).value(); };
  const Config running = config("[[device]]\nid = \"sim:cameo3\"\n");
  CHECK(restart_keys(running, running).empty());
  CHECK(restart_keys(running, config(R"(
allowed_hosts = ["cutter.lab:8631"]
[log]
level = "debug"
[[device]]
id = "sim:cameo3"
materials = ["paper-220"]
[[user]]
uid = 7
role = "viewer"
[limits]
rate_per_s = 3
queue_jobs = 7
[webhook]
url = "http://localhost:9/"
secret_file = "/s"
allow = ["localhost:9"]
)"))
            .empty());
  CHECK(restart_keys(running, config(R"(
listen = ["127.0.0.1:1"]
state = "/var/lib/popcut"
[log]
form = "json"
[[device]]
id = "sim:cameo3"
time_scale = 3
[[device]]
id = "sim:cameo4"
[planner]
processes = 2
)")) == std::vector<std::string>{"listen", "state", "log.form", "planner", "device sim:cameo3",
                                 "device sim:cameo4"});
  CHECK(restart_keys(running, config("")) == std::vector<std::string>{"device sim:cameo3"});
  CHECK(config("[[device]]\nid = \"sim:cameo3\"\nmaterials = [\"pp-150\"]").devices[0].materials ==
        std::vector<std::string>{"pp-150"});
  refused("[[device]]\nid = \"sim:cameo3\"\nmaterials = \"pp-150\"", "3:13: device.materials",
          "must be a list of texts");
}

TEST_CASE("random text is never a valid configuration and never crashes popcut",
          "[daemon][config]") {
  std::mt19937 random(20261121);
  const std::string seed = "listen=[\"127.0.0.1:1\"]\n[[device]]\nid=\"sim:cameo3\"\n[limits]\n";
  int lawful = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string text = seed;
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = static_cast<char>(random() % 256);
    const auto config = parse_config(text);
    lawful += config ? 1 : 0;
    if (!config) CHECK_FALSE(config.error().detail.empty());
  }
  CHECK(lawful < 1000);
  CHECK(parse_config("# \xC3\xA9\nstate = \"/home/\xC3\xA9\"")->state == "/home/\xC3\xA9");
  CHECK_FALSE(parse_config(std::string(100'000, '[')));
  CHECK_FALSE(parse_config("x = " + std::string(100'000, '[')));
  CHECK_FALSE(parse_config(std::string((1 << 20) + 1, ' ')));
}

}  // namespace config_test
