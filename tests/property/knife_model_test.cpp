// SPDX-License-Identifier: MIT
// The rules of jobs, the ledger and the recovery of the journals, explored as a whole.
#include <chrono>
#include <cstdlib>
#include <string>

#include <catch2/catch.hpp>

#include "tests/support/knife_model.hpp"

namespace knife_model_test {

using popcut::testing::Exploration;
using popcut::testing::explore_knife;
using popcut::testing::Flaw;
using popcut::testing::told;

namespace {

constexpr int kDepth = 6;      // in the suite; POPCUT_MODEL_DEPTH asks for another
constexpr int kFlawDepth = 8;  // the first wrong state ends the search

}  // namespace

TEST_CASE("in no state that can be reached is a stroke cut twice unasked or a job lost",
          "[daemon][model]") {
  const char* const text = std::getenv("POPCUT_MODEL_DEPTH");
  const Exploration all = explore_knife(text == nullptr ? kDepth : std::atoi(text), Flaw::None);
  INFO(told(all));
  CHECK(all.wrong.empty());
  CHECK(all.states > 10'000);
  WARN(told(all));
}

TEST_CASE("the model finds each rule that is broken on purpose", "[daemon][model]") {
  struct Broken {
    Flaw flaw;
    const char* what;
  };
  for (const Broken& broken :
       {Broken{Flaw::DatabaseOnly, "the database alone is believed"},
        Broken{Flaw::IgnoresWitness, "the witness is ignored"},
        Broken{Flaw::IgnoresJournal, "journals of unknown attempts are ignored"},
        Broken{Flaw::SendsBeforeIntent, "intents are recorded after sending"},
        Broken{Flaw::ForgetsAtTheEnd, "journals are removed before their end is kept"},
        Broken{Flaw::QueuesAgain, "what was cut is queued again"},
        Broken{Flaw::ResumesOverDoubt, "resuming asks nothing"}}) {
    const Exploration found = explore_knife(kFlawDepth, broken.flaw);
    INFO(broken.what << ": " << told(found));
    CHECK_FALSE(found.wrong.empty());
    WARN(broken.what << ": found after " << found.states << " states: " << found.wrong);
  }
}

}  // namespace knife_model_test
