// SPDX-License-Identifier: MIT
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/devices/make_cutters.hpp"
#include "device/sim/sim_pty.hpp"
#include "tests/support/process.hpp"
#include "tests/support/received_log.hpp"
#include "tests/support/sim_bench.hpp"
#include "tests/support/timing.hpp"

namespace cutters_test {

using namespace popcut;
using namespace popcut::testing;
using daemon::Cutters;
using daemon::DeviceConfig;
using std::chrono::steady_clock;

namespace {

/// A journal that keeps what it is told, and may be made to fail, to block, or to ask for things.
class Journal final : public daemon::CutJournal {
 public:
  Result<void> intend(std::int64_t last) override {
    const auto stands = [&] { return blocked || last >= stands_from; };
    if (stands()) {
      waiting = true;
      while (stands()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      waiting = false;
    }
    if (last >= fails_from) return fail(ErrorKind::Unwritable, "", "the disk is full");
    intended = last;
    return {};
  }
  Result<void> settle(std::int64_t sure, std::int64_t got, std::uint64_t) override {
    certain = sure;
    taken = got;
    return {};
  }
  void progress(const SessionProgress& p) override {
    strokes_done = p.strokes_done;
    held = p.phase == SessionPhase::Held;
  }
  void ended(const SessionEnd& last) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(slow_end_ms));
    end = last;
    ++ends;
  }

  std::atomic<std::int64_t> intended{-1}, certain{-1}, taken{-1}, fails_from{1 << 30};
  std::atomic<std::int64_t> stands_from{1 << 30};  ///< who intends this stroke waits meanwhile
  std::atomic<int> slow_end_ms{0};
  std::atomic<std::uint64_t> strokes_done{};
  std::atomic<bool> held{false}, blocked{false}, waiting{false};
  std::atomic<int> ends{0};
  SessionEnd end;
};

struct Bench {
  TempFolder temp;
  std::unique_ptr<Cutters> cutters;
  std::atomic<int> changes{0};
  EncodedProgram program;
  std::size_t strokes{};  ///< that are sent

  explicit Bench(std::vector<DeviceConfig> devices, const char* model = "cameo3",
                 double session_stuck_s = 5) {
    std::mt19937 random(5);
    const Material paper = value(find_material("paper-220"));
    const Toolpath path = random_toolpath(random, 80, 190, paper);
    JobOptions job;
    job.page_length_mm = 300;
    program = value(encode(path, machine(model), paper, job));
    strokes = program.strokes.size() - program.dots.size();
    daemon::CuttersOptions options;
    options.devices = std::move(devices);
    options.usb = false;
    options.stuck_s = 0.7;
    options.session.stuck_s = session_stuck_s;
    auto made = daemon::make_cutters(std::move(options));
    INFO((made ? std::string() : message(made.error())));
    REQUIRE(made);
    cutters = std::move(*made);
    cutters->on_change([this] { ++changes; });
  }
  ~Bench() { cutters.reset(); }  // before what it tells goes
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  Result<void> cut(const std::string& device, const std::shared_ptr<Journal>& journal,
                   std::int64_t first = 0) const {
    return cutters->cut({"A1", device, program, {304.8, 300}, first}, journal);
  }
  [[nodiscard]] daemon::DeviceRecord record(std::size_t k = 0) const {
    return cutters->list().at(k);
  }
  /// Cuts and waits for the end.
  [[nodiscard]] SessionEnd cut_all(const std::string& device) const {
    const auto journal = std::make_shared<Journal>();
    const auto taken = cut(device, journal);
    INFO((taken ? std::string() : message(taken.error())));
    REQUIRE(taken);
    REQUIRE(comes_true([&] { return journal->ends == 1; }));
    return journal->end;
  }
};

}  // namespace

TEST_CASE("without a configuration there is one simulated cutter that cuts", "[daemon][cutters]") {
  Bench bench({});
  REQUIRE(bench.cutters->list().size() == 1);
  const auto record = bench.record();
  CHECK(record.id == "sim:cameo3");
  CHECK(record.model == "cameo3");
  CHECK(record.state == "idle");
  CHECK(record.simulated);
  CHECK(record.enabled);
  CHECK(record.width_mm >= 304.8);
  CHECK(value(bench.cutters->machine("sim:cameo3")).name == "cameo3");
  CHECK(bench.cutters->machine("sim:cameo4").error().kind == ErrorKind::DeviceGone);
  CHECK(bench.cut("sim:nowhere", std::make_shared<Journal>()).error().kind ==
        ErrorKind::DeviceGone);
}

TEST_CASE("on a virtual clock a cut ends at once and all of it is certain", "[daemon][cutters]") {
  TempFolder temp;
  Bench bench({{.id = "sim:left",
                .machine = "cameo3",
                .time_scale = 0,
                .trace = (temp / "trace").string()}});
  const auto journal = std::make_shared<Journal>();
  REQUIRE(bench.cut("sim:left", journal));
  REQUIRE(comes_true([&] { return journal->ends == 1; }));
  CHECK_FALSE(journal->end.error);
  CHECK(journal->end.confirmed);
  CHECK(count(journal->end, StrokeFate::Certain) == bench.strokes);
  CHECK(journal->intended + 1 == static_cast<std::int64_t>(bench.program.strokes.size()));
  CHECK(journal->certain == journal->intended);
  CHECK(bench.record().state == "idle");
  CHECK(bench.record().sheets_done == 1);
  CHECK_FALSE(bench.record().firmware.empty());
  CHECK(comes_true([&] { return bench.changes >= 2; }));  // busy, and idle again
  // What the cutter got and did is kept.
  const auto trace = nlohmann::json::parse(text_of_file(temp / "trace/A1.json"));
  CHECK(trace["lifts"] == bench.strokes);
  const std::string received = text_of_file(temp / "trace/received.log");
  CHECK(received.rfind("open A1\n", 0) == 0);
  CHECK(received.size() > 2 * bench.program.bytes.size());
  // From a stroke on.
  const auto rest = std::make_shared<Journal>();
  REQUIRE(bench.cut("sim:left", rest, 60));
  REQUIRE(comes_true([&] { return rest->ends == 1; }));
  CHECK_FALSE(rest->end.error);
  CHECK(count(rest->end, StrokeFate::NotSent) >= 60);
  CHECK(rest->end.fates.size() == bench.program.strokes.size());
}

TEST_CASE("a paced cutter runs in real time and obeys pause and resume and stop",
          "[daemon][cutters]") {
  constexpr double kScale = 60;  // a stall of the computer counts so many times for the session
  Bench bench(
      {{.id = "sim:cameo3", .time_scale = 0}, {.id = "sim:portrait", .time_scale = kScale}});
  const double virtual_s = bench.cut_all("sim:cameo3").seconds;
  Bench slow({{.id = "sim:cameo3", .time_scale = kScale}}, "cameo3", 30 * kScale);
  const auto begun = steady_clock::now();
  const auto journal = std::make_shared<Journal>();
  journal->stands_from = 10;  // until it is told to pause
  REQUIRE(slow.cut("sim:cameo3", journal));
  REQUIRE(comes_true([&] { return journal->waiting.load(); }));
  CHECK(slow.record().state == "busy");
  CHECK(slow.cut("sim:cameo3", std::make_shared<Journal>()).error().kind == ErrorKind::Refused);
  CHECK(slow.cutters->reset("sim:cameo3").error().kind == ErrorKind::Refused);
  slow.cutters->pause("sim:cameo3");
  journal->stands_from = 1 << 30;
  REQUIRE(comes_true([&] { return journal->held.load(); }));
  REQUIRE(comes_true([&] { return journal->certain == journal->taken; }));
  const auto at_rest = journal->taken.load();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // 12 s of the machine
  CHECK(journal->taken == at_rest);
  CHECK(comes_true([&] { return slow.cutters->alive(); }));
  CHECK(slow.record().state == "busy");
  slow.cutters->resume("sim:cameo3");
  REQUIRE(comes_true([&] { return journal->ends == 1; }));
  const double took = std::chrono::duration<double>(steady_clock::now() - begun).count();
  CHECK_FALSE(journal->end.error);
  CHECK(count(journal->end, StrokeFate::Certain) == slow.strokes);
  CHECK(took > 0.8 * virtual_s / kScale);
  CHECK(journal->end.seconds > virtual_s);
  // Cancelled: at the end of a stroke, parked, the rest not sent.
  const auto second = std::make_shared<Journal>();
  second->stands_from = 10;
  REQUIRE(slow.cut("sim:cameo3", second));
  REQUIRE(comes_true([&] { return second->waiting.load(); }));
  slow.cutters->cancel("sim:cameo3");
  second->stands_from = 1 << 30;
  REQUIRE(comes_true([&] { return second->ends == 1; }));
  CHECK(second->end.cancelled);
  CHECK_FALSE(second->end.error);
  CHECK(count(second->end, StrokeFate::InDoubt) == 0);
  CHECK(count(second->end, StrokeFate::NotSent) > 20);
  CHECK(slow.record().state == "idle");
}

TEST_CASE("each cutter has its own thread and stopping all ends every cut", "[daemon][cutters]") {
  Bench bench({{.id = "sim:a", .machine = "cameo3", .time_scale = 20},
               {.id = "sim:b", .machine = "cameo3", .time_scale = 20}});
  const auto a = std::make_shared<Journal>(), b = std::make_shared<Journal>();
  b->slow_end_ms = 300;  // to be written down is a part of the end
  REQUIRE(bench.cut("sim:a", a));
  REQUIRE(bench.cut("sim:b", b));
  REQUIRE(comes_true([&] { return a->strokes_done >= 3 && b->strokes_done >= 3; }));
  bench.cutters->stop_all(60);
  CHECK(a->ends == 1);
  CHECK(b->ends == 1);
  CHECK(a->end.cancelled);
  CHECK(b->end.cancelled);
  CHECK(bench.cut("sim:a", a).error().kind == ErrorKind::Refused);
  // Without time to wait it does not wait.
  Bench other({{.id = "sim:a", .machine = "cameo3", .time_scale = 1}});
  const auto c = std::make_shared<Journal>();
  REQUIRE(other.cut("sim:a", c));
  other.cutters->stop_all(0.05);
  CHECK(c->ends == 1);
  CHECK(count(c->end, StrokeFate::NotSent) > 20);
}

TEST_CASE("a stroke that outlasts the stop timeout is abandoned with the tool up",
          "[daemon][cutters][faults]") {
  TempFolder temp;
  // Slower than the machine: what is sent ahead takes longer than this test waits. The Portrait has
  // no blade to set.
  Bench bench({{.id = "sim:slow",
                .machine = "portrait",
                .time_scale = 0.4,
                .trace = (temp / "trace").string()}},
              "portrait");
  const auto journal = std::make_shared<Journal>();
  REQUIRE(bench.cut("sim:slow", journal));
  REQUIRE(comes_true([&] { return journal->taken >= 0 || journal->intended >= 0; }));
  bench.cutters->stop_all(0.3);
  REQUIRE(journal->ends == 1);
  CHECK(journal->end.cancelled);
  REQUIRE(journal->end.error);
  INFO(journal->end.error->detail);
  // What was sent ends with the trailer, which lifts and parks the tool.
  const auto log = received_log(temp / "trace/received.log");
  REQUIRE(log.size() == 1);
  const auto trailer = bench.program.view(bench.program.trailer);
  REQUIRE(log[0].bytes.size() > trailer.size());
  CHECK(std::equal(trailer.begin(), trailer.end(),
                   log[0].bytes.end() - static_cast<std::ptrdiff_t>(trailer.size())));
  const std::size_t begun_strokes = places_cut(log[0].bytes, machine("portrait")).size();
  CHECK(begun_strokes <= bench.strokes - count(journal->end, StrokeFate::NotSent));
  CHECK(count(journal->end, StrokeFate::NotSent) > 20);
}

TEST_CASE("a cutter that is removed while it cuts ends its stroke first", "[daemon][cutters]") {
  const auto journal = std::make_shared<Journal>();
  {
    Bench bench({{.id = "sim:cameo3", .time_scale = 20}});
    REQUIRE(bench.cut("sim:cameo3", journal));
    REQUIRE(comes_true([&] { return journal->strokes_done >= 3; }));
  }
  CHECK(journal->ends == 1);
  CHECK(journal->end.cancelled);
  CHECK(count(journal->end, StrokeFate::InDoubt) == 0);
}

TEST_CASE("after a fault a cutter waits for a reset and nothing starts by itself",
          "[daemon][cutters]") {
  TempFolder temp;
  const auto script = [&](const std::string& kind, const std::string& more) {
    write_file(temp / "faults.json", R"j({"popcut": 1, "faults": [{"at_byte": 600, "kind": ")j" +
                                         kind + "\"" + more + "}]}");
    return DeviceConfig{
        .id = "sim:cameo3", .time_scale = 0, .faults = (temp / "faults.json").string()};
  };
  const struct {
    const char *kind, *more, *state;
    ErrorKind error;
    ErrorReason reason;
    const char* counted;  ///< among the errors of its line
  } cases[] = {
      {"unplug", "", "fault", ErrorKind::DeviceGone, ErrorReason::None, "nodev"},
      {"nak", R"(, "seconds": 4000)", "fault", ErrorKind::Timeout, ErrorReason::None, "timeout"},
      {"stall", "", "fault", ErrorKind::Refused, ErrorReason::Stalled, "stall"},
      {"media out", "", "attention", ErrorKind::Refused, ErrorReason::NoMedia, nullptr},
      {"cancel", R"(, "seconds": 1)", "attention", ErrorKind::Refused, ErrorReason::PanelStop,
       nullptr}};
  for (const auto& wrong : cases) {
    CAPTURE(wrong.kind);
    Bench bench({script(wrong.kind, wrong.more)});
    const SessionEnd end = bench.cut_all("sim:cameo3");
    REQUIRE(end.error);
    CHECK(end.error->kind == wrong.error);
    CHECK(end.error->reason == wrong.reason);
    if (wrong.counted != nullptr)
      CHECK(bench.cutters->metrics().find(
                fmt::format("popcut_usb_errors_total{{device=\"sim:cameo3\",kind=\"{}\"}} 1\n",
                            wrong.counted)) != std::string::npos);
    CHECK(bench.record().state == wrong.state);
    REQUIRE(bench.record().reasons.size() == 1);
    CHECK(bench.record().reasons[0] == end.error->detail);
    CHECK(bench.cutters->alive());
    if (wrong.state == std::string("fault")) {
      const auto refused = bench.cut("sim:cameo3", std::make_shared<Journal>());
      CHECK(refused.error().kind == ErrorKind::Refused);
      CHECK(refused.error().detail.find("reset") != std::string::npos);
      REQUIRE(bench.cutters->reset("sim:cameo3"));
      CHECK(bench.record().state == "idle");
    }
    // The script is of the first cut only.
    CHECK_FALSE(bench.cut_all("sim:cameo3").error);
    CHECK(bench.record().state == "idle");
    CHECK(bench.record().reasons.empty());
  }
}

TEST_CASE("a failing journal ends the cut without blaming the cutter", "[daemon][cutters]") {
  Bench bench({{.id = "sim:cameo3", .time_scale = 0}});
  const auto journal = std::make_shared<Journal>();
  journal->fails_from = 30;
  REQUIRE(bench.cut("sim:cameo3", journal));
  REQUIRE(comes_true([&] { return journal->ends == 1; }));
  REQUIRE(journal->end.error);
  CHECK(journal->end.error->kind == ErrorKind::Unwritable);
  CHECK(count(journal->end, StrokeFate::InDoubt) == 0);
  CHECK(count(journal->end, StrokeFate::NotSent) >= 50);
  CHECK(bench.record().state == "idle");
  CHECK_FALSE(bench.cut_all("sim:cameo3").error);
}

TEST_CASE("a cutter whose journal never returns counts as not alive", "[daemon][cutters]") {
  Bench bench({{.id = "sim:cameo3", .time_scale = 0}});
  const auto journal = std::make_shared<Journal>();
  journal->blocked = true;
  REQUIRE(bench.cut("sim:cameo3", journal));
  REQUIRE(comes_true([&] { return journal->waiting.load(); }));
  CHECK(comes_true([&] { return !bench.cutters->alive(); }));
  journal->blocked = false;
  REQUIRE(comes_true([&] { return journal->ends == 1; }));
  CHECK(comes_true([&] { return bench.cutters->alive(); }));
}

TEST_CASE("a configured port is absent until it appears and then it can cut", "[daemon][cutters]") {
  TempFolder temp;
  const std::string port = (temp / "port").string();
  Bench bench({{.id = "serial:" + port, .machine = "cameo3"}});
  CHECK(bench.record().state == "absent");
  CHECK(bench.cut("serial:" + port, std::make_shared<Journal>()).error().kind ==
        ErrorKind::DeviceGone);
  CHECK(bench.cutters->reset("serial:" + port).error().kind == ErrorKind::DeviceGone);
  write_file(port, "");
  CHECK(comes_true([&] { return bench.record().state == "idle"; }));
  // It is no serial port, which only shows when it is opened.
  const SessionEnd end = bench.cut_all("serial:" + port);
  REQUIRE(end.error);
  CHECK(count(end, StrokeFate::NotSent) == bench.program.strokes.size());
  std::filesystem::remove(port);
  CHECK(comes_true([&] { return bench.record().state == "absent"; }));
  CHECK(comes_true([&] { return bench.changes >= 4; }));
}

TEST_CASE("a trace goes through no link and into no file that is there already",
          "[daemon][cutters][links]") {
  TempFolder temp;
  const std::filesystem::path trace = temp / "trace", precious = temp / "elsewhere/precious";
  std::filesystem::create_directory(temp / "elsewhere");
  std::filesystem::create_directory(trace);
  write_file(precious, "mine");
  const std::vector<DeviceConfig> devices{
      {.id = "sim:cameo3", .time_scale = 0, .trace = trace.string()}};
  const auto untouched = [&] {
    return text_of_file(precious) == "mine" && files_below(temp / "elsewhere").size() == 1;
  };
  {
    // Links at both names.
    std::filesystem::create_symlink(precious, trace / "received.log");
    std::filesystem::create_symlink(temp / "elsewhere/fresh", trace / "A1.json");
    const Bench bench(devices);
    CHECK(bench.cut_all("sim:cameo3").confirmed);
    CHECK(untouched());
  }
  {
    // A second name of another's file, and a trace that is there already.
    std::filesystem::remove(trace / "received.log");
    std::filesystem::create_hard_link(precious, trace / "received.log");
    std::filesystem::remove(trace / "A1.json");
    write_file(trace / "A1.json", "earlier");
    const Bench bench(devices);
    CHECK(bench.cut_all("sim:cameo3").confirmed);
    CHECK(text_of_file(trace / "A1.json") == "earlier");
    CHECK(untouched());
    std::filesystem::remove(trace / "received.log");
    std::filesystem::remove(trace / "A1.json");
  }
  {
    // A link takes the folder's place once popcutd has looked at it.
    const Bench bench(devices);
    std::filesystem::rename(trace, temp / "moved");
    std::filesystem::create_directory_symlink(temp / "elsewhere", trace);
    CHECK(bench.cut_all("sim:cameo3").confirmed);
    CHECK(untouched());
    CHECK(std::filesystem::exists(temp / "moved/A1.json"));
  }
  // And one that is a link from the start is refused.
  daemon::CuttersOptions options;
  options.devices = devices;
  options.usb = false;
  const auto made = daemon::make_cutters(std::move(options));
  REQUIRE_FALSE(made);
  CHECK(message(made.error()) == trace.string() + ": is a link or a file; name a folder");
}

TEST_CASE("an impossible configuration is refused with the name of its device",
          "[daemon][cutters]") {
  const auto refused = [](std::vector<DeviceConfig> devices, const std::string& part) {
    daemon::CuttersOptions options;
    options.devices = std::move(devices);
    options.usb = false;
    const auto made = daemon::make_cutters(std::move(options));
    REQUIRE_FALSE(made);
    INFO(message(made.error()));
    CHECK(message(made.error()).find(part) != std::string::npos);
  };
  refused({{.id = "sim:cameo33"}}, "cameo3");
  refused({{.id = "left"}}, "left");
  refused({{.id = "file:out.gpgl"}}, "not a cutter");
  refused({{.id = "serial:/dev/ttyUSB0"}}, "name its machine");
  refused({{.id = "sim:cameo3"}, {.id = "sim:cameo3"}}, "twice");
  refused({{.id = "sim:cameo3", .faults = "/nowhere/faults.json"}}, "/nowhere/faults.json");
  refused({{.id = "sim:cameo3", .trace = "/proc/none/trace"}}, "/proc/none/trace");
}

}  // namespace cutters_test
