// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"

namespace popcut::cli {

/// A job for popcutd.
struct QueueRequest {
  std::string input, device, material, name;
  std::map<std::string, std::string> options{};  ///< of the plan, as typed, without dashes
  int copies{1}, priority{0};
  bool wait{false};
  std::string site{};
};

/// `popcut cut` without --direct: uploads what the input needs and the input, queues the job,
/// prints its id on standard output, and with `wait` follows it until it ends.
///
/// @retval Malformed, OutOfRange  the input; found here or by popcutd
/// @retval DeviceGone, Refused    popcutd is absent or refuses, or the job did not finish
[[nodiscard]] Result<void> queue_cut(const QueueRequest& request, const Globals& globals);

/// `popcut cut --test` without --direct: the material's small test shape as a job for one device,
/// which waits for 'popcut arm' and 'popcut start' like any other. Default device: the only one.
///
/// @retval Usage  there are several
[[nodiscard]] Result<void> queue_test_cut(const QueueRequest& request, const Globals& globals);

}  // namespace popcut::cli
