// SPDX-License-Identifier: MIT
// Server-sent events: first those that a client missed, then new ones.
#include <sys/socket.h>

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/http/api/render.hpp"
#include "daemon/http/hub.hpp"
#include "daemon/model/wall_clock.hpp"

namespace popcut::daemon::http {
namespace {

using boost::system::error_code;

constexpr int kPage = 200;
constexpr std::size_t kPiece = 16 << 10;
constexpr int kSendBuffer = 64 << 10;
constexpr double kCatchUp_s = 30;
constexpr std::size_t kMostWhole = 12 << 10;  // of a job with its notes and warnings; usually 2 kB

// What a client gets before new events.
struct CatchUp {
  std::string text;
  std::int64_t seq{};  ///< number of the last event in it
  bool is_whole{false};
  bool failed{false};
};

std::optional<std::int64_t> wanted_seq(const Request& request) {
  std::string_view text = request.header("last-event-id").value_or("");
  std::string after;
  for (const auto& [name, value] : request.query)
    if (name == "after" && text.empty()) text = after = value;
  std::int64_t seq = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seq);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || seq < 0)
    return std::nullopt;
  return seq;
}

// The current state: all devices, and the unfinished jobs, started ones before waiting ones.
std::string snapshot(Service& service, std::int64_t seq) {
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const DeviceRecord& device : service.devices.list()) devices.push_back(to_json(device));
  std::vector<std::string> jobs;
  bool more = false;
  const std::vector<JobState> begun{JobState::Cutting, JobState::Paused, JobState::Interrupted,
                                    JobState::Armed, JobState::Ready};
  for (const std::vector<JobState>& states :
       {begun, std::vector<JobState>{JobState::Planning, JobState::Queued}}) {
    const Answer<Page<Job>> page = service.jobs.list({states, {}, {}, {}}, {kPage / 2, {}});
    if (!page) continue;
    for (const Job& job : page->items) jobs.push_back(job_text(job));
    more = more || !page->next_cursor.empty();
  }
  return fmt::format("{{\"seq\":{},\"now\":\"{}\",\"devices\":{},\"jobs\":[{}],\"more\":{}}}", seq,
                     rfc3339(wall_clock_ms()), dump(devices), fmt::join(jobs, ","), more);
}

// The current job or device of an event; empty if it does not exist any more.
std::string text_of_subject(const Event& event, Service& service) {
  if (event.kind == "job" || event.kind == "queue") {
    const Answer<Job> job = service.jobs.brief(event.job);
    return job ? job_text(*job) : std::string();
  }
  if (event.kind != "device") return {};
  const std::string id = text_in(event, "device");
  if (id.empty()) return {};
  const Answer<DeviceRecord> device = service.devices.find(id);
  return device ? dump(to_json(*device)) : std::string();
}

CatchUp catch_up(Service& service, std::optional<std::int64_t> after) {
  CatchUp out;
  const std::int64_t last = service.operations.last_event();
  const bool is_known = after && *after <= last && *after + 1 >= service.operations.first_event();
  if (!is_known) {
    out.seq = last;
    out.is_whole = true;
    // The id comes with the snapshot, so that a client that loses its connection resumes from
    // there.
    out.text = frame_text("reset", fmt::format("{{\"seq\":{}}}", last)) +
               fmt::format("id: {}\n", last) + frame_text("snapshot", snapshot(service, last));
    return out;
  }
  const Answer<std::vector<Event>> events = service.operations.events(*after, kPage, "");
  out.failed = !events;
  if (!events) return out;
  out.seq = events->empty() ? *after : events->back().seq;
  out.is_whole = events->size() < kPage;
  for (const Event& event : *events) out.text += frame_of(event)->text;
  return out;
}

// Adds the stream to the listeners exactly when the events that it missed arrive: events are posted
// in the order of their commits, so none is lost in between.
asio::awaitable<CatchUp> ask_catch_up(Hub& hub, ClientPtr client,
                                      std::optional<std::int64_t> after) {
  auto result = std::make_shared<CatchUp>();
  result->failed = true;
  const std::weak_ptr<Stream> stream = client->stream;  // it stays on this thread
  std::function<void(Service&, Hub::Done)> work = [result, after, stream, &hub](
                                                      Service& service, const Hub::Done& done) {
    CatchUp found;
    try {
      found = catch_up(service, after);
    } catch (const std::exception&) {
      found.failed = true;
    }
    done([result, stream, found = std::move(found), &hub] {
      *result = found;
      const std::shared_ptr<Stream> here = stream.lock();
      if (here && found.is_whole && !found.failed) hub.streams.push_back(here);
    });
  };
  const bool answered = co_await hub.ask(client, std::move(work), kCatchUp_s);
  if (!answered) result->failed = true;
  co_return *result;
}

// Reading notices a client that disconnects; it sends nothing else.
void watch(const ClientPtr& client) {
  client->socket.async_read_some(asio::buffer(client->buffer),
                                 [client](const error_code& ec, std::size_t got) {
                                   if (ec || got == 0) return client->close();
                                   if (!client->closed) watch(client);
                                 });
}

std::string take_piece(EventRing& ring, std::int64_t seen) {
  std::string piece;
  while (piece.size() < kPiece) {
    const EventFramePtr frame = ring.pop();
    if (!frame) break;
    if (frame->seq == 0 || frame->seq > seen) piece += frame->text;
  }
  return piece;
}

// A deleted or expired token ends its streams and those of its sessions. Returns the seconds until
// the next check; nothing if the client is not known.
asio::awaitable<std::optional<double>> known_for_s(Hub& hub, ClientPtr client) {
  const double heartbeat_s = hub.limits().heartbeat_s;
  if (client->peer.is_local) co_return heartbeat_s;
  const Answer<std::string> bearer = bearer_of(client->reader.head());
  if (!bearer) co_return std::nullopt;
  auto known = std::make_shared<std::optional<Principal>>();
  std::function<void(Service&, Hub::Done)> work = [token = *bearer, known](Service& service,
                                                                           const Hub::Done& done) {
    std::optional<Principal> found;
    try {
      found = service.access.authenticate(token);
    } catch (const std::exception&) {  // treated as unknown
    }
    done([known, found = std::move(found)] { *known = found; });
  };
  const bool answered = co_await hub.ask(client, std::move(work), kCatchUp_s);
  if (!answered || !*known) co_return std::nullopt;
  const std::optional<std::int64_t> left_ms = (*known)->left_ms;
  if (!left_ms) co_return heartbeat_s;
  co_return std::min(heartbeat_s, static_cast<double>(*left_ms + 1) / 1000);
}

asio::awaitable<void> stream_on(Hub& hub, ClientPtr client, std::int64_t seen) {
  Stream& stream = *client->stream;
  stream.doubted = true;  // the credential may have expired since the request
  double check_s = 0;
  while (!client->closed) {
    if (stream.doubted || hub.now_s() >= check_s) {
      stream.doubted = false;
      const std::optional<double> known_s = co_await known_for_s(hub, client);
      if (!known_s) co_return;
      check_s = hub.now_s() + *known_s;
      hub.end_missed();
    }
    std::string piece = take_piece(stream.ring, seen);
    if (piece.empty() && stream.ring.has_overflowed()) {
      const std::string last = frame_text("overflow", "{}");
      const bool sent = co_await send_all(hub, client, last);
      static_cast<void>(sent);
      co_return;
    }
    if (piece.empty()) {
      error_code ec;
      const double quiet_s = std::min(hub.limits().heartbeat_s, check_s - hub.now_s());
      stream.wake.expires_after(
          std::chrono::microseconds(static_cast<std::int64_t>(std::max(quiet_s, 0.0) * 1e6)));
      if (stream.doubted) continue;
      co_await stream.wake.async_wait(asio::redirect_error(asio::use_awaitable, ec));
      if (ec || client->closed) continue;  // woken by an event, or the end
      piece = ":\n\n";
    }
    const bool fine = co_await send_all(hub, client, piece);
    if (!fine) co_return;
  }
}

// One principal may have half of all streams, and a quarter is kept for those who move a knife.
// Empty: there is a place.
std::string why_no_stream(const Hub& hub, const std::string& who, bool may_cut) {
  const int all = hub.limits().streams, each = std::max(1, all / 2);
  const auto own = hub.streams_of.find(who);
  if (own != hub.streams_of.end() && own->second >= each)
    return fmt::format("{} event streams of yours are open already; close one", each);
  if (hub.link->listeners.load() >= all)
    return fmt::format("{} event streams are open already", all);
  if (!may_cut && hub.watching >= all - all / 4)
    return fmt::format("{} event streams are open already; the others are kept for operators",
                       hub.watching);
  return {};
}

asio::awaitable<void> stream_all(Hub& hub, ClientPtr client, std::optional<std::int64_t> after) {
  while (!client->closed) {
    const CatchUp part = co_await ask_catch_up(hub, client, after);
    if (part.failed) co_return;
    const bool fine = co_await send_all(hub, client, part.text);
    if (!fine) co_return;
    after = part.seq;
    if (part.is_whole) break;
  }
  if (!client->closed) co_await stream_on(hub, client, after.value_or(0));
}

}  // namespace

EventFramePtr live_frame(const Event& event, Service& service) {
  try {
    const std::string whole = text_of_subject(event, service);
    if (!whole.empty() && whole.size() <= kMostWhole)
      return frame_of(event,
                      fmt::format("\"now\":\"{}\",\"whole\":{}", rfc3339(wall_clock_ms()), whole));
  } catch (const std::exception&) {  // clients that need it request it
  }
  return frame_of(event);
}

asio::awaitable<void> stream_events(Hub& hub, ClientPtr client, const Request& request) {
  const std::string who = request.principal.name;
  const bool may_cut = request.principal.role >= Role::Operator;
  if (std::string why = why_no_stream(hub, who, may_cut); !why.empty()) {
    Problem full{ProblemKind::Unavailable, std::move(why)};
    full.retry_after_s = 5;
    const Response response = problem_response(full, request);
    const std::string text =
        response_head(response, request.id, response.body.size(), true) + response.body;
    const bool sent = co_await send_all(hub, client, text);
    static_cast<void>(sent);
    hub.metrics.reject("full");
    hub.metrics.count("/v1/events", response.status);
    co_return;
  }
  hub.metrics.set_streams(++hub.link->listeners);
  ++hub.streams_of[who];
  if (!may_cut) ++hub.watching;
  const AtEnd leave([&hub, client, who, may_cut] {
    std::erase(hub.streams, client->stream);
    if (--hub.streams_of[who] == 0) hub.streams_of.erase(who);
    if (!may_cut) --hub.watching;
    hub.metrics.set_streams(--hub.link->listeners);
  });
  client->stream = std::make_shared<Stream>(hub.io, hub.limits());
  // Keep the buffer to a client that does not read small.
  ::setsockopt(client->socket.native_handle(), SOL_SOCKET, SO_SNDBUF, &kSendBuffer,
               sizeof(kSendBuffer));
  Response head;
  head.content_type = "text/event-stream";
  const std::string text = response_head(head, request.id, std::nullopt, true);
  hub.metrics.count("/v1/events", 200);
  const bool fine = co_await send_all(hub, client, text);
  if (fine) {
    watch(client);
    co_await stream_all(hub, client, wanted_seq(request));
  }
}

}  // namespace popcut::daemon::http
