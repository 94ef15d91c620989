// SPDX-License-Identifier: MIT
#include "daemon/store/sliced_copy.hpp"

#include <utility>

#include <fmt/format.h>
#include <sqlite3.h>

namespace popcut::daemon {
namespace {

[[noreturn]] void give_up(int code, const std::string& words) {
  const int kind = code & 0xFF;
  throw StoreFault(kind == SQLITE_FULL                               ? FaultKind::Full
                   : kind == SQLITE_CORRUPT || kind == SQLITE_NOTADB ? FaultKind::Corrupt
                                                                     : FaultKind::Other,
                   fmt::format("the database cannot be copied: {}", words));
}

}  // namespace

SlicedCopy::SlicedCopy(SqliteDatabase& from, const std::string& path) {
  const int opened =
      sqlite3_open_v2(path.c_str(), &to_,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  if (opened == SQLITE_OK) {
    // It is synced once, as a whole, by whoever keeps it.
    sqlite3_exec(to_, "PRAGMA synchronous=OFF; PRAGMA journal_mode=OFF", nullptr, nullptr, nullptr);
    backup_ = sqlite3_backup_init(to_, "main", from.db_, "main");
  }
  if (backup_ != nullptr) return;
  const int code = to_ != nullptr ? sqlite3_errcode(to_) : opened;
  const std::string words = to_ != nullptr ? sqlite3_errmsg(to_) : sqlite3_errstr(opened);
  close();
  give_up(code, words);
}

SlicedCopy::~SlicedCopy() { close(); }

bool SlicedCopy::step(int pages) {
  const int code = sqlite3_backup_step(backup_, pages);
  if (code == SQLITE_OK) return false;
  if (code != SQLITE_DONE) give_up(code, sqlite3_errstr(code));
  close();
  return true;
}

void SlicedCopy::close() {
  if (backup_ != nullptr) sqlite3_backup_finish(std::exchange(backup_, nullptr));
  if (to_ != nullptr) sqlite3_close_v2(std::exchange(to_, nullptr));
}

void finish_copy(const std::string& path) {
  SqliteDatabase copy({.path = path, .create = false});
  copy.checkpoint(true);
}

std::string verdict_on_copy(const std::string& path) {
  SqliteDatabase copy({.path = path, .create = false});
  std::string verdict;
  for (const char* check : {"PRAGMA integrity_check(20)", "PRAGMA foreign_key_check"}) {
    Rows rows = copy.rows(check);
    while (rows.next())
      if (const std::string line = rows.text(0); line != "ok") verdict += line + "\n";
  }
  return verdict.empty() ? std::string("ok") : verdict;
}

}  // namespace popcut::daemon
