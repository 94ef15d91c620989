// SPDX-License-Identifier: MIT
#include "daemon/store/restore.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "daemon/store/salvage.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

// A database of popcutd's in the mode in which popcutd keeps it, with all that the copy holds.
void write_fresh(const StateFolder& folder, const std::string& copy, const std::string& fresh) {
  const std::string reading = folder.at("incoming/restored");
  remove_tree(reading);
  fs::create_directory(reading);
  const auto take = [&](const std::string& from, const std::string& name) {
    if (const std::error_code error = copy_new(from, reading + "/" + name))
      throw fs::filesystem_error("cannot be copied", from, error);
  };
  take(copy, "popcut.db");
  if (fs::exists(copy + "-wal")) take(copy + "-wal", "popcut.db-wal");
  for (const char* suffix : {"", "-wal", "-journal"}) remove_tree(fresh + suffix);
  {
    SqliteDatabase from({.path = reading + "/popcut.db", .create = false, .exclusive_wal = false});
    from.run("VACUUM INTO ?", fresh);
  }
  {
    SqliteDatabase to({.path = fresh, .create = false});
    to.checkpoint(true);
  }
  remove_tree(reading);
}

Result<void> is_usable(const std::string& copy, const Integrity& found) {
  if (!found.damage.empty())
    return fail(ErrorKind::Malformed, copy, "is damaged: " + found.damage + "; try another copy");
  if (found.application != kApplicationId || found.version < 1)
    return fail(ErrorKind::Malformed, copy,
                "is not a database of popcutd; copies are in the folder backups, as popcut-*.db");
  if (std::string misfit = version_misfit(found.version, ""); !misfit.empty())
    return fail(ErrorKind::OutOfRange, copy, std::move(misfit));
  return {};
}

// Nobody goes back to an older database unasked while there is a whole one.
Result<void> loses_nothing(const std::string& original, const Integrity& there,
                           const Integrity& copy) {
  if (!there.damage.empty() || there.last_event <= copy.last_event) return {};
  return fail(ErrorKind::Refused, original,
              fmt::format("is whole and knows more than the copy: {} jobs up to event {}, the copy "
                          "{} jobs up to event {}; use it as it is ('popcut db salvage' if popcutd "
                          "refuses it), or add --older to lose what came after the copy",
                          there.jobs, there.last_event, copy.jobs, copy.last_event));
}

}  // namespace

Result<Restored> restore(const std::string& path, const std::string& copy, bool older) {
  std::error_code error;
  if (!fs::is_regular_file(copy, error))
    return fail(ErrorKind::Malformed, copy, "is not a file; copies are in STATE/backups");
  auto folder = StateFolder::open(path);
  if (!folder) return tl::unexpected(folder.error());
  const std::string original = (*folder)->at("popcut.db");
  if (!older && !fs::exists(original, error) && (*folder)->has_moved_to_fleet())
    return fail(ErrorKind::Refused, original,
                "the jobs of this folder have moved to a fleet, and may be cut there; a copy knows "
                "nothing of that ('popcut db restore COPY --older' restores it all the same)");
  const std::string scratch = (*folder)->at("incoming/looked-at");
  Restored done;
  try {
    done.copy = integrity_of(copy, scratch);
    if (auto usable = is_usable(copy, done.copy); !usable) return tl::unexpected(usable.error());
    if (fs::exists(original, error)) {
      if (fs::equivalent(original, copy, error))
        return fail(ErrorKind::Refused, copy, "is the database itself; name a copy of it");
      if (!older)
        if (auto free = loses_nothing(original, integrity_of(original, scratch), done.copy); !free)
          return tl::unexpected(free.error());
      const Result<std::string> aside = set_aside(original, (*folder)->at("backups"));
      if (!aside) return tl::unexpected(aside.error());
      done.original = *aside;
    }
    const std::string fresh = original + ".restored";
    write_fresh(**folder, copy, fresh);
    if (auto placed = put_in_place(**folder, fresh); !placed) return tl::unexpected(placed.error());
  } catch (const StoreFault& fault) {
    return fail(ErrorKind::Unwritable, path, fault.what());
  } catch (const fs::filesystem_error& fault) {
    return fail(ErrorKind::Unwritable, path, fault.what());
  }
  return done;
}

}  // namespace popcut::daemon
