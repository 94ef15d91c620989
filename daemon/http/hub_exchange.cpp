// SPDX-License-Identifier: MIT
// One connection: reads requests, checks them at the front door, asks the service, answers.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>

#include "daemon/http/api/dispatch.hpp"
#include "daemon/http/api/target.hpp"
#include "daemon/http/hub.hpp"
#include "daemon/http/spool.hpp"

namespace popcut::daemon::http {
namespace {

using boost::system::error_code;

constexpr double kAuthenticate_s = 10;
constexpr std::size_t kLargeAnswer = 1 << 20;  // from this size on, see `make_room_for_answer`
constexpr std::size_t kFilePiece = 64 << 10;
constexpr std::size_t kMostLinger = 1 << 20;
constexpr double kLinger_s = 2;

// A request on its way through the front door.
struct Exchange {
  Request request{};
  const Route* route{nullptr};
  // Shared by writer and reader: the last owner removes the file.
  std::shared_ptr<Spool> spool{};
  Clock::time_point begun{Clock::now()};
};

std::string_view reject_word(const Problem& problem) {
  switch (problem.kind) {
    case ProblemKind::WrongHost:
      return "host";
    case ProblemKind::Unauthenticated:
    case ProblemKind::Forbidden:
      return "auth";
    case ProblemKind::Rate:
      return "rate";
    case ProblemKind::TooLarge:
      return "size";
    case ProblemKind::BadRequest:
      return "head";
    default:
      return {};
  }
}

// Closes a descriptor at the end of a block.
class File {
 public:
  explicit File(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  // The size, if it is a regular file.
  [[nodiscard]] std::optional<std::uint64_t> size() const {
    struct stat found {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &found) != 0 || !S_ISREG(found.st_mode))
      return std::nullopt;
    return static_cast<std::uint64_t>(found.st_size);
  }
  [[nodiscard]] std::string read(std::size_t most) const {
    std::string piece(most, '\0');
    const ssize_t got = ::read(descriptor_, piece.data(), piece.size());
    piece.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return piece;
  }

 private:
  int descriptor_;
};

// Reads until the head is complete. False: the client is gone, or too slow.
asio::awaitable<bool> receive(ClientPtr client) {
  error_code ec;
  const std::size_t got = co_await client->socket.async_read_some(
      asio::buffer(client->buffer), asio::redirect_error(asio::use_awaitable, ec));
  if (ec || got == 0 || client->closed) co_return false;
  client->reader.append({client->buffer.data(), got});
  co_return true;
}

// Reads and drops what a refused client still sends, so that it can read the reason.
asio::awaitable<void> linger(ClientPtr client) {
  error_code ec;
  client->socket.shutdown(asio::socket_base::shutdown_send, ec);
  client->expect_within(client, kLinger_s);
  std::size_t seen = 0;
  while (!client->closed && seen < kMostLinger) {
    const std::size_t got = co_await client->socket.async_read_some(
        asio::buffer(client->buffer), asio::redirect_error(asio::use_awaitable, ec));
    if (ec || got == 0) break;
    seen += got;
  }
}

asio::awaitable<bool> send_file(Hub& hub, ClientPtr client, const File& file, std::uint64_t size) {
  std::uint64_t sent = 0;
  while (sent < size) {
    const std::string piece = file.read(std::min<std::uint64_t>(kFilePiece, size - sent));
    if (piece.empty()) co_return false;  // the file shrank: the announced length is wrong now
    const bool fine = co_await send_all(hub, client, piece);
    if (!fine) co_return false;
    sent += piece.size();
  }
  co_return true;
}

// Sends a response. False: the connection cannot go on.
asio::awaitable<bool> respond(Hub& hub, ClientPtr client, Exchange& exchange, Response response,
                              bool close) {
  Request& request = exchange.request;
  std::optional<File> file;
  std::optional<std::uint64_t> file_size;
  if (!response.file.empty()) {
    file.emplace(response.file);
    file_size = file->size();
    if (!file_size)
      response =
          problem_response(Problem{ProblemKind::Internal, "the stored file is missing"}, request);
  }
  if (response.make_body && !response.is_brief) {
    auto made = std::make_shared<std::optional<std::string>>();
    std::function<void()> make = [made, body = std::move(response.make_body)] { *made = body(); };
    const bool ended = co_await hub.run_aside(client, hub.texts, std::move(make));
    response.make_body = {};
    if (ended && *made)
      response.body = std::move(**made);
    else
      response = problem_response(
          Problem{ProblemKind::Unavailable, "popcutd is out of memory; try again later"}, request);
  }
  if (response.make_body) response.body = response.make_body();
  const AtEnd sent([client] { client->answer_bytes = 0; });
  if (response.body.size() >= kLargeAnswer &&
      !hub.make_room_for_answer(client, response.body.size())) {
    Problem full{ProblemKind::Unavailable,
                 "popcutd is sending too many large answers at once; try again"};
    full.retry_after_s = 2;
    response = problem_response(full, request);
  }
  const bool has_body = response.status != 204 && response.status != 304;
  std::optional<std::uint64_t> length;
  if (has_body) length = file_size ? *file_size : response.body.size();
  std::string text = response_head(response, request.id, length, close);
  const bool is_head = request.method == Method::Head;
  const bool is_large = response.body.size() >= kLargeAnswer;  // and stays where it is
  if (has_body && !is_head && !file_size && !is_large) text += response.body;
  client->enter(Client::State::Busy);
  bool fine = co_await send_all(hub, client, text);
  if (fine && has_body && !is_head && is_large)
    fine = co_await send_all(hub, client, response.body);
  if (fine && file_size && !is_head) fine = co_await send_file(hub, client, *file, *file_size);
  hub.metrics.count(exchange.route == nullptr ? "none" : exchange.route->path, response.status);
  const double ms =
      std::chrono::duration<double, std::milli>(Clock::now() - exchange.begun).count();
  hub.log_request(request, response, ms);
  co_return fine && !close;
}

// Checks host, path, method and length, which need neither the body nor the service.
std::optional<Problem> look_at_head(Hub& hub, const Client& client, Exchange& exchange,
                                    Response& refusal) {
  const RequestHead& head = client.reader.head();
  Request& request = exchange.request;
  request.method = head.method;
  request.target = head.target;
  request.headers = head.headers;
  request.place = place_of(client.peer);
  if (auto wrong = check_host(head, client.peer, hub.names)) return wrong;
  Answer<Target> target = read_target(head.target);
  if (!target) return target.error();
  Match match = find_route(head.method, target->segments);
  if (match.allowed.empty())
    return Problem{ProblemKind::NotFound,
                   request.path().size() > 1 && request.path().back() == '/'
                       ? "there is no such path; remove the slash at the end"
                       : "there is no such path; /v1/openapi.json lists all paths"};
  if (match.route == nullptr) {
    refusal.headers.push_back({"Allow", allow_header(match.allowed)});
    return Problem{ProblemKind::MethodNotAllowed,
                   fmt::format("this path does not support {}; it supports {}",
                               name_of(head.method), allow_header(match.allowed))};
  }
  exchange.route = match.route;
  request.params = std::move(match.params);
  request.query = std::move(target->query);
  request.usual_page_items = match.route->usual_page_items;
  if (client.reserved && !match.route->is_urgent) {
    Problem full{ProblemKind::Unavailable, "all connections are in use; try again"};
    full.retry_after_s = 1;
    return full;
  }
  const std::uint64_t most = most_bytes(*match.route, hub.limits());
  if (match.route->body != BodyRule::None && head.content_length.value_or(0) > most)
    return Problem{ProblemKind::TooLarge, fmt::format("the body may have at most {} bytes", most)};
  return std::nullopt;
}

// The problem of a failed login; after too many of them, the client must wait.
Problem failed_login(Hub& hub, const Client& client, Problem problem) {
  if (const auto wait = hub.logins.note(place_of(client.peer), hub.now_s())) {
    problem = Problem{ProblemKind::Rate, "too many failed logins"};
    problem.retry_after_s = *wait;
  }
  return problem;
}

asio::awaitable<Answer<Principal>> authenticate(Hub& hub, ClientPtr client, bool is_urgent) {
  const RequestHead& head = client->reader.head();
  if (client->peer.is_local) {
    if (head.header("authorization")) {
      co_return refuse(ProblemKind::Unauthenticated,
                       "on the unix socket, your user is your identity; do not send Authorization");
    }
    co_return local_principal(client->peer, hub.options.users, ::getuid(), hub.options.machine);
  }
  const Answer<std::string> bearer = bearer_of(head);
  if (!bearer) {
    // A request without a token is not an attempt to guess one.
    if (!head.header("authorization")) co_return tl::unexpected<Problem>(bearer.error());
    co_return tl::unexpected<Problem>(failed_login(hub, *client, bearer.error()));
  }
  struct Found {
    std::optional<Principal> who;
    bool is_unknown{false};  ///< the credential is not valid
  };
  auto found = std::make_shared<Found>();
  std::function<void(Service&, Hub::Done)> work = [token = *bearer, found](Service& service,
                                                                           const Hub::Done& done) {
    Found now;
    try {
      now.who = service.access.authenticate(token);
    } catch (const std::exception&) {
      now.is_unknown = true;
    }
    done([found, now = std::move(now)] { *found = now; });
  };
  const bool answered = co_await hub.ask(client, std::move(work), kAuthenticate_s, is_urgent);
  if (!answered) co_return refuse(ProblemKind::Unavailable, "popcutd is not answering");
  if (found->who) co_return *found->who;
  // A client that took this for a refusal would discard a valid token.
  if (found->is_unknown) {
    Problem later{ProblemKind::Unavailable,
                  "popcutd cannot look your token up now; send the request again in a moment"};
    later.retry_after_s = 2;
    co_return tl::unexpected<Problem>(std::move(later));
  }
  co_return tl::unexpected<Problem>(failed_login(
      hub, *client,
      Problem{ProblemKind::Unauthenticated,
              "unknown token: it has ended or was deleted; log in again, or ask an admin for a new "
              "one ('popcut token create')"}));
}

// The key under which requests are counted: nobody uses up the rate of another.
std::string bucket_of(const Peer& peer, const Route& route, const Principal& principal) {
  const std::string place = place_of(peer);
  if (route.access.is_open()) return fmt::format("{} open {}", place, route.path);
  return peer.is_local ? place : fmt::format("{} {}", place, principal.name);
}

Problem lacks_role(const Route& route, const Principal& principal) {
  return {ProblemKind::Forbidden,
          fmt::format("this requires the role {}; {} has {}", name_of(route.access.role()),
                      principal.name, name_of(principal.role))};
}

std::optional<Problem> take_from_bucket(Hub& hub, const Client& client, const Exchange& exchange) {
  const Route& route = *exchange.route;
  const HttpLimits& limits = hub.limits();
  struct Rate {
    RateLimit& limit;
    double per_s;
    const char* what;
  };
  const Rate rate =
      route.is_urgent                   ? Rate{hub.urgent_rate, limits.rate_per_s, "requests"}
      : route.bucket == Bucket::Preview ? Rate{hub.preview_rate, limits.previews_per_s, "previews"}
      : route.bucket == Bucket::Picture ? Rate{hub.picture_rate, limits.pictures_per_s, "pictures"}
                                        : Rate{hub.rate, limits.rate_per_s, "requests"};
  const auto wait =
      rate.limit.take(bucket_of(client.peer, route, exchange.request.principal), hub.now_s());
  if (!wait) return std::nullopt;
  Problem problem{ProblemKind::Rate,
                  fmt::format("more than {:g} {} per second", rate.per_s, rate.what)};
  problem.retry_after_s = *wait;
  return problem;
}

// A valid one-time code works however many wrong ones come from the same address: all users of this
// computer share 127.0.0.1.
bool counts_failures(const Route& route) {
  return route.guess == Guess::Word || route.guess == Guess::Secret;
}

// The key under which the attempts of a route are counted. A wrong one-time code is a failed login.
std::string tries_of(const Client& client, const Exchange& exchange) {
  const Route& route = *exchange.route;
  if (route.guess == Guess::Word) return place_of(client.peer);
  return fmt::format("{} {} {}", place_of(client.peer), exchange.request.principal.name,
                     route.path);
}

Problem too_many_tries(const Route& route, int wait_s) {
  Problem problem{ProblemKind::Rate, "too many failed logins"};
  if (route.guess == Guess::Secret)
    problem.detail = "too many expired pairings; request a new code";
  if (route.guess == Guess::Code)
    problem.detail = "too many wrong codes; wait, then check the code";
  if (route.guess == Guess::Another) problem.detail = "too many pairing requests; wait a little";
  problem.retry_after_s = wait_s;
  return problem;
}

// Counts the attempt that a response reports: a wrong code, or a new secret.
std::optional<Problem> count_try(Hub& hub, const Client& client, const Exchange& exchange,
                                 const Response& response) {
  const Guess guess = exchange.route->guess;
  const bool counts = (guess == Guess::Word && response.status == 401) ||
                      (guess == Guess::Secret && response.status == 404) ||
                      (guess == Guess::Code && response.status == 404) ||
                      (guess == Guess::Another && response.status == 201);
  if (!counts) return std::nullopt;
  const auto wait = hub.logins.note(tries_of(client, exchange), hub.now_s());
  if (!wait || guess == Guess::Another) return std::nullopt;
  return too_many_tries(*exchange.route, *wait);
}

// Checked before the attempt: a right code must not pass among too many wrong ones.
std::optional<Problem> too_many_before(Hub& hub, const Client& client, const Exchange& exchange) {
  const Guess guess = exchange.route->guess;
  if (guess != Guess::Code && guess != Guess::Another) return std::nullopt;
  const auto wait = hub.logins.wait(tries_of(client, exchange), hub.now_s());
  if (!wait) return std::nullopt;
  return too_many_tries(*exchange.route, *wait);
}

// Role, origin, rate, form of the body.
std::optional<Problem> look_at_principal(Hub& hub, Client& client, Exchange& exchange) {
  const Request& request = exchange.request;
  const Route& route = *exchange.route;
  if (!route.access.is_open() && !route.access.allows(request.principal.role))
    return lacks_role(route, request.principal);
  if (auto wrong = check_origin(client.reader.head(), client.peer, hub.names)) {
    hub.metrics.reject("origin");
    return wrong;
  }
  if (hub.is_crowding(client) && !route.is_urgent) {
    hub.metrics.reject("crowd");
    Problem full{ProblemKind::Unavailable,
                 fmt::format("{} holds half of all connections; close some, or try again",
                             request.principal.name)};
    full.retry_after_s = 5;
    return full;
  }
  if (!counts_failures(route) && !route.is_static)
    if (auto wait = take_from_bucket(hub, client, exchange)) return wait;
  const RequestHead& head = client.reader.head();
  // Headers that describe a body do not matter without one.
  if (route.body != BodyRule::None)
    if (auto wrong = check_media(head, exchange.request.media_type)) return wrong;
  const bool has_body = head.is_chunked || head.content_length.value_or(0) > 0;
  if (auto wrong = check_body(route, exchange.request.media_type, has_body)) return wrong;
  if (const auto expect = head.header("expect"); expect && *expect != "100-continue")
    return Problem{ProblemKind::BadRequest, "the only Expect value supported is 100-continue"};
  const bool is_upload = route.body == BodyRule::Design || route.body == BodyRule::Asset;
  if (!is_upload) return std::nullopt;
  const int own = hub.uploads_of(request.principal.name);
  if (own >= std::max(1, hub.limits().uploads / 2)) {
    hub.metrics.reject("crowd");
    Problem busy{
        ProblemKind::Unavailable,
        fmt::format("{} uploads of yours are under way; try again when one has ended", own)};
    busy.retry_after_s = 1;
    return busy;
  }
  if (hub.uploads >= hub.limits().uploads) {
    Problem busy{ProblemKind::Unavailable, "too many uploads at once; try again"};
    busy.retry_after_s = 1;
    return busy;
  }
  Answer<Spool> spool = Spool::create(hub.options.incoming_folder, request.id);
  if (!spool) return spool.error();
  exchange.spool = std::make_shared<Spool>(std::move(*spool));
  ++hub.uploads;
  client.uploads = true;
  return std::nullopt;
}

asio::awaitable<std::optional<Problem>> read_whole_body(Hub& hub, ClientPtr client,
                                                        Exchange& exchange) {
  const std::uint64_t most = most_bytes(*exchange.route, hub.limits());
  std::uint64_t got = 0;
  const RequestReader::Sink sink = [&](std::string_view piece) -> std::optional<Problem> {
    got += piece.size();
    if (exchange.spool) return exchange.spool->add(piece);
    exchange.request.body += piece;
    return std::nullopt;
  };
  if (!client->reader.is_done() && client->reader.head().header("expect")) {
    const bool fine = co_await send_all(hub, client, "HTTP/1.1 100 Continue\r\n\r\n");
    if (!fine) co_return Problem{ProblemKind::BadRequest, ""};
  }
  BodyPace pace(hub.now_s());
  while (true) {
    const Answer<bool> whole = client->reader.read_body(most, sink);
    if (!whole) co_return whole.error();
    if (*whole) break;
    client->expect_within(client, pace.left_s(hub.limits(), got, hub.now_s()));
    const bool more = co_await receive(client);
    if (!more) co_return Problem{ProblemKind::BadRequest, "the body ended early"};
  }
  client->relax();
  if (!exchange.spool) co_return std::nullopt;
  if (got == 0)
    co_return Problem{ProblemKind::Validation, "the body is empty; send the file itself"};
  auto upload = std::make_shared<std::optional<Answer<Upload>>>();
  std::function<void()> finish = [upload, spool = exchange.spool] { *upload = spool->finish(); };
  const bool finished = co_await hub.run_aside(client, hub.disk, std::move(finish));
  if (!finished || !*upload) {
    Problem late{ProblemKind::Unavailable, "the disk is too slow; try again"};
    late.retry_after_s = 5;
    co_return late;
  }
  if (!**upload) co_return (*upload)->error();
  exchange.request.upload = std::move(***upload);
  co_return std::nullopt;
}

double patience_of(const Route& route, const HttpLimits& limits) {
  switch (route.patience) {
    case Patience::Probe:
      return 1;
    case Patience::Design:
      return limits.design_answer_s;
    case Patience::Usual:
      break;
  }
  return limits.answer_s;
}

// Static files need neither the service nor its thread.
Response static_response(Hub& hub, const Exchange& exchange) {
  Response answer;
  dispatch(exchange.request, *exchange.route, *hub.options.service, hub.context,
           Reply([&answer](Response response) { answer = std::move(response); }));
  return answer;
}

// Notices when a client disconnects while it waits for its answer. The watch ends if the client
// sends more, which is read later.
void watch_for_end(const ClientPtr& client) {
  client->socket.async_wait(asio::socket_base::wait_read, [client](const error_code& ec) {
    if (ec || client->closed) return;
    char next = 0;
    const ssize_t got = ::recv(client->socket.native_handle(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
    if (got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR))) return;
    client->close();
  });
}

asio::awaitable<Response> ask_handler(Hub& hub, ClientPtr client, Exchange& exchange) {
  auto answer = std::make_shared<std::optional<Response>>();
  // Shared with the service, because a client that disconnects does not cancel its request.
  auto request = std::make_shared<Request>(exchange.request);
  const Route* const route = exchange.route;
  const auto context = std::make_shared<HandlerContext>(hub.context);
  const std::shared_ptr<Spool> spool = exchange.spool;  // kept until the service has answered
  // A body may take minutes, so the credential is checked again when it is complete.
  std::string bearer;
  if (!route->access.is_open() && !client->peer.is_local)
    bearer = bearer_of(client->reader.head()).value_or("");
  if (!route->access.is_open() && client->peer.is_local) {
    const Answer<Principal> now =
        local_principal(client->peer, hub.options.users, ::getuid(), hub.options.machine);
    if (!now) co_return problem_response(now.error(), *request);
    if (!route->access.allows(now->role))
      co_return problem_response(lacks_role(*route, *now), *request);
    request->principal = *now;
  }
  std::function<void(Service&, Hub::Done)> work = [=](Service& service, const Hub::Done& done) {
    const Reply reply([answer, done, spool](Response response) {
      done([answer, response = std::move(response)]() mutable { *answer = std::move(response); });
    });
    if (!bearer.empty()) {
      const std::optional<Principal> now = service.access.authenticate(bearer);
      if (!now)
        return reply(problem_response(
            Problem{ProblemKind::Unauthenticated, "this token or session has ended"}, *request));
      if (!route->access.allows(now->role))
        return reply(problem_response(lacks_role(*route, *now), *request));
      request->principal = *now;
    }
    dispatch(*request, *route, service, *context, reply);
  };
  if (route->ends_with_client) {
    request->departure = std::make_shared<Departure>();
    watch_for_end(client);
  }
  const bool answered = co_await hub.ask(client, std::move(work), patience_of(*route, hub.limits()),
                                         route->is_urgent);
  if (route->ends_with_client && !client->closed) {
    error_code none;
    client->socket.cancel(none);  // only `watch_for_end` waits for it
  }
  if (request->departure && !answered) request->departure->happens();
  if (answered && *answer) co_return std::move(**answer);
  Problem late{ProblemKind::Unavailable,
               route->key == KeyRule::None
                   ? "popcutd has no answer yet; try again"
                   : "popcutd has no answer yet; send the request again with the same "
                     "Idempotency-Key"};
  late.retry_after_s = 5;
  co_return problem_response(late, *request);
}

// The word under which metrics count a refusal, beside those of the front door.
void count_refusal(Hub& hub, const Response& response) {
  if (response.status == 400 && response.body.find("nested more than") != std::string::npos)
    hub.metrics.reject("depth");
}

// Reads the rest of one request and answers it. False: the connection ends.
asio::awaitable<bool> serve_one(Hub& hub, ClientPtr client, Exchange& exchange) {
  Request& request = exchange.request;
  const RequestHead& head = client->reader.head();
  Response refusal;
  std::optional<Problem> problem = look_at_head(hub, *client, exchange, refusal);
  if (!problem && !exchange.route->access.is_open()) {
    const bool is_for_knife = exchange.route->is_urgent && request.method == Method::Post;
    if (is_for_knife && hub.options.on_knife) hub.options.on_knife();
    Answer<Principal> principal = co_await authenticate(hub, client, exchange.route->is_urgent);
    client->principal = principal ? principal->name : std::string();
    if (principal)
      request.principal = std::move(*principal);
    else
      problem = std::move(principal.error());
  }
  if (!problem) problem = look_at_principal(hub, *client, exchange);
  if (!problem) problem = too_many_before(hub, *client, exchange);
  if (!problem) problem = co_await read_whole_body(hub, client, exchange);
  if (client->closed) co_return false;
  // An unread rest of the body would be taken for the next request.
  const bool has_rest = !client->reader.is_done();
  const bool close = has_rest || head.asks_close || hub.stopping || client->reserved;
  if (problem) {
    if (const auto word = reject_word(*problem); !word.empty()) hub.metrics.reject(word);
    Response response = problem_response(*problem, request);
    for (Header& header : refusal.headers) response.headers.push_back(std::move(header));
    const bool fine = co_await respond(hub, client, exchange, std::move(response), close);
    if (has_rest && !client->closed) co_await linger(client);
    co_return fine;
  }
  const bool is_stream =
      exchange.route->is_stream && request.method == Method::Get && wants_stream(request);
  if (is_stream) problem = check_stream(request, *exchange.route);
  if (problem)
    co_return co_await respond(hub, client, exchange, problem_response(*problem, request), close);
  if (is_stream) {
    co_await stream_events(hub, client, request);
    co_return false;
  }
  Response response;
  if (exchange.route->is_static)
    response = static_response(hub, exchange);
  else
    response = co_await ask_handler(hub, client, exchange);
  if (client->closed) co_return false;
  if (counts_failures(*exchange.route) && response.status >= 400 && response.status < 500)
    if (const auto wait = take_from_bucket(hub, *client, exchange))
      response = problem_response(*wait, request);
  // An unknown word may be a guess; a malformed body is not.
  if (const auto wrong = count_try(hub, *client, exchange, response))
    response = problem_response(*wrong, request);
  count_refusal(hub, response);
  co_return co_await respond(hub, client, exchange, std::move(response), close);
}

// Waits for a head. False: the connection ends, answered or not.
asio::awaitable<bool> next_head(Hub& hub, ClientPtr client) {
  client->enter(client->reader.has_begun() ? Client::State::Head : Client::State::Idle);
  const bool may_idle = client->served > 0 && !client->reader.has_begun();
  client->expect_within(client, may_idle ? hub.limits().idle_s : hub.limits().header_s);
  while (true) {
    const Answer<bool> whole = client->reader.read_head();
    if (!whole) {
      Exchange exchange;
      exchange.request.id = new_request_id();
      exchange.request.method = Method::Other;
      if (const auto word = reject_word(whole.error()); !word.empty()) hub.metrics.reject(word);
      Response response = problem_response(whole.error(), exchange.request);
      const bool fine = co_await respond(hub, client, exchange, std::move(response), true);
      static_cast<void>(fine);
      if (!client->closed) co_await linger(client);
      co_return false;
    }
    if (*whole) break;
    const bool had_begun = client->reader.has_begun();
    const bool more = co_await receive(client);
    if (!more) co_return false;
    if (!had_begun) {
      client->enter(Client::State::Head);
      client->expect_within(client, hub.limits().header_s);
    }
  }
  client->relax();
  client->enter(Client::State::Busy);
  co_return true;
}

asio::awaitable<void> serve_all(Hub& hub, ClientPtr client) {
  while (!client->closed && !hub.stopping) {
    const bool has_head = co_await next_head(hub, client);
    if (!has_head) co_return;
    Exchange exchange;
    exchange.request.id = new_request_id();
    const AtEnd give_back([&hub, &exchange, client] {
      if (exchange.spool) --hub.uploads;
      client->uploads = false;
    });
    const bool goes_on = co_await serve_one(hub, client, exchange);
    if (!goes_on) co_return;
    ++client->served;
    client->reader.next();
  }
}

}  // namespace

asio::awaitable<bool> send_all(Hub& hub, ClientPtr client, std::string_view bytes) {
  const Clock::time_point begun = Clock::now();
  std::size_t sent = 0;
  while (sent < bytes.size() && !client->closed) {
    const double spent = std::chrono::duration<double>(Clock::now() - begun).count();
    const double left =
        hub.limits().body_s + static_cast<double>(sent) / hub.limits().body_bytes_per_s - spent;
    client->expect_within(client, std::max(left, 0.0));
    error_code ec;
    const std::size_t now = co_await client->socket.async_write_some(
        asio::buffer(bytes.data() + sent, bytes.size() - sent),
        asio::redirect_error(asio::use_awaitable, ec));
    if (ec) {
      client->close();
      co_return false;
    }
    sent += now;
  }
  client->relax();
  co_return !client->closed;
}

asio::awaitable<void> serve(Hub& hub, ClientPtr client) {
  const AtEnd leave([&hub, client] {
    client->close();
    hub.remove(client);
  });
  try {
    co_await serve_all(hub, client);
  } catch (const std::exception& e) {
    hub.log_fault(e.what());
  }
}

}  // namespace popcut::daemon::http
