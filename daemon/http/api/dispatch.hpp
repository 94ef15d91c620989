// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "daemon/http/api/routes.hpp"

namespace popcut::daemon::http {

/// What is wrong with a request before its handler sees it: names in the query that the route does
/// not have, If-Match or Idempotency-Key that are missing or malformed.
[[nodiscard]] std::optional<Problem> check_request(const Request& request, const Route& route);

/// The same of a request for a stream, which no handler sees.
[[nodiscard]] std::optional<Problem> check_stream(const Request& request, const Route& route);

/// The media types of an upload; none for another body.
[[nodiscard]] std::span<const std::string_view> upload_types(BodyRule body);

/// Nothing if a body of `media_type` may come to `route`.
[[nodiscard]] std::optional<Problem> check_body(const Route& route, std::string_view media_type,
                                                bool has_body);

/// The most bytes that a body of `route` may have.
[[nodiscard]] std::uint64_t most_bytes(const Route& route, const HttpLimits& limits);

/// True if a request to a route that can stream asks for events as they come.
[[nodiscard]] bool wants_stream(const Request& request);

/// Checks, calls the handler, answers 304 where the client has it already. What a handler throws
/// becomes a problem. On the service's thread.
void dispatch(const Request& request, const Route& route, Service& service,
              const HandlerContext& context, const Reply& reply);

}  // namespace popcut::daemon::http
