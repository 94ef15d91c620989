// SPDX-License-Identifier: MIT
// What goes wrong with popcutd's own disk, clock, threads and version.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <future>
#include <map>
#include <random>
#include <thread>

#include <sqlite3.h>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/fault_page.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/received_log.hpp"
#include "tests/support/running_daemon.hpp"
#include "tests/support/service_manager_socket.hpp"

namespace faults_daemon_test {

using namespace popcut;
using namespace popcut::testing;
using Json = nlohmann::json;
using std::chrono::steady_clock;

namespace {

constexpr std::int64_t kYear = 365LL * 86'400;

/// A popcutd in the hands of the shim.
struct FaultyShop {
  RunningDaemon popcutd;
  FaultPage page;

  explicit FaultyShop(double time_scale = 0, const std::string& more = "")
      : popcutd(time_scale, more), page((popcutd.daemon().folder() / "control").string()) {
    page.calm();
  }
  void open(const std::vector<std::string>& more = {}) {
    std::vector<std::string> environment = page.environment();
    environment.insert(environment.end(), more.begin(), more.end());
    popcutd.open(environment);
  }
  [[nodiscard]] std::filesystem::path trace() { return popcutd.daemon().folder() / "trace"; }
  [[nodiscard]] std::set<int> cut(int lines) { return lines_cut(trace(), lines); }
};

/// Sends one request and does not wait for what comes.
class QuickClient {
 public:
  QuickClient(const std::string& path, const std::string& request)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    path.copy(at.sun_path, sizeof at.sun_path - 1);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0)
      (void)!::send(socket_, request.data(), request.size(), MSG_NOSIGNAL);
  }
  QuickClient(QuickClient&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  QuickClient(const QuickClient&) = delete;
  QuickClient& operator=(const QuickClient&) = delete;
  ~QuickClient() {
    if (socket_ >= 0) ::close(socket_);
  }
  /// All that comes until the other end closes.
  [[nodiscard]] std::string answer() const {
    std::string text;
    std::array<char, 4096> room{};
    for (;;) {
      const ssize_t got = ::recv(socket_, room.data(), room.size(), 0);
      if (got <= 0) return text;
      text.append(room.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  int socket_;
};

}  // namespace

TEST_CASE("a disk that fails once stops the knife after its stroke and nothing is written then",
          "[popcutd][faults][alone]") {
  constexpr int kLines = 160;
  FaultyShop faulty(8);
  RunningDaemon& popcutd = faulty.popcutd;
  faulty.open();
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(kLines)));
  popcutd.cut(id);
  REQUIRE(happens([&] { return faulty.cut(kLines).size() > 10; }));
  faulty.page->bad_sync = faulty.page->syncs + 1;
  // It says what is wrong, stops the knife, and takes nothing new.
  REQUIRE(happens([&] { return popcutd.ask("GET", "/readyz").status == 503; }));
  const Json ready = Json::parse(popcutd.ask("GET", "/readyz").body);
  CHECK(ready["db"] == "failed");
  REQUIRE(happens([&] { return popcutd.device_state("sim:cameo3") == "idle"; }));
  const std::set<int> cut = faulty.cut(kLines);
  CHECK(cut.size() < kLines);
  const std::uint64_t syncs = faulty.page->syncs;
  const client::HttpResponse refused = popcutd.ask("POST", "/v1/jobs", R"({"design":"sha256-0"})");
  CHECK(refused.status == 503);
  CHECK(refused.body.find("restart") != std::string::npos);
  CHECK(popcutd.get("/v1/jobs")["items"].size() == 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // longer than a tick
  CHECK(faulty.page->syncs == syncs);
  CHECK(faulty.cut(kLines) == cut);
  popcutd.daemon().signal(SIGTERM);
  CHECK(popcutd.daemon().wait() == 0);
  CHECK(faulty.page->syncs == syncs);
  faulty.page.calm();
  faulty.open();
  CHECK(popcutd.get("/readyz")["ready"] == true);
  CHECK(popcutd.job(id)["state"] == "interrupted");
  CHECK(wrong_in(popcutd.ledger(id), kLines, cut) == "");
}

TEST_CASE("a journal of intents that cannot be written stops the knife",
          "[popcutd][faults][alone]") {
  constexpr int kLines = 160;
  FaultyShop faulty(8);
  RunningDaemon& popcutd = faulty.popcutd;
  faulty.open();
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(kLines)));
  popcutd.cut(id);
  REQUIRE(happens([&] { return faulty.cut(kLines).size() > 10; }));
  faulty.page->bad_journal = 1;
  REQUIRE(happens([&] { return popcutd.ask("GET", "/readyz").status == 503; }));
  REQUIRE(happens([&] { return popcutd.device_state("sim:cameo3") == "idle"; }));
  const std::set<int> cut = faulty.cut(kLines);
  CHECK(cut.size() < kLines);
  popcutd.daemon().signal(SIGTERM);
  CHECK(popcutd.daemon().wait() == 0);
  faulty.page.calm();
  faulty.open();
  CHECK(popcutd.job(id)["state"] == "interrupted");
  CHECK(wrong_in(popcutd.ledger(id), kLines, cut) == "");
}

TEST_CASE("popcutd that lost the end of its log after a kill cuts no stroke twice",
          "[popcutd][faults][alone]") {
  namespace fs = std::filesystem;
  constexpr int kLines = 80;
  constexpr std::uintmax_t kFrame = 24 + 4096;
  RunningDaemon popcutd(20);
  popcutd.open();
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(kLines)));
  popcutd.cut(id);
  const fs::path trace = popcutd.daemon().folder() / "trace";
  REQUIRE(happens([&] { return lines_cut(trace, kLines).size() > 20; }));
  popcutd.daemon().signal(SIGKILL);
  CHECK(popcutd.daemon().wait() == 128 + SIGKILL);
  const fs::path state = popcutd.daemon().state();
  const fs::path aside = popcutd.daemon().folder() / "aside";
  fs::create_directory(aside);
  fs::copy(state, aside / "state", fs::copy_options::recursive);
  fs::copy(trace, aside / "trace", fs::copy_options::recursive);
  const std::set<int> first = lines_cut(trace, kLines);
  const std::uintmax_t frames = (fs::file_size(state / "popcut.db-wal") - 32) / kFrame;
  for (const std::uintmax_t lost : {std::uintmax_t{2}, std::uintmax_t{12}}) {
    const bool zero = lost == 12;
    CAPTURE(lost, frames, zero);
    for (const char* name : {"state", "trace"}) {
      fs::remove_all(popcutd.daemon().folder() / name);
      fs::copy(aside / name, popcutd.daemon().folder() / name, fs::copy_options::recursive);
    }
    const std::uintmax_t whole = fs::file_size(state / "popcut.db-wal");
    fs::resize_file(state / "popcut.db-wal", whole - lost * kFrame);
    if (zero) fs::resize_file(state / "popcut.db-wal", whole);
    popcutd.open();
    CHECK(popcutd.job(id)["state"] == "interrupted");
    const Json ledger = popcutd.ledger(id);
    CHECK(wrong_in(ledger, kLines, first) == "");
    REQUIRE_FALSE(ledger["not_sent"].empty());
    popcutd.act(id, "resume-from",
                {{"from_path", *members_of(ledger["not_sent"]).begin()},
                 {"registration", "re-registered"},
                 {"skip_in_doubt", true}});
    popcutd.cut(id);
    popcutd.await(id, [](const Json& job) { return job["state"] != "cutting"; });
    for (const int line : lines_cut(trace, kLines)) CHECK_FALSE(first.contains(line));
    popcutd.daemon().signal(SIGKILL);
    CHECK(popcutd.daemon().wait() == 128 + SIGKILL);
  }
}

TEST_CASE("a clock that jumps by years affects no armed job and no cut and no order",
          "[popcutd][faults]") {
  constexpr int kLines = 12;
  FaultyShop faulty(40);
  RunningDaemon& popcutd = faulty.popcutd;
  faulty.open();
  const std::string design = popcutd.design(RunningDaemon::lines_svg(kLines));
  std::vector<std::string> jobs;
  for (const std::int64_t jump : {kYear, -30 * kYear, std::int64_t{1}}) {
    CAPTURE(jump);
    const std::string id = popcutd.ready_job(design);
    jobs.push_back(id);
    popcutd.act(id, "arm", {{"sheet", 1}});
    faulty.page->clock_s += jump;
    // What was armed is armed still, and can be started.
    CHECK(popcutd.job(id)["state"] == "armed");
    popcutd.act(id, "start", {{"sheet", 1}});
    REQUIRE(happens([&] { return !faulty.cut(kLines).empty(); }));
    faulty.page->clock_s -= 2 * jump;
    popcutd.await_state(id, "done");
    CHECK(faulty.cut(kLines).size() == kLines);
    CHECK(popcutd.get("/readyz")["ready"] == true);
    CHECK(popcutd.ledger(id)["attempts"].size() == 1);
  }
  CHECK(std::is_sorted(jobs.begin(), jobs.end()));
  // Who lists goes by the order in which they came.
  const Json listed = popcutd.get("/v1/jobs");
  std::vector<std::string> ids;
  for (const Json& job : listed["items"]) ids.push_back(job["id"]);
  CHECK(ids == jobs);
  std::int64_t before = 0;
  const Json events = popcutd.get("/v1/events?after=0&limit=200");
  for (const Json& event : events["items"]) {
    const std::int64_t seq = event["seq"];
    if (before != 0) CHECK(seq == before + 1);
    before = seq;
  }
}

TEST_CASE("one key makes one job even if popcutd is killed between the commit and the answer",
          "[popcutd][faults][alone]") {
  FaultyShop faulty(0, "connections = 400\n");
  RunningDaemon& popcutd = faulty.popcutd;
  faulty.open();
  const std::string design = popcutd.design(RunningDaemon::lines_svg(4));
  std::mt19937 random(7);
  std::size_t made = 0;
  std::uint64_t calls = 0;  // of a hundred equal requests
  int died_after_commit = 0, died_before = 0;
  for (int round = 0; round < 12; ++round) {
    CAPTURE(round);
    const std::string body = Json{{"design", design}, {"name", std::to_string(round)}}.dump();
    const std::string request = fmt::format(
        "POST /v1/jobs HTTP/1.1\r\nHost: popcut\r\nContent-Type: application/json\r\n"
        "Idempotency-Key: key-of-round-{:04}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{}",
        round, body.size(), body);
    const std::string socket = popcutd.daemon().socket();
    const std::uint64_t before = faulty.page->calls;
    if (round > 0) {
      // Some surely before the commit and some surely after it; the others anywhere.
      if (round % 4 == 1)
        faulty.page->kill_at = before + 1;
      else if (round % 4 == 2)
        faulty.page->last_sync = faulty.page->syncs + 1;
      else
        faulty.page->kill_after = before + 1 + random() % calls;
      std::vector<QuickClient> clients;
      for (int k = 0; k < 100; ++k) clients.emplace_back(socket, request);
      // Should it have made fewer calls this time, others have it write.
      std::atomic<bool> dead{false};
      std::thread others([&] {
        while (!dead) {
          const QuickClient one(
              socket,
              "POST /v1/tokens HTTP/1.1\r\nHost: popcut\r\nContent-Type: application/json\r\n"
              "Connection: close\r\nContent-Length: "
              "32\r\n\r\n{\"name\":\"other\",\"role\":\"viewer\"}");
          (void)one.answer();
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      });
      const int ended = popcutd.daemon().wait();
      dead = true;
      others.join();
      REQUIRE(ended == 128 + SIGKILL);
      faulty.page.calm();
      faulty.open();
    }
    const std::size_t there = popcutd.get("/v1/jobs?limit=200")["items"].size();
    CHECK((there == made || there == made + 1));
    if (round > 0) ++(there == made ? died_before : died_after_commit);
    std::vector<QuickClient> clients;
    for (int k = 0; k < 100; ++k) clients.emplace_back(socket, request);
    std::set<std::string> places;
    for (const QuickClient& client : clients) {
      const std::string answer = client.answer();
      CHECK(answer.rfind("HTTP/1.1 201", 0) == 0);
      const std::size_t at = answer.find("Location: ");
      places.insert(at == std::string::npos ? answer
                                            : answer.substr(at, answer.find("\r\n", at) - at));
    }
    CHECK(places.size() == 1);
    if (round == 0) calls = faulty.page->calls - before;
    const Json jobs = popcutd.get("/v1/jobs?limit=200");
    CHECK(jobs["items"].size() == ++made);
    // Nothing else is written while the next ones come.
    for (const Json& job : jobs["items"]) popcutd.await_state(job["id"], "ready");
  }
  CHECK(died_after_commit > 0);
  CHECK(died_before > 0);
}

TEST_CASE("exactly one of 64 clients that start or stop a knife at once succeeds",
          "[popcutd][faults]") {
  RunningDaemon popcutd(5, "connections = 400\n");
  popcutd.open();
  const std::string design = popcutd.design(RunningDaemon::lines_svg(60));
  int number = 0;
  const auto press = [&](const std::string& id, const std::vector<std::string>& actions) {
    const std::int64_t rev = popcutd.job(id)["rev"];
    std::vector<QuickClient> clients;
    for (int k = 0; k < 64; ++k)
      clients.emplace_back(
          popcutd.daemon().socket(),
          fmt::format("POST /v1/jobs/{}/actions/{} HTTP/1.1\r\nHost: popcut\r\nIf-Match: \"{}\"\r\n"
                      "Content-Type: application/json\r\nIdempotency-Key: key-of-client-{:06}\r\n"
                      "Connection: close\r\nContent-Length: 2\r\n\r\n{{}}",
                      id, actions[static_cast<std::size_t>(k) % actions.size()], rev, ++number));
    std::map<std::string, int> answers;
    for (const QuickClient& client : clients) ++answers[client.answer().substr(9, 3)];
    return answers;
  };
  for (int round = 0; round < 3; ++round) {
    CAPTURE(round);
    const std::string id = popcutd.ready_job(design);
    popcutd.act(id, "arm", {{"sheet", 1}});
    auto started = press(id, {"start"});
    CHECK(started["200"] == 1);
    CHECK(started["409"] + started["412"] == 63);
    auto stopped = press(id, {"pause", "cancel"});
    CHECK(stopped["200"] == 1);
    CHECK(stopped["409"] + stopped["412"] == 63);
    popcutd.await(id, [](const Json& job) {
      return job["state"] == "paused" || job["state"] == "cancelled";
    });
    CHECK(popcutd.ledger(id)["attempts"].size() == 1);
    if (popcutd.job(id)["state"] == "paused") popcutd.act(id, "cancel");
    popcutd.await_state(id, "cancelled");
  }
}

TEST_CASE("the watchdog is not fed while any thread of popcutd hangs", "[popcutd][faults][alone]") {
  const auto starve = [](Blocked where) -> std::string {
    ServiceManagerSocket manager;
    FaultyShop faulty(3);
    RunningDaemon& popcutd = faulty.popcutd;
    faulty.open(manager.environment(4));
    const std::string design = popcutd.design(RunningDaemon::lines_svg(40));
    const std::string id = popcutd.ready_job(design);
    popcutd.cut(id);
    if (!happens([&] { return manager.feedings() > 0; })) return "it was never fed";
    // On a busy machine a thread may seem to hang before; only what is written from now on counts.
    std::size_t since = popcutd.daemon().log().size();
    faulty.page->blocked = where;
    const auto hangs = [&] {
      const std::string log = popcutd.daemon().log();
      const std::size_t at = log.rfind("a thread is not responding");
      return at != std::string::npos && at >= since &&
             log.find("all threads are responding again", at) == std::string::npos;
    };
    do {
      if (!happens(hangs)) return "nobody noticed";
      manager.feedings();
      std::this_thread::sleep_for(std::chrono::milliseconds(1800));  // it is fed every 1.3 s
    } while (!hangs());
    if (manager.feedings() > 0) return "it was fed all the same";
    if (where == kTraces) {
      // What the service manager does then.
      popcutd.daemon().signal(SIGABRT);
      if (popcutd.daemon().wait() != 128 + SIGABRT) return "it did not end";
      faulty.page.calm();
      faulty.open(manager.environment(4));
      if (popcutd.job(id)["state"] != "interrupted") return "the cut is not interrupted";
      const std::string wrong = wrong_in(popcutd.ledger(id), 40, faulty.cut(40));
      return wrong;
    }
    since = popcutd.daemon().log().size();
    faulty.page->blocked = kNobody;
    const auto responds = [&] {
      return popcutd.daemon().log().find("all threads are responding again", since) !=
             std::string::npos;
    };
    if (!happens(responds)) return "it never came back";
    if (!happens([&] { return manager.feedings() > 0; })) return "it is not fed again";
    // And the cut goes on; how long it would take is no matter here.
    const auto sent = [](const Json& job) { return job["progress"]["paths_sent"].get<int>(); };
    const int before = sent(popcutd.job(id));
    popcutd.await(id,
                  [&](const Json& job) { return job["state"] == "done" || sent(job) > before; });
    if (popcutd.job(id)["state"] == "done") return {};
    popcutd.act(id, "cancel");
    popcutd.await_state(id, "cancelled");
    return {};
  };
  std::vector<std::future<std::string>> all;
  for (const Blocked where : {kSyncs, kPolls, kTraces})
    all.push_back(std::async(std::launch::async, starve, where));
  for (std::size_t k = 0; k < all.size(); ++k) {
    CAPTURE(k);
    CHECK(all[k].get() == "");
  }
}

TEST_CASE("damage that is found after the start ends popcutd before anything is armed",
          "[popcutd][faults][alone]") {
  RunningDaemon popcutd;
  popcutd.open();
  (void)popcutd.design(RunningDaemon::lines_svg(2));
  popcutd.daemon().signal(SIGKILL);
  (void)popcutd.daemon().wait();
  // All into the file, then a page of a table that is not read at a start.
  const std::string path = popcutd.daemon().state() + "/popcut.db";
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  int page = 0;
  const auto take = [](void* out, int, char** values, char**) {
    *static_cast<int*>(out) = std::atoi(values[0]);
    return 0;
  };
  REQUIRE(sqlite3_exec(database, "SELECT rootpage FROM sqlite_schema WHERE name='usage'", take,
                       &page, nullptr) == SQLITE_OK);
  sqlite3_db_config(database, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  REQUIRE(sqlite3_wal_checkpoint_v2(database, nullptr, SQLITE_CHECKPOINT_PASSIVE, nullptr,
                                    nullptr) == SQLITE_OK);
  sqlite3_close(database);
  // The log would hide the page; a later change keeps it from being empty.
  const std::string log = text_of_file(path + "-wal");
  REQUIRE(page > 1);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp((page - 1) * 4096);
    file.write("\xAA\xAA\xAA\xAA\xAA\xAA\xAA\xAA", 8);
  }
  write_file(popcutd.daemon().state() + "/database-state", "in use\n");
  const bool served = popcutd.daemon().start();
  const int code = served ? popcutd.daemon().wait() : 78;
  CAPTURE(popcutd.daemon().log(), log.size());
  CHECK(code == 78);
  CHECK(popcutd.daemon().log().find("is damaged") != std::string::npos);
  CHECK(popcutd.daemon().log().find("popcut db salvage") != std::string::npos);
  // The next one does not even begin to serve.
  const Ran ran = run_program({popcutd_program(), "--config", popcutd.daemon().config()}, "/");
  CHECK(ran.exit == 78);
}

TEST_CASE("popcutd does not touch a database with tables of another version",
          "[popcutd][faults][alone]") {
  RunningDaemon popcutd;
  popcutd.open();
  (void)popcutd.design(RunningDaemon::lines_svg(2));
  popcutd.daemon().signal(SIGTERM);
  REQUIRE(popcutd.daemon().wait() == 0);
  const std::string path = popcutd.daemon().state() + "/popcut.db";
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  CHECK(sqlite3_exec(database, "PRAGMA user_version=9999", nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(database);
  for (const char* beside : {"/database-state", "/witness"})
    std::filesystem::remove(popcutd.daemon().state() + beside);
  const std::string before = text_of_file(path);
  CHECK_FALSE(popcutd.daemon().start());
  const Ran ran = run_program({popcutd_program(), "--config", popcutd.daemon().config()}, "/");
  CAPTURE(ran.err);
  CHECK(ran.exit == 78);
  CHECK(ran.err.find("another version of popcutd (schema 9999") != std::string::npos);
  CHECK(text_of_file(path) == before);
}

TEST_CASE("a symbolic link among the state folders is refused and its target is not touched",
          "[popcutd][faults]") {
  RunningDaemon popcutd;
  TempFolder elsewhere;
  write_file(elsewhere / "precious", "mine");
  const std::filesystem::path state = popcutd.daemon().state();
  std::filesystem::create_directory(state);
  for (const char* inside : {"incoming", "plans"}) {
    CAPTURE(inside);
    std::filesystem::remove(state / inside);
    std::filesystem::create_directory_symlink(elsewhere.path(), state / inside);
    const Ran ran = run_program({popcutd_program(), "--config", popcutd.daemon().config()}, "/");
    CHECK(ran.exit == 7);
    CHECK(ran.err.find(inside) != std::string::npos);
    CHECK(ran.err.find("is a link") != std::string::npos);
    std::filesystem::remove(state / inside);
  }
  // Files under the names that it writes are not followed either.
  std::filesystem::create_symlink(elsewhere / "precious", state / "lock");
  CHECK_FALSE(popcutd.daemon().start());
  std::filesystem::remove(state / "lock");
  CHECK(text_of_file(elsewhere / "precious") == "mine");
  CHECK(files_below(elsewhere.path()).size() == 1);
  popcutd.open();
  CHECK(popcutd.get("/readyz")["ready"] == true);
}

}  // namespace faults_daemon_test
