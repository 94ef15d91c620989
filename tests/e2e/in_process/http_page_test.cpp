// SPDX-License-Identifier: MIT
// The files of the page: who gets them, with which headers, and what is no file of it.
#include <atomic>

#include <fmt/format.h>
#include <zlib.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/http/api/page_response.hpp"
#include "tests/support/raw_http.hpp"

namespace http_page_test {

using namespace popcut::daemon;
using http::PageFile;
using http::Response;

namespace {

std::string address_of(const PageFile& file) {
  return file.name.empty() ? "/" : fmt::format("/page/{}", file.name);
}

const PageFile& any_file() { return http::page_files().back(); }

std::string value_of(const Response& response, std::string_view name) {
  for (const http::Header& header : response.headers)
    if (header.name == name) return header.value;
  return {};
}

std::string gzip_of(const std::string& text) {
  std::string in = text, out(text.size() + 1024, '\0');
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
    "require-trusted-types-for 'script'; trusted-types 'none'";

void check_safety(const WireResponse& response) {
  CHECK(response.headers.at("content-security-policy") == kPolicy);
  CHECK(response.headers.at("cross-origin-opener-policy") == "same-origin-allow-popups");
  CHECK(response.headers.at("permissions-policy") ==
        "usb=(), serial=(), camera=(), microphone=(), geolocation=(), screen-wake-lock=(self)");
  CHECK(response.headers.at("x-content-type-options") == "nosniff");
  CHECK(response.headers.at("referrer-policy") == "no-referrer");
  CHECK(response.headers.at("cross-origin-resource-policy") == "same-origin");
  CHECK(response.headers.at("vary") == "Accept-Encoding");
  CHECK(response.headers.count("set-cookie") == 0);
  CHECK(response.headers.count("access-control-allow-origin") == 0);
}

}  // namespace

TEST_CASE("the page and its files need no token and say what a browser may do with them",
          "[daemon][http][page]") {
  LiveServer server;
  REQUIRE(http::page_files().front().name.empty());
  REQUIRE(http::page_files().size() > 1);
  for (const PageFile& file : http::page_files()) {
    const std::string address = address_of(file);
    CAPTURE(address);
    const WireResponse plain = server.fetch("GET", address, "");
    CHECK(plain.status == 200);
    CHECK(plain.headers.at("content-type") == file.media_type);
    CHECK(plain.headers.count("content-encoding") == 0);
    CHECK(plain.headers.at("cache-control") ==
          (file.name.empty() ? "no-cache" : "public, max-age=31536000, immutable"));
    check_safety(plain);
    CHECK_FALSE(plain.body.empty());
    const WireResponse packed =
        server.fetch("GET", address, "", "Accept-Encoding: gzip, deflate, br, zstd\r\n");
    CHECK(packed.status == 200);
    CHECK((packed.headers.count("content-encoding") == 1) == file.is_gzip);
    CHECK(packed.body == file.bytes);
    CHECK((packed.headers.at("etag") != plain.headers.at("etag")) == file.is_gzip);
  }
  CHECK(server.fetch("GET", "/", "").body.find("<!doctype html>") == 0);
  // A token that has ended is no reason to refuse what everyone gets.
  CHECK(server.fetch("GET", "/", "", "Authorization: Bearer pc_gone_0123456789\r\n").status == 200);
  RawConnection local(server.socket_path());
  local.send("GET / HTTP/1.1\r\nHost: popcut\r\n\r\n");
  CHECK(local.receive().status == 200);
}

TEST_CASE("a page that a browser has is not sent again and keeps its policy",
          "[daemon][http][page]") {
  LiveServer server;
  for (const PageFile* file : {&http::page_files().front(), &any_file()}) {
    const std::string address = address_of(*file);
    const WireResponse first = server.fetch("GET", address, "");
    const std::string etag = first.headers.at("etag");
    CAPTURE(address, etag);
    for (const std::string& seen : {etag, "\"x\", " + etag, std::string("*"), "W/" + etag}) {
      const WireResponse same =
          server.fetch("GET", address, "", fmt::format("If-None-Match: {}\r\n", seen));
      CHECK(same.status == 304);
      CHECK(same.body.empty());
      CHECK(same.headers.at("etag") == etag);
      CHECK(same.headers.at("cache-control") == first.headers.at("cache-control"));
      CHECK(same.headers.count("content-type") == 0);
      check_safety(same);  // it takes the place of what the browser has kept
    }
    CHECK(server.fetch("GET", address, "", "If-None-Match: \"other\"\r\n").status == 200);
    RawConnection connection = server.connect();
    connection.send(server.request("HEAD", address, ""));
    const WireResponse head = connection.receive(60, true);
    CHECK(head.status == 200);
    CHECK(head.headers.at("content-length") == std::to_string(first.body.size()));
    CHECK(head.headers.at("etag") == etag);
    // The connection goes on: HEAD had no body.
    connection.send(server.request("GET", address, "", "Range: bytes=0-3\r\n"));
    const WireResponse whole = connection.receive();
    CHECK(whole.status == 200);  // ranges are not served; the whole file is a right answer
    CHECK(whole.body == first.body);
  }
}

TEST_CASE("what is no file of the page is refused in words and never looked for on the disk",
          "[daemon][http][page]") {
  LiveServer server;
  for (const char* name : {"/page/none.js", "/page/index.html", "/page/stamp", "/page/%00",
                           "/page/plain.css%20", "/page/PLAIN.CSS", "/page/.gitignore"}) {
    CAPTURE(name);
    const WireResponse gone = server.fetch("GET", name, "");
    CHECK((gone.status == 404 || gone.status == 400));
    CHECK(gone.headers.at("content-type") == "application/problem+json");
    if (gone.status == 404) CHECK(gone.body.find("reload the page") != std::string::npos);
  }
  for (const char* name :
       {"/page", "/page/", "/page/..", "/page/../", "/page/%2e%2e", "/page/%2e%2e/", "/page/.",
        "/page/%2e%2e%2f%2e%2e%2fetc%2fpasswd", "/page/..%5c..%5cetc", "/page/a/b", "//", "/..",
        "/page//", "/page//etc/passwd", "/page/../../etc/passwd", "/index.html", "/favicon.ico"}) {
    CAPTURE(name);
    const WireResponse gone = server.fetch("GET", name, "");
    CHECK((gone.status == 404 || gone.status == 400));
    CHECK(gone.body.find("root:") == std::string::npos);
  }
  const std::string address = address_of(any_file());
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS"}) {
    CAPTURE(method);
    const WireResponse refused = server.fetch(method, address, "");
    CHECK(refused.status == 405);
    CHECK(refused.headers.at("allow") == "GET, HEAD");
    CHECK(server.fetch(method, "/", "").status == 405);
  }
  CHECK(server.fetch("GET", "/", "", "", "{}").status == 400);
  RawConnection elsewhere = server.connect();
  elsewhere.send("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  CHECK(elsewhere.receive().status == 421);
}

TEST_CASE("the page is served however often, and when the service is not answering",
          "[daemon][http][page]") {
  std::atomic<bool> is_busy{false};
  LiveServer server([&](HttpOptions& options) {
    options.limits.rate_per_s = 0.001;
    options.limits.rate_burst = 2;
    options.on_service = [&is_busy, take = options.on_service](std::function<void()> work) {
      return !is_busy && take(std::move(work));
    };
  });
  RawConnection connection = server.connect();
  const std::string request = server.request("GET", address_of(any_file()), "");
  is_busy = true;
  for (int i = 0; i < 200; ++i) {
    connection.send(request);
    REQUIRE(connection.receive().status == 200);
  }
  is_busy = false;
  // Nor does it use up what its user may ask of the rest.
  CHECK(server.fetch("GET", "/v1/meta", "viewer").status == 200);
  CHECK(server.fetch("GET", "/v1/meta", "viewer").status == 200);
  CHECK(server.fetch("GET", "/v1/meta", "viewer").status == 429);
  CHECK(server.fetch("GET", "/", "viewer").status == 200);
}

TEST_CASE("a file of the page is sent packed to who takes gzip and as it is to all others",
          "[daemon][http][page]") {
  std::string text;
  for (int i = 0; i < 40'000; ++i) text += fmt::format("line {};\n", i);
  const std::string packed = gzip_of(text);
  const PageFile file{"main-1.js", "text/javascript; charset=utf-8", "0123456789abcdef", packed,
                      true};
  for (const char* takes : {"gzip", "GZIP", "br;q=1.0, gzip;q=0.8, *;q=0.1", "*", "x-gzip",
                            "deflate , gzip ; q=0.001", "identity;q=0, *;q=1"}) {
    CAPTURE(takes);
    const Response response = http::page_response(file, takes);
    CHECK(response.body == packed);
    CHECK(value_of(response, "Content-Encoding") == "gzip");
    CHECK(value_of(response, "ETag") == "\"0123456789abcdef-gzip\"");
  }
  for (const char* takes : {"", "identity", "br", "gzip;q=0", "gzip;q=0.000, *", "*;q=0", "gzipped",
                            "br, gzip;q=0, deflate", ",,,", ";q=1", "notgzip"}) {
    CAPTURE(takes);
    const Response response = http::page_response(file, takes);
    CHECK(response.body == text);
    CHECK(value_of(response, "Content-Encoding").empty());
    CHECK(value_of(response, "ETag") == "\"0123456789abcdef\"");
  }
  // Every packed file of the program is a whole gzip.
  for (const PageFile& one : http::page_files())
    CHECK_FALSE(http::page_response(one, "").body.empty());
}

TEST_CASE("meta tells which page the program has", "[daemon][http][page]") {
  LiveServer server;
  const auto meta = nlohmann::json::parse(server.fetch("GET", "/v1/meta", "viewer").body);
  CHECK(meta.at("page") == std::string(http::page_stamp().substr(0, 12)));
  CHECK((http::page_stamp().empty() || http::page_stamp().size() == 64));
}

}  // namespace http_page_test
