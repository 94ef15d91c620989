// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/http/routes.hpp"

namespace popcut::daemon::http {

// What handlers share: answers, revisions, pages, words of the query.

[[nodiscard]] Response json_response(int status, const nlohmann::ordered_json& body);
[[nodiscard]] Response empty_response();  ///< 204
[[nodiscard]] std::string etag_of(std::int64_t rev);
/// 200 with an ETag.
[[nodiscard]] Response revised(int status, std::int64_t rev, const nlohmann::ordered_json& body);
[[nodiscard]] Response revised(int status, std::int64_t rev, std::string text);
/// A rendered answer as it is kept with a key.
[[nodiscard]] Response from_rendered(Rendered rendered);
[[nodiscard]] Rendered to_rendered(const Response& response);

/// Answers with `effect`, which runs once for each Idempotency-Key.
void answer_once(const Request& request, Service& service, const Reply& reply,
                 const std::function<Response()>& effect);

/// The value of a query name, or nothing.
[[nodiscard]] std::optional<std::string> query_text(const Request& request, std::string_view name);
/// A whole number of the query. A fault is added if it is not one of `low..high`.
[[nodiscard]] std::optional<std::int64_t> query_integer(const Request& request,
                                                        std::string_view name, std::int64_t low,
                                                        std::int64_t high,
                                                        std::vector<RequestFault>& faults);
[[nodiscard]] std::optional<TimeMs> query_time(const Request& request, std::string_view name,
                                               std::vector<RequestFault>& faults);
[[nodiscard]] PageWish page_wish(const Request& request, std::vector<RequestFault>& faults);

/// "2026-11-21" or "2026-11-21T10:12:00[.123](Z|+01:00)" as time; nothing if it is neither.
[[nodiscard]] std::optional<TimeMs> time_from(std::string_view text);

/// The revision that If-Match names: `"12"`. "*" gives `current` where the route lets it.
[[nodiscard]] Answer<std::int64_t> wanted_rev(const Request& request,
                                              std::optional<std::int64_t> current);

/// The number in a path: 1, 2, ... without sign or leading zero; nothing otherwise.
[[nodiscard]] std::optional<int> path_number(const std::string& text);

/// Submitters may touch only what is theirs.
[[nodiscard]] std::optional<Problem> check_owner(const Request& request, const std::string& owner);

/// Items as a page; rendered late, on the thread of HTTP.
template <typename T, typename Render>
Response page_response(std::vector<T> items, std::string next_cursor, Render render);

/// The text of a page of items that are rendered already.
[[nodiscard]] std::string page_text(const std::vector<std::string>& items,
                                    const std::string& next_cursor);

template <typename T, typename Render>
Response page_response(std::vector<T> items, std::string next_cursor, Render render) {
  Response response;
  response.make_body = [items = std::move(items), next = std::move(next_cursor), render] {
    std::vector<std::string> texts;
    texts.reserve(items.size());
    for (const T& item : items) texts.push_back(render(item));
    return page_text(texts, next);
  };
  return response;
}

}  // namespace popcut::daemon::http
