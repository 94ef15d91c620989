// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/http_client.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/fault_page.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/received_log.hpp"
#include "tests/support/rounds.hpp"

namespace disk_full_test {

using namespace popcut;
using namespace popcut::testing;
using client::HttpClient;
using client::HttpResponse;
using nlohmann::json;
using std::chrono::steady_clock;

namespace {

constexpr int kLines = 12;

/// Another drawing for each number, so that none is there already.
std::string design_svg(std::uint64_t number) {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='200mm' height='200mm' viewBox='0 0 200 200'>";
  svg += fmt::format("<!-- {} -->", number);
  for (int k = 0; k < kLines; ++k)
    svg += fmt::format("<path fill='none' stroke='black' d='M{},{}h5'/>", 10 + k % 4 * 12,
                       10 + k / 4 * 12);
  return svg + "</svg>";
}

/// Several disks at once fill up, each on a thread of its own, where Catch's assertions may not be.
void must(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error(what);
}

/// One job from the upload to its end, while the disk is full from some write on.
class FullDisk {
 public:
  FullDisk()
      : daemon_(popcutd_program(), 0),
        page_((daemon_.folder() / "control").string()),
        machine_(*find_machine("cameo3")) {
    page_.calm();
    must(daemon_.start(page_.environment()), "popcutd does not start: " + daemon_.log());
    const auto address = client::parse_address("unix:" + daemon_.socket());
    http_ = std::make_unique<HttpClient>(std::vector<client::Address>{*address}, "");
  }

  /// The writes of one job on a disk with room.
  std::uint64_t writes_of_a_job() {
    const std::uint64_t before = page_->disk;
    must(run_job() == "done", "a job on a disk with room is done");
    return page_->disk - before;
  }

  /// The state that the job ended in, with the disk full from its n-th write until it stood still.
  std::string run_job_full_from(std::uint64_t n) {
    page_->full_until = 0;
    page_->full_from = page_->disk + n;
    return run_job();
  }

  void check_cut_once() {
    for (const Received& one : received_log(daemon_.folder() / "trace/received.log")) {
      const auto places = places_cut(one.bytes, machine_);
      must(std::set<std::string>(places.begin(), places.end()).size() == places.size(),
           "a stroke was cut twice on one sheet");
    }
  }

  std::map<int, int> refusals{};  ///< by status

 private:
  HttpResponse ask(const std::string& method, const std::string& target, const std::string& body,
                   const std::string& type, std::int64_t rev = -1) {
    client::HttpRequest request;
    request.method = method;
    request.target = target;
    request.body = body;
    request.content_type = type;
    if (method == "POST") request.headers.emplace_back("Idempotency-Key", client::random_key());
    if (rev >= 0) request.headers.emplace_back("If-Match", fmt::format("\"{}\"", rev));
    const auto answer = http_->ask(std::move(request));
    must(answer.has_value(), answer ? "" : message(answer.error()));
    return *answer;
  }

  /// Asks until it is done; a full disk is the only reason why it may not be, and then there is
  /// room again, and without a restart it is done.
  json insist(const std::string& target, const std::string& body, const std::string& type,
              std::int64_t rev = -1) {
    const auto begun = steady_clock::now();
    for (;;) {
      const HttpResponse answer = ask("POST", target, body, type, rev);
      const std::string said = fmt::format("{} {} {}", target, answer.status, answer.body);
      if (answer.status < 300) return json::parse(answer.body);
      ++refusals[answer.status];
      const json problem = json::parse(answer.body);
      if (answer.status == 412 || answer.status == 409) return {};  // look again at the job
      must(answer.status == 507 || answer.status == 503, said);
      must(answer.content_type.find("application/problem+json") == 0, said);
      // What only looks goes on as ever.
      must(ask("GET", "/v1/jobs", "", "").status == 200, "the list cannot be read");
      must(std::chrono::duration<double>(steady_clock::now() - begun).count() < 120, said);
      page_->full_from = 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  std::string run_job() {
    const json design = insist("/v1/designs?name=lines", design_svg(++number_), "image/svg+xml");
    const json created =
        insist("/v1/jobs", json{{"design", design["id"]}, {"options", {{"order", "keep"}}}}.dump(),
               "application/json");
    const std::string id = created["id"];
    accepted_.insert(id);
    const std::string path = "/v1/jobs/" + id;
    const auto begun = steady_clock::now();
    std::string state;
    bool mended = false;
    for (;;) {
      const HttpResponse answer = ask("GET", path, "", "");
      must(answer.status == 200, answer.body);
      const json job = json::parse(answer.body);
      state = job["state"];
      const std::int64_t rev = job["rev"];
      const std::string sheet = json{{"sheet", job["sheet"]}}.dump();
      if (state == "ready")
        insist(path + "/actions/arm", sheet, "application/json", rev);
      else if (state == "armed")
        insist(path + "/actions/start", sheet, "application/json", rev);
      else if (state == "done" || state == "cancelled" || state == "failed")
        break;
      else if (state == "interrupted") {
        check_ledger(id, job["plan"]);
        page_->full_from = 0;
        mended = true;
        insist(path + "/actions/retry-sheet", sheet, "application/json", rev);
      }
      // A cut that ends, or a plan that waits, for want of room: somebody makes some.
      if (std::chrono::duration<double>(steady_clock::now() - begun).count() > 0.3)
        page_->full_from = 0;
      must(std::chrono::duration<double>(steady_clock::now() - begun).count() < 120,
           "stuck: " + answer.body);
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
    page_->full_from = 0;
    for (const std::string& one : accepted_)
      must(ask("GET", "/v1/jobs/" + one, "", "").status == 200, "an accepted job is lost");
    if (accepted_.size() > 20) accepted_.erase(accepted_.begin());
    return mended ? state + " on a second sheet" : state;
  }

  /// What was cut is certain or in doubt.
  void check_ledger(const std::string& id, const json&) {
    const HttpResponse answer = ask("GET", "/v1/jobs/" + id + "/sheets/1/ledger", "", "");
    must(answer.status == 200, answer.body);
    const json ledger = json::parse(answer.body);
    const std::set<int> not_sent = members_of(ledger["not_sent"]);
    // It may have ended before anything was sent.
    std::size_t cut = 0;
    for (const Received& one : received_log(daemon_.folder() / "trace/received.log"))
      if (one.attempt == ledger["attempts"].back()["id"])
        cut = places_cut(one.bytes, machine_).size();
    must(cut + not_sent.size() <= static_cast<std::size_t>(kLines),
         "what was cut is called not sent: " + answer.body);
  }

  DaemonProcess daemon_;
  FaultPage page_;
  Machine machine_;
  std::unique_ptr<HttpClient> http_;
  std::set<std::string> accepted_;
  std::uint64_t number_{};
};

}  // namespace

TEST_CASE("a disk that is full at any write of a job stops new work but never a running cut",
          "[daemon][disk][alone]") {
  constexpr std::uint64_t kAtOnce = 8;
  // Each write in ./run soak calls.
  const auto in_suite = static_cast<std::uint64_t>(testing::step_of(3, 7)) * kAtOnce;
  const std::uint64_t step = std::getenv("POPCUT_EVERY_CALL") == nullptr ? in_suite : kAtOnce;
  std::mutex mutex;
  std::map<std::string, int> ends;
  std::map<int, int> refusals;
  std::vector<std::string> wrong;
  std::atomic<std::uint64_t> writes{0};
  const auto fill = [&](std::uint64_t first) {
    std::uint64_t n = first;
    try {
      FullDisk disk;
      const std::uint64_t own = disk.writes_of_a_job();
      if (first == 1) writes = own;
      std::map<std::string, int> own_ends;
      for (; n <= own + kAtOnce; n += step) ++own_ends[disk.run_job_full_from(n)];
      disk.check_cut_once();
      const std::lock_guard lock(mutex);
      for (const auto& [end, count] : own_ends) ends[end] += count;
      for (const auto& [status, count] : disk.refusals) refusals[status] += count;
    } catch (const std::exception& fault) {
      const std::lock_guard lock(mutex);
      wrong.push_back(fmt::format("at write {}: {}", n, fault.what()));
    }
  };
  std::vector<std::thread> threads;
  for (std::uint64_t k = 1; k <= kAtOnce; ++k) threads.emplace_back(fill, k);
  for (std::thread& thread : threads) thread.join();
  for (const std::string& what : wrong) FAIL_CHECK(what);
  CHECK(writes > 50);
  std::printf("full from each of %llu writes of a job on:",
              static_cast<unsigned long long>(writes.load()));
  for (const auto& [end, count] : ends) {
    std::printf(" %d %s;", count, end.c_str());
    CHECK(end.rfind("done", 0) == 0);
  }
  for (const auto& [status, count] : refusals) std::printf(" %d x %d;", count, status);
  std::printf("\n");
  CHECK(refusals[507] > 0);
}

}  // namespace disk_full_test
