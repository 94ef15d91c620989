// SPDX-License-Identifier: MIT
#include "daemon/service/service_store.hpp"

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

/// The files without a fleet: every file is in the state folder already.
class OwnFiles final : public SharedFiles {
 public:
  Result<void> keep(const std::string&, const std::string&) override { return {}; }
  bool keep_small(const std::string&) override { return true; }
  Found fetch(const std::string&) override { return Found::Here; }
  std::vector<std::string> names(const std::string&) override { return {}; }
  void forget(const std::string&) override {}
};

}  // namespace

Event event_of(const Rows& rows) {
  Event event;
  rows.read(0, std::tie(event.seq, event.kind, event.time, event.job, event.data));
  return event;
}

ServiceStore::ServiceStore(Store& store, const ServiceOptions& options)
    : store_(store), options_(options) {
  // New ids are greater than all others, also when the clock was put back. In a fleet the clock is
  // that of the database.
  if (!in_fleet())
    for (const char* sql : {"SELECT max(id) FROM job", "SELECT max(id) FROM plan",
                            "SELECT max(id) FROM attempt", "SELECT max(id) FROM token"}) {
      Rows last = db().rows(sql);
      if (last.next()) ulids_.raise_above(last.text(0));
    }
  db().committed = [this](double seconds) { figures_.commits.add(seconds); };
}

void ServiceStore::forget_after(const Marks& marks) {
  after_.resize(marks.after);
  with_.resize(marks.with);
  events_.resize(marks.events);
}

void ServiceStore::try_to(const std::function<void()>& work) const {
  try {
    work();
  } catch (const std::exception& fault) {
    try {
      log(fmt::format("an event or an effect of a change failed: {}", fault.what()));
    } catch (const std::exception&) {  // too little memory to log it
    }
  }
}

void ServiceStore::follow_up() {
  // Move them out first: an effect may change something, with events and effects of its own.
  const std::vector<Event> events = std::exchange(events_, {});
  const std::vector<std::function<void()>> after = std::exchange(after_, {});
  for (const auto& work : std::exchange(with_, {})) try_to(work);
  // The change is committed, so an effect that fails must not prevent the others.
  if (!events.empty()) try_to([&] { store_.bear_witness(events.back().seq); });
  if (in_fleet())
    try_to([&] {
      for (const Event& event : events) own_.insert(event.data);
      deliver_new_events();
    });
  else
    for (const Event& event : events) publish(event);
  for (const auto& work : after) try_to(work);
}

void ServiceStore::emit(const std::string& kind, const std::string& job,
                        const JsonObject& members) {
  JsonObject data;
  data.text("kind", kind);
  if (!job.empty()) data.text("job", job);
  // Without "{": `store_events` puts it and the number of the event before this text.
  events_.push_back({0, kind, now(), job, data.members_of(members).whole().substr(1)});
}

void ServiceStore::store_events() {
  if (events_.empty()) return;
  if (in_fleet()) {
    for (const Event& event : events_)
      db().insert_later("event_new(time, kind, job, data)", event.time, event.kind, event.job,
                        event.data);
    return;
  }
  std::int64_t seq = db().number("SELECT max(seq) FROM event");
  for (Event& event : events_) {
    event.seq = ++seq;
    event.data = fmt::format(R"({{"seq":{},{})", seq, event.data);
    db().insert("event(seq, time, kind, job, data)", seq, event.time, event.kind, event.job,
                event.data);
  }
}

void ServiceStore::number_events() {
  // Other nodes may add events all the time, so stop after a while; the next turn continues.
  constexpr int kMostTimes = 10;
  for (int times = 0; times < kMostTimes; ++times)
    if (db().number("SELECT event_number(?)", node_.name) == 0) return;
}

SharedFiles& ServiceStore::files() {
  static OwnFiles own;
  return store_.files() == nullptr ? own : *store_.files();
}

Answer<void> ServiceStore::fetch_file(const std::string& name) {
  return read([&]() -> Answer<void> {
    if (files().fetch(name) != SharedFiles::Found::Coming) return {};
    return refuse(
        ProblemKind::Unavailable,
        "this file is still being fetched from the fleet's database; ask again in a moment",
        /*retry_after_s=*/1);
  });
}

// A later call keeps `last_delivered_`, so that listeners get the events that other nodes stored
// while the database did not answer.
void ServiceStore::begin_delivery() {
  const std::int64_t last = db().number("SELECT last FROM event_counter");
  if (!std::exchange(has_delivered_, true) || last < last_delivered_) last_delivered_ = last;
}

void ServiceStore::deliver_new_events() {
  constexpr int kAtOnce = 500;
  // A listener may cause another event, which the loop below finds.
  if (db().in_transaction() || is_delivering_) return;
  struct Delivering {
    bool& flag_;
    explicit Delivering(bool& flag) : flag_(flag) { flag_ = true; }
    ~Delivering() { flag_ = false; }
  } const delivering(is_delivering_);
  number_events();
  bool from_others = false;
  for (int count = 1; count > 0;) {
    std::vector<Event> news = all_of(
        db().rows("SELECT seq, kind, time, job, data FROM event WHERE seq>? ORDER BY seq LIMIT ?",
                  last_delivered_, kAtOnce),
        event_of);
    count = static_cast<int>(news.size());
    for (const Event& event : news) {
      last_delivered_ = event.seq;
      const auto own = own_.find(event.data.substr(event.data.find(',') + 1));
      if (own != own_.end()) {
        own_.erase(own);
      } else if (on_remote_event) {
        // Before the listeners, because it may stop a knife.
        try_to([&] { on_remote_event(event); });
        from_others = true;
      }
      publish(event);
    }
  }
  if (from_others && after_remote_events) after_remote_events();
}

bool ServiceStore::was_overtaken(const StoreFault& fault) const {
  // In a fleet another node may have changed what was read before.
  return fault.kind() == FaultKind::Again || (fault.kind() == FaultKind::Constraint && in_fleet());
}

void ServiceStore::publish(const Event& event) {
  for (const auto& listener : listeners_) try_to([&] { listener(event); });
}

void ServiceStore::audit(const std::string& principal, std::string_view action,
                         const std::string& subject, const std::string& detail) {
  db().insert_later("audit(time, principal, action, subject, detail)", now(), principal, action,
                    subject, detail);
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

Problem ServiceStore::file_problem(const Error& error) {
  note_full();
  const Answer<void> room = accepts_work();
  return !room && room.error().kind == ProblemKind::Unavailable ? room.error()
                                                                : problem_from(error);
}

std::string ServiceStore::moved_away() const {
  return fmt::format("popcutd's state folder is no longer at {}", store_.folder().path());
}

void ServiceStore::handle_fault(const StoreFault& fault) {
  if (in_fleet()) {
    // Its administrator looks after the disk of that database. A cut here goes on without it.
    if (fault.kind() == FaultKind::InDoubt && on_doubt) on_doubt();
    return;
  }
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
    case FaultKind::Away:
      return refuse(ProblemKind::Unavailable,
                    fmt::format("the database of the fleet does not answer: {}", fault.what()),
                    /*retry_after_s=*/2)
          .value();
    case FaultKind::InDoubt:
      return {
          ProblemKind::Unavailable,
          "the database of the fleet went away while this was stored; check whether it was done "
          "before you send it again"};
    case FaultKind::Again:
      return refuse(ProblemKind::Unavailable,
                    "another request is changing the same thing; send this request again",
                    /*retry_after_s=*/1)
          .value();
    case FaultKind::Refused:
      return {ProblemKind::StateConflict, fault.what()};
    case FaultKind::Full:
      if (in_fleet())
        return {ProblemKind::DiskFull,
                "the disk of the fleet's database is full; tell its administrator, and send the "
                "request "
                "again when it has space"};
      return {ProblemKind::DiskFull,
              "the disk is full; free some space and send the request again"};
    case FaultKind::Busy:
      return {ProblemKind::Unavailable,
              "popcutd has no free file descriptor; send the request again when fewer clients are "
              "connected"};
    case FaultKind::Io:
    case FaultKind::Corrupt:
      if (in_fleet())
        return {ProblemKind::Unavailable,
                fmt::format("the database of the fleet failed: {}", fault.what())};
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
                  "popcutd was not shut down cleanly and is still checking its database; arm again "
                  "in a moment");
  return {};
}

void ServiceStore::check_ended(const std::string& damage) {
  if (degraded_) return;
  if (!damage.empty()) return degrade(damage);
  store_.set_checked();
  log("the database was not closed cleanly; a full check found no damage");
}

void ServiceStore::recover_disk() {
  if (degraded_ || (!full_ && folder().has_reserve()) || !folder().is_in_place()) return;
  const std::uint64_t reserve = store_.options().reserve_bytes;
  if (folder().free_bytes() < options_.least_free_bytes + reserve) return;
  if (!folder().take_reserve(reserve)) return;
  if (full_) log("the disk has space again");
  full_ = false;
}

}  // namespace popcut::daemon
