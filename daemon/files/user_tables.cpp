// SPDX-License-Identifier: MIT
#include "daemon/files/user_tables.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "daemon/files/held_folder.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kTableLimitBytes = 4u << 20;

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

Result<void> write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t wrote = ::write(file, text.data(), text.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0) return fail(ErrorKind::Unwritable, "", std::strerror(errno));
    text.remove_prefix(static_cast<std::size_t>(wrote));
  }
  if (::fsync(file) != 0) return fail(ErrorKind::Unwritable, "", std::strerror(errno));
  return {};
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
  UserTables tables;
  for (const fs::path& folder : folders())
    for (const char* name :
         {"machines.json", "materials.json", "svg_profiles.json", "hands.json"}) {
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

Result<hands::Hands> own_hands() {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  auto hands = hands::hands_of(tables->texts);
  if (!hands) return tl::unexpected(tables->with_file(hands.error()));
  return hands;
}

Result<OwnTable> own_table(const char* name) {
  const std::vector<fs::path> found = folders();
  if (found.size() < 2)
    return fail(ErrorKind::Unwritable, "$HOME", "is not set; set it to your home folder");
  const fs::path file = found.back() / name;
  std::error_code ignored;
  OwnTable table{file.string(), ""};
  if (!fs::exists(file, ignored)) return table;
  auto text = read_file(file, kTableLimitBytes);
  if (!text) return tl::unexpected(text.error());
  table.text = std::move(*text);
  return table;
}

Result<void> write_own_table(const char* table_name, const std::string& text) {
  const auto table = own_table(table_name);
  if (!table) return tl::unexpected(table.error());
  std::error_code error;
  fs::create_directories(fs::path(table->file).parent_path(), error);
  // Who keeps the table elsewhere and links to it here keeps that link.
  const fs::path real = fs::weakly_canonical(table->file, error);
  const auto failed = [&](const std::string& why) {
    return fail(ErrorKind::Unwritable, table->file, "cannot be written: " + why);
  };
  std::string name;
  const auto folder = HeldFolder::around(real.string(), name);
  if (!folder) return tl::unexpected(folder.error());
  const std::string aside = "." + name + ".new";
  const int file = folder->create_again(aside);
  if (file < 0) return failed(std::strerror(errno));
  const Result<void> written = write_all(file, text);
  ::close(file);
  if (written && folder->rename(aside, name) == 0 && folder->sync()) return {};
  const std::string why = written ? std::strerror(errno) : written.error().detail;
  folder->remove(aside);
  return failed(why);
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
