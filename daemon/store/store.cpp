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
#include "daemon/store/integrity.hpp"
#include "daemon/store/salvage.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/wal_check.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kInUse = "in use\n";
constexpr std::string_view kSuspect = "in use, found damaged\n";
constexpr std::size_t kWitnessDigits = 18;

// What is wrong with the file before SQLite is let near it; empty: nothing.
std::string header_damage(const std::string& path) {
  std::array<unsigned char, 100> header{};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"),
                                                             &std::fclose);
  if (!file) return "cannot be opened";
  if (std::fread(header.data(), 1, header.size(), file.get()) != header.size())
    return "is too short for a database";
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  if (!std::equal(kMagic.begin(), kMagic.end(), header.begin())) return "is not an SQLite database";
  if (header[18] != 2 || header[19] != 2) return "is not in write-ahead mode";
  const unsigned id = static_cast<unsigned>(header[68]) << 24 |
                      static_cast<unsigned>(header[69]) << 16 |
                      static_cast<unsigned>(header[70]) << 8 | static_cast<unsigned>(header[71]);
  return id == static_cast<unsigned>(kApplicationId) ? "" : "is not a database of popcutd";
}

// Until it has its name it is nothing: what has the name is a whole database.
void make_database(const std::string& path, const StoreOptions& options) {
  const std::string fresh = path + ".new";
  remove_tree(fresh);
  remove_tree(fresh + "-journal");
  remove_tree(fresh + "-wal");
  {
    SqliteDatabase database({.path = fresh, .vfs = options.vfs});
    build_schema(database);
    database.checkpoint(true);
  }
  // A full disk may leave a sound database that is not in the mode that was asked for.
  if (const std::string what = header_damage(fresh); !what.empty())
    throw StoreFault(FaultKind::Full, "the new database " + what + "; is the disk full?");
  remove_tree(fresh + "-wal");
  if (const Result<void> kept = keep_file(fresh, path); !kept)
    throw StoreFault(FaultKind::Io, message(kept.error()));
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
      if (store->folder_->has_moved_to_fleet())
        return fail(
            ErrorKind::Refused, "",
            fmt::format("{}: the jobs of this popcutd have moved to a fleet; give its "
                        "configuration the [fleet] that it had, or a new state folder to begin "
                        "with an empty queue ('popcut fleet import' made the copy in {})",
                        path, store->folder_->at("backups")));
      if (!mark.empty() || fs::exists(path + "-wal", ignored))
        return fail(
            ErrorKind::Malformed, "",
            fmt::format("{}: the database is missing, but it existed before; put a copy from "
                        "{} in its place with 'popcut db restore COPY --state {}', or delete "
                        "the files database-state and witness beside it to start with an "
                        "empty queue",
                        path, store->folder_->at("backups"), settings.folder));
      make_database(path, settings);
    }
    if (::access(path.c_str(), R_OK | W_OK) != 0 && errno == EACCES)
      return fail(ErrorKind::CheckFailed, "",
                  path + ": popcutd cannot read and write it; give it the owner of its " +
                      "folder: chown --reference=" + settings.folder + " " + path);
    if (std::string what = header_damage(path); !what.empty()) return damaged(what);
    const bool was_closed = mark.starts_with(kCleanMark);
    if (was_closed && mark != clean_mark(path))
      return damaged("has changed since popcutd closed it");
    // All that was ever confirmed is in the file. A log beside it is of a run that ended before it
    // could remove it, or that began, confirmed nothing, and ended: a part of it would only hide
    // newer pages of the file.
    if (was_closed && fs::exists(path + "-wal", ignored) && !fs::remove(path + "-wal", ignored))
      return fail(ErrorKind::Unwritable, "",
                  path + "-wal: cannot be removed; it belongs to popcutd, give it its folder");
    if (mark == kInUse || mark == kSuspect)
      if (std::string what = log_damage(path + "-wal"); !what.empty())
        return damaged("was not closed and its log " + what);
    auto file = std::make_unique<SqliteDatabase>(
        SqliteDatabase::Options{.path = path, .vfs = settings.vfs, .create = false});
    store->file_ = file.get();
    store->database_ = std::move(file);
    const int version = schema_version(*store->database_);
    const std::string misfit = version < 1 ? "" : version_misfit(version, settings.folder);
    if (!misfit.empty()) {
      store->failed_ = true;
      return fail(ErrorKind::OutOfRange, "", fmt::format("{}: {}", path, misfit));
    }
    store->checked_ = was_closed;
    if (!was_closed && (!settings.check_later || mark != kInUse)) {
      if (std::string what = damage_in(*store->database_); !what.empty())
        return damaged("is damaged: " + what);
      store->file_->forget_pages();
      store->checked_ = true;
    }
    if (version < 1) return damaged("has no version");
    const std::int64_t known = store->database_->number("SELECT max(seq) FROM event");
    if (known < store->witnessed())
      return damaged(
          fmt::format("has lost changes: it ends with event {}, but event {} existed (if you put "
                      "an older copy there yourself, 'popcut db restore COPY --older --state {}' "
                      "goes back to it)",
                      known, store->witnessed(), store->folder_->path()));
    store->folder_->take_reserve(settings.reserve_bytes);
    return store;
  } catch (const StoreFault& fault) {
    if (fault.kind() == FaultKind::Corrupt || fault.kind() == FaultKind::Constraint)
      return damaged(fmt::format("is damaged: {}", fault.what()));
    store->failed_ = true;
    return fail(ErrorKind::Unwritable, "", fmt::format("{}: {}", path, fault.what()));
  }
}

Result<std::unique_ptr<Store>> Store::over(StoreOptions options, std::unique_ptr<Database> shared) {
  auto folder = StateFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  std::unique_ptr<Store> store(new Store(std::move(options), std::move(*folder)));
  store->database_ = std::move(shared);
  store->checked_ = true;
  store->folder_->take_reserve(store->options_.reserve_bytes);
  return store;
}

std::string Store::set_aside_as(const std::string& what) const {
  const std::string path = folder_->at("popcut.db");
  const Result<std::string> copy = set_aside(path, folder_->at("backups"));
  const std::string kept = copy ? "a copy was saved as " + *copy
                                : "no copy could be saved (" + message(copy.error()) + ")";
  // Who has a whole database must not go back to an older one.
  try {
    const Integrity found = integrity_of(path, folder_->at("incoming/looked-at"));
    if (found.damage.empty() && found.last_event >= witnessed())
      return fmt::format(
          "{}: the database {}; all of it can be read ({} jobs, the last event is {}); 'popcut db "
          "salvage --state {}' goes on with it; {}, and the original is unchanged",
          path, what, found.jobs, found.last_event, options_.folder, kept);
  } catch (const StoreFault&) {  // cannot be read
  }
  return fmt::format(
      "{0}: the database {1}; {2}, and the original is unchanged; 'popcut db salvage --state {3}' "
      "saves what can be read, or put a copy from {4} in its place with 'popcut db restore COPY "
      "--state {3}'",
      path, what, kept, options_.folder, folder_->at("backups"));
}

std::optional<std::string> Store::damage_of_copy() const {
  try {
    const Integrity found =
        integrity_of(folder_->at("popcut.db"), folder_->at("incoming/looked-at"));
    return found.damage.empty() ? "" : "is damaged: " + found.damage;
  } catch (const StoreFault&) {
    return std::nullopt;
  }
}

std::string Store::damage_in_place() {
  const std::string damage = damage_in(*file_);
  file_->forget_pages();
  return damage.empty() ? "" : "is damaged: " + damage;
}

void Store::mark_suspect() const {
  if (file_ == nullptr) return;
  // Best effort: without it the next run serves until it has found the damage again.
  (void)write_file(folder_->at("database-state"), kSuspect);
}

std::int64_t Store::witnessed() const {
  const std::string text = read_whole(folder_->at("witness"), 100).value_or("");
  const bool whole = text.size() == kWitnessDigits + 1 && text.back() == '\n' &&
                     text.find_first_not_of("0123456789") == kWitnessDigits;
  return whole ? std::stoll(text) : 0;
}

void Store::bear_witness(std::int64_t event) {
  if (file_ == nullptr) return;
  if (witness_ < 0)
    witness_ =
        ::open(folder_->at("witness").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  const std::string text = fmt::format("{:0{}}\n", event, kWitnessDigits);
  // Best effort: without it less damage is noticed, and nothing else is lost.
  if (witness_ >= 0) (void)(pwrite(witness_, text.data(), text.size(), 0) < 0);
}

void Store::mark_in_use() {
  if (file_ == nullptr) return;
  // With nothing in it yet the log would be taken for one that was cut short.
  if (file_->wal_pages() == 0)
    database_->script(fmt::format("PRAGMA user_version={}", kSchemaVersion));
  if (const Result<void> done = write_file(folder_->at("database-state"), kInUse); !done)
    throw StoreFault(FaultKind::Io, message(done.error()));
  in_use_ = true;
}

// At each step the next start finds a whole database: until the mark is there, all of the log is;
// from then on all is in the file, each byte of it is known, and the log is of no use.
Store::~Store() {
  if (witness_ >= 0) close(witness_);
  if (file_ == nullptr || failed_ || !checked_) return;
  try {
    const std::string path = folder_->at("popcut.db");
    if (!in_use_ && file_->wal_pages() > 0) mark_in_use();
    const bool moved = file_->checkpoint(false);
    database_.reset();
    if (!moved || !folder_->is_in_place()) return;
    const std::string mark = clean_mark(path);
    if (!mark.empty() && write_file(folder_->at("database-state"), mark))
      remove_tree(path + "-wal");
  } catch (const StoreFault&) {
    // The log stays and is read at the next opening.
  }
}

std::string back_up(Database& database, const StateFolder& folder, const std::string& name) {
  std::string path = folder.at("backups/" + name);
  const std::string fresh = folder.at("backups/.new-" + name);
  remove_tree(fresh);
  database.run("VACUUM INTO ?", fresh);
  {
    // In the mode in which popcutd keeps it, so that it can be put in the database's place.
    SqliteDatabase copy({.path = fresh, .create = false});
    copy.checkpoint(true);
  }
  remove_tree(fresh + "-wal");
  if (const Result<void> kept = keep_file(fresh, path); !kept)
    throw StoreFault(FaultKind::Io, message(kept.error()));
  return path;
}

}  // namespace popcut::daemon
