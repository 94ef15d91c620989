// SPDX-License-Identifier: MIT
#include "tests/support/fleet_nodes.hpp"

#include <algorithm>
#include <csignal>
#include <stdexcept>

#include <fmt/format.h>

#include "daemon/fleet/fleet_schema.hpp"

namespace popcut::testing {

std::string join_fleet(const PostgresServer& server, const std::string& database,
                       const std::string& node, const std::string& password) {
  std::string login = "popcut_n_" + node;
  std::replace(login.begin(), login.end(), '-', '_');
  // Roles are common to all databases of a server.
  server.run_sql(
      fmt::format("DO $$ BEGIN IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname='{0}') THEN "
                  "CREATE ROLE {0} LOGIN PASSWORD '{1}'; END IF; END $$; "
                  "GRANT popcut_node TO {0}; SELECT popcut.node_join('{2}', '{0}')",
                  login, password, node),
      database);
  return login;
}

FleetNodes::FleetNodes(Options options) : options_(options), server_({.tcp = options.tcp}) {
  server_.create_database(kDatabase);
  run_sql(std::string(daemon::fleet_schema()));
  for (int k = 1; k <= options_.nodes; ++k) {
    join_fleet(server_, kDatabase, name(k), kPassword);
    if (options_.proxies) proxies_.push_back(std::make_unique<FaultProxy>(server_.socket()));
    nodes_.push_back(std::make_unique<RunningDaemon>(options_.time_scale,
                                                     section(k) + options_.more, device(k)));
  }
}

std::string FleetNodes::url(int node) const {
  std::string login = "popcut_n_" + name(node);
  std::replace(login.begin(), login.end(), '-', '_');
  if (options_.proxies) return proxies_.at(index(node))->url(kDatabase, login);
  if (options_.tcp) return server_.tcp_url(kDatabase, login, "");
  return server_.url(kDatabase, login);
}

std::string FleetNodes::section(int node) const {
  return fmt::format(
      "[fleet]\ndatabase = \"{0}\"\nnode = \"{1}\"\nurl = \"http://{1}.lab\"\nlease_s = "
      "{2}\nbeat_s = {3}\n",
      url(node), name(node), options_.lease_s, options_.beat_s);
}

void FleetNodes::open() {
  for (int k = 1; k <= size(); ++k) open(k);
}

void FleetNodes::open(int node) {
  (*this)[node].open();
  if (!happens([&] { return is_alive(node); }, 20))
    throw std::runtime_error(name(node) + " gets no lease: " + (*this)[node].daemon().log());
}

void FleetNodes::kill(int node) {
  (*this)[node].daemon().signal(SIGKILL);
  (*this)[node].daemon().wait();
}

bool FleetNodes::is_alive(int node) const {
  return run_sql(fmt::format("SELECT count(*) FROM popcut.node WHERE name='{}' AND "
                             "lease_until>clock_timestamp() AND "
                             "generation=popcut.popcut_generation()",
                             name(node))) == "1";
}

std::string FleetNodes::ready_job(int at, int for_cutter_of, int lines, double length_mm) {
  RunningDaemon& here = (*this)[at];
  const std::string design = here.design(RunningDaemon::lines_svg(lines, length_mm));
  if (!happens([&] { return here.device_state(device(for_cutter_of)) == "idle"; }, 10))
    throw std::runtime_error(name(at) + " does not see " + device(for_cutter_of));
  std::string job = here.ready_job(design, device(for_cutter_of));
  return job;
}

std::set<int> FleetNodes::lines_cut(int node, int lines) {
  return testing::lines_cut((*this)[node].daemon().folder() / "trace", lines);
}

}  // namespace popcut::testing
