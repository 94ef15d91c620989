// SPDX-License-Identifier: MIT
// Must not compile: a route that does not say who may use it.
#include "daemon/http/api/handlers.hpp"

namespace popcut::daemon::http {

#ifdef POPCUT_WITH_ROLE
constexpr Route kRoute{.method = Method::Get,
                       .path = "/v1/open",
                       .access = RouteAccess(Role::Viewer),
                       .handler = handle::list_jobs};
#else
constexpr Route kRoute{.method = Method::Get, .path = "/v1/open", .handler = handle::list_jobs};
#endif

const Route* route() { return &kRoute; }

}  // namespace popcut::daemon::http
