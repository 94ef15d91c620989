// SPDX-License-Identifier: MIT
#include "daemon/store/salvage.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/digest/digest.hpp"
#include "daemon/store/integrity.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> columns_of(Database& database, const std::string& table,
                                    const char* what) {
  return all_of(
      database.rows(fmt::format("SELECT name FROM pragma_table_info('{}') WHERE {}", table, what)),
      first_text);
}

// That of this popcutd if the damage hides it.
int version_of(Database& damaged) {
  try {
    const int version = schema_version(damaged);
    return version < 1 ? kSchemaVersion : version;
  } catch (const StoreFault&) {
    return kSchemaVersion;
  }
}

// Rows from the front up to damage, then from the back up to it: what lies before and behind.
Salvage::Table bring_over(Database& from, Database& to, const std::string& table) {
  Salvage::Table report{.name = table};
  std::vector<std::string> columns = columns_of(to, table, "1");
  try {
    // What both have: its version does not say which columns a database really has.
    const std::vector<std::string> known = columns_of(from, table, "1");
    std::erase_if(columns, [&](const std::string& column) {
      return std::find(known.begin(), known.end(), column) == known.end();
    });
  } catch (const StoreFault&) {
    columns.clear();
  }
  if (columns.empty()) {
    report.whole = version_of(from) < kSchemaVersion;
    return report;
  }
  const std::vector<std::string> keys = columns_of(to, table, "pk > 0 ORDER BY pk");
  const std::string names = fmt::format("{}", fmt::join(columns, ","));
  const std::string insert =
      fmt::format("INSERT OR IGNORE INTO {}({}) VALUES({})", table, names,
                  fmt::join(std::vector<std::string_view>(columns.size(), "?"), ","));
  for (const char* direction : {"ASC", "DESC"}) {
    try {
      Rows rows =
          from.rows(fmt::format("SELECT {} FROM {} ORDER BY {} {}", names, table,
                                fmt::join(keys, fmt::format(" {},", direction)), direction));
      while (rows.next()) {
        std::vector<Bound> values;
        for (std::size_t i = 0; i < columns.size(); ++i)
          values.push_back(rows.value(static_cast<int>(i)));
        try {
          report.rows += to.run_list(insert, values);
        } catch (const StoreFault& fault) {
          if (fault.kind() != FaultKind::Constraint && fault.kind() != FaultKind::Other) throw;
          ++report.refused;
        }
      }
      return report;
    } catch (const StoreFault& fault) {
      if (fault.kind() == FaultKind::Full) throw;
      report.whole = false;
    }
  }
  return report;
}

std::vector<Salvage::Table> bring_all(SqliteDatabase& from, SqliteDatabase& to) {
  std::vector<Salvage::Table> tables;
  Transaction all(to);
  for (const std::string_view name : table_names())
    tables.push_back(bring_over(from, to, std::string(name)));
  all.commit();
  to.checkpoint(true);
  return tables;
}

tl::unexpected<Error> unreadable(const StateFolder& folder) {
  return fail(
      ErrorKind::Malformed, "",
      fmt::format("{}: nothing can be read from it; put a copy from {} in its place with "
                  "'popcut db restore COPY --state {}', or, if there is no copy, delete the "
                  "files popcut.db, popcut.db-wal, database-state and witness to start "
                  "with an empty queue",
                  folder.at("popcut.db"), folder.at("backups"), folder.path()));
}

}  // namespace

void give_to_owner(const std::string& folder) {
  struct stat top {};
  if (::geteuid() != 0 || ::stat(folder.c_str(), &top) != 0 || top.st_uid == 0) return;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    struct stat one {};
    if (::lstat(at->path().c_str(), &one) != 0 || one.st_uid != 0) continue;
    // A second name may be of a file that lies elsewhere.
    if (S_ISDIR(one.st_mode) || (S_ISREG(one.st_mode) && one.st_nlink == 1))
      (void)(::lchown(at->path().c_str(), top.st_uid, top.st_gid) == 0);
  }
}

Result<std::string> set_aside(const std::string& database, const std::string& backups) {
  std::string digests;
  for (const char* suffix : {"", "-wal"})
    if (fs::exists(database + suffix))
      digests += sha256_of_file(database + suffix).value_or("unreadable");
  const fs::path place = fs::path(backups) / ("damaged-" + sha256_hex(digests).substr(0, 16));
  std::error_code error;
  if (fs::exists(place, error)) return place.string();
  const fs::path fresh = fs::path(backups) / (".new-" + place.filename().string());
  remove_tree(fresh.string());
  fs::create_directory(fresh, error);
  for (const char* suffix : {"", "-wal"}) {
    if (error || !fs::exists(database + suffix)) continue;
    const fs::path copy = fresh / (fs::path(database).filename().string() + suffix);
    error = copy_new(database + suffix, copy.string());
    if (!error) (void)keep_file(copy.string(), copy.string());
  }
  if (!error) fs::rename(fresh, place, error);
  if (!error) return place.string();
  remove_tree(fresh.string());
  return fail(ErrorKind::Unwritable, place.string(), "cannot be written: " + error.message());
}

Result<void> put_in_place(const StateFolder& folder, const std::string& fresh) {
  const std::string original = folder.at("popcut.db");
  remove_tree(fresh + "-wal");
  // From the mark on popcutd takes no other database than the new one, and from the new one's name
  // on it does not read the old log. Until then it refuses, and this can be done again.
  const std::string mark = clean_mark(fresh);
  Result<void> done = mark.empty() ? fail(ErrorKind::Unwritable, fresh, "cannot be read")
                                   : write_file(folder.at("database-state"), mark);
  if (done) remove_tree(folder.at("witness"));
  if (done) done = keep_file(fresh, original);
  if (done) remove_tree(original + "-wal");
  give_to_owner(folder.path());
  return done;
}

Result<Salvage> salvage(const std::string& path) {
  auto folder = StateFolder::open(path);
  if (!folder) return tl::unexpected(folder.error());
  const std::string original = (*folder)->at("popcut.db");
  const std::string fresh = original + ".salvaged";
  std::error_code error;
  if (!fs::exists(original, error))
    return fail(ErrorKind::Unwritable, "",
                original + ": does not exist; there is nothing to salvage");
  const Result<std::string> aside = set_aside(original, (*folder)->at("backups"));
  if (!aside) return fail(ErrorKind::Unwritable, "", message(aside.error()));
  Salvage report{.tables = {}, .original = *aside};
  // Reading writes a log's index beside the file, so a copy of the copy is read.
  const std::string reading = (*folder)->at("incoming/salvage");
  try {
    fs::copy(*aside, reading, fs::copy_options::recursive);
    for (const char* suffix : {"", "-wal", "-journal"}) remove_tree(fresh + suffix);
    SqliteDatabase from({.path = reading + "/popcut.db", .create = false, .exclusive_wal = false});
    SqliteDatabase to({.path = fresh});
    if (const int version = version_of(from); version < kOldestSalvaged || version > kSchemaVersion)
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("{}: {}", original, version_misfit(version, "")));
    build_schema(to);
    report.tables = bring_all(from, to);
  } catch (const StoreFault& fault) {
    if (fault.kind() == FaultKind::Corrupt) return unreadable(**folder);
    return fail(ErrorKind::Unwritable, "", fmt::format("{}: {}", original, fault.what()));
  } catch (const fs::filesystem_error& fault) {
    return fail(ErrorKind::Unwritable, "", fault.what());
  }
  remove_tree(reading);
  const bool nothing = std::all_of(report.tables.begin(), report.tables.end(),
                                   [](const auto& table) { return table.rows == 0; });
  if (nothing) {
    remove_tree(fresh);
    remove_tree(fresh + "-wal");
    return unreadable(**folder);
  }
  if (const Result<void> done = put_in_place(**folder, fresh); !done)
    return fail(ErrorKind::Unwritable, "", message(done.error()));
  return report;
}

}  // namespace popcut::daemon
