// SPDX-License-Identifier: MIT
// What one client can take: limits of number, time and size; who may come over which socket.
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/http/api/page_files.hpp"
#include "tests/support/raw_http.hpp"

namespace http_limits_test {

using namespace popcut::daemon;

namespace {

const std::string kSvg = "Content-Type: image/svg+xml\r\n";

std::string new_job(LiveServer& server, JobState state = JobState::Ready) {
  const std::string id = server.bench.ready_job().id;
  if (state == JobState::Cutting) server.bench.started(id);
  return id;
}

}  // namespace

TEST_CASE("the defaults of all limits are as documented", "[daemon][http][limits]") {
  const HttpLimits limits;
  CHECK(limits.header_bytes == 8192);
  CHECK(limits.json_bytes == 262'144);
  CHECK(limits.json_depth == 32);
  CHECK(limits.design_bytes == 33'554'432);
  CHECK(limits.asset_bytes == 268'435'456);
  CHECK(limits.connections == 64);
  CHECK(limits.streams == 16);
  CHECK(limits.rate_per_s == 20);
  CHECK(limits.rate_burst == 60);
  CHECK(limits.failed_logins_per_minute == 5);
  CHECK(limits.header_s == 10);
  CHECK(limits.body_s == 30);
  CHECK(limits.body_bytes_per_s == 1024);
  CHECK(limits.idle_s == 60);
  CHECK(limits.heartbeat_s == 15);
  CHECK(limits.answer_bytes == 536'870'912);
  CHECK(limits.stream_events == 256);
  CHECK(limits.stream_bytes == 262'144);
}

TEST_CASE("the server enforces the default limits", "[daemon][http][limits]") {
  LiveServer server([](HttpOptions& options) { options.limits = HttpLimits{}; });
  SECTION("a burst of 60 and 20 a second for each principal") {
    RawConnection connection = server.connect();
    std::string all;
    for (int i = 0; i < 400; ++i) all += server.request("GET", "/v1/devices", "viewer");
    const auto begun = std::chrono::steady_clock::now();
    connection.send(all);
    int fine = 0;
    WireResponse last;
    for (int i = 0; i < 400; ++i) {
      last = connection.receive();
      if (last.status != 200) break;
      ++fine;
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    CHECK(fine >= 60);
    CHECK(fine <= 61 + 20 * took.count());
    CHECK(last.status == 429);
    CHECK(last.problem() == "rate");
    CHECK(last.headers.at("retry-after") == "1");
    // Others are not touched by it, and neither is what stops a knife.
    CHECK(server.fetch("GET", "/v1/devices", "operator").status == 200);
    const std::string id = new_job(server, JobState::Cutting);
    CHECK(server.fetch("GET", "/v1/jobs/" + id, "viewer").status == 200);
  }
  SECTION("five failed logins a minute") {
    // Who sends what cannot be read guesses no secret.
    for (const char* body : {"{", "[]", "{}", R"({"one_shot":7})", "{", "{", "{"})
      CHECK(server.fetch("POST", "/v1/session", "", "Content-Type: application/json\r\n", body)
                .status < 423);
    for (int i = 0; i < 5; ++i)
      CHECK(server.fetch("GET", "/v1/jobs", "", "Authorization: Bearer pc_none_0123\r\n").status ==
            401);
    const WireResponse sixth =
        server.fetch("GET", "/v1/jobs", "", "Authorization: Bearer pc_none_0123\r\n");
    CHECK(sixth.status == 429);
    CHECK(std::stoi(sixth.headers.at("retry-after")) <= 60);
    // Who has a token is not locked out by who has none.
    CHECK(server.fetch("GET", "/v1/jobs", "viewer").status == 200);
    CHECK(server
              .fetch("POST", "/v1/session", "", "Content-Type: application/json\r\n",
                     R"({"one_shot":"guessed-word"})")
              .status == 429);
  }
  SECTION("requests and failures of each address and user on their own") {
    const std::string json = "Content-Type: application/json\r\n";
    std::string good;
    server.ask([&](LiveService& service) {
      good = service.access.create_one_shot(server.principal(Role::Operator)).value();
    });
    RawConnection other(server.port(), false);
    // Bad words and none, from one address, until nothing but 429 comes.
    int refused = 0;
    for (int i = 0; i < 200; ++i)
      refused += server.fetch("POST", "/v1/session", "", json, "{}").status == 429 ? 1 : 0;
    int tried = 0;
    for (int i = 0; i < 100; ++i) {
      const int status =
          server.fetch("POST", "/v1/session", "", json, R"({"one_shot":"guess"})").status;
      CHECK((status == 401 || status == 429));
      tried += status == 401 ? 1 : 0;
    }
    CHECK(refused > 0);
    CHECK(tried <= 10);  // five, and one more every twelve seconds
    // Who has a good one comes in.
    CHECK(server.fetch("POST", "/v1/session", "", json, "{\"one_shot\":\"" + good + "\"}").status ==
          201);
    // What is open to all is counted by address: the user of the socket is another one.
    RawConnection many = server.connect();
    std::string all;
    for (int i = 0; i < 400; ++i) all += server.request("GET", "/healthz", "");
    many.send(all);
    int status = 200;
    for (int i = 0; i < 400 && status == 200; ++i) status = many.receive().status;
    CHECK(status == 429);
    RawConnection local(server.socket_path());
    local.send("GET /healthz HTTP/1.1\r\nHost: popcut\r\n\r\n");
    CHECK(local.receive().status == 200);
    // Nobody sends much before it is known who it is.
    CHECK(server.fetch("POST", "/v1/session", "", json, std::string(1025, ' ')).status == 413);
  }
  SECTION("a head of 8 KiB") {
    const std::string head = server.request("GET", "/v1/jobs");
    const std::string filler = "X-Filler: " + std::string(8192 - head.size() - 12, 'x') + "\r\n";
    CHECK(server.fetch("GET", "/v1/jobs", "admin", filler).status == 200);
    CHECK(server.fetch("GET", "/v1/jobs", "admin", "X" + filler).status == 413);
  }
  SECTION("a body of 256 KiB and 32 deep") {
    const std::string deep = R"({"design":)" + std::string(40, '[') + std::string(40, ']') + "}";
    CHECK(server.fetch("POST", "/v1/jobs", "submitter", acting(), deep).problem() ==
          "malformed-json");
    const std::string wide = R"({"design":")" + std::string(262'144 - 13, 'a') + "\"}";
    CHECK(server.fetch("POST", "/v1/jobs", "submitter", acting(), wide).status == 422);
    CHECK(server.fetch("POST", "/v1/jobs", "submitter", acting(), wide + " ").status == 413);
  }
}

TEST_CASE("deeply nested JSON is refused and the server survives", "[daemon][http][limits]") {
  LiveServer server;
  for (const int depth : {33, 1000, 100'000}) {
    const std::string bomb = std::string(static_cast<std::size_t>(depth), '[') +
                             std::string(static_cast<std::size_t>(depth), ']');
    const WireResponse response = server.fetch("POST", "/v1/jobs", "submitter", acting(), bomb);
    CHECK(response.status == 400);
    CHECK(response.problem() == "malformed-json");
  }
  CHECK(server.fetch("GET", "/metrics").body.find("popcut_http_rejected_total{why=\"depth\"} 3") !=
        std::string::npos);
}

TEST_CASE("slow and silent clients lose their connection", "[daemon][http][slow]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.header_s = 0.3;
    options.limits.body_s = 0.3;
    options.limits.idle_s = 0.6;
  });
  SECTION("who says nothing") {
    RawConnection connection = server.connect();
    CHECK(connection.closes());
  }
  SECTION("who sends a head byte by byte") {
    RawConnection connection = server.connect();
    bool is_open = true;
    for (int i = 0; i < 6000 && is_open; ++i) {
      is_open = connection.send(i == 0 ? "GET /healthz HTTP/1.1\r\nX-A: " : "x");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    CHECK_FALSE(is_open);
  }
  SECTION("who sends a body byte by byte") {
    RawConnection connection = server.connect();
    connection.send(
        server.request("POST", "/v1/designs", "submitter", kSvg + "Content-Length: 5000\r\n"));
    bool is_open = true;
    for (int i = 0; i < 6000 && is_open; ++i) {
      is_open = connection.send("x");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    CHECK_FALSE(is_open);
    CHECK(comes_true([&] { return server.spools() == 0; }));
  }
  SECTION("who keeps a connection and asks nothing") {
    RawConnection connection = server.connect();
    connection.send(server.request("GET", "/healthz", ""));
    CHECK(connection.receive().status == 200);
    CHECK(connection.closes());
  }
  SECTION("a body that comes slowly and fast enough is read") {
    LiveServer patient([](HttpOptions& options) {
      options.limits.body_s = 0.3;
      options.limits.body_bytes_per_s = 10;
    });
    RawConnection connection = patient.connect();
    const std::string head =
        patient.request("POST", "/v1/designs", "submitter", kSvg + "Content-Length: 8192\r\n");
    for (int i = 0; i < 8; ++i) {
      CHECK(connection.send((i == 0 ? head : "") + std::string(1024, 'x')));
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
    CHECK(connection.receive().status == 201);
  }
}

TEST_CASE("an upload that was quick at first may not be slow ever after", "[daemon][http][slow]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.body_s = 0.3;
    options.limits.upload_s = 1.2;
  });
  const auto begin = [&] {
    RawConnection connection = server.connect();
    connection.send(
        server.request("POST", "/v1/designs", "submitter",
                       "Content-Type: application/dxf\r\nContent-Length: 33000000\r\n"));
    return connection;
  };
  SECTION("a megabyte at once, which would be a credit of seventeen minutes") {
    RawConnection connection = begin();
    CHECK(connection.send(std::string(1 << 20, 'x')));
    CHECK(connection.closes(20));
  }
  SECTION("quick enough, but without end") {
    RawConnection connection = begin();
    const auto begun = std::chrono::steady_clock::now();
    const std::string piece(2048, 'x');
    while (connection.send(piece) && popcut::testing::seconds_since(begun) < 120)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    CHECK(popcut::testing::seconds_since(begun) < 120);
    CHECK(popcut::testing::seconds_since(begun) > 1);  // ten times what it needs to be quick enough
  }
  CHECK(comes_true([&] { return server.spools() == 0; }));
}

TEST_CASE("one principal has at most half of the uploads and connections",
          "[daemon][http][limits]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.uploads = 4;
    options.limits.connections = 8;
  });
  std::vector<RawConnection> held;
  const auto hold = [&](const char* role) {
    held.push_back(server.connect());
    held.back().send(
        server.request("POST", "/v1/designs", role,
                       "Content-Type: application/dxf\r\nContent-Length: 33000000\r\n") +
        "0\n");
  };
  const auto upload = [&](const char* role) {
    return server.fetch("POST", "/v1/designs", role, "Content-Type: application/dxf\r\n", "0\nEOF");
  };
  hold("submitter");
  hold("submitter");
  REQUIRE(comes_true([&] { return server.spools() == 2; }));
  const WireResponse third = upload("submitter");
  CHECK(third.status == 503);
  CHECK(third.headers.at("retry-after") == "1");
  CHECK(third.body.find("2 uploads of yours") != std::string::npos);
  CHECK(upload("operator").status == 201);
  CHECK(server.fetch("GET", "/v1/devices", "submitter").status == 200);
  // Connections that are busy with something else count, too.
  const std::string id = new_job(server, JobState::Cutting);
  for (int k = 0; k < 2; ++k) {
    held.push_back(server.connect());
    const std::string request =
        server.request("POST", "/v1/jobs", "submitter", acting(), std::string(1000, ' '));
    held.back().send(request.substr(0, request.size() - 500));
  }
  CHECK(comes_true([&] { return server.fetch("GET", "/v1/devices", "submitter").status == 503; }));
  CHECK(server.fetch("GET", "/v1/jobs/" + id, "submitter").status == 200);  // to stop a knife
  CHECK(server.fetch("GET", "/v1/devices", "operator").status == 200);
  held.clear();
  CHECK(comes_true([&] { return upload("submitter").status == 200; }));
}

TEST_CASE("a knife can be stopped even when all connections are in use", "[daemon][http][slow]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.connections = 8;
    options.limits.header_s = 300;
  });
  const std::string id = new_job(server, JobState::Cutting);
  // Half-sent bodies of people who are known hold their places for long.
  std::vector<RawConnection> slow;
  for (const char* role : {"submitter", "admin"})
    for (int i = 0; i < 4; ++i) {
      slow.push_back(server.connect());
      const std::string request =
          server.request("POST", "/v1/jobs", role, acting(), std::string(1000, ' '));
      slow.back().send(request.substr(0, request.size() - 500));
    }
  WireResponse other;
  CHECK(comes_true([&] {
    other = server.fetch("GET", "/v1/devices", "viewer");
    return other.status == 503;
  }));
  CHECK(other.problem() == "unavailable");
  CHECK(other.headers.at("retry-after") == "1");
  const WireResponse job = server.fetch("GET", "/v1/jobs/" + id, "operator");
  CHECK(job.status == 200);
  const WireResponse paused = server.fetch("POST", "/v1/jobs/" + id + "/actions/pause", "operator",
                                           acting(job.headers.at("etag")));
  CHECK(paused.status == 200);
  // Nobody who looks at the job first can make a stop come too late.
  const WireResponse cancelled =
      server.fetch("POST", "/v1/jobs/" + id + "/actions/cancel", "operator", acting("*"));
  CHECK(cancelled.status == 200);
}

TEST_CASE("who does not say who they are keeps out nobody who does", "[daemon][http][slow]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.connections = 8;
    options.limits.header_s = options.limits.body_s = 300;
  });
  std::vector<RawConnection> strangers;
  SECTION("half-sent heads") {
    for (int i = 0; i < 100; ++i) {
      strangers.push_back(server.connect());
      strangers.back().send("GET /v1/jobs HTTP/1.1\r\nX-A: ");
    }
  }
  SECTION("files of the page that nobody reads") {
    const auto files = http::page_files();
    const auto largest = std::max_element(
        files.begin(), files.end(),
        [](const auto& a, const auto& b) { return a.bytes.size() < b.bytes.size(); });
    std::string all;
    for (int i = 0; i < 300; ++i)
      all += server.request("GET", "/page/" + std::string(largest->name), "");
    for (int i = 0; i < 8; ++i) {
      strangers.push_back(server.connect());
      strangers.back().send(all);
    }
  }
  // Until popcutd has noticed that they neither say who they are nor read.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (server.fetch("GET", "/v1/devices", "viewer").status != 200 &&
         std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  for (int i = 0; i < 20; ++i) CHECK(server.fetch("GET", "/v1/devices", "viewer").status == 200);
}

TEST_CASE("an idle connection is closed in favour of a new one", "[daemon][http][slow]") {
  LiveServer server([](HttpOptions& options) { options.limits.connections = 4; });
  std::vector<RawConnection> kept;
  for (int i = 0; i < 4; ++i) {
    kept.push_back(server.connect());
    kept.back().send(server.request("GET", "/healthz", ""));
    CHECK(kept.back().receive().status == 200);
  }
  CHECK(server.fetch("GET", "/v1/devices").status == 200);
  CHECK(kept.front().closes());
}

TEST_CASE("clients that stop reading or reset leak nothing", "[daemon][http][slow]") {
  LiveServer server;
  const std::string design = server.design();
  for (int i = 0; i < 200; ++i) REQUIRE(server.bench.create(design));
  for (int i = 0; i < 50; ++i) {
    RawConnection connection = server.connect();
    connection.send(server.request("GET", "/v1/jobs?limit=200"));
    if (i % 2 == 0) connection.reset();
  }
  CHECK(server.fetch("GET", "/v1/devices", "viewer").status == 200);
  CHECK(comes_true([&] {
    return server.fetch("GET", "/metrics").body.find("popcut_http_connections 1\n") !=
           std::string::npos;
  }));
}

TEST_CASE("large answers that nobody reads are ended before they fill the memory",
          "[daemon][http][limits]") {
  constexpr std::size_t kBlob = 16u << 20;  // more than the system takes from a sender
  LiveServer server([](HttpOptions& options) { options.limits.answer_bytes = 4 * kBlob; });
  server.previewer->blob.assign(kBlob, 'x');
  const std::string body = R"({"spec":{},"quality":"draft"})";
  const auto ask = [&](RawConnection& page, const char* role) {
    page.send(
        server.request("POST", "/v1/preview", role, "Content-Type: application/json\r\n", body));
  };
  std::vector<RawConnection> slow;
  for (int k = 0; k < 2; ++k) {
    slow.push_back(server.connect());
    ask(slow.back(), "submitter");
  }
  const auto has_begun = [](const RawConnection& one) {
    char byte = 0;
    return ::recv(one.socket(), &byte, 1, MSG_DONTWAIT | MSG_PEEK) == 1;
  };
  REQUIRE(comes_true([&] { return has_begun(slow[0]) && has_begun(slow[1]); }));
  // Half of all is one principal's; for two seconds nobody is called slow.
  RawConnection third = server.connect();
  ask(third, "submitter");
  WireResponse answer = third.receive();
  if (answer.status == 200) {
    WARN("this computer took two seconds for one answer");
    return;
  }
  CHECK(answer.status == 503);
  CHECK(answer.headers.count("retry-after") == 1);
  CHECK(answer.problem() == "unavailable");
  // What is small passes, and so do others.
  CHECK(server.fetch("GET", "/v1/devices", "submitter").status == 200);
  RawConnection other = server.connect();
  ask(other, "operator");
  CHECK(other.receive().body.size() == kBlob);
  // Then the slowest goes.
  std::this_thread::sleep_for(std::chrono::milliseconds(2200));
  ask(third, "submitter");
  answer = third.receive();
  CHECK(answer.status == 200);
  CHECK(answer.body.size() == kBlob);
  CHECK(slow[0].receive().body.size() < kBlob);
  CHECK(slow[1].receive().body.size() == kBlob);
}

TEST_CASE("codes of tablets cannot be tried out", "[daemon][http][pairing]") {
  LiveServer server;
  const std::string json = "Content-Type: application/json\r\n";
  const auto ask = [&] {
    return server.fetch("POST", "/v1/session/pair", "", json, R"({"name":"tablet"})");
  };
  const auto allow = [&](const std::string& code, const char* role) {
    return server.fetch("POST", "/v1/session/pair/allow", role, json,
                        fmt::format(R"({{"code":"{}","role":"viewer"}})", code));
  };
  const auto collect = [&](const std::string& secret) {
    return server.fetch("POST", "/v1/session/pair/collect", "", json,
                        fmt::format(R"({{"secret":"{}"}})", secret));
  };
  const auto first = nlohmann::json::parse(ask().body);
  const std::string code = first.at("code"), secret = first.at("secret");
  // What cannot be a code is no try of one.
  for (int i = 0; i < 10; ++i)
    CHECK(server.fetch("POST", "/v1/session/pair/allow", "operator", json, "{}").status == 422);
  for (int i = 0; i < 5; ++i) CHECK(allow(fmt::format("WRONG{}", i), "operator").status == 404);
  const WireResponse refused = allow(code, "operator");
  CHECK(refused.status == 429);  // nor does the right one tell that it is right
  CHECK(refused.headers.count("retry-after") == 1);
  CHECK(refused.problem() == "rate");
  // Somebody else may type theirs, and who knows a word may open a page.
  std::string word;
  server.ask([&](LiveService& service) {
    word = service.access.create_one_shot(server.principal(Role::Operator)).value();
  });
  CHECK(server.fetch("POST", "/v1/session", "", json, "{\"one_shot\":\"" + word + "\"}").status ==
        201);
  // A tablet that waits asks as often as it likes.
  for (int i = 0; i < 30; ++i) CHECK(collect(secret).status == 202);
  CHECK(allow(code, "viewer").status == 200);
  CHECK(collect(secret).status == 201);
  for (int i = 0; i < 5; ++i) CHECK(collect(secret).status == 404);
  CHECK(collect(secret).status == 429);
  // Whoever tries secrets keeps no tablet of the same address from its session.
  const auto second = nlohmann::json::parse(ask().body);
  for (int i = 0; i < 70; ++i) CHECK(collect("guess " + std::to_string(i)).status == 429);
  CHECK(collect(second.at("secret")).status == 202);
  CHECK(allow(second.at("code"), "viewer").status == 200);
  CHECK(collect(second.at("secret")).status == 201);
  // New codes are no way to guess either.
  for (int i = 0; i < 3; ++i) CHECK(ask().status == 201);
  CHECK(ask().status == 429);
  CHECK(server
            .fetch("POST", "/v1/session/pair", "", json + "Origin: http://evil.example\r\n",
                   R"({"name":"x"})")
            .status == 403);
}

TEST_CASE("what a tablet calls itself is checked before anybody reads it",
          "[daemon][http][pairing]") {
  LiveServer server;
  const auto ask = [&](const std::string& body) {
    return server.fetch("POST", "/v1/session/pair", "", "Content-Type: application/json\r\n", body)
        .status;
  };
  CHECK(ask(R"({"name":""})") == 422);
  CHECK(ask(R"({"name":"a\nb"})") == 422);
  CHECK(ask(R"({"name":"a\u0000b"})") == 422);
  CHECK(ask(R"({"name":"a\u001b[31mb"})") == 422);
  CHECK(ask("{\"name\":\"" + std::string(121, 'x') + "\"}") == 422);
  CHECK(ask("{\"name\":\"" + std::string(2000, 'x') + "\"}") == 413);
  CHECK(ask("{\"name\":\"\xFF\"}") == 400);
  CHECK(ask(R"({"name":["x"]})") == 422);
  CHECK(ask(R"({"name":"x","role":"admin"})") == 422);
  CHECK(ask(R"({"name":"<script>alert(1)</script>"})") == 201);
}

TEST_CASE("over the unix socket the user is the peer's", "[daemon][http][unix]") {
  LiveServer server;
  RawConnection connection(server.socket_path());
  connection.send("GET /v1/meta HTTP/1.1\r\nHost: popcut\r\n\r\n");
  const WireResponse meta = connection.receive();
  CHECK(meta.status == 200);
  CHECK(meta.body.find(fmt::format(R"("principal":{{"name":"uid:{}")", ::getuid())) !=
        std::string::npos);
  CHECK(meta.body.find(R"("role":"admin")") != std::string::npos);
  connection.send(
      fmt::format("GET /v1/meta HTTP/1.1\r\nHost: popcut\r\nAuthorization: Bearer {}\r\n\r\n",
                  server.token("viewer")));
  CHECK(connection.receive().status == 401);
  struct stat found {};
  REQUIRE(::stat(server.socket_path().c_str(), &found) == 0);
  CHECK((found.st_mode & 0777) == 0600);
}

TEST_CASE("the server listens only on loopback addresses", "[daemon][http][listen]") {
  popcut::testing::ServiceBench bench;
  const auto start = [&](const std::string& address) {
    HttpOptions options;
    options.listen = {{address}};
    options.service = &bench.service();
    options.on_service = [&](std::function<void()> work) {
      return bench.thread().post(ServiceThread::Lane::Asking, std::move(work));
    };
    HttpServer server(options);
    return server.start();
  };
  for (const char* address : {"0.0.0.0:0", "[::]:0", "192.0.2.1:0"})
    CHECK(start(address).error().kind == popcut::ErrorKind::Usage);
  for (const char* address : {"", "localhost", "127.0.0.1:http", "127.0.0.1:99999", "unix:", ":1"})
    CHECK_FALSE(start(address).has_value());
  CHECK(start("localhost:0").has_value());
}

TEST_CASE("the server stops while clients are busy and starts again", "[daemon][http][listen]") {
  for (int round = 0; round < 5; ++round) {
    LiveServer server;
    RawConnection idle = server.connect(), stream = server.connect(), half = server.connect();
    stream.send(server.request("GET", "/v1/events"));
    CHECK(stream.receive_until("event: snapshot").find("event: reset") != std::string::npos);
    half.send("GET /v1/jobs HTTP/1.1\r\n");
    CHECK(server.server().alive());
    server.server().stop(0.1);
    CHECK(idle.closes());
    CHECK(stream.closes());
    CHECK(half.closes());
  }
}

TEST_CASE("two hundred half-sent request heads use only their own connections",
          "[daemon][http][slow]") {
  LiveServer server([](HttpOptions& options) {
    options.limits = HttpLimits{};
    options.limits.rate_per_s = options.limits.rate_burst = 1e6;
    options.limits.header_s = 300;  // none is thrown out for being slow
  });
  const std::string id = new_job(server, JobState::Cutting);
  std::vector<RawConnection> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(server.connect());
    slow.back().send("GET /v1/jobs HTTP/1.1\r\nX-A: ");
  }
  for (int i = 0; i < 20; ++i)
    CHECK(server.fetch("GET", "/v1/jobs/" + id, "operator").status == 200);
  CHECK(server.fetch("POST", "/v1/jobs/" + id + "/actions/pause", "operator", acting("*")).status ==
        200);
  const auto open = [&] {
    return std::count_if(slow.begin(), slow.end(), [](const RawConnection& one) {
      char byte = 0;
      return ::recv(one.socket(), &byte, 1, MSG_DONTWAIT | MSG_PEEK) < 0 && errno == EAGAIN;
    });
  };
  CHECK(comes_true([&] { return open() <= 68; }));
}

TEST_CASE("one user of the unix socket cannot use all connections", "[daemon][http][unix]") {
  LiveServer server([](HttpOptions& options) { options.limits.connections = 8; });
  std::vector<RawConnection> greedy;
  for (int i = 0; i < 20; ++i) {
    greedy.emplace_back(server.socket_path());
    greedy.back().send("GET /v1/jobs HTTP/1.1\r\nX-A: ");
  }
  CHECK(server.fetch("GET", "/v1/devices").status == 200);
  CHECK(server.fetch("GET", "/v1/devices").status == 200);
}

TEST_CASE("a log has no secrets and no control characters", "[daemon][http][log]") {
  std::ostringstream text;
  std::string viewer;
  std::vector<std::string> secrets{"SECRET", "someone", "\x1B"};
  {
    LiveServer server([&](HttpOptions& options) {
      auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(text);
      options.log = std::make_shared<spdlog::logger>("http", sink);
      options.log->set_level(spdlog::level::debug);
    });
    viewer = server.token_id("viewer");
    for (const char* role : {"viewer", "admin"}) secrets.push_back(server.token(role).substr(30));
    CHECK(server.fetch("GET", "/v1/jobs?owner=someone", "viewer").status == 200);
    CHECK(server.fetch("GET", "/v1/jobs", "", "Authorization: Bearer pc_guess_SECRET\r\n").status ==
          401);
    CHECK(server.fetch("GET", "/v1/jobs/%1B%5B31m", "viewer").status == 400);
    CHECK(server
              .fetch("POST", "/v1/session", "", "Content-Type: application/json\r\n",
                     R"({"one_shot":"SECRET-word"})")
              .status == 401);
    const WireResponse token =
        server.fetch("POST", "/v1/tokens", "admin", "Content-Type: application/json\r\n",
                     R"({"name":"a","role":"viewer"})");
    secrets.push_back(nlohmann::json::parse(token.body).at("token").get<std::string>().substr(30));
    REQUIRE(secrets.back().size() == 43);
    server.ask([&](LiveService&) {
      server.devices().fault = [] { throw std::runtime_error("the cutters are\x1B[31m lost"); };
    });
    const WireResponse failed = server.fetch("GET", "/v1/devices", "viewer");
    CHECK(failed.status == 500);
    CHECK(comes_true([&] { return server.fetch("GET", "/v1/nothing").status == 404; }));
    server.server().stop(0.1);
    CHECK(text.str().find(failed.headers.at("x-request-id") +
                          " GET /v1/devices: the cutters are") != std::string::npos);
  }
  const std::string log = text.str();
  CHECK(log.find("token:" + viewer + " GET /v1/jobs 200") != std::string::npos);
  for (const std::string& secret : secrets) CHECK(log.find(secret) == std::string::npos);
}

TEST_CASE("inherited sockets and IPv6 are served", "[daemon][http][listen]") {
  const int inherited = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  REQUIRE(::listen(inherited, 8) == 0);  // binds to all addresses: refused
  popcut::testing::ServiceBench bench;
  const auto options = [&] {
    HttpOptions out;
    out.service = &bench.service();
    out.on_service = [&](std::function<void()> work) {
      return bench.thread().post(ServiceThread::Lane::Asking, std::move(work));
    };
    return out;
  };
  {
    HttpOptions all = options();
    all.inherited = {inherited};
    HttpServer server(all);
    CHECK(server.start().error().kind == popcut::ErrorKind::Usage);
  }
  HttpOptions six = options();
  six.listen = {{"[::1]:0", true}, {"127.0.0.1:0", false}};
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("popcut-{}.sock", ::getpid())).string();
  // Made by someone else, as systemd would, and handed over.
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  const int local = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  REQUIRE(::bind(local, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0);
  REQUIRE(::listen(local, 8) == 0);
  six.inherited = {local};
  {
    HttpServer server(six);
    REQUIRE(server.start());
    RawConnection connection(path);
    connection.send("GET /v1/meta HTTP/1.1\r\nHost: a\r\n\r\n");
    CHECK(connection.receive().status == 200);
    for (const std::string& name : server.endpoints()) {
      if (!name.starts_with("[::1]:")) continue;
      RawConnection other(static_cast<std::uint16_t>(std::stoi(name.substr(6))), true);
      other.send(fmt::format("GET /healthz HTTP/1.1\r\nHost: {}\r\n\r\n", name));
      CHECK(other.receive().status == 200);
    }
  }
  // What was not made here is not removed here.
  CHECK(std::filesystem::exists(path));
  std::filesystem::remove(path);
}

TEST_CASE("a second server on the same socket is refused and a stale one is taken over",
          "[daemon][http][listen]") {
  LiveServer server;
  HttpOptions options;
  options.listen = {{"unix:" + server.socket_path()}};
  options.service = &server.bench.service();
  options.on_service = [](const std::function<void()>&) { return false; };
  {
    HttpServer second(options);
    const auto started = second.start();
    REQUIRE_FALSE(started);
    CHECK(started.error().kind == popcut::ErrorKind::Refused);
    CHECK(started.error().detail.find("another popcutd may be running") != std::string::npos);
  }
  // It is still there, and still the first one's.
  RawConnection connection(server.socket_path());
  connection.send("GET /v1/meta HTTP/1.1\r\nHost: a\r\n\r\n");
  CHECK(connection.receive().status == 200);
}

}  // namespace http_limits_test
