// SPDX-License-Identifier: MIT
#include "daemon/files/user_tables.hpp"

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> folders() {
  std::vector<fs::path> found{"/etc/popcut"};
  const char* const config = std::getenv("XDG_CONFIG_HOME");
  const char* const home = std::getenv("HOME");
  if (config != nullptr && *config == '/')
    found.push_back(fs::path(config) / "popcut");
  else if (home != nullptr && *home == '/')
    found.push_back(fs::path(home) / ".config" / "popcut");
  return found;
}

}  // namespace

Error UserTables::with_file(Error error) const {
  for (std::size_t i = files.size(); i-- > 0;) {
    const std::string table = fmt::format("table {}", i + 1);
    if (error.place.rfind(table, 0) != 0) continue;
    error.place.replace(0, table.size(), files[i]);
    break;
  }
  return error;
}

Error UserTables::with_file(Error error, const char* option) const {
  error = with_file(std::move(error));
  return error.place.empty() ? Error{ErrorKind::Usage, option, error.detail} : error;
}

Result<UserTables> read_user_tables() {
  constexpr std::uintmax_t kTableLimitBytes = 4u << 20;
  UserTables tables;
  for (const fs::path& folder : folders())
    for (const char* name : {"machines.json", "materials.json", "svg_profiles.json"}) {
      std::error_code ignored;
      const fs::path file = folder / name;
      if (!fs::exists(file, ignored)) continue;
      auto text = read_file(file, kTableLimitBytes);
      if (!text) return tl::unexpected(text.error());
      tables.texts.push_back(std::move(*text));
      tables.files.push_back(file.string());
    }
  return tables;
}

Result<std::vector<SimFault>> read_faults(const std::string& file) {
  constexpr std::uintmax_t kLimitBytes = 1u << 24;
  if (file.empty()) return std::vector<SimFault>{};
  const auto text = read_file(file, kLimitBytes);
  if (!text) return tl::unexpected(text.error());
  auto faults = parse_faults(*text);
  if (!faults) return tl::unexpected(within(file, faults.error()));
  return faults;
}

}  // namespace popcut::cli
