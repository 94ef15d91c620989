// SPDX-License-Identifier: MIT
// Each place where a request takes much memory, failing once: it is answered, or refused with 503.
// Small pieces are let through: nlohmann 3.11 takes some in the destructor of a value, which ends
// the program when there is none.
#include <atomic>
#include <cstdlib>
#include <new>

#include <catch2/catch.hpp>

#include "daemon/http/api/dispatch.hpp"
#include "daemon/http/api/target.hpp"
#include "daemon/http/wire.hpp"
#include "tests/support/raw_http.hpp"

namespace {

// The number of allocations of this thread until one fails; below zero: none does. Only those of
// `least_bytes` and more count.
thread_local long allocations_left = -1;
thread_local std::size_t least_bytes = 1024;

// The same for one allocation of any thread that is as large as a connection.
constexpr std::size_t kConnectionBytes = 16'384;
std::atomic<int> connections_to_fail{0};

bool is_to_fail(std::size_t size) {
  if (size >= kConnectionBytes && connections_to_fail > 0) {
    --connections_to_fail;
    return true;
  }
  return size >= least_bytes && allocations_left >= 0 && allocations_left-- == 0;
}

}  // namespace

void* operator new(std::size_t size) {
  if (is_to_fail(size)) throw std::bad_alloc();
  void* const memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
// Both forms: the sanitizers' own would not match the deletes below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (is_to_fail(size)) return nullptr;
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace popcut::daemon;
using namespace popcut::daemon::http;

namespace {

// The status of the answer, 0 if there was none; `failed` tells whether memory failed meanwhile.
int status_when(long fails_at, ServiceForHttp& http, const Request& request, const Route& route,
                bool& failed) {
  const HandlerContext context;
  int status = 0, answers = 0;
  const Reply reply([&](const Response& response) {
    status = response.status;
    ++answers;
  });
  http.ask([&](LiveService&) {
    allocations_left = fails_at;
    dispatch(request, route, http.service(), context, reply);
    failed = allocations_left < 0;
    allocations_left = -1;
  });
  return answers == 1 ? status : 0;
}

Request request_for(Method method, const std::string& target, const std::string& body) {
  Request request;
  request.method = method;
  request.target = target;
  request.id = "01JREQUEST";
  request.body = body;
  request.principal = {"token:admin", Role::Admin};
  return request;
}

}  // namespace

TEST_CASE("a request for which there is no memory is refused and answered once",
          "[daemon][http][memory]") {
  ServiceForHttp http;
  const std::string id = http.bench.ready_job().id, job = "/v1/jobs/" + id;
  for (int i = 0; i < 60; ++i) REQUIRE(http.bench.create(http.design()));
  const std::vector<std::pair<Request, int>> requests{
      {request_for(
           Method::Post, "/v1/jobs",
           R"({"design":")" + http.design() + R"(","note":")" + std::string(1500, 'n') + R"("})"),
       201},
      {request_for(Method::Post, job + "/actions/arm", R"({"sheet":1})"), 200},
      {request_for(Method::Post, job + "/actions/arm",
                   R"({")" + std::string(1900, 's') + R"(":1})"),
       422},
      {request_for(Method::Get, job, ""), 200},
      {request_for(Method::Get, "/v1/jobs", ""), 200},
  };
  long number = 0;
  for (const auto& [made, status] : requests) {
    CAPTURE(made.target);
    Request request = made;
    const Match match = find_route(request.method, read_target(request.target)->segments);
    request.params = match.params;
    bool failed = true;
    long refused = 0;
    for (long n = 0; failed && n < 100'000; ++n) {
      // Each request is new, and finds the job as the first one did.
      const Job now = http.bench.job(id);
      if (now.state == JobState::Armed) REQUIRE(http.bench.act(id, JobAction::Disarm));
      request.headers = {{"idempotency-key", "0123456789abcdef" + std::to_string(++number)},
                         {"if-match", "\"" + std::to_string(http.bench.job(id).rev) + "\""}};
      const int got = status_when(n, http, request, *match.route, failed);
      if (failed && got != 503 && got != status) FAIL("allocation " << n << " gave " << got);
      refused += got == 503 ? 1 : 0;
    }
    CHECK_FALSE(failed);
    CHECK(refused > 0);
  }
}

TEST_CASE("reading a request survives failed allocations", "[daemon][http][memory]") {
  const std::string bytes =
      "POST /v1/jobs HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"
      "3\r\nabc\r\n0\r\n\r\n";
  const RequestReader::Sink sink = [](std::string_view) { return std::optional<Problem>{}; };
  least_bytes = 1;
  bool failed = true;
  long n = 0;
  for (; failed && n < 10'000; ++n) {
    allocations_left = n;
    try {
      RequestReader reader(8192);
      reader.append(bytes);
      const bool has_head = reader.read_head().value_or(false);
      const bool has_body = has_head && reader.read_body(100, sink).value_or(false);
      failed = allocations_left < 0;
      allocations_left = -1;
      CHECK((has_body || failed));
    } catch (const std::bad_alloc&) {
      allocations_left = -1;
    }
  }
  least_bytes = 1024;
  CHECK_FALSE(failed);
  CHECK(n > 5);
}

TEST_CASE("a client for whom there is no memory is turned away and the next one is served",
          "[daemon][http][memory]") {
  LiveServer server;
  connections_to_fail = 1;
  RawConnection unlucky(server.port());
  CHECK(unlucky.closes());
  CHECK(connections_to_fail == 0);
  CHECK(server.fetch("GET", "/healthz").status == 200);
}
