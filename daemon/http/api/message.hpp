// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/model/input_limits.hpp"
#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon::http {

enum class Method : std::uint8_t { Get, Head, Post, Put, Patch, Delete, Options, Other };
[[nodiscard]] std::string_view name_of(Method method);
/// The method of that name (case-sensitive); `Other` for methods that no route has.
[[nodiscard]] Method method_from(std::string_view name);

struct Header {
  std::string name;  ///< lower case in what was received
  std::string value;
};

/// The head of a request that passed `check_head`.
struct RequestHead {
  Method method{};
  std::string target;  ///< as it was sent: "/v1/jobs?limit=10"
  std::vector<Header> headers{};
  bool is_http_1_0{false};
  bool is_chunked{false};
  bool asks_close{false};
  std::optional<std::uint64_t> content_length{};

  /// The value, or nothing if there is no such header.
  [[nodiscard]] std::optional<std::string_view> header(std::string_view lower_name) const;
};

/// Cancels the work of a request when its client disconnects before the answer. From any thread.
class Departure {
 public:
  /// Calls `what` when the client disconnects; at once, if it already has.
  void then(std::function<void()> what);
  void happens();

 private:
  std::mutex mutex_;
  bool has_happened_{false};
  std::function<void()> what_{};
};

/// A request as handlers see it: authenticated, with the path matched and the body read.
struct Request {
  Method method{};
  std::string target;
  std::string id;                     ///< chosen by the server; in each problem and log line
  std::vector<std::string> params{};  ///< what stands for {...} in the route, decoded
  std::vector<std::pair<std::string, std::string>> query{};
  std::vector<Header> headers{};
  std::string media_type{};
  std::string body{};
  std::optional<Upload> upload{};
  Principal principal{};
  std::string place{};                     ///< the user or network that it came from
  std::shared_ptr<Departure> departure{};  ///< of its client; null: not watched
  int usual_page_items{kUsualPageItems};   ///< of a list, if the query has no `limit`

  [[nodiscard]] std::optional<std::string_view> header(std::string_view lower_name) const;
  /// The path of `target`, without the query.
  [[nodiscard]] std::string_view path() const;
};

struct Response {
  int status{200};
  std::string content_type{"application/json"};
  std::string body{};
  /// Makes the body later, on a thread of its own: a long list delays neither the service nor other
  /// clients.
  std::function<std::string()> make_body{};
  bool is_brief{false};  ///< `make_body` is quick; call it on the HTTP thread
  std::string file{};    ///< if not empty: the body is what this file holds
  std::vector<Header> headers{};
};

/// Answers one request, once; from any thread, now or later. If the last copy is destroyed without
/// an answer, the client gets 500.
class Reply {
 public:
  explicit Reply(std::function<void(Response)> send);
  void operator()(Response response) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// `problem` as application/problem+json.
[[nodiscard]] Response problem_response(const Problem& problem, std::string_view instance,
                                        std::string_view request_id);
[[nodiscard]] Response problem_response(const Problem& problem, const Request& request);

/// The head of a response: status line, what every response carries, `extra`, and the length of
/// the body if it is known. Control characters in values become spaces.
[[nodiscard]] std::string response_head(const Response& response, std::string_view request_id,
                                        std::optional<std::uint64_t> length, bool close);

/// "Not Found", ...
[[nodiscard]] std::string_view reason_of(int status);

/// `text` with control characters (C0, DEL and C1) as \x..: fit for one line of a log.
[[nodiscard]] std::string for_log(std::string_view text);

}  // namespace popcut::daemon::http
