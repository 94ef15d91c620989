// SPDX-License-Identifier: MIT
// Links that somebody planted where popcutd writes.
#include <filesystem>
#include <memory>
#include <string>

#include <catch2/catch.hpp>

#include "daemon/files/held_folder.hpp"
#include "daemon/http/spool.hpp"
#include "daemon/store/state_folder.hpp"
#include "tests/support/process.hpp"

namespace state_links_test {

using namespace popcut;
using popcut::daemon::StateFolder;
namespace fs = std::filesystem;
using testing::files_below;
using testing::TempFolder;
using testing::text_of_file;

namespace {

/// A state folder, and another one with a file that must stay as it is.
struct Bench {
  TempFolder temp;
  fs::path elsewhere{temp / "elsewhere"}, precious{elsewhere / "precious"};
  std::unique_ptr<StateFolder> folder;

  Bench() {
    fs::create_directory(elsewhere);
    testing::write_file(precious, "mine");
    auto opened = StateFolder::open((temp / "state").string());
    REQUIRE(opened);
    folder = std::move(*opened);
  }
  [[nodiscard]] std::string at(const std::string& inside) const { return folder->at(inside); }
  /// At this name of the state lies a link to the file elsewhere.
  void plant(const std::string& inside) const {
    fs::remove_all(at(inside));
    fs::create_symlink(precious, at(inside));
  }
  /// The folder is moved away and a link to the other one takes its place.
  void swap(const std::string& inside) const {
    fs::rename(at(inside), at(inside) + ".moved");
    fs::create_directory_symlink(elsewhere, at(inside));
  }
  void check_untouched() const {
    CHECK(text_of_file(precious) == "mine");
    CHECK(files_below(elsewhere).size() == 1);
  }
};

}  // namespace

TEST_CASE("a link at any name that popcutd writes in its state is replaced and never followed",
          "[daemon][store][links]") {
  const Bench bench;
  for (const char* name : {"database-state", "webhook", "designs/abc"}) {
    CAPTURE(name);
    const fs::path place = bench.at(name);
    const std::string beside =
        (fs::path(name).parent_path() / (".new-" + place.filename().string())).string();
    bench.plant(name);
    bench.plant(beside);
    REQUIRE(daemon::write_file(place.string(), "new"));
    CHECK_FALSE(fs::is_symlink(place));
    CHECK(text_of_file(place) == "new");
    bench.check_untouched();
  }
  bench.plant("plans/p1");
  bench.plant("plans/.new-p1");
  REQUIRE(daemon::write_folder(bench.at("plans/p1"), {{"sheet-01.gpgl", "bytes"}}));
  CHECK(text_of_file(bench.at("plans/p1/sheet-01.gpgl")) == "bytes");
  bench.plant("reserve");
  bench.plant(".new-reserve");
  CHECK(bench.folder->take_reserve(4096));
  CHECK(fs::is_regular_file(fs::symlink_status(bench.at("reserve"))));
  bench.plant("incoming/r1.upload");
  CHECK_FALSE(daemon::http::Spool::create(bench.at("incoming"), "r1"));
  bench.check_untouched();
}

TEST_CASE("a state folder that a link replaces while popcutd runs is not written through",
          "[daemon][store][links]") {
  const Bench bench;
  testing::write_file(bench.at("incoming/u"), "upload");
  for (const char* inside : {"designs", "plans", "incoming"}) bench.swap(inside);
  CHECK_FALSE(daemon::write_file(bench.at("designs/abc"), "new"));
  CHECK_FALSE(daemon::write_folder(bench.at("plans/p1"), {{"sheet-01.gpgl", "bytes"}}));
  CHECK_FALSE(daemon::keep_file(bench.at("incoming.moved/u"), bench.at("designs/u")));
  CHECK_FALSE(daemon::http::Spool::create(bench.at("incoming"), "r1"));
  bench.check_untouched();
}

TEST_CASE("a state folder is found through a link and stays the one that it was",
          "[daemon][store][links]") {
  TempFolder temp;
  fs::create_directory(temp / "real");
  fs::create_directory(temp / "other");
  fs::create_directory_symlink(temp / "real", temp / "state");
  const auto folder = StateFolder::open((temp / "state").string());
  REQUIRE(folder);
  fs::remove(temp / "state");
  fs::create_directory_symlink(temp / "other", temp / "state");
  REQUIRE(daemon::write_file((*folder)->at("designs/abc"), "new"));
  CHECK(text_of_file(temp / "real/designs/abc") == "new");
  CHECK(files_below(temp / "other").empty());
}

TEST_CASE("a held folder makes files in itself only", "[daemon][links]") {
  TempFolder temp;
  const auto held = HeldFolder::open(temp.path().string());
  REQUIRE(held);
  for (const char* name : {"", ".", "..", "a/b", "../a", "/tmp/a"}) {
    CAPTURE(name);
    CHECK(held->create(name) < 0);
    CHECK(held->create_again(name) < 0);
    CHECK(held->append(name) < 0);
    CHECK(held->make_folder(name) < 0);
  }
  const int file = held->create("a");
  REQUIRE(file >= 0);
  ::close(file);
  CHECK(held->create("a") < 0);
  CHECK(errno == EEXIST);
  fs::create_hard_link(temp / "a", temp / "b");
  CHECK(held->append("a") < 0);
  fs::remove(temp / "b");
  const int more = held->append("a");
  REQUIRE(more >= 0);
  ::close(more);
  CHECK_FALSE(HeldFolder::open((temp / "a").string()));
  CHECK_FALSE(HeldFolder::open((temp / "nowhere").string()));
  CHECK(HeldFolder().create("a") < 0);
}

}  // namespace state_links_test
