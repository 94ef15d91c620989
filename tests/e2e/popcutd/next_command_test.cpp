// SPDX-License-Identifier: MIT
// Whoever is refused, or stands before a cutter that went wrong, finds the next command in what is
// printed.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/api.hpp"
#include "tests/support/at_terminal.hpp"
#include "tests/support/daemon_with_cli.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/running_daemon.hpp"

namespace next_command_test {

using namespace popcut::testing;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

namespace {

/// The commands in a message, without the comments behind them.
std::vector<std::string> commands_in(const std::string& text) {
  std::vector<std::string> all;
  constexpr std::string_view kBegin = "popcut ";
  for (std::size_t at = text.find(kBegin); at != std::string::npos; at = text.find(kBegin, at)) {
    const bool is_word = at == 0 || text[at - 1] == ' ' || text[at - 1] == '\'';
    std::size_t end = text.size();
    for (const char* stop : {"'", ", or ", " (", ";", "\n", "  "})
      end = std::min(end, text.find(stop, at));
    if (is_word) all.push_back(text.substr(at, end - at));
    at = end;
  }
  return all;
}

Words words_of(const std::string& command) {
  std::istringstream in(command);
  Words words;
  for (std::string word; in >> word;) words.push_back(word);
  words.erase(words.begin());  // popcut
  return words;
}

std::string device(const std::string& id, const char* machine, double time_scale,
                   const std::string& faults = "") {
  return fmt::format("[[device]]\nid = \"{}\"\nmachine = \"{}\"\ntime_scale = {}\n{}", id, machine,
                     time_scale, faults.empty() ? "" : fmt::format("faults = \"{}\"\n", faults));
}

constexpr int kLines = 30;

/// A popcutd with cutters that go wrong, and a person who has only what popcut prints.
struct Workshop : DaemonWithCli {
  explicit Workshop(const std::string& more, double time_scale = 0)
      : DaemonWithCli(time_scale, more) {
    write_file(file("lines.svg"), RunningDaemon::lines_svg(kLines));
  }
  [[nodiscard]] std::string file(const std::string& name) const {
    return (daemon.folder() / name).string();
  }
  [[nodiscard]] std::string queue(const std::string& on) const {
    const Ran ran = popcut({"cut", "-q", file("lines.svg"), "--device", on});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    const std::string id = ran.out.substr(0, 26);
    REQUIRE(comes_to(id, "ready"));
    return id;
  }
  void must(const Words& words) const {
    const Ran ran = popcut(words);
    CAPTURE(words, ran.err);
    REQUIRE(ran.exit == 0);
  }
  /// Whether popcut takes the words: with no popcutd, it then looks for one.
  [[nodiscard]] bool is_command(const Words& words) const {
    ::setenv("POPCUT_URL", "unix:/nowhere/popcut.sock", 1);
    const Ran ran = popcut(words);
    ::setenv("POPCUT_URL", daemon.socket().c_str(), 1);
    CAPTURE(words, ran.err);
    return ran.exit == 5 || (words.front() == "devices" && ran.exit == 0);
  }
  /// The command is refused, says `part`, and names commands; the first of them.
  [[nodiscard]] Words cure(const Words& words, const std::string& part) const {
    const Ran ran = popcut(words);
    CAPTURE(words, ran.err);
    CHECK(ran.exit != 0);
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
    CHECK(says(ran.err, part));
    const std::vector<std::string> commands = commands_in(ran.err);
    REQUIRE_FALSE(commands.empty());
    for (const std::string& command : commands) {
      CAPTURE(command);
      CHECK(is_command(words_of(command)));
    }
    return words_of(commands.front());
  }
};

const char* const kStall = R"j({"popcut": 1, "faults": [{"at_path": 6, "kind": "stall"}]})j";

}  // namespace

TEST_CASE("every refusal names a command that cures it", "[popcutd][cli][next]") {
  const TempFolder scripts;
  const std::string stall = (scripts / "stall.json").string();
  write_file(stall, kStall);
  Workshop shop(device("sim:slow", "cameo3", 1) + device("sim:stuck", "cameo3", 0, stall) +
                device("sim:wide", "cameo4", 0));
  shop.open();
  const std::string id = shop.queue("sim:cameo3"), other = shop.queue("sim:cameo3");
  const auto arm = Words{"arm", id, "1"};

  SECTION("a job that is ready, held or armed") {
    for (const Words& words : std::vector<Words>{{"resume", id},
                                                 {"start", id},
                                                 {"arm", id, "2"},
                                                 {"arm", id, "1", "--blank", "7"},
                                                 {"arm", id, "--device", "sim:nowhere"},
                                                 {"resume", id, "--from", "3"},
                                                 {"confirm", id, "1", "good"},
                                                 {"pause", id},
                                                 {"retry", id, "2"}})
      CHECK(shop.cure(words, "") == arm);
    const Words change{"change", id, "--device", "sim:slow"};
    const Words again{"change", id, "--device", "sim:wide", "--plan-again"};
    CHECK(shop.cure({"change", id, "--device", "sim:wide"}, "planned for") == again);
    CHECK(shop.cure({"arm", id, "--device", "sim:wide"}, "") == again);
    CHECK(shop.cure({"change", id, "--device", "sim:none"}, "one of") == change);
    CHECK(shop.cure({"resume", id, "--from"}, "needs a path") == Words{"jobs", id.substr(0, 12)});
    CHECK(shop.cure({"arm"}, "name one of") == Words{"arm", std::min(id, other)});
    CHECK(shop.cure({"pause"}, "not possible for any job") == Words{"jobs"});
    shop.must({"hold", id});
    for (const char* action : {"arm", "start", "resume"})
      CHECK(shop.cure({action, id}, "held") == Words{"release", id});
    shop.must({"release", id});
    shop.must(arm);
    for (const Words& words : std::vector<Words>{
             arm, {"resume", id}, {"retry", id}, {"change", id, "--name", "x"}, {"arm", other}})
      CHECK(shop.cure(words, "") == Words{"start", id});
    CHECK(shop.cure({"devices", "reset", "sim:cameo3"}, "holds a sheet") == Words{"disarm", id});
    shop.must({"devices", "disable", "sim:cameo3"});
    const Words enable{"devices", "enable", "sim:cameo3"};
    CHECK(shop.cure(arm, "disabled") == enable);
    CHECK(shop.cure({"start", id}, "") == enable);
    CHECK(shop.cure({"cut", "--test", "--device", "sim:cameo3"}, "disabled") == enable);
    shop.must(enable);
    shop.must(arm);
  }
  SECTION("a job that is cutting, paused or over") {
    const std::string slow = shop.queue("sim:slow");
    shop.must({"arm", slow});
    shop.must({"start", slow});
    for (const Words& words : std::vector<Words>{{"arm", slow},
                                                 {"retry", slow},
                                                 {"resume", slow},
                                                 {"resume", slow, "--from", "2"},
                                                 {"change", slow, "--priority", "2"},
                                                 {"hold", slow}})
      CHECK(shop.cure(words, "") == Words{"pause", slow});
    CHECK(shop.cure({"devices", "reset", "sim:slow"}, "holds a sheet") == Words{"cancel", slow});
    // Behind a cut one can but wait, unless another cutter is free.
    const std::string next = shop.queue("sim:slow");
    CHECK(shop.cure({"arm", next}, "holds a sheet") ==
          Words{"change", next, "--device", "sim:cameo3"});
    for (const char* busy : {"sim:cameo3", "sim:stuck"}) shop.must({"devices", "disable", busy});
    shop.must({"change", next, "--device", ""});
    CHECK(shop.cure({"arm", next}, "holds a sheet").front() == "devices");
    shop.must({"pause", slow});
    REQUIRE(shop.comes_to(slow, "paused"));
    for (const Words& words : std::vector<Words>{{"arm", slow}, {"retry", slow}, {"hold", slow}})
      CHECK(shop.cure(words, "") == Words{"resume", slow});
    shop.must({"devices", "disable", "sim:slow"});
    CHECK(shop.cure({"resume", slow}, "disabled") == Words{"devices", "enable", "sim:slow"});
    shop.must({"devices", "enable", "sim:slow"});
    shop.must({"cancel", slow});
    REQUIRE(shop.comes_to(slow, "cancelled"));
    for (const char* action : {"arm", "resume", "retry", "cancel", "hold"})
      CHECK(shop.cure({action, slow}, "") == Words{"jobs"});
    CHECK(shop.cure({"arm", "01ARZ3NDEKTSV4RRFFQ69G5FAV"}, "no job") == Words{"jobs", "--all"});
    CHECK(shop.cure({"devices", "reset", "sim:cutter"}, "no device") == Words{"devices"});
  }
  SECTION("a sheet that was interrupted, on a cutter in fault") {
    const std::string stuck = shop.queue("sim:stuck");
    shop.must({"arm", stuck});
    shop.must({"start", stuck});
    REQUIRE(shop.comes_to(stuck, "interrupted"));
    const Words reset{"devices", "reset", "sim:stuck"};
    for (const Words& words : std::vector<Words>{{"arm", stuck},
                                                 {"start", stuck},
                                                 {"resume", stuck},
                                                 {"resume", stuck, "--from", "0"},
                                                 {"confirm", stuck, "1", "good"},
                                                 {"retry", stuck, "2"}}) {
      CHECK(shop.cure(words, "") == reset);
      const std::string told = shop.popcut(words).err;
      CHECK(says(told, "(skips what is in doubt)"));
      CHECK(says(told, "(cuts again what may be cut already)"));
    }
    const Words skip = shop.cure({"resume", stuck, "--from"}, "skips what is in doubt");
    CHECK(skip.back() == "--skip-in-doubt");
    const std::string shown = shop.popcut({"jobs", stuck}).out;
    // popcut itself prints the short form of ids.
    CHECK(shop.popcut({"jobs", stuck.substr(0, 12)}).out == shown);
    CHECK(says(shown, "popcut " + fmt::format("{}", fmt::join(skip, " "))));
    CHECK(says(shown, "popcut devices reset sim:stuck"));
    CHECK(shop.cure({"cut", "--test", "--device", "sim:stuck"}, "in fault") == reset);
    shop.must(skip);
    CHECK(shop.cure({"arm", stuck}, "in fault") == reset);
    CHECK(says(shop.popcut({"jobs", stuck}).out, "popcut devices reset sim:stuck"));
    CHECK(says(shop.popcut({"jobs"}).out, "popcut devices reset sim:stuck"));
    shop.must(reset);
    CHECK(shop.until_done({"arm", stuck}).exit == 0);
    shop.must({"start", stuck, "--wait"});
  }
  SECTION("a person who may not") {
    const Ran token = shop.popcut({"token", "create", "--role", "viewer"});
    REQUIRE(token.exit == 0);
    ::setenv("POPCUT_TOKEN", token.out.substr(0, token.out.find('\n')).c_str(), 1);
    ::setenv("POPCUT_URL", shop.daemon.url().c_str(), 1);
    const std::string arming = shop.popcut(arm).err;
    const std::string resetting = shop.popcut({"devices", "disable", "sim:slow"}).err;
    ::unsetenv("POPCUT_TOKEN");
    ::setenv("POPCUT_URL", shop.daemon.socket().c_str(), 1);
    for (const auto& [text, role] : {std::pair(arming, "operator"), {resetting, "admin"}}) {
      CAPTURE(text);
      const auto commands = commands_in(text);
      REQUIRE(commands.size() == 1);
      CHECK(words_of(commands[0]) == Words{"token", "create", "--role", role});
      shop.must(words_of(commands[0]));
    }
  }
}

namespace {

/// Somebody at the terminal who does nothing but run the command that stands in the last message.
struct Hand {
  const Workshop& shop;
  std::string id;
  bool skips{};  ///< of what is in doubt: skip it, else cut it again
  std::vector<std::string> typed{};
  std::string reason{};  ///< of the first interruption

  /// Among the commands of a message the one that goes on.
  [[nodiscard]] std::string chosen(const std::string& message) const {
    std::vector<std::string> commands = commands_in(message);
    if (commands.empty()) return {};
    if (says(commands.front(), "devices reset")) return commands.front();
    for (const std::string& command : commands)
      if (says(command, skips ? "--skip-in-doubt" : "--accept-double-cut")) return command;
    return commands.front();
  }
  /// Until the job is over; false if a message names no command or it takes too many of them.
  [[nodiscard]] bool sees_it_through(std::string message) {
    constexpr std::size_t kMost = 30;
    while (typed.size() < kMost) {
      const std::string command = chosen(message);
      if (command.empty()) return says(message, "done");
      typed.push_back(command);
      Words words = words_of(command);
      const bool looks = words.back() == "--watch" || words == Words{"devices"};
      const Json job = shop.job(id);
      if (job["state"] == "interrupted" && reason.empty()) reason = job["reason"];
      if (looks) {  // until there is something to do: the view itself would not end
        REQUIRE(comes_true([&] {
          const std::string state = shop.job(id)["state"];
          return state != "queued" && state != "planning" && state != "cutting";
        }));
        words = {"jobs", id};
      }
      const Ran ran = shop.popcut(words);
      message = ran.out + ran.err;
    }
    return false;
  }
};

}  // namespace

TEST_CASE("a shift at two cutters is worked with the printed commands alone",
          "[popcutd][cli][next]") {
  const TempFolder scripts;
  const std::string left = (scripts / "left.json").string();
  const std::string right = (scripts / "right.json").string();
  struct Fault {
    const char *members, *reason;
  };
  // A cutter meets its fault at the first sheet after popcutd has started.
  const std::vector<Fault> faults{
      {R"("at_path": 6, "kind": "stall")", "stall"},
      {R"("at_path": 5, "kind": "media out")", "media_out"},
      {R"("at_path": 5, "kind": "cancel", "seconds": 1)", "panel_stop"},
      {R"("at_byte": 450, "kind": "unplug")", "device_gone"},
      {R"("kind": "wrong name", "text": "PORTRAIT V1.00   ")", "refused"}};
  const auto script = [&](const std::string& file, const Fault& fault) {
    write_file(file, fmt::format(R"j({{"popcut": 1, "faults": [{{{}}}]}})j", fault.members));
  };
  Workshop shop(device("sim:left", "cameo3", 0, left) + device("sim:right", "cameo3", 0, right), 8);
  for (std::size_t k = 0; k < faults.size(); ++k) {
    CAPTURE(faults[k].reason);
    if (k % 2 == 0) {
      script(left, faults[k]);
      script(right, faults[(k + 1) % faults.size()]);
      if (k > 0) shop.daemon.signal(SIGTERM);
      if (k > 0) CHECK(shop.daemon.wait() == 0);
      shop.open();
    }
    const Ran queued = shop.popcut(
        {"cut", shop.file("lines.svg"), "--device", k % 2 == 0 ? "sim:left" : "sim:right"});
    REQUIRE(queued.exit == 0);
    Hand hand{shop, queued.out.substr(0, 26), k < 2};
    const bool through = hand.sees_it_through(queued.err);
    CAPTURE(hand.typed);
    CHECK(through);
    CHECK(shop.job(hand.id)["state"] == "done");
    CHECK(hand.reason == faults[k].reason);
  }
  // And popcutd itself is killed in the middle of a cut.
  const std::string id = shop.queue("sim:cameo3");
  shop.must({"arm", id});
  shop.must({"start", id});
  REQUIRE(comes_true([&] { return shop.job(id)["progress"]["paths_sent"] > 3; }));
  shop.daemon.signal(SIGKILL);
  CHECK(shop.daemon.wait() == 128 + SIGKILL);
  shop.open();
  Hand hand{shop, id, false};
  CHECK(hand.sees_it_through(shop.popcut({"jobs"}).out));
  CHECK(hand.reason == "crash");
  CHECK(shop.job(id)["state"] == "done");
}

TEST_CASE("a watched job that popcutd no longer has leaves the view and is asked for no more",
          "[popcutd][cli][next]") {
  Workshop shop("");
  shop.open();
  const std::string gone = shop.queue("sim:cameo3"), ended = shop.queue("sim:cameo3");
  AtTerminal view(popcut_program(), {"jobs", "--watch"}, shop.daemon.folder());
  const auto printed = [&](const std::string& words) {
    return comes_true([&] { return says(view.out(), words); });
  };
  CHECK(printed(gone.substr(0, 12) + " lines: ready"));
  shop.must({"cancel", gone});
  shop.must({"cancel", ended});
  CHECK(printed(ended.substr(0, 12) + " lines: cancelled"));
  auto api = popcut::client::Api::from_environment();
  REQUIRE(api);
  REQUIRE(api->remove("/v1/jobs/" + gone, "job"));
  CHECK(printed(gone.substr(0, 12) + " lines: popcutd no longer has it"));
  CHECK_FALSE(says(view.out(), ended.substr(0, 12) + " lines: popcutd no longer"));
  // In three looks more it is not asked for: the log has one 404 at most.
  const auto misses = [&] {
    const std::string log = shop.daemon.log();
    std::size_t count = 0;
    for (std::size_t at = log.find(gone + " 404"); at != std::string::npos;
         at = log.find(gone + " 404", at + 1))
      ++count;
    return count;
  };
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  CHECK(misses() <= 1);
  view.type("\x03");
  CHECK(view.ended() == 0);
}

}  // namespace next_command_test
