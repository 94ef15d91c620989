// SPDX-License-Identifier: MIT
#include "daemon/files/fault_file.hpp"

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

}  // namespace popcut::cli
