// SPDX-License-Identifier: MIT
#include "daemon/store/store.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "daemon/digest/digest.hpp"
#include "daemon/store/salvage.hpp"
#include "daemon/store/wal_check.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kClean = "clean ";  // and the digest of the database
constexpr std::string_view kInUse = "in use\n";
constexpr std::size_t kWitnessDigits = 18;

int version_of(Database& database) {
  return static_cast<int>(database.number("PRAGMA user_version"));
}

// Until it has its name it is nothing: what has the name is a whole database.
void make_database(const std::string& path, const StoreOptions& options) {
  const std::string fresh = path + ".new";
  remove_tree(fresh);
  remove_tree(fresh + "-journal");
  remove_tree(fresh + "-wal");
  {
    Database database({.path = fresh, .vfs = options.vfs});
    build_schema(database, options.steps, options.steps.back().version);
    database.checkpoint(true);
  }
  remove_tree(fresh + "-wal");
  if (const Result<void> kept = keep_file(fresh, path); !kept)
    throw StoreFault(FaultKind::Io, message(kept.error()));
}

std::string clean_mark(const std::string& path) {
  return fmt::format("{}{}\n", kClean, sha256_of_file(path).value_or("unreadable"));
}

// What is wrong with the file before SQLite is let near it; empty: nothing.
std::string header_damage(const std::string& path) {
  std::array<unsigned char, 100> header{};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"),
                                                             &std::fclose);
  if (!file) return "cannot be opened";
  if (std::fread(header.data(), 1, header.size(), file.get()) != header.size())
    return "is too short for a database";
  constexpr std::string_view magic("SQLite format 3\0", 16);
  if (!std::equal(magic.begin(), magic.end(), header.begin())) return "is not an SQLite database";
  if (header[18] != 2 || header[19] != 2) return "is not in write-ahead mode";
  const unsigned id = static_cast<unsigned>(header[68]) << 24 |
                      static_cast<unsigned>(header[69]) << 16 |
                      static_cast<unsigned>(header[70]) << 8 | static_cast<unsigned>(header[71]);
  return id == static_cast<unsigned>(kApplicationId) ? "" : "is not a database of popcutd";
}

}  // namespace

Result<std::unique_ptr<Store>> Store::open(StoreOptions options) {
  auto folder = StateFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  std::unique_ptr<Store> store(new Store(std::move(options), std::move(*folder)));
  const StoreOptions& settings = store->options_;
  const std::string path = store->folder_->at("popcut.db");
  const std::string mark = read_whole(store->folder_->at("database-state"), 100).value_or("");
  const auto damaged = [&](const std::string& what) {
    store->failed_ = true;
    return fail(ErrorKind::Malformed, "", store->set_aside_as(what));
  };
  try {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) {
      if (!mark.empty() || fs::exists(path + "-wal", ignored))
        return fail(ErrorKind::Malformed, "",
                    path +
                        ": the database is missing, but it existed before; restore a copy from " +
                        store->folder_->at("backups") +
                        ", or delete the files database-state and witness beside it to start with "
                        "an empty queue");
      make_database(path, settings);
    }
    if (::access(path.c_str(), R_OK | W_OK) != 0 && errno == EACCES)
      return fail(ErrorKind::CheckFailed, "",
                  path + ": popcutd cannot read and write it; give it the owner of its " +
                      "folder: chown --reference=" + settings.folder + " " + path);
    if (std::string what = header_damage(path); !what.empty()) return damaged(what);
    const bool was_closed = mark.starts_with(kClean);
    const bool unchanged = was_closed && mark == clean_mark(path);
    // A log beside it: a run that ended before it had marked the database as in use.
    const bool as_left = unchanged && !fs::exists(path + "-wal", ignored);
    if (was_closed && !unchanged)
      return damaged(
          "has changed since popcutd closed it (if you restored a copy, also delete the files "
          "database-state and witness beside it)");
    if (mark == kInUse)
      if (std::string what = log_damage(path + "-wal"); !what.empty())
        return damaged("was not closed and its log " + what);
    store->database_ = std::make_unique<Database>(
        Database::Options{.path = path, .vfs = settings.vfs, .create = false});
    const int version = version_of(*store->database_);
    const int newest = settings.steps.back().version;
    if (version > newest) {
      store->failed_ = true;
      return fail(
          ErrorKind::OutOfRange, "",
          fmt::format("{}: was written by a later popcutd (schema {}, this version supports up to "
                      "{}); install that version, or restore the copy that it made",
                      path, version, newest));
    }
    if (!as_left) {
      Rows verdict = store->database_->rows("PRAGMA integrity_check(1)");
      if (!verdict.next() || verdict.text(0) != "ok")
        return damaged("is damaged: " + verdict.text(0));
      store->database_->forget_pages();
    }
    if (version < 1) return damaged("has no version");
    const std::int64_t known = store->database_->number("SELECT max(seq) FROM event");
    if (known < store->witnessed())
      return damaged(
          fmt::format("has lost changes: it ends with event {}, but event {} existed (if you "
                      "restored an older copy, also delete the file {})",
                      known, store->witnessed(), store->folder_->at("witness")));
    if (version < newest) store->migrate();
    store->folder_->take_reserve(settings.reserve_bytes);
    return store;
  } catch (const StoreFault& fault) {
    if (fault.kind() == FaultKind::Corrupt || fault.kind() == FaultKind::Constraint)
      return damaged(fmt::format("is damaged: {}", fault.what()));
    store->failed_ = true;
    return fail(ErrorKind::Unwritable, "", fmt::format("{}: {}", path, fault.what()));
  }
}

std::string Store::set_aside_as(const std::string& what) {
  const std::string path = folder_->at("popcut.db");
  const Result<std::string> copy = set_aside(path, folder_->at("backups"));
  return fmt::format(
      "{}: the database {}; {}, and the original is unchanged; 'popcut db salvage' saves what can "
      "be read, or restore a copy from {}",
      path, what,
      copy ? "a copy was saved as " + *copy
           : "no copy could be saved (" + message(copy.error()) + ")",
      folder_->at("backups"));
}

std::int64_t Store::witnessed() const {
  const std::string text = read_whole(folder_->at("witness"), 100).value_or("");
  const bool whole = text.size() == kWitnessDigits + 1 && text.back() == '\n' &&
                     text.find_first_not_of("0123456789") == kWitnessDigits;
  return whole ? std::stoll(text) : 0;
}

void Store::bear_witness(std::int64_t event) {
  if (witness_ < 0)
    witness_ =
        ::open(folder_->at("witness").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  const std::string text = fmt::format("{:0{}}\n", event, kWitnessDigits);
  // Best effort: without it less damage is noticed, and nothing else is lost.
  if (witness_ >= 0) (void)!pwrite(witness_, text.data(), text.size(), 0);
}

void Store::migrate() {
  const int from = version_of(*database_);
  const int to = options_.steps.back().version;
  (void)back_up(
      *database_, *folder_,
      fmt::format("before-version-{}-{}.db", to, sha256_hex(random_bytes(8)).substr(0, 8)));
  Transaction all(*database_);
  for (const Migration& step : options_.steps)
    if (step.version > from) database_->script(std::string(step.sql));
  database_->script(fmt::format("PRAGMA user_version={}", to));
  all.commit();
}

void Store::mark_in_use() {
  if (const Result<void> done = write_file(folder_->at("database-state"), kInUse); !done)
    throw StoreFault(FaultKind::Io, message(done.error()));
}

Store::~Store() {
  if (witness_ >= 0) close(witness_);
  if (!database_ || failed_) return;
  try {
    const std::string path = folder_->at("popcut.db");
    database_->checkpoint(true);
    database_.reset();
    // Only now may the log be missing, and each byte of the database is known.
    if (write_file(folder_->at("database-state"), clean_mark(path))) remove_tree(path + "-wal");
  } catch (const StoreFault&) {
    // The log stays and is read at the next opening.
  }
}

std::string back_up(Database& database, const StateFolder& folder, const std::string& name) {
  const std::string path = folder.at("backups/" + name);
  const std::string fresh = folder.at("backups/.new-" + name);
  remove_tree(fresh);
  database.run("VACUUM INTO ?", fresh);
  {
    // In the mode in which popcutd keeps it, so that it can be put in the database's place.
    Database copy({.path = fresh, .create = false});
    copy.checkpoint(true);
  }
  remove_tree(fresh + "-wal");
  if (const Result<void> kept = keep_file(fresh, path); !kept)
    throw StoreFault(FaultKind::Io, message(kept.error()));
  return path;
}

}  // namespace popcut::daemon
