// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// What an attempt's journal of intents says, as far as it can be read. An intent is a record that
/// strokes up to `last` are about to be sent.
struct JournalClaim {
  bool there{false};        ///< its head is whole
  std::int64_t records{0};  ///< intents that are whole and follow from the one before
  std::int64_t last{-1};    ///< last stroke of the last of them
};

/// What the witness of that journal says: how many intents there were. It has two slots, which are
/// written in turn, so that a torn write leaves the one before.
struct WitnessClaim {
  bool there{false};             ///< its head and a slot are whole
  bool whole{false};             ///< both slots are
  std::int64_t records{0};       ///< of the newer slot
  std::int64_t last{-1};         ///< last stroke of that intent
  std::int64_t last_before{-1};  ///< of the slot before; only if `whole`
};

/// What the three records of one attempt say after a crash. Each intent is written to the journal,
/// then to the witness, then to the database; each is on the disk before the next is written, and
/// all three before a byte of these strokes is sent.
struct IntentClaims {
  std::int64_t first{0}, strokes{0};  ///< the attempt was to send strokes `first .. strokes - 1`
  std::int64_t recorded{-1};  ///< last stroke that the database knows of; below `first`: none
  JournalClaim journal{};
  WitnessClaim witness{};
};

/// What may have been sent.
struct IntentVerdict {
  std::int64_t doubt_upto{-1};  ///< no later stroke was sent; below `first`: none was
  std::string loss{};           ///< which record lost what, in words; empty: they agree
};

/// Up to which stroke an attempt that popcutd did not end itself may have been sent.
///
/// The highest of the three claims counts. A witness that is missing, damaged or shown to be out of
/// date bounds nothing: then all the rest of the sheet may have been sent.
[[nodiscard]] IntentVerdict verdict_on(const IntentClaims& claims);

/// What becomes of a job whose journal knows of an attempt that the database does not know.
enum class Surfacing : std::uint8_t {
  History,           ///< it belongs to a blank that is given up, or to a job that has ended
  Interrupts,        ///< the current sheet was begun: it is interrupted, on the journal's blank
  InterruptsBefore,  ///< a later sheet was begun: nothing is known of the current one
  Blocks,            ///< the job has no such sheet yet: it must not be armed
};

/// Where a job is, or an attempt at it.
struct SheetPlace {
  int sheet{}, blank{1};
};

/// @param sheets  that the job has; 0: its plan has not come yet
[[nodiscard]] Surfacing surfacing_of(JobState state, const SheetPlace& job, int sheets,
                                     const SheetPlace& attempt);

}  // namespace popcut::daemon
