// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/http/api/input.hpp"
#include "daemon/http/api/routes.hpp"

namespace popcut::daemon::http {

// What handlers share: answers, revisions, pages, numbers and times.

[[nodiscard]] Response json_response(int status, const nlohmann::ordered_json& body);
/// 204, or the problem.
[[nodiscard]] Response done_response(const Request& request, const Answer<void>& done);
[[nodiscard]] std::string etag_of(std::int64_t rev);
/// 200 with an ETag.
[[nodiscard]] Response revised(int status, std::int64_t rev, const nlohmann::ordered_json& body);
[[nodiscard]] Response revised(int status, std::int64_t rev, std::string text);
/// True if the client already has the version `etag`.
[[nodiscard]] bool has_seen(const Request& request, std::string_view etag);
/// 304: the client already has this version.
[[nodiscard]] Response unchanged(std::string_view etag, std::string_view cache_control = {});
/// A rendered answer, as stored with an Idempotency-Key.
[[nodiscard]] Response from_rendered(Rendered rendered);
[[nodiscard]] Rendered to_rendered(const Response& response);

/// Answers with `effect`, which runs once for each Idempotency-Key. Returns the status.
int answer_once(const Request& request, Service& service, const Reply& reply,
                const std::function<Response()>& effect);

/// "12" as a number; nothing if the text is anything else.
[[nodiscard]] std::optional<std::int64_t> whole_number(std::string_view text);
/// Whether `text` can be an Idempotency-Key or a Preview-Key.
[[nodiscard]] bool is_key(std::string_view text);

/// "2026-11-21" or "2026-11-21T10:12:00[.123](Z|+01:00)" as time; nothing if it is neither.
[[nodiscard]] std::optional<TimeMs> time_from(std::string_view text);

/// The revision in If-Match: `"12"`. "*" is `current`, where the route allows it.
[[nodiscard]] Answer<std::int64_t> wanted_rev(const Request& request,
                                              std::optional<std::int64_t> current);

/// The number in a path: 1, 2, ... without sign or leading zero; nothing otherwise.
[[nodiscard]] std::optional<int> path_number(const std::string& text);

/// The problem of an optional If-Match that is not the revision of the job.
[[nodiscard]] std::optional<Problem> check_seen(const Request& request, const Job& job);

/// A problem if a submitter changes something of someone else.
[[nodiscard]] std::optional<Problem> check_owner(const Request& request, const std::string& owner);

/// The page of a complete list, ordered by `key_of`, a string.
template <typename T, typename KeyOf>
Page<T> page_of(std::vector<T> all, const PageRequest& wanted, KeyOf key_of) {
  Page<T> page;
  for (T& one : all) {
    if (!wanted.cursor.empty() && key_of(one) <= wanted.cursor) continue;
    if (page.items.size() == static_cast<std::size_t>(wanted.limit)) {
      page.next_cursor = key_of(page.items.back());
      break;
    }
    page.items.push_back(std::move(one));
  }
  return page;
}

/// The text of a page of items that are rendered already.
[[nodiscard]] std::string page_text(const std::vector<std::string>& items,
                                    const std::string& next_cursor);

/// A page of the list `list` (see `QueryReader::page`); rendered late, on the thread of HTTP.
template <typename T, typename Render>
Response page_response(Page<T> page, char list, Render render) {
  Response response;
  std::string next = page.next_cursor.empty() ? std::string() : list + page.next_cursor;
  response.make_body = [items = std::move(page.items), next = std::move(next), render] {
    std::vector<std::string> texts;
    texts.reserve(items.size());
    for (const T& item : items) texts.push_back(render(item));
    return page_text(texts, next);
  };
  return response;
}

/// The page that the query asks for of the list `list`, whose items `all` are ordered by `key_of`,
/// a string.
template <typename T, typename KeyOf, typename Render>
Response whole_list_response(const Request& request, char list, std::vector<T> all, KeyOf key_of,
                             Render render) {
  QueryReader query(request);
  const PageRequest wanted = query.page(list);
  if (const auto wrong = query.problem()) return problem_response(*wrong, request);
  return page_response(page_of(std::move(all), wanted, key_of), list, render);
}

}  // namespace popcut::daemon::http
