// SPDX-License-Identifier: MIT
#include "daemon/store/integrity.hpp"

#include <filesystem>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "daemon/digest/digest.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

// A folder that goes with this object, and what is in it.
class Scratch {
 public:
  explicit Scratch(std::string path) : path_(std::move(path)) {
    remove_tree(path_);
    std::error_code error;
    if (!fs::create_directory(path_, error)) throw_of(path_, error);
  }
  ~Scratch() { remove_tree(path_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  /// Copies a file into it; gives the copy's path.
  [[nodiscard]] std::string take(const std::string& file) const {
    std::string to = path_ + "/" + fs::path(file).filename().string();
    if (const std::error_code error = copy_new(file, to)) throw_of(file, error);
    return to;
  }

 private:
  [[noreturn]] static void throw_of(const std::string& path, const std::error_code& error) {
    throw StoreFault(error == std::errc::no_space_on_device ? FaultKind::Full : FaultKind::Io,
                     fmt::format("{}: cannot be copied to be checked: {}", path, error.message()));
  }
  std::string path_;
};

}  // namespace

std::string damage_in(Database& database) {
  Rows verdict = database.rows("PRAGMA integrity_check(1)");
  if (!verdict.next()) return "its check gives no result";
  return verdict.text(0) == "ok" ? "" : verdict.text(0);
}

std::string clean_mark(const std::string& database) {
  const Result<std::string> digest = sha256_of_file(database);
  return digest ? fmt::format("{}{}\n", kCleanMark, *digest) : "";
}

Integrity integrity_of(const std::string& database, const std::string& scratch) {
  const Scratch folder(scratch);
  const std::string copy = folder.take(database);
  std::error_code ignored;
  if (fs::exists(database + "-wal", ignored)) (void)folder.take(database + "-wal");
  Integrity found;
  try {
    SqliteDatabase opened({.path = copy, .create = false, .exclusive_wal = false});
    found.damage = damage_in(opened);
    found.application = opened.number("PRAGMA application_id");
    found.version = schema_version(opened);
    found.jobs = opened.number("SELECT count(*) FROM job");
    found.last_event = opened.number("SELECT max(seq) FROM event");
  } catch (const StoreFault& fault) {
    if (fault.kind() == FaultKind::Full || fault.kind() == FaultKind::Io) throw;
    if (found.damage.empty()) found.damage = fault.what();
  }
  return found;
}

}  // namespace popcut::daemon
