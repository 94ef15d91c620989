// SPDX-License-Identifier: MIT
// Clients that are slow, greedy or gone, while the whole of popcutd cuts.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <deque>
#include <filesystem>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/raw_http.hpp"
#include "tests/support/running_daemon.hpp"

namespace faults_network_test {

using namespace popcut;
using namespace popcut::testing;
using daemon::RawConnection;
using Json = nlohmann::json;

namespace {

constexpr int kLines = 120;

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    count += entry.path().empty() ? 0 : 1;
  return count;
}

/// Those who mean no good, each kind on a thread of its own until they are told to stop.
class Crowd {
 public:
  Crowd(std::uint16_t port, std::string head) : port_(port), head_(std::move(head)) {
    for (auto work : {&Crowd::half_heads, &Crowd::endless_uploads, &Crowd::who_never_read,
                      &Crowd::who_reset, &Crowd::lying_lengths})
      threads_.emplace_back([this, work] { (this->*work)(); });
  }
  ~Crowd() { stop(); }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;
  void stop() {
    stop_ = true;
    for (std::thread& thread : threads_)
      if (thread.joinable()) thread.join();
  }
  std::atomic<int> rounds{0};

 private:
  void nap() const { std::this_thread::sleep_for(std::chrono::milliseconds(5)); }
  /// Two hundred at a time, thrown out or not, and anew.
  void half_heads() {
    std::vector<RawConnection> slow;
    while (!stop_) {
      if (slow.size() >= 200) slow.clear();
      slow.emplace_back(port_);
      slow.back().send("GET /v1/jobs HTTP/1.1\r\nX-A: ");
      nap();
      ++rounds;
    }
  }
  void endless_uploads() {
    const std::string piece = "2000\r\n" + std::string(0x2000, 'x') + "\r\n";
    while (!stop_) {
      RawConnection one(port_);
      one.send("POST /v1/designs?name=endless HTTP/1.1\r\n" + head_ +
               "Content-Type: image/svg+xml\r\nTransfer-Encoding: chunked\r\n\r\n");
      for (int i = 0; i < 8000 && !stop_ && one.send(piece); ++i) continue;
      nap();
    }
  }
  /// Streams and long lists of which nothing is taken.
  void who_never_read() {
    std::deque<RawConnection> all;
    while (!stop_) {
      if (all.size() >= 24) all.pop_front();
      all.emplace_back(port_);
      all.back().shrink_buffer(2048);
      const bool stream = all.size() % 2 == 0;
      all.back().send(fmt::format("GET {} HTTP/1.1\r\n{}\r\n",
                                  stream ? "/v1/events" : "/v1/openapi.json", head_));
      nap();
    }
  }
  void who_reset() {
    while (!stop_) {
      RawConnection one(port_);
      one.send("GET /v1/openapi.json HTTP/1.1\r\n" + head_ + "\r\n");
      one.reset();
      nap();
    }
  }
  void lying_lengths() {
    while (!stop_) {
      RawConnection one(port_);
      one.send("POST /v1/designs HTTP/1.1\r\n" + head_ +
               "Content-Type: image/svg+xml\r\nContent-Length: 10737418240\r\n\r\n<svg");
      RawConnection less(port_);
      less.send("POST /v1/designs HTTP/1.1\r\n" + head_ +
                "Content-Type: image/svg+xml\r\nContent-Length: 1000\r\n\r\n<svg");
      nap();
    }
  }
  std::uint16_t port_;
  std::string head_;
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

/// The numbers of its open files, once what was begun has let go of its own.
std::set<std::size_t> settled_files(pid_t process) {
  const auto numbers = [process] {
    std::set<std::size_t> all;
    for (const auto& entry :
         std::filesystem::directory_iterator(fmt::format("/proc/{}/fd", process)))
      all.insert(std::stoul(entry.path().filename().string()));
    return all;
  };
  std::set<std::size_t> now = numbers();
  for (int same = 0; same < 6;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::set<std::size_t> next = numbers();
    same = next == now ? same + 1 : 0;
    now = std::move(next);
  }
  return now;
}

/// Leaves popcutd so many descriptors more than it has now, until it goes.
class TightDescriptors {
 public:
  TightDescriptors(pid_t process, std::size_t more) : process_(process) {
    if (::prlimit(process_, RLIMIT_NOFILE, nullptr, &before_) != 0)
      throw std::runtime_error("rlimit");
    // The limit is one of numbers, not of how many: those that are free below it count.
    const std::set<std::size_t> used = settled_files(process);
    rlimit tight = before_;
    tight.rlim_cur = 0;
    for (std::size_t free = 0; free < more; ++tight.rlim_cur)
      if (!used.contains(tight.rlim_cur)) ++free;
    if (::prlimit(process_, RLIMIT_NOFILE, &tight, nullptr) != 0)
      throw std::runtime_error("rlimit");
  }
  ~TightDescriptors() { ::prlimit(process_, RLIMIT_NOFILE, &before_, nullptr); }
  TightDescriptors(const TightDescriptors&) = delete;
  TightDescriptors& operator=(const TightDescriptors&) = delete;

 private:
  pid_t process_;
  rlimit before_{};
};

std::uint16_t port_of(RunningDaemon& popcutd) {
  const std::string url = popcutd.daemon().url();
  return static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
}

std::vector<RawConnection> half_heads(std::uint16_t port, int count) {
  std::vector<RawConnection> crowd;
  for (int k = 0; k < count; ++k) {
    crowd.emplace_back(port);
    crowd.back().send("GET /v1/jobs HTTP/1.1\r\nX-A: ");
  }
  return crowd;
}

bool is_served(std::uint16_t port) {
  return happens([&] {
    RawConnection one(port);
    one.send(fmt::format("GET /healthz HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", port));
    return one.receive(5).status == 200;
  });
}

}  // namespace

TEST_CASE("a cut continues and can be held whatever clients do and nothing is left behind",
          "[popcutd][faults]") {
  RunningDaemon popcutd(8);
  popcutd.open();
  const auto port = port_of(popcutd);
  const Json token =
      Json::parse(popcutd.ask("POST", "/v1/tokens", R"({"name":"crowd","role":"submitter"})").body);
  const std::string head = fmt::format("Host: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n", port,
                                       token["token"].get<std::string>());
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(kLines)));
  const std::filesystem::path incoming = popcutd.daemon().state() + "/incoming";
  const std::size_t files = open_files(popcutd.daemon().pid());
  popcutd.cut(id);
  {
    Crowd crowd(port, head);
    REQUIRE(happens([&] { return crowd.rounds > 50; }));
    const auto sent = [](const Json& job) { return job["progress"]["paths_sent"].get<int>(); };
    const int before = sent(popcutd.job(id));
    popcutd.await(id, [&](const Json& job) { return sent(job) > before + 10; });
    // Places are taken, but not that of who stops a knife; the crowd is not waited for.
    popcutd.act(id, "pause");
    popcutd.await_state(id, "paused");
  }
  CHECK(happens([&] { return popcutd.ask("GET", "/v1/devices").status == 200; }));
  popcutd.act(id, "resume");
  popcutd.await_state(id, "done");
  CHECK(lines_cut(popcutd.daemon().folder() / "trace", kLines).size() == kLines);
  CHECK(popcutd.ledger(id)["in_doubt"].empty());
  // Their places, their files and their descriptors are free again.
  CHECK(happens([&] { return files_in(incoming) == 0; }));
  CHECK(happens([&] { return open_files(popcutd.daemon().pid()) <= files; }));
  CHECK(popcutd.get("/readyz")["ready"] == true);
}

TEST_CASE("a client that stops reading in the middle of an answer delays nobody else",
          "[popcutd][faults]") {
  RunningDaemon popcutd(20);
  popcutd.open();
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(30)));
  // A real one, with a stream and its process stopped.
  const pid_t client = ::fork();
  REQUIRE(client >= 0);
  if (client == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::setenv("POPCUT_URL", popcutd.daemon().socket().c_str(), 1);
    ::execl(popcut_program(), popcut_program(), "events", "--follow", nullptr);
    ::_exit(127);
  }
  REQUIRE(happens([&] {
    return popcutd.ask("GET", "/metrics").body.find("popcut_sse_clients 1\n") != std::string::npos;
  }));
  ::kill(client, SIGSTOP);
  popcutd.cut(id);
  popcutd.await_state(id, "done");
  CHECK(lines_cut(popcutd.daemon().folder() / "trace", 30).size() == 30);
  ::kill(client, SIGKILL);
  ::waitpid(client, nullptr, 0);
  CHECK(happens([&] {
    return popcutd.ask("GET", "/metrics").body.find("popcut_sse_clients 0\n") != std::string::npos;
  }));
}

TEST_CASE("any number of connections leaves descriptors for a cut and for stopping it",
          "[popcutd][faults]") {
  constexpr int kLeft = 40;  // docs/api.md
  constexpr int kMany = 90;  // nine seconds, of which the crowd takes one
  RunningDaemon popcutd(8);
  popcutd.open();
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(kMany)));
  const auto port = port_of(popcutd);
  const pid_t pid = popcutd.daemon().pid();
  {
    const TightDescriptors tight(pid, kLeft + 4);
    popcutd.cut(id);
    const std::size_t before = open_files(pid);
    {
      const auto crowd = half_heads(port, 60);
      popcutd.act(id, "pause");
      popcutd.await_state(id, "paused");
      CHECK(open_files(pid) < before + 20);
    }
    // They are gone, and with them what was refused meanwhile.
    CHECK(happens([&] { return popcutd.ask("GET", "/v1/devices").status == 200; }));
    popcutd.act(id, "resume");
    popcutd.await_state(id, "done");
  }
  CHECK(lines_cut(popcutd.daemon().folder() / "trace", kMany).size() == kMany);
  CHECK(is_served(port));
}

// UBSan asks a pipe whether an object can be read: without descriptors it calls each one broken.
#ifndef __SANITIZE_ADDRESS__
TEST_CASE("connections that arrive when all descriptors are used wait and are served later",
          "[popcutd][faults]") {
  RunningDaemon popcutd(20, "header_s = 2\n");
  popcutd.open();
  const std::string id = popcutd.ready_job(popcutd.design(RunningDaemon::lines_svg(30)));
  const auto port = port_of(popcutd);
  popcutd.act(id, "arm", {{"sheet", 1}});
  const Json armed = popcutd.job(id);
  const auto start = [&] { return popcutd.api().act(armed, "start", {{"sheet", 1}}); };
  {
    // One for the connection, none for the records of the cut: it is not begun, and nothing failed.
    const TightDescriptors tight(popcutd.daemon().pid(), 1);
    const auto refused = start();
    REQUIRE(!refused);
    CHECK(message(refused.error()).find("no free file descriptor") != std::string::npos);
  }
  CHECK(popcutd.get("/readyz")["ready"] == true);
  for (const char* records : {"/intents", "/witnesses"})
    CHECK(std::filesystem::is_empty(popcutd.daemon().state() + records));
  {
    // None is left for anybody else; the cut's trace may be lost, its ledger may not.
    const TightDescriptors tight(popcutd.daemon().pid(), 4);
    CHECK(happens([&] { return start().has_value(); }));
    const auto crowd = half_heads(port, 40);
    popcutd.await_state(id, "done");
  }
  CHECK(is_served(port));
  const Json ledger = popcutd.ledger(id);
  CHECK(ledger.value("certain_upto", -1) == 29);
  CHECK(ledger.value("not_sent", Json::array({1})).empty());
}
#endif

}  // namespace faults_network_test
