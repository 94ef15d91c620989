// SPDX-License-Identifier: MIT
#include "tests/support/fleet_nodes.hpp"

#include <algorithm>
#include <csignal>
#include <stdexcept>

#include <fmt/format.h>

#include "daemon/fleet/fleet_schema.hpp"

namespace popcut::testing {

namespace fs = std::filesystem;

std::string join_fleet(const PostgresServer& server, const std::string& database,
                       const std::string& node, const std::string& password) {
  std::string login = "popcut_n_" + node;
  std::replace(login.begin(), login.end(), '-', '_');
  add_node_role(server, login, password);
  server.run_sql(fmt::format("SELECT popcut.node_join('{}', '{}')", node, login), database);
  return login;
}

FleetNodes::FleetNodes(Options options)
    : options_(options),
      server_(
          {.tcp = options.tcp, .more = options.database_more, .place = options.database_place}) {
  server_.create_database(kDatabase);
  run_sql(std::string(daemon::fleet_schema()));
  for (int k = 1; k <= options_.nodes; ++k) join_fleet(server_, kDatabase, name(k), kPassword);
  if (options_.standby != Options::Standby::None)
    standby_.reset(new PostgresServer(
        PostgresServer::standby_of(server_, options_.standby == Options::Standby::Synchronous
                                                ? PostgresServer::Commits::Synchronous
                                                : PostgresServer::Commits::Asynchronous)));
  for (int k = 1; k <= options_.nodes; ++k) {
    if (options_.proxies) proxies_.push_back(std::make_unique<FaultProxy>(server_.socket()));
    if (options_.proxies && standby_)
      standby_proxies_.push_back(std::make_unique<FaultProxy>(standby_->socket()));
    const bool is_other = k == 1 && options_.first_time_scale >= 0;
    nodes_.push_back(
        std::make_unique<RunningDaemon>(is_other ? options_.first_time_scale : options_.time_scale,
                                        section(k) + options_.more, device(k)));
  }
}

std::string FleetNodes::url(int node, bool by_proxy) const {
  std::string login = "popcut_n_" + name(node);
  std::replace(login.begin(), login.end(), '-', '_');
  const std::size_t k = index(node);
  if (!standby_) {
    if (by_proxy) return proxies_.at(k)->url(kDatabase, login);
    return options_.tcp ? server_.tcp_url(kDatabase, login, "") : server_.url(kDatabase, login);
  }
  // FOLDER/.s.PGSQL.PORT
  const fs::path first = by_proxy ? proxies_.at(k)->socket() : server_.socket();
  const fs::path second = by_proxy ? standby_proxies_.at(k)->socket() : standby_->socket();
  return fmt::format("postgresql://{}@/{}?host={},{}&port={},{}&target_session_attrs=read-write",
                     login, kDatabase, first.parent_path().string(), second.parent_path().string(),
                     first.extension().string().substr(1), second.extension().string().substr(1));
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

void FleetNodes::open(int node, const std::vector<std::string>& environment) {
  (*this)[node].open(environment);
  if (!happens([&] { return is_alive(node); }))
    throw std::runtime_error(name(node) + " gets no lease: " + (*this)[node].daemon().log());
}

void FleetNodes::promote() {
  standby_->promote();
  ask_standby();
}

void FleetNodes::ask_standby() { primary_ = standby_.get(); }

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
  if (!happens([&] { return here.device_state(device(for_cutter_of)) == "idle"; }))
    throw std::runtime_error(name(at) + " does not see " + device(for_cutter_of));
  std::string job = here.ready_job(design, device(for_cutter_of));
  return job;
}

std::set<int> FleetNodes::lines_cut(int node, int lines) {
  return testing::lines_cut((*this)[node].daemon().folder() / "trace", lines);
}

}  // namespace popcut::testing
