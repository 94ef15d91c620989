// SPDX-License-Identifier: MIT
#include "daemon/http/http_metrics.hpp"

#include <fmt/format.h>

namespace popcut::daemon::http {

std::string HttpMetrics::text(std::string_view build, int connections) const {
  std::string out = "# TYPE popcut_http_requests counter\n";
  for (const auto& [key, count] : requests_)
    out += fmt::format("popcut_http_requests_total{{route=\"{}\",code=\"{}\"}} {}\n", key.first,
                       key.second, count);
  out += "# TYPE popcut_http_rejected counter\n";
  for (const auto& [why, count] : rejected_)
    out += fmt::format("popcut_http_rejected_total{{why=\"{}\"}} {}\n", why, count);
  out += fmt::format(
      "# TYPE popcut_http_connections gauge\npopcut_http_connections {}\n"
      "# TYPE popcut_sse_clients gauge\npopcut_sse_clients {}\n"
      "# TYPE popcut_sse_dropped counter\npopcut_sse_dropped_total {}\n"
      "# TYPE popcut_build info\npopcut_build_info{{version=\"{}\"}} 1\n",
      connections, streams_, dropped_, build);
  return out;
}

}  // namespace popcut::daemon::http
