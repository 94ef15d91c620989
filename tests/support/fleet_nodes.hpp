// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/support/fault_proxy.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/running_daemon.hpp"

namespace popcut::testing {

/// Several popcutd that share one queue: each with a folder and a simulated cutter of its own
/// ("sim:room-1", ...), and a person who asks it. Node k is called "room-K", from 1.
class FleetNodes {
 public:
  struct Options {
    int nodes{2};
    double time_scale{0};         ///< of the cutters; 0: at once
    double first_time_scale{-1};  ///< of the first node's, if it is another
    double lease_s{4}, beat_s{0.4};
    bool proxies{false};  ///< a FaultProxy between each node and the database
    bool tcp{false};      ///< the nodes come by 127.0.0.1, with the password `password`
    std::string more{};   ///< at the end of each node's configuration
    std::filesystem::path database_place{};  ///< where the database has its folder
    std::string database_more{};             ///< lines of its postgresql.conf
    enum class Standby { None, Asynchronous, Synchronous };
    Standby standby{Standby::None};  ///< a second database, which nodes find by the same address
  };
  static constexpr const char* kPassword = "four word pass phrase";
  static constexpr const char* kDatabase = "popcut";

  /// Starts the PostgreSQL, and makes its tables and roles; starts no node yet.
  explicit FleetNodes(Options options);
  FleetNodes() : FleetNodes(Options{}) {}

  /// Starts all nodes and waits until each has its lease.
  void open();
  /// Starts one, and waits until it has its lease.
  void open(int node, const std::vector<std::string>& environment = {});
  [[nodiscard]] RunningDaemon& operator[](int node) { return *nodes_.at(index(node)); }
  [[nodiscard]] FaultProxy& proxy(int node) { return *proxies_.at(index(node)); }
  /// Between a node and the standby; with `proxies`.
  [[nodiscard]] FaultProxy& proxy_to_standby(int node) { return *standby_proxies_.at(index(node)); }
  /// The first primary, also when it is one no more.
  [[nodiscard]] PostgresServer& server() { return server_; }
  [[nodiscard]] PostgresServer& standby() { return *standby_; }
  /// The standby takes over, and is asked.
  void promote();
  /// What is asked of the database from now on is asked of the standby.
  void ask_standby();
  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] const Options& options() const { return options_; }

  [[nodiscard]] static std::string name(int node) { return "room-" + std::to_string(node); }
  [[nodiscard]] static std::string device(int node) { return "sim:" + name(node); }
  /// The [fleet] of a node, to which a test may add.
  [[nodiscard]] std::string section(int node) const;
  /// Where the node finds the database: through its proxy, if it has one.
  [[nodiscard]] std::string url(int node) const { return url(node, options_.proxies); }
  /// The same past its proxies.
  [[nodiscard]] std::string direct_url(int node) const { return url(node, false); }
  /// SIGKILL, and waits for its end.
  void kill(int node);
  /// As superuser, in the fleet's database.
  std::string run_sql(const std::string& sql) const { return primary_->run_sql(sql, kDatabase); }
  /// Whether a node's lease lives.
  [[nodiscard]] bool is_alive(int node) const;

  /// Queues a drawing of `lines` lines at one node for the cutter of another; waits until it is
  /// ready there.
  [[nodiscard]] std::string ready_job(int at, int for_cutter_of, int lines, double length_mm = 5);
  /// Lines of `RunningDaemon::lines_svg` that a node's cutter cut in its last attempt.
  [[nodiscard]] std::set<int> lines_cut(int node, int lines);

 private:
  [[nodiscard]] std::string url(int node, bool by_proxy) const;
  [[nodiscard]] std::size_t index(int node) const { return static_cast<std::size_t>(node - 1); }
  Options options_;
  PostgresServer server_;
  std::unique_ptr<PostgresServer> standby_;
  PostgresServer* primary_{&server_};
  std::vector<std::unique_ptr<FaultProxy>> proxies_, standby_proxies_;
  std::vector<std::unique_ptr<RunningDaemon>> nodes_;
};

/// A login for a node, as `popcut fleet join` makes it; its name.
std::string join_fleet(const PostgresServer& server, const std::string& database,
                       const std::string& node, const std::string& password = "");

}  // namespace popcut::testing
