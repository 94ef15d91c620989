// SPDX-License-Identifier: MIT
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <numbers>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/cli/options/angles.hpp"
#include "daemon/files/output_folder.hpp"
#include "tests/support/process.hpp"
#include "tests/support/value.hpp"

namespace output_folder_test {

using namespace popcut;
using cli::OutputFolder;
using testing::files_below;
using testing::TempFolder;
using testing::text_of_file;
using testing::write_file;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

namespace {

/// One whole run: each name is a file with its own name as content.
void run_with(const fs::path& folder, const Names& names) {
  auto out = testing::value(OutputFolder::open(folder));
  for (const std::string& name : names) REQUIRE(out.add(name, name));
  REQUIRE(out.commit("test"));
}

void put_manifest(const fs::path& folder, const Names& files) {
  write_file(folder / "manifest.json", nlohmann::json{{"popcut", 1}, {"files", files}}.dump());
}

}  // namespace

TEST_CASE("files appear only when the run is committed", "[cli][output]") {
  const TempFolder temp;
  {
    auto out = testing::value(OutputFolder::open(temp / "new/deep"));
    REQUIRE(out.add("report.json", "{}"));
    CHECK_FALSE(fs::exists(temp / "new/deep/report.json"));
    REQUIRE(out.add("deploy/psi_001.stl", "solid"));
    REQUIRE(out.commit("test run"));
  }
  CHECK(files_below(temp / "new/deep") ==
        Names{"deploy/psi_001.stl", "manifest.json", "report.json"});
  const auto manifest = nlohmann::json::parse(text_of_file(temp / "new/deep/manifest.json"));
  CHECK(manifest["files"] == Names{"report.json", "deploy/psi_001.stl"});
  CHECK(manifest["made_by"] == "test run");
}

TEST_CASE("a run that fails leaves nothing and no new folder", "[cli][output]") {
  const TempFolder temp;
  fs::create_directory(temp / "old");
  for (const std::string name : {"old", "fresh/er"}) {
    auto out = testing::value(OutputFolder::open(temp / name));
    REQUIRE(out.add("a.txt", "a"));
    const auto streamed = out.add("b.txt", [](std::ostream& text) -> Result<void> {
      text << "half";
      return fail(ErrorKind::Infeasible, "slice 3", "no");
    });
    REQUIRE_FALSE(streamed);
    CHECK(streamed.error().place == "slice 3");
  }
  CHECK(files_below(temp.path()).empty());
  CHECK(fs::exists(temp / "old"));
  CHECK_FALSE(fs::exists(temp / "fresh"));
}

TEST_CASE("files of the last run that this one does not write are removed and others stay",
          "[cli][output]") {
  const TempFolder temp;
  run_with(temp.path(), {"sheet-01.svg", "sheet-02.svg", "deploy/psi_001.stl", "plan.json"});
  write_file(temp / "mine.txt", "my own");
  write_file(temp / "sheet-99.svg", "my own");
  run_with(temp.path(), {"sheet-01.svg", "plan.json"});
  CHECK(files_below(temp.path()) ==
        Names{"manifest.json", "mine.txt", "plan.json", "sheet-01.svg", "sheet-99.svg"});
  CHECK_FALSE(fs::exists(temp / "deploy"));
}

TEST_CASE("a foreign manifest removes nothing outside the folder", "[cli][output]") {
  const TempFolder temp;
  const fs::path folder = temp / "out", outside = temp / "outside";
  write_file(outside / "precious.txt", "x");
  write_file(folder / "sub/kept.txt", "x");
  fs::create_directory_symlink(outside, folder / "link");
  fs::create_symlink(outside / "precious.txt", folder / "link.txt");
  put_manifest(folder, {"../outside/precious.txt", (outside / "precious.txt").string(),
                        "link/precious.txt", "link.txt", "sub/../../outside/precious.txt", "sub",
                        "", ".", "..", "a//b", "manifest.json", std::string("x\0y", 3)});
  run_with(folder, {"a.txt"});
  CHECK(text_of_file(outside / "precious.txt") == "x");
  CHECK(files_below(folder) == Names{"a.txt", "link", "link.txt", "manifest.json", "sub/kept.txt"});
}

TEST_CASE("a manifest that is no manifest is replaced", "[cli][output]") {
  for (const std::string text : {"", "{", "[]", "{\"popcut\":1,\"files\":3}", "{\"files\":[\"a\"]}",
                                 "{\"popcut\":1,\"files\":[3,null,{}]}"}) {
    CAPTURE(text);
    const TempFolder temp;
    write_file(temp / "manifest.json", text);
    write_file(temp / "a", "mine");
    run_with(temp.path(), {"b"});
    CHECK(files_below(temp.path()) == Names{"a", "b", "manifest.json"});
  }
}

TEST_CASE("what a killed run left aside is cleared", "[cli][output]") {
  const TempFolder temp;
  write_file(temp / ".popcut-aside/half.svg", "half");
  run_with(temp.path(), {"a"});
  CHECK(files_below(temp.path()) == Names{"a", "manifest.json"});
}

TEST_CASE("two runs cannot write into one folder at once", "[cli][output]") {
  const TempFolder temp;
  auto first = testing::value(OutputFolder::open(temp.path()));
  const auto second = OutputFolder::open(temp.path());
  REQUIRE_FALSE(second);
  CHECK(second.error().kind == ErrorKind::Unwritable);
  CHECK(second.error().detail.find("another popcut") != std::string::npos);
  REQUIRE(first.add("a", "a"));
  REQUIRE(first.commit("test"));
  CHECK(files_below(temp.path()) == Names{"a", "manifest.json"});
}

TEST_CASE("an output that cannot be a folder is refused with its path", "[cli][output]") {
  const TempFolder temp;
  write_file(temp / "file", "x");
  for (const fs::path& folder : {temp / "file", temp / "file/below", fs::path("/proc/popcut")}) {
    CAPTURE(folder);
    const auto out = OutputFolder::open(folder);
    REQUIRE_FALSE(out);
    CHECK(out.error().kind == ErrorKind::Unwritable);
    CHECK(out.error().place.find(folder.begin()->string()) == 0);
  }
  CHECK(files_below(temp.path()) == Names{"file"});
}

TEST_CASE("what stands in the way of a file is found before anything changes", "[cli][output]") {
  const TempFolder temp;
  run_with(temp.path(), {"a", "z"});
  fs::create_directory(temp / "b");
  fs::create_directory_symlink("/tmp", temp / "c");
  for (const std::string name : {"b", "c/file", "a/below"}) {
    CAPTURE(name);
    auto out = testing::value(OutputFolder::open(temp.path()));
    REQUIRE(out.add("z", "new"));
    REQUIRE(out.add(name, "x"));
    const auto done = out.commit("test");
    REQUIRE_FALSE(done);
    CHECK(done.error().kind == ErrorKind::Unwritable);
    CHECK(done.error().place == (temp / name).string());
    CHECK(text_of_file(temp / "z") == "z");
  }
}

TEST_CASE("names that leave the folder are refused", "[cli][output]") {
  const TempFolder temp;
  auto out = testing::value(OutputFolder::open(temp.path()));
  for (const std::string name :
       {"", "..", "../a", "a/../../b", "/etc/a", "manifest.json", ".popcut-aside/a", "a/", "./a"}) {
    CAPTURE(name);
    CHECK_FALSE(out.add(name, "x"));
  }
  CHECK(out.add("a", "x"));
  CHECK_FALSE(out.add("a", "again"));
}

TEST_CASE("a file is read whole or not at all", "[cli][input]") {
  const TempFolder temp;
  write_file(temp / "a", std::string(100'000, 'x'));
  CHECK(cli::read_file(temp / "a").value().size() == 100'000);
  CHECK(cli::read_file(temp / "a", 100'000));
  const auto large = cli::read_file(temp / "a", 99'999);
  REQUIRE_FALSE(large);
  CHECK(large.error().kind == ErrorKind::Malformed);
  CHECK_FALSE(cli::read_file(temp.path()));
  CHECK_FALSE(cli::read_file(temp / "absent"));
  CHECK_FALSE(cli::read_file("/dev/zero", 1000));
}

TEST_CASE("angles are read as people write them", "[cli][angles]") {
  constexpr double pi = std::numbers::pi;
  CHECK(cli::parse_angle("1.1").value() == 1.1);
  CHECK(cli::parse_angle("pi").value() == pi);
  CHECK(cli::parse_angle(" pi/2 ").value() == pi / 2);
  CHECK(cli::parse_angle("90deg").value() == pi / 2);
  CHECK(cli::parse_angle("180deg").value() == pi);
  CHECK(cli::parse_angle("2*pi/3").value() == 2 * pi / 3);
  CHECK(cli::parse_angle("0.4pi").value() == 0.4 * pi);
  for (const std::string text :
       {"", "deg", "pie", "pi/", "pi/0", "*pi", "1,1", "nan", "inf", "1.1rad", "pi*2", "1e999"}) {
    CAPTURE(text);
    CHECK_FALSE(cli::parse_angle(text));
  }
  CHECK(cli::parse_opening_angles("pi,1.1,0").value() == std::vector<double>{pi, 1.1, 0});
  CHECK(cli::parse_opening_angles("").value().empty());
  for (const std::string text : {"pi,,1", "-1", "3.2", "1;2"}) {
    CAPTURE(text);
    CHECK_FALSE(cli::parse_opening_angles(text));
  }
}

TEST_CASE("a pipe into which nobody writes is refused, and one that is written is read",
          "[files]") {
  const TempFolder temp;
  const fs::path pipe = temp.path() / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const auto nothing = cli::read_file(pipe, 100, std::chrono::milliseconds(1));
  REQUIRE(!nothing);
  CHECK(nothing.error().detail == "is a pipe into which nothing is written; give a file");
  std::thread writer([&] { write_file(pipe, "model"); });
  const auto read = cli::read_file(pipe, 100, std::chrono::minutes(10));
  writer.join();
  REQUIRE(read);
  CHECK(*read == "model");
}

TEST_CASE("whoever else may write in the folder leads no file elsewhere", "[cli][output]") {
  const TempFolder temp;
  write_file(temp / "secret", "kept");
  auto out = testing::value(OutputFolder::open(temp / "out"));
  // The place aside, and later that of the files, becomes a folder of links.
  fs::rename(temp / "out/.popcut-aside", temp / "out/moved");
  fs::create_directory(temp / "out/.popcut-aside");
  for (const char* name : {"report.json", "manifest.json"})
    fs::create_symlink(temp / "secret", temp / "out/.popcut-aside" / name);
  fs::create_symlink(temp / "secret", temp / "out/report.json");
  REQUIRE(out.add("report.json", "{}"));
  REQUIRE(out.commit("test run"));
  CHECK(text_of_file(temp / "secret") == "kept");
  CHECK(fs::symlink_status(temp / "out/report.json").type() == fs::file_type::regular);
  CHECK(text_of_file(temp / "out/report.json") == "{}");
  // And one file by itself.
  fs::create_symlink(temp / "secret", temp / ("one.part-" + std::to_string(::getpid())));
  REQUIRE(cli::write_whole_file(temp / "one", [](std::ostream& file) { file << "new"; }));
  CHECK(text_of_file(temp / "secret") == "kept");
  CHECK(text_of_file(temp / "one") == "new");
}

TEST_CASE("a signal that ends the program leaves nothing aside and no new folder",
          "[cli][output]") {
  const TempFolder temp;
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  fs::create_directory(temp / "there");
  std::array<int, 2> ready{};
  REQUIRE(::pipe(ready.data()) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(signal, SIG_DFL);
    auto one = OutputFolder::open(temp / "there"), other = OutputFolder::open(temp / "new/deep");
    const bool added = one && other && one->add("a/b", "text") && other->add("c", "text");
    if (!added || ::write(ready[1], "x", 1) != 1) ::_exit(3);
    for (;;) ::pause();
  }
  char byte = 0;
  CHECK(::read(ready[0], &byte, 1) == 1);
  ::kill(child, signal);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK((WIFSIGNALED(status) && WTERMSIG(status) == signal));
  CHECK(fs::is_empty(temp / "there"));
  CHECK_FALSE(fs::exists(temp / "new"));
  for (const int end : ready) ::close(end);
}

TEST_CASE("a file that another one names lies in its folder and is reached through no link",
          "[cli][files]") {
  const TempFolder temp;
  fs::create_directories(temp / "model/maps");
  write_file(temp / "secret.png", "secret");
  write_file(temp / "model/a.png", "a");
  write_file(temp / "model/maps/b.png", "b");
  fs::create_symlink(temp / "secret.png", temp / "model/link.png");
  fs::create_directory_symlink(temp.path(), temp / "model/up");
  REQUIRE(::mkfifo((temp / "model/pipe").c_str(), 0600) == 0);
  const fs::path model = temp / "model/x.mtl";
  CHECK(cli::read_beside(model, "a.png").value() == "a");
  CHECK(cli::read_beside(model, "./maps/../maps/b.png").value() == "b");
  const auto why = [&](const std::string& name) {
    const auto read = cli::read_beside(model, name);
    CAPTURE(name);
    REQUIRE_FALSE(read);
    CHECK(read.error().kind == ErrorKind::Malformed);
    return read.error().detail;
  };
  for (const std::string& name :
       {std::string("../secret.png"), std::string("maps/../../secret.png"),
        (temp / "secret.png").string(), std::string("/proc/kmsg"), std::string("..")})
    CHECK(why(name).find("outside of the folder of x.mtl") != std::string::npos);
  CHECK(why("link.png").find("is a link") != std::string::npos);
  CHECK(why("up/secret.png").find("reached through") != std::string::npos);
  CHECK(why("pipe").find("is not a file") != std::string::npos);
  CHECK(why("maps").find("is not a file") != std::string::npos);
  CHECK(why("absent").find("is not a file") != std::string::npos);
}

}  // namespace output_folder_test
