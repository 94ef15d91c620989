// SPDX-License-Identifier: MIT
// The event stream: resuming, resets, slow readers.
#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/raw_http.hpp"

namespace http_events_test {

using namespace popcut::daemon;

namespace {

std::string open_stream(LiveServer& server, RawConnection& connection, const std::string& more = "",
                        const char* token = "viewer") {
  connection.send(
      server.request("GET", "/v1/events", token, "Accept: text/event-stream\r\n" + more));
  return connection.receive_until("\r\n\r\n");
}

int count(std::string_view text, std::string_view word) {
  int found = 0;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1))
    ++found;
  return found;
}

void tell(LiveServer& server, int times, std::size_t bytes = 10) {
  server.ask([&](FakeService& fake) {
    for (int i = 0; i < times; ++i)
      fake.tell("job", "01J", fmt::format(R"("rev":1,"text":"{}")", std::string(bytes, 'x')));
  });
}

}  // namespace

TEST_CASE("a stream begins with a snapshot and continues with events", "[daemon][http][events]") {
  LiveServer server;
  server.ask([](FakeService& fake) { fake.add_job(JobState::Ready, "token:submitter"); });
  tell(server, 3);
  RawConnection connection = server.connect();
  const std::string head = open_stream(server, connection);
  CHECK(head.find("200 OK") != std::string::npos);
  CHECK(head.find("Content-Type: text/event-stream") != std::string::npos);
  const std::string first = connection.receive_until("\"more\":false}\n\n");
  CHECK(first.starts_with("event: reset\ndata: {\"seq\":3}\n\nid: 3\nevent: snapshot\n"));
  CHECK(first.find("load sheet 1 of 2") != std::string::npos);
  tell(server, 1);
  CHECK(connection.receive_until("\n\n") ==
        "id: 4\nevent: job\ndata: {\"seq\":4,\"kind\":\"job\",\"job\":\"01J\",\"rev\":1,"
        "\"text\":\"xxxxxxxxxx\",\"time\":\"2026-11-21T10:00:00.123Z\"}\n\n");
  server.ask([](FakeService& fake) { fake.tell_progress("01J", R"("paths_sent":7)"); });
  CHECK(connection.receive_until("\n\n").starts_with("event: progress\ndata: {\"seq\":0"));
}

TEST_CASE("a stream resumes after the last event that the client saw", "[daemon][http][events]") {
  LiveServer server;
  tell(server, 1000);
  RawConnection connection = server.connect();
  open_stream(server, connection, "Last-Event-ID: 400\r\n");
  tell(server, 20);
  const std::string all = connection.receive_until("id: 1020\n");
  CHECK(count(all, "event: job") == 619);
  for (int seq = 401; seq <= 1020; ++seq)
    if (count(all, fmt::format("id: {}\n", seq)) != 1) FAIL("event " << seq);
  CHECK(all.find("reset") == std::string::npos);
}

TEST_CASE("a stream that was interrupted too long begins again with a snapshot",
          "[daemon][http][events]") {
  LiveServer server;
  tell(server, 100);
  server.ask([](FakeService& fake) { fake.first_kept = 50; });
  for (const char* seen :
       {"Last-Event-ID: 48\r\n", "Last-Event-ID: 101\r\n", "Last-Event-ID: nonsense\r\n",
        "Last-Event-ID: -1\r\n", "Last-Event-ID: 99999999999999999999\r\n"}) {
    CAPTURE(seen);
    RawConnection connection = server.connect();
    open_stream(server, connection, seen);
    CHECK(connection.receive_until("\n\n") == "event: reset\ndata: {\"seq\":100}\n\n");
  }
  RawConnection connection = server.connect();
  open_stream(server, connection, "Last-Event-ID: 49\r\n");
  CHECK(connection.receive_until("\n\n").starts_with("id: 50\n"));
}

TEST_CASE("an event that is heard as it happens comes with the job or the device as it is",
          "[daemon][http][events]") {
  LiveServer server;
  std::string job, large;
  server.ask([&](FakeService& fake) {
    job = fake.add_job(JobState::Ready, "token:submitter").id;
    fake.job_map.at(job).name = "a\nb\u2028\"<script>";
    fake.job_map.at(job).next_actions = {{.action = "retry-sheet"}};
    Job& long_one = fake.add_job(JobState::Ready, "token:submitter");
    large = long_one.id;
    long_one.note = std::string(13'000, 'x');
  });
  RawConnection connection = server.connect();
  open_stream(server, connection);
  const std::string first = connection.receive_until("\"more\":false}\n\n");
  const std::string data = first.substr(first.rfind("data: ") + 6);
  CHECK(nlohmann::json::parse(data).at("now").get<std::string>().ends_with("Z"));
  const auto heard = [&](const std::function<void(FakeService&)>& happens) {
    server.ask(happens);
    const std::string frame = connection.receive_until("\n\n");
    CHECK(count(frame, "\ndata: ") == 1);
    return nlohmann::json::parse(frame.substr(frame.find("data: ") + 6));
  };
  const auto of_job = heard([&](FakeService& fake) { fake.tell("job", job, R"("rev":2)"); });
  auto shown = nlohmann::json::parse(server.fetch("GET", "/v1/jobs/" + job, "viewer").body);
  CHECK(shown.contains("ways"));
  shown.erase("ways");
  CHECK(of_job.at("whole") == shown);
  CHECK(of_job.at("now").get<std::string>().ends_with("Z"));
  CHECK(of_job.at("rev") == 2);
  CHECK(heard([&](FakeService& fake) { fake.tell("queue", job, R"("held":true)"); }).at("whole") ==
        shown);
  const auto of_device = heard([](FakeService& fake) {
    fake.tell("device", "", R"("device":"sim:cameo3","state":"idle","rev":1)");
  });
  CHECK(of_device.at("whole") ==
        nlohmann::json::parse(server.fetch("GET", "/v1/devices/sim:cameo3", "viewer").body));
  // What is gone, or too much, or not to be had now, is left out; the event is not.
  for (const std::string& id : {std::string("01JD0000000000000000000000"), large})
    CHECK_FALSE(heard([&](FakeService& fake) {
                  fake.tell("job", id, R"("deleted":true)");
                }).contains("whole"));
  for (const char* odd : {R"("device":"gone")", R"("device":7)", R"("x":1)"})
    CHECK_FALSE(heard([&](FakeService& fake) { fake.tell("device", "", odd); }).contains("whole"));
  // Missed events come as they were stored.
  RawConnection later = server.connect();
  open_stream(server, later, "Last-Event-ID: 0\r\n");
  const std::string missed = later.receive_until("id: 7\n");
  CHECK(count(missed, "event: ") >= 6);
  CHECK(count(missed, "whole") == 0);
}

TEST_CASE("a stream that is slow loses no event to jobs that are long", "[daemon][http][events]") {
  LiveServer server;
  std::string job;
  server.ask([&](FakeService& fake) {
    job = fake.add_job(JobState::Ready, "token:submitter").id;
    fake.job_map.at(job).note = std::string(8000, 'x');
  });
  RawConnection slow = server.connect();
  slow.shrink_buffer(4096);
  open_stream(server, slow);
  CHECK(slow.receive_until("\"more\":false}\n\n").starts_with("event: reset"));
  constexpr int kEvents = 200;
  server.ask([&](FakeService& fake) {
    for (int i = 0; i < kEvents; ++i) fake.tell("job", job, fmt::format(R"("rev":{})", i));
  });
  const std::string all = slow.receive_until(fmt::format("\"seq\":{},", kEvents));
  CHECK(all.find("overflow") == std::string::npos);
  CHECK(count(all, "event: job") == kEvents);
  CHECK(count(all, "\"whole\"") > 5);
  CHECK(count(all, "\"whole\"") < kEvents);
}

TEST_CASE("a stream with an invalid query is refused", "[daemon][http][events]") {
  LiveServer server;
  for (const char* query : {"?after=abc", "?after=-1", "?aftr=3", "?limit=0"}) {
    CAPTURE(query);
    CHECK(server
              .fetch("GET", std::string("/v1/events") + query, "viewer",
                     "Accept: text/event-stream\r\n")
              .problem() == "validation");
  }
}

TEST_CASE("no event is lost or doubled while clients come and go", "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.stream_events = 1'000'000;
    options.limits.stream_bytes = std::size_t{1} << 30;
  });
  std::atomic<bool> ends{false};
  std::thread teller([&] {
    while (!ends) {
      tell(server, 3);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  std::string wrong;
  for (int round = 0; round < 20 && wrong.empty(); ++round) {
    RawConnection connection = server.connect();
    std::int64_t after = 0;
    server.ask([&](FakeService& fake) {
      // Sometimes nothing was missed, sometimes several pages.
      after = std::max<std::int64_t>(fake.operations.last_event() - round * 40, 0);
    });
    open_stream(server, connection, fmt::format("Last-Event-ID: {}\r\n", after));
    for (std::int64_t seq = after + 1; seq < after + 1000 && wrong.empty(); ++seq) {
      const std::string frame = connection.receive_until("\n\n");
      if (!frame.starts_with(fmt::format("id: {}\n", seq)))
        wrong = fmt::format("{}: {}", seq, frame);
    }
  }
  ends = true;
  teller.join();
  CHECK(wrong.empty());
}

TEST_CASE("a client that does not read is dropped and delays nobody", "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.stream_events = 16;
    options.limits.body_s = 1;
  });
  RawConnection deaf = server.connect();
  deaf.shrink_buffer(2048);
  open_stream(server, deaf);
  RawConnection good = server.connect();
  open_stream(server, good);
  (void)good.receive_until("snapshot");
  // Far more than what the kernel keeps between the two.
  for (int i = 0; i < 200; ++i) {
    tell(server, 4, 8000);
    const std::string got = good.receive_until(fmt::format("id: {}\n", (i + 1) * 4));
    if (count(got, "overflow") != 0) FAIL("a client that reads was dropped");
  }
  CHECK(comes_true([&] {
    return server.fetch("GET", "/metrics").body.find("popcut_sse_clients 1\n") != std::string::npos;
  }));
  const std::string text = server.fetch("GET", "/metrics").body;
  CHECK(text.find("popcut_sse_dropped_total 0\n") == std::string::npos);
}

TEST_CASE("a client that reads too slowly is asked to reconnect", "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) { options.limits.stream_events = 16; });
  RawConnection slow = server.connect();
  slow.shrink_buffer(4096);
  open_stream(server, slow);
  (void)slow.receive_until("snapshot");
  for (int i = 0; i < 100; ++i) tell(server, 8, 8000);
  const std::string all = slow.receive_until("event: overflow\ndata: {}\n\n");
  CHECK(count(all, "event: overflow") == 1);
  CHECK(slow.closes());
}

TEST_CASE("a stream without events gets heartbeats", "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) { options.limits.heartbeat_s = 0.05; });
  RawConnection connection = server.connect();
  open_stream(server, connection);
  (void)connection.receive_until("\"more\":false}\n\n");
  CHECK(connection.receive_until(":\n\n:\n\n") == ":\n\n:\n\n");
}

TEST_CASE("streams are limited in all and for each person and operators have places of their own",
          "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) { options.limits.streams = 8; });
  std::vector<RawConnection> streams;
  const auto answer = [&](const char* token) {
    streams.push_back(server.connect());
    return open_stream(server, streams.back(), "", token);
  };
  const auto opens = [&](const char* token, int times) {
    for (int i = 0; i < times; ++i) CHECK(answer(token).find("200 OK") != std::string::npos);
  };
  opens("viewer", 4);
  CHECK(answer("viewer").find("503") != std::string::npos);  // half of all
  opens("submitter", 2);
  CHECK(answer("submitter").find("503") != std::string::npos);  // the rest is for operators
  opens("operator", 2);
  CHECK(answer("admin").find("503") != std::string::npos);
  // One that goes makes room, though nothing was sent to it meanwhile.
  streams.pop_back();
  streams.pop_back();
  CHECK(comes_true([&] {
    RawConnection again = server.connect();
    return open_stream(server, again, "", "operator").find("200 OK") != std::string::npos;
  }));
}

TEST_CASE("events are available as a list", "[daemon][http][events]") {
  LiveServer server;
  tell(server, 5);
  const WireResponse list = server.fetch("GET", "/v1/events?after=2&limit=2", "viewer");
  CHECK(list.status == 200);
  CHECK(list.headers.at("content-type") == "application/json");
  CHECK(count(list.body, "\"seq\":") == 2);
  CHECK(list.body.find(R"("first_seq":1,"last_seq":5})") != std::string::npos);
  CHECK(server.fetch("GET", "/v1/events?after=x", "viewer").status == 422);
  CHECK(server.fetch("GET", "/v1/events?limit=0", "viewer").status == 422);
}

TEST_CASE("a token that is deleted ends its streams", "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) { options.limits.heartbeat_s = 0.05; });
  RawConnection connection = server.connect();
  open_stream(server, connection);
  CHECK(connection.receive_until(":\n\n:\n\n").find("snapshot") != std::string::npos);
  CHECK(server.fetch("DELETE", "/v1/tokens/viewer").status == 204);
  CHECK(connection.closes());
}

}  // namespace http_events_test
