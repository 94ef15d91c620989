// SPDX-License-Identifier: MIT
// What goes wrong at a cutter and on its cable, through the whole of popcutd.
#include <algorithm>
#include <chrono>
#include <csignal>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/text/words.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/running_daemon.hpp"
#include "tests/support/service_manager_socket.hpp"
#include "tests/support/timing.hpp"

namespace faults_cutter_test {

using namespace popcut;
using namespace popcut::testing;
using Json = nlohmann::json;
using std::chrono::steady_clock;

namespace {

constexpr int kLines = 40, kFew = 16;

/// A simulated cutter of which the first sheet meets a fault.
struct Wrong {
  std::string fault;   ///< members of a fault, as in a script
  std::string state;   ///< of the job in the end
  std::string reason;  ///< of the job
  std::string device;  ///< its state afterwards
};

/// Several cutters, a fault each, and a folder for their scripts and traces.
struct Wrongs {
  TempFolder folder;
  std::vector<Wrong> all;
  double time_scale{0};

  static std::string id(std::size_t k) { return fmt::format("sim:c{}", k); }
  [[nodiscard]] std::filesystem::path trace(std::size_t k) const {
    return folder / fmt::format("trace{}", k);
  }
  [[nodiscard]] std::string config() const {
    std::string text;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::string script = folder / fmt::format("faults{}.json", k);
      write_file(script, R"j({"popcut": 1, "faults": [{)j" + all[k].fault + "}]}");
      text += fmt::format(
          "[[device]]\nid = \"{}\"\nmachine = \"cameo3\"\ntime_scale = {}\nfaults = \"{}\"\n"
          "trace = \"{}\"\n",
          id(k), time_scale, script, trace(k).string());
    }
    return text;
  }
};

bool printable(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if ((c < 0x20 && c != '\n') || c == 0x7f) return false;
    // U+0080 to U+009F: some terminals take them for escape sequences.
    if (c == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0)
      return false;
  }
  return true;
}

}  // namespace

TEST_CASE("after any fault of a cutter its job ends with a true ledger and nothing restarts",
          "[popcutd][faults]") {
  Wrongs wrongs;
  // A cable pulled at bytes of some strokes, and between them.
  for (int byte = 400; byte < 520; byte += 5)
    wrongs.all.push_back({fmt::format(R"("at_byte": {}, "kind": "unplug")", byte), "interrupted",
                          "device_gone", "fault"});
  const std::size_t pulled = wrongs.all.size();
  for (const auto& [fault, state, reason, device] : std::vector<Wrong>{
           {R"("at_path": 6, "kind": "stall")", "interrupted", "stall", "fault"},
           {R"("at_byte": 450, "kind": "stall")", "interrupted", "stall", "fault"},
           {R"("at_byte": 451, "kind": "short write")", "done", "", "idle"},
           {R"("at_byte": 452, "kind": "nak", "seconds": 20)", "done", "", "idle"},
           {R"("at_byte": 453, "kind": "nak", "seconds": 100000)", "interrupted", "stall", "fault"},
           {R"("at_byte": 454, "kind": "silence", "seconds": 0.8)", "done", "", "idle"},
           {R"("at_byte": 455, "kind": "silence", "seconds": 100000)", "interrupted", "stall",
            "fault"},
           {R"("at_byte": 456, "kind": "garbage", "text": "\u00ff\u0003\u0003{}%n0\u0003")", "done",
            "", "idle"},
           {R"("at_byte": 457, "kind": "garbage", "text": "\u0003")", "done", "", "idle"},
           {R"("at_path": 5, "kind": "pause", "seconds": 30)", "done", "", "idle"},
           {R"("at_path": 5, "kind": "cancel", "seconds": 1)", "interrupted", "panel_stop",
            "attention"},
           {R"("at_path": 5, "kind": "media out")", "interrupted", "media_out", "attention"},
           {R"("kind": "wrong name", "text": "PORTRAIT V1.00   ")", "interrupted", "refused",
            "attention"}})
    wrongs.all.push_back({fault, state, reason, device});
  RunningDaemon popcutd(0, wrongs.config());
  popcutd.open();
  const std::string design = popcutd.design(RunningDaemon::lines_svg(kLines));
  std::vector<std::string> jobs;
  std::set<std::string> doubts;
  for (std::size_t k = 0; k < wrongs.all.size(); ++k) {
    jobs.push_back(popcutd.ready_job(design, Wrongs::id(k)));
    popcutd.cut(jobs.back());
  }
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const Wrong& wrong = wrongs.all[k];
    CAPTURE(wrong.fault);
    const Json job = popcutd.await(jobs[k], [](const Json& now) {
      return now["state"] == "done" || now["state"] == "interrupted";
    });
    CHECK(job["state"] == wrong.state);
    if (wrong.state == "interrupted") {
      CHECK(job["reason"] == wrong.reason);
      CHECK_FALSE(job["attention"]["text"].get<std::string>().empty());
    }
    CHECK(happens([&] { return popcutd.device_state(Wrongs::id(k)) == wrong.device; }));
    const Json ledger = popcutd.ledger(jobs[k]);
    INFO(ledger.dump());
    CHECK(wrong_in(ledger, kLines, lines_cut(wrongs.trace(k), kLines)) == "");
    CHECK(ledger["attempts"].size() == 1);
    if (k < pulled) doubts.insert(ledger["in_doubt"].dump());
    if (wrong.device == "fault") {
      // Nothing is sent to it until somebody has looked.
      REQUIRE(popcutd.act(jobs[k], "retry-sheet", {{"sheet", 1}})["state"] == "ready");
      CHECK_FALSE(popcutd.api().act(popcutd.job(jobs[k]), "arm", {{"sheet", 1}}));
      popcutd.reset(Wrongs::id(k));
      CHECK(happens([&] { return popcutd.device_state(Wrongs::id(k)) == "idle"; }));
      CHECK(popcutd.job(jobs[k])["state"] == "ready");
    }
  }
  CHECK(doubts.size() > 3);  // the cable was pulled in different strokes
  // After a reset a person cuts the sheet anew, and the whole of it.
  popcutd.cut(jobs[0]);
  popcutd.await_state(jobs[0], "done");
  CHECK(lines_cut(wrongs.trace(0), kLines).size() == kLines);
}

TEST_CASE("a cutter that takes no data shows as busy and is cancelled at once",
          "[popcutd][faults][seconds]") {
  Wrongs wrongs;
  wrongs.time_scale = 12;
  wrongs.all = {{R"("at_path": 5, "kind": "nak", "seconds": 100000)", "", "", ""},
                {R"("at_path": 16, "kind": "nak", "seconds": 100000)", "", "", ""},
                {R"("at_path": 3, "kind": "nak", "seconds": 30)", "", "", ""}};
  ServiceManagerSocket manager;
  RunningDaemon popcutd(0, wrongs.config());
  popcutd.open(manager.environment(4));
  const std::string design = popcutd.design(RunningDaemon::lines_svg(kFew));
  std::vector<std::string> jobs;
  for (std::size_t k = 0; k < wrongs.all.size(); ++k) {
    jobs.push_back(popcutd.ready_job(design, Wrongs::id(k)));
    popcutd.cut(jobs[k]);
  }
  for (const std::size_t k : {0U, 1U}) {
    const Json job =
        popcutd.await(jobs[k], [](const Json& now) { return !now["attention"].is_null(); });
    CHECK(job["state"] == "cutting");
    CHECK(job["attention"]["kind"] == "device_busy");
    CHECK(job["attention"]["text"].get<std::string>().find("accepts no data") != std::string::npos);
  }
  // One goes on by itself, and is said to be no longer busy.
  popcutd.await_state(jobs[2], "done");
  CHECK(popcutd.job(jobs[2])["attention"].is_null());
  const Json events = popcutd.get("/v1/events?after=0&limit=200");
  CHECK(std::any_of(events["items"].begin(), events["items"].end(), [&](const Json& event) {
    return event.value("job", "") == jobs[2] && event.value("reason", "") == "device_busy";
  }));
  // All threads turn meanwhile.
  manager.feedings();
  CHECK(happens([&] { return manager.feedings() > 0; }));
  CHECK(happens([&] { return popcutd.ask("GET", "/readyz").status == 200; }));
  bool is_quick = false;  // one of them: the other may have met a machine that was busy otherwise
  for (std::size_t k : {0U, 1U}) {
    CAPTURE(k);
    const auto begun = steady_clock::now();
    popcutd.act(jobs[k], "cancel");
    const Json job =
        popcutd.await(jobs[k], [](const Json& now) { return now["state"] == "cancelled"; });
    is_quick = is_quick || in_time(begun, 1);
    CHECK(wrong_in(popcutd.ledger(jobs[k]), kFew, lines_cut(wrongs.trace(k), kFew)) == "");
  }
  CHECK(is_quick);
}

TEST_CASE("popcutd ends in time although a cutter takes no data", "[popcutd][faults][seconds]") {
  Wrongs wrongs;
  wrongs.time_scale = 20;
  wrongs.all = {{R"("at_path": 5, "kind": "nak", "seconds": 100000)", "", "", ""},
                {R"("at_path": 16, "kind": "nak", "seconds": 100000)", "", "", ""},
                {R"("at_path": 5, "kind": "pause")", "", "", ""}};
  RunningDaemon popcutd(0, wrongs.config());
  popcutd.open();
  const std::string design = popcutd.design(RunningDaemon::lines_svg(kFew));
  std::vector<std::string> jobs;
  for (std::size_t k = 0; k < wrongs.all.size(); ++k) {
    jobs.push_back(popcutd.ready_job(design, Wrongs::id(k)));
    popcutd.cut(jobs[k]);
  }
  for (const std::string& id : jobs)
    popcutd.await(id, [](const Json& now) { return !now["attention"].is_null(); });
  const auto begun = steady_clock::now();
  popcutd.daemon().signal(SIGTERM);
  CHECK(popcutd.daemon().wait() == 0);
  CHECK(in_time(begun, 30));  // of the 45 that a service manager grants
  popcutd.open();
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    CAPTURE(k);
    const Json job = popcutd.job(jobs[k]);
    CHECK(job["state"] == "interrupted");
    CHECK(job["reason"] == "shutdown");
    CHECK(wrong_in(popcutd.ledger(jobs[k]), kFew, lines_cut(wrongs.trace(k), kFew)) == "");
  }
}

TEST_CASE("a cutter's replies reach terminals and pages only as plain text", "[popcutd][faults]") {
  // Escape sequences in both forms, a tag, and what ends a JSON text.
  const std::string evil =
      R"(\u001b[2J\u001b]0;owned\u0007<img src=x onerror=alert(1)>\"}\u009b31m V1.0)";
  Wrongs wrongs;
  wrongs.all = {{R"("kind": "wrong name", "text": ")" + evil + "\"", "", "", ""},
                {R"("at_byte": 450, "kind": "garbage", "text": ")" + evil + "\"", "", "", ""},
                {R"("kind": "wrong name", "text": "<b>x</b>\u001b[1m V9")", "", "", ""}};
  RunningDaemon popcutd(0, wrongs.config());
  popcutd.open();
  const std::string design = popcutd.design(RunningDaemon::lines_svg(kLines));
  for (std::size_t k = 0; k < wrongs.all.size(); ++k) {
    const std::string id = popcutd.ready_job(design, Wrongs::id(k));
    popcutd.cut(id);
    popcutd.await(id, [](const Json& now) {
      return now["state"] == "done" || now["state"] == "interrupted";
    });
  }
  ::setenv("POPCUT_URL", popcutd.daemon().socket().c_str(), 1);
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"jobs"}, {"jobs", "--json"}, {"devices"}, {"events"}, {"events", "--json"}}) {
    std::vector<std::string> all{popcut_program()};
    all.insert(all.end(), words.begin(), words.end());
    const Ran ran = run_program(all, "/");
    CAPTURE(words.front(), ran.out);
    CHECK(printable(ran.out));
    CHECK(printable(ran.err));
  }
  // Nor do names in a file that somebody sent.
  write_file(popcutd.daemon().folder() / "evil.json",
             R"j({"popcut": 1, "units_per_slice": 4, "slices": 4, "\u001b[2J\u009b2J": 1})j");
  const Ran ran = run_program({popcut_program(), "design", "evil.json", "-o", "out"},
                              popcutd.daemon().folder().path());
  CAPTURE(ran.err);
  CHECK(ran.exit == 3);
  CHECK(ran.err.find("2J") != std::string::npos);
  CHECK(printable(ran.err));
  CHECK(printable(popcutd.daemon().log()));
  for (const char* target : {"/v1/jobs", "/v1/devices", "/v1/events?after=0"}) {
    const client::HttpResponse answer = popcutd.ask("GET", target);
    CHECK(answer.status == 200);
    CHECK(printable(answer.body));
    CHECK(Json::accept(answer.body));
    // No answer is a page.
    CHECK(answer.content_type.find("html") == std::string::npos);
  }
}

TEST_CASE("a name is plain text and never a path or an escape sequence", "[popcutd][faults]") {
  RunningDaemon popcutd;
  popcutd.open();
  const std::string svg = RunningDaemon::lines_svg(3);
  const std::string design = popcutd.design(svg);
  const auto make = [&](const std::string& member, const Json& value) {
    Json request{{"design", design}};
    request[member] = value;
    return popcutd.ask("POST", "/v1/jobs", request.dump());
  };
  for (const char* control : {"a\x1b[31m", "a\nb", "\x7f",
                              "a\xc2\x9b"
                              "31m",
                              "\x01"}) {
    CAPTURE(Json(control).dump());
    CHECK(make("name", control).status == 422);
    CHECK(make("tags", {control}).status == 422);
    CHECK(popcutd.ask("POST", "/v1/designs?name=" + percent_encoded(control), svg, "image/svg+xml")
                  .status /
              100 ==
          4);
  }
  // What is only odd is kept as it is.
  for (const char* odd :
       {"../../../../tmp/popcut-evil", "/etc/passwd", "<img src=x onerror=alert(1)>",
        "'; DROP TABLE job; --", "%2e%2e%2f", "nul", "a\\b", "$(reboot)"}) {
    CAPTURE(odd);
    const client::HttpResponse made = make("name", odd);
    CHECK(made.status == 201);
    CHECK(Json::parse(made.body)["name"] == odd);
    CHECK(popcutd.ask("POST", "/v1/designs?name=" + percent_encoded(odd), svg, "image/svg+xml")
              .status < 300);
  }
  const Json listed = popcutd.get("/v1/jobs");
  for (const Json& job : listed["items"]) popcutd.await_state(job["id"], "ready");
  // No name of a file has anything of it.
  for (const std::string& file : files_below(popcutd.daemon().state())) {
    CAPTURE(file);
    for (const char* part : {"evil", "passwd", "img", "DROP", "%", "nul", "reboot", "\\"})
      CHECK(file.find(part) == std::string::npos);
  }
  CHECK_FALSE(std::filesystem::exists("/tmp/popcut-evil"));
}

}  // namespace faults_cutter_test
