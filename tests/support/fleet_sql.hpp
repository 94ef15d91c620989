// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/postgres_server.hpp"

namespace popcut::testing {

/// A connection to a fleet's database as one login, with the tables' schema in its search path.
/// Statements that are given together are one transaction, unless they say BEGIN and COMMIT.
class FleetLine {
 public:
  explicit FleetLine(const std::string& url);
  ~FleetLine();
  FleetLine(FleetLine&& other) noexcept;
  FleetLine& operator=(FleetLine&&) = delete;

  /// The rows of the last statement as `psql -At` prints them. Throws what libpqxx throws.
  std::string operator()(const std::string& sql);
  /// As above; if it is refused: the SQLSTATE and the first line of what was said, and what was
  /// open is rolled back: "PC001 there is no node x".
  std::string tried(const std::string& sql);
  /// Runs a statement that is prepared once and kept by its text, with $1 and so on for parameters.
  /// The first column of its first row; empty without one.
  std::string prepared(const std::string& sql, const std::vector<std::string>& values);

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

/// A database of its own with a fleet's schema, which is daemon/fleet/schema.sql.
class FleetSql {
 public:
  explicit FleetSql(PostgresServer& server = shared_postgres());
  /// By the superuser, who may speak for every node.
  std::string operator()(const std::string& sql) { return admin_(sql); }
  std::string tried(const std::string& sql) { return admin_.tried(sql); }
  /// A new connection; a login that is not there yet is made, as one of nodes.
  [[nodiscard]] FleetLine line(const std::string& login);
  [[nodiscard]] FreshDatabase& database() { return database_; }

  /// The id with that name: 26 characters.
  [[nodiscard]] static std::string id(const std::string& name);
  [[nodiscard]] static std::string plan_sha256() { return std::string(64, 'a'); }
  /// A job of one sheet that is ready, of the one plan that there is.
  void add_job(const std::string& name, const std::string& owner = "anna");
  /// A cutter that is there.
  void add_device(const std::string& name, const std::string& node);

 private:
  PostgresServer& server_;
  FreshDatabase database_;
  FleetLine admin_;
};

/// One INSERT into `job`, of a job of that id in the state `ready`.
[[nodiscard]] std::string new_job_sql(const std::string& id, const std::string& owner);
/// Many at once, of many owners, with the ids J00... of those numbers; without a device, and
/// finished if that is their state.
[[nodiscard]] std::string new_jobs_sql(std::int64_t first, std::int64_t last,
                                       const std::string& state);
[[nodiscard]] std::string new_plan_sql();

/// What a popcutd does as a node. Each function is a transaction; it gives back what `tried` does.
class FleetNode {
 public:
  FleetNode(FleetSql& fleet, std::string name, const std::string& login);

  /// Begins a life and says that the journals are compared.
  std::string begin(const std::string& identity = "");
  std::string begin_only(const std::string& identity, const std::string& epoch_before = "NULL",
                         std::int64_t last_event = 0);
  std::string beat(double lease_s = 30);
  std::string arm(const std::string& job, const std::string& device);
  std::string start(const std::string& attempt, const std::string& job, const std::string& device,
                    std::int64_t least_fence = 0);
  std::string mark(const std::string& attempt, int certain, int taken, int intended, int bytes);
  /// All of it certain, and the job done.
  std::string finish(const std::string& attempt, const std::string& job);
  /// Alone, without the job: "knife_end(...)" and so on, with the node and its epoch filled in.
  std::string call(const std::string& function, const std::string& values);
  [[nodiscard]] std::string call_sql(const std::string& function, const std::string& values) const;

  std::string name;
  std::string epoch{"0"};
  FleetLine line;
};

}  // namespace popcut::testing
