// SPDX-License-Identifier: MIT
// Bytes on a socket: what the front door lets in, and what it does not.
#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/raw_http.hpp"

namespace http_front_door_test {

using namespace popcut::daemon;

namespace {

struct RawCase {
  const char* name;
  std::string bytes;  ///< HOST and AUTH stand for the lines that a lawful request has
  int status;
  const char* problem;
};

std::string filled(std::string text, const LiveServer& server) {
  const auto replace = [&](std::string_view word, const std::string& with) {
    for (std::size_t at = text.find(word); at != std::string::npos;
         at = text.find(word, at + with.size()))
      text.replace(at, word.size(), with);
  };
  replace("HOST", fmt::format("Host: localhost:{}\r\n", server.port()));
  replace("AUTH", fmt::format("Authorization: Bearer {}\r\n", server.token("admin")));
  replace("KEY", "Idempotency-Key: 0123456789abcdef\r\n");
  replace("PORT", fmt::format("{}", server.port()));
  return text;
}

// Each is refused, and nothing that follows it is taken for a request.
const std::vector<RawCase> kRefused{
    {"no Host", "GET /healthz HTTP/1.1\r\n\r\n", 400, "bad-request"},
    {"no Host in HTTP/1.0", "GET /healthz HTTP/1.0\r\n\r\n", 400, "bad-request"},
    {"two Hosts", "GET /healthz HTTP/1.1\r\nHOSTHost: evil\r\n\r\n", 400, "bad-request"},
    {"two equal Hosts", "GET /healthz HTTP/1.1\r\nHOSTHOST\r\n", 400, "bad-request"},
    {"an empty Host", "GET /healthz HTTP/1.1\r\nHost:\r\n\r\n", 421, "wrong-host"},
    {"length and chunks",
     "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: 4\r\nTransfer-Encoding: "
     "chunked\r\n\r\n0\r\n\r\n",
     400, "bad-request"},
    {"chunks and length",
     "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: chunked\r\nContent-Length: "
     "4\r\n\r\n0\r\n\r\n",
     400, "bad-request"},
    {"two unequal lengths",
     "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: 4\r\nContent-Length: 5\r\n\r\n{}  ", 400,
     "bad-request"},
    {"two equal lengths",
     "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: 2\r\nContent-Length: 2\r\n\r\n{}", 400,
     "bad-request"},
    {"a list of lengths", "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: 2, 2\r\n\r\n{}", 400,
     "bad-request"},
    {"a signed length", "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: +2\r\n\r\n{}", 400,
     "bad-request"},
    {"a negative length", "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: -2\r\n\r\n{}", 400,
     "bad-request"},
    {"a hexadecimal length", "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: 0x2\r\n\r\n{}", 400,
     "bad-request"},
    {"an empty length", "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length:\r\n\r\n{}", 400,
     "bad-request"},
    {"a length beyond 64 bits",
     "POST /v1/jobs HTTP/1.1\r\nHOSTContent-Length: 18446744073709551617\r\n\r\n{}", 400,
     "bad-request"},
    {"an unknown coding", "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: foo\r\n\r\nGET /", 400,
     "bad-request"},
    {"an unknown coding and a length",
     "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: foo\r\nContent-Length: 2\r\n\r\n{}", 400,
     "bad-request"},
    {"identity coding", "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: identity\r\n\r\n", 400,
     "bad-request"},
    {"xchunked", "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: xchunked\r\n\r\n0\r\n\r\n", 400,
     "bad-request"},
    {"chunked twice",
     "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: chunked, chunked\r\n\r\n0\r\n\r\n", 400,
     "bad-request"},
    {"gzip then chunked",
     "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n", 400,
     "bad-request"},
    {"two codings",
     "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: chunked\r\nTransfer-Encoding: "
     "chunked\r\n\r\n0\r\n\r\n",
     400, "bad-request"},
    {"chunked with a vertical tab",
     "POST /v1/jobs HTTP/1.1\r\nHOSTTransfer-Encoding: \x0B"
     "chunked\r\n\r\n0\r\n\r\n",
     400, "bad-request"},
    {"chunks in HTTP/1.0",
     "POST /v1/jobs HTTP/1.0\r\nHOSTTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400,
     "bad-request"},
    {"a folded line", "GET /healthz HTTP/1.1\r\nHOSTX-A: b\r\n c\r\n\r\n", 400, "bad-request"},
    {"a folded line with a tab", "GET /healthz HTTP/1.1\r\nHOSTX-A: b\r\n\tc\r\n\r\n", 400,
     "bad-request"},
    {"a folded first line", "GET /healthz HTTP/1.1\r\n HOST\r\n", 400, "bad-request"},
    {"bare line feeds", "GET /healthz HTTP/1.1\nHost: localhost:PORT\n\r\n\r\n", 400,
     "bad-request"},
    {"a bare line feed between", "GET /healthz HTTP/1.1\r\nHOSTX-A: b\nX-B: c\r\n\r\n", 400,
     "bad-request"},
    {"a bare carriage return", "GET /healthz HTTP/1.1\r\nHOSTX-A: b\rX-B: c\r\n\r\n", 400,
     "bad-request"},
    {"a zero byte in a value", std::string("GET /healthz HTTP/1.1\r\nHOSTX-A: b\0c\r\n\r\n", 39),
     400, "bad-request"},
    {"a zero byte in the path", std::string("GET /heal\0thz HTTP/1.1\r\nHOST\r\n", 30), 400,
     "bad-request"},
    {"an escape in a value", "GET /healthz HTTP/1.1\r\nHOSTX-A: \x1B[31m\r\n\r\n", 400,
     "bad-request"},
    {"a space before the colon", "GET /healthz HTTP/1.1\r\nHOSTX-A : b\r\n\r\n", 400,
     "bad-request"},
    {"a space in a name", "GET /healthz HTTP/1.1\r\nHOSTX A: b\r\n\r\n", 400, "bad-request"},
    {"no name", "GET /healthz HTTP/1.1\r\nHOST: b\r\n\r\n", 400, "bad-request"},
    {"no colon", "GET /healthz HTTP/1.1\r\nHOSTX-A\r\n\r\n", 400, "bad-request"},
    {"a name in another alphabet", "GET /healthz HTTP/1.1\r\nHOSTX-\xC3\xA4: b\r\n\r\n", 400,
     "bad-request"},
    {"a whole URI", "GET http://localhost:PORT/healthz HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"a whole URI of elsewhere", "GET http://evil/healthz HTTP/1.1\r\nHOST\r\n", 400,
     "bad-request"},
    {"CONNECT", "CONNECT evil:443 HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"OPTIONS of all", "OPTIONS * HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"no version", "GET /healthz\r\nHOST\r\n", 400, "bad-request"},
    {"HTTP/0.9", "GET /healthz HTTP/0.9\r\nHOST\r\n", 400, "bad-request"},
    {"HTTP/1.2", "GET /healthz HTTP/1.2\r\nHOST\r\n", 400, "bad-request"},
    {"HTTP/2.0", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 400, "bad-request"},
    {"a version in small letters", "GET /healthz http/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"two spaces", "GET  /healthz HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"a tab for a space", "GET\t/healthz\tHTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"a method in small letters", "get /healthz HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"an empty line first", "\r\nGET /healthz HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"a path with a fragment", "GET /healthz#a HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"a path with quotes", "GET /\"><script> HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"a path beyond ASCII", "GET /\xC3\xA4 HTTP/1.1\r\nHOST\r\n", 400, "bad-request"},
    {"TLS", std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 15), 400,
     "bad-request"},
    {"two tokens", "GET /v1/jobs HTTP/1.1\r\nHOSTAUTHAUTH\r\n", 400, "bad-request"},
    {"two keys", "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYKEY\r\n", 400, "bad-request"},
};

// Each is refused with its own problem; what follows the refusal depends on its body.
const std::vector<RawCase> kAnswered{
    {"another host", "GET /v1/jobs HTTP/1.1\r\nHost: evil.example\r\nAUTH\r\n", 421, "wrong-host"},
    {"the right host and a wrong port", "GET /v1/jobs HTTP/1.1\r\nHost: localhost:1\r\nAUTH\r\n",
     421, "wrong-host"},
    {"the right host without its port", "GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\nAUTH\r\n", 421,
     "wrong-host"},
    {"a host that begins rightly",
     "GET /v1/jobs HTTP/1.1\r\nHost: localhost:PORT.evil.example\r\nAUTH\r\n", 421, "wrong-host"},
    {"a host with a dot at its end", "GET /v1/jobs HTTP/1.1\r\nHost: localhost.:PORT\r\nAUTH\r\n",
     421, "wrong-host"},
    {"a user in the host", "GET /v1/jobs HTTP/1.1\r\nHost: a@localhost:PORT\r\nAUTH\r\n", 421,
     "wrong-host"},
    {"the host in capital letters", "GET /healthz HTTP/1.1\r\nHost: LocalHosT:PORT\r\n\r\n", 200,
     ""},
    {"no token", "GET /v1/jobs HTTP/1.1\r\nHOST\r\n", 401, "unauthenticated"},
    {"a password", "GET /v1/jobs HTTP/1.1\r\nHOSTAuthorization: Basic YTpi\r\n\r\n", 401,
     "unauthenticated"},
    {"an unknown token", "GET /v1/jobs HTTP/1.1\r\nHOSTAuthorization: Bearer pc_none_0123\r\n\r\n",
     401, "unauthenticated"},
    {"who claims to be another",
     "GET /v1/jobs HTTP/1.1\r\nHOSTX-Forwarded-User: root\r\nX-Forwarded-For: 127.0.0.1\r\n"
     "Forwarded: for=127.0.0.1\r\nX-Remote-User: admin\r\n\r\n",
     401, "unauthenticated"},
    {"no such path", "GET /v2/jobs HTTP/1.1\r\nHOSTAUTH\r\n", 404, "not-found"},
    {"no such path without a token", "GET /v2/jobs HTTP/1.1\r\nHOST\r\n", 404, "not-found"},
    {"a slash at the end", "GET /v1/jobs/ HTTP/1.1\r\nHOSTAUTH\r\n", 404, "not-found"},
    {"two slashes", "GET //v1/jobs HTTP/1.1\r\nHOSTAUTH\r\n", 404, "not-found"},
    {"a path in capital letters", "GET /V1/JOBS HTTP/1.1\r\nHOSTAUTH\r\n", 404, "not-found"},
    {"dots", "GET /v1/../etc/passwd HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"encoded dots", "GET /v1/designs/%2e%2e/content HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"an encoded slash", "GET /v1/designs/a%2Fb HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"an encoded backslash", "GET /v1/designs/a%5Cb HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"an encoded zero byte", "GET /v1/designs/a%00 HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"an encoded line feed", "GET /v1/designs/a%0Ab HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"half a percent", "GET /v1/designs/a%4 HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"an overlong slash", "GET /v1/designs/%C0%AF HTTP/1.1\r\nHOSTAUTH\r\n", 400, "bad-request"},
    {"DELETE of all jobs", "DELETE /v1/jobs HTTP/1.1\r\nHOSTAUTH\r\n", 405, "method-not-allowed"},
    {"OPTIONS", "OPTIONS /v1/jobs HTTP/1.1\r\nHOSTAUTH\r\n", 405, "method-not-allowed"},
    {"TRACE", "TRACE /v1/jobs HTTP/1.1\r\nHOSTAUTH\r\n", 405, "method-not-allowed"},
    {"an unknown method", "BREW /v1/jobs HTTP/1.1\r\nHOSTAUTH\r\n", 405, "method-not-allowed"},
    {"an action by GET", "GET /v1/jobs/X/actions/start HTTP/1.1\r\nHOSTAUTH\r\n", 405,
     "method-not-allowed"},
    {"GET with a body", "GET /v1/jobs HTTP/1.1\r\nHOSTAUTHContent-Length: 2\r\n\r\n{}", 400,
     "bad-request"},
    {"a body that is too long",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHContent-Type: application/json\r\nKEY"
     "Content-Length: 262145\r\n\r\n",
     413, "too-large"},
    {"a body of ten gigabytes",
     "POST /v1/designs HTTP/1.1\r\nHOSTAUTHContent-Type: image/svg+xml\r\n"
     "Content-Length: 10737418240\r\n\r\n",
     413, "too-large"},
    {"a form",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: "
     "application/x-www-form-urlencoded\r\nContent-Length: 2\r\n\r\n{}",
     415, "unsupported-media"},
    {"text",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: text/plain\r\n"
     "Content-Length: 2\r\n\r\n{}",
     415, "unsupported-media"},
    {"no type", "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Length: 2\r\n\r\n{}", 415,
     "unsupported-media"},
    {"JSON in another alphabet",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: application/json; charset=utf-16\r\n"
     "Content-Length: 2\r\n\r\n{}",
     415, "unsupported-media"},
    {"a packed body",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: application/json\r\n"
     "Content-Encoding: gzip\r\nContent-Length: 2\r\n\r\n{}",
     415, "unsupported-media"},
    {"a multipart upload",
     "POST /v1/designs HTTP/1.1\r\nHOSTAUTHContent-Type: multipart/form-data; boundary=x\r\n"
     "Content-Length: 2\r\n\r\n{}",
     415, "unsupported-media"},
    {"another page",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYOrigin: http://evil.example\r\n"
     "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}",
     403, "forbidden"},
    {"a page that hides where it is from",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYOrigin: null\r\n"
     "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}",
     403, "forbidden"},
    {"a page on another port of this machine",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYOrigin: http://localhost:1\r\n"
     "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}",
     403, "forbidden"},
    {"a page of the same site",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYSec-Fetch-Site: same-site\r\n"
     "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}",
     403, "forbidden"},
    {"an unknown expectation",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYExpect: tea\r\n"
     "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}",
     400, "bad-request"},
    {"a chunk of a wrong size",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: application/json\r\n"
     "Transfer-Encoding: chunked\r\n\r\nzz\r\n{}\r\n0\r\n\r\n",
     400, "bad-request"},
    {"a chunk without its end",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: application/json\r\n"
     "Transfer-Encoding: chunked\r\n\r\n2\r\n{}garbage\r\n0\r\n\r\n",
     400, "bad-request"},
    {"a chunk beyond the limit",
     "POST /v1/jobs HTTP/1.1\r\nHOSTAUTHKEYContent-Type: application/json\r\n"
     "Transfer-Encoding: chunked\r\n\r\nfffff\r\n" +
         std::string(300'000, ' '),
     413, "too-large"},
    {"a name in the query twice", "GET /v1/jobs?limit=1&limit=2 HTTP/1.1\r\nHOSTAUTH\r\n", 400,
     "bad-request"},
    {"an unknown name in the query", "GET /v1/jobs?limitt=1 HTTP/1.1\r\nHOSTAUTH\r\n", 422,
     "validation"},
};

}  // namespace

TEST_CASE("an ambiguous request is refused and the connection ends", "[daemon][http][door]") {
  const LiveServer server;
  for (const RawCase& one : kRefused) {
    CAPTURE(one.name);
    RawConnection connection = server.connect();
    connection.send(filled(one.bytes, server));
    // A second request on the same connection, which must never be answered.
    connection.send(filled("GET /healthz HTTP/1.1\r\nHOST\r\n", server));
    const WireResponse response = connection.receive();
    CHECK(response.status == one.status);
    CHECK(response.problem() == one.problem);
    if (one.status == 400) {
      CHECK(response.headers.count("connection") == 1);
      CHECK(connection.receive(2).status == 0);
    }
  }
  CHECK(server.fetch("GET", "/healthz", "").status == 200);
}

TEST_CASE("each fault of a request has its own problem type", "[daemon][http][door]") {
  const LiveServer server(
      [](HttpOptions& options) { options.limits.failed_logins_per_minute = 99; });
  for (const RawCase& one : kAnswered) {
    CAPTURE(one.name);
    RawConnection connection = server.connect();
    connection.send(filled(one.bytes, server));
    const WireResponse response = connection.receive();
    CHECK(response.status == one.status);
    CHECK(response.problem() == one.problem);
    if (one.status >= 400) {
      CHECK(response.headers.at("content-type") == "application/problem+json");
      CHECK(response.body.find("\"request_id\":\"" + response.headers.at("x-request-id")) !=
            std::string::npos);
    }
    CHECK(response.headers.at("x-content-type-options") == "nosniff");
    CHECK(response.headers.count("access-control-allow-origin") == 0);
    CHECK(response.headers.count("set-cookie") == 0);
  }
  CHECK(kRefused.size() + kAnswered.size() >= 60);
  CHECK(server.spools() == 0);
}

TEST_CASE("chunks in all valid forms make one body", "[daemon][http][door]") {
  LiveServer server;
  const std::string body = fmt::format(R"({{"design":"{}","name":"chunked"}})", server.design());
  const std::string head =
      server.request("POST", "/v1/jobs", "submitter", acting() + "Transfer-Encoding: chunked\r\n");
  for (std::size_t piece : {std::size_t{1}, std::size_t{7}, body.size()}) {
    CAPTURE(piece);
    std::string chunks;
    for (std::size_t at = 0; at < body.size(); at += piece)
      chunks += fmt::format("{:x};note=\"a\"\r\n{}\r\n", body.substr(at, piece).size(),
                            body.substr(at, piece));
    chunks += "0\r\nX-Trailer: a\r\n\r\n";
    RawConnection connection = server.connect();
    connection.send(head);
    // Byte by byte, so that each boundary falls between two reads once.
    for (const char c : chunks) connection.send(std::string_view(&c, 1));
    CHECK(connection.receive().status == 201);
    // The same key: the requests differ in their chunks only, and are one.
    CHECK(server.jobs() == 1);
  }
}

TEST_CASE("requests that are sent together are answered one after the other",
          "[daemon][http][door]") {
  const LiveServer server;
  RawConnection connection = server.connect();
  const std::string one = server.request("GET", "/v1/devices");
  connection.send(one + server.request("GET", "/v1/jobs") + server.request("GET", "/none") + one);
  CHECK(connection.receive().status == 200);
  CHECK(connection.receive().status == 200);
  CHECK(connection.receive().status == 404);
  CHECK(connection.receive().status == 200);
}

TEST_CASE("HTTP/1.0 and Connection: close end the connection after the answer",
          "[daemon][http][door]") {
  const LiveServer server;
  for (const std::string& bytes :
       {filled("GET /healthz HTTP/1.0\r\nHOST\r\n", server),
        filled("GET /healthz HTTP/1.1\r\nHOSTConnection: close\r\n\r\n", server)}) {
    RawConnection connection = server.connect();
    connection.send(bytes);
    CHECK(connection.receive().status == 200);
    CHECK(connection.closes());
  }
}

TEST_CASE("100 Continue is sent only if the request may have its body", "[daemon][http][door]") {
  LiveServer server;
  const std::string expect = "Expect: 100-continue\r\n";
  const std::string body = fmt::format(R"({{"design":"{}"}} )", server.design());
  RawConnection good = server.connect();
  good.send(
      server.request("POST", "/v1/jobs", "submitter",
                     fmt::format("{}{}Content-Length: {}\r\n", acting(), expect, body.size())));
  CHECK(good.receive_until("\r\n\r\n") == "HTTP/1.1 100 Continue\r\n\r\n");
  good.send(body);
  CHECK(good.receive().status == 201);

  RawConnection bad = server.connect();
  bad.send(server.request("POST", "/v1/jobs", "submitter",
                          acting() + expect + "Content-Length: 999999\r\n"));
  CHECK(bad.receive().status == 413);
  CHECK(bad.closes());
}

}  // namespace http_front_door_test
