// SPDX-License-Identifier: MIT
#include "daemon/client/http_client.hpp"

#include <array>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>

#include "daemon/client/wire.hpp"

namespace popcut::client {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace asio = boost::asio;

constexpr std::uint64_t kMostBody = std::uint64_t{256} << 20;
constexpr double kLeastBytesPerSecond = 1024;  // of an answer, after the time until it must begin
constexpr double kConnectSeconds = 5;
constexpr double kSilenceSeconds = 45;  // three heartbeats of an event stream

/// A wire as Beast wants its streams.
class WireStream {
 public:
  explicit WireStream(Wire& wire) : wire_(wire) {}
  /// Reads at most `most` bytes within `seconds`; if `most` is 0 any number, but not slower than
  /// `kLeastBytesPerSecond` after that time.
  WireStream(Wire& wire, std::uint64_t most, double seconds)
      : wire_(wire), most_(most), seconds_(seconds) {}
  template <typename Buffers>
  std::size_t read_some(const Buffers& into, beast::error_code& error) {
    // What comes without a pause never waits, and so never notices that its time is over.
    if (seconds_) {
      const double more_s = most_ > 0 ? 0 : static_cast<double>(read_) / kLeastBytesPerSecond;
      const std::chrono::duration<double> gone = Wire::Clock::now() - begun_;
      const double left_s = *seconds_ + more_s - gone.count();
      const bool is_full = most_ > 0 && read_ >= most_;
      if (is_full || left_s < 0) {
        error = is_full ? beast::error_code(http::error::body_limit)
                        : beast::error_code(asio::error::timed_out);
        return 0;
      }
      wire_.deadline_in(left_s);
    }
    const long got = wire_.read(vectors(into));
    if (got == 0 && asio::buffer_size(into) > 0) error = asio::error::eof;
    if (got > 0) read_ += static_cast<std::uint64_t>(got);
    return count(got, error);
  }
  template <typename Buffers>
  std::size_t write_some(const Buffers& from, beast::error_code& error) {
    return count(wire_.write(vectors(from)), error);
  }
  template <typename Buffers>
  std::size_t read_some(const Buffers& into) {
    return thrown([&](beast::error_code& error) { return read_some(into, error); });
  }
  template <typename Buffers>
  std::size_t write_some(const Buffers& from) {
    return thrown([&](beast::error_code& error) { return write_some(from, error); });
  }

 private:
  template <typename Buffers>
  std::span<const iovec> vectors(const Buffers& buffers) {
    std::size_t used = 0;
    for (auto it = asio::buffer_sequence_begin(buffers);
         it != asio::buffer_sequence_end(buffers) && used < vectors_.size(); ++it) {
      const asio::const_buffer one(*it);
      if (one.size() == 0) continue;
      vectors_[used++] = {const_cast<void*>(one.data()), one.size()};
    }
    return {vectors_.data(), used};
  }
  static std::size_t count(long done, beast::error_code& error) {
    if (done >= 0) return static_cast<std::size_t>(done);
    error.assign(static_cast<int>(-done), boost::system::system_category());
    return 0;
  }
  template <typename Work>
  static std::size_t thrown(const Work& work) {
    beast::error_code error;
    const std::size_t done = work(error);
    if (error) throw beast::system_error(error);
    return done;
  }
  Wire& wire_;
  std::uint64_t most_{0}, read_{0};
  std::optional<double> seconds_{};
  Wire::Clock::time_point begun_{Wire::Clock::now()};
  std::array<iovec, 16> vectors_{};
};

using Message = http::request<http::span_body<const char>>;

Message message_of(const HttpRequest& request, const Address& address, const std::string& token) {
  Message message;
  message.version(11);
  message.method_string(request.method);
  message.target(request.target);
  message.set(http::field::host, address.host_header());
  message.set(http::field::user_agent, "popcut");
  if (!token.empty()) message.set(http::field::authorization, "Bearer " + token);
  if (!request.content_type.empty()) message.set(http::field::content_type, request.content_type);
  for (const auto& [name, value] : request.headers) message.set(name, value);
  message.body() = {request.body.data(), request.body.size()};
  message.prepare_payload();
  return message;
}

template <typename Fields>
HttpResponse head_of(const Fields& fields, int status) {
  HttpResponse response;
  response.status = status;
  response.content_type = std::string(fields[http::field::content_type]);
  response.etag = std::string(fields[http::field::etag]);
  response.location = std::string(fields[http::field::location]);
  const std::string after(fields[http::field::retry_after]);
  if (!after.empty()) response.retry_after_s = std::strtod(after.c_str(), nullptr);
  return response;
}

Error broken(const Address& address, const std::string& why) {
  return {
      ErrorKind::DeviceGone, address.text(),
      fmt::format("popcutd closed the connection ({}); check that it runs, and try again", why)};
}

void pause_for(double seconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000)));
}

/// The seconds after which it makes sense to ask again, or none.
std::optional<double> busy(const HttpResponse& response) {
  constexpr double kLongestWait = 10;
  const bool in_progress =
      response.status == 409 && response.body.find("idempotency-in-progress") != std::string::npos;
  if (in_progress) return 0.2;
  if (response.status == 429 && response.retry_after_s.value_or(1) <= kLongestWait)
    return std::max(0.1, response.retry_after_s.value_or(1));
  // It is only for a moment, as popcutd says itself.
  if (response.status == 503 && response.retry_after_s.value_or(10) <= 1) return 0.3;
  return std::nullopt;
}

}  // namespace

std::string random_key() {
  static constexpr std::string_view kLetters = "0123456789abcdefghijklmnopqrstuv";
  std::random_device random;
  std::string key(32, '0');
  for (char& c : key) c = kLetters[random() % kLetters.size()];
  return key;
}

// One question at a time

struct HttpClient::Connection {
  Wire wire;
  beast::flat_buffer buffer{};
  bool used{false};
};

HttpClient::HttpClient(std::vector<Address> addresses, std::string token)
    : addresses_(std::move(addresses)), token_(std::move(token)) {}
HttpClient::~HttpClient() = default;
HttpClient::HttpClient(HttpClient&&) noexcept = default;
HttpClient& HttpClient::operator=(HttpClient&&) noexcept = default;

const Address& HttpClient::address() const { return addresses_[used_]; }

Result<void> HttpClient::connect() {
  std::optional<Error> first;
  for (std::size_t k = 0; k < addresses_.size(); ++k) {
    auto wire = Wire::connect(addresses_[k], kConnectSeconds);
    if (wire) {
      used_ = k;
      reached_ = true;
      connection_ = std::make_unique<Connection>(Connection{std::move(*wire)});
      return {};
    }
    // What is there and says no is of more use than what is not there.
    if (!first || (first->kind == ErrorKind::DeviceGone && wire.error().kind == ErrorKind::Refused))
      first = wire.error();
    else if (first->kind == wire.error().kind && first->kind == ErrorKind::DeviceGone)
      first->place += ", " + wire.error().place;
  }
  return tl::unexpected(*first);
}

Result<HttpResponse> HttpClient::ask_once(const HttpRequest& request) {
  if (!connection_)
    if (auto done = connect(); !done) return tl::unexpected(done.error());
  const Message message = message_of(request, address(), token_);
  WireStream stream(connection_->wire, request.most_bytes, request.seconds);
  connection_->wire.deadline_in(request.seconds);
  beast::error_code error, sent;
  http::write(stream, message, sent);
  // popcutd may answer before it has all: too large, no room.
  http::response_parser<http::string_body> parser;
  parser.body_limit(request.most_bytes > 0 ? request.most_bytes : kMostBody);
  if (request.method == "HEAD") parser.skip(true);
  http::read(stream, connection_->buffer, parser, error);
  if (error && !parser.is_done()) {
    connection_.reset();
    // To ask again would not help.
    if (error == http::error::body_limit)
      return fail(ErrorKind::Refused, address().text(),
                  fmt::format("sends more than {} bytes; check POPCUT_URL",
                              request.most_bytes > 0 ? request.most_bytes : kMostBody));
    if (parser.is_header_done() && error == boost::system::errc::timed_out)
      return fail(ErrorKind::Refused, address().text(),
                  "sends its answer too slowly; check the network and POPCUT_URL");
    return tl::unexpected(broken(address(), (sent ? sent : error).message()));
  }
  HttpResponse response = head_of(parser.get(), parser.get().result_int());
  response.body = std::move(parser.get().body());
  connection_->used = true;
  if (!parser.keep_alive() || sent) connection_.reset();
  return response;
}

Result<HttpResponse> HttpClient::ask(HttpRequest request) {
  if (request.method == "POST") request.headers.emplace_back("Idempotency-Key", random_key());
  double wait = 0.2;
  for (int tried = 1;; ++tried) {
    const bool fresh = !connection_ || !connection_->used;
    auto response = ask_once(request);
    const std::optional<double> again = response ? busy(*response) : std::optional<double>(wait);
    if (!again || tried > tries_) return response;
    if (!response && (!reached_ || response.error().kind == ErrorKind::Refused)) return response;
    if (!response && !fresh) continue;  // an idle connection was closed: at once, on a new one
    pause_for(*again);
    wait *= 2;
  }
}

// Events

struct EventStream::Stream {
  explicit Stream(Wire connected) : wire(std::move(connected)) {}
  Wire wire;
  beast::flat_buffer buffer{};
  http::response_parser<http::buffer_body> parser{};
  std::array<char, 4096> room{};
  Wire::Clock::time_point heard{Wire::Clock::now()};
};

EventStream::EventStream(const HttpClient& like, std::string target)
    : addresses_{like.address()}, token_(like.token()), target_(std::move(target)) {}
EventStream::~EventStream() = default;

bool EventStream::connected() const { return stream_ != nullptr; }

Result<void> EventStream::open(double seconds) {
  auto wire = Wire::connect(addresses_.front(), kConnectSeconds);
  if (!wire) return tl::unexpected(wire.error());
  auto opened = std::make_unique<Stream>(std::move(*wire));
  HttpRequest request;
  request.target = target_;
  request.headers.emplace_back("Accept", "text/event-stream");
  if (!reader_.last_id().empty()) request.headers.emplace_back("Last-Event-ID", reader_.last_id());
  WireStream stream(opened->wire);
  opened->wire.deadline_in(std::max(seconds, kConnectSeconds));
  beast::error_code error;
  const Message message = message_of(request, addresses_.front(), token_);
  http::write(stream, message, error);
  if (!error) http::read_header(stream, opened->buffer, opened->parser, error);
  if (error) return tl::unexpected(broken(addresses_.front(), error.message()));
  opened->parser.body_limit(std::numeric_limits<std::uint64_t>::max());
  reader_.restart();
  const int status = static_cast<int>(opened->parser.get().result_int());
  if (status != 200) problem_ = head_of(opened->parser.get(), status);
  stream_ = std::move(opened);
  return {};
}

Result<std::vector<SseEvent>> EventStream::next(double seconds) {
  if (!stream_)
    if (auto done = open(seconds); !done) return tl::unexpected(done.error());
  Stream& stream = *stream_;
  WireStream wire(stream.wire);
  const auto until =
      Wire::Clock::now() + std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000));
  while (!stream.parser.is_done()) {
    stream.parser.get().body() = {stream.room.data(), stream.room.size(), true};
    stream.wire.deadline_in(
        std::max(0.0, std::chrono::duration<double>(until - Wire::Clock::now()).count()));
    beast::error_code error;
    http::read_some(wire, stream.buffer, stream.parser, error);
    const std::size_t got = stream.room.size() - stream.parser.get().body().size;
    const std::string_view bytes(stream.room.data(), got);
    if (got > 0) stream.heard = Wire::Clock::now();
    if (problem_) problem_->body.append(bytes);
    auto events = problem_ ? std::vector<SseEvent>{} : reader_.feed(bytes);
    if (!events.empty()) return events;
    const bool silent =
        std::chrono::duration<double>(Wire::Clock::now() - stream.heard).count() > kSilenceSeconds;
    if (error == boost::system::errc::timed_out && !silent) return std::vector<SseEvent>{};
    if (error == boost::system::errc::interrupted) return std::vector<SseEvent>{};
    if ((error && error != http::error::need_buffer) || silent || reader_.broken()) break;
    if (Wire::Clock::now() >= until) return std::vector<SseEvent>{};
  }
  stream_.reset();
  if (problem_) return fail(ErrorKind::Refused, addresses_.front().text(), "no events");
  return std::vector<SseEvent>{};
}

}  // namespace popcut::client
