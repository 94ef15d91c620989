// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_import.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "daemon/digest/digest.hpp"
#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/node_lease.hpp"
#include "daemon/store/salvage.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/store.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostFile = std::uint64_t{1} << 30;
constexpr std::size_t kPart = std::size_t{1} << 20;
constexpr std::size_t kRowsAtOnce = 50;

[[noreturn]] void give_up(const std::string& sentence) {
  throw StoreFault(FaultKind::Refused, sentence);
}

// Rows that the fleet may have already, from another folder or by itself. They stay as they are.
bool is_shared(std::string_view table) {
  constexpr std::array<std::string_view, 8> kShared{
      "asset", "design", "plan_asker", "material", "device", "calendar", "search", "ownership"};
  return std::find(kShared.begin(), kShared.end(), table) != kShared.end();
}

bool is_person(std::string_view column) {
  return column == "owner" || column == "operator" || column == "principal";
}

bool is_local_user(std::string_view text) {
  constexpr std::string_view kUser = "uid:";
  return text.starts_with(kUser) && text.size() > kUser.size() &&
         text.substr(kUser.size()).find_first_not_of("0123456789") == std::string_view::npos;
}

/// Rows that go to one table in few statements.
class Batch {
 public:
  Batch(Database& to, std::string_view table, const std::vector<std::string>& columns,
        std::string_view otherwise)
      : to_(to),
        columns_(columns.size()),
        head_(fmt::format("INSERT INTO popcut.{}({}) VALUES ", table, fmt::join(columns, ", "))),
        tail_(otherwise) {}

  /// `values` may go when this returns.
  void add(const std::vector<Bound>& values) {
    for (const Bound& value : values)
      values_.push_back(value.kind() == Bound::Kind::Text ? Bound(texts_.emplace_back(value.text()))
                                                          : value);
    if (++rows_ == kRowsAtOnce) flush();
  }
  /// How many rows came in so far, after `flush`.
  [[nodiscard]] std::int64_t inserted() const { return inserted_; }
  void flush() {
    if (rows_ == 0) return;
    const std::string one =
        fmt::format("({})", fmt::join(std::vector<std::string_view>(columns_, "?"), ", "));
    inserted_ += to_.run_list(
        head_ + fmt::format("{}", fmt::join(std::vector<std::string>(rows_, one), ", ")) + tail_,
        values_);
    values_.clear();
    texts_.clear();
    rows_ = 0;
  }

 private:
  Database& to_;
  std::size_t columns_, rows_{0};
  std::string head_, tail_;
  std::vector<Bound> values_;
  std::deque<std::string> texts_;  // a deque, so that what is bound stays where it is
  std::int64_t inserted_{0};
};

class Import {
 public:
  Import(Database& from, Database& to, const StateFolder& folder, const ImportRequest& request)
      : from_(from), to_(to), folder_(folder), request_(request), user_("@" + request.node) {}

  Imported run() {
    if (const std::string misfit = schema_misfit(to_); !misfit.empty()) give_up(misfit);
    if (to_.number("SELECT count(*) FROM popcut.node WHERE name=?", request_.node) == 0)
      give_up(fmt::format("the fleet has no node {0}; type first: popcut fleet join --node {0}",
                          request_.node));
    look_at_cuts();
    look_for_ids();
    files();
    // What is left of a material that was deleted must not keep out one that is imported.
    (void)to_.run("DELETE FROM popcut.material WHERE json=''");
    for (const std::string_view table : table_names())
      if (table != "event") move_table(std::string(table));
    // Last: until the commit no other event gets a number.
    move_events();
    (void)to_.run("SELECT popcut.node_tidy()");
    (void)to_.number("SELECT pg_notify('popcut', ?)", request_.node);
    return std::move(done_);
  }

 private:
  void report(const std::string& what) const {
    if (request_.report) request_.report(what);
  }

  // Nothing is armed or cut. A start of popcutd ends both in order.
  void look_at_cuts() {
    const auto busy = first_of(
        from_.rows(
            "SELECT id, state FROM job WHERE state IN ('armed', 'cutting', 'paused') OR id IN "
            "(SELECT job FROM arm UNION SELECT job FROM attempt WHERE ended IS NULL AND "
            "started_at IS NOT NULL) ORDER BY id"),
        [](const Rows& row) { return fmt::format("job {} is {}", row.text(0), row.text(1)); });
    if (!busy) return;
    give_up(
        fmt::format("{}; start popcutd with this folder and without [fleet] once more, which ends "
                    "it in good order, stop it when it cuts nothing, and import then",
                    *busy));
  }

  void look_for_ids() {
    for (const char* table : {"job", "plan", "token"})
      for (const char* end : {"min", "max"}) {
        const std::string id =
            first_of(from_.rows(fmt::format("SELECT {}(id) FROM {}", end, table)), first_text)
                .value_or("");
        if (id.empty() ||
            to_.number(fmt::format("SELECT count(*) FROM popcut.{} WHERE id=?", table), id) == 0)
          continue;
        give_up(
            fmt::format("{} {} is in the fleet already: this folder was imported before; move {} "
                        "into {}, so that no popcutd cuts from it",
                        table, id, folder_.at("popcut.db"), folder_.at("backups")));
      }
  }

  [[nodiscard]] std::vector<std::string> columns_of(const std::string& table) const {
    return all_of(from_.rows(fmt::format("SELECT name FROM pragma_table_info('{}')", table)),
                  first_text);
  }

  void move_table(const std::string& table) {
    report(table);
    std::vector<std::string> columns = columns_of(table);
    // The fleet numbers these itself; of an empty one the numbers stay.
    const bool is_numbered = table == "audit" || table == "usage";
    const bool keeps_numbers =
        is_numbered &&
        to_.number(fmt::format("SELECT count(*) FROM (SELECT FROM popcut.{} LIMIT 1) "
                               "AS any_row",
                               table)) == 0;
    if (is_numbered && !keeps_numbers) std::erase(columns, "seq");
    Batch batch(to_, table, columns, is_shared(table) ? " ON CONFLICT DO NOTHING" : "");
    Rows rows = from_.rows(
        fmt::format("SELECT {} FROM {}{}", fmt::join(columns, ", "), table, order_of(table)));
    std::int64_t count = 0;
    while (rows.next()) {
      move_row(table, columns, rows, batch);
      ++count;
    }
    batch.flush();
    if (keeps_numbers && count > 0)
      (void)to_.number(
          fmt::format("SELECT setval(pg_get_serial_sequence('popcut.{0}', 'seq'), "
                      "(SELECT max(seq) FROM popcut.{0}))",
                      table));
    done_.tables.push_back({table, batch.inserted(), count - batch.inserted()});
  }

  // A session refers to the one that it was opened from.
  static std::string order_of(const std::string& table) {
    if (table == "audit" || table == "usage") return " ORDER BY seq";
    return table == "session" ? " ORDER BY created, id" : "";
  }

  void move_row(const std::string& table, const std::vector<std::string>& columns, const Rows& rows,
                Batch& batch) {
    std::deque<std::string> own;
    std::vector<Bound> values;
    values.reserve(columns.size());
    for (std::size_t at = 0; at < columns.size(); ++at) {
      const int column = static_cast<int>(at);
      const Bound value = rows.value(column);
      const std::optional<std::string> other = changed(table, columns[at], rows, column);
      values.push_back(other ? Bound(own.emplace_back(*other)) : value);
    }
    batch.add(values);
  }

  // The value that a column gets in the fleet; nothing: the same.
  std::optional<std::string> changed(const std::string& table, const std::string& column,
                                     const Rows& rows, int at) {
    if (is_person(column)) {
      if (std::string name = rows.text(at); is_local_user(name)) return name + user_;
      return std::nullopt;
    }
    if (column == "node" && (table == "attempt" || table == "device")) return request_.node;
    if (column == "identity" && table == "attempt") return identity_of(folder_);
    if (column == "state" && table == "device") return "absent";
    if (column == "state" && table == "job" && rows.text(at) == "planning") return "queued";
    if (column == "key" && table == "plan") {
      std::string key = rows.text(at);
      // Another folder had the same planned.
      if (to_.number("SELECT count(*) FROM popcut.plan WHERE key=? AND state IN ('pending', "
                     "'planned')",
                     key) > 0)
        return fmt::format("imported-{}-{}", request_.node, key);
    }
    return std::nullopt;
  }

  void move_events() {
    report("event");
    to_.hold("popcut.event_counter");  // as event_number does
    const std::int64_t last = to_.number("SELECT last FROM popcut.event_counter");
    const std::vector<std::string> columns{"seq", "time", "kind", "job", "data"};
    Batch batch(to_, "event", columns, "");
    Rows rows = from_.rows("SELECT seq, time, kind, job, data FROM event ORDER BY seq");
    std::int64_t seq = last, count = 0;
    while (rows.next()) {
      std::string data = rows.text(4);
      const std::int64_t old = rows.integer(0);
      seq = last == 0 ? old : seq + 1;
      const std::string head = fmt::format(R"({{"seq":{},)", old);
      if (seq != old && data.starts_with(head))
        data.replace(0, head.size(), fmt::format(R"({{"seq":{},)", seq));
      batch.add({Bound(seq), rows.value(1), rows.value(2), rows.value(3), Bound(data)});
      ++count;
    }
    batch.flush();
    to_.run("UPDATE popcut.event_counter SET last=?", seq);
    done_.tables.push_back({"event", count, 0});
  }

  void files() {
    report("files");
    for (const char* table : {"asset", "design"})
      for (const std::string& id :
           all_of(from_.rows(fmt::format("SELECT id FROM {} ORDER BY id", table)), first_text))
        file(fmt::format("{}s/{}", table, id), id);
    for (const std::string& id :
         all_of(from_.rows("SELECT id FROM plan WHERE state='planned' ORDER BY id"), first_text))
      folder("plans/" + id);
    for (const std::string& id :
         all_of(from_.rows("SELECT id FROM search WHERE state='found' ORDER BY id"), first_text))
      folder("searches/" + id);
  }

  void folder(const std::string& path) {
    std::error_code error;
    std::set<std::string> names;
    for (fs::directory_iterator at(folder_.at(path), error), end; !error && at != end;
         at.increment(error))
      if (at->is_regular_file() && !at->is_symlink()) names.insert(at->path().filename().string());
    if (error || names.empty()) done_.missing.push_back(path);
    for (const std::string& name : names) file(fmt::format("{}/{}", path, name), "");
  }

  // `id` ends with the digest that the bytes must have, if it is known.
  void file(const std::string& path, std::string_view id) {
    if (to_.number("SELECT count(*) FROM popcut.blob WHERE path=?", path) > 0) return;
    const Result<std::string> bytes = read_whole(folder_.at(path), kMostFile);
    const std::string digest = bytes ? sha256_hex(*bytes) : "";
    if (!bytes || (!id.empty() && !id.ends_with(digest))) {
      done_.missing.push_back(path);
      return;
    }
    to_.run(
        "INSERT INTO popcut.blob(path, sha256, bytes, created) VALUES(?, ?, ?, "
        "(extract(epoch FROM clock_timestamp())*1000)::bigint)",
        path, digest, static_cast<std::int64_t>(bytes->size()));
    std::int64_t seq = 0;
    for (std::size_t from = 0; from < bytes->size(); from += kPart, ++seq)
      to_.run("INSERT INTO popcut.blob_part(path, seq, data) VALUES(?, ?, ?)", path, seq,
              "\\x" + hex_of(std::string_view(*bytes).substr(from, kPart)));
    ++done_.files;
    done_.bytes += static_cast<std::int64_t>(bytes->size());
  }

  Database& from_;
  Database& to_;
  const StateFolder& folder_;
  const ImportRequest& request_;
  std::string user_;
  Imported done_;
};

// The mark in the folder stays, so that a popcutd without a fleet says that its database is gone
// instead of beginning with an empty queue.
Result<std::string> set_original_aside(const std::string& folder) {
  auto held = StateFolder::open(folder);
  if (!held) return tl::unexpected(held.error());
  const std::string from = (*held)->at("popcut.db");
  const std::string to =
      (*held)->at(fmt::format("backups/moved-to-fleet-{}.db", hex_of(random_bytes(4))));
  if (const Result<void> done = keep_file(from, to); !done) return tl::unexpected(done.error());
  remove_tree(from + "-wal");
  give_to_owner(folder);
  return to;
}

}  // namespace

Result<Imported> import_folder(Database& fleet, const ImportRequest& request) {
  std::error_code error;
  const fs::path file = fs::path(request.folder) / "popcut.db";
  if (!fs::exists(file, error))
    return fail(ErrorKind::Unwritable, "",
                file.string() + ": does not exist; name the state folder of a popcutd");
  Imported done;
  {
    StoreOptions options;
    options.folder = request.folder;
    auto store = Store::open(std::move(options));
    if (!store) return tl::unexpected(store.error());
    try {
      Transaction all(fleet);
      done = Import((*store)->database(), fleet, (*store)->folder(), request).run();
      all.commit();
    } catch (const StoreFault& fault) {
      if (fault.kind() == FaultKind::InDoubt)
        return fail(ErrorKind::Refused, "",
                    fmt::format("{}; either everything was moved or nothing: type the command "
                                "again to see whether it finished",
                                fault.what()));
      return fail(ErrorKind::Refused, "",
                  fault.kind() == FaultKind::Refused
                      ? fault.what()
                      : fmt::format("nothing was moved: {}", fault.what()));
    }
  }
  Result<std::string> aside = set_original_aside(request.folder);
  if (!aside)
    return fail(
        ErrorKind::Unwritable, "",
        fmt::format("all is in the fleet, but {} is still in its place ({}); move it into {}, "
                    "so that no popcutd cuts from it",
                    file.string(), message(aside.error()),
                    (fs::path(request.folder) / "backups").string()));
  done.original = std::move(*aside);
  return done;
}

}  // namespace popcut::daemon
