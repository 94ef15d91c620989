// SPDX-License-Identifier: MIT
#include "daemon/http/api/dispatch.hpp"

#include <algorithm>
#include <array>
#include <new>

#include <fmt/format.h>

#include "core/text/near_names.hpp"
#include "core/text/words.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/model/turns.hpp"

namespace popcut::daemon::http {
namespace {

constexpr std::array<std::string_view, 5> kDesignTypes{
    "application/json", "application/dxf", "application/pdf", "image/svg+xml", "image/vnd.dxf"};
constexpr std::array<std::string_view, 10> kAssetTypes{"application/octet-stream",
                                                       "application/json",
                                                       "application/dxf",
                                                       "image/svg+xml",
                                                       "image/vnd.dxf",
                                                       "model/gltf-binary",
                                                       "model/obj",
                                                       "model/stl",
                                                       "text/csv",
                                                       "model/x.stl-binary"};

// The limit of a body that anyone may send: it holds one word.
constexpr std::uint64_t kOpenBytes = 1024;

std::optional<Problem> check_query(const Request& request, const Route& route) {
  if (request.query.empty()) return std::nullopt;
  const std::vector<std::string> known = words_of(route.query);
  std::vector<RequestFault> faults;
  for (const auto& [name, value] : request.query) {
    if (std::find(known.begin(), known.end(), name) != known.end()) {
      if (value.empty()) faults.push_back({"?" + name, "empty", "must have a value"});
      continue;
    }
    const std::string near = nearest_word(name, known);
    faults.push_back({"?" + name.substr(0, 64), "unknown_member",
                      near.empty() ? "is unknown here" : fmt::format("did you mean {}?", near)});
  }
  if (faults.empty()) return std::nullopt;
  return validation(std::move(faults));
}

std::optional<Problem> check_match(const Request& request, const Route& route) {
  const bool has_match = request.header("if-match").has_value();
  switch (route.match) {
    case MatchRule::None:
    case MatchRule::Allowed:
      return std::nullopt;
    case MatchRule::Required:
      if (has_match) return std::nullopt;
      return Problem{ProblemKind::PreconditionRequired, "send If-Match with the ETag you read"};
    case MatchRule::OrAny:
      if (has_match) return std::nullopt;
      return Problem{ProblemKind::PreconditionRequired,
                     "send If-Match with the ETag you read, or 'If-Match: *'"};
    case MatchRule::OrNew:
      const bool is_new = request.header("if-none-match") == "*";
      if (has_match != is_new) return std::nullopt;
      return Problem{ProblemKind::PreconditionRequired,
                     "send If-Match with the ETag you read, or 'If-None-Match: *' to create"};
  }
  return std::nullopt;
}

std::optional<Problem> check_key(const Request& request, const Route& route) {
  const auto key = request.header("idempotency-key");
  if (!key) {
    if (route.key != KeyRule::Required) return std::nullopt;
    return Problem{ProblemKind::IdempotencyKeyMissing,
                   fmt::format("send an Idempotency-Key of {} to {} characters; use the same key "
                               "when you repeat the request",
                               kLeastKeyCharacters, kMostKeyCharacters)};
  }
  if (is_key(*key)) return std::nullopt;
  return Problem{ProblemKind::IdempotencyKeyMissing,
                 fmt::format("Idempotency-Key must be {} to {} visible ASCII characters",
                             kLeastKeyCharacters, kMostKeyCharacters)};
}

Response unless_seen(Response response, const Request& request) {
  if (response.status != 200) return response;
  std::string etag;
  for (const Header& header : response.headers) {
    if (header.name == "ETag") etag = header.value;
  }
  if (etag.empty() || !has_seen(request, etag)) return response;
  // A browser replaces the headers that it kept with these, so they include its policy.
  Response same;
  same.status = 304;
  same.content_type.clear();
  for (const Header& kept : response.headers)
    if (!kept.name.starts_with("Content-") || kept.name == "Content-Security-Policy")
      same.headers.push_back(kept);
  return same;
}

bool is_read(const Request& request) {
  return request.method == Method::Get || request.method == Method::Head;
}

}  // namespace

std::optional<Problem> check_request(const Request& request, const Route& route) {
  if (auto fault = check_query(request, route)) return fault;
  if (auto fault = check_match(request, route)) return fault;
  return check_key(request, route);
}

std::optional<Problem> check_stream(const Request& request, const Route& route) {
  if (auto wrong = check_request(request, route)) return wrong;
  QueryReader query(request);
  static_cast<void>(query.whole("after"));
  static_cast<void>(query.whole("limit"));
  return query.problem();
}

std::span<const std::string_view> upload_types(BodyRule body) {
  if (body == BodyRule::Design) return kDesignTypes;
  if (body == BodyRule::Asset) return kAssetTypes;
  return {};
}

std::optional<Problem> check_body(const Route& route, std::string_view media_type, bool has_body) {
  if (route.body == BodyRule::None) {
    if (!has_body) return std::nullopt;
    return Problem{ProblemKind::BadRequest, "this request must not have a body"};
  }
  if (route.body == BodyRule::Json) {
    if (!has_body || media_type == "application/json") return std::nullopt;
    return Problem{ProblemKind::UnsupportedMedia,
                   "send the body as Content-Type: application/json"};
  }
  const std::span<const std::string_view> types = upload_types(route.body);
  if (std::find(types.begin(), types.end(), media_type) != types.end()) return std::nullopt;
  return Problem{
      ProblemKind::UnsupportedMedia,
      fmt::format("the media type of {} must be one of {}; send the file's bytes, not a form",
                  route.body == BodyRule::Design ? "a design" : "an asset",
                  fmt::join(types, ", "))};
}

std::uint64_t most_bytes(const Route& route, const HttpLimits& limits) {
  switch (route.body) {
    case BodyRule::None:
      return 0;
    case BodyRule::Json:
      return route.access.is_open() ? std::min(limits.json_bytes, kOpenBytes) : limits.json_bytes;
    case BodyRule::Design:
      return limits.design_bytes;
    case BodyRule::Asset:
      return limits.asset_bytes;
  }
  return 0;
}

bool wants_stream(const Request& request) {
  const std::string_view accept = request.header("accept").value_or("*/*");
  if (accept.find("text/event-stream") != std::string_view::npos) return true;
  return request.query.empty() && accept.find("*/*") != std::string_view::npos &&
         accept.find("json") == std::string_view::npos;
}

void dispatch(const Request& request, const Route& route, Service& service,
              const HandlerContext& context, const Reply& reply) {
  try {
    name_turn(name_of(route.method), route.path);
    Reply answer = reply;
    if (const auto seen = request.header("if-none-match"); seen && is_read(request)) {
      Request asked;
      asked.headers.push_back({"if-none-match", std::string(*seen)});
      answer = Reply([reply, asked = std::move(asked)](Response response) {
        reply(unless_seen(std::move(response), asked));
      });
    }
    if (const auto fault = check_request(request, route))
      return answer(problem_response(*fault, request));
    route.handler(request, service, context, answer);
  } catch (const std::bad_alloc&) {
    reply(problem_response(
        Problem{ProblemKind::Unavailable, "popcutd is out of memory; try again later"}, request));
  } catch (const std::exception& e) {
    if (context.log_fault)
      context.log_fault(fmt::format("http {} {} {}: {}", request.id, name_of(request.method),
                                    for_log(request.path()), for_log(e.what())));
    reply(problem_response(
        Problem{ProblemKind::Internal, "popcutd failed; its log has details under this request id"},
        request));
  }
}

}  // namespace popcut::daemon::http
