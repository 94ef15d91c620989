// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_health.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <fmt/format.h>

#include "daemon/fleet/fleet_nodes.hpp"
#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/fleet_url.hpp"
#include "daemon/fleet/postgres_database.hpp"

namespace popcut::daemon {
namespace {

using Level = FleetFinding::Level;

constexpr std::int64_t kClock_ms = 2000;  // what nobody notices, and what a slow answer looks like

std::int64_t system_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class Look {
 public:
  explicit Look(const FleetProbe& probe) : probe_(probe), url_(FleetUrl::parse(probe.url)) {}

  std::vector<FleetFinding> run() {
    try {
      PostgresDatabase database(
          {.url = probe_.url, .password = probe_.password, .name = "popcut doctor"}, false);
      if (connects(database) && fits(database)) {
        login(database);
        clock(database);
        const std::vector<NodeState> nodes = fleet_nodes(database);
        this_node(nodes);
        other_nodes(nodes);
        failover(database);
        primaries();
      }
      transport();
    } catch (const StoreFault& fault) {
      add(Level::Problem, fmt::format("the fleet's database says: {}", fault.what()));
    }
    return std::move(found_);
  }

 private:
  void add(Level level, std::string what, std::string remedy = "") {
    found_.push_back({level, std::move(what), std::move(remedy)});
  }
  void fine(std::string what) { add(Level::Fine, std::move(what)); }
  void note(std::string what, std::string remedy = "") {
    add(Level::Note, std::move(what), std::move(remedy));
  }
  void problem(std::string what, std::string remedy = "") {
    add(Level::Problem, std::move(what), std::move(remedy));
  }
  [[nodiscard]] std::string join_again() const {
    return fmt::format("as the administrator of the database: popcut fleet join --node {} --again",
                       probe_.node);
  }

  bool connects(PostgresDatabase& database) {
    if (database.is_there()) {
      fine(fmt::format("the fleet's database answers: {}", url_.shown()));
      return true;
    }
    if (database.is_refused())
      problem(
          fmt::format("the fleet's database does not let this node in: {}", database.why_away()),
          "compare 'database' and 'password_file' of [fleet] with what 'popcut fleet join' "
          "printed; for a new password, " +
              join_again());
    else
      problem(
          fmt::format("the fleet's database does not answer at {}: {}", url_.shown(),
                      database.why_away()),
          "start PostgreSQL, or repair the network; until then popcutd finishes the sheet under "
          "the knife and starts nothing");
    return false;
  }

  bool fits(Database& database) {
    try {
      const std::string misfit = schema_misfit(database);
      if (misfit.empty()) {
        fine(fmt::format("its tables fit this popcut (version {})",
                         database.number("SELECT version FROM popcut.popcut_schema")));
        return true;
      }
      const std::size_t cut = misfit.find("; ");
      problem(misfit.substr(0, cut), cut == std::string::npos ? "" : misfit.substr(cut + 2));
    } catch (const StoreFault& fault) {
      if (fault.kind() != FaultKind::Other) throw;
      problem("the login of [fleet] may not read the fleet's tables", join_again());
    }
    return false;
  }

  void login(Database& database) {
    const std::string login =
        first_of(database.rows("SELECT session_user::text"), first_text).value_or("");
    const auto wanted = first_of(
        database.rows("SELECT login FROM popcut.node WHERE name=?", probe_.node), first_text);
    const bool owns =
        database.number("SELECT pg_has_role(session_user, 'popcut_owner', 'MEMBER')::int") != 0;
    if (owns)
      note(fmt::format("the login {} may do anything in the fleet's database", login),
           fmt::format("give the node one of its own: popcut fleet join --node {}", probe_.node));
    else if (wanted && *wanted != login)
      problem(
          fmt::format("node {} has the login {}, and [fleet] has {}", probe_.node, *wanted, login),
          "correct 'node' or 'database' in [fleet]");
    else
      fine(fmt::format("the login {} is that of node {}", login, probe_.node));
  }

  void clock(Database& database) {
    const auto now = probe_.now_ms ? probe_.now_ms : system_ms;
    const std::int64_t before = now();
    const std::int64_t there =
        database.number("SELECT (extract(epoch FROM clock_timestamp())*1000)::bigint");
    const std::int64_t after = now(), ahead = there - (before + after) / 2;
    if (std::abs(ahead) <= kClock_ms + (after - before))
      fine("this machine's clock agrees with the database's");
    else
      note(fmt::format("this machine's clock is {} {} the database's, which popcut uses",
                       rough_time(std::abs(ahead) / 1000), ahead > 0 ? "behind" : "ahead of"),
           "timedatectl set-ntp true");
  }

  void this_node(const std::vector<NodeState>& nodes) {
    const std::string& name = probe_.node;
    const auto at = std::find_if(nodes.begin(), nodes.end(),
                                 [&](const NodeState& node) { return node.name == name; });
    if (at == nodes.end())
      return problem(
          fmt::format("the fleet has no node {}", name),
          fmt::format("as the administrator of the database: popcut fleet join --node {}", name));
    if (at->draining)
      note(fmt::format("node {} is being drained: it arms no sheet", name),
           fmt::format("popcut fleet drain {} --undo", name));
    if (at->epoch == 0)
      return note(fmt::format("node {} has joined, and its popcutd was never started", name),
                  "start popcutd");
    if (at->alive && !at->reported)
      return note(
          fmt::format("the database went back to an earlier state; node {} is alive, and "
                      "compares its journals within seconds",
                      name));
    if (at->alive)
      return fine(fmt::format("node {} is alive; its lease lasts {:.0f} s and is renewed", name,
                              at->lease_s));
    if (at->ended)
      return note(
          fmt::format("node {} was stopped in order {} ago", name, rough_time(at->heartbeat_s)),
          "start popcutd");
    problem(fmt::format("node {} has no lease: its popcutd was last heard {} ago", name,
                        rough_time(at->heartbeat_s)),
            "start popcutd; if it runs, its log says why it does not reach the database");
  }

  void other_nodes(const std::vector<NodeState>& nodes) {
    std::int64_t alive = 0;
    for (const NodeState& node : nodes) {
      alive += node.alive ? 1 : 0;
      if (node.name == probe_.node || node.epoch == 0) continue;
      if (!node.reported)
        problem(
            fmt::format("no sheet can be armed: the database went back to an earlier state, and "
                        "node {} has not compared its journals with it since",
                        node.name),
            fmt::format("start its popcutd; if it is gone for good: popcut fleet forget {}",
                        node.name));
      else if (!node.alive && !node.ended)
        note(fmt::format("node {} is silent for {}", node.name, rough_time(node.heartbeat_s)),
             fmt::format("look at it; if it is gone for good: popcut fleet forget {}", node.name));
    }
    fine(fmt::format("{} of {} nodes are alive", alive, nodes.size()));
  }

  // What a START is worth: whether it is still known after the disk, or the machine, of the
  // database is lost.
  void failover(Database& database) {
    const auto setting = [&](const char* name) {
      return first_of(database.rows("SELECT current_setting(?)", name), first_text).value_or("");
    };
    const std::string commit = setting("synchronous_commit"),
                      named = setting("synchronous_standby_names");
    const std::int64_t standbys = database.number(
        "SELECT count(*) FROM pg_stat_replication WHERE application_name IS NULL OR "
        "application_name NOT IN ('pg_basebackup', 'pg_receivewal')");
    if (setting("fsync") == "off" || setting("full_page_writes") == "off")
      problem(
          "the database does not wait for its disk (fsync or full_page_writes is off): after a "
          "power cut it may have lost a START, or everything",
          "set both to on in postgresql.conf");
    if (commit == "off")
      return problem(
          "commits do not wait for the disk (synchronous_commit = off): a crash of the database "
          "may "
          "lose a START",
          "set synchronous_commit = on in postgresql.conf");
    if (named.empty() && standbys == 0)
      return note("the database has no standby: if its machine is lost, a backup must be restored",
                  "set up a standby and backups (docs/fleet.md#backup)");
    if (named.empty())
      return note(
          "a standby follows without being waited for: a failover may lose the last commits, and "
          "with "
          "them a START; then nobody arms a sheet until every node has compared its journals",
          "set synchronous_standby_names to lose none (docs/fleet.md#failover)");
    if (standbys == 0)
      return problem(
          "the database waits for a standby, and none is connected: nothing can be changed",
          "start the standby, or remove it from synchronous_standby_names");
    if (commit == "local")
      return note(
          "synchronous_commit = local: a START does not wait for the standby, and a failover "
          "may lose it",
          "set synchronous_commit = on in postgresql.conf");
    if (commit == "remote_write")
      return note(
          "synchronous_commit = remote_write: a START is lost if both database machines lose power",
          "set synchronous_commit = on in postgresql.conf");
    fine("each START is on the disk of a standby before the knife moves: a failover loses none");
  }

  // Each goes its own way from the moment that the second one takes writes.
  void primaries() {
    const std::vector<FleetUrl> each = url_.each_host();
    std::vector<std::string> write;
    for (const FleetUrl& one : each) {
      if (each.size() == 1) return;
      PostgresDatabase database(
          {.url = one.text(), .password = probe_.password, .name = "popcut doctor"}, false);
      if (database.is_there()) write.push_back(one.shown());
    }
    if (write.size() > 1)
      problem(fmt::format("{} databases of this address take writes: {}", write.size(),
                          fmt::join(write, " and ")),
              "stop the old one at once, and make it a standby of the other before it starts again "
              "(docs/fleet.md#failover)");
  }

  void transport() {
    if (!url_.is_remote() || url_.value("sslmode") == "verify-full") return;
    note("the connection does not check that it speaks to the right database",
         "add sslmode=verify-full to 'database' (docs/fleet.md#tls)");
  }

  const FleetProbe& probe_;
  FleetUrl url_;
  std::vector<FleetFinding> found_;
};

}  // namespace

std::vector<FleetFinding> fleet_findings(const FleetProbe& probe) { return Look(probe).run(); }

}  // namespace popcut::daemon
