// SPDX-License-Identifier: MIT
#include "daemon/service/live/fleet_watch.hpp"

#include <fmt/format.h>

#include "daemon/model/metrics.hpp"
#include "daemon/service/repositories/recovery.hpp"

namespace popcut::daemon {

FleetWatch::FleetWatch(Parts parts)
    : parts_(parts),
      lease_(parts_.store.db(), parts_.store.folder(), parts_.store.node(),
             {.name = parts_.options.fleet.node,
              .url = parts_.options.fleet.url,
              .version = parts_.options.fleet.version,
              .lease_s = parts_.options.fleet.lease_s}) {
  parts_.store.on_doubt = [this] { in_doubt_ = true; };
  parts_.cuts.may_cut = [this] { return may_cut(); };
}

Answer<void> FleetWatch::begin() {
  try {
    begin_epoch();
  } catch (const StoreFault& fault) {
    if (fault.kind() == FaultKind::Refused && !is_held_by_own_lease())
      return refuse(ProblemKind::StateConflict, fault.what());
    if (fault.kind() != FaultKind::Away && fault.kind() != FaultKind::InDoubt &&
        fault.kind() != FaultKind::Refused)
      return refuse(ProblemKind::Unavailable, fault.what());
    log_fault(fault);
  }
  return {};
}

// Whether the lease that prevents a new epoch is of an earlier run of this node. If so, `tick`
// tries until it expires.
bool FleetWatch::is_held_by_own_lease() const {
  try {
    return lease_.is_own_life();
  } catch (const StoreFault&) {
    return false;
  }
}

// The new epoch is committed before anything is read. After that, the database stores no START of
// an earlier epoch, so what is read is complete.
void FleetWatch::begin_epoch() {
  has_begun_ = false;
  lease_.begin();
  log_generation();
  parts_.store.begin_delivery();
  // Revoke each START of this run that the database has, but whose answer was lost.
  for (const AttemptRow& open : parts_.jobs.attempts().open())
    if (!parts_.cuts.has(open.id)) (void)parts_.cuts.revoke_start(open);
  if (const Answer<void> recovered =
          recover(parts_.store, parts_.jobs, parts_.intents,
                  [this](const std::string& attempt) { return parts_.cuts.has(attempt); });
      !recovered)
    throw StoreFault(FaultKind::Away, recovered.error().detail);
  parts_.dispatcher.forget_arms();
  parts_.cuts.reclaim();
  lease_.reported();
  if (!was_begun_ && on_begun) on_begun();
  was_begun_ = true;
  has_begun_ = true;
  in_doubt_ = false;
  why_.clear();
  parts_.store.log(fmt::format("this is node {} of the fleet, epoch {}", lease_.options().name,
                               parts_.store.node().epoch));
  logged_.clear();
  beat_ms_ = parts_.store.monotonic();
  parts_.devices.load_others();
}

// A generation is "TIMELINE.TIME": the timeline of the database, and when a node last noticed that
// the database went back to an earlier state.
void FleetWatch::log_generation() const {
  const std::string &before = lease_.generation_before(), &now = lease_.generation();
  if (before.empty() || before == now) return;
  const auto same = [&](std::size_t from, std::size_t to) {
    return before.substr(from, to) == now.substr(from, to);
  };
  const std::size_t dot = before.find('.');
  parts_.store.log(fmt::format(
      "{}{}; this node now tells it of the cuts in its journals; nobody can arm a sheet until all "
      "nodes have done so",
      same(dot, before.npos) ? "the database is another one now"
                             : "the database went back to an earlier state",
      same(0, dot) ? "" : ": a standby took over, or a backup was restored"));
}

void FleetWatch::log_fault(const StoreFault& fault) {
  why_ = fault.what();
  if (std::exchange(logged_, why_) != why_)
    parts_.store.log(fmt::format("the fleet's database: {}", why_));
}

void FleetWatch::tick() {
  if (has_left_) return;  // a node that gave up its lease must not begin again
  try {
    lease_.saw(parts_.store.last_delivered());
    if (!has_begun_) return begin_epoch();
    const std::int64_t now = parts_.store.monotonic();
    const auto between_ms = static_cast<std::int64_t>(parts_.options.fleet.beat_s * 1000);
    // After a lost answer, renew the lease at once: the database may be another one now.
    if (in_doubt_ || now - beat_ms_ >= between_ms) {
      beat_ms_ = now;
      beat();
    }
    if (has_begun_) parts_.store.deliver_new_events();
    lease_.saw(parts_.store.last_delivered());
  } catch (const StoreFault& fault) {
    // Refused: another popcutd has begun with the name of this node.
    if (fault.kind() == FaultKind::Refused) has_begun_ = false;
    log_fault(fault);
  }
}

void FleetWatch::beat() {
  if (!lease_.beat()) {
    parts_.store.log(
        "the lease of this node was over, or the database is another one now; it begins again and "
        "compares its journals");
    return begin_epoch();
  }
  why_.clear();
  logged_.clear();
  check_open_attempts();
  if (!has_begun_) return;
  parts_.devices.load_others();
  close_lost_nodes();
}

// Looks for attempts that are open in the database, but not cut here. If only the answer to a START
// was lost, revokes the START: the knife moves only after the answer. For any other attempt, begins
// a new epoch, which compares the journals.
void FleetWatch::check_open_attempts() {
  in_doubt_ = false;
  for (const AttemptRow& open : parts_.jobs.attempts().open())
    if (!parts_.cuts.has(open.id) && !parts_.cuts.revoke_start(open)) return begin_epoch();
}

void FleetWatch::close_lost_nodes() {
  struct Node {
    std::string name;
    std::int64_t epoch{};
  };
  const std::vector<Node> silent =
      all_of(parts_.store.db().rows(
                 "SELECT name, epoch FROM node WHERE lease_until<clock_timestamp() AND name!=? AND "
                 "(EXISTS (SELECT 1 FROM attempt WHERE attempt.node=name AND ended IS NULL) OR "
                 "EXISTS (SELECT 1 FROM arm WHERE arm.node=name) OR "
                 "EXISTS (SELECT 1 FROM plan WHERE planner=name AND state='pending') OR "
                 "EXISTS (SELECT 1 FROM search WHERE planner=name AND state='pending'))",
                 lease_.options().name),
             [](const Rows& rows) {
               return Node{rows.text(0), rows.integer(1)};
             });
  for (const Node& node : silent) {
    if (parts_.store.db().number("SELECT node_lapse(?, ?)", node.name, node.epoch) == 0) continue;
    const Answer<void> closed = close_lost_node(parts_.store, parts_.jobs, node.name, node.epoch);
    if (closed)
      parts_.store.log(
          fmt::format("node {} does not answer: what it was cutting is interrupted, "
                      "what it was planning is planned by others",
                      node.name));
  }
  parts_.jobs.plans_ended_before();
  parts_.store.db().run("SELECT node_tidy()");
}

void FleetWatch::end() {
  has_left_ = true;
  if (has_begun_) lease_.end();
  has_begun_ = false;
}

std::string FleetWatch::metrics() {
  const std::string node = metric_label(lease_.options().name);
  const bool holds = has_begun_ && lease_.holds();
  std::string text = fmt::format(
      "# TYPE popcut_fleet_lease gauge\n# HELP popcut_fleet_lease Whether this node may arm and "
      "start.\npopcut_fleet_lease{{node=\"{}\"}} {}\n"
      "# TYPE popcut_fleet_epoch gauge\npopcut_fleet_epoch{{node=\"{}\"}} {}\n",
      node, holds ? 1 : 0, node, parts_.store.node().epoch);
  try {
    text +=
        "# TYPE popcut_fleet_node_alive gauge\n# HELP popcut_fleet_node_alive Nodes whose lease "
        "has not run out.\n";
    Rows nodes = parts_.store.db().rows(
        "SELECT name, lease_until>clock_timestamp() FROM node WHERE epoch>0 ORDER BY name");
    while (nodes.next())
      text += fmt::format("popcut_fleet_node_alive{{node=\"{}\"}} {}\n",
                          metric_label(nodes.text(0)), nodes.integer(1));
  } catch (const StoreFault& fault) {
    log_fault(fault);
  }
  return text;
}

Answer<void> FleetWatch::may_cut() const {
  if (has_begun_ && lease_.holds()) return {};
  return refuse(
      ProblemKind::Unavailable,
      fmt::format("this node has no lease of the fleet's database, so it starts nothing{}{}",
                  why_.empty() ? "" : ": ", why_),
      /*retry_after_s=*/2);
}

}  // namespace popcut::daemon
