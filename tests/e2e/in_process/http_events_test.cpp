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

}  // namespace

TEST_CASE("a stream begins with a snapshot and continues with events", "[daemon][http][events]") {
  LiveServer server;
  const std::string job = server.bench.ready_job().id;
  server.tell(job, 3);
  const std::int64_t seen = server.last_event();
  RawConnection connection = server.connect();
  const std::string head = open_stream(server, connection);
  CHECK(head.find("200 OK") != std::string::npos);
  CHECK(head.find("Content-Type: text/event-stream") != std::string::npos);
  const std::string first = connection.receive_until("\"more\":false}\n\n");
  CHECK(first.starts_with(
      fmt::format("event: reset\ndata: {{\"seq\":{0}}}\n\nid: {0}\nevent: snapshot\n", seen)));
  CHECK(first.find("load sheet 1 of 2") != std::string::npos);
  server.tell(job, 1);
  const std::string frame = connection.receive_until("\n\n");
  CHECK(frame.starts_with(
      fmt::format("id: {0}\nevent: job\ndata: "
                  "{{\"seq\":{0},\"kind\":\"job\",\"job\":\"{1}\",\"state\":\"ready\","
                  "\"rev\":",
                  seen + 1, job)));
  CHECK(count(frame, "\"time\":\"") == 1);
  CHECK(frame.ends_with("}\n\n"));
  server.bench.started(job);
  server.bench.cutters.progress(server.bench.device, {.phase = popcut::SessionPhase::Held});
  const std::string progress = "event: progress\ndata: {\"seq\":0";
  CHECK(connection.receive_until(progress).ends_with("\n\n" + progress));
}

TEST_CASE("a stream resumes after the last event that the client saw", "[daemon][http][events]") {
  LiveServer server;
  const std::string job = server.bench.ready_job().id;
  const std::int64_t begin = server.last_event();
  server.tell(job, 1000);
  RawConnection connection = server.connect();
  open_stream(server, connection, fmt::format("Last-Event-ID: {}\r\n", begin + 400));
  server.tell(job, 20);
  const std::string all = connection.receive_until(fmt::format("id: {}\n", begin + 1020));
  CHECK(count(all, "event: job") == 619);
  for (std::int64_t seq = begin + 401; seq <= begin + 1020; ++seq)
    if (count(all, fmt::format("id: {}\n", seq)) != 1) FAIL("event " << seq);
  CHECK(all.find("reset") == std::string::npos);
}

TEST_CASE("a stream that was interrupted too long begins again with a snapshot",
          "[daemon][http][events]") {
  LiveServer server;
  server.tell(server.bench.ready_job().id, 100);
  const std::int64_t last = server.last_event(), kept = last - 50;
  server.ask([&](LiveService&) {
    server.bench.store().database().run("DELETE FROM event WHERE seq<?", kept);
  });
  const auto open = [&](RawConnection& connection, const std::string& seen) {
    open_stream(server, connection, "Last-Event-ID: " + seen + "\r\n");
  };
  for (const std::string& seen :
       {std::to_string(kept - 2), std::to_string(last + 1), std::string("nonsense"),
        std::string("-1"), std::string("99999999999999999999")}) {
    CAPTURE(seen);
    RawConnection connection = server.connect();
    open(connection, seen);
    CHECK(connection.receive_until("\n\n") ==
          fmt::format("event: reset\ndata: {{\"seq\":{}}}\n\n", last));
  }
  RawConnection connection = server.connect();
  open(connection, std::to_string(kept - 1));
  CHECK(connection.receive_until("\n\n").starts_with(fmt::format("id: {}\n", kept)));
}

TEST_CASE("an event that is heard as it happens comes with the job or the device as it is",
          "[daemon][http][events]") {
  LiveServer server;
  const std::string job = server.bench.ready_job().id;
  const auto act = [&](const std::string& action) {
    server.ask([&](LiveService& service) {
      const std::string& id = server.bench.device;
      const std::int64_t now = service.devices.find(id).value().rev;
      service.devices.act(server.bench.admin, id, now, {.action = action}).value();
    });
  };
  // The job waits for a cutter that is disabled: there is a way to go on.
  act("disable");
  server.ask([&](LiveService& service) {
    const JobPatch wanted{.device = server.bench.device};
    const std::int64_t now = service.jobs.brief(job).value().rev;
    service.jobs.patch(server.bench.tutor, job, now, wanted).value();
  });
  server.put_texts(job, "a\nb\u2028\"<script>", "");
  const std::string large = server.bench.ready_job().id;
  server.put_texts(large, "", std::string(13'000, 'x'));
  RawConnection connection = server.connect();
  open_stream(server, connection);
  const std::string first = connection.receive_until("\"more\":false}\n\n");
  const std::string data = first.substr(first.rfind("data: ") + 6);
  CHECK(nlohmann::json::parse(data).at("now").get<std::string>().ends_with("Z"));
  const std::int64_t begin = server.last_event();
  const auto next = [&] {
    const std::string frame = connection.receive_until("\n\n");
    CHECK(count(frame, "\ndata: ") == 1);
    return nlohmann::json::parse(frame.substr(frame.find("data: ") + 6));
  };
  const auto get = [&](const std::string& path) {
    return nlohmann::json::parse(server.fetch("GET", path, "viewer").body);
  };
  const auto shown = [&] {
    auto whole = get("/v1/jobs/" + job);
    CHECK(whole.contains("ways"));
    whole.erase("ways");
    return whole;
  };
  const std::int64_t rev = server.bench.job(job).rev;
  server.tell(job, 1);
  const auto of_job = next();
  CHECK(of_job.at("whole") == shown());
  CHECK(of_job.at("now").get<std::string>().ends_with("Z"));
  CHECK(of_job.at("rev") == rev + 1);
  server.ask([&](LiveService& service) { service.jobs.move(server.bench.tutor, job, "").value(); });
  CHECK(next().at("kind") == "job");
  const auto of_queue = next();
  CHECK(of_queue.at("kind") == "queue");
  CHECK(of_queue.at("whole") == shown());
  act("enable");
  CHECK(next().at("whole") == get("/v1/devices/sim:cameo3"));
  // What is gone, or too much, or not to be had now, is left out; the event is not.
  server.ask(
      [&](LiveService&) { server.devices().fault = [] { throw std::runtime_error("not now"); }; });
  act("disable");
  CHECK_FALSE(next().contains("whole"));
  server.tell(large, 1);
  CHECK_FALSE(next().contains("whole"));
  server.bench.act(large, JobAction::Cancel).value();
  server.ask(
      [&](LiveService& service) { REQUIRE(service.jobs.remove(server.bench.tutor, large)); });
  auto gone = next();
  while (!gone.contains("deleted")) gone = next();
  CHECK_FALSE(gone.contains("whole"));
  // Missed events come as they were stored.
  RawConnection later = server.connect();
  open_stream(server, later, fmt::format("Last-Event-ID: {}\r\n", begin));
  const std::string missed = later.receive_until(fmt::format("id: {}\n", server.last_event()));
  CHECK(count(missed, "event: ") >= 5);
  CHECK(count(missed, "whole") == 0);
}

TEST_CASE("a stream that is slow loses no event to jobs that are long", "[daemon][http][events]") {
  LiveServer server;
  const std::string job = server.bench.ready_job().id;
  server.put_texts(job, "", std::string(8000, 'x'));
  RawConnection slow = server.connect();
  slow.shrink_buffer(4096);
  open_stream(server, slow);
  CHECK(slow.receive_until("\"more\":false}\n\n").starts_with("event: reset"));
  constexpr int kEvents = 200;
  server.tell(job, kEvents);
  const std::string all = slow.receive_until(fmt::format("\"seq\":{},", server.last_event()));
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
  const std::string job = server.bench.ready_job().id;
  server.tell(job, 800);
  std::atomic<bool> ends{false};
  std::thread teller([&] {
    while (!ends) {
      server.tell(job, 3);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  });
  std::string wrong;
  for (int round = 0; round < 20 && wrong.empty(); ++round) {
    RawConnection connection = server.connect();
    // Sometimes nothing was missed, sometimes several pages.
    const std::int64_t last = server.last_event(), after = last - round * 40;
    open_stream(server, connection, fmt::format("Last-Event-ID: {}\r\n", after));
    for (std::int64_t seq = after + 1; seq < last + 200 && wrong.empty(); ++seq) {
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
  const std::string job = server.bench.ready_job().id;
  server.put_texts(job, "", std::string(8000, 'x'));
  RawConnection deaf = server.connect();
  deaf.shrink_buffer(2048);
  open_stream(server, deaf);
  RawConnection good = server.connect();
  open_stream(server, good);
  (void)good.receive_until("snapshot");
  const std::int64_t begin = server.last_event();
  // Far more than what the kernel keeps between the two.
  for (int i = 0; i < 200; ++i) {
    server.tell(job, 4);
    const std::string got = good.receive_until(fmt::format("id: {}\n", begin + (i + 1) * 4));
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
  const std::string job = server.bench.ready_job().id;
  server.put_texts(job, "", std::string(8000, 'x'));
  RawConnection slow = server.connect();
  slow.shrink_buffer(4096);
  open_stream(server, slow);
  (void)slow.receive_until("snapshot");
  for (int i = 0; i < 100; ++i) server.tell(job, 8);
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
  server.tell(server.bench.ready_job().id, 5);
  const std::int64_t last = server.last_event();
  const WireResponse list =
      server.fetch("GET", fmt::format("/v1/events?after={}&limit=2", last - 3), "viewer");
  CHECK(list.status == 200);
  CHECK(list.headers.at("content-type") == "application/json");
  CHECK(count(list.body, "\"seq\":") == 2);
  CHECK(list.body.find(fmt::format(R"("first_seq":1,"last_seq":{}}})", last)) != std::string::npos);
  CHECK(server.fetch("GET", "/v1/events?after=x", "viewer").status == 422);
  CHECK(server.fetch("GET", "/v1/events?limit=0", "viewer").status == 422);
}

TEST_CASE("a token that is deleted ends its streams", "[daemon][http][events]") {
  LiveServer server([](HttpOptions& options) { options.limits.heartbeat_s = 0.05; });
  RawConnection connection = server.connect();
  open_stream(server, connection);
  CHECK(connection.receive_until(":\n\n:\n\n").find("snapshot") != std::string::npos);
  CHECK(server.fetch("DELETE", "/v1/tokens/" + server.token_id("viewer")).status == 204);
  CHECK(connection.closes());
}

}  // namespace http_events_test
