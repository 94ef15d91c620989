// SPDX-License-Identifier: MIT
#include "tests/support/fleet_sql.hpp"

#include <unordered_map>

#include <fmt/format.h>

#include <pqxx/pqxx>

#include "daemon/fleet/fleet_schema.hpp"

namespace popcut::testing {
namespace {

std::string rows_of(const pqxx::result& answer) {
  std::string text;
  for (const auto& row : answer) {
    if (!text.empty()) text += '\n';
    for (int column = 0; column < static_cast<int>(row.size()); ++column) {
      if (column > 0) text += '|';
      text += row[static_cast<pqxx::row::size_type>(column)].c_str();
    }
  }
  return text;
}

std::string first_line(std::string text) {
  text.resize(std::min(text.find('\n'), text.size()));
  constexpr std::string_view kError = "ERROR:  ";
  if (text.starts_with(kError)) text.erase(0, kError.size());
  return text;
}

// libpqxx 6 keeps no SQLSTATE in some of its exceptions.
std::string state_of(const pqxx::failure& refused) {
  if (dynamic_cast<const pqxx::insufficient_privilege*>(&refused) != nullptr) return "42501";
  if (dynamic_cast<const pqxx::deadlock_detected*>(&refused) != nullptr) return "40P01";
  const auto* const error = dynamic_cast<const pqxx::sql_error*>(&refused);
  return error == nullptr ? "" : error->sqlstate();
}

}  // namespace

struct FleetLine::Open {
  explicit Open(const std::string& url) : connection(url) {}
  pqxx::connection connection;
  std::unordered_map<std::string, std::string> names;
};

FleetLine::FleetLine(const std::string& url) : open_(std::make_unique<Open>(url)) {
  (*this)("SET search_path = popcut");
}
FleetLine::~FleetLine() = default;
FleetLine::FleetLine(FleetLine&& other) noexcept = default;

std::string FleetLine::operator()(const std::string& sql) {
  pqxx::nontransaction work(open_->connection);
  return rows_of(work.exec(sql));
}

std::string FleetLine::tried(const std::string& sql) {
  try {
    return (*this)(sql);
  } catch (const pqxx::broken_connection&) {
    throw;
  } catch (const pqxx::failure& refused) {
    const std::string said = state_of(refused) + " " + first_line(refused.what());
    (*this)("ROLLBACK");
    return said;
  }
}

std::string FleetLine::prepared(const std::string& sql, const std::vector<std::string>& values) {
  pqxx::nontransaction work(open_->connection);
  auto known = open_->names.find(sql);
  if (known == open_->names.end()) {
    std::string name = fmt::format("s{}", open_->names.size());
    open_->connection.prepare(name, sql);
    known = open_->names.emplace(sql, std::move(name)).first;
  }
  const pqxx::result answer =
      work.exec_prepared(known->second, pqxx::prepare::make_dynamic_params(values));
  return answer.empty() || answer.columns() == 0 ? std::string() : answer[0][0].c_str();
}

std::string new_plan_sql() {
  return fmt::format(
      "INSERT INTO plan(id, key, kind, design, material, machine, state, sha256, sheets, paths, "
      "cut_mm, low_s, high_s, width_mm, length_mm, warnings, error, options, machine_json, "
      "material_json, created) VALUES('{}', 'k', 'design', 'd', 'card', 'portrait', 'planned', "
      "'{}', 1, 10, 100, 60, 90, 210, 297, '[]', '', '{{}}', '{{}}', '{{}}', 1)",
      FleetSql::id("PLAN"), FleetSql::plan_sha256());
}

namespace {

constexpr std::string_view kNewJob =
    "INSERT INTO job(id, rev, state, reason, asked, name, note, owner, operator, "
    "requested_device, device, design, plan, material, priority, position, copies, held, "
    "sheets_total, sheet, blank, "
    "segment, first_stroke, paths_certain, paths_sent, paths_total, done_paths, done_mm, low_s, "
    "high_s, created, finished, outcome, tags, attention_kind, attention_text, attention_since) ";

}  // namespace

std::string new_job_sql(const std::string& id, const std::string& owner) {
  return fmt::format(
      "{}VALUES('{}', 1, 'ready', '', '', 'card', '', '{}', '', '', '', 'd', '{}', 'card', 0, 1, "
      "1, 0, 1, 1, 1, 1, 0, 0, 0, 10, 0, 0, 60, 90, 1, NULL, '', '[]', 'load_sheet', 'load sheet "
      "1 of 1', 1)",
      kNewJob, id, owner, FleetSql::id("PLAN"));
}

std::string new_jobs_sql(std::int64_t first, std::int64_t last, const std::string& state) {
  const bool ended = state == "done" || state == "failed" || state == "cancelled";
  return fmt::format(
      "{}SELECT 'J' || lpad(n::text, 25, '0'), 1, '{}', '', '', 'card ' || n, '', 'owner-' || n % "
      "1000, '', '', '', 'd', '{}', 'card', 0, n * 1048576::bigint, 1, 0, 1, 1, 1, 1, 0, 0, 0, 10, "
      "0, 0, "
      "60, 90, n, {}, '', '[]', 'load_sheet', 'load sheet 1 of 1', 1 FROM generate_series({}, {}) "
      "n",
      kNewJob, state, FleetSql::id("PLAN"), ended ? "n" : "NULL", first, last);
}

namespace {

// As one transaction: statements that are sent together.
std::string prepared_database(FreshDatabase& database) {
  database.run_sql(std::string(daemon::fleet_schema()));
  return database.url();
}

}  // namespace

FleetSql::FleetSql(PostgresServer& server)
    : database_(server), admin_(prepared_database(database_)) {
  admin_(new_plan_sql());
}

FleetLine FleetSql::line(const std::string& login) {
  admin_(fmt::format(
      "DO $$ BEGIN IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname='{0}') THEN CREATE ROLE {0} "
      "LOGIN; GRANT popcut_node TO {0}; END IF; END $$",
      login));
  return FleetLine(database_.url(login));
}

std::string FleetSql::id(const std::string& name) {
  return std::string(26 - name.size(), '0') + name;
}

void FleetSql::add_job(const std::string& name, const std::string& owner) {
  admin_(new_job_sql(id(name), owner));
}

void FleetSql::add_device(const std::string& name, const std::string& node) {
  admin_(fmt::format(
      "INSERT INTO device(id, rev, model, title, simulated, width_mm, length_mm, enabled, state, "
      "sheets_done, cut_mm, node) VALUES('{}', 1, 'portrait', '', 1, 210, 297, 1, 'idle', 0, 0, "
      "'{}')",
      name, node));
}

FleetNode::FleetNode(FleetSql& fleet, std::string node, const std::string& login)
    : name(std::move(node)), line(fleet.line(login)) {}

std::string FleetNode::begin_only(const std::string& identity, const std::string& epoch_before,
                                  std::int64_t last_event) {
  const std::string said = line.tried(
      fmt::format("SELECT epoch FROM node_begin('{}', '{}', 'http://{}', '1.0', {}, {})", name,
                  identity.empty() ? name : identity, name, epoch_before, last_event));
  if (said.find(' ') != std::string::npos) return said;
  epoch = said;
  return {};
}

std::string FleetNode::begin(const std::string& identity) {
  const std::string said = begin_only(identity);
  return said.empty() ? line.tried(fmt::format("SELECT node_reported('{}', {})", name, epoch))
                      : said;
}

std::string FleetNode::beat(double lease_s) {
  return line.tried(
      fmt::format("SELECT alive FROM node_beat('{}', {}, {}, 0)", name, epoch, lease_s));
}

std::string FleetNode::call_sql(const std::string& function, const std::string& values) const {
  return fmt::format("SELECT {}('{}', {}{}{});", function, name, epoch, values.empty() ? "" : ", ",
                     values);
}

std::string FleetNode::call(const std::string& function, const std::string& values) {
  return line.tried(call_sql(function, values));
}

std::string FleetNode::arm(const std::string& job, const std::string& device) {
  const std::string id = FleetSql::id(job);
  const std::string taken = line.tried(
      fmt::format("BEGIN; UPDATE job SET state='armed', device='{}', rev=rev+1 WHERE id='{}' AND "
                  "state='ready' RETURNING sheet, blank",
                  device, id));
  if (taken.find(' ') != std::string::npos) return taken;
  if (taken.empty()) {
    line("ROLLBACK");
    return "the job is not ready";
  }
  return line.tried(
      fmt::format("SELECT knife_arm('{}', {}, id, sheet, blank, '{}', '{}', 'olga', 5, 'run') FROM "
                  "job WHERE id='{}'; COMMIT",
                  name, epoch, device, FleetSql::plan_sha256(), id));
}

std::string FleetNode::start(const std::string& attempt, const std::string& job,
                             const std::string& device, std::int64_t least_fence) {
  return line.tried(fmt::format(
      "SELECT knife_start('{}', {}, '{}', id, sheet, blank, segment, 0, 10, '{}', 's', 'olga', "
      "'{}', 'run', 6, {}) FROM job WHERE id='{}'; UPDATE job SET state='cutting', rev=rev+1, "
      "started=6 WHERE id='{}'",
      name, epoch, FleetSql::id(attempt), device, FleetSql::plan_sha256(), least_fence,
      FleetSql::id(job), FleetSql::id(job)));
}

std::string FleetNode::mark(const std::string& attempt, int certain, int taken, int intended,
                            int bytes) {
  return call("knife_mark", fmt::format("'{}', 0, {}, {}, {}, {}", FleetSql::id(attempt), certain,
                                        taken, intended, bytes));
}

std::string FleetNode::finish(const std::string& attempt, const std::string& job) {
  return line.tried(call_sql("knife_end", fmt::format("'{}', 9, 'done', '', 100, '{{0}}', '{{9}}', "
                                                      "'{{certain}}'",
                                                      FleetSql::id(attempt))) +
                    fmt::format("UPDATE job SET state='done', finished=9, rev=rev+1 WHERE id='{}'",
                                FleetSql::id(job)));
}

}  // namespace popcut::testing
