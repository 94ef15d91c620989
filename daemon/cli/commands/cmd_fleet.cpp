// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/utf8.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/fleet/fleet_import.hpp"
#include "daemon/fleet/fleet_nodes.hpp"
#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/fleet_url.hpp"
#include "daemon/fleet/postgres_database.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::cli {
namespace fleet_command {
namespace {

using daemon::Database;
using daemon::FaultKind;
using daemon::FleetUrl;
using daemon::PostgresDatabase;
using daemon::StoreFault;
using Json = nlohmann::ordered_json;

constexpr const char* kVariable = "POPCUT_FLEET_DATABASE";
constexpr double kPatient_s = 600;  // a large table may take long

Result<FleetUrl> wanted_database(const std::string& given) {
  std::string text = given;
  if (text.empty())
    if (const char* const set = std::getenv(kVariable)) text = set;
  if (text.empty())
    return fail(ErrorKind::Usage, "--database",
                fmt::format("is missing; give the fleet's PostgreSQL, as in --database "
                            "postgresql://postgres@db.lab/popcut, or set {}",
                            kVariable));
  if (text.find("://") == std::string::npos && text.find('=') == std::string::npos)
    return fail(ErrorKind::Usage, "--database",
                fmt::format("\"{}\" is not the address of a database; give one as "
                            "postgresql://postgres@db.lab/popcut",
                            text));
  return FleetUrl::parse(text);
}

// "ERROR:  permission denied to create role (CREATE ROLE ...)": without the statement, which helps
// nobody at a terminal.
std::string plain_words(std::string text) {
  constexpr std::string_view kError = "ERROR:";
  if (text.starts_with(kError)) text.erase(0, text.find_first_not_of(' ', kError.size()));
  for (const char* word : {"SELECT", "INSERT", "UPDATE", "CREATE", "ALTER", "GRANT", "DROP", "SET",
                           "-- SPDX", "COMMIT"})
    text.resize(std::min(text.find(fmt::format(" ({}", word)), text.size()));
  return text;
}

Error trouble(const FleetUrl& url, const StoreFault& fault) {
  std::string detail = plain_words(fault.what());
  if (fault.kind() == FaultKind::Other && (detail.find("permission denied") != std::string::npos ||
                                           detail.find("must ") != std::string::npos))
    detail += "; give --database a role that may, such as the one of 'popcut fleet init'";
  if (fault.kind() == FaultKind::Away) detail += "; check the address and that PostgreSQL runs";
  if (fault.kind() == FaultKind::InDoubt)
    detail += "; popcut does not know whether it was done: type the command again";
  return {ErrorKind::Refused, url.shown(), std::move(detail)};
}

/// Connects, does it, and gives what was thrown as an error.
template <typename Work>
Result<void> with_database(const std::string& given, Work work) {
  const Result<FleetUrl> url = wanted_database(given);
  if (!url) return tl::unexpected(url.error());
  try {
    PostgresDatabase database({.url = url->text(), .name = "popcut fleet", .answer_s = kPatient_s});
    return work(database, *url);
  } catch (const StoreFault& fault) {
    return tl::unexpected(trouble(*url, fault));
  }
}

void add_database(const Command& command, std::string& database) {
  command
      .add_option("--database", database,
                  "Address of the fleet's PostgreSQL, with a role that may do this; put the "
                  "password into ~/.pgpass. Default: $POPCUT_FLEET_DATABASE")
      .value_text("URL");
}

void add_node(const Command& command, std::string& node, const char* what) {
  command.add_option("NODE", node, what).required().value_text("NODE");
}

// init

/// Creates the database itself, if it is not there and the role may.
///
/// @return whether it did
/// @throws StoreFault  as the statements
bool create_database(const FleetUrl& url) {
  FleetUrl other = url;
  other.database = "postgres";
  PostgresDatabase server({.url = other.text(), .name = "popcut fleet", .answer_s = kPatient_s});
  if (server.number("SELECT count(*) FROM pg_catalog.pg_database WHERE datname=?", url.database) >
      0)
    return false;
  std::string quoted;
  for (const char c : url.database) quoted += c == '"' ? "\"\"" : std::string(1, c);
  server.script(fmt::format("CREATE DATABASE \"{}\" ENCODING 'UTF8' TEMPLATE template0", quoted));
  return true;
}

Result<void> run_init(const std::string& given, const Globals& globals) {
  const Result<FleetUrl> url = wanted_database(given);
  if (!url) return tl::unexpected(url.error());
  if (url->database.empty())
    return fail(ErrorKind::Usage, "--database",
                "names no database; add one, as in postgresql://postgres@db.lab/popcut");
  bool created = false;
  try {
    PostgresDatabase probe({.url = url->text(), .name = "popcut fleet"}, false);
    if (!probe.is_there()) {
      if (!probe.is_refused()) throw StoreFault(FaultKind::Away, probe.why_away());
      // Also a wrong password is a refusal; then this is refused in the same words.
      created = create_database(*url);
    }
  } catch (const StoreFault& fault) {
    return tl::unexpected(trouble(*url, fault));
  }
  return with_database(url->text(), [&](Database& database, const FleetUrl&) -> Result<void> {
    const daemon::FleetMade made = daemon::make_fleet(database);
    const Json document{
        {"created_database", created}, {"version_before", made.from}, {"version", made.to}};
    return answer(globals, document, [&] {
      if (globals.quiet) return;
      if (created) fmt::print("created the database {}\n", url->database);
      if (made.from == made.to)
        fmt::print("nothing to do: the tables of the fleet exist (version {})\n", made.to);
      else if (made.from == 0)
        fmt::print("made the tables and roles of the fleet (version {})\n", made.to);
      else
        fmt::print("brought the tables from version {} to {}\n", made.from, made.to);
      if (made.from == 0)
        fmt::print(stderr, "next, for each machine: popcut fleet join --node NAME\n");
    });
  });
}

constexpr const char* kInitHelp =
    "Make a fleet's tables and roles in a PostgreSQL database, or bring them up to date.\n\n"
    "  sudo -u postgres popcut fleet init --database postgresql:///popcut\n"
    "  popcut fleet init --database postgresql://postgres@db.lab/popcut\n\n"
    "It creates the database if it does not exist. You can run it again at any time. After an\n"
    "upgrade of popcut, it updates the tables; nodes of the previous version keep working. The\n"
    "role needs CREATEROLE, and CREATEDB if the database does not exist.";

void add_init(const Command& fleet, const Globals& globals, Run& run) {
  auto database = std::make_shared<std::string>();
  const Command command = fleet.add_command("init", kInitHelp);
  add_database(command, *database);
  when_chosen(command, run, [database, &globals] { return run_init(*database, globals); });
}

// join

struct JoinOptions {
  std::string database, node, url, folder, address;
  bool again{false};
};

std::string toml_text(const std::string& text) { return Json(text).dump(); }

std::string configuration_of(const JoinOptions& options, const FleetUrl& url,
                             const std::string& password_file) {
  std::string text =
      fmt::format("[fleet]\ndatabase = {}\npassword_file = {}\nnode = {}\n", toml_text(url.text()),
                  toml_text(password_file), toml_text(options.node));
  if (!options.url.empty()) text += fmt::format("url = {}\n", toml_text(options.url));
  return text;
}

Result<void> run_join(const JoinOptions& options, const Globals& globals) {
  return with_database(options.database, [&](Database& database, FleetUrl url) -> Result<void> {
    std::string file = "/etc/popcut/fleet.password";
    if (!options.folder.empty()) {
      std::error_code failed;
      const auto folder = std::filesystem::absolute(options.folder, failed).lexically_normal();
      file = (folder / "fleet.password").string();
      // What cannot be kept must not be made: the server would be told a password that is lost.
      if (const Result<void> can = daemon::write_file(file + ".new", ""); !can)
        return fail(ErrorKind::Unwritable, "--write", message(can.error()));
      daemon::remove_tree(file + ".new");
    }
    const daemon::JoinedNode joined = daemon::join_node(database, options.node, options.again);
    if (!options.folder.empty())
      if (const Result<void> kept = daemon::write_file(file, joined.password + "\n"); !kept)
        return fail(ErrorKind::Unwritable, "--write",
                    fmt::format("{}; type the command again with --again", message(kept.error())));
    url.user = joined.login;
    url.password.clear();
    if (!options.address.empty()) {
      url.hosts = options.address;
      std::erase_if(url.more, [](const auto& one) {
        return one.first == "host" || one.first == "hostaddr" || one.first == "port" ||
               one.first == "user";
      });
      // What is enough on one machine is not enough in a network.
      const std::string mode = url.value("sslmode");
      if (url.is_remote() &&
          (mode.empty() || mode == "disable" || mode == "allow" || mode == "prefer")) {
        std::erase_if(url.more, [](const auto& one) { return one.first == "sslmode"; });
        url.more.emplace_back("sslmode", "verify-full");
      }
    }
    const std::string section = configuration_of(options, url, file);
    if (globals.json) {
      Json json{{"node", options.node}, {"login", joined.login}, {"password_file", file}};
      if (options.folder.empty()) json["password"] = joined.password;
      json["configuration"] = section;
      print_json(json);
      return {};
    }
    fmt::print("{}", section);
    std::fflush(stdout);
    if (globals.quiet) return {};
    if (options.folder.empty())
      fmt::print(stderr,
                 "\nPut the lines above at the end of popcutd.toml on {0}. There, put the password "
                 "into {1}:\n\n  install -m 600 /dev/stdin {1} <<< {2}\n\npopcut does not show it "
                 "again. Then restart popcutd.\n",
                 options.node, file, joined.password);
    else
      fmt::print(stderr,
                 "\nThe password is in {}. Put the lines above at the end of popcutd.toml on {}, "
                 "and restart popcutd.\n",
                 file, options.node);
    if (url.is_remote() && url.value("sslmode") != "verify-full")
      fmt::print(stderr,
                 "The database is on another machine: add sslmode=verify-full to the address "
                 "(docs/fleet.md#tls).\n");
    return {};
  });
}

constexpr const char* kJoinHelp =
    "Let a machine into the fleet: make its login, and print what its popcutd.toml needs.\n\n"
    "  popcut fleet join --node room-1 --url https://room-1.lab\n"
    "  sudo -u postgres popcut fleet join --database postgresql:///popcut --address db.lab \\\n"
    "    --node room-1                              # on the machine of the database\n"
    "  popcut fleet join --node room-1 --write /etc/popcut >> /etc/popcut/popcutd.toml\n"
    "  popcut fleet join --node room-1 --again      # a new password; the old one stops working\n\n"
    "Each node has its own login, with only the permissions that it needs.";

void add_join(const Command& fleet, const Globals& globals, Run& run) {
  auto options = std::make_shared<JoinOptions>();
  const Command command = fleet.add_command("join", kJoinHelp);
  add_database(command, options->database);
  command.add_option("--node", options->node, "Name of the node, as in room-1")
      .required()
      .value_text("NAME");
  command.add_option("--url", options->url, "Where people reach this node's page")
      .value_text("URL");
  command
      .add_option("--address", options->address,
                  "Where the node reaches the database, as in db.lab or db1.lab,db2.lab:5433. "
                  "Default: as in --database")
      .value_text("HOST[:PORT]");
  command
      .add_option("--write", options->folder,
                  "Write the password to DIR/fleet.password (mode 0600) instead of printing it")
      .value_text("DIR");
  command.add_flag("--again", options->again, "Give a node that has joined a new password");
  when_chosen(command, run, [options, &globals] { return run_join(*options, globals); });
}

// nodes, drain, forget

std::string state_of(const daemon::NodeState& node) {
  if (node.epoch == 0) return "never started";
  std::string text = node.alive ? fmt::format("alive for {}", daemon::rough_time(node.begun_s))
                     : node.ended
                         ? fmt::format("stopped {} ago", daemon::rough_time(node.heartbeat_s))
                         : fmt::format("silent for {}", daemon::rough_time(node.heartbeat_s));
  if (node.draining) text += ", draining";
  if (!node.reported) text += ", has journals to compare";
  return text;
}

Json to_json(const daemon::NodeState& node) {
  Json json{{"name", node.name},       {"alive", node.alive},       {"draining", node.draining},
            {"stopped", node.ended},   {"reported", node.reported}, {"epoch", node.epoch},
            {"login", node.login},     {"url", node.url},           {"version", node.version},
            {"devices", node.devices}, {"site", node.site}};
  if (node.epoch > 0) {
    json["begun_s_ago"] = node.begun_s;
    json["heartbeat_s_ago"] = node.heartbeat_s;
  }
  if (node.alive) json["lease_s"] = node.lease_s;
  return json;
}

Result<void> run_nodes(const std::string& given, const Globals& globals) {
  return with_database(given, [&](Database& database, const FleetUrl&) -> Result<void> {
    const auto nodes = daemon::fleet_nodes(database);
    if (globals.json) {
      print_json(Json{{"nodes", json_list(nodes, to_json)}});
      return {};
    }
    if (nodes.empty()) {
      if (!globals.quiet)
        fmt::print(stderr,
                   "the fleet has no nodes yet; let one in with: popcut fleet join --node NAME\n");
      return {};
    }
    std::size_t name_width = 4, state_width = 5;
    for (const auto& node : nodes) {
      name_width = std::max(name_width, node.name.size());
      state_width = std::max(state_width, state_of(node).size());
    }
    fmt::print("{:<{}}  {:<{}}  {:>8}  {:<13}  {:<10}  {}\n", "NODE", name_width, "STATE",
               state_width, "LEASE", "EPOCH", "VERSION", "CUTTERS AND PAGE");
    for (const auto& node : nodes) {
      std::string last = fmt::format("{}", fmt::join(node.devices, ", "));
      if (!node.site.empty()) last += " at " + node.site;
      if (!node.url.empty()) last += (last.empty() ? "" : "  ") + node.url;
      fmt::print("{:<{}}  {:<{}}  {:>8}  {:<13}  {:<10}  {}\n", node.name, name_width,
                 state_of(node), state_width,
                 node.alive ? fmt::format("{:.0f} s", node.lease_s) : "none", node.epoch,
                 node.version.empty() ? "-" : shown_text(node.version), shown_text(last));
    }
    return {};
  });
}

struct NodeOptions {
  std::string database, node;
  bool undo{false};
};

Result<void> run_drain(const NodeOptions& options, const Globals& globals) {
  return with_database(options.database, [&](Database& database, const FleetUrl&) -> Result<void> {
    daemon::drain_node(database, options.node, !options.undo);
    if (globals.json)
      print_json(Json{{"node", options.node}, {"draining", !options.undo}});
    else if (!globals.quiet && options.undo)
      fmt::print("node {} arms sheets again\n", options.node);
    else if (!globals.quiet)
      fmt::print("node {0} arms nothing more; a sheet under the knife is finished\n", options.node);
    return {};
  });
}

Result<void> run_forget(const NodeOptions& options, const Globals& globals) {
  return with_database(options.database, [&](Database& database, const FleetUrl&) -> Result<void> {
    const std::string login = daemon::forget_node(database, options.node);
    return answer(globals, Json{{"node", options.node}, {"login_left", login}}, [&] {
      if (globals.quiet) return;
      fmt::print("node {} is forgotten\n", options.node);
      if (!login.empty())
        fmt::print(stderr,
                   "its login still exists, because your role may not remove it; with a role that "
                   "may, run: DROP ROLE {}\n",
                   login);
    });
  });
}

constexpr const char* kNodesHelp =
    "List the machines of the fleet: who is alive, with which cutters, and where.\n\n"
    "  popcut fleet nodes\n"
    "  popcut fleet nodes --json | jq '.nodes[] | select(.alive | not)'";
constexpr const char* kDrainHelp =
    "Let a node finish its cut and arm no further sheet, for example before an upgrade.\n\n"
    "  popcut fleet drain room-1\n"
    "  popcut fleet drain room-1 --undo";
constexpr const char* kForgetHelp =
    "Remove a machine that does not come back, with its login.\n\n"
    "  popcut fleet forget room-1\n\n"
    "popcut does not remove a node that is alive, or whose last cut has no recorded end. After "
    "you\n"
    "restore the database, no node arms a sheet until every node has compared its journals. "
    "Remove\n"
    "a node that does not come back; what only its journal knows is then lost.";

void add_nodes(const Command& fleet, const Globals& globals, Run& run) {
  auto database = std::make_shared<std::string>();
  const Command nodes = fleet.add_command("nodes", kNodesHelp);
  add_database(nodes, *database);
  when_chosen(nodes, run, [database, &globals] { return run_nodes(*database, globals); });

  auto drained = std::make_shared<NodeOptions>();
  const Command drain = fleet.add_command("drain", kDrainHelp);
  add_node(drain, drained->node, "The node, as 'popcut fleet nodes' lists it");
  add_database(drain, drained->database);
  drain.add_flag("--undo", drained->undo, "Let it arm sheets again");
  when_chosen(drain, run, [drained, &globals] { return run_drain(*drained, globals); });

  auto forgotten = std::make_shared<NodeOptions>();
  const Command forget = fleet.add_command("forget", kForgetHelp);
  add_node(forget, forgotten->node, "The node, as 'popcut fleet nodes' lists it");
  add_database(forget, forgotten->database);
  when_chosen(forget, run, [forgotten, &globals] { return run_forget(*forgotten, globals); });
}

// import

struct ImportOptions {
  std::string database, node, folder;
};

void print_imported(const daemon::Imported& done) {
  for (const auto& table : done.tables)
    if (table.rows + table.kept > 0)
      fmt::print("{:<12} {:>8} rows{}\n", table.name, table.rows,
                 table.kept > 0 ? fmt::format(", {} as the fleet has them", table.kept) : "");
  fmt::print("{:<12} {:>8} files, {:.1f} MB\n", "files", done.files,
             static_cast<double>(done.bytes) / 1e6);
  for (const std::string& file : done.missing)
    fmt::print(stderr, "{}: is missing or damaged in the folder, and was not moved\n",
               shown_text(file));
  fmt::print(stderr,
             "the database that was in the folder is now {}\nnext: add the [fleet] section of "
             "'popcut fleet join' to popcutd.toml, keep 'state' as it is, and start popcutd\n",
             done.original);
}

Result<void> run_import(const ImportOptions& options, const Globals& globals) {
  return with_database(options.database, [&](Database& database, const FleetUrl&) -> Result<void> {
    daemon::ImportRequest request{.folder = options.folder, .node = options.node};
    if (!globals.json && !globals.quiet && globals.verbose > 0)
      request.report = [](const std::string& what) { fmt::print(stderr, "moving {}\n", what); };
    const auto done = daemon::import_folder(database, request);
    if (!done) return fail(ErrorKind::Refused, "", message(done.error()));
    const Json tables = json_list(done->tables, [](const auto& table) {
      return Json{{"table", table.name}, {"rows", table.rows}, {"kept", table.kept}};
    });
    const Json document{{"tables", tables},
                        {"files", done->files},
                        {"bytes", done->bytes},
                        {"missing", done->missing},
                        {"original", done->original}};
    return answer(globals, document, [&] {
      if (!globals.quiet) print_imported(*done);
    });
  });
}

constexpr const char* kImportHelp =
    "Move the jobs of a standalone popcutd into the fleet, as jobs of a node.\n\n"
    "  systemctl stop popcutd.socket popcutd.service\n"
    "  popcut fleet join --node room-1 --write /etc/popcut >> /etc/popcut/popcutd.toml\n"
    "  popcut fleet import --node room-1 --state /var/lib/private/popcut\n"
    "  systemctl start popcutd.socket\n\n"
    "All of it moves, or nothing: jobs, plans, ledgers, events, tokens and files, with their ids.\n"
    "Tokens keep working, at every node. The folder stays the node's state folder; its database\n"
    "goes to backups/. If a sheet is armed or a cut has no recorded end, first start popcutd once\n"
    "without [fleet].";

void add_import(const Command& fleet, const Globals& globals, Run& run) {
  auto options = std::make_shared<ImportOptions>();
  const Command command = fleet.add_command("import", kImportHelp);
  add_database(command, options->database);
  command.add_option("--state", options->folder, "State folder of the popcutd, which must not run")
      .required()
      .value_text("DIR");
  command.add_option("--node", options->node, "The node that gets the jobs; it must have joined")
      .required()
      .value_text("NAME");
  when_chosen(command, run, [options, &globals] { return run_import(*options, globals); });
}

constexpr const char* kHelp =
    "Set up and look after several popcutd that share one queue (docs/fleet.md).\n\n"
    "  export POPCUT_FLEET_DATABASE=postgresql://postgres@db.lab/popcut\n"
    "  popcut fleet init                      # once: the tables and roles\n"
    "  popcut fleet join --node room-1        # for each machine: its login\n"
    "  popcut fleet nodes                     # who is alive\n"
    "  popcut fleet drain room-1              # before work on a machine\n"
    "  popcut fleet forget room-1             # remove a node that does not come back\n"
    "  popcut fleet import --node room-1 --state DIR   # move a standalone popcutd";

}  // namespace
}  // namespace fleet_command

void register_fleet(const Command& app, const Globals& globals, Run& run) {
  using namespace fleet_command;
  const Command fleet = app.add_command("fleet", kHelp);
  fleet.needs_command(1, 1);
  add_init(fleet, globals, run);
  add_join(fleet, globals, run);
  add_nodes(fleet, globals, run);
  add_import(fleet, globals, run);
}

}  // namespace popcut::cli
