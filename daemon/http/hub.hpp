// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/asio.hpp"

#include "daemon/http/api/routes.hpp"
#include "daemon/http/event_ring.hpp"
#include "daemon/http/front_door.hpp"
#include "daemon/http/http_metrics.hpp"
#include "daemon/http/rate_limit.hpp"
#include "daemon/http/server.hpp"
#include "daemon/http/wire.hpp"

// What the coroutines of the server share. All of it belongs to the thread of HTTP, but `Link`.
namespace popcut::daemon::http {

namespace asio = boost::asio;
using Socket = asio::generic::stream_protocol::socket;
using Clock = std::chrono::steady_clock;

/// The way from other threads to the HTTP thread. Outlives the server: late work is dropped.
class Link {
 public:
  explicit Link(asio::io_context& io) : io_(&io) {}
  void post(std::function<void()> work);
  void cut();
  std::atomic<int> listeners{0};    ///< streams that run or are about to start
  std::atomic<bool> missed{false};  ///< an event was lost: all streams must restart

 private:
  std::mutex mutex_;
  asio::io_context* io_;
};

/// Work of another thread. The coroutine that waits for it resumes when the work is done, when its
/// time is over, or when its client disconnects.
struct Ticket {
  explicit Ticket(asio::io_context& io) : timer(io) {}
  asio::steady_timer timer;
  bool done{false};
};

/// A client of the event stream.
struct Stream {
  Stream(asio::io_context& io, const HttpLimits& limits)
      : ring(limits.stream_events, limits.stream_bytes), wake(io) {}
  EventRing ring;
  asio::steady_timer wake;
  bool doubted{false};  ///< its credential may have expired: check it
};

/// One connection.
struct Client {
  Client(asio::io_context& io, Socket accepted, Peer who, const HttpLimits& limits)
      : socket(std::move(accepted)), peer(std::move(who)), reader(limits.header_bytes), guard(io) {}

  enum class State { Idle, Head, Busy };
  Socket socket;
  Peer peer;
  RequestReader reader;
  asio::steady_timer guard;  ///< closes the connection when it takes too long
  std::uint64_t guard_round{0};
  State state{State::Idle};
  Clock::time_point since{Clock::now()};  ///< of `state`
  std::uint64_t served{0};
  bool reserved{false};         ///< it has a place that serves urgent requests only
  bool uploads{false};          ///< one of its bodies is being written to disk
  std::string principal{};      ///< of its last request; empty: unknown
  std::size_t answer_bytes{0};  ///< of the large answer that it is reading from memory
  bool closed{false};
  std::shared_ptr<Ticket> ticket{};
  std::shared_ptr<Stream> stream{};
  std::array<char, 16384> buffer{};

  void enter(State next);
  /// Closes the connection after `seconds`, unless called again or `relax`ed before.
  void expect_within(const std::shared_ptr<Client>& self, double seconds);
  void relax();
  void close();
};
using ClientPtr = std::shared_ptr<Client>;  // the coroutine's, the guard's and the hub's

struct Hub {
  explicit Hub(HttpOptions what);

  asio::io_context io{1};
  asio::thread_pool disk{1};
  asio::thread_pool texts{1};  ///< long answers are rendered here
  std::shared_ptr<Link> link;
  HttpOptions options;
  HandlerContext context;
  Names names;
  HttpMetrics metrics;
  RateLimit rate, urgent_rate, preview_rate, picture_rate;
  FailedLogins logins;
  std::vector<ClientPtr> clients;
  std::vector<std::shared_ptr<Stream>> streams;
  std::map<std::string, int> streams_of{};  ///< open event streams of each principal
  int watching{0};                          ///< of those, the ones of people who may not cut
  int uploads{0};
  bool stopping{false};
  std::function<void()> on_empty{};  ///< called when the last client has gone while it stops

  [[nodiscard]] const HttpLimits& limits() const { return options.limits; }
  [[nodiscard]] double now_s() const;
  /// Finds a place for a new connection: a free one, else the place of the connection that is idle
  /// the longest, else of the one that is unidentified the longest, else a reserved place. False:
  /// all are taken.
  ///
  /// @param descriptor  of its socket; the last `kDescriptorsLeft` must stay free
  [[nodiscard]] bool make_room(const Peer& peer, int descriptor, bool& reserved);
  /// The TCP client that has been unidentified for longest; null if all identified in time.
  [[nodiscard]] ClientPtr oldest_stranger() const;
  /// True if the principal of this client has more than half of all places.
  [[nodiscard]] bool is_crowding(const Client& client) const;
  /// Running uploads of a principal.
  [[nodiscard]] int uploads_of(const std::string& principal) const;
  /// True for a user of the unix socket who has half of all places already.
  [[nodiscard]] bool is_greedy(const Peer& peer) const;
  /// Counts a large answer that is sent to `client` from memory. If these exceed `answer_bytes`, it
  /// ends the oldest ones: those of this principal if they take half, else those of the principal
  /// with the most bytes. False: none can be ended.
  [[nodiscard]] bool make_room_for_answer(const ClientPtr& client, std::size_t bytes);
  void remove(const ClientPtr& client);
  /// See `HttpServer::retune`.
  void retune(HttpTuning tuning);
  void publish(const EventFramePtr& frame);
  /// Checks the credentials of all streams again, because one has expired.
  void check_streams();
  /// Ends all streams with overflow if an event was lost.
  void end_missed();
  void log_fault(std::string_view what) const;
  void log_request(const Request& request, const Response& response, double ms) const;
  /// Call it once, on any thread, when the work is done: `arrive` runs on the HTTP thread, then the
  /// waiting coroutine resumes.
  using Done = std::function<void(std::function<void()> arrive)>;
  /// Starts work by `start` and waits for it. False: it did not start, or took too long.
  asio::awaitable<bool> wait_for(ClientPtr client, std::function<bool(Done)> start,
                                 double patience_s);
  /// Runs `work` on the service's thread and waits until it calls the function that it gets, at
  /// once or later. False: it took too long, or the service accepts no work.
  asio::awaitable<bool> ask(ClientPtr client, std::function<void(Service&, Done)> work,
                            double patience_s, bool is_urgent = false);
  /// Runs slow `work`, such as disk access, on another thread and waits for its end. Exceptions are
  /// dropped.
  asio::awaitable<bool> run_aside(ClientPtr client, asio::thread_pool& where,
                                  std::function<void()> work);
};

/// The slowest that a body may arrive: after `body_s`, at least `body_bytes_per_s` over each
/// further `body_s`, so that a fast start gives no credit for later; and at most `upload_s` in
/// total.
class BodyPace {
 public:
  explicit BodyPace(double now_s) : begun_s_(now_s), window_s_(now_s) {}
  /// Seconds in which more must arrive, after `got` bytes.
  [[nodiscard]] double left_s(const HttpLimits& limits, std::uint64_t got, double now_s);

 private:
  double begun_s_, window_s_;
  std::uint64_t window_got_{0};
};

/// Serves one connection until it ends.
asio::awaitable<void> serve(Hub& hub, ClientPtr client);
/// Sends all of `bytes`, not slower than the limits allow; false: the client is gone.
asio::awaitable<bool> send_all(Hub& hub, ClientPtr client, std::string_view bytes);
/// An event as connected clients get it: with `now`, and `whole`, the current job or device, so
/// that they need not request it. `whole` is left out if that is very large or was deleted. On the
/// service's thread.
[[nodiscard]] EventFramePtr live_frame(const Event& event, Service& service);
/// Streams events until the client goes, or is too slow.
asio::awaitable<void> stream_events(Hub& hub, ClientPtr client, const Request& request);

/// Calls a function when destroyed, so that a coroutine releases what it took however it ends.
class AtEnd {
 public:
  explicit AtEnd(std::function<void()> what) : what_(std::move(what)) {}
  ~AtEnd() { what_(); }
  AtEnd(const AtEnd&) = delete;
  AtEnd& operator=(const AtEnd&) = delete;

 private:
  std::function<void()> what_;
};

/// 26 characters that sort by time, unlike any other.
[[nodiscard]] std::string new_request_id();

}  // namespace popcut::daemon::http
