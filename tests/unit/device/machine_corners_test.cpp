// SPDX-License-Identifier: MIT
// Every machine of the table cuts a whole sheet at its four corners. The programs are read here by
// a reader that shares nothing with the encoder and the simulator; which axis is which is written
// down again, from the sources named in docs/cutters.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "device/sim/bed.hpp"
#include "device/sim/simulate.hpp"
#include "protocol/decode.hpp"
#include "tests/support/sim_bench.hpp"

namespace popcut::testing {
namespace {

/// Machines whose first coordinate is the carriage. All others: the feed.
const std::set<std::string> kCarriageFirst{"stika-sv15", "stika-sv12", "stika-sv8"};

/// A point where the tool is down, on the bed: mm across (carriage) and along (feed).
struct BedPoint {
  double across, along;
};

/// All points of lines, read from the letters alone: D and PD draw through pairs of numbers, M, U,
/// PU and PA move (PA draws while the pen is down).
std::vector<BedPoint> drawn(const std::string& program, const std::string& machine, double step) {
  std::vector<BedPoint> points;
  const bool carriage_first = kCarriageFirst.count(machine) > 0;
  bool down = false;
  std::string word;
  std::vector<double> numbers;
  double at[2] = {0, 0};
  const auto end = [&] {
    static const std::set<std::string> kDown{"D", "PD"}, kUp{"M", "U", "PU"}, kPlain{"PA"};
    if (kDown.count(word)) down = true;
    if (kUp.count(word)) down = false;
    if (kDown.count(word) || kUp.count(word) || kPlain.count(word))
      for (std::size_t k = 0; k + 1 < numbers.size(); k += 2) {
        const auto add = [&] {
          const BedPoint p = carriage_first ? BedPoint{at[0] * step, at[1] * step}
                                            : BedPoint{at[1] * step, at[0] * step};
          if (points.empty() || p.across != points.back().across || p.along != points.back().along)
            points.push_back(p);
        };
        if (down && k == 0) add();
        at[0] = numbers[k], at[1] = numbers[k + 1];
        if (down) add();
      }
    word.clear();
    numbers.clear();
  };
  for (std::size_t i = 0; i < program.size();) {
    const char c = program[i];
    if (c == ';' || c == '\x03' || c == '\n') {
      end();
      ++i;
    } else if ((c >= '0' && c <= '9') || c == '-') {
      char* stop = nullptr;
      numbers.push_back(std::strtod(&program[i], &stop));
      i = static_cast<std::size_t>(stop - program.data());
    } else {
      if (!numbers.empty() && c != ',' && c != ' ') end();
      if (c != ',' && c != ' ') word += c;
      ++i;
    }
  }
  end();
  return points;
}

/// An L at each corner of the sheet, its arms 10 mm long, and a line inward at the upper left.
Toolpath corners(double width, double length) {
  Toolpath path;
  const auto line = [&](std::vector<PagePoint> points) {
    Stroke stroke;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = static_cast<std::uint32_t>(points.size());
    stroke.line = static_cast<std::uint32_t>(path.strokes.size());
    stroke.force_gf = 70;
    stroke.speed_mm_s = 50;
    path.points.insert(path.points.end(), points.begin(), points.end());
    path.strokes.push_back(stroke);
  };
  line({{10, 0}, {0, 0}, {0, 10}});
  line({{0, 0}, {5, 7}});
  line({{width - 10, 0}, {width, 0}, {width, 10}});
  line({{10, length}, {0, length}, {0, length - 10}});
  line({{width - 10, length}, {width, length}, {width, length - 10}});
  return path;
}

Machine renamed(Machine machine, const char* name) {
  machine.name = name;
  return machine;
}

}  // namespace

TEST_CASE("every machine cuts the four corners of its longest sheet where they belong",
          "[device][protocol]") {
  for (const Machine& m : value(all_machines())) {
    if (!m.driven()) continue;
    CAPTURE(m.name);
    CHECK(has_own_bed(m.name));
    CHECK(!m.source.empty());
    JobOptions options{.page_width_mm = m.width_mm, .page_length_mm = m.length_mm};
    options.draw = DrawForm::Text;
    const Toolpath path = corners(m.width_mm, m.length_mm);
    const auto program = value(encode(path, m, value(find_material("paper-220")), options));
    const std::vector<BedPoint> points = drawn(program.bytes, m.name, m.unit_mm);
    REQUIRE(points.size() >= 14);
    double least[2] = {1e9, 1e9}, most[2] = {-1e9, -1e9};
    for (const BedPoint& p : points) {
      least[0] = std::min(least[0], p.across), most[0] = std::max(most[0], p.across);
      least[1] = std::min(least[1], p.along), most[1] = std::max(most[1], p.along);
    }
    CHECK(least[0] == Approx(m.margin_left_mm).margin(0.05));
    CHECK(most[0] == Approx(m.margin_left_mm + m.width_mm).margin(0.05));
    CHECK(least[1] == Approx(m.margin_top_mm).margin(0.05));
    CHECK(most[1] == Approx(m.margin_top_mm + m.length_mm).margin(0.05));
    // No mirror image: these machines' coordinates are right-handed, and on the page the way from
    // right to down is clockwise.
    const bool carriage_first = kCarriageFirst.count(m.name) > 0;
    const BedPoint right = points[0], corner = points[1], below = points[2];
    const double turn = (right.across - corner.across) * (below.along - corner.along) -
                        (below.across - corner.across) * (right.along - corner.along);
    CHECK((carriage_first ? turn : -turn) < 0);
  }
}

TEST_CASE("the simulator cuts whole corners of every machine's longest sheet", "[device][sim]") {
  for (const Machine& m : value(all_machines())) {
    if (!m.driven()) continue;
    CAPTURE(m.name);
    JobOptions options{.page_width_mm = m.width_mm, .page_length_mm = m.length_mm};
    const auto program = value(
        encode(corners(m.width_mm, m.length_mm), m, value(find_material("paper-220")), options));
    SimOptions sheet;
    sheet.page_width_mm = m.width_mm;
    sheet.page_length_mm = m.length_mm;
    const Trace trace = value(simulate(std::as_bytes(std::span(program.bytes)), m, sheet));
    CHECK(trace.clipped_mm < 0.2);
    CHECK(trace.cut_mm == Approx(4 * 20 + std::hypot(5, 7)).margin(0.3));
  }
}

TEST_CASE("a program with exchanged axes runs off the simulator's own bed", "[device][sim]") {
  const Machine roll = machine("hpgl-generic");
  Machine wrong = roll;  // what popcut 0.x wrote: the carriage on X
  wrong.axes = Axes::CarriageFeed;
  Toolpath path = corners(600, 1500);
  JobOptions options{.page_width_mm = 600, .page_length_mm = 1500};
  const auto program = value(encode(path, wrong, value(find_material("paper-220")), options));
  SimOptions sheet;
  sheet.page_width_mm = 600;
  sheet.page_length_mm = 1500;
  const auto bytes = std::as_bytes(std::span(program.bytes));
  CHECK(value(simulate(bytes, wrong, sheet)).clipped_mm >
        20);  // its own bed, whatever the row says
  CHECK(value(simulate(bytes, renamed(wrong, "mine"), sheet)).clipped_mm < 0.2);
}

TEST_CASE("the bed of a row that a user has replaced is the user's", "[device][sim]") {
  const Machine longer = value(find_machine("cameo3", {R"({"popcut": 1, "machines": [
      {"name": "cameo3", "like": "cameo3", "length_mm": 6000}]})"}));
  CHECK_FALSE(longer.built_in);
  CHECK(Bed(longer, 6000).feed_mm() == 6000);
  CHECK(machine("cameo3").built_in);
  CHECK(Bed(machine("cameo3"), 6000).feed_mm() == 3000);
}

TEST_CASE("a machine that answers OH gets no program beyond its limits", "[device][session]") {
  const Machine gcc = machine("gcc-bobcat");
  Machine small = gcc;  // as the machine in inkcut's list of replies: 186 mm across
  small.name = "gcc-a4";
  small.width_mm = 186;
  small.length_mm = 25'000;
  const auto run = [&](double width, double length, Axes axes) {
    Machine driven = small;
    driven.axes = axes;
    JobOptions options{.page_width_mm = width, .page_length_mm = length};
    const auto program =
        value(encode(corners(width, length), driven, value(find_material("paper-220")), options));
    SimOptions sheet;
    sheet.page_width_mm = width;
    sheet.page_length_mm = length;
    SimTransport cable(cutter(small, sheet));
    return run_session(cable, driven, program);
  };
  const SessionEnd fits = run(180, 300, Axes::FeedCarriage);
  CHECK(!fits.error);
  CHECK(count(fits, StrokeFate::NotSent) == 0);
  const SessionEnd wide = run(200, 300, Axes::FeedCarriage);
  REQUIRE(wide.error);
  CHECK_THAT(message(*wide.error), Catch::Contains("0,0 to 1000000,7440") &&
                                       Catch::Contains("12000,8000;") &&
                                       Catch::Contains("nothing was cut"));
  CHECK(count(wide, StrokeFate::NotSent) == 5);
  const SessionEnd exchanged = run(180, 300, Axes::CarriageFeed);
  REQUIRE(exchanged.error);
  CHECK_THAT(message(*exchanged.error), Catch::Contains("axes exchanged"));
}

TEST_CASE("a reply to OH that names no area is not believed", "[protocol][replies]") {
  CHECK(value(parse_limits("0,0,1000000,7454")).most.b == 7454);
  CHECK(!parse_limits("0,0,0,0"));
  CHECK(!parse_limits("0,0,1000000"));
  CHECK(!parse_limits("error"));
}

TEST_CASE("a row of the table with axes or sizes that cannot be is refused", "[device][machines]") {
  const auto error = [](const std::string& more) {
    const auto found = find_machine(
        "mine", {R"({"popcut": 1, "machines": [{"name": "mine", "like": )" + more + "}]}"});
    return found ? std::string("accepted") : message(found.error());
  };
  CHECK(error(R"("hpgl-generic", "axes": "carriage-feed")") == "accepted");
  CHECK_THAT(error(R"("cameo3", "axes": "carriage-feed")"),
             Catch::Contains("/machines/0/axes") && Catch::Contains("feed-carriage"));
  CHECK_THAT(error(R"("hpgl-generic", "axes": "x-y")"), Catch::Contains("/machines/0/axes"));
  CHECK_THAT(error(R"("hpgl-generic", "y_up": true)"),
             Catch::Contains("\"axes\": \"carriage-feed\""));
  CHECK_THAT(error(R"("hpgl-generic", "margin_left_mm": -5)"),
             Catch::Contains("/machines/0/margin_left_mm") && Catch::Contains("negative"));
  CHECK(error(R"("hpgl-generic", "margin_left_mm": -5, "variant": "negative")") == "accepted");
  CHECK_THAT(error(R"("cameo3", "width_mm": 200)"),
             Catch::Contains("/machines/0/mats") && Catch::Contains("200"));
}

TEST_CASE("the tool goes round a sheet on every machine without coming down", "[device][sim]") {
  for (const Machine& m : value(all_machines())) {
    if (!m.driven()) continue;
    CAPTURE(m.name);
    JobOptions options{.page_width_mm = 120, .page_length_mm = 150};
    const Box box{10, 20, 90, 140};
    const auto program = value(frame_of(box, m, value(find_material("paper-220")), options));
    SimOptions sheet;
    sheet.page_width_mm = 120;
    sheet.page_length_mm = 150;
    SimTransport cable(cutter(m, sheet));
    const SessionEnd end = run_session(cable, m, program);
    CHECK(!end.error);
    CHECK(cable.cutter().trace().strokes.empty());
    CHECK(cable.cutter().trace().cut_mm == 0);
    CHECK(cable.cutter().trace().unknown_count == 0);
    // Four sides of 80 and 120 mm with the tool up, the way there and the way home: nothing faster.
    CHECK(cable.cutter().trace().seconds > 400 / m.motion.travel_mm_s);
    const auto read = value(decode(program.dialect, program.view()));
    std::set<std::pair<double, double>> corners;
    for (const MachinePoint& p : read.points) corners.insert({p.a, p.b});
    CHECK(corners.size() >= 4);
  }
}

}  // namespace popcut::testing
