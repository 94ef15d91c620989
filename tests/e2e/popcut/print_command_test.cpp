// SPDX-License-Identifier: MIT
// Pages to print and cut by hand.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/command_bench.hpp"
#include "tests/support/paths.hpp"

namespace print_command_test {

using namespace popcut::testing;
using nlohmann::json;

namespace {

const std::string kCard =
    "<svg xmlns='http://www.w3.org/2000/svg' width='120mm' height='80mm' viewBox='0 0 120 80' "
    "fill='none' stroke='black'><path data-assignment='B' d='M0 0H120V80H0Z'/>"
    "<path data-assignment='V' d='M0 40H40M80 40H120M40 20H80M40 60H80'/>"
    "<path data-assignment='M' d='M40 40H80'/><path data-assignment='C' d='M40 20V60M80 20V60'/>"
    "</svg>";

// Runs a program of poppler-utils, the second opinion; none if it is not installed.
struct Bench : CommandBench {
  [[nodiscard]] static bool has_poppler() {
    if (std::filesystem::exists("/usr/bin/pdftotext")) return true;
    WARN("skipped in part: poppler-utils is not installed");
    return false;
  }
  [[nodiscard]] std::string poppler(std::vector<std::string> words) const {
    words[0] = "/usr/bin/" + words[0];
    const Ran ran = run_program(words, temp.path(), {});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    return ran.out;
  }
  json planned(const std::string& file, std::vector<std::string> options) const {
    options.insert(options.begin(), {"plan", file, "-o", "sheets", "--json"});
    const Ran ran = popcut(options);
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    said = ran.err;
    return json::parse(ran.out);
  }
  mutable std::string said;
};

struct Pixels {
  int width{}, height{};
  std::string grey;
  [[nodiscard]] bool dark(int x, int y) const {
    return static_cast<unsigned char>(grey[static_cast<std::size_t>(y * width + x)]) < 128;
  }
};

Pixels pixels_of(const std::string& pgm) {
  std::istringstream in(pgm);
  std::string magic;
  Pixels page;
  int most = 0;
  in >> magic >> page.width >> page.height >> most;
  REQUIRE(magic == "P5");
  in.get();
  page.grey.assign(std::istreambuf_iterator<char>(in), {});
  REQUIRE(page.grey.size() == static_cast<std::size_t>(page.width * page.height));
  return page;
}

// The longest dark run of each row, and the longest of all.
int longest_run(const Pixels& page, int from, int to) {
  int longest = 0;
  for (int y = from; y < to; ++y)
    for (int x = 0, run = 0; x < page.width; ++x) {
      run = page.dark(x, y) ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  return longest;
}

}  // namespace

TEST_CASE("a drawing is printed on A4 at true scale with any script in its name",
          "[cli][e2e][print]") {
  const Bench bench;
  write_file(bench.temp / "Für Oma ♥ Ωμέγα Привет.svg", kCard);
  const json plan =
      bench.planned("Für Oma ♥ Ωμέγα Привет.svg", {"--machine", "none", "--mat", "A4"});
  CHECK(std::filesystem::exists(bench.temp / "sheets/sheets.pdf"));
  for (const char* program : {"sheets/sheet-01.gpgl", "sheets/plan-01.svg"})
    CHECK_FALSE(std::filesystem::exists(bench.temp / program));
  CHECK(plan["sheets"][0]["seconds"].is_null());
  CHECK(plan["sheets"][0]["fold_mm"] == plan["sheets"][0]["fold_line_mm"]);
  CHECK(bench.said.find("at actual size") != std::string::npos);
  if (!Bench::has_poppler()) return;
  const std::string text = bench.poppler({"pdftotext", "-layout", "sheets/sheets.pdf", "-"});
  for (const char* words : {"Für Oma ♥ Ωμέγα Привет: sheet 1 of 1", "100 mm: measure it", "cut",
                            "mountain fold", "valley fold", "Printed side up"}) {
    CAPTURE(words, text);
    CHECK(text.find(words) != std::string::npos);
  }
  CHECK(text.find("tab") == std::string::npos);
  const std::string facts = bench.poppler({"pdfinfo", "sheets/sheets.pdf"});
  CHECK(facts.find("(A4)") != std::string::npos);
  // Every font is embedded, and only the letters that are used.
  std::istringstream fonts(bench.poppler({"pdffonts", "sheets/sheets.pdf"}));
  std::string line;
  std::getline(fonts, line);
  std::getline(fonts, line);
  int count = 0;
  while (std::getline(fonts, line)) {
    CAPTURE(line);
    CHECK(line.find("yes yes") != std::string::npos);
    ++count;
  }
  CHECK(count >= 1);
  // 254 dots an inch are 10 a millimetre: the bar, and the card's upper edge.
  const Pixels page =
      pixels_of(bench.poppler({"pdftoppm", "-gray", "-r", "254", "sheets/sheets.pdf"}));
  CHECK(page.width == Approx(2100).margin(1));
  CHECK(page.height == Approx(2970).margin(1));
  CHECK(longest_run(page, 2970 - 300, 2970) == Approx(1000).margin(5));
  CHECK(longest_run(page, 0, 2600) == Approx(1200).margin(5));
}

TEST_CASE("a split drawing is printed with tabs, letters and how to glue it", "[cli][e2e][print]") {
  const Bench bench;
  const json plan =
      bench.planned(source_file("examples/facade.json"), {"--machine", "none", "--mat", "A6"});
  const auto sheets = plan["sheets"].size();
  REQUIRE(sheets > 1);
  if (!Bench::has_poppler()) return;
  const std::string facts = bench.poppler({"pdfinfo", "sheets/sheets.pdf"});
  CAPTURE(facts);
  const auto at = facts.find("Pages:");
  REQUIRE(at != std::string::npos);
  // The sheets, how to glue them, and the legend that has no room on a page so narrow.
  CHECK(std::stoul(facts.substr(at + 6)) == sheets + 2);
  const std::string text = bench.poppler({"pdftotext", "sheets/sheets.pdf", "-"});
  for (const std::string& words :
       {std::string("sheet 2 of ") + std::to_string(sheets), std::string("piece 2"),
        std::string("Glue in this order"), std::string("tab: glue under the same letter"),
        std::string("50 mm"), std::string("mountain fold")}) {
    CAPTURE(words);
    CHECK(text.find(words) != std::string::npos);
  }
}

TEST_CASE("one page explains what is on all small pages that have no room for a legend",
          "[cli][e2e][print]") {
  const Bench bench;
  write_file(bench.temp / "wide.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='210mm' height='100mm' viewBox='0 0 "
             "210 100' fill='none' stroke='black'><path data-assignment='B' d='M5 5H185V63H5Z'/>"
             "<path data-assignment='M' d='M140 5V63'/></svg>");
  bench.planned("wide.svg", {"--machine", "none", "--mat", "100x70"});
  if (!Bench::has_poppler()) return;
  const std::string text = bench.poppler({"pdftotext", "-layout", "sheets/sheets.pdf", "-"});
  CAPTURE(text);
  const std::size_t legend = text.find("For all sheets that have no room");
  REQUIRE(legend != std::string::npos);
  for (const char* words : {"cut", "mountain fold", "tab", "mountain folds rise toward you"})
    CHECK(text.find(words) != std::string::npos);
}

TEST_CASE("pages are written beside a cutter's program when they are asked for",
          "[cli][e2e][print]") {
  const Bench bench;
  write_file(bench.temp / "card.svg", kCard);
  bench.planned("card.svg", {"--formats", "pdf,program"});
  CHECK(std::filesystem::exists(bench.temp / "sheets/sheets.pdf"));
  CHECK(std::filesystem::exists(bench.temp / "sheets/sheet-01.gpgl"));
  CHECK_FALSE(std::filesystem::exists(bench.temp / "sheets/sheet-01.svg"));
  // The same plan gives the same bytes.
  const std::string first = text_of_file(bench.temp / "sheets/sheets.pdf");
  bench.planned("card.svg", {"--formats", "pdf"});
  CHECK(text_of_file(bench.temp / "sheets/sheets.pdf") == first);
  CHECK_FALSE(std::filesystem::exists(bench.temp / "sheets/sheet-01.gpgl"));
  bench.planned("card.svg", {});
  CHECK_FALSE(std::filesystem::exists(bench.temp / "sheets/sheets.pdf"));
  check_refused(bench.popcut({"plan", "card.svg", "-o", "s", "--formats", "png"}), 2,
                "'png' is not a format; give some of: svg program picture assembly pdf");
  check_refused(bench.popcut({"plan", "card.svg", "-o", "s", "--machine", "none", "--formats",
                              "pdf,program"}),
                2, "takes no programs from popcut; leave program out");
  check_refused(
      bench.popcut({"plan", "card.svg", "-o", "s", "--machine", "none", "--mat", "50x50"}), 3,
      "too small to print on; use at least 60 x 60 mm");
  CHECK_FALSE(std::filesystem::exists(bench.temp / "s"));
}

TEST_CASE("a name that no font can print is named", "[cli][e2e][print]") {
  const Bench bench;
  const std::string name = "a\xf3\xbf\xbf\xbd";
  write_file(bench.temp / (name + ".svg"), kCard);
  bench.planned(name + ".svg", {"--machine", "none"});
  CHECK(bench.said.find("no font of this computer has \"\xf3\xbf\xbf\xbd\"") != std::string::npos);
  CHECK(bench.said.find("fonts-noto") != std::string::npos);
  const json spec = {{"popcut", 1},
                     {"name", name},
                     {"surface", {{"type", "revolution"}, {"radius", "sqrt(900 - y^2)"}}},
                     {"units_per_slice", 3},
                     {"slices", 3},
                     {"widths_mm", 10}};
  write_file(bench.temp / "tower.json", spec.dump());
  const Ran ran = bench.popcut({"design", "tower.json", "-o", "out", "--formats", "pdf"});
  CAPTURE(ran.err);
  CHECK(ran.exit == 0);
  CHECK(ran.err.find("no font of this computer has") != std::string::npos);
}

TEST_CASE("a design's page has its legend, its size and its name", "[cli][e2e][print]") {
  const Bench bench;
  const json named = {{"popcut", 1},
                      {"name", "Πύργος"},
                      {"surface", {{"type", "revolution"}, {"radius", "sqrt(900 - y^2)"}}},
                      {"units_per_slice", 3},
                      {"slices", 3},
                      {"widths_mm", 10}};
  write_file(bench.temp / "tower.json", named.dump());
  const Ran ran = bench.popcut({"design", "tower.json", "-o", "out", "--formats", "pdf"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  if (!Bench::has_poppler()) return;
  const std::string text = bench.poppler({"pdftotext", "out/pattern.pdf", "-"});
  for (const char* words : {"Πύργος", "mountain fold", "valley fold", "mm"}) {
    CAPTURE(words, text);
    CHECK(text.find(words) != std::string::npos);
  }
}

TEST_CASE("fold-guide shows how to fold a card, as text, JSON and pages", "[cli][e2e][print]") {
  const Bench bench;
  write_file(bench.temp / "card.svg", kCard);
  const Ran ran = bench.popcut({"fold-guide", "card.svg", "-o", "guide", "--page", "Letter"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(
      ran.out.find("  1  Crease 1 mountain fold (red, its ridge toward you) and 4 valley folds") !=
      std::string::npos);
  CHECK(ran.out.find("Shut the card, press it, and open it.") != std::string::npos);
  const json guide = bench.read_json("guide/fold-guide.json");
  REQUIRE(guide["cards"].size() == 1);
  const json& card = guide["cards"][0];
  CHECK(card["folds"].size() == 5);
  CHECK(card["steps"][0]["kind"] == "crease");
  CHECK(card["steps"][0]["folds"].size() == 5);
  CHECK(card["steps"][1]["push_from"] == "behind");
  CHECK(json::parse(bench.popcut({"fold-guide", "card.svg", "--json", "-q"}).out) == guide);
  if (Bench::has_poppler()) {
    const std::string info = bench.poppler({"pdfinfo", "guide/fold-guide.pdf"});
    CHECK(info.find("Pages:           1\n") != std::string::npos);
    CHECK(info.find("612 x 792 pts (letter)") != std::string::npos);
    CHECK(bench.poppler({"pdftotext", "guide/fold-guide.pdf", "-"}).find("How to fold card") !=
          std::string::npos);
  }
  write_file(bench.temp / "net.svg",  // of a box
             "<svg xmlns='http://www.w3.org/2000/svg' width='140mm' height='110mm' viewBox='0 0 "
             "140 110' fill='none'><g id='cut' stroke='#000'><path d='M10 "
             "40H40V10H70V40H130V70H70V100H40V70H10Z'/></g><g id='valley' stroke='#00f'><path "
             "d='M40 40V70M70 40V70M100 40V70M40 40H70M40 70H70'/></g></svg>");
  const Ran net = bench.popcut({"fold-guide", "net.svg"});
  CAPTURE(net.out, net.err);
  CHECK(net.exit == 0);
  CHECK(net.out.find("Fold it up along its creases") != std::string::npos);
  CHECK(net.out.find("card") == std::string::npos);
  check_refused(bench.popcut({"fold-guide", "card.svg", "--page", "50x50", "-o", "guide"}), 2,
                "--page");
  check_refused(bench.popcut({"fold-guide", "card.stl", "-o", "guide"}), 3, "card.stl");
}

}  // namespace print_command_test
