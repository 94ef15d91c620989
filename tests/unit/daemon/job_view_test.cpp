// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "daemon/cli/help/terminal_text.hpp"
#include "daemon/cli/view/job_view.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/cli/view/progress_bar.hpp"

namespace job_view_test {

using namespace popcut::cli;
using Json = nlohmann::json;

namespace {

Json job(const std::string& state) {
  return {{"id", "01JDX7KQ4M8ZB1Q2R3S4T5V6W7"},
          {"name", "sphere"},
          {"state", state},
          {"device", "sim:cameo3"},
          {"sheet", 2},
          {"sheets_total", 3},
          {"blank", 1},
          {"reason", nullptr},
          {"progress", {{"paths_certain", 30}, {"paths_sent", 50}, {"paths_total", 200}}},
          {"est", {{"remaining_s", {60.0, 80.0}}}},
          {"actions", Json::array()}};
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace

TEST_CASE("each thing that waits for a person comes with the command to type", "[cli][jobs]") {
  Json ready = job("ready");
  ready["actions"] = {"arm", "cancel"};
  CHECK(joined(waiting_for(ready)) ==
        "load sheet 2 of 3 into sim:cameo3: popcut arm 01JDX7KQ4M8Z 2\n");
  ready["blank"] = 2;
  CHECK(joined(waiting_for(ready)).find("blank 2") != std::string::npos);
  Json elsewhere = ready;
  elsewhere["device"] = nullptr;
  elsewhere["site"] = "upstairs";
  CHECK(joined(waiting_for(elsewhere)).find("load sheet 2 of 3 at upstairs, ") == 0);
  CHECK(job_summary(elsewhere) == "ready, sheet 2 of 3, at upstairs");
  CHECK(joined(waiting_for(job("armed"))).find("popcut start 01JDX7KQ4M8Z") != std::string::npos);
  CHECK(waiting_for(job("paused")).empty());  // its cancel is under way
  Json paused = job("paused");
  paused["actions"] = {"resume", "cancel"};
  CHECK(joined(waiting_for(paused)).find("popcut resume") != std::string::npos);
  Json interrupted = job("interrupted");
  interrupted["actions"] = {"retry-sheet", "resume-from", "confirm-result", "cancel"};
  interrupted["reason"] = "unplug";
  const std::string ways = joined(waiting_for(interrupted));
  CHECK(ways.find("interrupted by unplug; 30 paths are certainly cut, 20 more are in doubt") !=
        std::string::npos);
  for (const char* way :
       {"popcut retry 01JDX7KQ4M8Z 2", "popcut jobs 01JDX7KQ4M8Z  ", "good", "popcut cancel"})
    CHECK(ways.find(way) != std::string::npos);
  interrupted["actions"] = {"retry-sheet", "cancel"};
  CHECK(joined(waiting_for(interrupted)).find("good") == std::string::npos);
  CHECK(waiting_for(job("cutting")).empty());
  CHECK(waiting_for(job("queued")).empty());
  Json absent = job("ready");
  absent["attention"] = {{"kind", "device_absent"}, {"text", "plug it in"}};
  CHECK(joined(waiting_for(absent)) == "plug it in\n");
}

TEST_CASE("the live view has running knives first and shows how far they are", "[cli][jobs]") {
  Json done = job("done"), ready = job("ready");
  ready["actions"] = {"arm"};
  const auto lines = jobs_view({job("queued"), done, ready, job("cutting")}, {});
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].find("cutting") != std::string::npos);
  CHECK(lines[0].find("[####............]  25 %  1:20 left") != std::string::npos);
  CHECK(lines[1].find("ready") != std::string::npos);
  CHECK(lines[2].find("-> load sheet") != std::string::npos);
  CHECK(lines[3].find("queued") != std::string::npos);
  CHECK(lines[4].find("done") != std::string::npos);
}

TEST_CASE("the view survives any input", "[cli][jobs]") {
  Json odd = job("ready");
  odd["name"] =
      "\x1b[31mred\x07\xc2\x9b"
      "2J\xe2\x80\xaegnp\xe2\x81\xa6";
  odd["sheet"] = "two";
  odd["progress"] = 7;
  odd["est"] = {{"remaining_s", "soon"}};
  odd["actions"] = "arm";
  odd["attention"] = Json::array();
  const std::string text = joined(jobs_view({odd, Json::object(), Json(3)}, {}));
  CHECK(text.find('\x1b') == std::string::npos);
  CHECK(text.find('\x07') == std::string::npos);
  CHECK(text.find("\xc2\x9b") == std::string::npos);
  CHECK(text.find("\xe2\x80\xae") == std::string::npos);
  CHECK(text.find("\xe2\x81\xa6") == std::string::npos);
  CHECK_FALSE(job_details(odd, {Json::object()}).empty());
  Json wide = job("cutting");
  wide["name"] = "\xC3\xA9\xC3\xA9\xC3\xA9";
  for (const std::string& line : jobs_view({wide}, {15, false})) CHECK(line.size() <= 18);
}

TEST_CASE("a resumed sheet is shown with the advice to leave it in place", "[cli][jobs]") {
  Json again = job("ready");
  again["actions"] = {"arm"};
  again["segment"] = 2;
  again["attention"] = {{"kind", "load_sheet"}, {"text", "leave sheet 2 of 3 where it is"}};
  CHECK(joined(waiting_for(again)) ==
        "leave sheet 2 of 3 where it is: popcut arm 01JDX7KQ4M8Z 2\n");
  again["actions"] = {"resume-from", "retry-sheet"};  // its place is not known any more
  CHECK(joined(waiting_for(again)) ==
        "leave sheet 2 of 3 where it is\n"
        "  popcut jobs 01JDX7KQ4M8Z                 # shows how to continue this sheet\n"
        "  popcut retry 01JDX7KQ4M8Z 2              # cut it again on a new sheet\n");
  again["ways"] = {
      {{"action", "resume-from"},
       {"body", {{"from_path", 6}, {"registration", "kept"}, {"skip_in_doubt", true}}}},
      {{"action", "resume-from"},
       {"body", {{"from_path", 4}, {"registration", "kept"}, {"i_accept_double_cut", true}}}}};
  const std::string both = joined(waiting_for(again));
  CHECK(both.find("popcut resume 01JDX7KQ4M8Z --from 6 --skip-in-doubt   # continue this sheet, "
                  "skips what is in doubt") != std::string::npos);
  CHECK(both.find("popcut resume 01JDX7KQ4M8Z --from 4 --accept-double-cut   # continue this "
                  "sheet, cuts again what may be cut already") != std::string::npos);
  again["actions"] = {"arm"};
  again["segment"] = 1;
  CHECK(joined(waiting_for(again)).find("load sheet 2 of 3 into sim:cameo3") == 0);
}

TEST_CASE("no command to type is cut off where the terminal is narrow", "[cli][jobs]") {
  Json interrupted = job("interrupted"), ready = job("ready"), cutting = job("cutting");
  interrupted["actions"] = {"retry-sheet", "resume-from", "confirm-result", "cancel"};
  ready["actions"] = {"arm"};
  cutting["name"] = "\xE5\x90\x8D\xE5\x89\x8D\xE5\x90\x8D\xE5\x89\x8D";  // two columns each
  for (const std::size_t width : {30u, 40u, 60u, 80u, 120u}) {
    CAPTURE(width);
    const auto lines = jobs_view({interrupted, ready, cutting}, {width, false});
    std::string text;
    for (const std::string& line : lines) {
      CAPTURE(line);
      CHECK(columns_of(line) <= width);
      CHECK(line.find_last_not_of(' ') + 1 == line.size());
      text += line.substr(line.find_first_not_of(' ')) + " ";
    }
    for (const char* part : {"popcut arm 01JDX7KQ4M8Z 2", "popcut retry 01JDX7KQ4M8Z 2",
                             "popcut jobs 01JDX7KQ4M8Z", "25 %", "1:20 left"})
      CHECK(text.find(part) != std::string::npos);
    if (width >= 40) {
      const auto whole = [](const std::string& line) {
        return line.find("popcut arm 01JDX7KQ4M8Z 2") != std::string::npos;
      };
      CHECK(std::any_of(lines.begin(), lines.end(), whole));  // in one line, to be copied
    }
  }
}

TEST_CASE("the ways out of an interruption are listed one per line", "[cli][jobs]") {
  Json interrupted = job("interrupted");
  interrupted["actions"] = {"retry-sheet", "resume-from", "confirm-result", "cancel"};
  const auto lines = waiting_lines(waiting_for(interrupted), 2);
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].rfind("  -> sheet 2", 0) == 0);
  for (std::size_t k = 1; k < lines.size(); ++k) {
    CAPTURE(lines[k]);
    CHECK(lines[k].rfind("       popcut ", 0) == 0);
    CHECK(lines[k].find('#') == lines[1].find('#'));
  }
}

TEST_CASE("in a window that is too narrow for both a comment follows its command", "[cli][jobs]") {
  Json interrupted = job("interrupted");
  interrupted["actions"] = {"retry-sheet", "cancel"};
  const std::string wide = joined(jobs_view({interrupted}, {120, false}));
  CHECK(wide.find("popcut retry 01JDX7KQ4M8Z 2              # cut it again on a new sheet\n") !=
        std::string::npos);
  const std::string apart =
      "         popcut retry 01JDX7KQ4M8Z 2\n           # cut it again on a new sheet\n";
  CHECK(joined(jobs_view({interrupted}, {60, false})).find(apart) != std::string::npos);
  CHECK(joined(job_details(interrupted, {}, std::nullopt, 60)).find(apart.substr(4, 32)) !=
        std::string::npos);
}

TEST_CASE("a sheet that was not sent completely cannot be confirmed as complete", "[cli][jobs]") {
  Json interrupted = job("interrupted");
  interrupted["actions"] = {"retry-sheet", "confirm-result", "cancel"};
  const Json unsent{{"certain", {{0, 29}}}, {"not_sent", {{30, 199}}}};
  CHECK(joined(job_details(interrupted, {}, unsent)).find(" good") == std::string::npos);
  CHECK(joined(job_details(interrupted, {}, Json{{"certain", {{0, 199}}}})).find(" good") !=
        std::string::npos);
  // Of several sheets the figures of the job do not tell; of one they do.
  CHECK(joined(waiting_for(interrupted)).find(" good") != std::string::npos);
  interrupted["sheets_total"] = interrupted["sheet"] = 1;
  CHECK(joined(waiting_for(interrupted)).find(" good") == std::string::npos);
  interrupted["progress"]["paths_sent"] = 200;
  CHECK(joined(waiting_for(interrupted)).find(" good") != std::string::npos);
}

TEST_CASE("a reason that implies the state replaces it", "[cli][jobs]") {
  Json ended = job("cancelled");
  ended["reason"] = "cancelled by uid:0";
  CHECK(job_summary(ended) == "cancelled by uid:0");
  ended["reason"] = "wrong colour";
  CHECK(job_summary(ended) == "cancelled, wrong colour");
}

TEST_CASE("a cancelled job shows no sheet as being cut", "[cli][jobs]") {
  const std::vector<Json> sheets{{{"sheet", 1}, {"state", "done"}},
                                 {{"sheet", 2}, {"state", "cutting"}},
                                 {{"sheet", 3}, {"state", "waiting"}}};
  const std::string ended = joined(job_details(job("cancelled"), sheets));
  CHECK(ended.find("sheet 1    done") != std::string::npos);
  CHECK(ended.find("sheet 2    not finished") != std::string::npos);
  CHECK(ended.find("sheet 3    not cut") != std::string::npos);
  const std::string going = joined(job_details(job("cutting"), sheets));
  CHECK(going.find("sheet 2    cutting") != std::string::npos);
  CHECK(going.find("sheet 3    waiting") != std::string::npos);
}

TEST_CASE("a job says what it takes to fold by hand", "[cli][jobs]") {
  Json one = job("ready");
  CHECK(joined(job_details(one, {})).find("by hand") == std::string::npos);
  one["handwork"] = {{"folds", 19}, {"shortest_fold_mm", 6}, {"fold_s", 600}, {"label", "easy"}};
  CHECK(joined(job_details(one, {}))
            .find("by hand    19 folds, the shortest 6 mm; about 10 minutes "
                  "to fold (easy)") != std::string::npos);
  one["handwork"] = {{"folds", "many"}};
  CHECK(joined(job_details(one, {})).find("by hand") == std::string::npos);
}

TEST_CASE("a priority is shown where a job has one", "[cli][jobs]") {
  Json urgent = job("queued");
  CHECK(joined(jobs_view({urgent}, {})).find("priority") == std::string::npos);
  urgent["priority"] = 7;
  CHECK(joined(jobs_view({urgent}, {})).find("priority 7") != std::string::npos);
  CHECK(joined(job_details(urgent, {})).find("priority   7") != std::string::npos);
}

TEST_CASE("the width of a line is that on a terminal", "[cli]") {
  CHECK(columns_of("abc") == 3);
  CHECK(columns_of("\xC3\xA9") == 1);
  CHECK(columns_of("e\xCC\x81") == 1);         // a mark on the letter before
  CHECK(columns_of("\xE5\x90\x8D") == 2);      // CJK
  CHECK(columns_of("\xF0\x9F\x98\x80") == 2);  // emoji
  CHECK(columns_of("\xFF\xC3") == 2);          // no UTF-8
  CHECK(fitted("a\xE5\x90\x8D", 2) == "a");
  CHECK(padded("\xE5\x90\x8D", 4) == "\xE5\x90\x8D  ");
  CHECK(padded("abcdef", 4) == "abcd");
  CHECK(wrapped("short", 10, 2) == std::vector<std::string>{"short"});
  CHECK(wrapped("one two three", 7, 2) == std::vector<std::string>{"one two", "  three"});
  CHECK(wrapped("abcdefghij", 4, 1) == std::vector<std::string>{"abcd", " efg", " hij"});
  for (std::size_t width = 0; width < 6; ++width)
    CHECK_FALSE(wrapped("\xE5\x90\x8D\xE5\x90\x8D x", width, 2).empty());
}

TEST_CASE("off a terminal nobody is told how far long work is", "[cli][progress]") {
  const int kept = ::dup(STDERR_FILENO), null = ::open("/dev/null", O_WRONLY);
  REQUIRE(kept >= 0);
  REQUIRE(::dup2(null, STDERR_FILENO) == STDERR_FILENO);
  {
    LongWork work(true, "designing");
    CHECK_FALSE(work.progress());  // so that those who compute call nothing
    work.now("writing", 0.5);
  }
  CHECK(::dup2(kept, STDERR_FILENO) == STDERR_FILENO);
  ::close(kept);
  ::close(null);
}

TEST_CASE("a line of what takes an unknown time keeps to the width of the terminal", "[cli]") {
  CHECK(time_line("designing", 94.9) == "designing, 1:34 so far");
  for (std::size_t width = 4; width < 80; ++width) {
    const std::string line = time_line("laying the lattice: conformal", 94, width);
    CAPTURE(width, line);
    CHECK(columns_of(line) <= width);
    if (width >= 14) CHECK(line.find("1:34 so far") != std::string::npos);
  }
}

TEST_CASE("a progress line keeps to the width of the terminal", "[cli]") {
  const std::string what = "cutting, sheet 1 of 1, path 11 of 378, on sim:cameo3";
  CHECK(progress_line("planning", 0.5, 61) == "[############............] planning, 1:01 left");
  for (std::size_t width = 4; width < 120; ++width) {
    CAPTURE(width);
    const std::string line = progress_line(what, 0.5, 229, width);
    CHECK(columns_of(line) <= width);
    if (width >= 10) CHECK(line.find("3:49 left") != std::string::npos);
    CHECK(line.find(", ,") == std::string::npos);
    CHECK(line.find(",,") == std::string::npos);
    if (width >= 80) CHECK(line.find(what) != std::string::npos);
  }
}

TEST_CASE("a person is shown by name if this computer knows it", "[cli][jobs]") {
  CHECK(person_name("token:workshop") == "token:workshop");
  CHECK(person_name("uid:") == "uid:");
  CHECK(person_name("uid:1x") == "uid:1x");
  CHECK(person_name("uid:99999999999999") == "uid:99999999999999");
  const passwd* const me = ::getpwuid(::getuid());
  const std::string id = "uid:" + std::to_string(::getuid());
  CHECK(person_name(id) == (me == nullptr ? id : std::string(me->pw_name) + " (" + id + ")"));
}

}  // namespace job_view_test
