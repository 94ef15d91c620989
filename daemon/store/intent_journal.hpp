// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/jobs/intents.hpp"
#include "daemon/model/model.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

/// Whose intents they are: enough to know the attempt again if the database lost it.
struct IntentHead {
  std::string attempt, job;
  int sheet{}, blank{1}, segment{1};
  std::int64_t first_stroke{}, strokes{};
  std::string device{}, device_session{}, operator_name{}, plan_sha256{}, invocation{};
  TimeMs created{};
};

/// The intents of one attempt, beside the database: STATE/intents/ATTEMPT is a list to which
/// records are added, and STATE/witnesses/ATTEMPT counts them.
///
/// A list is its head and then records of one size: "NUMBER LAST DIGEST\n", where the digest covers
/// the record and the digest before it. A witness is the same head and two slots, written in turn,
/// each "NUMBER LAST CHAIN DIGEST\n", where CHAIN is the digest of the record that it counts.
/// Members throw StoreFault: Full or Io. For one thread at a time.
class IntentJournal {
 public:
  /// Makes both files and syncs them with their folders.
  ///
  /// @throws StoreFault  Full, Io; neither file is left then
  IntentJournal(const StateFolder& folder, const IntentHead& head);
  /// Removes both files, unless `keep` was called: the attempt never came to be.
  ~IntentJournal();
  IntentJournal(const IntentJournal&) = delete;
  IntentJournal& operator=(const IntentJournal&) = delete;

  /// The database knows the attempt.
  void keep() { kept_ = true; }
  /// Writes down that strokes up to `last` are about to be sent: on the disk when this returns. On
  /// a full disk it can be called again; after a failed one nothing more is written.
  void intend(std::int64_t last);

 private:
  void open(const IntentHead& head);
  void shut();
  std::string list_path_, witness_path_;
  int list_{-1}, witness_{-1};
  std::string chain_;
  std::int64_t records_{0};
  bool kept_{false}, failed_{false};
};

/// What both files of an attempt say, as far as they can be read.
struct IntentTrail {
  std::optional<IntentHead> head{};  ///< of either file
  JournalClaim journal{};
  WitnessClaim witness{};
};

/// The files of all attempts whose end may not yet be on the disk for good.
///
/// They are kept until the database's log with that end in it was moved into the database, so that
/// a log that loses its tail after an end is noticed, too.
class IntentJournals {
 public:
  /// @param keeps  also of attempts whose end is known: a shared database may be replaced by an
  ///               older copy of it, on which this popcutd has no influence
  explicit IntentJournals(const StateFolder& folder, bool keeps = false)
      : folder_(folder), keeps_(keeps) {}

  [[nodiscard]] std::unique_ptr<IntentJournal> begin(const IntentHead& head) const {
    return std::make_unique<IntentJournal>(folder_, head);
  }
  /// By attempt. A file whose name is no id is left alone.
  [[nodiscard]] std::map<std::string, IntentTrail> trails() const;
  /// The attempt's end is committed.
  void ended(const std::string& attempt) {
    if (!keeps_) ended_.insert(attempt);
  }
  /// It is so old that no copy of a database without it will be put back.
  void outlived(const std::string& attempt) { ended_.insert(attempt); }
  [[nodiscard]] std::size_t waiting() const { return ended_.size(); }
  /// All that was committed is in the database itself: what ended is forgotten.
  void checkpointed();
  /// Whether there is a file of the attempt.
  [[nodiscard]] bool has(const std::string& attempt) const;
  /// The attempt sent nothing.
  void remove(const std::string& attempt) const;

  /// Strokes of this job were sent that belong to no sheet it has: it must not be armed.
  void block(const std::string& job, const std::string& why) { blocked_[job] = why; }
  [[nodiscard]] std::string why_blocked(const std::string& job) const {
    const auto found = blocked_.find(job);
    return found == blocked_.end() ? std::string() : found->second;
  }

 private:
  const StateFolder& folder_;
  bool keeps_;
  std::set<std::string> ended_;
  std::map<std::string, std::string> blocked_;
};

}  // namespace popcut::daemon
