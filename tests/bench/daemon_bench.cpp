// SPDX-License-Identifier: MIT
// popcutd as its users meet it, over HTTP, with ten thousand jobs of ten sheets and a knife that is
// moving: requests a second, memory, start, and what the load does to the knife.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/api.hpp"
#include "tests/bench/http_load.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"

namespace daemon_bench {

using namespace popcut;
using namespace popcut::testing;
using client::Api;
using nlohmann::json;

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kJobs = 10'000;
constexpr int kSheets = 10;
constexpr double kTimeScale = 20;         // as popcutd's own simulated cutter
constexpr int kRows = 48, kColumns = 18;  // lines of a sheet that takes a minute at that speed
constexpr double kEach_s = 2;             // of load of one kind
constexpr int kStarts = 7;

double ms_since(Clock::time_point then) {
  return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

std::string design_svg() {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='280mm' height='280mm' viewBox='0 0 280 280'>";
  for (int k = 0; k < kRows * kColumns; ++k)
    svg += fmt::format("<path fill='none' stroke='black' d='M{},{}h9'/>", 20 + 13 * (k % kColumns),
                       20 + 5 * (k / kColumns));
  return svg + "</svg>";
}

/// What a process has in memory, in MB.
struct Memory {
  double resident{}, proportional{}, own{};
};

Memory memory_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/smaps_rollup");
  Memory memory;
  for (std::string line; std::getline(file, line);) {
    const auto mb = [&] { return std::strtod(line.c_str() + line.find(':') + 1, nullptr) / 1024; };
    if (line.starts_with("Rss:")) memory.resident = mb();
    if (line.starts_with("Pss:")) memory.proportional = mb();
    if (line.starts_with("Private_")) memory.own += mb();
  }
  return memory;
}

/// Processor time of a process so far, in ms; the system counts it in steps of 10.
double processor_ms(pid_t process) {
  const std::string text = text_of_file("/proc/" + std::to_string(process) + "/stat");
  const char* at = text.c_str() + text.rfind(')');
  for (int field = 2; field < 14; ++field) at = std::strchr(at, ' ') + 1;
  char* end = nullptr;
  const double user = std::strtod(at, &end);
  return (user + std::strtod(end, nullptr)) * 1000 / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// What the metrics say of how long the stream was held up.
struct Waits {
  double longest_ms{};
  std::int64_t count{};
};

/// How a cut went: what the knife noticed, on its own clock, and what the stream did, on ours.
struct CutFigures {
  double seconds{}, starved_ms{};
  Waits waits;
};

class Bench {
 public:
  Bench() : daemon_(popcutd_program(), kTimeScale, "connections = 200\n") {}

  void start() {
    REQUIRE(daemon_.start());
    const auto address = value(client::parse_address("unix:" + daemon_.socket()));
    client::HttpClient http({address}, "");
    api_ = std::make_unique<Api>(std::move(http));
    const std::string url = daemon_.url();
    tcp_.port = static_cast<std::uint16_t>(std::atoi(url.c_str() + url.rfind(':') + 1));
  }
  void end(int signal) {
    api_.reset();
    daemon_.signal(signal);
    const int code = daemon_.wait();
    REQUIRE(code == (signal == SIGKILL ? 128 + SIGKILL : 0));
  }

  /// Milliseconds from the call to exec until it answers a request.
  double start_ms() {
    std::atomic<bool> answered{false}, given_up{false};
    double took = 0;
    const Clock::time_point begun = Clock::now();
    std::thread asks([&] {
      while (!answered && !given_up) {
        try {
          KeptConnection connection(local());
          answered =
              connection.ask("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n").status == 200;
        } catch (const std::exception&) {
          std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
      }
      took = ms_since(begun);
    });
    start();
    const Clock::time_point serving = Clock::now();
    while (!answered && ms_since(serving) < 10'000)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    given_up = true;
    asks.join();
    REQUIRE(answered);
    return took;
  }

  /// One design, one plan, and `kJobs` jobs of it.
  void fill() {
    const auto token =
        api().post("/v1/tokens", {{"name", "bench"}, {"role", "admin"}}, "tokens").value();
    token_ = client::text_of(token, "token");
    const auto design =
        api().upload("/v1/designs?name=lines", design_svg(), "image/svg+xml", "").value();
    const json first =
        api().post("/v1/jobs", job_of("design", client::text_of(design, "id")), "jobs").value();
    plan_ = client::text_of(first, "plan");
    for (const auto begun = Clock::now(); ms_since(begun) < 60'000;) {
      const json plan = api().get("/v1/plans/" + plan_, "plan").value();
      if (client::text_of(plan, "state") != "pending") break;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::atomic<int> made{1};
    std::vector<std::thread> threads;
    for (int client = 0; client < 4; ++client)
      threads.emplace_back([&] {
        KeptConnection connection(local());
        while (made++ < kJobs)
          if (connection.ask(post_job(local())).status != 201) return;
      });
    for (std::thread& thread : threads) thread.join();
    const auto jobs = value(api().list("/v1/jobs", "jobs"));
    REQUIRE(jobs.size() == kJobs);
    for (const json& job : jobs) ids_.push_back(client::text_of(job, "id"));
    const json plan = api().get("/v1/plans/" + plan_, "plan").value();
    sheet_s_ = plan["sheets"][0]["seconds"].get<double>();
  }

  /// Starts the first sheet of the job `index`.
  void start_cut(std::size_t index) {
    cutting_ = ids_.at(index);
    const json job = api().get("/v1/jobs/" + cutting_, "job").value();
    const json armed = api().act(job, "arm", {{"sheet", 1}}).value();
    REQUIRE(api().act(armed, "start", {{"sheet", 1}}));
  }
  bool cuts() {
    const json job = api().get("/v1/jobs/" + cutting_, "job").value();
    return client::text_of(job, "state") == "cutting";
  }
  CutFigures end_of_cut() {
    while (cuts()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const json ledger = api().get("/v1/jobs/" + cutting_ + "/sheets/1/ledger", "ledger").value();
    const std::string attempt = client::text_of(ledger["attempts"][0], "id");
    CHECK(client::text_of(ledger["attempts"][0], "end_kind") == "done");
    const json trace = json::parse(text_of_file(daemon_.folder() / ("trace/" + attempt + ".json")));
    CutFigures figures;
    figures.seconds = trace["seconds"].get<double>();
    figures.starved_ms = 1000 * trace["starved_s"].get<double>() / kTimeScale;
    figures.waits = waits();
    return figures;
  }

  std::string get(const Endpoint& to, const std::string& target) const {
    return "GET " + target + head(to) + "\r\n";
  }
  std::string post_job(const Endpoint& to) const {
    const std::string body = job_of("plan", plan_).dump();
    return fmt::format(
        "POST /v1/jobs{}Content-Type: application/json\r\nIdempotency-Key: {}\r\n"
        "Content-Length: {}\r\n\r\n{}",
        head(to), client::random_key(), body.size(), body);
  }
  /// A walk through the whole list, page by page: milliseconds.
  double list_all(KeptConnection& connection) {
    const Clock::time_point begun = Clock::now();
    std::size_t seen = 0;
    for (std::string cursor; seen == 0 || !cursor.empty();) {
      const auto answer = connection.ask(
          get(tcp_, "/v1/jobs?limit=200" + (cursor.empty() ? "" : "&cursor=" + cursor)));
      REQUIRE(answer.status == 200);
      constexpr std::string_view kBefore = "\"next_cursor\":\"";
      const std::size_t at = answer.body.rfind(kBefore);
      cursor.clear();
      if (at != std::string_view::npos) {
        cursor = answer.body.substr(at + kBefore.size());
        cursor.resize(cursor.find('"'));
        if (cursors_.size() < kJobs / 200 - 1) cursors_.push_back(cursor);
      }
      for (std::size_t k = 0; (k = answer.body.find("\"rev\":", k)) != std::string_view::npos; ++k)
        ++seen;
    }
    CHECK(seen >= kJobs);
    return ms_since(begun);
  }

  Api& api() { return *api_; }
  [[nodiscard]] Endpoint tcp() const { return tcp_; }
  [[nodiscard]] Endpoint local() const { return {0, daemon_.socket()}; }
  [[nodiscard]] const std::string& id(std::size_t k) const { return ids_[k % ids_.size()]; }
  /// Where a page of the list begins.
  [[nodiscard]] const std::string& cursor(std::size_t k) const {
    return cursors_[k % cursors_.size()];
  }
  [[nodiscard]] double processor() const { return processor_ms(daemon_.pid()); }
  [[nodiscard]] Memory memory() const { return memory_of(daemon_.pid()); }
  [[nodiscard]] double sheet_s() const { return sheet_s_; }
  [[nodiscard]] std::string file(const char* name) const { return daemon_.folder() / name; }

 private:
  static json job_of(const char* what, const std::string& id) {
    return {{what, id}, {"copies", kSheets}, {"name", "a card for the bench"}, {"tags", {"bench"}}};
  }
  [[nodiscard]] std::string head(const Endpoint& to) const {
    if (!to.unix_socket.empty()) return " HTTP/1.1\r\nHost: localhost\r\n";
    return fmt::format(" HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n", to.port,
                       token_);
  }
  Waits waits() {
    const std::string text = api().get_text("/metrics", "*/*", "metrics").value();
    const auto value = [&](const std::string& name) {
      const std::size_t at = text.find("\n" + name + " ");
      return at == std::string::npos ? 0
                                     : std::strtod(text.c_str() + at + name.size() + 2, nullptr);
    };
    return {1000 * value("popcut_stream_wait_seconds_longest"),
            static_cast<std::int64_t>(value("popcut_stream_wait_seconds_count"))};
  }

  DaemonProcess daemon_;
  std::unique_ptr<Api> api_;
  Endpoint tcp_;
  std::string token_, plan_, cutting_;
  std::vector<std::string> ids_, cursors_;
  double sheet_s_{};
};

/// `processor_ms`: what popcutd took of a processor meanwhile; less than 0: it is not about it.
void say_load(const char* what, const LoadFigures& figures, double processor_ms,
              double bar_ms = 0) {
  const std::string bar = bar_ms > 0 ? fmt::format("p99 < {:g}", bar_ms) : "";
  const std::string each =
      processor_ms < 0
          ? "-"
          : fmt::format("{:.3f}", processor_ms / static_cast<double>(figures.requests));
  std::printf("  %-34s %3d %9.0f %8.2f %8.2f %8.2f %8s   %s\n", what, figures.clients,
              figures.per_second(), figures.within(0.5), figures.within(0.99),
              figures.milliseconds.back(), each.c_str(), bar.c_str());
  CHECK(figures.failures == 0);
}

void say(const char* what, double value, const char* unit, double bar = 0) {
  const std::string text = bar > 0 ? fmt::format("< {:g}", bar) : "";
  std::printf("  %-44s %9.2f %-4s %s\n", what, value, unit, text.c_str());
}

double median(std::vector<double> all) {
  std::sort(all.begin(), all.end());
  return all[all.size() / 2];
}

void measure_starts(Bench& bench, const char* what, int signal) {
  std::vector<double> took, processor;
  for (int k = 0; k < kStarts; ++k) {
    KeptConnection connection(bench.local());
    for (int made = 0; signal == SIGKILL && made < 20; ++made)  // so that there is a log to read
      REQUIRE(connection.ask(bench.post_job(bench.local())).status == 201);
    bench.end(signal);
    took.push_back(bench.start_ms());
    processor.push_back(bench.processor());
  }
  say(fmt::format("start {}, median of {}", what, kStarts).c_str(), median(took), "ms", 100);
  say("  processor time of it, median", median(processor), "ms");
  say("  the longest of them", *std::max_element(took.begin(), took.end()), "ms");
}

void measure_load(Bench& bench, const BareServer& bare) {
  const Endpoint tcp = bench.tcp(), local = bench.local();
  std::printf("\n  %-34s %3s %9s %8s %8s %8s %8s\n", "while a cut streams", "cl.", "a second",
              "p50 ms", "p99 ms", "longest", "CPU ms");
  const auto under = [&](const char* what, const Endpoint& to, int clients, int status,
                         const std::function<std::string(int, int)>& request, double bar_ms = 0) {
    const double before = bench.processor();
    const LoadFigures figures = load(to, clients, kEach_s, status, request);
    say_load(what, figures, bench.processor() - before, bar_ms);
  };
  const auto job = [&](const Endpoint& to) {
    return [&bench, to](int client, int k) {
      return bench.get(to, "/v1/jobs/" + bench.id(static_cast<std::size_t>(client * 997 + k)));
    };
  };
  for (const int clients : {1, 16}) under("GET job", tcp, clients, 200, job(tcp));
  under("GET job (unix socket)", local, 1, 200, job(local));
  {
    KeptConnection connection(tcp);
    bench.list_all(connection);
  }
  const auto page = [&](int client, int k) {
    return bench.get(
        tcp, "/v1/jobs?limit=200&cursor=" + bench.cursor(static_cast<std::size_t>(client * 7 + k)));
  };
  for (const int clients : {1, 8})
    under("GET a page of 200 jobs", tcp, clients, 200, page, clients == 1 ? 20 : 0);
  {
    LoadFigures lists;
    lists.clients = 1;
    KeptConnection connection(tcp);
    const double before = bench.processor();
    const Clock::time_point begun = Clock::now();
    while (ms_since(begun) < 1000 * kEach_s)
      lists.milliseconds.push_back(bench.list_all(connection));
    lists.seconds = ms_since(begun) / 1000;
    lists.requests = lists.milliseconds.size();
    std::sort(lists.milliseconds.begin(), lists.milliseconds.end());
    say_load("list of 10 000 (50 pages of 200)", lists, bench.processor() - before);
  }
  for (const int clients : {1, 16})
    under("POST job", tcp, clients, 201, [&](int, int) { return bench.post_job(tcp); });
  const std::string plain = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
  for (const int clients : {1, 16})
    say_load("beside it: bare Boost.Beast, 1.3 kB",
             load(bare.endpoint(), clients, kEach_s, 200, [&](int, int) { return plain; }), -1);
  LoadFigures commits;
  commits.clients = 1;
  commits.milliseconds = bare_commits(bench.file("bare.db"), 500, 1000);
  commits.requests = commits.milliseconds.size();
  for (const double ms : commits.milliseconds) commits.seconds += ms / 1000;
  say_load("beside it: bare SQLite, a commit", commits, -1);
}

}  // namespace

TEST_CASE("popcutd with ten thousand jobs while a knife moves", "[bench]") {
  const BareServer bare(1300);
  Bench bench;
  double average = 0;
  REQUIRE(getloadavg(&average, 1) == 1);
  std::printf("load average %.1f on %u processors\n\n", average,
              std::thread::hardware_concurrency());
  say("start with nothing", bench.start_ms(), "ms");
  std::this_thread::sleep_for(std::chrono::seconds(2));
  say("resident memory, idle, with nothing", bench.memory().resident, "MB");
  const Clock::time_point begun = Clock::now();
  bench.fill();
  std::printf("  (%d jobs of %d sheets in %.1f s)\n", kJobs, kSheets, ms_since(begun) / 1000);
  measure_starts(bench, "after an orderly end", SIGTERM);
  measure_starts(bench, "after kill -9", SIGKILL);
  std::this_thread::sleep_for(std::chrono::seconds(3));
  const Memory idle = bench.memory();
  say("resident memory, idle", idle.resident, "MB", 20);
  CHECK(idle.resident < 20);
  say("  shared pages by share (PSS)", idle.proportional, "MB");
  say("  its own alone", idle.own, "MB");

  bench.start_cut(0);
  const CutFigures alone = bench.end_of_cut();
  bench.end(SIGTERM);
  bench.start();
  bench.start_cut(1);
  measure_load(bench, bare);
  const bool through = bench.cuts();
  const CutFigures loaded = bench.end_of_cut();
  CHECK(through);  // it cut all the while
  std::printf("\n  %-44s %9s %9s\n", "the knife", "alone", "loaded");
  std::printf("  %-44s %9.2f %9.2f   (plan %.2f)\n", "a sheet, s of the cutter's clock",
              alone.seconds, loaded.seconds, bench.sheet_s());
  std::printf("  %-44s %9.2f %9.2f\n", "longest wait for bytes with the tool down, ms",
              alone.starved_ms, loaded.starved_ms);
  std::printf("  %-44s %9.2f %9.2f   of %lld, %lld\n", "longest pause of the stream, ms",
              alone.waits.longest_ms, loaded.waits.longest_ms,
              static_cast<long long>(alone.waits.count),
              static_cast<long long>(loaded.waits.count));
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const Memory after = bench.memory();
  say("\n  resident memory after all that", after.resident, "MB", 150);
  say("  its own alone", after.own, "MB");
}

}  // namespace daemon_bench
