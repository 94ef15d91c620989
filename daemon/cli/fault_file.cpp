// SPDX-License-Identifier: MIT
#include "daemon/cli/fault_file.hpp"

#include <fmt/format.h>

#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

Result<std::vector<SimFault>> read_faults(const std::string& file) {
  constexpr std::uintmax_t kLimitBytes = 1u << 24;
  const auto text = read_file(file, kLimitBytes);
  if (!text) return tl::unexpected(text.error());
  auto faults = parse_faults(*text);
  if (!faults) return tl::unexpected(within(file, faults.error()));
  return faults;
}

Result<std::vector<SimFault>> read_faults(const std::string& file, const CutTarget& target) {
  if (target.simulated()) return read_faults(file);
  return fail(ErrorKind::Usage, "--faults",
              fmt::format("works with simulated devices only, and {} is none; leave it out",
                          target.device.text));
}

}  // namespace popcut::cli
