// SPDX-License-Identifier: MIT
#include "daemon/popcutd/sheet_program.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "daemon/planning/program_file.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {

Result<EncodedProgram> stored_program(const std::string& folder, int sheet) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
  const std::string stem = fmt::format("{}/sheet-{:02}", folder, sheet);
  const auto index = read_whole(stem + ".program.json", kMostBytes);
  if (!index) return tl::unexpected(index.error());
  std::error_code ignored;
  const bool hpgl = std::filesystem::exists(stem + ".hpgl", ignored);
  auto bytes = read_whole(stem + (hpgl ? ".hpgl" : ".gpgl"), kMostBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return planning::read_program(*index, std::move(*bytes));
}

}  // namespace popcut::daemon
