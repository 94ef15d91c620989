// SPDX-License-Identifier: MIT
// The protocol by which the popcutd of a fleet share one queue, explored as a whole.
#include <cstdlib>
#include <string>

#include <catch2/catch.hpp>

#include "tests/support/lease_model.hpp"
#include "tests/support/rounds.hpp"

namespace lease_model_test {

using popcut::testing::Exploration;
using popcut::testing::explore_leases;
using popcut::testing::told;
using popcut::testing::lease::Bounds;
using popcut::testing::lease::Flaw;

namespace {

constexpr int kMost = 400'000'000;

int number(const char* name, int otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

// In the suite; the environment asks for others.
Bounds wanted_bounds() {
  const int starts = popcut::testing::fewer_rounds() ? 2 : 3;
  return {.faults = number("POPCUT_MODEL_FAULTS", 1),
          .attempts = number("POPCUT_MODEL_STARTS", starts),
          .states = static_cast<std::size_t>(number("POPCUT_MODEL_STATES", kMost))};
}

}  // namespace

TEST_CASE("in no state of a fleet that can be reached is a rule of its leases broken",
          "[daemon][model][lease]") {
  const Bounds bounds = wanted_bounds();
  const Exploration all = explore_leases(bounds, Flaw::None);
  INFO(told(all));
  CHECK(all.wrong.empty());
  CHECK((all.whole || bounds.states != kMost));
  CHECK(all.states > 400'000);
  CHECK(all.recoveries > 10'000);
  WARN(told(all));
}

TEST_CASE("the model of leases finds each rule that is broken on purpose",
          "[daemon][model][lease]") {
  struct Broken {
    Flaw flaw;
    const char* what;
    const char* finds;
    int faults{1};
  };
  const Broken all[]{
      {Flaw::EpochUnchecked, "the epoch of a node is not checked", "newest epoch"},
      {Flaw::IdentityUnchecked, "another process takes a name that is in use", "hold the lease"},
      {Flaw::ArmSurvivesRestart, "what is armed survives a restart", "another epoch armed"},
      {Flaw::SendsBeforeCommit, "bytes are sent before START is committed", "is committed"},
      {Flaw::StartsOnLostAnswer, "no answer to START counts as yes", "is committed"},
      {Flaw::StartsOnLateAnswer, "a late answer to START counts", "no longer valid"},
      {Flaw::StartDecidedTooEarly, "a START under way counts as lost", "does not cut"},
      {Flaw::HeartbeatRevives, "a heartbeat revives a lease that is over", "lost or unknown"},
      {Flaw::SweepsTheLiving, "a node with a lease is swept", "lost or unknown"},
      {Flaw::SweepMakesReady, "a lease that is over makes the sheet ready", "offered"},
      {Flaw::SweepKeepsNotSent, "a lease that is over leaves no doubt", "recorded as not sent"},
      {Flaw::SweepForgetsCancel, "a lease that is over forgets a cancel", "cancel"},
      {Flaw::MarkUnchecked, "marks of an old epoch are written", "recorded as not sent"},
      {Flaw::EndUnchecked, "an end is written over what superseded it", "superseded"},
      {Flaw::EndMovesTwice, "an end that comes twice counts twice", "not cut"},
      {Flaw::TakesUpSuperseded, "a cut is taken up though a person acted", "superseded"},
      {Flaw::OverrulesNotGood, "an end overrules a person's 'not good'", "not good"},
      {Flaw::TakesUpHeldAsCutting, "a held cut is taken up as one that moves", "is held"},
      {Flaw::JournalLoses, "journals do not win after a restore", "neither in the record"},
      {Flaw::JournalForgotten, "journals are removed at the end", "neither in the record"},
      {Flaw::ForgetsRunning, "what is being cut is not told after a restore",
       "neither in the record"},
      {Flaw::TakesBackByGuess, "what is open and not cut is taken back", "recorded as not sent"},
      {Flaw::ArmsBeforeAllReported, "nodes arm before all told their journals", "offered"},
      {Flaw::GoesOnAfterRestore, "nodes go on as if there was no restore", "lost or unknown"},
      {Flaw::CopyBelieved, "a copied journal is believed", "recorded as not sent", 2},
  };
  for (const Broken& broken : all) {
    const Exploration found =
        explore_leases({.faults = broken.faults, .attempts = 2, .states = kMost}, broken.flaw);
    INFO(broken.what << ": " << told(found));
    CHECK_FALSE(found.wrong.empty());
    CHECK(found.wrong.find(broken.finds) != std::string::npos);
    WARN(broken.what << ": " << told(found));
  }
}

}  // namespace lease_model_test
