// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/http/api/message.hpp"
#include "daemon/model/input_limits.hpp"
#include "daemon/model/limits.hpp"
#include "daemon/service/service.hpp"

namespace popcut::daemon::http {

/// What a handler knows besides the request and the service.
struct HandlerContext {
  HttpLimits limits{};
  std::string build{};           ///< version of the program
  std::string openapi_sha256{};  ///< of /v1/openapi.json
  std::string page_url{};        ///< "http://localhost:8631/"; empty: it listens on no TCP address
  std::function<void(const std::string&)> log_fault{};      ///< from any thread; can be empty
  std::function<std::string()> metrics{};                   ///< of HTTP; called on its thread
  std::function<std::vector<WorkerWall>()> worker_walls{};  ///< what isolates workers; can be empty
};

/// Answers one request. Runs on the service's thread; the reply may come later.
using HandlerFunction = void(const Request&, Service&, const HandlerContext&, Reply);
using Handler = HandlerFunction*;

/// Who may use a route. Without a default, so that a route that forgets it does not compile.
class RouteAccess {
 public:
  constexpr explicit RouteAccess(Role least) : role_(least), open_(false) {}
  /// Everyone, without authentication. Only for requests that change nothing.
  static constexpr RouteAccess everyone() { return {}; }
  [[nodiscard]] constexpr bool is_open() const { return open_; }
  [[nodiscard]] constexpr Role role() const { return role_; }
  [[nodiscard]] constexpr bool allows(Role role) const { return open_ || role >= role_; }

 private:
  constexpr RouteAccess() : role_(Role::Viewer), open_(true) {}
  Role role_;
  bool open_;
};

enum class BodyRule : std::uint8_t { None, Json, Design, Asset };
enum class KeyRule : std::uint8_t { None, Allowed, Required };  ///< Idempotency-Key
enum class MatchRule : std::uint8_t {
  None,
  Required,  ///< If-Match has the revision that the client saw
  OrAny,     ///< or is "*": you can stop a knife without knowing the revision
  OrNew,     ///< or If-None-Match is "*": it must not exist yet
  Allowed    ///< compared with the revision if it is sent
};
/// Which rate of a principal a request counts against.
enum class Bucket : std::uint8_t { Usual, Preview, Picture };
enum class Patience : std::uint8_t { Usual, Probe, Design };  ///< how long the answer may take

/// What an attacker could guess with many requests. All of it is limited like failed logins, five a
/// minute.
enum class Guess : std::uint8_t {
  None,
  Word,    ///< 401: the one-time code was wrong; valid ones always pass
  Secret,  ///< the same, with 404; counted apart from logins
  Code,    ///< 404: a code was wrong
  Another  ///< each answer is one more secret that can be guessed
};

/// An answer of a route that succeeds.
struct Success {
  /// What the body is, with a space between where a client may choose: a schema ("Job"; "JobPage"
  /// is the page of a list of them), a media type ("image/png"), or a media type with the type of
  /// its schema ("text/csv:string").
  std::string_view content{};
  int status{};             ///< 0: 200, or 204 without content
  std::string_view text{};  ///< empty: what the status usually means
};

struct Body;

/// What a row of the table says beyond method, path, role and handler. The server holds requests
/// against it, and the description of the API is made from it.
struct RouteRules {
  const Body* takes{nullptr};  ///< the JSON body
  BodyRule body{BodyRule::None};
  KeyRule key{KeyRule::None};
  MatchRule match{MatchRule::None};
  std::string_view query{};               ///< the names that a query may have, with a space between
  int usual_page_items{kUsualPageItems};  ///< of a list whose query has no `limit`
  std::string_view parameter{};           ///< of components/parameters: a header that it takes too

  Success gives{};
  Success gives_too{};         ///< another status than that of `gives`
  std::string_view headers{};  ///< further headers of its answers, with a space between
  bool has_etag{false};        ///< its answers carry a revision
  bool is_cached{false};       ///< the same, and 304 for a client that has the answer already

  // Which problems a handler can give beyond those that follow from the rest of the row.
  bool can_miss{false};        ///< 404 although the path names nothing
  bool can_conflict{false};    ///< 409
  bool stores_nothing{false};  ///< changes nothing on disk, so that a full disk does not matter
  bool is_constant{false};     ///< gives what the program contains: never 500

  /// Stops a knife, or is needed for that: served even when all places are taken.
  bool is_urgent{false};
  Patience patience{Patience::Usual};
  /// May become a stream of events (see `wants_stream`).
  bool is_stream{false};
  /// Built into the program: answered without the service and its thread, and not rate limited. Its
  /// handler must not use the service.
  bool is_static{false};
  Bucket bucket{Bucket::Usual};
  /// The handler cancels its work when the client disconnects (`Request::departure`).
  bool ends_with_client{false};
  Guess guess{Guess::None};
  std::string_view details{};  ///< what `summary` leaves out, in sentences
};

struct Route : RouteRules {
  Method method{};
  std::string_view path{};  ///< "/v1/jobs/{id}/sheets/{k}"; {..} is any one part
  RouteAccess access;  ///< must be given: a route that says nothing does not compile (tests/misuse)
  Handler handler{nullptr};
  std::string_view summary{};  ///< for the description of the API: "Get a job"
};

/// All routes. The description of the API (openapi.hpp) is made from them.
[[nodiscard]] std::span<const Route> routes();

struct Match {
  const Route* route{nullptr};      ///< nullptr: nothing for this method and path
  std::vector<std::string> params;  ///< the values of {..}
  std::vector<Method> allowed;      ///< the methods of that path; empty: no such path
};
/// HEAD is served by the route of GET.
[[nodiscard]] Match find_route(Method method, const std::vector<std::string>& segments);

/// "GET, HEAD, POST" for the header Allow.
[[nodiscard]] std::string allow_header(const std::vector<Method>& allowed);

}  // namespace popcut::daemon::http
