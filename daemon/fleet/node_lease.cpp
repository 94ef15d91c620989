// SPDX-License-Identifier: MIT
#include "daemon/fleet/node_lease.hpp"

#include <algorithm>
#include <ctime>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "daemon/digest/digest.hpp"

namespace popcut::daemon {
namespace {

constexpr double kSpared = 0.75;  // of the lease, as this machine counts it

// It goes on while the machine sleeps.
std::int64_t boot_clock_ms() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
}

}  // namespace

std::string identity_of(const StateFolder& folder) {
  struct stat place {};
  (void)::stat(folder.path().c_str(), &place);
  return sha256_hex(
             fmt::format("{} {}", read_whole("/etc/machine-id", 100).value_or(""), place.st_ino))
      .substr(0, 32);
}

NodeLease::NodeLease(Database& database, const StateFolder& folder, NodeMark& mark, Options options)
    : database_(database), folder_(folder), mark_(mark), options_(std::move(options)) {
  if (!options_.elapsed_ms) options_.elapsed_ms = boot_clock_ms;
  mark_.name = options_.name;
  mark_.identity = identity_of(folder);
  kept_ = read_whole(folder_.at("node"), 200).value_or("");
  std::istringstream words(kept_);
  words >> last_epoch_ >> last_event_ >> mark_.fence >> next_epoch_ >> generation_;
}

void NodeLease::keep() {
  std::string text = fmt::format("{} {} {} {} {}\n", last_epoch_, last_event_, mark_.fence,
                                 next_epoch_, generation_);
  if (text == kept_) return;
  // Best effort: without it an older database is noticed by the journals only.
  if (write_file(folder_.at("node"), text)) kept_ = std::move(text);
}

void NodeLease::begin() {
  holds_until_ms_ = 0;
  try {
    return begin_after(last_epoch_);
  } catch (const StoreFault& fault) {
    // The last time it may have died, or lost the answer, just when its epoch was committed.
    if (fault.kind() != FaultKind::Refused || next_epoch_ == 0) throw;
  }
  begin_after(next_epoch_);
}

void NodeLease::begin_after(std::int64_t epoch) {
  Transaction beginning(database_);
  std::int64_t fence = 0, clock_ms = 0;
  std::string generation;
  {
    Rows begun =
        database_.rows("SELECT epoch, fence, generation, now_ms FROM node_begin(?, ?, ?, ?, ?, ?)",
                       options_.name, mark_.identity, options_.url, options_.version,
                       epoch == 0 ? std::nullopt : std::optional(epoch), last_event_);
    if (!begun.next()) throw StoreFault(FaultKind::Other, "node_begin gave no row");
    next_epoch_ = begun.integer(0);
    fence = begun.integer(1);
    generation = begun.text(2);
    clock_ms = begun.integer(3);
  }
  keep();
  beginning.commit();
  mark_.epoch = last_epoch_ = std::exchange(next_epoch_, 0);
  mark_.fence = std::max(mark_.fence, fence);
  last_event_ = 0;  // of the database as it is now
  read_clock(clock_ms);
  generation_before_ = std::exchange(generation_, generation);
  keep();
}

bool NodeLease::is_own_life() const {
  return first_of(
             database_.rows("SELECT identity FROM node WHERE name=? AND login=session_user AND "
                            "lease_until>clock_timestamp()",
                            options_.name),
             first_text) == mark_.identity;
}

void NodeLease::reported() {
  database_.run("SELECT node_reported(?, ?)", options_.name, mark_.epoch);
  (void)beat();
}

bool NodeLease::beat() {
  const std::int64_t sent_ms = options_.elapsed_ms();
  Rows answer = database_.rows("SELECT alive, now_ms FROM node_beat(?, ?, ?, ?)", options_.name,
                               mark_.epoch, options_.lease_s, last_event_);
  if (!answer.next() || answer.integer(0) == 0) {
    holds_until_ms_ = 0;
    return false;
  }
  read_clock(answer.integer(1));
  holds_until_ms_ = sent_ms + static_cast<std::int64_t>(options_.lease_s * kSpared * 1000);
  keep();
  return true;
}

void NodeLease::read_clock(std::int64_t ms) {
  clock_ms_ = ms;
  clock_at_ms_ = options_.elapsed_ms();
}

void NodeLease::end() {
  holds_until_ms_ = 0;
  keep();
  try {
    database_.run("SELECT node_end(?, ?)", options_.name, mark_.epoch);
  } catch (const StoreFault&) {  // the lease runs out by itself
  }
}

bool NodeLease::holds() const { return options_.elapsed_ms() < holds_until_ms_; }

std::int64_t NodeLease::ahead_ms(std::int64_t own_ms) const {
  if (clock_ms_ == 0) return 0;
  return clock_ms_ + (options_.elapsed_ms() - clock_at_ms_) - own_ms;
}

void NodeLease::saw(std::int64_t event) { last_event_ = std::max(last_event_, event); }

}  // namespace popcut::daemon
