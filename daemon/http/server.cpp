// SPDX-License-Identifier: MIT
#include "daemon/http/server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/logger.h>

#include "daemon/http/hub.hpp"
#include "daemon/http/listen.hpp"
#include "daemon/http/spool.hpp"

namespace popcut::daemon {
namespace {

using http::Client;
using http::ClientPtr;
using http::Hub;
using http::Peer;
using http::Socket;
using Acceptor = boost::asio::basic_socket_acceptor<boost::asio::generic::stream_protocol>;
namespace asio = boost::asio;

std::int64_t steady_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// The process at the other end of a unix socket, from the kernel.
void look_at_process(int socket, Peer& peer) {
  ucred who{};
  socklen_t size = sizeof(who);
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) {
    peer.uid = static_cast<uid_t>(-1);  // unknown, so it has no role
    return;
  }
  peer.uid = who.uid;
  std::vector<gid_t> groups(64);
  size = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
  int failed = ::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size);
  if (failed != 0 && errno == ERANGE) {
    groups.resize(size / sizeof(gid_t));
    failed = ::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size);
  }
  groups.resize(failed == 0 ? size / sizeof(gid_t) : 0);
  groups.push_back(who.gid);
  peer.groups = std::move(groups);
}

Peer peer_of(int socket, const http::Listener& listener) {
  Peer peer;
  peer.is_local = listener.is_local();
  peer.port = listener.port();
  if (peer.is_local) {
    look_at_process(socket, peer);
    return peer;
  }
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0) {
    if (address.ss_family == AF_INET)
      inet_ntop(AF_INET, &reinterpret_cast<sockaddr_in*>(&address)->sin_addr, text.data(),
                text.size());
    else
      inet_ntop(AF_INET6, &reinterpret_cast<sockaddr_in6*>(&address)->sin6_addr, text.data(),
                text.size());
  }
  peer.address = text.data();
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  return peer;
}

void welcome(Hub& hub, Socket socket, const http::Listener& listener) {
  bool reserved = false;
  Peer peer = peer_of(socket.native_handle(), listener);
  // Without a place, the socket closes here.
  if (hub.stopping || !hub.make_room(peer, socket.native_handle(), reserved)) return;
  auto client = std::make_shared<Client>(hub.io, std::move(socket), std::move(peer), hub.limits());
  client->reserved = reserved;
  hub.clients.push_back(client);
  asio::co_spawn(hub.io, http::serve(hub, client), asio::detached);
}

asio::awaitable<void> accept_all(Hub& hub, Acceptor& acceptor, const http::Listener& listener) {
  asio::steady_timer pause(hub.io);
  while (!hub.stopping) {
    boost::system::error_code ec;
    Socket socket(hub.io);
    co_await acceptor.async_accept(socket, asio::redirect_error(asio::use_awaitable, ec));
    if (hub.stopping || ec == asio::error::operation_aborted) co_return;
    if (!ec) {
      try {
        welcome(hub, std::move(socket), listener);
      } catch (
          const std::exception& fault) {  // ends this client only; popcutd accepts the next ones
        hub.log_fault(fault.what());
      }
      continue;
    }
    // Out of descriptors, for example: open connections continue, new ones wait a little.
    pause.expires_after(std::chrono::milliseconds(100));
    co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
}

}  // namespace

struct HttpServer::Impl {
  explicit Impl(HttpOptions options) : hub(std::move(options)), beat(hub.io), grace(hub.io) {}

  Hub hub;
  std::vector<http::Listener> listeners;
  std::vector<Acceptor> acceptors;
  asio::steady_timer beat, grace;
  std::atomic<std::int64_t> turned_ms{0};
  std::thread thread;
  bool started{false};

  Result<void> listen();
  Result<void> accept_on_all();
  void run();
  void turn();
  void begin_stop(double grace_s);
  void cut_off() const;
};

Result<void> HttpServer::Impl::listen() {
  const HttpOptions& options = hub.options;
  for (const int socket : options.inherited) {
    Result<http::Listener> listener = http::Listener::adopt(socket, options.allow_remote);
    if (!listener) return tl::unexpected<Error>(listener.error());
    listeners.push_back(std::move(*listener));
  }
  for (const HttpEndpoint& endpoint : options.listen) {
    Result<http::Listener> listener = http::Listener::open(endpoint.address, options.allow_remote);
    if (!listener && endpoint.optional && listener.error().kind == ErrorKind::Refused) continue;
    if (!listener) return tl::unexpected<Error>(listener.error());
    listeners.push_back(std::move(*listener));
  }
  if (listeners.empty())
    return fail(ErrorKind::Usage, "listen", "is empty; name at least one address or a socket");
  return {};
}

Result<void> HttpServer::Impl::accept_on_all() {
  acceptors.reserve(listeners.size());
  for (http::Listener& listener : listeners) {
    acceptors.emplace_back(hub.io);
    boost::system::error_code ec;
    acceptors.back().assign(asio::generic::stream_protocol(listener.family(), 0),
                            listener.release(), ec);
    if (!ec) acceptors.back().non_blocking(true, ec);
    if (ec) return fail(ErrorKind::Internal, listener.name(), ec.message());
    asio::co_spawn(hub.io, accept_all(hub, acceptors.back(), listener), asio::detached);
  }
  return {};
}

// Runs until nothing is left to do. An exception (no memory, for example) ends only the handler
// that threw it.
void HttpServer::Impl::run() {
  while (true) {
    try {
      hub.io.run();
      return;
    } catch (const std::exception& e) {
      hub.log_fault(e.what());
    }
  }
}

// Shows that the thread is alive, for the watchdog.
void HttpServer::Impl::turn() {
  turned_ms = steady_ms();
  if (hub.stopping) return;
  beat.expires_after(std::chrono::seconds(1));
  beat.async_wait([this](const boost::system::error_code& ec) {
    if (!ec) turn();
  });
}

void HttpServer::Impl::begin_stop(double grace_s) {
  hub.stopping = true;
  boost::system::error_code none;
  for (Acceptor& acceptor : acceptors) acceptor.close(none);
  beat.cancel();
  for (const ClientPtr& client : std::vector<ClientPtr>(hub.clients))
    if (client->state != Client::State::Busy || client->stream) client->close();
  grace.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(grace_s * 1e6)));
  grace.async_wait([this](const boost::system::error_code&) { cut_off(); });
  hub.on_empty = [this] { grace.cancel(); };
  if (hub.clients.empty()) grace.cancel();
}

void HttpServer::Impl::cut_off() const {
  for (const ClientPtr& client : std::vector<ClientPtr>(hub.clients)) client->close();
}

HttpServer::HttpServer(HttpOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}

HttpServer::~HttpServer() { stop(0); }

Result<void> HttpServer::start() {
  Impl& impl = *impl_;
  std::signal(SIGPIPE, SIG_IGN);
  if (auto fine = impl.listen(); !fine) return fine;
  if (const std::uint16_t tcp = port(); tcp != 0)
    impl.hub.context.page_url = fmt::format("http://localhost:{}/", tcp);
  http::clear_spools(impl.hub.options.incoming_folder);
  if (auto fine = impl.accept_on_all(); !fine) return fine;
  impl.hub.options.on_service(
      [&hub = impl.hub, link = impl.hub.link, service = impl.hub.options.service] {
        // Only its own thread uses the hub; the service may call this as long as it lives.
        service->operations.listen([&hub, link, service](const Event& event) {
          if (link->listeners == 0) return;
          try {
            link->post([&hub, frame = http::live_frame(event, *service)] { hub.publish(frame); });
          } catch (const std::exception&) {
            link->missed = true;  // a listener never delays the publisher of an event
          }
        });
        service->access.on_access_change([&hub, link] {
          if (link->listeners == 0) return;
          try {
            link->post([&hub] { hub.check_streams(); });
          } catch (const std::exception&) {  // each stream checks by itself a little later
          }
        });
      });
  impl.turn();
  impl.thread = std::thread([&impl] { impl.run(); });
  impl.started = true;
  return {};
}

std::uint16_t HttpServer::port() const {
  for (const http::Listener& listener : impl_->listeners)
    if (!listener.is_local()) return listener.port();
  return 0;
}

std::vector<std::string> HttpServer::endpoints() const {
  std::vector<std::string> out;
  for (const http::Listener& listener : impl_->listeners) out.push_back(listener.name());
  return out;
}

void HttpServer::stop(double grace_s) {
  Impl& impl = *impl_;
  if (!std::exchange(impl.started, false)) return;
  asio::post(impl.hub.io, [&impl, grace_s] { impl.begin_stop(grace_s); });
  impl.thread.join();  // run() returns when no coroutine is left
  impl.hub.link->cut();
  impl.hub.disk.join();
  impl.hub.texts.join();
}

void HttpServer::retune(HttpTuning tuning) {
  Impl& impl = *impl_;
  if (!impl.started) return;
  asio::post(impl.hub.io,
             [&impl, tuning = std::move(tuning)]() mutable { impl.hub.retune(std::move(tuning)); });
}

bool HttpServer::alive(double within_s) const {
  return static_cast<double>(steady_ms() - impl_->turned_ms) < 1000 * within_s;
}

}  // namespace popcut::daemon
