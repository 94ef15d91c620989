// SPDX-License-Identifier: MIT
#include "daemon/http/wire.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/basic_parser.hpp>
#include <boost/beast/http/error.hpp>

#include "daemon/http/head.hpp"

namespace popcut::daemon::http {
namespace {

namespace bhttp = boost::beast::http;
using boost::beast::error_code;
using Text = boost::beast::string_view;

std::string_view view(Text text) { return {text.data(), text.size()}; }

// The longest line of chunk sizes or trailers. No client needs a longer one.
constexpr std::size_t kLongestChunkHead = 4096;

}  // namespace

class RequestReader::Parser : public bhttp::basic_parser<true> {
 public:
  RequestHead head;
  const Sink* sink{nullptr};
  std::optional<Problem> problem;
  std::uint64_t most_bytes{0}, got_bytes{0};
  bool head_done{false};

 private:
  void on_request_impl(bhttp::verb, Text method, Text target, int version, error_code&) override {
    head.method = method_from(view(method));
    head.target = std::string(view(target));
    head.is_http_1_0 = version == 10;
  }
  void on_response_impl(int, Text, int, error_code&) override {}
  void on_field_impl(bhttp::field, Text name, Text value, error_code&) override {
    if (!head_done) head.headers.push_back({to_lower(view(name)), std::string(view(value))});
  }
  void on_header_impl(error_code&) override {
    head_done = true;
    if (content_length()) head.content_length = *content_length();
    head.is_chunked = chunked();
    head.asks_close = !keep_alive() || head.is_http_1_0;
  }
  void on_body_init_impl(const boost::optional<std::uint64_t>&, error_code&) override {}
  std::size_t on_body_impl(Text body, error_code& ec) override { return take(body, ec); }
  void on_chunk_header_impl(std::uint64_t, Text, error_code&) override {}
  std::size_t on_chunk_body_impl(std::uint64_t, Text body, error_code& ec) override {
    return take(body, ec);
  }
  void on_finish_impl(error_code&) override {}

  std::size_t take(Text body, error_code& ec) {
    got_bytes += body.size();
    if (got_bytes > most_bytes)
      problem = Problem{ProblemKind::TooLarge,
                        fmt::format("the body is longer than {} bytes", most_bytes)};
    else
      problem = (*sink)(view(body));
    if (problem) ec = bhttp::error::body_limit;
    return body.size();
  }
};

RequestReader::RequestReader(std::size_t header_bytes) : header_bytes_(header_bytes) { next(); }
RequestReader::~RequestReader() = default;

void RequestReader::append(std::string_view bytes) { pending_ += bytes; }

bool RequestReader::has_begun() const { return parser_->head_done || !pending_.empty(); }

void RequestReader::next() {
  parser_ = std::make_unique<Parser>();
  parser_->header_limit(static_cast<std::uint32_t>(header_bytes_ + 4));
  // Beast's own limit is out of the way, since `read_body` counts.
  parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
  scanned_ = 0;
}

const RequestHead& RequestReader::head() const { return parser_->head; }

bool RequestReader::is_done() const { return parser_->is_done(); }

Answer<bool> RequestReader::read_head() {
  if (parser_->head_done) return true;
  const std::size_t end = pending_.find("\r\n\r\n", scanned_);
  const std::size_t size = end == std::string::npos ? pending_.size() : end + 4;
  if (size > header_bytes_)
    return refuse(ProblemKind::TooLarge,
                  fmt::format("the head of the request is longer than {} bytes", header_bytes_));
  if (end == std::string::npos) {
    scanned_ = pending_.size() < 3 ? 0 : pending_.size() - 3;
    return false;
  }
  const std::string_view raw = std::string_view(pending_).substr(0, size);
  if (auto fault = check_head(raw)) return tl::unexpected<Problem>(std::move(*fault));
  error_code ec;
  std::size_t taken = 0;
  while (taken < size && !ec && !parser_->head_done)
    taken += parser_->put({pending_.data() + taken, size - taken}, ec);
  if (ec || !parser_->head_done || taken != size)
    return refuse(ProblemKind::BadRequest,
                  fmt::format("the head of the request cannot be read ({})", ec.message()));
  pending_.erase(0, size);
  return true;
}

Answer<bool> RequestReader::read_body(std::uint64_t most_bytes, const Sink& sink) {
  Parser& parser = *parser_;
  parser.most_bytes = most_bytes;
  parser.sink = &sink;
  std::size_t taken = 0;
  error_code ec;
  while (!parser.is_done() && taken < pending_.size()) {
    const std::size_t left = pending_.size() - taken;
    // Beast 1.74 assumes that the last chunk comes with all its five bytes.
    if (parser.head.is_chunked && left < 5) break;
    // Beast 1.74 counts a chunk again each time that its extensions go on in the next piece.
    if (parser.head.is_chunked) parser.body_limit(std::numeric_limits<std::uint64_t>::max());
    const std::size_t now = parser.put({pending_.data() + taken, left}, ec);
    taken += now;
    if (ec || now == 0) break;
  }
  pending_.erase(0, taken);
  if (parser.problem) return tl::unexpected<Problem>(*parser.problem);
  if (ec && ec != bhttp::error::need_more)
    return refuse(ProblemKind::BadRequest, fmt::format("the body is malformed ({})", ec.message()));
  if (!parser.is_done() && pending_.size() > kLongestChunkHead)
    return refuse(ProblemKind::BadRequest, "a line between two chunks is too long");
  return parser.is_done();
}

}  // namespace popcut::daemon::http
