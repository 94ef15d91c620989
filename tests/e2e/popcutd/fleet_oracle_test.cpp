// SPDX-License-Identifier: MIT
// Nodes that are killed, a database that is killed, a network that loses, delays and repeats, and
// people at all nodes who want the same at once. At the end the cutters' own logs are held against
// the ledger. './run soak fleet' runs it for long.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/fleet_nodes.hpp"
#include "tests/support/received_log.hpp"

namespace fleet_oracle_test {

using namespace popcut;
using namespace popcut::testing;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
using client::text_of;

namespace {

constexpr int kLines = 24;
constexpr double kTimeScale = 8;  // a sheet takes a second or two

double since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}
void nap(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

int number_from(const char* name, int usual) {
  const char* const text = std::getenv(name);
  return text == nullptr ? usual : std::atoi(text);
}

/// One blank of one sheet of one job, and a stroke of it.
using Stroke = std::tuple<std::string, int, int>;

/// People at all nodes. What they accept is noted before they ask for it.
class People {
 public:
  People(FleetNodes& fleet, std::uint32_t seed, std::string design)
      : fleet_(fleet), design_(std::move(design)) {
    for (int k = 1; k <= fleet_.size(); ++k)
      threads_.emplace_back([this, k, seed] { work(k, seed + static_cast<std::uint32_t>(k)); });
  }
  ~People() { stop(); }
  People(const People&) = delete;
  People& operator=(const People&) = delete;
  void stop() {
    over_ = true;
    for (std::thread& one : threads_)
      if (one.joinable()) one.join();
  }

  [[nodiscard]] std::set<std::string> accepted() const {
    const std::lock_guard hold(lock_);
    return accepted_;
  }
  [[nodiscard]] int allowed(const Stroke& stroke) const {
    const std::lock_guard hold(lock_);
    const auto found = allowed_.find(stroke);
    return found == allowed_.end() ? 0 : found->second;
  }
  std::atomic<int> asked{0}, done{0}, starts{0}, resumes{0}, unanswered{0};

 private:
  struct User {
    int node;
    std::mt19937 random;
    client::Api api;
    std::size_t pick(std::size_t count) { return random() % std::max<std::size_t>(1, count); }
  };

  void work(int node, std::uint32_t seed) {
    const auto address = client::parse_address("unix:" + fleet_[node].daemon().socket());
    client::HttpClient http({*address}, "");
    http.set_tries(0);
    User me{node, std::mt19937(seed), client::Api(std::move(http))};
    while (!over_) {
      nap(0.02 + 0.0005 * static_cast<double>(me.pick(200)));
      const auto jobs = me.api.list("/v1/jobs?order=desc", "jobs", 200);
      if (!jobs) {
        ++unanswered;
        nap(0.2);
        continue;
      }
      std::vector<Json> open;
      for (const Json& job : *jobs) {
        const std::string state = text_of(job, "state");
        if (state != "done" && state != "cancelled" && state != "failed") open.push_back(job);
      }
      if (open.size() < 2 * static_cast<std::size_t>(fleet_.size()) && me.pick(3) == 0) create(me);
      if (!open.empty()) step(me, open[me.pick(open.size())]);
    }
  }

  void create(User& me) {
    Json request{{"design", design_}, {"options", {{"order", "keep"}}}};
    const auto job = me.api.post("/v1/jobs", request, "jobs");
    if (!job) return;
    const std::lock_guard hold(lock_);
    accepted_.insert(text_of(*job, "id"));
  }

  bool act(User& me, const Json& job, const std::string& action, const Json& body) {
    ++asked;
    const auto done_it = me.api.act(job, action, body);
    if (!done_it) return false;
    ++done;
    if (action == "start") ++starts;
    return true;
  }

  void step(User& me, const Json& job) {
    const std::string state = text_of(job, "state");
    const Json sheet{{"sheet", job["sheet"]}};
    const std::string own = FleetNodes::device(me.node);
    if (state == "ready") {
      Json arm = sheet;
      arm["device"] = own;
      if (me.pick(40) == 0) arm.erase("device");
      if (act(me, job, "arm", arm)) (void)act_again(me, job, "start", sheet);
    } else if (state == "armed") {
      (void)act(me, job, me.pick(10) == 0 ? "disarm" : "start",
                me.pick(10) == 0 ? Json::object() : sheet);
    } else if (state == "paused") {
      (void)act(me, job, me.pick(8) == 0 ? "cancel" : "resume", Json::object());
    } else if (state == "cutting") {
      if (me.pick(12) == 0) (void)act(me, job, "pause", Json::object());
      if (me.pick(60) == 0) (void)act(me, job, "cancel", Json::object());
    } else if (state == "interrupted") {
      mend(me, job);
    }
  }

  // Twice at once, as impatient people do.
  bool act_again(User& me, const Json& job, const std::string& action, const Json& body) {
    const auto now = me.api.get("/v1/jobs/" + text_of(job, "id"), "");
    if (!now) return false;
    const bool first = act(me, *now, action, body);
    if (me.pick(4) == 0) (void)act(me, *now, action, body);
    return first;
  }

  void mend(User& me, const Json& job) {
    const std::string id = text_of(job, "id");
    const Json sheet{{"sheet", job["sheet"]}};
    const auto ledger = me.api.get("/v1/jobs/" + id + "/sheets/1/ledger", id);
    if (!ledger) return;
    const std::set<int> doubt = members_of((*ledger)["in_doubt"]);
    const int next = (*ledger)["certain_upto"].get<int>() + 1;
    const int blank = (*ledger)["blank"];
    switch (me.pick(6)) {
      case 0: {  // those in doubt are left out
        const int from = doubt.empty() ? next : *doubt.rbegin() + 1;
        if (from >= kLines) return;
        ++resumes;
        (void)act(
            me, job, "resume-from",
            {{"from_path", from}, {"registration", "re-registered"}, {"skip_in_doubt", true}});
        return;
      }
      case 1: {  // those in doubt may be cut twice
        if (next >= kLines) return;
        {
          const std::lock_guard hold(lock_);
          for (int k = next; k < kLines; ++k) ++allowed_[{id, blank, k}];
        }
        ++resumes;
        (void)act(me, job, "resume-from",
                  {{"from_path", next},
                   {"registration", "re-registered"},
                   {"i_accept_double_cut", true}});
        return;
      }
      case 2:
        (void)act(me, job, "cancel", Json::object());
        return;
      case 3:
        nap(0.3);  // and perhaps the truth comes
        return;
      default:
        (void)act(me, job, "retry-sheet", sheet);
    }
  }

  FleetNodes& fleet_;
  std::string design_;
  mutable std::mutex lock_;
  std::set<std::string> accepted_;
  std::map<Stroke, int> allowed_;
  std::atomic<bool> over_{false};
  std::vector<std::thread> threads_;
};

/// What happens to nodes, network and database.
class Fate {
 public:
  Fate(FleetNodes& fleet, std::uint32_t seed) : fleet_(fleet), random_(seed) {}

  void strike() {
    const int node = 1 + static_cast<int>(random_() % static_cast<unsigned>(fleet_.size()));
    FaultProxy& proxy = fleet_.proxy(node);
    using Way = FaultProxy::Way;
    ++struck;
    switch (random_() % 12) {
      case 0:
      case 1: {
        ++kills;
        fleet_.kill(node);
        nap(0.01 * static_cast<double>(random_() % 400));
        fleet_[node].open();
        break;
      }
      case 2:
        ++database_kills;
        fleet_.server().kill();
        nap(0.01 * static_cast<double>(random_() % 200));
        fleet_.server().start();
        break;
      case 3:
        proxy.cut_all();
        break;
      case 4:  // longer than a lease, or not
        proxy.hold();
        later_.push_back({Clock::now() + std::chrono::milliseconds(random_() % 6000),
                          [&proxy] { proxy.pass(); }});
        break;
      case 5:  // only the answers are lost
        proxy.hold(random_() % 2 ? Way::ToClient : Way::ToServer);
        later_.push_back({Clock::now() + std::chrono::milliseconds(random_() % 5000), [&proxy] {
                            proxy.pass();
                            proxy.cut_all();
                          }});
        break;
      case 6:
        proxy.refuse(true);
        proxy.cut_all();
        later_.push_back({Clock::now() + std::chrono::milliseconds(random_() % 6000),
                          [&proxy] { proxy.refuse(false); }});
        break;
      case 7:
        proxy.cut_at("COMMIT",
                     random_() % 2 ? FaultProxy::Lost::Request : FaultProxy::Lost::Answer);
        break;
      case 8:
        proxy.cut_at("knife_",
                     random_() % 2 ? FaultProxy::Lost::Request : FaultProxy::Lost::Answer);
        break;
      case 9:
        proxy.delay(Way::ToServer, std::chrono::milliseconds(random_() % 300));
        later_.push_back({Clock::now() + std::chrono::milliseconds(random_() % 3000), [&proxy] {
                            proxy.delay(FaultProxy::Way::ToServer, std::chrono::milliseconds(0));
                          }});
        break;
      case 10:
        repeat(proxy);
        break;
      case 11:  // an orderly stop and start
        ++stops;
        fleet_[node].daemon().signal(SIGTERM);
        (void)fleet_[node].daemon().wait();
        fleet_[node].open();
        break;
    }
  }
  void pass_time(double seconds) {
    const auto begun = Clock::now();
    do {
      nap(0.01);
      for (std::size_t k = 0; k < later_.size();)
        if (later_[k].first <= Clock::now()) {
          later_[k].second();
          later_.erase(later_.begin() + static_cast<std::ptrdiff_t>(k));
        } else {
          ++k;
        }
    } while (since(begun) < seconds);
  }
  void heal() {
    for (auto& [when, cure] : later_) cure();
    later_.clear();
    for (int k = 1; k <= fleet_.size(); ++k) {
      fleet_.proxy(k).pass();
      fleet_.proxy(k).refuse(false);
      fleet_.proxy(k).delay(FaultProxy::Way::ToServer, std::chrono::milliseconds(0));
    }
  }
  std::atomic<int> struck{0}, kills{0}, database_kills{0}, stops{0}, repeats{0};

 private:
  // What a client said some time ago arrives once more.
  void repeat(FaultProxy& proxy) {
    proxy.record(true);
    proxy.cut_all();  // new connections are recorded
    pass_time(1.0);
    proxy.record(false);
    if (proxy.recordings() == 0) return;
    const std::string said = proxy.recorded(random_() % proxy.recordings());
    if (said.empty()) return;
    ++repeats;
    try {
      (void)proxy.replay(said, std::chrono::seconds(2));
    } catch (const std::exception&) {  // the server waits for more
    }
  }

  FleetNodes& fleet_;
  std::mt19937 random_;
  std::vector<std::pair<Clock::time_point, std::function<void()>>> later_;
};

/// What the cutters' logs and the ledger say.
struct Account {
  std::size_t jobs{}, attempts{}, strokes{}, accepted_twice{};
  std::map<std::string, int> states;
};

Account check_all(FleetNodes& fleet, const People& people) {
  Account account;
  struct Attempt {
    std::string job;
    int sheet{}, blank{};
    bool started{}, ended{};
    std::set<int> certain{}, doubt{};
  };
  std::map<std::string, Attempt> attempts;
  std::istringstream rows(fleet.run_sql(
      "SELECT id, job, k, blank, started_at IS NOT NULL, ended IS NOT NULL FROM popcut.attempt"));
  for (std::string line; std::getline(rows, line);) {
    std::vector<std::string> words;
    std::istringstream parts(line);
    for (std::string word; std::getline(parts, word, '|');) words.push_back(word);
    REQUIRE(words.size() == 6);
    attempts[words[0]] = {.job = words[1],
                          .sheet = std::atoi(words[2].c_str()),
                          .blank = std::atoi(words[3].c_str()),
                          .started = words[4] == "t",
                          .ended = words[5] == "t"};
  }
  std::istringstream chunks(
      fleet.run_sql("SELECT attempt, path_from, path_to, state FROM popcut.chunk"));
  for (std::string line; std::getline(chunks, line);) {
    std::vector<std::string> words;
    std::istringstream parts(line);
    for (std::string word; std::getline(parts, word, '|');) words.push_back(word);
    REQUIRE(words.size() == 4);
    Attempt& one = attempts[words[0]];
    for (int k = std::atoi(words[1].c_str()); k <= std::atoi(words[2].c_str()); ++k)
      (words[3] == "certain" ? one.certain : one.doubt).insert(k);
  }
  account.attempts = attempts.size();

  const auto machine = find_machine("cameo3");
  std::map<Stroke, int> times;
  std::map<std::string, int> opened;
  std::map<std::string, std::set<int>> cut;
  for (int node = 1; node <= fleet.size(); ++node)
    for (const Received& one : received_log(fleet[node].daemon().folder() / "trace/received.log")) {
      CAPTURE(node, one.attempt);
      ++opened[one.attempt];
      const std::vector<std::string> places = places_cut(one.bytes, *machine);
      if (!attempts.contains(one.attempt)) {
        CHECK(places.empty());  // of what the ledger does not know nothing was cut
        continue;
      }
      const Attempt& known = attempts[one.attempt];
      if (!places.empty()) CHECK(known.started);
      for (const std::string& place : places) {
        const int line = line_at(place, kLines);
        REQUIRE(line >= 0);
        ++account.strokes;
        ++times[{known.job, known.blank, line}];
        cut[one.attempt].insert(line);
        if (!known.certain.contains(line) && !known.doubt.contains(line)) {
          CAPTURE(line, known.job, known.blank);
          FAIL_CHECK("a stroke was cut that the ledger calls not sent");
        }
      }
    }
  for (const auto& [id, count] : opened) {
    CAPTURE(id);
    CHECK(count == 1);
  }
  for (const auto& [id, one] : attempts) {
    CAPTURE(id, one.job, one.blank);
    for (const int line : one.certain)
      if (!cut[id].contains(line)) {
        CAPTURE(line);
        FAIL_CHECK("a stroke is certain that was not cut");
      }
  }
  for (const auto& [stroke, count] : times) {
    const auto& [job, blank, line] = stroke;
    CAPTURE(job, blank, line, count);
    if (count > 1) ++account.accepted_twice;
    CHECK(count <= 1 + people.allowed(stroke));
  }
  std::map<std::string, std::string> jobs;
  std::istringstream states(fleet.run_sql("SELECT id, state FROM popcut.job"));
  for (std::string line; std::getline(states, line);)
    jobs[line.substr(0, line.find('|'))] = line.substr(line.find('|') + 1);
  for (const std::string& id : people.accepted()) {
    CAPTURE(id);
    CHECK(jobs.contains(id));
  }
  account.jobs = jobs.size();
  for (const auto& [id, state] : jobs) ++account.states[state];
  return account;
}

std::string words_of(const std::map<std::string, int>& states) {
  std::string text;
  for (const auto& [state, count] : states)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, state);
  return text;
}

}  // namespace

TEST_CASE("a fleet in which everything dies cuts nothing twice and loses no job",
          "[fleet][oracle]") {
  NEEDS_POSTGRES();
  const auto seed = static_cast<std::uint32_t>(number_from("POPCUT_FLEET_SEED", 1));
  const int seconds = number_from("POPCUT_FLEET_S", 15);
  const int nodes = number_from("POPCUT_FLEET_NODES", 3);
  const bool is_long = seconds > 60;
  if (is_long) std::printf("seed %u, %d nodes, %d s\n", seed, nodes, seconds);
  CAPTURE(seed, nodes);
  FleetNodes fleet(
      {.nodes = nodes, .time_scale = kTimeScale, .lease_s = 2, .beat_s = 0.4, .proxies = true});
  fleet.open();
  const std::string design = fleet[1].design(RunningDaemon::lines_svg(kLines));
  People people(fleet, 1000 * seed, design);
  Fate fate(fleet, seed);
  const auto begun = Clock::now();
  auto told = begun;
  std::mt19937 random(seed + 7);
  while (since(begun) < seconds) {
    fate.pass_time(0.05 + 0.002 * static_cast<double>(random() % 1000));
    fate.strike();
    if (is_long && since(told) >= 10) {
      told = Clock::now();
      std::printf(
          "%5.0f s: %d faults (%d nodes and %d times the database killed), %zu jobs, "
          "%d starts, %d of %d actions done\n",
          since(begun), fate.struck.load(), fate.kills.load(), fate.database_kills.load(),
          people.accepted().size(), people.starts.load(), people.done.load(), people.asked.load());
      std::fflush(stdout);
    }
  }
  fate.heal();
  // People work on for a moment, then what still cuts comes to its end.
  nap(is_long ? 10 : 3);
  people.stop();
  for (int k = 1; k <= fleet.size(); ++k) {
    INFO(fleet[k].daemon().log());
    REQUIRE(happens([&] { return fleet.is_alive(k); }));
  }
  std::string last;
  const bool settles = happens(
      [&] {
        const auto all = fleet[1].api().list("/v1/jobs", "jobs");
        for (const Json& job : all ? *all : std::vector<Json>()) {
          if (text_of(job, "state") != "paused") continue;
          const auto done = fleet[1].api().act(job, "cancel", Json::object());
          last = done ? "cancelled " + text_of(job, "id") : message(done.error());
          nap(0.5);
        }
        return fleet.run_sql(
                   "SELECT count(*) FROM popcut.job WHERE state IN ('cutting', 'paused', "
                   "'planning', 'queued')") == "0";
      },
      60);
  INFO(
      fleet.run_sql("SELECT id, state, asked, reason, device FROM popcut.job WHERE state NOT IN "
                    "('done', 'ready', 'cancelled', 'interrupted')"));
  INFO(last);
  if (!settles)
    for (int k = 1; k <= fleet.size(); ++k)
      std::fprintf(stderr, "%s\n%s\n", FleetNodes::name(k).c_str(),
                   fleet[k].daemon().log().c_str());
  CHECK(settles);
  CHECK(fleet.run_sql("SELECT count(*) FROM popcut.attempt WHERE ended IS NULL") == "0");
  const Account account = check_all(fleet, people);
  std::printf(
      "fleet: %d faults (%d nodes and %d times the database killed, %d repeated), %zu jobs (%s), "
      "%zu attempts, %zu strokes cut, %zu of them twice as accepted, %d of %d actions done\n",
      fate.struck.load(), fate.kills.load(), fate.database_kills.load(), fate.repeats.load(),
      account.jobs, words_of(account.states).c_str(), account.attempts, account.strokes,
      account.accepted_twice, people.done.load(), people.asked.load());
  CHECK(account.strokes > 0);
}

}  // namespace fleet_oracle_test
