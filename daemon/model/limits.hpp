// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace popcut::daemon {

/// File descriptors that clients leave to cuts, plans and the database, whatever `connections`.
inline constexpr int kDescriptorsLeft = 40;

/// What one client may take of the daemon. Every member is a line `limits.NAME` of the
/// configuration; a test holds the defaults against the documentation.
struct HttpLimits {
  std::size_t header_bytes{8 << 10};
  std::size_t json_bytes{256 << 10};
  int json_depth{32};
  std::uint64_t design_bytes{std::uint64_t{32} << 20};
  std::uint64_t asset_bytes{std::uint64_t{256} << 20};
  int connections{64};
  int reserved_connections{4};  ///< more, that serve nothing but what stops a knife
  int streams{16};              ///< clients of /v1/events at once, part of `connections`
  int uploads{8};               ///< bodies that are being written to disk at once
  double rate_per_s{20};        ///< requests of one principal in the long run
  double rate_burst{60};
  double previews_per_s{30};  ///< of one principal, apart from `rate_per_s`; twice that at once
  double pictures_per_s{60};  ///< the same, of pictures of designs; ten times that at once
  int failed_logins_per_minute{5};
  double header_s{10};
  double body_s{30};  ///< and from then on at least `body_bytes_per_s`, over each `body_s` again
  double body_bytes_per_s{1024};
  double upload_s{1800};  ///< the longest that a body may take, however it comes
  double idle_s{60};
  double answer_s{30};          ///< how long a handler may take
  double design_answer_s{900};  ///< and one that waits for a design to be read
  double heartbeat_s{15};
  /// Of large answers (from 1 MiB) that are in memory while clients read them; half of it for one
  /// principal.
  std::size_t answer_bytes{std::size_t{512} << 20};
  std::size_t stream_events{256};
  std::size_t stream_bytes{256 << 10};
};

}  // namespace popcut::daemon
