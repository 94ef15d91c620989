// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
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

/// The way from other threads to that of HTTP. Outlives the server: what comes too late is dropped.
class Link {
 public:
  explicit Link(asio::io_context& io) : io_(&io) {}
  void post(std::function<void()> work);
  void cut();
  std::atomic<int> listeners{0};    ///< streams that are or are about to be served
  std::atomic<bool> missed{false};  ///< an event could not be passed on: streams start again

 private:
  std::mutex mutex_;
  asio::io_context* io_;
};

/// Something that another thread will do; the coroutine that waits wakes when it is done, when it
/// has waited long enough, or when its client goes.
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
  bool doubted{false};  ///< its credential may have ended
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
  bool reserved{false};         ///< in a place that serves urgent requests only
  bool uploads{false};          ///< a body of its goes to the disk
  std::string principal{};      ///< whose last request it was; empty: nobody known
  std::size_t answer_bytes{0};  ///< of a large answer that it is being sent from memory
  bool closed{false};
  std::shared_ptr<Ticket> ticket{};
  std::shared_ptr<Stream> stream{};
  std::array<char, 16384> buffer{};

  void enter(State next);
  /// Closes the connection in `seconds` unless it is called again or `relax`ed.
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
  int uploads{0};
  bool stopping{false};
  std::function<void()> on_empty{};  ///< called when the last client has gone while it stops

  [[nodiscard]] const HttpLimits& limits() const { return options.limits; }
  [[nodiscard]] double now_s() const;
  /// A place for a new connection: one that is free, else that of the longest idle one, else that
  /// of who has not said for longest who they are, else a reserved one. False: there is none.
  ///
  /// @param descriptor  of its socket; the last `kDescriptorsLeft` are no places
  [[nodiscard]] bool make_room(const Peer& peer, int descriptor, bool& reserved);
  /// Over TCP, the one who has not said for longest who they are; null: none is that slow.
  [[nodiscard]] ClientPtr oldest_stranger() const;
  /// True if one principal, this client's, has more than half of all places.
  [[nodiscard]] bool is_crowding(const Client& client) const;
  /// How many uploads of a principal are under way.
  [[nodiscard]] int uploads_of(const std::string& principal) const;
  /// True for a user of the unix socket who has half of all places already.
  [[nodiscard]] bool is_greedy(const Peer& peer) const;
  /// Counts a large answer that is sent to `client` from memory. If there are too many, it ends
  /// those that have been read the longest: of this principal if theirs are half of
  /// `answer_bytes`, else of who has most. False: there is none that may be ended.
  [[nodiscard]] bool make_room_for_answer(const ClientPtr& client, std::size_t bytes);
  void remove(const ClientPtr& client);
  /// See `HttpServer::retune`.
  void retune(HttpTuning tuning);
  void publish(const EventFramePtr& frame);
  /// Looks again whether the clients of the streams are still known: a credential has ended.
  void check_streams();
  /// Ends all streams by overflow if an event was missed.
  void end_missed();
  void log_fault(std::string_view what) const;
  void log_request(const Request& request, const Response& response, double ms) const;
  /// To be called once, on any thread, when something is done: the coroutine that waits for it
  /// wakes, and `arrive` has run on the thread of HTTP before.
  using Done = std::function<void(std::function<void()> arrive)>;
  /// Begins something by `start` and waits for it. False: it did not begin, or takes too long.
  asio::awaitable<bool> wait_for(ClientPtr client, std::function<bool(Done)> start,
                                 double patience_s);
  /// Runs `work` on the service's thread and waits until it calls the function that it is given,
  /// there or later. False: too late, or the service takes nothing.
  asio::awaitable<bool> ask(ClientPtr client, std::function<void(Service&, Done)> work,
                            double patience_s, bool is_urgent = false);
  /// Runs `work`, which takes long or waits for the disk, on another thread and waits until it has
  /// ended. What it throws is dropped.
  asio::awaitable<bool> run_aside(ClientPtr client, asio::thread_pool& where,
                                  std::function<void()> work);
};

/// How slowly a body may come: after `body_s` at `body_bytes_per_s` at least, over each such time
/// again, so that what came quickly is no credit for being slow ever after; and no longer in all
/// than `upload_s`.
class BodyPace {
 public:
  explicit BodyPace(double now_s) : begun_s_(now_s), window_s_(now_s) {}
  /// In how many seconds more must come, when there are `got` bytes.
  [[nodiscard]] double left_s(const HttpLimits& limits, std::uint64_t got, double now_s);

 private:
  double begun_s_, window_s_;
  std::uint64_t window_got_{0};
};

/// Serves one connection until it ends.
asio::awaitable<void> serve(Hub& hub, ClientPtr client);
/// Sends all of `bytes`, at the least speed that limits want; false: the client is gone.
asio::awaitable<bool> send_all(Hub& hub, ClientPtr client, std::string_view bytes);
/// An event as it goes to those who hear it now: with `now`, and `whole`, the job or the device as
/// it is, so that they need not ask for it. One that is very large, or gone, is left out. On the
/// service's thread.
[[nodiscard]] EventFramePtr live_frame(const Event& event, Service& service);
/// Streams events until the client goes, or is too slow.
asio::awaitable<void> stream_events(Hub& hub, ClientPtr client, const Request& request);

/// Calls a function when it is destroyed: a coroutine returns what it took, however it ends.
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
