// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>

#include <sqlite3.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/api.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/fault_page.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/received_log.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/timing.hpp"

namespace crash_test {

using namespace popcut;
using namespace popcut::testing;
using client::Api;
using client::HttpClient;
using nlohmann::json;
using std::chrono::steady_clock;

namespace {

constexpr int kLines = 48;
constexpr double kLong = 200;  // seconds; it dies before that, if at all

/// Short lines, none where another is, so that a place of the knife tells which stroke it is.
std::string design_svg() {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='200mm' height='200mm' viewBox='0 0 200 200'>";
  for (int k = 0; k < kLines; ++k)
    svg += fmt::format("<path fill='none' stroke='black' d='M{},{}h5'/>", 10 + k % 8 * 12,
                       10 + k / 8 * 12);
  return svg + "</svg>";
}

/// For how long the thread of a process that had to wait longest was ready and had no core.
double waited_for_a_core(pid_t process) {
  double longest_s = 0;
  std::error_code gone;
  for (const auto& thread :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process), gone)) {
    double ran_ns = 0, waited_ns = 0;
    if (std::ifstream(thread.path() / "schedstat") >> ran_ns >> waited_ns)
      longest_s = std::max(longest_s, 1e-9 * waited_ns);
  }
  return longest_s;
}

/// A popcutd, a person who keeps it busy, and what must be true of it whenever it died.
class Crash {
 public:
  Crash(std::uint32_t seed, double time_scale)
      : random_(seed),
        daemon_(popcutd_program(), time_scale),
        control_((daemon_.folder() / "control").string()),
        machine_(*find_machine("cameo3")) {}

  /// Starts it, calmly or with what the control says.
  bool start() {
    const auto begun = steady_clock::now();
    if (!daemon_.start(control_.environment())) return false;
    // On a machine that is busy otherwise, the time that popcutd itself took.
    const double took = seconds_since(begun);
    starts_.push_back(std::max(0.0, took - waited_for_a_core(daemon_.pid())));
    const auto address = client::parse_address("unix:" + daemon_.socket());
    REQUIRE(address);
    HttpClient http({*address}, "");
    http.set_tries(0);
    api_ = std::make_unique<Api>(std::move(http));
    return true;
  }

  /// Keeps it busy until it does not answer any more, or `seconds` are over.
  void keep_busy(double seconds) {
    const auto begun = steady_clock::now();
    while (seconds_since(begun) < seconds) {
      const auto jobs = api_->list("/v1/jobs", "jobs");
      if (!jobs) return;
      std::size_t open = 0;
      for (const json& job : *jobs) open += is_open(job) ? 1 : 0;
      if (open < 2 && !create()) return;
      for (const json& job : *jobs)
        if (is_open(job) && !step(job)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  /// Keeps it busy until a stroke has been cut, however long that takes.
  void cut_something() {
    const auto begun = steady_clock::now();
    const auto cut = [&] {
      for (const Received& one : received_log(daemon_.folder() / "trace/received.log"))
        if (!places_cut(one.bytes, machine_).empty()) return true;
      return false;
    };
    while (!cut() && seconds_since(begun) < 120) keep_busy(0.1);
  }

  /// Keeps it busy until a sheet is being cut.
  void until_it_cuts() {
    const auto begun = steady_clock::now();
    const auto cuts = [&] {
      const auto jobs = api_->list("/v1/jobs", "jobs");
      return jobs && std::any_of(jobs->begin(), jobs->end(), [](const json& job) {
               return client::text_of(job, "state") == "cutting";
             });
    };
    while (!cuts() && seconds_since(begun) < 120) keep_busy(0.02);
  }

  void kill() {
    daemon_.signal(SIGKILL);
    wait_for_end();
  }
  void wait_for_end() { CHECK(daemon_.wait() == 128 + SIGKILL); }
  /// Asks it to end; true: it came to its end before it died.
  bool ends_in_order() {
    daemon_.signal(SIGTERM);
    const int code = daemon_.wait();
    CHECK((code == 0 || code == 128 + SIGKILL));
    return code == 0;
  }

  /// What must hold after any death: asked of the new popcutd before anybody else asks for a thing.
  void check_truth() {
    control_.calm();
    auto jobs = api_->list("/v1/jobs", "jobs");
    if (!jobs) {  // the death that was asked of its start may come just after it serves
      wait_for_end();
      REQUIRE(start());
      jobs = api_->list("/v1/jobs", "jobs");
    }
    REQUIRE(jobs);
    std::map<std::string, json> by_id;
    for (const json& job : *jobs) by_id[client::text_of(job, "id")] = job;
    for (const std::string& id : accepted_) {
      CAPTURE(id);
      CHECK(by_id.contains(id));
    }
    std::map<std::string, std::vector<std::string>> cut;
    for (const Received& one : received_log(daemon_.folder() / "trace/received.log"))
      cut[one.attempt] = places_cut(one.bytes, machine_);
    std::size_t attempts = 0;
    for (const auto& [id, job] : by_id) {
      CAPTURE(id);
      const std::string state = client::text_of(job, "state");
      CAPTURE(state);
      // Nothing is armed, nothing cuts: R1 and R2.
      CHECK(state != "armed");
      CHECK(state != "cutting");
      CHECK(state != "paused");
      if (job["plan"].is_null() || job["sheets_total"] == 0) continue;
      const auto ledger = api_->get("/v1/jobs/" + id + "/sheets/1/ledger", id);
      if (!ledger) continue;
      attempts += check_ledger(id, state, *ledger, cut);
    }
    attempts_ = std::max(attempts_, attempts);
  }

  /// The database by itself, when no popcutd has it.
  void check_database() {
    if (DaemonProcess::fleet_section != nullptr) return;  // PostgreSQL looks after its own
    const std::string copy = (daemon_.folder() / "copy.db").string();
    for (const char* ending : {"", "-wal"}) {
      const std::string from = daemon_.state() + "/popcut.db" + ending;
      std::error_code ignored;
      std::filesystem::remove(copy + ending, ignored);
      if (std::filesystem::exists(from)) std::filesystem::copy_file(from, copy + ending);
    }
    sqlite3* database = nullptr;
    REQUIRE(sqlite3_open_v2(copy.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr) == SQLITE_OK);
    std::string said;
    const auto note = [](void* out, int, char** values, char**) {
      *static_cast<std::string*>(out) += values[0] ? values[0] : "";
      return 0;
    };
    CHECK(sqlite3_exec(database, "PRAGMA integrity_check", note, &said, nullptr) == SQLITE_OK);
    CHECK(said == "ok");
    said.clear();
    sqlite3_exec(database, "PRAGMA foreign_key_check", note, &said, nullptr);
    CHECK(said.empty());
    sqlite3_close(database);
  }

  [[nodiscard]] FaultControl& control() { return *control_.operator->(); }
  [[nodiscard]] std::mt19937& random() { return random_; }
  [[nodiscard]] const DaemonProcess& daemon() const { return daemon_; }

  void report(const char* what, int points) {
    std::sort(starts_.begin(), starts_.end());
    const auto quick = static_cast<std::size_t>(
        std::count_if(starts_.begin(), starts_.end(), [](double s) { return s < 1.0; }));
    std::printf(
        "%s: %d deaths, %zu jobs accepted, %zu attempts at sheets, %zu strokes cut, %d "
        "resumed from a stroke; serving again after %.3f s (median), %.3f s (longest)\n",
        what, points, accepted_.size(), attempts_, strokes_, resumed_, starts_[starts_.size() / 2],
        starts_.back());
    CHECK(strokes_ > 0);  // it did cut
    CHECK(attempts_ > accepted_.size() / 2);
    // One in ten may take longer: disks have moods.
    if (!testing::judges_time()) return;
    CHECK(10 * quick >= 9 * starts_.size());
    CHECK(starts_[starts_.size() / 2] < 0.5);
  }

 private:
  static bool is_open(const json& job) {
    const std::string state = client::text_of(job, "state");
    return state != "done" && state != "failed" && state != "cancelled";
  }

  bool create() {
    if (design_.empty()) {
      const auto design = api_->upload("/v1/designs?name=lines", design_svg(), "image/svg+xml", "");
      if (!design) return gone(design.error());
      design_ = client::text_of(*design, "id");
    }
    const auto job =
        api_->post("/v1/jobs", {{"design", design_}, {"options", {{"order", "keep"}}}}, "jobs");
    if (!job) return gone(job.error());
    accepted_.insert(client::text_of(*job, "id"));
    return true;
  }

  /// False: it does not answer. Other errors are answers: another step came between.
  static bool gone(const Error& error) {
    INFO(message(error));
    return error.kind != ErrorKind::DeviceGone && error.kind != ErrorKind::Timeout;
  }

  bool act(const json& job, const std::string& action, const json& body) {
    const auto done = api_->act(job, action, body);
    return done || gone(done.error());
  }

  /// What a person does with a job as it stands.
  bool step(const json& job) {
    const std::string state = client::text_of(job, "state");
    const json sheet{{"sheet", job["sheet"]}};
    // After a death the sheet of a job that was to go on is registered again, or taken anew.
    if (state == "ready" && !may(job, "arm")) return mend(job);
    if (state == "ready") return act(job, "arm", sheet);
    if (state == "armed") return act(job, "start", sheet);
    if (state == "paused") return act(job, "resume", json::object());
    if (state == "cutting" && random_() % 40 == 0) return act(job, "pause", json::object());
    if (state == "cutting" && random_() % 200 == 0) return act(job, "cancel", json::object());
    if (state == "interrupted") return mend(job);
    return true;
  }

  static bool may(const json& job, const char* action) {
    const json& actions = job["actions"];
    return std::find(actions.begin(), actions.end(), action) != actions.end();
  }

  bool mend(const json& job) {
    const std::string id = client::text_of(job, "id");
    const json sheet{{"sheet", job["sheet"]}};
    const auto ledger = api_->get("/v1/jobs/" + id + "/sheets/1/ledger", id);
    if (!ledger) return gone(ledger.error());
    const std::set<int> doubt = members_of((*ledger)["in_doubt"]);
    const int next = (*ledger)["certain_upto"].get<int>() + 1;
    switch (random_() % 4) {
      case 0:
        return act(job, "retry-sheet", sheet);
      case 1: {  // those in doubt are left out
        const int from = doubt.empty() ? next : *doubt.rbegin() + 1;
        if (from >= kLines) return act(job, "retry-sheet", sheet);
        ++resumed_;
        return act(
            job, "resume-from",
            {{"from_path", from}, {"registration", "re-registered"}, {"skip_in_doubt", true}});
      }
      case 2: {  // those in doubt may be cut twice
        if (next >= kLines) return act(job, "retry-sheet", sheet);
        for (int k = next; k < kLines; ++k)
          ++allowed_twice_[id + fmt::format("/{}/{}", (*ledger)["blank"].get<int>(), k)];
        ++resumed_;
        return act(job, "resume-from",
                   {{"from_path", next},
                    {"registration", "re-registered"},
                    {"i_accept_double_cut", true}});
      }
      default:
        return act(job, random_() % 2 ? "cancel" : "retry-sheet",
                   random_() % 2 ? json::object() : sheet);
    }
  }

  /// The ledger against what the cutter says it got.
  std::size_t check_ledger(const std::string& id, const std::string& state, const json& ledger,
                           const std::map<std::string, std::vector<std::string>>& cut) {
    const int blank = ledger["blank"];
    std::map<int, std::map<std::string, int>> times;  // by blank and place
    for (const json& attempt : ledger["attempts"]) {
      const auto found = cut.find(client::text_of(attempt, "id"));
      if (found == cut.end()) continue;
      strokes_ = std::max(strokes_, found->second.size());
      for (const std::string& place : found->second) ++times[attempt["blank"].get<int>()][place];
    }
    for (const auto& [number, places] : times)
      for (const auto& [place, count] : places) {
        CAPTURE(number, place);
        const int stroke = stroke_at(place);
        REQUIRE(stroke >= 0);
        const int allowed = 1 + allowed_twice_[id + fmt::format("/{}/{}", number, stroke)];
        CHECK(count <= allowed);  // P2
      }
    const std::set<int> certain = members_of(ledger["certain"]);
    const std::set<int> doubt = members_of(ledger["in_doubt"]);
    for (int k = 0; k < kLines; ++k) {
      CAPTURE(k);
      const bool was_cut = times[blank].contains(place_of(k));
      if (certain.contains(k)) CHECK(was_cut);
      if (was_cut && state != "done") CHECK((certain.contains(k) || doubt.contains(k)));
      if (state == "done" && client::text_of(ledger, "last_status").empty()) CHECK(was_cut);
    }
    return ledger["attempts"].size();
  }

  /// Places are learned from the first sheet that was cut whole; the order is that of the drawing.
  static std::string place_of(int k) {
    // The drawing keeps its place on the page.
    return fmt::format("{} {}", 1000 + k % 8 * 1200, 1000 + k / 8 * 1200);
  }
  static int stroke_at(const std::string& place) {
    for (int k = 0; k < kLines; ++k)
      if (place_of(k) == place) return k;
    return -1;
  }

  std::mt19937 random_;
  DaemonProcess daemon_;
  FaultPage control_;
  Machine machine_;
  std::unique_ptr<Api> api_;
  std::string design_;
  std::set<std::string> accepted_;
  std::map<std::string, int> allowed_twice_;
  std::vector<double> starts_;
  std::size_t attempts_{}, strokes_{};
  int resumed_{};
};

/// How many deaths: 30 in the suite (fewer with a sanitizer), as many as a soak asks for.
int deaths() {
  const char* const text = std::getenv("POPCUT_CRASH_POINTS");
  return text == nullptr ? testing::rounds(30, 3) : std::atoi(text);
}
/// A long run says how far it is.
void tell(const char* what, int point) {
  if (deaths() > 50 && point > 0 && point % 100 == 0)
    std::fprintf(stderr, "%s: %d of %d deaths\n", what, point, deaths());
}
std::uint32_t seed() {
  const char* const text = std::getenv("POPCUT_CRASH_SEED");
  return text == nullptr ? 1U : static_cast<std::uint32_t>(std::atoi(text));
}

}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("popcutd uses less than 20 MB of memory when idle", "[daemon][memory]") {
  DaemonProcess daemon(popcutd_program());
  REQUIRE(daemon.start());
  // A moment after it serves it gives back what only its start needed.
  double resident_mb = 1e9;
  const auto begun = steady_clock::now();
  while (resident_mb >= 20 && seconds_since(begun) < 30) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::string status = text_of_file("/proc/" + std::to_string(daemon.pid()) + "/status");
    const std::size_t at = status.find("VmRSS:");
    REQUIRE(at != std::string::npos);
    resident_mb = std::strtod(status.c_str() + at + 6, nullptr) / 1024;
  }
  CHECK(resident_mb < 20);
}
#endif

TEST_CASE("killed at any time popcutd loses no job and no stroke is cut twice", "[daemon][crash]") {
  Crash crash(seed(), 40);
  CAPTURE(seed());
  REQUIRE(crash.start());
  crash.cut_something();
  for (int point = 0; point < deaths(); ++point) {
    CAPTURE(point);
    tell("killed by time", point);
    const double after_s = std::uniform_real_distribution<double>(0.0, 1.2)(crash.random());
    std::thread killer([&] {
      std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
      crash.daemon().signal(SIGKILL);
    });
    crash.keep_busy(kLong);
    killer.join();
    crash.wait_for_end();
    if (point % 10 == 0) crash.check_database();
    const bool serves = crash.start();
    INFO(crash.daemon().log());
    REQUIRE(serves);
    crash.check_truth();
  }
  crash.kill();
  crash.check_database();
  crash.report("killed by time", deaths());
}

TEST_CASE("killed at any write popcutd loses no job and no stroke is cut twice",
          "[daemon][crash]") {
  Crash crash(seed() + 1000, 40);
  CAPTURE(seed());
  REQUIRE(crash.start());
  crash.cut_something();
  for (int point = 0; point < deaths(); ++point) {
    CAPTURE(point);
    tell("killed by calls", point);
    FaultControl& control = crash.control();
    auto& kill = point % 2 ? control.kill_at : control.kill_after;
    constexpr std::array<std::uint64_t, 3> kWithin{100, 700, 2500};
    // Every other pair of deaths falls into a cut.
    if (point / 2 % 2 == 1) crash.until_it_cuts();
    kill = control.calls + 1 + crash.random()() % kWithin[static_cast<std::size_t>(point % 3)];
    crash.keep_busy(kLong);
    crash.wait_for_end();
    if (point % 10 == 0) crash.check_database();
    // One in four dies at its start too, while it puts in order what the last one left.
    kill = point % 4 == 0 ? control.calls + 1 + crash.random()() % 60 : 0;
    control.kill_at = point % 2 ? kill.load() : 0;
    bool serves = crash.start();
    for (int again = 0; !serves && again < 3; ++again) {
      control.kill_at = 0;
      control.kill_after = 0;
      serves = crash.start();
    }
    INFO(crash.daemon().log());
    REQUIRE(serves);
    control.kill_at = 0;
    control.kill_after = 0;
    crash.check_truth();
  }
  crash.kill();
  crash.check_database();
  crash.report("killed by calls", deaths());
}

TEST_CASE("killed at any system call of its start popcutd starts the next time",
          "[daemon][crash]") {
  Crash crash(seed() + 2000, 40);
  CAPTURE(seed());
  REQUIRE(crash.start());
  crash.cut_something();
  FaultControl& control = crash.control();
  bool died = true;
  std::uint64_t calls = 0;
  // Every fifth in the suite, before it or after it; all of them in a soak.
  const auto step = static_cast<std::uint64_t>(
      std::getenv("POPCUT_CRASH_POINTS") == nullptr ? testing::step_of(5, 3) : 1);
  for (std::uint64_t n = 1 + seed() % step; died && n < 2000; n += step) {
    CAPTURE(n);
    crash.keep_busy(0.3);
    crash.kill();
    auto& kill = (n / step) % 2 ? control.kill_at : control.kill_after;
    kill = control.calls + n;
    died = !crash.start();
    kill = 0;
    const bool serves = !died || crash.start();
    INFO(crash.daemon().log());
    REQUIRE(serves);
    crash.check_truth();
    calls = n;
  }
  CHECK_FALSE(died);
  crash.kill();
  crash.check_database();
  crash.report("killed at its start", static_cast<int>(calls / step));
}

TEST_CASE("killed at any system call of its end popcutd starts the next time", "[daemon][crash]") {
  Crash crash(seed() + 3000, 40);
  CAPTURE(seed());
  REQUIRE(crash.start());
  crash.cut_something();
  FaultControl& control = crash.control();
  // Some in the suite, with the kills of service_kill_test at each; all of them in a soak.
  const auto step = static_cast<std::uint64_t>(
      std::getenv("POPCUT_CRASH_POINTS") == nullptr ? testing::step_of(16, 2) : 1);
  std::uint64_t deaths = 0;
  for (const bool cutting : {false, true}) {
    bool ended = false;
    for (std::uint64_t n = 1 + seed() % step; !ended && n < 2000; n += step) {
      CAPTURE(n, cutting);
      if (cutting)
        crash.until_it_cuts();
      else
        crash.keep_busy(0.1);
      control.kill_at = control.calls + n;
      ended = crash.ends_in_order();
      control.kill_at = 0;
      deaths += ended ? 0 : 1;
      const bool serves = crash.start();
      INFO(crash.daemon().log());
      REQUIRE(serves);
      crash.check_truth();
    }
    CHECK(ended);
  }
  crash.kill();
  crash.check_database();
  crash.report("killed at its end", static_cast<int>(deaths));
}

}  // namespace crash_test
