// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "tests/support/exploration.hpp"

namespace popcut::testing {

/// A rule that is broken on purpose, to show that the model finds it.
enum class Flaw : std::uint8_t {
  None,
  DatabaseOnly,       ///< a crash leaves in doubt what the database knows, and no more
  IgnoresWitness,     ///< the journal is believed without being counted
  IgnoresJournal,     ///< only attempts that the database knows are looked at
  SendsBeforeIntent,  ///< bytes are sent before their intent is written down
  ForgetsAtTheEnd,    ///< a journal is removed when its end is committed, not when it is kept
  QueuesAgain,        ///< what was being cut is made ready again from its first stroke
  ResumesOverDoubt,   ///< `resume-from` does not ask about what may be cut already
};

/// Explores one job of one sheet, breadth first, to `depth` steps: what a person does, what the
/// cutter does, each record of an intent, and crashes after which the database, the journal or the
/// witness may have lost their ends or be gone.
///
/// The rules are popcut's own: `step_of`, `state_after`, `may_resume`, `merged_fates`,
/// `verdict_on`, `surfacing_of`. The promises: no stroke is cut twice on a blank unless a person
/// said so; what the ledger calls certain was cut and what it calls not sent was not; a job is done
/// only if it was cut or a person said so; there is always something to do with a job that has not
/// ended.
///
/// What no record can show is left out: all records of an attempt gone at once, or all three set
/// back to the same earlier moment.
[[nodiscard]] Exploration explore_knife(int depth, Flaw flaw);

}  // namespace popcut::testing
