// SPDX-License-Identifier: MIT
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <set>

#include <catch2/catch.hpp>

#include "daemon/store/restore.hpp"
#include "daemon/store/salvage.hpp"
#include "daemon/store/schema.hpp"
#include "daemon/store/store.hpp"
#include "daemon/store/ulid.hpp"
#include "daemon/store/wal_check.hpp"
#include "tests/support/service_bench.hpp"

namespace store_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::TempFolder;
using popcut::testing::write_text;

namespace {

namespace fs = std::filesystem;

popcut::Result<std::unique_ptr<Store>> open(const TempFolder& scratch) {
  return Store::open({.folder = (scratch / "state").string(), .reserve_bytes = 4096});
}

void add_token(Database& db, const std::string& name) {
  db.run("INSERT INTO material(id, rev, json) VALUES(?, 1, '{}')", name);
}

std::int64_t tokens(Database& db) { return db.number("SELECT count(*) FROM material"); }

}  // namespace

TEST_CASE("digests and random words have the right form", "[daemon][store]") {
  CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Sha256 pieces;
  pieces.add("a");
  pieces.add("bc");
  CHECK(pieces.hex() == sha256_hex("abc"));
  CHECK(base64url(std::string("\xff\xfe\xfd", 3)) == "__79");
  CHECK(base64url("f") == "Zg");
  CHECK(base64url(random_bytes(32)).size() == 43);
  CHECK(random_bytes(32) != random_bytes(32));
  CHECK(equal_in_constant_time("secret", "secret"));
  CHECK_FALSE(equal_in_constant_time("secret", "secreT"));
  CHECK_FALSE(equal_in_constant_time("secret", "secre"));
}

TEST_CASE("ids sort by their time and grow even when the clock goes back", "[daemon][store]") {
  UlidSource source;
  std::string before;
  for (int i = 0; i < 3000; ++i) {
    const std::int64_t now = 1'795'000'000'000 + (i < 1000 ? i : 2000 - i);
    const std::string id = source.next(now);
    REQUIRE(is_ulid(id));
    REQUIRE(id > before);
    before = id;
  }
  UlidSource after(before);
  CHECK(after.next(0) > before);
  CHECK(first_ulid_of(1'795'000'000'000) < source.next(1'795'000'000'000));
  CHECK(first_ulid_of(1469918176385).substr(0, 10) == "01ARYZ6S41");
  CHECK_FALSE(is_ulid("8ZZZZZZZZZZZZZZZZZZZZZZZZZ"));
  CHECK_FALSE(is_ulid("01ARYZ6S41TSV4RRFFQ69G5FAI"));
}

TEST_CASE("one process owns the state and a second one is refused", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  auto first = open(scratch);
  REQUIRE(first);
  const auto second = open(scratch);
  REQUIRE_FALSE(second);
  CHECK(second.error().kind == popcut::ErrorKind::Refused);
  CHECK(second.error().detail.find("another popcutd") != std::string::npos);
  first->reset();
  CHECK(open(scratch));
}

TEST_CASE("files appear whole or not at all", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string folder = (scratch / "plan").string();
  REQUIRE(write_folder(folder, {{"a.svg", "one"}, {"b.json", "two"}}));
  CHECK(read_whole(folder + "/b.json", 10).value() == "two");
  REQUIRE(write_folder(folder, {{"c.svg", "three"}}));
  CHECK_FALSE(fs::exists(folder + "/a.svg"));
  CHECK_FALSE(write_folder(folder, {{"../escape", "x"}}));
  CHECK_FALSE(write_folder(folder, {{".hidden", "x"}}));
  CHECK(fs::exists(folder + "/c.svg"));
  CHECK_FALSE(fs::exists((scratch / "escape").string()));
  CHECK_FALSE(write_folder((scratch / "not/there/plan").string(), {{"a", "x"}}));
  CHECK_FALSE(read_whole(folder + "/c.svg", 3));
  CHECK_FALSE(read_whole(folder, 100));
  fs::create_symlink("/etc/passwd", (scratch / "link").string());
  CHECK_FALSE(read_whole((scratch / "link").string(), 1 << 20));
}

TEST_CASE("unfinished files of an earlier process are removed", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  open(scratch)->reset();
  const std::string state = (scratch / "state").string();
  write_text(state + "/incoming/upload", "half");
  fs::create_directory(state + "/plans/.new-01J");
  fs::create_directory(state + "/plans/01J");
  const auto again = open(scratch);
  REQUIRE(again);
  CHECK_FALSE(fs::exists(state + "/incoming/upload"));
  CHECK_FALSE(fs::exists(state + "/plans/.new-01J"));
  CHECK(fs::exists(state + "/plans/01J"));
  CHECK(fs::file_size(state + "/reserve") == 4096);
  CHECK((fs::status(state).permissions() & fs::perms::others_all) == fs::perms::none);
}

TEST_CASE("a transaction inside another is undone with it or alone", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  auto store = open(scratch).value();
  Store& held = *store;
  Database& db = held.database();
  {
    Transaction outer(db);
    add_token(db, "kept");
    {
      Transaction inner(db);
      add_token(db, "undone");
    }
    {
      Transaction inner(db);
      add_token(db, "also-kept");
      inner.commit();
    }
    outer.commit();
  }
  CHECK(tokens(db) == 2);
  {
    Transaction outer(db);
    Transaction inner(db);
    add_token(db, "third");
    inner.commit();
  }
  CHECK(tokens(db) == 2);
  CHECK_THROWS_AS(db.run("INSERT INTO material(id, rev, json) VALUES('kept', 1, '')"), StoreFault);
  CHECK_THROWS_AS(db.run("SELECT nonsense"), StoreFault);
}

TEST_CASE("the schema itself keeps the rules that matter most", "[daemon][store]") {
  TempFolder scratch{TempFolder::Place::Memory};
  auto store = open(scratch).value();
  Database& db = store->database();
  db.script("PRAGMA foreign_keys=OFF");
  const auto job = [&](const std::string& id, const std::string& state, const std::string& device) {
    db.run(
        "INSERT INTO job(id, rev, state, device, reason, asked, name, note, owner, operator, "
        "requested_device, design, plan, material, priority, position, copies, held, sheets_total, "
        "sheet, blank, segment, first_stroke, paths_certain, paths_sent, paths_total, done_paths, "
        "done_mm, low_s, high_s, created, outcome, tags, attention_kind, attention_text, "
        "attention_since) VALUES(?, 1, ?, ?, '', '', '', '', 'o', '', '', 'd', "
        "'01J0000000000000000000PLAN', 'm', 0, 0, 1, 0, 2, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, '', "
        "'[]', '', '', 0)",
        id, state, device);
  };
  job("01J00000000000000000000001", "cutting", "sim:a");
  CHECK_THROWS_AS(job("01J00000000000000000000002", "cutting", "sim:a"), StoreFault);
  CHECK_THROWS_AS(job("01J00000000000000000000002", "armed", "sim:a"), StoreFault);
  CHECK_THROWS_AS(job("01J00000000000000000000002", "armed", ""), StoreFault);
  CHECK_THROWS_AS(job("01J00000000000000000000002", "melted", "sim:b"), StoreFault);
  CHECK_NOTHROW(job("01J00000000000000000000002", "cutting", "sim:b"));
  // Ended is for ever.
  db.run("UPDATE job SET state='done', finished=1 WHERE id='01J00000000000000000000002'");
  CHECK_THROWS_AS(db.run("UPDATE job SET state='ready', finished=NULL WHERE "
                         "id='01J00000000000000000000002'"),
                  StoreFault);
  CHECK_THROWS_AS(db.run("DELETE FROM job WHERE id='01J00000000000000000000002'"), StoreFault);
  CHECK(db.number("SELECT jobs FROM tally WHERE state='done'") == 1);
  CHECK(db.number("SELECT jobs FROM tally WHERE state='cutting'") == 1);
  // The same blank is never started twice; what never started does not count.
  const auto attempt = [&](const std::string& id, const char* started) {
    db.run(std::string("INSERT INTO attempt VALUES(?, '01J00000000000000000000001', 1, 1, 1, 0, 5, "
                       "'sim:a', '', '', '', '', 0, ") +
               started + ", 1, '', 0, '', '', 0, NULL, '')",
           id);
  };
  attempt("01J0000000000000000000000A", "NULL");
  attempt("01J0000000000000000000000B", "5");
  attempt("01J0000000000000000000000C", "NULL");
  CHECK_THROWS_AS(attempt("01J0000000000000000000000D", "6"), StoreFault);
}

TEST_CASE("a database with tables of another version is refused and not touched",
          "[daemon][store]") {
  for (const int version : {9, kSchemaVersion + 1, 9999}) {
    const TempFolder scratch{TempFolder::Place::Memory};
    const std::string state = (scratch / "state").string(), path = state + "/popcut.db";
    add_token(open(scratch).value()->database(), "other");
    {
      SqliteDatabase other({.path = path, .create = false, .exclusive_wal = false});
      other.script("PRAGMA user_version=" + std::to_string(version));
      other.checkpoint(true);
    }
    for (const char* beside : {"/database-state", "/witness"}) fs::remove(state + beside);
    const std::string before = read_whole(path, 1 << 24).value();
    const auto refused = [&](const auto& result, const std::string& place) {
      REQUIRE_FALSE(result);
      CHECK(result.error().kind == popcut::ErrorKind::OutOfRange);
      CHECK(message(result.error()) ==
            place + ": was written by another version of popcutd (schema " +
                std::to_string(version) +
                ", this version uses schema 2); install that version, or use another state folder "
                "to start with an empty queue");
      CHECK(read_whole(path, 1 << 24).value() == before);
    };
    refused(open(scratch), path);
    refused(salvage(state), path);
    const std::string copy = (scratch / "copy.db").string();
    fs::copy_file(path, copy);
    refused(restore(state, copy, true), copy);
  }
}

TEST_CASE("a database of an older popcutd is brought into this version by salvage",
          "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string(), path = state + "/popcut.db";
  add_token(open(scratch).value()->database(), "kept");
  {
    SqliteDatabase older({.path = path, .create = false, .exclusive_wal = false});
    older.script(
        "ALTER TABLE plan DROP COLUMN handwork; DROP TABLE calendar; PRAGMA user_version=1");
    older.checkpoint(true);
  }
  for (const char* beside : {"/database-state", "/witness"}) fs::remove(state + beside);
  const auto refused = open(scratch);
  REQUIRE_FALSE(refused);
  CHECK(message(refused.error()) ==
        path +
            ": was written by an older popcutd (schema 1, this version uses schema 2); bring "
            "its jobs into this version with 'popcut db salvage --state " +
            state + "', which keeps the old database");
  const auto done = salvage(state);
  REQUIRE(done);
  CHECK(fs::exists(done->original + "/popcut.db"));
  const auto opened = open(scratch);
  REQUIRE(opened);
  Database& now = opened.value()->database();
  CHECK(now.number("SELECT count(*) FROM material WHERE id='kept'") == 1);
  CHECK(now.number("SELECT count(*) FROM calendar") == 0);
  CHECK(now.number("SELECT count(*) FROM pragma_table_info('plan') WHERE name='handwork'") == 1);
}

TEST_CASE("salvage keeps the rows of tables that lack a column, whatever their version says",
          "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  add_token(open(scratch).value()->database(), "kept");
  {
    SqliteDatabase other({.path = state + "/popcut.db", .create = false, .exclusive_wal = false});
    other.script(
        "ALTER TABLE plan DROP COLUMN handwork; ALTER TABLE material ADD COLUMN more TEXT");
    other.run("UPDATE material SET more='m'");
    other.checkpoint(true);
  }
  for (const char* beside : {"/database-state", "/witness"}) fs::remove(state + beside);
  const auto done = salvage(state);
  REQUIRE(done);
  for (const auto& table : done->tables) {
    CAPTURE(table.name);
    CHECK(table.whole);
  }
  CHECK(open(scratch).value()->database().number("SELECT count(*) FROM material WHERE id='kept'") ==
        1);
}

TEST_CASE("a missing or empty or foreign database is never replaced silently", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string path = (scratch / "state/popcut.db").string();
  {
    auto store = open(scratch).value();
    add_token(store->database(), "one");
  }
  const std::string whole = read_whole(path, 1 << 24).value();
  const auto refused = [&](const char* why) {
    CAPTURE(why);
    const auto opened = open(scratch);
    REQUIRE_FALSE(opened);
    CHECK(opened.error().kind == popcut::ErrorKind::Malformed);
    CHECK(opened.error().detail.find(path) != std::string::npos);
  };
  fs::remove(path);
  refused("gone");
  write_text(path, "");
  refused("empty");
  write_text(path,
             "hello, I am a text that is longer than any header of a database that there "
             "might be, and no database at all");
  refused("a text");
  write_text(path, whole.substr(0, whole.size() / 2));
  refused("cut short");
  std::string other = whole;
  other[68] = 'x';
  write_text(path, whole.substr(0, 5000) + "y" + whole.substr(5001));
  refused("one byte is another");
  write_text(path, other);
  refused("another program's");
  CHECK(read_whole(path, 1 << 24).value() == other);  // the original stays as it is
  write_text(path, whole);
  CHECK(open(scratch));
}

TEST_CASE("a log that is missing or damaged in its middle is reported", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string path = (scratch / "state/popcut.db").string();
  {
    auto store = open(scratch).value();
    for (int i = 0; i < 5; ++i) add_token(store->database(), "row-" + std::to_string(i));
    store->mark_in_use();
    store->give_up();
  }
  const std::string log = read_whole(path + "-wal", 1 << 24).value();
  REQUIRE(log.size() > 5 * 4120);
  CHECK(log_damage(path + "-wal").empty());
  fs::remove(path + "-wal");
  REQUIRE_FALSE(open(scratch));
  CHECK(open(scratch).error().detail.find("log is missing") != std::string::npos);
  for (const std::size_t at : {std::size_t{5}, std::size_t{40}, log.size() / 2}) {
    CAPTURE(at);
    std::string damaged = log;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    write_text(path + "-wal", damaged);
    const auto opened = open(scratch);
    REQUIRE_FALSE(opened);
    CHECK(opened.error().kind == popcut::ErrorKind::Malformed);
  }
  // The last transaction may be torn: it was never reported.
  write_text(path + "-wal", log.substr(0, log.size() - 100));
  {
    const auto opened = open(scratch);
    REQUIRE(opened);
    CHECK(tokens((*opened)->database()) == 4);
    (*opened)->give_up();
  }
  write_text(path + "-wal", log);
  CHECK(tokens(open(scratch).value()->database()) == 5);
}

TEST_CASE("leftovers of killed runs after the last commit are not damage", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string log_path = (scratch / "state/popcut.db-wal").string();
  constexpr std::size_t kFrameHeader = 24, kFrame = kFrameHeader + 4096;
  const auto log_after = [&](int rows, char text) {
    auto store = open(scratch).value();
    Transaction all(store->database());
    for (int i = 0; i < rows; ++i)
      store->database().run("INSERT INTO material(id, rev, json) VALUES(?, 1, ?)",
                            "row-" + std::to_string(tokens(store->database())),
                            std::string(1000, text));
    all.commit();
    store->mark_in_use();
    store->give_up();
    return read_whole(log_path, 1 << 24).value();
  };
  const std::string before = log_after(1, 'a');
  // One run is killed in a long transaction: the frame that commits it is not there.
  std::string log = log_after(200, 'b');
  log.resize(log.size() - kFrame);
  // The next one between the two writes of the frame that commits a short one: its header is there.
  write_text(log_path, before);
  const std::string next = log_after(1, 'c');
  REQUIRE(next.size() > before.size());
  REQUIRE(next.size() + kFrame < log.size());
  const std::size_t begun = next.size() - kFrame + kFrameHeader;
  log.replace(0, begun, next.substr(0, begun));
  write_text(log_path, log);
  CHECK(log_damage(log_path).empty());
  {
    const auto opened = open(scratch);
    REQUIRE(opened);
    CHECK(tokens((*opened)->database()) == 1);
    (*opened)->give_up();
  }
  // And one that commits there: what the others left behind it does not matter.
  log.replace(0, next.size(), next);
  write_text(log_path, log);
  CHECK(log_damage(log_path).empty());
  CHECK(tokens(open(scratch).value()->database()) == 2);
}

TEST_CASE("a damaged database is copied aside once and salvage recovers the rest",
          "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  {
    auto store = open(scratch).value();
    Transaction all(store->database());
    for (int i = 0; i < 2000; ++i)
      store->database().run("INSERT INTO material(id, rev, json) VALUES(?, 1, ?)",
                            "material-" + std::to_string(100'000 + i), std::string(100, 'x'));
    all.commit();
  }
  std::string bytes = read_whole(state + "/popcut.db", 1 << 24).value();
  // A page in the middle of that table's leaves.
  const std::size_t at = bytes.find("material-101000") / 4096 * 4096;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 4096, '\xAA');
  write_text(state + "/popcut.db", bytes);
  for (int i = 0; i < 2; ++i) REQUIRE_FALSE(open(scratch));
  int copies = 0;
  for (const auto& entry : fs::directory_iterator(state + "/backups"))
    copies += entry.path().filename().string().starts_with("damaged-") ? 1 : 0;
  CHECK(copies == 1);

  const auto done = salvage(state);
  REQUIRE(done);
  CHECK(read_whole(done->original + "/popcut.db", 1 << 24).value() == bytes);
  auto store = open(scratch).value();
  const std::int64_t left = tokens(store->database());
  CHECK(left > 1900);
  CHECK(left < 2000);
  for (const Salvage::Table& table : done->tables)
    if (table.name == "material") {
      CHECK_FALSE(table.whole);
      CHECK(table.rows == left);
    } else {
      CHECK(table.whole);
    }
  CHECK(salvage(state).error().kind == popcut::ErrorKind::Refused);
}

TEST_CASE("a backup made in operation can replace the database", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const fs::path state = (scratch / "state").string();
  std::string copy;
  {
    auto store = open(scratch).value();
    add_token(store->database(), "kept");
    copy = back_up(store->database(), store->folder(), "popcut-1.db");
    add_token(store->database(), "later");
  }
  CHECK_FALSE(fs::exists(copy + "-wal"));
  fs::copy_file(copy, state / "popcut.db", fs::copy_options::overwrite_existing);
  for (const char* name : {"popcut.db-wal", "database-state", "witness"}) fs::remove(state / name);
  const auto opened = open(scratch);
  REQUIRE(opened);
  CHECK(tokens((*opened)->database()) == 1);
}

TEST_CASE("a copy is restored by one command and never in place of a whole later database",
          "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  std::string copy;
  {
    auto store = open(scratch).value();
    add_token(store->database(), "kept");
    copy = back_up(store->database(), store->folder(), "popcut-1.db");
    add_token(store->database(), "later");
    store->database().run(
        "INSERT INTO event(seq, time, kind, job, data) VALUES(1, 0, 'job', '', '{}')");
  }
  const auto refused = restore(state, copy, false);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == popcut::ErrorKind::Refused);
  CHECK(refused.error().detail.find("--older") != std::string::npos);
  CHECK(tokens(open(scratch).value()->database()) == 2);
  // The one that is there may be no copy of itself, nor another program's file one of it.
  CHECK(restore(state, state + "/popcut.db", true).error().kind == popcut::ErrorKind::Refused);
  write_text(state + "/text", "no database");
  CHECK(restore(state, state + "/text", true).error().kind == popcut::ErrorKind::Malformed);
  CHECK(restore(state, state + "/none", true).error().kind == popcut::ErrorKind::Malformed);

  const auto done = restore(state, copy, true);
  REQUIRE(done);
  CHECK(tokens(open(scratch).value()->database()) == 1);
  CHECK(fs::exists(done->original + "/popcut.db"));
  // What was replaced can be put back; its log went with it.
  REQUIRE(restore(state, done->original + "/popcut.db", false));
  CHECK(tokens(open(scratch).value()->database()) == 2);
  // With a damaged one there is nothing to lose.
  write_text(state + "/popcut.db", std::string(8192, '\x5A'));
  REQUIRE_FALSE(open(scratch));
  REQUIRE(restore(state, copy, false));
  CHECK(tokens(open(scratch).value()->database()) == 1);
}

TEST_CASE("whoever has a whole database is not told to go back to a copy", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  {
    auto store = open(scratch).value();
    for (int i = 0; i < 5; ++i) add_token(store->database(), "row-" + std::to_string(i));
  }
  // As after a change by hand: whole, but not what was closed.
  write_text(state + "/database-state", "clean " + std::string(64, '0') + "\n");
  const auto changed = open(scratch);
  REQUIRE_FALSE(changed);
  CHECK(changed.error().detail.find("all of it can be read") != std::string::npos);
  CHECK(changed.error().detail.find("popcut db salvage --state " + state) != std::string::npos);
  CHECK(changed.error().detail.find("restore") == std::string::npos);
  REQUIRE(salvage(state));
  CHECK(tokens(open(scratch).value()->database()) == 5);
  // One that is not whole may have to be replaced.
  std::string bytes = read_whole(state + "/popcut.db", 1 << 24).value();
  bytes[100] = static_cast<char>(bytes[100] ^ 0x40);
  write_text(state + "/popcut.db", bytes);
  CHECK(open(scratch).error().detail.find("popcut db restore COPY --state " + state) !=
        std::string::npos);
}

TEST_CASE("a folder that is moved while it is in use can be used again", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string(), away = (scratch / "away").string();
  {
    auto store = open(scratch).value();
    add_token(store->database(), "kept");
    store->mark_in_use();
    fs::rename(state, away);
    // Another one in its place is not touched.
    fs::create_directory(state);
  }
  CHECK(fs::is_empty(state));
  fs::remove(state);
  fs::rename(away, state);
  CHECK(tokens(open(scratch).value()->database()) == 1);
}

TEST_CASE("the check of all pages can come after the start and damage is kept in mind",
          "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  const auto later = [&] {
    return Store::open({.folder = state, .reserve_bytes = 4096, .check_later = true});
  };
  const auto kill = [](Store& store) {
    store.mark_in_use();
    store.give_up();
  };
  {
    auto store = open(scratch).value();
    CHECK(store->checked());
    Transaction all(store->database());
    for (int i = 0; i < 500; ++i)
      store->database().run("INSERT INTO material(id, rev, json) VALUES(?, 1, ?)",
                            "material-" + std::to_string(100'000 + i), std::string(100, 'x'));
    all.commit();
  }
  CHECK(later().value()->checked());  // closed in order: each byte is known
  kill(*open(scratch).value());
  {
    auto store = later().value();
    CHECK_FALSE(store->checked());
    add_token(store->database(), "while it is checked");
    CHECK(store->damage_of_copy() == "");
    CHECK(store->damage_in_place().empty());
  }
  {
    // It ended before it was checked: that is still to be done.
    auto store = later().value();
    CHECK_FALSE(store->checked());
    CHECK(tokens(store->database()) == 501);
    store->set_checked();
  }
  CHECK(later().value()->checked());
  kill(*open(scratch).value());
  std::string bytes = read_whole(state + "/popcut.db", 1 << 24).value();
  const std::size_t at = bytes.find("material-100250") / 4096 * 4096;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 4096, '\xAA');
  write_text(state + "/popcut.db", bytes);
  {
    auto store = later().value();
    CHECK(store->damage_of_copy().value().find("is damaged") == 0);
    store->mark_suspect();
    store->give_up();
  }
  // Now nothing is served before it is looked at.
  REQUIRE_FALSE(later());
  CHECK(later().error().kind == popcut::ErrorKind::Malformed);
}

TEST_CASE("files that root salvages belong to the folder's owner", "[daemon][store]") {
  if (::geteuid() != 0) {
    WARN("skipped: only root can give files away");
    return;
  }
  constexpr uid_t kOwner = 61'000;
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  add_token(open(scratch).value()->database(), "kept");
  for (const auto& entry : fs::recursive_directory_iterator(state))
    REQUIRE(::lchown(entry.path().c_str(), kOwner, kOwner) == 0);
  REQUIRE(::chown(state.c_str(), kOwner, kOwner) == 0);
  REQUIRE(salvage(state));
  for (const auto& entry : fs::recursive_directory_iterator(state)) {
    struct stat found {};
    REQUIRE(::lstat(entry.path().c_str(), &found) == 0);
    CAPTURE(entry.path().string());
    CHECK(found.st_uid == kOwner);
  }
}

TEST_CASE("salvage that reads nothing says how to go on and that works", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  open(scratch)->reset();
  const std::string whole = read_whole(state + "/popcut.db", 1 << 24).value();
  write_text(state + "/popcut.db", whole.substr(0, whole.size() / 2));
  const auto done = salvage(state);
  REQUIRE_FALSE(done);
  const std::string& detail = done.error().detail;
  INFO(detail);
  CHECK(detail.find("PRAGMA") == std::string::npos);
  CHECK(detail.find("'popcut db restore COPY --state " + state + "'") != std::string::npos);
  for (const std::string name : {"popcut.db", "popcut.db-wal", "database-state", "witness"}) {
    CHECK(detail.find(name) != std::string::npos);
    std::filesystem::remove(state + "/" + name);
  }
  CHECK(open(scratch));
}

TEST_CASE("salvage of a file that is not a database changes nothing", "[daemon][store]") {
  const TempFolder scratch{TempFolder::Place::Memory};
  const std::string state = (scratch / "state").string();
  open(scratch)->reset();
  write_text(state + "/popcut.db", std::string(8192, '\x5A'));
  const auto done = salvage(state);
  REQUIRE_FALSE(done);
  CHECK(done.error().kind == popcut::ErrorKind::Malformed);
  CHECK(read_whole(state + "/popcut.db", 1 << 20).value() == std::string(8192, '\x5A'));
  CHECK_FALSE(open(scratch));
}

}  // namespace store_test
