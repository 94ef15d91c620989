// SPDX-License-Identifier: MIT
#include "daemon/jobs/intents.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

// Whether the witness can be believed: nothing else knows more than it can have counted.
bool counts(const IntentClaims& claims) {
  const auto& [first, strokes, recorded, journal, witness] = claims;
  if (!witness.there || journal.records > witness.records + 1) return false;
  if (witness.whole) return recorded <= witness.last;
  // The other slot is torn. If that was the next one, its intent is in the journal; else it is
  // damaged, and so may have been a newer one.
  return journal.records == witness.records + 1 && recorded <= journal.last;
}

}  // namespace

IntentVerdict verdict_on(const IntentClaims& claims) {
  const JournalClaim& journal = claims.journal;
  const WitnessClaim& witness = claims.witness;
  IntentVerdict verdict;
  const auto lost = [&](const std::string& what) {
    verdict.loss += (verdict.loss.empty() ? "" : "; ") + what;
  };
  const bool counted = counts(claims);
  const std::int64_t none = claims.first - 1;
  const std::int64_t known = std::max({none, claims.recorded, journal.there ? journal.last : none,
                                       witness.there ? witness.last : none});
  verdict.doubt_upto = std::min(counted ? known : claims.strokes - 1, claims.strokes - 1);
  if (!witness.there)
    lost("the witness of its intents is missing or damaged");
  else if (!counted)
    lost("the witness of its intents is damaged or out of date");
  if (!journal.there)
    lost("the journal of its intents is missing or damaged");
  else if (witness.there && journal.records < witness.records)
    lost(fmt::format("the journal of its intents ends after {} of {}", journal.records,
                     witness.records));
  // An intent comes to the database before the next one is begun.
  const std::int64_t least = counted && witness.whole ? witness.last_before : none;
  if (claims.recorded < std::max(least, none))
    lost(fmt::format("the database lost its end: it knows of {}, but path {} was to be sent",
                     claims.recorded < claims.first ? std::string("no path")
                                                    : fmt::format("path {}", claims.recorded),
                     verdict.doubt_upto));
  return verdict;
}

Surfacing surfacing_of(JobState state, const SheetPlace& job, int sheets,
                       const SheetPlace& attempt) {
  if (is_terminal(state)) return Surfacing::History;
  if (attempt.sheet > sheets || job.sheet == 0) return Surfacing::Blocks;
  if (attempt.sheet > job.sheet) return Surfacing::InterruptsBefore;
  return std::tie(attempt.sheet, attempt.blank) < std::tie(job.sheet, job.blank)
             ? Surfacing::History
             : Surfacing::Interrupts;
}

}  // namespace popcut::daemon
