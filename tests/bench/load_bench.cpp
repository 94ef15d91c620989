// SPDX-License-Identifier: MIT
// 64 clients that mean no good, of many kinds, while a cut streams to the simulated cutter: the
// longest turn of the thread that feeds the knife, how soon a cancel is answered, and how long the
// stream waits. POPCUT_LOAD_SECONDS is how long (60).
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/api.hpp"
#include "tests/bench/http_load.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/timing.hpp"

namespace load_bench {

using namespace popcut;
using namespace popcut::testing;
using client::Api;
using nlohmann::json;

namespace {

constexpr const char* kConfig = "connections = 200\nplans_each = 100000\n";

std::string lines_svg(int lines) {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='280mm' height='280mm' viewBox='0 0 280 280'>";
  for (int k = 0; k < lines; ++k)
    svg += fmt::format("<path fill='none' stroke='black' d='M{},{}h9'/>", 20 + 13 * (k % 18),
                       20 + 5 * (k / 18 % 48));
  return svg + "</svg>";
}

std::string invented_ids() {
  std::string text = "{\"popcut\":1,\"files\":[";
  for (int k = 0; text.size() < (32u << 20) - 100; ++k)
    text += fmt::format("\"sha256-{:064x}\",", k);
  return text + "\"\"]}";
}

/// The value of a metric; of all that begin so, the largest.
double largest(const std::string& metrics, const std::string& begin, std::string* which = nullptr) {
  double most = 0;
  for (std::size_t at = metrics.find("\n" + begin); at != std::string::npos;
       at = metrics.find("\n" + begin, at + 1)) {
    const std::string line = metrics.substr(at + 1, metrics.find('\n', at + 1) - at - 1);
    const double value = std::strtod(line.c_str() + line.rfind(' '), nullptr);
    if (value > most && which != nullptr) *which = line.substr(0, line.rfind(' '));
    most = std::max(most, value);
  }
  return most;
}

double part(const std::vector<double>& sorted, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
  return sorted[std::min(at, sorted.size() - 1)];
}

}  // namespace

TEST_CASE("64 hostile clients while a cut streams", "[bench]") {
  const char* const wanted = std::getenv("POPCUT_LOAD_SECONDS");
  const double seconds = wanted == nullptr ? 60 : std::atof(wanted);
  DaemonProcess daemon(popcutd_program(), 4, kConfig);
  REQUIRE(daemon.start());
  client::HttpClient http({*client::parse_address("unix:" + daemon.socket())}, "");
  Api api(std::move(http));
  const auto token_of = [&](const char* role) {
    return client::text_of(
        api.post("/v1/tokens", {{"name", role}, {"role", role}}, "tokens").value(), "token");
  };
  const std::string bad = token_of("submitter"), good = token_of("operator");
  const std::string url = daemon.url();
  const Endpoint tcp{static_cast<std::uint16_t>(std::atoi(url.c_str() + url.rfind(':') + 1)), {}};
  const auto design = client::text_of(
      api.upload("/v1/designs?name=a", lines_svg(864), "image/svg+xml", "").value(), "id");
  json job = api.post("/v1/jobs", {{"design", design}, {"copies", 3}}, "jobs").value();
  const std::string cut = client::text_of(job, "id"), plan = client::text_of(job, "plan");
  REQUIRE(comes_true([&] {
    job = api.get("/v1/jobs/" + cut, "job").value();
    return client::text_of(job, "state") == "ready";
  }));
  const json armed = api.act(job, "arm", {{"sheet", 1}}).value();
  REQUIRE(api.act(armed, "start", {{"sheet", 1}}));

  const auto head = [&](const std::string& token, const std::string& more = "") {
    return fmt::format(" HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n{}",
                       tcp.port, token, more);
  };
  const auto get = [&](const std::string& path) { return "GET " + path + head(bad) + "\r\n"; };
  const auto post = [&](const std::string& token, const std::string& path, const std::string& body,
                        const std::string& more = "") {
    return fmt::format(
        "POST {}{}Content-Type: application/json\r\nIdempotency-Key: {}\r\nContent-Length: "
        "{}\r\n\r\n{}",
        path, head(token, more), client::random_key(), body.size(), body);
  };
  const std::string ids = invented_ids();
  std::string dense = "{\"options\":[";
  while (dense.size() < (256u << 10) - 10) dense += "[],";
  dense += "[]]}";
  const std::string new_job = json{{"plan", plan}}.dump();
  const std::vector<std::function<std::string(int)>> kinds{
      [&](int k) {
        return post(bad, "/v1/designs",
                    ids.substr(0, ids.size() - 1) +
                        std::string(1 + static_cast<std::size_t>(k % 50), ' ') + "}");
      },
      [&](int) { return get("/v1/jobs?limit=200&owner=nobody&state=queued,ready,done,cancelled"); },
      [&](int) { return get("/v1/queue?limit=200&device=nobody"); },
      [&](int) { return get("/v1/plans/" + plan); },
      [&](int) { return post(bad, "/v1/jobs", new_job); },
      [&](int) { return post(bad, "/v1/jobs", dense); },
      [&](int) { return get("/v1/usage?by=device"); },
      [&](int k) { return get(k % 2 == 0 ? "/metrics" : "/v1/events?after=0&limit=200"); }};
  std::atomic<bool> stop{false};
  std::atomic<std::size_t> asked{0};
  std::vector<std::thread> crowd;
  for (int client = 0; client < 64; ++client)
    crowd.emplace_back([&, client] {
      const auto& kind = kinds[static_cast<std::size_t>(client) % kinds.size()];
      for (int k = client; !stop; ++k) {
        try {
          KeptConnection connection(tcp);
          for (int again = 0; again < 20 && !stop; ++again) {
            ++asked;
            if (connection.ask(kind(k + 100 * again)).status == 0) break;
          }
        } catch (const std::exception&) {
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      }
    });
  // A person who stops jobs, all the while.
  std::vector<double> cancels;
  const auto begun = std::chrono::steady_clock::now();
  std::size_t failed = 0;
  while (seconds_since(begun) < seconds) {
    try {
      KeptConnection connection(tcp);
      for (int k = 0; k < 50 && seconds_since(begun) < seconds; ++k) {
        const auto made = connection.ask(post(good, "/v1/jobs", new_job));
        const json answer = json::parse(made.body, nullptr, false);
        if (made.status != 201) break;
        const std::string id = client::text_of(answer, "id");
        const std::string request =
            post(good, "/v1/jobs/" + id + "/actions/cancel", "{}", "If-Match: *\r\n");
        const auto sent = std::chrono::steady_clock::now();
        const auto cancelled = connection.ask(request);
        cancels.push_back(1000 * seconds_since(sent));
        if (cancelled.status != 200) ++failed;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    } catch (const std::exception&) {
      ++failed;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  const std::string metrics = api.get_text("/metrics", "*/*", "metrics").value();
  const std::string state = client::text_of(api.get("/v1/jobs/" + cut, "job").value(), "state");
  stop = true;
  daemon.signal(SIGKILL);  // whoever is in the middle of something ends now
  for (std::thread& thread : crowd) thread.join();
  REQUIRE_FALSE(cancels.empty());
  std::sort(cancels.begin(), cancels.end());
  std::string longest, longest_cpu;
  const double turn = largest(metrics, "popcut_service_turn_longest_seconds{", &longest);
  const double cpu = largest(metrics, "popcut_service_turn_longest_cpu_seconds{", &longest_cpu);
  double average = 0;
  (void)!getloadavg(&average, 1);
  std::printf("%.0f s, %zu requests of 64 clients, load average %.1f on %u processors\n", seconds,
              asked.load(), average, std::thread::hardware_concurrency());
  std::printf("longest turn          %8.1f ms  %s   (bar 50)\n", 1000 * turn, longest.c_str());
  std::printf("  of processor time   %8.1f ms  %s\n", 1000 * cpu, longest_cpu.c_str());
  std::printf(
      "cancel, of %zu: p50 %.1f, p99 %.1f, p99.9 %.1f, longest %.1f ms   (bar 100 at p99.9)\n",
      cancels.size(), part(cancels, 0.5), part(cancels, 0.99), part(cancels, 0.999),
      cancels.back());
  std::printf("longest wait of the stream %.1f ms\n",
              1000 * largest(metrics, "popcut_stream_wait_seconds_longest "));
  CHECK(failed == 0);
  CHECK((state == "cutting" || state == "ready" || state == "done"));
  CHECK(cpu < 0.05);
}

}  // namespace load_bench
