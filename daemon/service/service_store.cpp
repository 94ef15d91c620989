// SPDX-License-Identifier: MIT
#include "daemon/service/service_store.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace popcut::daemon {

ServiceStore::ServiceStore(Store& store, const ServiceOptions& options)
    : store_(store), options_(options) {
  // Ids go on after the greatest there is, also when the clock was put back.
  for (const char* sql : {"SELECT max(id) FROM job", "SELECT max(id) FROM plan",
                          "SELECT max(id) FROM attempt", "SELECT max(id) FROM token"}) {
    Rows last = db().rows(sql);
    if (last.next()) ulids_.raise_above(last.text(0));
  }
  db().committed = [this](double seconds) { figures_.commits.add(seconds); };
}

void ServiceStore::forget_after(const Marks& marks) {
  after_.resize(marks.after);
  events_.resize(marks.events);
}

void ServiceStore::follow_up() {
  // What follows may change something again, with events and follow-ups of its own.
  const std::vector<Event> events = std::exchange(events_, {});
  const std::vector<std::function<void()>> after = std::exchange(after_, {});
  // It is committed: whoever stumbles over the news must not keep the rest from happening.
  const auto try_to = [this](const auto& work) {
    try {
      work();
    } catch (const std::exception& fault) {
      try {
        log(fmt::format("after a commit: {}", fault.what()));
      } catch (const std::exception&) {  // not even memory to say so
      }
    }
  };
  if (!events.empty()) try_to([&] { store_.bear_witness(events.back().seq); });
  for (const Event& event : events) try_to([&] { tell(event); });
  for (const auto& work : after) try_to(work);
}

void ServiceStore::emit(const std::string& kind, const std::string& job,
                        const std::string& members) {
  const std::int64_t seq = db().number("SELECT max(seq) FROM event") + 1;
  std::string data = fmt::format(R"({{"seq":{},"kind":"{}")", seq, kind);
  if (!job.empty()) data += fmt::format(R"(,"job":"{}")", job);
  if (!members.empty()) data += "," + members;
  data += "}";
  const Event event{seq, kind, now(), job, data};
  db().insert("event(seq, time, kind, job, data)", seq, event.time, kind, job, data);
  events_.push_back(event);
}

void ServiceStore::tell(const Event& event) {
  for (const auto& listener : listeners_) listener(event);
}

void ServiceStore::audit(const std::string& principal, std::string_view action,
                         const std::string& subject, const std::string& detail) {
  db().insert("audit(time, principal, action, subject, detail)", now(), principal, action, subject,
              detail);
}

void ServiceStore::log(const std::string& line) const {
  if (options_.log) options_.log(line);
}

void ServiceStore::note_full() {
  if (!full_)
    log(folder().is_in_place() ? "the disk is full; new work is refused until there is space"
                               : moved_away() + "; new work is refused until it is back");
  full_ = true;
}

Problem ServiceStore::unkept(const Error& error) {
  note_full();
  const Answer<void> room = accepts_work();
  return !room && room.error().kind == ProblemKind::Unavailable ? room.error()
                                                                : problem_from(error);
}

std::string ServiceStore::moved_away() const {
  return fmt::format("popcutd's state folder is no longer at {}", store_.folder().path());
}

void ServiceStore::note(const StoreFault& fault) {
  if (fault.kind() == FaultKind::Full) note_full();
  if (degraded_ || (fault.kind() != FaultKind::Io && fault.kind() != FaultKind::Corrupt)) return;
  // A failed fsync may have dropped what it should have written: trying again proves nothing.
  degrade(fault.what());
}

void ServiceStore::degrade(const std::string& why) {
  degraded_ = true;
  degraded_why_ = why;
  store_.give_up();
  log(
      fmt::format("the database failed; nothing more is written to it, and cuts stop at the end of "
                  "their stroke; restart popcutd: {}",
                  why));
  if (on_degraded) on_degraded();
}

Problem ServiceStore::degraded_problem() const {
  return {ProblemKind::Unavailable,
          "the database failed; restart popcutd to make changes: " + degraded_why_};
}

Problem ServiceStore::problem_of(const StoreFault& fault) const {
  switch (fault.kind()) {
    case FaultKind::Full:
      return {ProblemKind::DiskFull,
              "the disk is full; free some space and send the request again"};
    case FaultKind::Busy:
      return {ProblemKind::Unavailable,
              "popcutd has no free file descriptor; send the request again when fewer clients are "
              "connected"};
    case FaultKind::Io:
    case FaultKind::Corrupt:
      return degraded_problem();
    default:
      return {ProblemKind::Internal, fault.what()};
  }
}

Answer<void> ServiceStore::accepts_work() const {
  if (degraded_) return tl::unexpected(degraded_problem());
  if (!store_.folder().is_in_place())
    return refuse(
        ProblemKind::Unavailable,
        moved_away() + "; move it back, or restart popcutd with --state and its new place");
  const std::uint64_t free = store_.folder().free_bytes();
  if (full_ || free < options_.least_free_bytes)
    return refuse(ProblemKind::DiskFull,
                  fmt::format("the disk of {1} has {0} MB free; new work needs {2} MB", free >> 20,
                              store_.folder().path(), options_.least_free_bytes >> 20));
  return {};
}

Answer<void> ServiceStore::accepts_arming() const {
  if (degraded_) return tl::unexpected(degraded_problem());
  if (!store_.checked())
    return refuse(ProblemKind::Unavailable,
                  "popcutd was not stopped in order and still checks its database; arm again in a "
                  "moment");
  return {};
}

void ServiceStore::checked(const std::string& damage) {
  if (degraded_) return;
  if (!damage.empty()) return degrade(damage);
  store_.set_checked();
  log("the database was not closed in order; all of it is checked now, and it is sound");
}

void ServiceStore::recover_disk() {
  if (degraded_ || (!full_ && folder().has_reserve()) || !folder().is_in_place()) return;
  const std::uint64_t reserve = store_.options().reserve_bytes;
  if (folder().free_bytes() < options_.least_free_bytes + reserve) return;
  if (!folder().take_reserve(reserve)) return;
  if (full_) log("the disk has space again");
  full_ = false;
}

std::string json_text(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace popcut::daemon
