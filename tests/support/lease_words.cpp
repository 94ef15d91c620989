// SPDX-License-Identifier: MIT
// Part of tests/support/lease_world.hpp: its steps in words.
#include <array>

#include <fmt/format.h>

#include "tests/support/lease_world.hpp"

namespace popcut::testing::lease {

std::string sentence(const Step& step) {
  static constexpr std::array<const char*, 3> kWho{"node 1", "node 2", "the copy of node 1"};
  const std::string who = kWho.at(step.process);
  switch (step.what) {
    case Do::Begin0:
      return "a job of two sheets is ready; both nodes have a lease";
    case Do::CloneStops:
      return "the copy of node 1 is switched off";
    case Do::Restart:
      return who + " starts";
    case Do::Reconnect:
      return who + " reaches the database again";
    case Do::StartArrives:
      return "the database answers the START of " + who;
    case Do::AnswerArrives:
      return who + (step.detail != 0 ? " hears that its START is committed, and begins to cut"
                                     : " hears of its START, and does not cut");
    case Do::StrayArrives: {
      static constexpr std::array<const char*, 4> kWhat{"message", "START", "mark", "end"};
      return fmt::format("a {} of {}, sent before, arrives only now", kWhat.at(step.detail), who);
    }
    case Do::BeatFails:
      return who + " hears that its lease is over";
    case Do::LeaseEnds:
      return "the lease of " + who + " runs out";
    case Do::Begins:
      return who + " begins a new epoch";
    case Do::Recovers:
      return who + " tells what its journals know";
    case Do::Resolves:
      return who + " takes back the START of which it heard nothing";
    case Do::Guesses:
      return who + " takes back a START of which it thinks that nothing was sent";
    case Do::Notices:
      return who + " notices that its cut is superseded, and stops";
    case Do::Strokes:
      return fmt::format("the knife of {} cuts stroke {}", who, step.detail + 1);
    case Do::Intends:
      return who + (step.detail != 0
                        ? " writes down the next stroke, in its journal and in the database"
                        : " writes down the next stroke in its journal only");
    case Do::Stops:
      return who + " stops, as a person asked";
    case Do::Holds:
      return who + " holds, as a person asked";
    case Do::Tells:
      return who + " tells the end of its cut";
    case Do::Sweeps:
      return "the other node ends what the lease of " + who + " left";
    case Do::Resumes:
      return "a person at " + who + " resumes";
    case Do::Disarms:
      return "a person disarms";
    case Do::Skips:
      return "a person skips the sheet";
    case Do::StrayLost:
      return "a message of " + who + " is lost for good";
    case Do::BeatArrives:
      return "a heartbeat of " + who + " arrives";
    case Do::OwnClockEnds:
      return who + " has heard nothing for so long that its lease may be over";
    case Do::Arms:
      return "a person arms at " + who;
    case Do::PressesStart:
      return "a person presses START at " + who;
    case Do::Pauses:
      return "a person pauses";
    case Do::Cancels:
      return "a person cancels";
    case Do::Confirms:
      return "a person says that the sheet is good";
    case Do::SaysNotGood:
      return "a person says that the sheet is not good";
    case Do::TakesNewBlank:
      return "a person takes a new blank";
    case Do::ResumesFrom:
      return fmt::format("a person at {} resumes from stroke {}{}{}", who,
                         step.detail % kStrokes + 1,
                         (step.detail / kStrokes & 1) != 0 ? ", and accepts a double cut" : "",
                         (step.detail / kStrokes & 2) != 0 ? ", and leaves what is in doubt" : "");
    case Do::GoesBack:
      return "the database goes back to its copy: a standby takes over, or a backup";
    case Do::Dies:
      return "popcutd dies on " + who;
    case Do::LinkBreaks:
      return who + " no longer reaches the database";
    case Do::StartLost:
      return "the connection of " + who + " breaks; it hears nothing of its START";
    case Do::StartDelayed:
      return "the connection of " + who + " breaks; its START is still under way";
    case Do::StartRepeated:
      return "the database answers the START of " + who + ", and gets it twice";
    case Do::MarkDelayed:
      return who + " writes down the next stroke; the connection breaks, the mark is under way";
    case Do::MarkRepeated:
      return who + " writes down the next stroke; the mark is sent twice";
    case Do::EndUnanswered:
      return who + " tells the end of its cut, and hears no answer";
    case Do::EndDelayed:
      return who + " tells the end of its cut; the connection breaks, the end is under way";
    case Do::EndRepeated:
      return who + " tells the end of its cut; it is sent twice";
    case Do::BeatsSlow:
      return "heartbeats of " + who + " come too late";
    case Do::CopyMade:
      return "from here on nothing reaches the copy of the database";
    case Do::Cloned:
      return "popcutd starts with a copy of node 1's state folder";
  }
  return {};
}

}  // namespace popcut::testing::lease
