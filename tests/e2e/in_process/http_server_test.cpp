// SPDX-License-Identifier: MIT
// The server as a client sees it: jobs, keys, roles, uploads.
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/digest/digest.hpp"
#include "daemon/http/api/routes.hpp"
#include "tests/support/raw_http.hpp"

namespace http_server_test {

using namespace popcut::daemon;

namespace {

const std::string kSvg = "Content-Type: image/svg+xml\r\n";

}  // namespace

TEST_CASE("a job is made, acted on and seen over HTTP", "[daemon][http][server]") {
  LiveServer server;
  server.bench.ready_job();  // so that the plan is made
  const WireResponse made =
      server.fetch("POST", "/v1/jobs", "submitter", acting(),
                   fmt::format(R"({{"design":"{}","copies":2,"tags":["a"]}})", server.design()));
  REQUIRE(made.status == 201);
  const std::string at = made.headers.at("location");
  CHECK(at.starts_with("/v1/jobs/01"));
  CHECK(at.size() == 9 + 26);
  const WireResponse seen = server.fetch("GET", at, "viewer");
  CHECK(seen.status == 200);
  CHECK(seen.headers.at("etag") == made.headers.at("etag"));
  CHECK(seen.body == made.body);
  CHECK(server.fetch("GET", at, "viewer", "If-None-Match: " + seen.headers.at("etag") + "\r\n")
            .status == 304);
  const WireResponse armed = server.fetch("POST", at + "/actions/arm", "operator",
                                          acting(seen.headers.at("etag")), R"({"sheet":1})");
  CHECK(armed.status == 200);
  CHECK(armed.body.find(R"("state":"armed")") != std::string::npos);
  // Who saw the job before it was armed is told what it is now.
  const WireResponse late =
      server.fetch("POST", at + "/actions/start", "operator", acting(seen.headers.at("etag")));
  CHECK(late.status == 412);
  CHECK(late.problem() == "stale");
  CHECK(late.headers.at("etag") == armed.headers.at("etag"));
  CHECK(late.body.find(R"("allowed_actions":["disarm","start","cancel"])") != std::string::npos);
}

TEST_CASE("the same key gets the same answer and does nothing twice", "[daemon][http][server]") {
  LiveServer server;
  const std::string key = acting(), body = fmt::format(R"({{"design":"{}"}})", server.design());
  const WireResponse first = server.fetch("POST", "/v1/jobs", "submitter", key, body);
  const WireResponse second = server.fetch("POST", "/v1/jobs", "submitter", key, body);
  CHECK(first.status == 201);
  CHECK(second.status == 201);
  CHECK(first.body == second.body);
  CHECK(first.headers.count("idempotent-replayed") == 0);
  CHECK(second.headers.at("idempotent-replayed") == "true");
  CHECK(second.headers.at("location") == first.headers.at("location"));
  CHECK(server.jobs() == 1);
  const WireResponse other =
      server.fetch("POST", "/v1/jobs", "submitter", key, R"({"design":"sha256-bb"})");
  CHECK(other.status == 422);
  CHECK(other.problem() == "idempotency-key-reused");
  // The key of another person is another key.
  CHECK(server.fetch("POST", "/v1/jobs", "operator", key, body).status == 201);
  for (const std::string_view bad :
       {"", "Idempotency-Key: short\r\n", "Idempotency-Key: with a space in it\r\n"}) {
    const std::string more = "Content-Type: application/json\r\n" + std::string(bad);
    const WireResponse without = server.fetch("POST", "/v1/jobs", "submitter", more, body);
    CHECK(without.status == 400);
    CHECK(without.problem() == "idempotency-key-missing");
  }
  CHECK(server.jobs() == 2);
}

TEST_CASE("each route lets in the roles of its row and no other", "[daemon][http][roles]") {
  LiveServer server;
  for (const http::Route& route : http::routes()) {
    std::string path(route.path);
    for (const std::string_view hole : {"{id}", "{k}", "{name}", "{file}"})
      for (std::size_t at = path.find(hole); at != std::string::npos; at = path.find(hole))
        path.replace(at, hole.size(), "1");
    const std::string_view method = http::name_of(route.method);
    CAPTURE(method, path);
    const WireResponse anonymous = server.fetch(method, path, "");
    CHECK((anonymous.status == 401) == !route.access.is_open());
    for (const Role role : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin}) {
      CAPTURE(name_of(role));
      // One of the routes ends the session that it is called with.
      server.renew_token(role);
      const std::string more = route.is_stream ? "Accept: application/json\r\n" : std::string();
      const WireResponse response = server.fetch(method, path, name_of(role), more);
      const bool is_let_in = route.access.is_open() || role >= route.access.role();
      CHECK(response.status != 0);
      if (!is_let_in) {
        CHECK(response.status == 403);
        CHECK(response.problem() == "forbidden");
      } else {
        CHECK(response.status != 403);
        CHECK(response.status != 401);
      }
    }
  }
}

TEST_CASE("an upload is in the incoming folder only until the service takes it",
          "[daemon][http][upload]") {
  LiveServer server;
  const std::string body(300'000, 'x');
  const WireResponse made =
      server.fetch("POST", "/v1/designs?name=%3Cimg%20onerror%3E.svg", "submitter", kSvg, body);
  CHECK(made.status == 201);
  Sha256 hash;
  hash.add(body);
  const std::string id = "sha256-" + hash.hex();
  CHECK(made.headers.at("location") == "/v1/designs/" + id);
  CHECK(server.fetch("GET", "/v1/designs/" + id + "/content").body == body);
  const auto design = nlohmann::json::parse(server.fetch("GET", "/v1/designs/" + id).body);
  CHECK(design.at("bytes") == body.size());
  CHECK(design.at("name") == "<img onerror>.svg");
  const popcut::daemon::PlanningTask checked = server.bench.planner.last_task();
  CHECK(checked.media_type == "image/svg+xml");
  // The name that a client gives never reaches the file system.
  CHECK(checked.design_path.find("onerror") == std::string::npos);
  CHECK(server.fetch("POST", "/v1/designs", "submitter", kSvg, body).status == 200);
  CHECK(comes_true([&] { return server.spools() == 0; }));
}

TEST_CASE("an upload that fails in any way leaves nothing behind", "[daemon][http][upload]") {
  LiveServer server([](HttpOptions& options) { options.limits.design_bytes = 100'000; });
  const std::string chunked = kSvg + "Transfer-Encoding: chunked\r\n";
  SECTION("the client goes in the middle") {
    RawConnection connection = server.connect();
    connection.send(
        server.request("POST", "/v1/designs", "submitter", kSvg + "Content-Length: 50000\r\n"));
    connection.send(std::string(20'000, 'x'));
    CHECK(comes_true([&] { return server.spools() == 1; }));
    connection.reset();
  }
  SECTION("it never ends") {
    RawConnection connection = server.connect();
    connection.send(server.request("POST", "/v1/designs", "submitter", chunked));
    for (int i = 0; i < 64 && connection.send("1000\r\n" + std::string(4096, 'x') + "\r\n"); ++i) {
    }
    CHECK(connection.receive().status == 413);
  }
  SECTION("it says that it is longer than it may be") {
    RawConnection connection = server.connect();
    connection.send(
        server.request("POST", "/v1/designs", "submitter", kSvg + "Content-Length: 100001\r\n"));
    CHECK(connection.receive().status == 413);
    CHECK(server.spools() == 0);
  }
  SECTION("it is empty") {
    CHECK(server.fetch("POST", "/v1/designs", "submitter", kSvg).status == 422);
  }
  SECTION("the service refuses it") {
    CHECK(server.fetch("POST", "/v1/designs", "submitter", kSvg, "<svg bad").status == 422);
  }
  SECTION("the service forgets to answer") {
    RawConnection connection = server.connect();
    connection.send(server.request("POST", "/v1/designs", "submitter", kSvg, "<svg held"));
    CHECK(comes_true([&] { return server.bench.planner.started == 1; }));
    server.bench.planner.forget();
    CHECK(connection.receive().status == 500);
  }
  SECTION("the service fails") {
    RawConnection local(server.socket_path());  // who is known without a clock
    server.has_clock = false;
    local.send(fmt::format(
        "POST /v1/designs HTTP/1.1\r\nHost: popcut\r\n{}Content-Length: 4\r\n\r\n<svg", kSvg));
    CHECK(local.receive().status == 500);
  }
  CHECK(comes_true([&] { return server.spools() == 0; }));
  server.has_clock = true;
  CHECK(server.fetch("GET", "/healthz", "").status == 200);
}

TEST_CASE("a full disk answers 507 and reads still work", "[daemon][http][upload]") {
  LiveServer server;
  // No file of this process may become longer than 4 MiB: a write beyond it fails. The database is
  // much smaller.
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const auto old = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4u << 20, before.rlim_max};
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  const WireResponse full =
      server.fetch("POST", "/v1/designs", "submitter", kSvg, std::string(5u << 20, 'x'));
  const WireResponse list = server.fetch("GET", "/v1/jobs");
  const WireResponse fits = server.fetch("POST", "/v1/designs", "submitter", kSvg, "<svg/>");
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old);
  CHECK(full.status == 507);
  CHECK(full.problem() == "disk-full");
  CHECK(list.status == 200);
  CHECK(fits.status == 201);
  CHECK(comes_true([&] { return server.spools() == 0; }));
}

TEST_CASE("an incoming folder that cannot be written is reported and nothing else stops",
          "[daemon][http][upload]") {
  const LiveServer server([](HttpOptions& options) { options.incoming_folder = "/dev/null/none"; });
  CHECK(server.fetch("POST", "/v1/designs", "submitter", kSvg, "<svg/>").status == 503);
  CHECK(server.fetch("GET", "/v1/jobs").status == 200);
}

TEST_CASE("only files that an earlier run left among the uploads are removed",
          "[daemon][http][upload]") {
  std::filesystem::path folder;
  const LiveServer server([&](HttpOptions& options) {
    folder = options.incoming_folder;
    for (const char* name : {"01J.upload", "02J.upload", "notes.txt"})
      std::ofstream(folder / name) << "x";
    std::filesystem::create_symlink("/etc/hostname", folder / "link.upload");
  });
  CHECK(std::filesystem::exists(folder / "notes.txt"));
  CHECK_FALSE(std::filesystem::exists(folder / "01J.upload"));
  CHECK_FALSE(std::filesystem::exists(folder / "02J.upload"));
  CHECK(std::filesystem::is_symlink(folder / "link.upload"));
}

TEST_CASE("a preview that waits too long ends, and placing a shape has more time",
          "[daemon][http][preview]") {
  LiveServer server([](HttpOptions& options) { options.limits.answer_s = 0.5; });
  server.previewer->holds = true;
  const std::string json = "Content-Type: application/json\r\n";
  const WireResponse late =
      server.fetch("POST", "/v1/preview", "submitter", json, R"({"spec": {}, "quality": "exact"})");
  CHECK(late.status == 503);
  CHECK(late.body.find("no answer yet; try again") != std::string::npos);  // it has no key
  CHECK(server.previewer->called_off == 1);
  for (const http::Route& route : http::routes())
    if (route.path == "/v1/place") CHECK(route.patience == http::Patience::Design);
}

TEST_CASE("a preview ends when its client goes, and not before", "[daemon][http][preview]") {
  LiveServer server;
  server.previewer->holds = true;
  const std::string body = R"({"spec": {}, "quality": "exact"})";
  const std::string wanted = server.request("POST", "/v1/preview", "submitter",
                                            "Content-Type: application/json\r\n", body);
  server.previewer->blob = "blob";
  const auto held = [&] { return server.previewer->held(); };
  SECTION("closed") {
    auto connection = std::make_unique<RawConnection>(server.connect());
    REQUIRE(connection->send(wanted));
    REQUIRE(comes_true([&] { return held() == 1; }));
    CHECK(server.previewer->called_off == 0);
    connection.reset();
    CHECK(comes_true([&] { return server.previewer->called_off == 1; }));
  }
  SECTION("reset") {
    RawConnection connection = server.connect();
    REQUIRE(connection.send(wanted));
    REQUIRE(comes_true([&] { return held() == 1; }));
    connection.reset();
    CHECK(comes_true([&] { return server.previewer->called_off == 1; }));
  }
  SECTION("answered, and the connection goes on") {
    RawConnection connection = server.connect();
    for (int k = 0; k < 3; ++k) {
      REQUIRE(connection.send(wanted));
      REQUIRE(comes_true([&] { return held() == 1; }));
      server.previewer->release();
      CHECK(connection.receive().body == "blob");
    }
    CHECK(server.previewer->called_off == 0);
  }
  SECTION("another request behind it is answered after it") {
    RawConnection connection = server.connect();
    REQUIRE(connection.send(wanted + server.request("GET", "/healthz", "")));
    REQUIRE(comes_true([&] { return held() == 1; }));
    server.previewer->release();
    CHECK(connection.receive().body == "blob");
    CHECK(connection.receive().status == 200);
  }
}

TEST_CASE("previews and pictures have rates of their own", "[daemon][http][preview]") {
  LiveServer server([](HttpOptions& options) {
    options.limits.rate_per_s = 0.01;
    options.limits.rate_burst = 1;
    options.limits.previews_per_s = 0.01;
    options.limits.pictures_per_s = 0.01;
  });
  const auto preview = [&] {
    return server.fetch("POST", "/v1/preview", "submitter", "Content-Type: application/json\r\n",
                        R"({"spec": {}, "quality": "draft"})");
  };
  CHECK(preview().status == 200);
  const WireResponse late = preview();
  CHECK(late.status == 429);
  CHECK(late.headers.contains("retry-after"));
  CHECK(server.fetch("GET", "/v1/meta", "submitter").status == 200);
  CHECK(server.fetch("GET", "/v1/meta", "submitter").status == 429);
  CHECK(server.fetch("GET", "/v1/designs/sha256-1/lattice", "submitter").status == 404);
}

TEST_CASE("uploaded files are served as bytes to save", "[daemon][http][upload]") {
  LiveServer server;
  const std::string evil =
      "<svg xmlns='http://www.w3.org/2000/svg'><script>alert(1)</script></svg>";
  const WireResponse made = server.fetch("POST", "/v1/designs", "submitter", kSvg, evil);
  const std::string at = made.headers.at("location");
  const WireResponse content = server.fetch("GET", at + "/content", "viewer");
  CHECK(content.status == 200);
  CHECK(content.body == evil);
  CHECK(content.headers.at("content-type") == "application/octet-stream");
  CHECK(content.headers.at("content-disposition").starts_with("attachment"));
  const WireResponse preview = server.fetch("GET", at + "/preview.svg", "viewer");
  CHECK(preview.headers.at("content-type") == "image/svg+xml");
  CHECK(preview.headers.at("content-security-policy").find("sandbox") != std::string::npos);
  CHECK(server.fetch("HEAD", at + "/content", "viewer").headers.at("content-length") ==
        std::to_string(evil.size()));
}

}  // namespace http_server_test
