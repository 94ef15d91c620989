// SPDX-License-Identifier: MIT
#include "daemon/http/hub.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <random>

#include <spdlog/logger.h>

#include "daemon/digest/digest.hpp"
#include "daemon/http/api/openapi.hpp"
#include "daemon/model/wall_clock.hpp"

namespace popcut::daemon::http {
namespace {

// A connection that sends nothing for this long can lose its place to another.
constexpr double kQuiet_s = 1;

constexpr double kReading_s = 2;  // a client may pause this long while it reads an answer
// When all places are taken, a new client must identify itself within this time: a head arrives
// with the connection, or soon after it.
constexpr double kStranger_s = 0.02;

// Bursts of previews and pictures, in seconds of their rate: a list of designs needs a picture
// each.
constexpr double kPreview_s = 2, kPicture_s = 10;
double burst(double per_s, double seconds) { return std::max(1.0, per_s * seconds); }

double age_s(const Client& client) {
  return std::chrono::duration<double>(Clock::now() - client.since).count();
}

// The kernel gives the lowest free descriptor, so the last one tells how many are left.
bool is_among_last(int descriptor) {
  rlimit now{};
  return ::getrlimit(RLIMIT_NOFILE, &now) == 0 && now.rlim_cur != RLIM_INFINITY &&
         static_cast<rlim_t>(descriptor) + kDescriptorsLeft >= now.rlim_cur;
}

}  // namespace

void Link::post(std::function<void()> work) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (io_ != nullptr) asio::post(*io_, std::move(work));
}

void Link::cut() {
  const std::lock_guard<std::mutex> lock(mutex_);
  io_ = nullptr;
}

void Client::enter(State next) {
  state = next;
  since = Clock::now();
}

void Client::expect_within(const std::shared_ptr<Client>& self, double seconds) {
  const std::uint64_t round = ++guard_round;
  guard.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(seconds * 1e6)));
  guard.async_wait(
      [weak = std::weak_ptr<Client>(self), round](const boost::system::error_code& ec) {
        const std::shared_ptr<Client> client = weak.lock();
        if (!ec && client && client->guard_round == round) client->close();
      });
}

void Client::relax() {
  ++guard_round;
  guard.cancel();
}

void Client::close() {
  closed = true;
  boost::system::error_code none;
  socket.close(none);
  relax();
  if (ticket) ticket->timer.cancel();
  if (stream) stream->wake.cancel();
}

Hub::Hub(HttpOptions what)
    : link(std::make_shared<Link>(io)),
      options(std::move(what)),
      names{options.hosts, options.origins},
      rate(options.limits.rate_per_s, options.limits.rate_burst),
      urgent_rate(options.limits.rate_per_s, options.limits.rate_burst),
      preview_rate(options.limits.previews_per_s, burst(options.limits.previews_per_s, kPreview_s)),
      picture_rate(options.limits.pictures_per_s, burst(options.limits.pictures_per_s, kPicture_s)),
      logins(options.limits.failed_logins_per_minute) {
  context.limits = options.limits;
  context.build = options.build;
  context.worker_walls = options.worker_walls;
  Sha256 hash;
  hash.add(openapi_json());
  context.openapi_sha256 = hash.hex();
  if (options.log)
    context.log_fault = [log = options.log](const std::string& line) {
      log->log(spdlog::level::err, "{}", line);
    };
  context.metrics = [this] {
    return metrics.text(options.build, static_cast<int>(clients.size()));
  };
}

double Hub::now_s() const {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

bool Hub::is_greedy(const Peer& peer) const {
  if (!peer.is_local) return false;
  const auto held = std::count_if(clients.begin(), clients.end(), [&](const ClientPtr& client) {
    return client->peer.is_local && client->peer.uid == peer.uid && !client->reserved;
  });
  return held >= std::max(1, limits().connections / 2);
}

bool Hub::is_crowding(const Client& client) const {
  if (client.principal.empty() || client.reserved) return false;
  const auto held = std::count_if(clients.begin(), clients.end(), [&](const ClientPtr& other) {
    return !other->reserved && other->principal == client.principal &&
           other->state == Client::State::Busy;
  });
  return held > std::max(1, limits().connections / 2);
}

int Hub::uploads_of(const std::string& principal) const {
  return static_cast<int>(std::count_if(
      clients.begin(), clients.end(),
      [&](const ClientPtr& client) { return client->uploads && client->principal == principal; }));
}

double BodyPace::left_s(const HttpLimits& limits, std::uint64_t got, double now_s) {
  const auto earned_s = [&] {
    return static_cast<double>(got - window_got_) / limits.body_bytes_per_s;
  };
  if (earned_s() >= limits.body_s) {
    window_s_ = now_s;
    window_got_ = got;
  }
  const double until = std::min(window_s_ + limits.body_s + earned_s(), begun_s_ + limits.upload_s);
  return std::max(until - now_s, 0.0);
}

ClientPtr Hub::oldest_stranger() const {
  ClientPtr oldest;
  for (const ClientPtr& client : clients) {
    if (client->reserved || client->closed || client->peer.is_local || !client->principal.empty())
      continue;
    const double patience = client->state == Client::State::Busy ? kReading_s : kStranger_s;
    if (age_s(*client) > patience && (!oldest || client->since < oldest->since)) oldest = client;
  }
  return oldest;
}

bool Hub::make_room(const Peer& peer, int descriptor, bool& reserved) {
  reserved = false;
  const auto usual = std::count_if(clients.begin(), clients.end(),
                                   [](const ClientPtr& client) { return !client->reserved; });
  if (usual < limits().connections && !is_greedy(peer) && !is_among_last(descriptor)) return true;
  ClientPtr quietest;
  const bool own_only = is_greedy(peer);
  for (const ClientPtr& client : clients) {
    if (own_only && !(client->peer.is_local && client->peer.uid == peer.uid)) continue;
    const bool is_quiet = !client->reserved && !client->closed &&
                          client->state == Client::State::Idle &&
                          (client->served > 0 || age_s(*client) > kQuiet_s);
    if (is_quiet && (!quietest || client->since < quietest->since)) quietest = client;
  }
  if (!quietest && !own_only) quietest = oldest_stranger();
  if (quietest) {
    quietest->close();  // its coroutine ends soon; the place is given away now
    remove(quietest);
    return true;
  }
  reserved = true;
  const auto kept = static_cast<int>(clients.size()) - static_cast<int>(usual);
  if (kept < limits().reserved_connections) return true;
  // In the reserved places, the client goes that has been silent the longest.
  ClientPtr slowest;
  for (const ClientPtr& client : clients)
    if (client->reserved && client->state != Client::State::Busy && !client->closed &&
        (!slowest || client->since < slowest->since))
      slowest = client;
  if (!slowest) return false;
  slowest->close();
  remove(slowest);
  return true;
}

bool Hub::make_room_for_answer(const ClientPtr& client, std::size_t bytes) {
  const std::size_t most = limits().answer_bytes;
  for (;;) {
    std::size_t all = 0;
    std::map<std::string, std::size_t> held;
    for (const ClientPtr& other : clients) {
      all += other->answer_bytes;
      held[other->principal] += other->answer_bytes;
    }
    const std::size_t own = held[client->principal];
    const bool is_own_full = own > 0 && own + bytes > most / 2;
    if (!is_own_full && (all == 0 || all + bytes <= most)) break;
    const std::string whose =
        is_own_full ? client->principal
                    : std::max_element(held.begin(), held.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
    ClientPtr slowest;
    for (const ClientPtr& other : clients)
      if (other->answer_bytes > 0 && other->principal == whose && age_s(*other) > kReading_s &&
          (!slowest || other->since < slowest->since))
        slowest = other;
    if (!slowest) return false;
    slowest->answer_bytes = 0;
    slowest->close();  // its coroutine ends next, and what it held with it
  }
  client->answer_bytes = bytes;
  return true;
}

void Hub::remove(const ClientPtr& client) {
  std::erase(clients, client);
  if (stopping && clients.empty() && on_empty) on_empty();
}

void Hub::retune(HttpTuning tuning) {
  names = {tuning.hosts, tuning.origins};
  options.users = std::move(tuning.users);
  options.limits = context.limits = tuning.limits;
  rate.set(tuning.limits.rate_per_s, tuning.limits.rate_burst);
  urgent_rate.set(tuning.limits.rate_per_s, tuning.limits.rate_burst);
  preview_rate.set(tuning.limits.previews_per_s, burst(tuning.limits.previews_per_s, kPreview_s));
  picture_rate.set(tuning.limits.pictures_per_s, burst(tuning.limits.pictures_per_s, kPicture_s));
  logins.set(tuning.limits.failed_logins_per_minute);
  for (const ClientPtr& client : std::vector<ClientPtr>(clients))
    if (client->stream && client->peer.is_local &&
        !local_principal(client->peer, options.users, ::getuid(), options.machine))
      client->close();
}

void Hub::check_streams() {
  for (const ClientPtr& client : clients) {
    if (!client->stream || client->peer.is_local) continue;
    client->stream->doubted = true;
    client->stream->wake.cancel();
  }
}

void Hub::log_fault(std::string_view what) const {
  if (options.log) options.log->log(spdlog::level::err, "http: {}", for_log(what));
}

void Hub::end_missed() {
  if (!link->missed.exchange(false)) return;
  for (const std::shared_ptr<Stream>& stream : streams) {
    stream->ring.give_up();
    stream->wake.cancel();
  }
}

void Hub::publish(const EventFramePtr& frame) {
  end_missed();
  for (const std::shared_ptr<Stream>& stream : streams) {
    const std::uint64_t before = stream->ring.dropped();
    stream->ring.push(frame);
    metrics.drop_events(stream->ring.dropped() - before);
    stream->wake.cancel();
  }
}

void Hub::log_request(const Request& request, const Response& response, double ms) const {
  if (!options.log) return;
  const bool is_quiet =
      response.status < 400 && (request.method == Method::Get || request.method == Method::Head);
  const auto level = response.status >= 500   ? spdlog::level::err
                     : response.status >= 400 ? spdlog::level::warn
                     : is_quiet               ? spdlog::level::debug
                                              : spdlog::level::info;
  // The path without its query: the log does not contain names of designs.
  options.log->log(level, "http {} {} {} {} {} {:.1f} ms", request.id,
                   request.principal.name.empty() ? "-" : for_log(request.principal.name),
                   name_of(request.method), for_log(request.path()), response.status, ms);
}

asio::awaitable<bool> Hub::wait_for(ClientPtr client, std::function<bool(Done)> start,
                                    double patience_s) {
  auto ticket = std::make_shared<Ticket>(io);
  ticket->timer.expires_after(
      std::chrono::microseconds(static_cast<std::int64_t>(patience_s * 1e6)));
  client->ticket = ticket;
  // The receiver may keep this longer than the server lives, and a ticket belongs to the server's
  // thread.
  Done done = [waiting = std::weak_ptr<Ticket>(ticket), out = link](std::function<void()> arrive) {
    out->post([waiting, arrive = std::move(arrive)] {
      const std::shared_ptr<Ticket> one = waiting.lock();
      if (!one || one->done) return;
      if (arrive) arrive();
      one->done = true;
      one->timer.cancel();
    });
  };
  const bool started = start(std::move(done));
  if (started && !client->closed) {
    boost::system::error_code ec;
    co_await ticket->timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
  client->ticket.reset();
  const bool answered = ticket->done;
  ticket->done = true;  // later results are too late
  co_return answered;
}

asio::awaitable<bool> Hub::ask(ClientPtr client, std::function<void(Service&, Done)> work,
                               double patience_s, bool is_urgent) {
  std::function<bool(Done)> start = [this, is_urgent, work = std::move(work)](Done done) {
    const auto& lane =
        is_urgent && options.on_service_urgent ? options.on_service_urgent : options.on_service;
    return lane([work, done = std::move(done), service = options.service] {
      // No fault here may end the service's thread.
      try {
        work(*service, done);
      } catch (const std::exception&) {
        try {
          done({});
        } catch (const std::exception&) {  // the time limit of the client ends it
        }
      }
    });
  };
  co_return co_await wait_for(client, std::move(start), patience_s);
}

asio::awaitable<bool> Hub::run_aside(ClientPtr client, asio::thread_pool& where,
                                     std::function<void()> work) {
  std::function<bool(Done)> start = [&where, work = std::move(work)](Done done) {
    asio::post(where, [work, done = std::move(done)] {
      // An exception would end popcutd.
      try {
        work();
      } catch (const std::exception&) {  // the waiting coroutine notices that the result is missing
      }
      try {
        done({});
      } catch (const std::exception&) {  // the time limit of the client ends it
      }
    });
    return true;
  };
  co_return co_await wait_for(client, std::move(start), limits().answer_s);
}

std::string new_request_id() {
  constexpr std::string_view kDigits = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
  thread_local std::mt19937_64 random{std::random_device{}()};
  auto ms = static_cast<std::uint64_t>(wall_clock_ms());
  std::string id(26, '0');
  for (std::size_t i = 10; i-- > 0; ms >>= 5) id[i] = kDigits[ms & 31u];
  std::uint64_t low = random(), high = random();
  for (std::size_t i = 10; i < 18; ++i, low >>= 5) id[i] = kDigits[low & 31u];
  for (std::size_t i = 18; i < 26; ++i, high >>= 5) id[i] = kDigits[high & 31u];
  return id;
}

}  // namespace popcut::daemon::http
