// SPDX-License-Identifier: MIT
#include "tests/support/fault_proxy.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <deque>
#include <future>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <boost/asio.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "tests/support/postgres_server.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Socket = asio::generic::stream_protocol::socket;
using Endpoint = asio::generic::stream_protocol::endpoint;
using Tcp = asio::ip::tcp;
using Local = asio::local::stream_protocol;

constexpr std::size_t kMostWaiting = std::size_t{4} << 20;   // then it reads no more
constexpr std::size_t kMostRecorded = std::size_t{1} << 20;  // of a connection

Endpoint endpoint_of(const std::string& server) {
  if (server.substr(0, 1) == "/") return Local::endpoint(server);
  const std::size_t colon = server.rfind(':');
  if (colon == std::string::npos) throw std::runtime_error(server + ": no host:port");
  return Tcp::endpoint(asio::ip::make_address(server.substr(0, colon)),
                       static_cast<std::uint16_t>(std::stoi(server.substr(colon + 1))));
}

}  // namespace

/// All that happens on the thread of the proxy.
class FaultProxy::Network {
 public:
  /// What cut_at waits for.
  struct Cut {
    std::string text;
    Lost lost;
    std::string after;
  };

  explicit Network(const std::string& server);
  ~Network();

  /// `work()` on the thread of the network; what it returns.
  template <typename Work>
  auto on(const Work& work) {
    std::packaged_task<std::invoke_result_t<Work>()> task(work);
    auto done = task.get_future();
    asio::post(context_, [&task] { task(); });
    return done.get();
  }
  void listen();
  void stop_listening();
  void pass(Way way);
  void cut_all();
  void cut_next(Cut next);
  [[nodiscard]] std::string socket() const { return folder_ / ".s.PGSQL.5432"; }
  [[nodiscard]] const TempFolder& folder() const { return folder_; }

  struct Direction {
    std::chrono::milliseconds delay{0};
    bool held{false};
    std::optional<std::size_t> left;  // until a cut
    std::size_t passed{0};
  };
  struct Connection;

  Direction& direction(Way way) { return directions_[static_cast<std::size_t>(way)]; }
  [[nodiscard]] bool cut_to_come();

  const Endpoint server;
  std::uint16_t port{0};
  bool records{false};
  std::vector<std::shared_ptr<std::string>> recordings;
  std::size_t accepted{0}, turns{0};
  std::set<std::shared_ptr<Connection>> connections;

 private:
  using Alive = std::shared_ptr<Connection>;
  template <typename Acceptor>
  void accept(Acceptor& acceptor);
  void begin(Socket client);
  void read(const Alive& alive, Way way);
  void take(const Alive& alive, Way way, std::size_t count);
  void pump(const Alive& alive, Way way);
  void write(const Alive& alive, Way way);
  /// How much of what comes next may go; less than `size`: then the connection is cut.
  std::size_t allowance(Connection& connection, Way way, const std::string& bytes);
  static bool passes(std::string& seen, const std::string& text);
  void end(const Alive& alive, Way way);
  void cut(const Alive& alive);
  void forget(const Alive& alive);

  std::optional<Cut> cut_at_;
  TempFolder folder_;
  asio::io_context context_;
  asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
  Tcp::socket reservation_{context_};  // keeps the port while nobody listens
  Tcp::acceptor tcp_{context_};
  Local::acceptor local_{context_};
  std::array<Direction, 2> directions_;
  std::thread thread_;
};

struct FaultProxy::Network::Connection {
  /// What one side has sent and the other has not got.
  struct Stream {
    struct Piece {
      std::string bytes;  // none: the end
      Clock::time_point due;
    };
    Socket from;
    asio::steady_timer timer;
    std::deque<Piece> waiting{};
    std::size_t waiting_bytes{0};
    bool reading{false}, writing{false};
    bool nobody{false};  // takes it any more
    bool ended{false};
    std::array<char, 65536> buffer{};
  };
  Connection(asio::io_context& context, Socket client)
      : streams{{{std::move(client), asio::steady_timer(context)},
                 {Socket(context), asio::steady_timer(context)}}} {}
  Stream& stream(Way way) { return streams[static_cast<std::size_t>(way)]; }
  Socket& target(Way way) { return streams[1 - static_cast<std::size_t>(way)].from; }

  std::array<Stream, 2> streams;
  std::shared_ptr<std::string> recording;
  std::string seen;  // the last bytes from the client, in which the text of a cut may begin
  bool has_begun{};  // the client has said what the text of the cut comes after
  bool answered{false}, answer_lost{false}, gone{false};
};

FaultProxy::Network::Network(const std::string& at) : server(endpoint_of(at)) {
  reservation_.open(Tcp::v4());
  reservation_.set_option(asio::socket_base::reuse_address(true));
  reservation_.bind({asio::ip::address_v4::loopback(), 0});
  port = reservation_.local_endpoint().port();
  listen();
  thread_ = std::thread([this] { context_.run(); });
}

FaultProxy::Network::~Network() {
  on([this] {
    stop_listening();
    cut_all();
  });
  work_.reset();
  thread_.join();
}

void FaultProxy::Network::listen() {
  if (tcp_.is_open()) return;
  ::unlink(socket().c_str());
  local_.open();
  local_.bind(socket());
  local_.listen();
  tcp_.open(Tcp::v4());
  tcp_.set_option(asio::socket_base::reuse_address(true));
  tcp_.bind({asio::ip::address_v4::loopback(), port});
  tcp_.listen();
  accept(local_);
  accept(tcp_);
}

void FaultProxy::Network::stop_listening() {
  error_code ignored;
  tcp_.close(ignored);
  local_.close(ignored);
}

template <typename Acceptor>
void FaultProxy::Network::accept(Acceptor& acceptor) {
  acceptor.async_accept([this, &acceptor](const error_code& error, auto client) {
    if (!error) begin(Socket(std::move(client)));
    if (acceptor.is_open() && error != asio::error::operation_aborted) accept(acceptor);
  });
}

void FaultProxy::Network::begin(Socket client) {
  ++accepted;
  auto made = std::make_shared<Connection>(context_, std::move(client));
  if (records) {
    made->recording = std::make_shared<std::string>();
    recordings.push_back(made->recording);
  }
  connections.insert(made);
  made->target(Way::ToServer).async_connect(server, [this, made](const error_code& error) {
    if (error) return cut(made);
    read(made, Way::ToServer);
    read(made, Way::ToClient);
  });
}

void FaultProxy::Network::read(const Alive& alive, Way way) {
  Connection::Stream& stream = alive->stream(way);
  if (stream.reading || stream.ended || alive->gone || stream.waiting_bytes > kMostWaiting) return;
  stream.reading = true;
  stream.from.async_read_some(asio::buffer(stream.buffer),
                              [this, alive, way](const error_code& error, std::size_t count) {
                                alive->stream(way).reading = false;
                                if (alive->gone) return;
                                take(alive, way, error ? 0 : count);
                                pump(alive, way);
                                read(alive, way);
                              });
}

void FaultProxy::Network::take(const Alive& alive, Way way, std::size_t count) {
  Connection::Stream& stream = alive->stream(way);
  stream.ended = count == 0;
  std::string bytes(stream.buffer.data(), count);
  if (way == Way::ToServer && alive->recording && alive->recording->size() <= kMostRecorded)
    *alive->recording += bytes;
  if (way == Way::ToServer && count > 0 && alive->answered) ++turns;
  alive->answered = way == Way::ToClient;
  if (stream.nobody && !stream.ended) return;
  stream.waiting_bytes += count;
  stream.waiting.push_back({std::move(bytes), Clock::now() + direction(way).delay});
}

void FaultProxy::Network::pump(const Alive& alive, Way way) {
  Connection::Stream& stream = alive->stream(way);
  if (stream.writing || stream.waiting.empty() || direction(way).held || alive->gone) return;
  if (stream.waiting.front().due <= Clock::now()) return write(alive, way);
  stream.timer.expires_at(stream.waiting.front().due);
  stream.timer.async_wait([this, alive, way](const error_code& error) {
    if (!error) pump(alive, way);
  });
}

void FaultProxy::Network::write(const Alive& alive, Way way) {
  Connection::Stream& stream = alive->stream(way);
  const std::string& bytes = stream.waiting.front().bytes;
  if (bytes.empty()) return end(alive, way);
  const std::size_t size = bytes.size(), allowed = allowance(*alive, way, bytes);
  stream.writing = true;
  asio::async_write(alive->target(way), asio::buffer(bytes.data(), allowed),
                    [this, alive, way, size, allowed](const error_code& error, std::size_t count) {
                      Connection::Stream& written = alive->stream(way);
                      written.writing = false;
                      direction(way).passed += count;
                      if (alive->gone) return;
                      if (allowed < size) return cut(alive);
                      written.waiting_bytes -= size;
                      written.waiting.pop_front();
                      // Its end goes the other way, as all else that is on that way.
                      if (error) written.nobody = true;
                      pump(alive, way);
                      read(alive, way);
                    });
}

// Takes off `seen` what cannot be the beginning of a later `text`, or all up to its end if it is
// there.
bool FaultProxy::Network::passes(std::string& seen, const std::string& text) {
  const std::size_t at = seen.find(text);
  if (at != std::string::npos) {
    seen.erase(0, at + text.size());
    return true;
  }
  if (seen.size() >= text.size()) seen.erase(0, seen.size() - text.size() + 1);
  return false;
}

std::size_t FaultProxy::Network::allowance(Connection& connection, Way way,
                                           const std::string& bytes) {
  if (way == Way::ToClient && connection.answer_lost) return 0;
  if (way == Way::ToServer && cut_at_) {
    connection.seen += bytes;
    if (!connection.has_begun) connection.has_begun = passes(connection.seen, cut_at_->after);
    if (connection.has_begun && passes(connection.seen, cut_at_->text)) {
      const Lost lost = cut_at_->lost;
      cut_at_.reset();
      if (lost == Lost::Request) return 0;
      connection.answer_lost = true;
    }
  }
  std::optional<std::size_t>& left = direction(way).left;
  if (!left) return bytes.size();
  if (*left >= bytes.size()) {
    *left -= bytes.size();
    return bytes.size();
  }
  return *std::exchange(left, std::nullopt);
}

void FaultProxy::Network::end(const Alive& alive, Way way) {
  alive->stream(way).waiting.clear();
  error_code ignored;
  alive->target(way).shutdown(asio::socket_base::shutdown_send, ignored);
  const Connection::Stream& other = alive->streams[1 - static_cast<std::size_t>(way)];
  if (other.ended && other.waiting.empty()) forget(alive);
}

void FaultProxy::Network::cut(const Alive& alive) {
  error_code ignored;
  for (Connection::Stream& stream : alive->streams)  // on TCP the peer gets a reset
    stream.from.set_option(asio::socket_base::linger(true, 0), ignored);
  forget(alive);
}

void FaultProxy::Network::forget(const Alive& alive) {
  if (std::exchange(alive->gone, true)) return;
  error_code ignored;
  for (Connection::Stream& stream : alive->streams) {
    stream.from.close(ignored);
    stream.timer.cancel();
  }
  connections.erase(alive);
}

void FaultProxy::Network::cut_all() {
  while (!connections.empty()) cut(Alive(*connections.begin()));
}

void FaultProxy::Network::pass(Way way) {
  direction(way).held = false;
  const std::set<Alive> all = connections;
  for (const Alive& one : all) pump(one, way);
}

bool FaultProxy::Network::cut_to_come() {
  return cut_at_ || direction(Way::ToServer).left || direction(Way::ToClient).left ||
         std::any_of(connections.begin(), connections.end(),
                     [](const Alive& one) { return one->answer_lost; });
}

void FaultProxy::Network::cut_next(Cut next) {
  cut_at_ = std::move(next);
  for (const Alive& one : connections) {
    one->seen.clear();
    one->has_begun = false;
  }
}

FaultProxy::FaultProxy(const std::string& server) : network_(std::make_unique<Network>(server)) {}
FaultProxy::~FaultProxy() = default;

std::string FaultProxy::url(const std::string& database, const std::string& user) const {
  return postgres_url(network_->folder().path().string(), 5432, database, user);
}

std::string FaultProxy::tcp_url(const std::string& database, const std::string& user,
                                const std::string& password) const {
  return postgres_url("127.0.0.1", port(), database, user, password);
}

std::string FaultProxy::socket() const { return network_->socket(); }
std::uint16_t FaultProxy::port() const { return network_->port; }

void FaultProxy::delay(Way way, std::chrono::milliseconds by) {
  network_->on([&] { network_->direction(way).delay = by; });
}

void FaultProxy::hold(Way way) {
  network_->on([&] { network_->direction(way).held = true; });
}

void FaultProxy::pass(Way way) {
  network_->on([&] { network_->pass(way); });
}

void FaultProxy::hold() {
  network_->on([&] {
    for (const Way way : {Way::ToServer, Way::ToClient}) network_->direction(way).held = true;
  });
}

void FaultProxy::pass() {
  network_->on([&] {
    for (const Way way : {Way::ToServer, Way::ToClient}) network_->pass(way);
  });
}

void FaultProxy::cut_all() {
  network_->on([&] { network_->cut_all(); });
}

void FaultProxy::refuse(bool yes) {
  network_->on([&] { yes ? network_->stop_listening() : network_->listen(); });
}

void FaultProxy::cut_after(Way way, std::size_t bytes) {
  network_->on([&] { network_->direction(way).left = bytes; });
}

void FaultProxy::cut_at(const std::string& text, Lost lost, const std::string& after) {
  network_->on([&] { network_->cut_next({text, lost, after}); });
}

bool FaultProxy::cut_to_come() const {
  return network_->on([&] { return network_->cut_to_come(); });
}

void FaultProxy::record(bool yes) {
  network_->on([&] { network_->records = yes; });
}

std::size_t FaultProxy::recordings() const {
  return network_->on([&] { return network_->recordings.size(); });
}

std::string FaultProxy::recorded(std::size_t which) const {
  std::string bytes = network_->on([&] { return *network_->recordings.at(which); });
  if (bytes.size() > kMostRecorded) throw std::runtime_error("too many bytes to be recorded");
  return bytes;
}

std::string FaultProxy::replay(const std::string& bytes, std::chrono::milliseconds patience) const {
  asio::basic_socket_iostream<asio::generic::stream_protocol> second;
  second.expires_after(patience);
  second.connect(network_->server);
  second << bytes << std::flush;
  second.socket().shutdown(asio::socket_base::shutdown_send);
  const std::string answer{std::istreambuf_iterator<char>(second), {}};
  if (second.error() == asio::error::timed_out)
    throw std::runtime_error("the server does not end the second connection");
  return answer;
}

std::size_t FaultProxy::connections() const {
  return network_->on([&] { return network_->connections.size(); });
}

std::size_t FaultProxy::accepted() const {
  return network_->on([&] { return network_->accepted; });
}

std::size_t FaultProxy::turns() const {
  return network_->on([&] { return network_->turns; });
}

std::size_t FaultProxy::passed(Way way) const {
  return network_->on([&] { return network_->direction(way).passed; });
}

}  // namespace popcut::testing
