// SPDX-License-Identifier: MIT
#include "daemon/http/api/handler_kit.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/digest/digest.hpp"
#include "daemon/http/api/render.hpp"
#include "daemon/http/api/target.hpp"

namespace popcut::daemon::http {
namespace {

template <typename Number>
std::optional<Number> number_from(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Digits only, as many as `text` is long.
std::optional<int> digits(std::string_view text) {
  if (text.empty() ||
      !std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }))
    return std::nullopt;
  return number_from<int>(text);
}

// "Z", "+01:00" or "-05:30" in minutes.
std::optional<int> zone_minutes(std::string_view zone) {
  if (zone == "Z" || zone == "z") return 0;
  if (zone.size() != 6 || (zone[0] != '+' && zone[0] != '-') || zone[3] != ':') return std::nullopt;
  const auto hours = digits(zone.substr(1, 2)), minutes = digits(zone.substr(4, 2));
  if (!hours || !minutes || *hours > 23 || *minutes > 59) return std::nullopt;
  return (*hours * 60 + *minutes) * (zone[0] == '-' ? -1 : 1);
}

// What follows the "T": the milliseconds of the day, in UTC.
std::optional<TimeMs> time_of_day(std::string_view text) {
  if (text.size() < 9 || text[2] != ':' || text[5] != ':') return std::nullopt;
  const auto hours = digits(text.substr(0, 2)), minutes = digits(text.substr(3, 2)),
             seconds = digits(text.substr(6, 2));
  if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || *seconds > 60)
    return std::nullopt;
  text.remove_prefix(8);
  TimeMs ms = 0;
  if (text.front() == '.') {
    const std::size_t end = text.find_first_not_of("0123456789", 1);
    if (end == std::string_view::npos || end == 1 || end > 10) return std::nullopt;
    const std::string fraction =
        fmt::format("{:0<3}", text.substr(1, std::min<std::size_t>(end - 1, 3)));
    ms = digits(fraction).value_or(0);
    text.remove_prefix(end);
  }
  const auto zone = zone_minutes(text);
  if (!zone) return std::nullopt;
  return ((TimeMs{*hours} * 60 + *minutes - *zone) * 60 + *seconds) * 1000 + ms;
}

bool has_etag(std::string_view list, std::string_view etag) {
  if (list == "*") return true;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    std::string_view one = trimmed(list.substr(0, end), " \t");
    if (one.starts_with("W/")) one.remove_prefix(2);
    if (one == etag) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

}  // namespace

Response json_response(int status, const nlohmann::ordered_json& body) {
  Response response;
  response.status = status;
  response.body = dump(body);
  return response;
}

Response done_response(const Request& request, const Answer<void>& done) {
  if (!done) return problem_response(done.error(), request);
  Response response;
  response.status = 204;
  response.content_type.clear();
  return response;
}

bool has_seen(const Request& request, std::string_view etag) {
  const auto seen = request.header("if-none-match");
  return seen && has_etag(*seen, etag);
}

Response unchanged(std::string_view etag, std::string_view cache_control) {
  Response same;
  same.status = 304;
  same.content_type.clear();
  same.headers.push_back({"ETag", std::string(etag)});
  if (!cache_control.empty()) same.headers.push_back({"Cache-Control", std::string(cache_control)});
  return same;
}

std::string etag_of(std::int64_t rev) { return fmt::format("\"{}\"", rev); }

Response revised(int status, std::int64_t rev, const nlohmann::ordered_json& body) {
  Response response = json_response(status, body);
  response.headers.push_back({"ETag", etag_of(rev)});
  return response;
}

Response revised(int status, std::int64_t rev, std::string text) {
  Response response;
  response.status = status;
  response.body = std::move(text);
  response.headers.push_back({"ETag", etag_of(rev)});
  return response;
}

Response from_rendered(Rendered rendered) {
  Response response;
  response.status = rendered.status;
  response.body = std::move(rendered.body);
  if (rendered.status >= 400) response.content_type = "application/problem+json";
  if (rendered.status == 204) response.content_type.clear();
  if (!rendered.etag.empty()) response.headers.push_back({"ETag", rendered.etag});
  if (!rendered.location.empty()) response.headers.push_back({"Location", rendered.location});
  if (rendered.replayed) response.headers.push_back({"Idempotent-Replayed", "true"});
  return response;
}

Rendered to_rendered(const Response& response) {
  Rendered rendered{response.status, response.body};
  for (const Header& header : response.headers) {
    if (header.name == "ETag") rendered.etag = header.value;
    if (header.name == "Location") rendered.location = header.value;
  }
  return rendered;
}

int answer_once(const Request& request, Service& service, const Reply& reply,
                const std::function<Response()>& effect) {
  const std::string key(request.header("idempotency-key").value_or(""));
  const auto answer = [&reply](Response response) {
    const int status = response.status;
    reply(std::move(response));
    return status;
  };
  if (key.empty()) return answer(effect());
  Sha256 hash;
  for (const std::string_view part :
       {name_of(request.method), std::string_view(request.target), std::string_view(request.body),
        std::string_view(request.principal.name)}) {
    hash.add(part);
    hash.add(std::string_view("\0", 1));
  }
  // Headers that are not stored (Retry-After) go only to the first request with the key.
  std::optional<Response> fresh;
  Answer<Rendered> kept = service.operations.once(request.principal, {key, hash.hex()},
                                                  [&effect, &fresh]() -> Rendered {
                                                    fresh = effect();
                                                    return to_rendered(*fresh);
                                                  });
  if (!kept) return answer(problem_response(kept.error(), request));
  if (fresh && !kept->replayed) return answer(std::move(*fresh));
  return answer(from_rendered(std::move(*kept)));
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  return number_from<std::int64_t>(text);
}

bool is_key(std::string_view text) {
  return text.size() >= kLeastKeyCharacters && text.size() <= kMostKeyCharacters &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < '\x7F'; });
}

std::optional<TimeMs> time_from(std::string_view text) {
  if (text.size() < 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const auto year = digits(text.substr(0, 4)), month = digits(text.substr(5, 2)),
             day = digits(text.substr(8, 2));
  if (!year || !month || !day) return std::nullopt;
  namespace chr = std::chrono;
  const chr::year_month_day date{chr::year(*year), chr::month(static_cast<unsigned>(*month)),
                                 chr::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  const TimeMs midnight = TimeMs{chr::sys_days(date).time_since_epoch().count()} * 24 * 3600 * 1000;
  if (text.size() == 10) return midnight;
  if (text[10] != 'T' && text[10] != 't') return std::nullopt;
  const std::optional<TimeMs> rest = time_of_day(text.substr(11));
  if (!rest) return std::nullopt;
  return midnight + *rest;
}

Answer<std::int64_t> wanted_rev(const Request& request, std::optional<std::int64_t> current) {
  const std::string_view value = request.header("if-match").value_or("");
  if (value == "*" && current) return *current;
  const bool is_quoted = value.size() >= 3 && value.front() == '"' && value.back() == '"';
  const std::optional<std::int64_t> rev =
      is_quoted ? number_from<std::int64_t>(value.substr(1, value.size() - 2)) : std::nullopt;
  if (!rev || *rev < 0)
    return refuse(ProblemKind::BadRequest, "If-Match must be an ETag with its quotes: \"12\"");
  return *rev;
}

std::optional<Problem> check_seen(const Request& request, const Job& job) {
  if (!request.header("if-match")) return std::nullopt;
  const Answer<std::int64_t> rev = wanted_rev(request, job.rev);
  if (!rev) return rev.error();
  if (*rev == job.rev) return std::nullopt;
  Problem stale{
      ProblemKind::Stale,
      fmt::format(
          "the job has changed (it is at revision {}, the request was for {}); read it again",
          job.rev, *rev)};
  stale.rev = job.rev;
  stale.state = name_of(job.state);
  stale.allowed_actions = job.actions;
  return stale;
}

std::optional<int> path_number(const std::string& text) {
  if (text.empty() || text.size() > 6 || text[0] == '0') return std::nullopt;
  return digits(text);
}

std::optional<Problem> check_owner(const Request& request, const std::string& owner) {
  if (request.principal.role >= Role::Operator || request.principal.name == owner)
    return std::nullopt;
  return Problem{ProblemKind::Forbidden,
                 fmt::format("it belongs to {}; only they or an operator may do this",
                             owner.empty() ? "someone else" : owner)};
}

std::string page_text(const std::vector<std::string>& items, const std::string& next_cursor) {
  std::string out = "{\"items\":[";
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) out += ',';
    out += items[i];
  }
  out += "],\"next_cursor\":";
  out += next_cursor.empty() ? "null" : '"' + encode_cursor(next_cursor) + '"';
  out += '}';
  return out;
}

}  // namespace popcut::daemon::http
