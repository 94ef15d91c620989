// SPDX-License-Identifier: MIT
// The parts of the HTTP side that need no socket.
#include <limits>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/message.hpp"
#include "daemon/http/api/render.hpp"
#include "daemon/http/api/target.hpp"
#include "daemon/http/event_ring.hpp"
#include "daemon/http/front_door.hpp"
#include "daemon/http/head.hpp"
#include "daemon/http/rate_limit.hpp"
#include "daemon/http/wire.hpp"

namespace http_parts_test {

using namespace popcut;
using namespace popcut::daemon;
using namespace popcut::daemon::http;

namespace {

constexpr TextRule line(std::size_t most) { return {1, most, TextRule::Controls::None}; }

std::vector<RequestFault> faults_of(const std::string& body,
                                    const std::function<void(FieldReader&)>& read) {
  Request request;
  request.body = body;
  const auto answer = read_body_as<int>(request, 32, [&](FieldReader& fields) {
    read(fields);
    return 0;
  });
  return answer ? std::vector<RequestFault>{} : answer.error().errors;
}

EventFramePtr frame(std::int64_t seq, std::size_t bytes, const char* progress_of = nullptr) {
  EventFrame made{seq, progress_of != nullptr, progress_of == nullptr ? "" : progress_of,
                  std::string(bytes, 'x')};
  return std::make_shared<const EventFrame>(made);
}

RequestHead head_with(std::vector<Header> headers, Method method = Method::Post) {
  RequestHead head;
  head.method = method;
  head.headers = std::move(headers);
  return head;
}

}  // namespace

TEST_CASE("a request is read the same however it is cut into pieces", "[daemon][http][wire]") {
  const std::string bytes =
      "POST /v1/jobs?x=1 HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"
      "3;a=b\r\nabc\r\n0a\r\n0123456789\r\n0\r\nX: y\r\n\r\n"
      "PUT /a HTTP/1.1\r\nHost: b\r\nContent-Length: 4\r\n\r\nwxyz";
  for (std::size_t step = 1; step <= bytes.size(); ++step) {
    CAPTURE(step);
    RequestReader reader(8192);
    std::vector<std::string> bodies;
    std::string body;
    const RequestReader::Sink sink = [&](std::string_view piece) {
      body += piece;
      return std::optional<Problem>{};
    };
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      reader.append(std::string_view(bytes).substr(at, step));
      while (true) {
        const Answer<bool> has_head = reader.read_head();
        REQUIRE(has_head);
        if (!*has_head) break;
        const Answer<bool> has_body = reader.read_body(100, sink);
        REQUIRE(has_body);
        if (!*has_body) break;
        bodies.push_back(std::string(name_of(reader.head().method)) + reader.head().target + body);
        body.clear();
        reader.next();
      }
    }
    REQUIRE(bodies.size() == 2);
    CHECK(bodies[0] == "POST/v1/jobs?x=1abc0123456789");
    CHECK(bodies[1] == "PUT/awxyz");
    CHECK_FALSE(reader.has_begun());
  }
}

TEST_CASE("a body is counted while it arrives and cut off at its limit", "[daemon][http][wire]") {
  RequestReader reader(8192);
  reader.append("POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 8\r\n\r\n12345678");
  REQUIRE(reader.read_head().value());
  std::size_t got = 0;
  const auto sink = [&](std::string_view piece) {
    got += piece.size();
    return std::optional<Problem>{};
  };
  const Answer<bool> read = reader.read_body(7, sink);
  REQUIRE_FALSE(read);
  CHECK(read.error().kind == ProblemKind::TooLarge);
  CHECK(got == 0);
}

TEST_CASE("a line of a chunk that never ends is refused", "[daemon][http][wire]") {
  RequestReader reader(8192);
  reader.append("POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n");
  REQUIRE(reader.read_head().value());
  const auto sink = [](std::string_view) { return std::optional<Problem>{}; };
  bool refused = false;
  for (int i = 0; i < 10 && !refused; ++i) {
    reader.append("1;" + std::string(1000, 'a'));
    refused = !reader.read_body(100, sink);
  }
  CHECK(refused);
}

TEST_CASE("request targets are split and decoded", "[daemon][http][target]") {
  const Answer<Target> target = read_target("/v1/jobs/a%20b%C3%A4?name=x%26y+z&limit=5&flag");
  REQUIRE(target);
  CHECK(target->segments == std::vector<std::string>{"v1", "jobs", "a b\xC3\xA4"});
  REQUIRE(target->query.size() == 3);
  CHECK(target->query[0] == std::pair<std::string, std::string>{"name", "x&y+z"});
  CHECK(target->query[1].second == "5");
  CHECK(target->query[2].second.empty());
  CHECK(read_target("/")->segments == std::vector<std::string>{""});
  CHECK(read_target("/a/")->segments == std::vector<std::string>{"a", ""});
  // A port's id has slashes, and is no path here.
  CHECK(read_target("/v1/devices/serial:%2Fdev%2FttyUSB0/actions/enable")->segments ==
        std::vector<std::string>{"v1", "devices", "serial:/dev/ttyUSB0", "actions", "enable"});
  for (const char* bad : {"/v1/devices/a%5Cb", "/v1/devices/..", "/v1/devices/a/b%2Fc",
                          "/v1/devices%2Fa", "/v1/jobs/a%2Fb", "/devices/a%2Fb"})
    CHECK_FALSE(read_target(bad));
  for (const char* bad :
       {"",           "a",       "/a%",      "/a%4",       "/a%zz",         "/%00",       "/%2f",
        "/%2F",       "/%5c",    "/..",      "/%2e%2e",    "/a/.",          "/%0a",       "/%7f",
        "/%c2%85",    "/%ff",    "/%c0%af",  "/%ed%a0%80", "/%f5%80%80%80", "/%e2%80%ae", "/a?=1",
        "/a?x=1&x=2", "/a?x=1&", "/a?x=%zz", "/a?&x=1",    "/a?x=%00"}) {
    CAPTURE(bad);
    REQUIRE_FALSE(read_target(bad));
    CHECK(read_target(bad).error().kind == ProblemKind::BadRequest);
    CHECK_FALSE(read_target(bad).error().detail.empty());
  }
}

TEST_CASE("cursors are read back and anything else is refused", "[daemon][http][cursor]") {
  for (const char* place : {"0", "01JD0000000000000000000001", "sha256-abc", "a~b!c"})
    CHECK(decode_cursor(encode_cursor(place)) == place);
  for (const char* bad : {"", "A", "MQ", "MTA=", "MTA\n", "....", "Mg", "MTAA"})
    CHECK_FALSE(decode_cursor(bad).has_value());
  CHECK_FALSE(decode_cursor(std::string(1000, 'M')).has_value());
  CHECK_FALSE(decode_cursor(encode_cursor("a b")).has_value());
}

TEST_CASE("JSON is refused for depth and duplicate members and invalid numbers",
          "[daemon][http][json]") {
  CHECK(parse_body(std::string(32, '[') + std::string(32, ']'), 32).has_value());
  for (const std::string& bad : {std::string(33, '[') + std::string(33, ']'),
                                 std::string(1'000'000, '['),
                                 std::string(R"({"a":1,"a":2})"),
                                 std::string(R"({"a":{"b":1,"b":1}})"),
                                 std::string("NaN"),
                                 std::string("[Infinity]"),
                                 std::string("[-Infinity]"),
                                 std::string("[1e999]"),
                                 std::string("[1e-]"),
                                 std::string("[01]"),
                                 std::string("[1,]"),
                                 std::string("{\"a\":1,}"),
                                 std::string("{'a':1}"),
                                 std::string("[1] [2]"),
                                 std::string("// a\n[]"),
                                 std::string(""),
                                 std::string("[\"\xC0\xAF\"]"),
                                 std::string("[\"\xED\xA0\x80\"]"),
                                 std::string("[\"a\nb\"]"),
                                 std::string("[\"\\ud800\"]"),
                                 std::string("\0[]", 3),
                                 std::string("[]\0[", 4),
                                 std::string("{\"a\":1}\0garbage", 15)}) {
    CAPTURE(bad.substr(0, 40));
    const auto read = parse_body(bad, 32);
    REQUIRE_FALSE(read);
    CHECK(read.error().kind == ProblemKind::MalformedJson);
    CHECK_FALSE(read.error().detail.empty());
  }
  // The place is told in bytes.
  CHECK(parse_body(R"({"a": 1, x})", 32).error().detail.find("(byte 10)") != std::string::npos);
}

TEST_CASE("all faults of a body are reported at once", "[daemon][http][json]") {
  const auto faults =
      faults_of(R"({"copies":0,"nmae":"x","good":1,"a/b~c":2,"note":"\u0007","state":"armd"})",
                [](FieldReader& fields) {
                  (void)fields.optional_integer("copies", 1, 1000);
                  (void)fields.optional_text("name", line(120));
                  (void)fields.optional_boolean("good");
                  (void)fields.optional_text("note", TextRule{0, 2000, TextRule::Controls::Lines});
                  (void)fields.optional_word("state", {"armed", "ready"});
                  fields.need("job", "must be the id of a job");
                  (void)fields.optional_text("job", line(64));
                });
  const auto at = [&](const std::string& pointer) {
    for (const RequestFault& fault : faults)
      if (fault.pointer == pointer) return fault.code + ": " + fault.detail;
    return std::string("none");
  };
  CHECK(faults.size() == 7);
  CHECK(at("/copies") == "range: is 0; must be a whole number from 1 to 1000");
  CHECK(at("/nmae") == "unknown_member: is not known; did you mean /name?");
  CHECK(at("/good") == "type: is a number; must be true or false");
  CHECK(at("/a~1b~0c").starts_with("unknown_member: is not known; the fields here are copies,"));
  CHECK(at("/note") == "characters: has a control character; leave it out");
  CHECK(at("/state") == "word: is \"armd\"; must be one of armed, ready; did you mean armed?");
  CHECK(at("/job") == "missing: is missing; must be the id of a job");
}

TEST_CASE("a list instead of an object is reported as exactly that", "[daemon][http][json]") {
  const auto problem_of = [](const std::string& body) {
    Request request;
    request.body = body;
    const auto read = read_body_as<int>(request, 32, [](FieldReader& fields) {
      fields.need("job", "must be the id of a job");
      (void)fields.optional_text("job", line(64));
      (void)fields.optional_integer("copies", 1, 9);
      (void)read_options(fields, "options");
      (void)fields.optional_texts("tags", 2, line(9));
      return 0;
    });
    return read ? Problem{} : read.error();
  };
  const Problem list = problem_of("[]");
  CHECK(list.detail == "the body is a list; must be an object");
  REQUIRE(list.errors.size() == 1);
  CHECK(list.errors.at(0).pointer.empty());
  CHECK(problem_of("null").detail == "the body is null; must be an object");
  CHECK(problem_of(R"({"job":{}})").detail == "/job is an object; must be a text");
  CHECK(problem_of(R"({"job":"a","copies":[]})").detail ==
        "/copies is a list; must be a whole number from 1 to 9");
  CHECK(problem_of(R"({"job":"a","options":[]})").detail ==
        "/options is a list; must be an object");
  CHECK(problem_of(R"({"job":"a","tags":{}})").detail ==
        "/tags is an object; must be a list of at most 2 texts");
  CHECK(problem_of(R"({"job":"a","tags":["a","b","c"]})").errors.at(0).code == "length");
}

TEST_CASE("numbers must be whole and in range", "[daemon][http][json]") {
  for (const char* bad : {"1.5", "1e3", "\"1\"", "true", "null", "[]", "-1", "11",
                          "18446744073709551615", "-9223372036854775808"}) {
    CAPTURE(bad);
    const auto faults = faults_of(fmt::format(R"({{"n":{}}})", bad), [](FieldReader& fields) {
      CHECK_FALSE(fields.optional_integer("n", 0, 10).has_value());
    });
    CHECK(faults.size() == 1);
  }
  CHECK(faults_of(R"({"n":10})", [](FieldReader& fields) {
          CHECK(fields.optional_integer("n", 0, 10) == 10);
        }).empty());
}

TEST_CASE("options have texts or numbers or booleans as values", "[daemon][http][json]") {
  std::map<std::string, std::string> options;
  const auto read = [&](FieldReader& fields) { options = read_options(fields, "options"); };
  CHECK(faults_of(R"({"options":{"mat":"free","at":"10,10","effort":3,"scale":1.5,"split":true}})",
                  read)
            .empty());
  CHECK(options.at("effort") == "3");
  CHECK(options.at("scale") == "1.5");
  CHECK(options.at("split") == "true");
  for (const char* bad : {"[]", "\"a\"", R"({"A b":1})", R"({"":1})", R"({"a":null})",
                          R"({"a":[1]})", R"({"a":{"b":1}})", R"({"a":"\u0000"})"})
    CHECK(faults_of(fmt::format(R"({{"options":{}}})", bad), read).size() == 1);
}

TEST_CASE("each client has a burst and then a steady rate", "[daemon][http][rate]") {
  RateLimit limit(20, 60);
  for (int i = 0; i < 60; ++i) CHECK_FALSE(limit.take("a", 100).has_value());
  CHECK(limit.take("a", 100) == 1);
  CHECK_FALSE(limit.take("b", 100).has_value());
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += limit.take("a", 100 + i * 0.01).has_value() ? 0 : 1;
  CHECK(taken >= 198);
  CHECK(taken <= 201);
  for (int i = 0; i < 100'000; ++i) (void)limit.take(fmt::format("key {}", i), 200);
  CHECK(limit.size() <= 4096);
}

TEST_CASE("failed logins are counted over a minute", "[daemon][http][rate]") {
  FailedLogins logins(5);
  for (int i = 0; i < 5; ++i) CHECK_FALSE(logins.note("a", i).has_value());
  CHECK(logins.note("a", 10) == 50);
  CHECK(logins.wait("a", 10) == 50);
  CHECK(logins.wait("a", 59.5) == 1);
  CHECK_FALSE(logins.wait("a", 200));
  CHECK_FALSE(logins.wait("nobody", 10));
  CHECK_FALSE(logins.note("b", 10).has_value());
  CHECK_FALSE(logins.note("a", 60.5).has_value());
  CHECK(logins.note("a", 60.6).has_value());
}

TEST_CASE("a client's event queue drops progress first and then ends the stream",
          "[daemon][http][ring]") {
  EventRing ring(4, 1000);
  ring.push(frame(1, 10));
  ring.push(frame(0, 10, "a"));
  ring.push(frame(0, 20, "b"));
  ring.push(frame(0, 30, "a"));  // takes the place of the older one
  CHECK(ring.size() == 3);
  CHECK(ring.bytes() == 60);
  ring.push(frame(2, 10));
  ring.push(frame(3, 10));  // no room: the oldest progress goes
  CHECK(ring.size() == 4);
  ring.push(frame(4, 10));
  CHECK(ring.size() == 4);
  CHECK(ring.dropped() == 3);
  CHECK_FALSE(ring.has_overflowed());
  ring.push(frame(0, 10, "c"));  // progress is not worth anything else
  CHECK_FALSE(ring.has_overflowed());
  ring.push(frame(5, 10));
  CHECK(ring.has_overflowed());
  CHECK(ring.is_empty());
  CHECK(ring.bytes() == 0);
  CHECK(ring.pop() == nullptr);
  ring.push(frame(6, 10));
  CHECK(ring.is_empty());
  EventRing small(100, 100);
  small.push(frame(1, 60));
  small.push(frame(2, 41));
  CHECK(small.has_overflowed());
}

TEST_CASE("a slow client gets events without the whole job or device", "[daemon][http][ring]") {
  const auto full = [](std::int64_t seq, std::size_t whole) {
    Event event{.seq = seq, .kind = "job", .time = 0, .job = "01J", .data = R"({"rev":1})"};
    return frame_of(event, fmt::format(R"("whole":{{"x":"{}"}})", std::string(whole, 'x')));
  };
  const EventFramePtr one = full(7, 10);
  CHECK(one->text ==
        "id: 7\nevent: job\ndata: {\"rev\":1,\"time\":\"1970-01-01T00:00:00.000Z\","
        "\"whole\":{\"x\":\"xxxxxxxxxx\"}}\n\n");
  REQUIRE(one->brief);
  CHECK(one->brief->text ==
        "id: 7\nevent: job\ndata: {\"rev\":1,\"time\":\"1970-01-01T00:00:00.000Z\"}\n\n");
  CHECK(one->brief->seq == 7);
  CHECK_FALSE(frame_of(Event{.seq = 1, .kind = "job", .data = "{}"})->brief);
  // The one frame goes to all streams; each takes the part that it has room for.
  EventRing ring(256, 256 << 10);
  for (int seq = 1; seq <= 250; ++seq) ring.push(full(seq, 2000));
  CHECK_FALSE(ring.has_overflowed());
  CHECK(ring.dropped() == 0);
  CHECK(ring.bytes() <= 256 << 10);
  int whole = 0;
  for (int seq = 1; seq <= 250; ++seq) {
    const EventFramePtr next = ring.pop();
    REQUIRE(next);
    CHECK(next->seq == seq);
    if (next->text.find("whole") != std::string::npos) ++whole;
  }
  CHECK(whole > 50);
  CHECK(whole < 70);
  CHECK(ring.bytes() == 0);
  // One that alone is more than half goes without.
  EventRing small(10, 1000);
  small.push(full(1, 600));
  CHECK(small.pop()->text.find("whole") == std::string::npos);
}

TEST_CASE("limits count a peer by its user or its network", "[daemon][http][users]") {
  const auto place = [](const std::string& address) {
    Peer peer;
    peer.address = address;
    return place_of(peer);
  };
  CHECK(place("127.0.0.1") == "127.0.0.1");
  CHECK(place("192.0.2.7") == "192.0.2.7");
  CHECK(place("::1") == "::1");
  CHECK(place("2001:db8:1:2:3:4:5:6") == "2001:db8:1:2::/64");
  CHECK(place("2001:db8:1:2:ffff::1") == place("2001:db8:1:2::9"));
  CHECK(place("2001:db8:1:3::1") != place("2001:db8:1:2::1"));
  Peer local;
  local.is_local = true;
  local.uid = 7;
  CHECK(place_of(local) == "uid:7");
}

TEST_CASE("times beyond 2262 are read and written right", "[daemon][http][clock]") {
  for (const char* text :
       {"2262-04-11T23:47:16.855Z", "2262-04-12T00:00:00.000Z", "2300-02-28T12:00:00.001Z",
        "9999-12-31T23:59:59.999Z", "1970-01-01T00:00:00.000Z", "1969-12-31T23:59:59.999Z"}) {
    REQUIRE(time_from(text));
    CHECK(rfc3339(*time_from(text)) == text);
  }
  CHECK(time_from("9999-12-31"));
  CHECK_FALSE(time_from("10000-01-01"));
  CHECK_FALSE(time_from("2300-02-29"));
}

TEST_CASE("local users have the configured roles", "[daemon][http][users]") {
  LocalUsers users;
  users.users[1000] = Role::Viewer;
  users.groups[50] = Role::Operator;
  users.groups[51] = Role::Submitter;
  const auto role = [&](uid_t uid, std::vector<gid_t> groups) {
    Peer peer;
    peer.is_local = true;
    peer.uid = uid;
    peer.groups = std::move(groups);
    return local_principal(peer, users, 999);
  };
  CHECK(role(0, {})->role == Role::Admin);
  CHECK(role(999, {})->role == Role::Admin);
  CHECK(role(1000, {})->role == Role::Viewer);
  CHECK(role(1000, {51, 50})->role == Role::Operator);
  CHECK(role(1001, {51})->role == Role::Submitter);
  CHECK(role(1001, {51})->name == "uid:1001");
  CHECK(role(1001, {52}).error().kind == ProblemKind::Forbidden);
  CHECK(role(static_cast<uid_t>(-1), {}).error().kind == ProblemKind::Forbidden);
}

TEST_CASE("Host and Origin are checked against the names of this daemon", "[daemon][http][names]") {
  Peer peer;
  peer.port = 8631;
  const Names names{{"cutter.lab:8631"}, {"https://cutter.lab"}};
  const auto host = [&](const char* text) {
    return !check_host(head_with({{"host", text}}), peer, names).has_value();
  };
  for (const char* good :
       {"localhost:8631", "127.0.0.1:8631", "[::1]:8631", "LOCALHOST:8631", "cutter.lab:8631"})
    CHECK(host(good));
  for (const char* bad : {"localhost", "localhost:80", "127.0.0.1", "127.1:8631", "127.0.0.2:8631",
                          "0.0.0.0:8631", "::1:8631", "[::1]", "cutter.lab", "evil.example:8631",
                          "localhost:8631@evil", "localhost:08631", "", "2130706433:8631"}) {
    CAPTURE(bad);
    CHECK_FALSE(host(bad));
  }
  const auto origin = [&](const char* text, Method method = Method::Post) {
    // A page whose name was turned to us sends Host and Origin of its own, alike.
    return !check_origin(head_with({{"host", "evil:8631"}, {"origin", text}}, method), peer, names)
                .has_value();
  };
  CHECK(origin("http://localhost:8631"));
  CHECK(origin("https://cutter.lab"));
  CHECK(origin("http://evil:8631", Method::Get));
  for (const char* bad : {"http://evil:8631", "https://localhost:8631", "http://localhost", "null",
                          "", "http://localhost:8631/", "http://localhost:8631.evil"}) {
    CAPTURE(bad);
    CHECK_FALSE(origin(bad));
  }
}

TEST_CASE("answers and log lines have no control characters", "[daemon][http][message]") {
  Response response;
  response.headers.push_back({"Location", "/a\r\nSet-Cookie: x"});
  const std::string head = response_head(response, "01J", 5, true);
  CHECK(head.find("Location: /a  Set-Cookie: x\r\n") != std::string::npos);
  CHECK(head.find("\r\nSet-Cookie") == std::string::npos);
  CHECK(head.find("Content-Length: 5\r\n") != std::string::npos);
  CHECK(for_log("a\n\x1B[31m\x7F\xC2\x9B\xC3\xA4") == "a\\x0a\\x1b[31m\\x7f\\x9b\xC3\xA4");
}

TEST_CASE("a job is written as JSON whatever its texts and numbers hold",
          "[daemon][http][render]") {
  Job job;
  job.id = "01ARZ3NDEKTSV4RRFFQ69G5FAV";
  job.name = "a \"card\"\\ <b>\n\x01 \xC3\xA9 \xFF";
  job.tags = {"", "two, three", "\"}"};
  job.est.remaining_s = {0.1, std::numeric_limits<double>::infinity()};
  job.progress.cut_mm = 1e21;
  job.attention = Attention{.kind = "load_sheet", .sheet = 1, .total = 2, .text = "load \"1\""};
  const nlohmann::json read = nlohmann::json::parse(job_text(job));
  CHECK(read["name"] == "a \"card\"\\ <b>\n\x01 \xC3\xA9 \xEF\xBF\xBD");
  CHECK(read["tags"] == nlohmann::json(job.tags));
  CHECK(read["est"]["remaining_s"] == nlohmann::json({0.1, nullptr}));
  CHECK(read["progress"]["cut_mm"] == 1e21);
  CHECK(read["attention"]["text"] == "load \"1\"");
  CHECK(read["attention"]["actions"] == nlohmann::json::array());
  CHECK(read["handwork"].is_null());
  job.handwork = Handwork{.folds = 7, .shortest_fold_mm = 6.5, .fold_s = 90, .label = "easy"};
  CHECK(nlohmann::json::parse(job_text(job))["handwork"] ==
        nlohmann::json({{"folds", 7},
                        {"shortest_fold_mm", 6.5},
                        {"waste", 0},
                        {"tabs", 0},
                        {"fold_s", 90},
                        {"label", "easy"}}));
  CHECK(read["sheet"].is_null());
  CHECK(read["links"]["plan"].is_null());
  CHECK(read["held"] == false);
  CHECK(read["copies"] == 1);
}

TEST_CASE("a reply is sent exactly once", "[daemon][http][message]") {
  std::vector<int> given;
  const auto send = [&](const Response& response) { given.push_back(response.status); };
  {
    const Reply reply(send);
    const Reply copy = reply;
    copy(Response{});
    reply(Response{});
  }
  CHECK(given == std::vector<int>{200});
  { const Reply dropped(send); }
  CHECK(given == std::vector<int>{200, 500});
}

}  // namespace http_parts_test
