// SPDX-License-Identifier: MIT
#include <sstream>

#include <catch2/catch.hpp>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/dxf/dxf_tables.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/linework_checks.hpp"
#include "tests/support/svg_drafts.hpp"
#include "tests/support/value.hpp"

namespace dxf_reader_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// "0 LINE 8 CUT ..." to groups: codes and values by turns, a `|` stands for a blank in a value.
std::string groups(const std::string& words) {
  std::istringstream in(words);
  std::string out, word;
  while (in >> word) {
    std::replace(word.begin(), word.end(), '|', ' ');
    out += word + "\n";
  }
  return out;
}

std::string section(const std::string& name, const std::string& words) {
  return groups("0 SECTION 2 " + name + " " + words + " 0 ENDSEC");
}

const std::string kMm = section("HEADER", "9 $INSUNITS 70 4");

std::string drawing(const std::string& entities, const std::string& before = kMm) {
  return before + section("ENTITIES", entities) + groups("0 EOF");
}

LineWork read(const std::string& text, const DxfOptions& options = {}) {
  const auto work = linework_from_dxf(text, options);
  INFO((work ? "" : message(work.error())));
  REQUIRE(work);
  return *work;
}

std::string fault(const std::string& text, const DxfOptions& options = {}) {
  const auto work = linework_from_dxf(text, options);
  return work ? "" : message(work.error());
}

std::string line_on(const std::string& layer, double l) {
  return "0 LINE 8 " + layer + " 10 0 20 0 11 " + std::to_string(l) + " 21 0 ";
}

bool warned(const LineWork& work, const std::string& words) {
  for (const Warning& warning : work.warnings)
    if (warning.message.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("a DXF line lies on the page with y turned down", "[core][formats][dxf]") {
  const LineWork work = read(drawing("0 LINE 5 1F 8 0 10 1 20 2 30 0 11 +3.5 21 4e0 31 0"));
  REQUIRE(work.lines.size() == 1);
  CHECK(work.points == std::vector<PagePoint>{{1, -2}, {3.5, -4}});
  CHECK(work.lines[0].operation == Operation::Cut);
  CHECK(work.warnings.empty());
  CHECK_FALSE(work.has_page);
}

TEST_CASE("DXF line ends and comments and a byte order mark do not matter",
          "[core][formats][dxf]") {
  const std::string plain = drawing(line_on("CUT", 5));
  std::string windows, old_mac,
      commented =
          "\xEF\xBB\xBF"
          "999\nmade by hand\n";
  for (const char c : plain) {
    windows += c == '\n' ? "\r\n" : std::string(1, c);
    old_mac += c == '\n' ? '\r' : c;
  }
  commented += plain + "\n\n";
  for (const std::string& text : {plain, windows, old_mac, commented})
    CHECK(read(text).points == read(plain).points);
}

TEST_CASE("layer names give DXF lines their meaning", "[core][formats][dxf]") {
  const std::vector<std::pair<std::string, LayerMeaning>> cases{
      {"CUT", LayerMeaning::Cut},
      {"FOLD_M", LayerMeaning::FoldMountain},
      {"FOLD_V", LayerMeaning::FoldValley},
      {"MARK", LayerMeaning::Draw},
      {"cuts", LayerMeaning::Cut},
      {"01-Cutting lines", LayerMeaning::Cut},
      {"Score", LayerMeaning::Score},
      {"laser engrave 2", LayerMeaning::Draw},
      {"valleyFolds", LayerMeaning::FoldValley},
      {"Mountain folds", LayerMeaning::FoldMountain},
      {"MOUNTAIN", LayerMeaning::FoldMountain},
      {"m", LayerMeaning::FoldMountain},
      {"fold", LayerMeaning::Fold},
      {"mountain and valley", LayerMeaning::Fold},
      {"Outline", LayerMeaning::Outline},
      {"cut_fold", LayerMeaning::Fold},
      {"no cut", LayerMeaning::Ignore},
      {"Defpoints", LayerMeaning::Ignore},
      {"0", LayerMeaning::Wordless},
      {"shortcut", LayerMeaning::Unknown},
      {"scoreboardmaker", LayerMeaning::Unknown},
      {"", LayerMeaning::Wordless}};
  for (const auto& [name, meaning] : cases) {
    CAPTURE(name);
    CHECK(layer_meaning(name) == meaning);
  }
  const LineWork work =
      read(drawing(line_on("CUT", 1) + line_on("fold_m", 2) + line_on("Fold_V", 4) +
                   line_on("MARK", 8) + line_on("score", 16) + line_on("crease", 32)));
  CHECK(total_mm(work, Operation::Cut) == Approx(1));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(2));
  CHECK(total_mm(work, Operation::FoldValley) == Approx(4 + 32));
  CHECK(total_mm(work, Operation::Draw) == Approx(8));
  CHECK(total_mm(work, Operation::Score) == Approx(16));
  CHECK(warned(work, "become valley folds"));
}

TEST_CASE("a DXF layer that nobody knows beside known ones is asked about",
          "[core][formats][dxf]") {
  DxfOptions asks;
  asks.colours = DxfColours::Asked;
  const std::string text = drawing(line_on("CUT", 1) + line_on("Wings", 2) + line_on("0", 4));
  const auto unclear = linework_from_dxf(text, asks);
  REQUIRE_FALSE(unclear);
  CHECK(unclear.error().reason == ErrorReason::Unclear);
  CHECK(unclear.error().place == "layer \"Wings\"");
  CHECK(unclear.error().detail.find("use `layers` \"Wings=fold\"") != std::string::npos);
  CHECK(total_mm(read(text), Operation::Cut) == Approx(7));
  asks.layers = *parse_layer_uses("wings = fold-mountain; 0=ignore");
  const LineWork said = read(text, asks);
  CHECK(total_mm(said, Operation::Cut) == Approx(1));
  CHECK(total_mm(said, Operation::FoldMountain) == Approx(2));
  asks.layers.clear();
  // No other name is known, or the lines are dashes already.
  const LineWork all = read(drawing(line_on("Wings", 2) + line_on("0", 4)), asks);
  CHECK(all.lines.size() == 2);
  CHECK(is_told(all, "the name \"Wings\" says neither cut nor fold, and no other name does"));
  CHECK_FALSE(is_told(read(drawing(line_on("Wings", 2)), asks), "neither cut nor fold"));
  CHECK(read(drawing(line_on("CUT", 1) + "0 LINE 8 Wings 6 HIDDEN 11 9 "), asks).lines.size() == 2);
  // Letters; B and C are those of FOLD beside M or V.
  CHECK_FALSE(linework_from_dxf(drawing(line_on("CUT", 1) + line_on("S", 2)), asks));
  CHECK_FALSE(linework_from_dxf(drawing(line_on("CUT", 1) + line_on("C", 2)), asks));
  CHECK(read(drawing(line_on("M", 1) + line_on("C", 2) + line_on("B", 2)), asks).lines.size() == 3);
  // Names are escaped in ASCII, or bytes of a code page that the file names.
  CHECK(total_mm(
            read(drawing(line_on("\\U+6298\\U+7EBF", 2) + line_on("sch\xe4rfe_schnitt", 3)), asks),
            Operation::FoldValley) == Approx(2));
  const std::string coded = line_on("\xc7\xd0\xb8\xee", 1) + line_on("\xd5\xdb\xcf\xdf", 2);
  const auto in_page = [&](const std::string& page, const std::string& lines) {
    return linework_from_dxf(drawing(lines, section("HEADER", "9 $DWGCODEPAGE 3 " + page)), asks);
  };
  const auto chinese = value(in_page("ANSI_936", coded));
  CHECK(total_mm(chinese, Operation::Cut) == Approx(1));
  CHECK(total_mm(chinese, Operation::FoldValley) == Approx(2));
  const auto russian =
      in_page("ANSI_1251", line_on("\xf0\xe5\xe7", 1) + line_on("\xf1\xe3\xe8\xe1", 2));
  REQUIRE(russian);
  CHECK(total_mm(*russian, Operation::FoldValley) == Approx(2));
  CHECK(in_page("ANSI_9999", coded).error().reason == ErrorReason::Unclear);
}

TEST_CASE("a DXF may be UTF-16 and begin with blank lines", "[core][formats][dxf]") {
  const std::string text = drawing(line_on("CUT", 1) + line_on("FOLD", 2));
  std::string wide = "\xFF\xFE";
  for (const char c : text) (wide += c) += '\0';
  for (const std::string& one : {wide, "\r\n \n\n" + text}) {
    const LineWork work = read(one);
    CHECK(total_mm(work, Operation::Cut) == Approx(1));
    CHECK(total_mm(work, Operation::FoldValley) == Approx(2));
  }
}

TEST_CASE("the name of a DXF block says what its lines on layer 0 are", "[core][formats][dxf]") {
  const std::string blocks = section(
      "BLOCKS",
      "0 BLOCK 8 0 2 FoldLines 70 0 10 0 20 0 0 LINE 8 0 11 2 0 LINE 8 CUT 11 4 0 ENDBLK "
      "0 BLOCK 8 0 2 Part 70 0 10 0 20 0 0 INSERT 8 0 2 FOLDLINES 10 0 20 0 0 LINE 8 0 11 1 "
      "0 ENDBLK");
  const LineWork work = read(drawing("0 INSERT 8 0 2 Part 10 0 20 0 ", kMm + blocks));
  CHECK(total_mm(work, Operation::FoldValley) == Approx(2));
  CHECK(total_mm(work, Operation::Cut) == Approx(1 + 4));
}

TEST_CASE("colours of a DXF are used only on request", "[core][formats][dxf]") {
  const std::string text = drawing(
      "0 LINE 8 A 62 1 11 1 0 LINE 8 A 62 5 11 2 0 LINE 8 A 62 3 11 4 "
      "0 LINE 8 A 11 8 0 LINE 8 A 62 2 11 16 "
      "0 LINE 8 A 420 255 11 32 0 LINE 8 CUT 62 1 11 64");
  CHECK(total_mm(read(text), Operation::Cut) == Approx(127));
  DxfOptions options;
  options.colours = DxfColours::OrigamiSim;
  const LineWork simulator = read(text, options);
  CHECK(total_mm(simulator, Operation::FoldMountain) == Approx(1));
  CHECK(total_mm(simulator, Operation::FoldValley) == Approx(2 + 32));
  CHECK(total_mm(simulator, Operation::Cut) == Approx(4 + 64));
  CHECK(total_mm(simulator, Operation::Outline) == Approx(8));
  CHECK(warned(simulator, "1 lines are left out"));
  options.colours = DxfColours::Lightburn;
  CHECK(total_mm(read(text, options), Operation::Cut) == Approx(4 + 8 + 16 + 64));
}

TEST_CASE("DXF units are read and a missing one is reported", "[core][formats][dxf]") {
  const auto length_in = [](const std::string& header) {
    return length(read(drawing(line_on("CUT", 10), section("HEADER", header))).points);
  };
  CHECK(length_in("9 $INSUNITS 70 4") == Approx(10));
  CHECK(length_in("9 $INSUNITS 70 1") == Approx(254));
  CHECK(length_in("9 $INSUNITS 70 5") == Approx(100));
  CHECK(length_in("9 $ACADVER 1 AC1015 9 $INSUNITS 70 6 9 $MEASUREMENT 70 0") == Approx(10000));
  CHECK(length_in("9 $MEASUREMENT 70 0") == Approx(254));
  CHECK(length_in("9 $INSUNITS 70 0 9 $MEASUREMENT 70 1") == Approx(10));
  CHECK(warned(read(drawing(line_on("CUT", 1), "")), "1 unit is read as 1 mm"));
  CHECK(warned(read(drawing(line_on("CUT", 1), section("HEADER", "9 $MEASUREMENT 70 0"))),
               "1 unit is read as 1 inch"));
  CHECK(fault(drawing(line_on("CUT", 1), section("HEADER", "9 $INSUNITS 70 mm"))) ==
        "line 8: \"mm\" is not a whole number (group code 70)");
}

TEST_CASE("DXF layers that are off or frozen or not plotted are left out and named",
          "[core][formats][dxf]") {
  const std::string tables = section(
      "TABLES",
      "0 TABLE 2 LAYER 70 4 0 LAYER 2 CUT 70 0 62 7 0 LAYER 2 Off 70 0 62 -7 0 LAYER 2 Cold 70 1 "
      "62 7 0 LAYER 2 Notes 70 0 62 7 290 0 0 ENDTAB");
  const LineWork work =
      read(drawing(line_on("cut", 1) + line_on("OFF", 2) + line_on("cold", 4) +
                       line_on("notes", 8) + "0 LINE 8 CUT 67 1 11 16 " + "0 LINE 8 CUT 60 1 11 32",
                   kMm + tables));
  CHECK(total_mm(work, Operation::Cut) == Approx(1));
  CHECK(work.lines.size() == 1);
  CHECK(warned(work, "the layer \"Off\" is off; 1 of its entities is left out"));
  CHECK(warned(work, "the layer \"Cold\" is frozen; 1"));
  CHECK(warned(work, "the layer \"Notes\" is not plotted or transparent; 1"));
  CHECK(warned(work, "1 entities on a paper layout"));
  CHECK(warned(work, "1 invisible entity is left out; it is at line "));
}

TEST_CASE("names of a DXF are the same in either case, however their letters are written",
          "[core][formats][dxf]") {
  const auto is_frozen = [](const std::string& table, const std::string& entity) {
    const LineWork work = read(drawing(
        line_on("0", 1) + line_on(entity, 2),
        kMm + section("TABLES", "0 TABLE 2 LAYER 0 LAYER 2 " + table + " 70 1 62 7 0 ENDTAB")));
    return work.lines.size() == 1 && warned(work, "is frozen; 1 of its entities is left out");
  };
  CHECK(is_frozen("ÄUSSEN", "äussen"));
  CHECK(is_frozen("\\U+00C4USSEN", "äussen"));
  CHECK(is_frozen("\xc4USSEN", "\xe4ussen"));  // Windows-1252
  CHECK(is_frozen("СЛОЙ-Ё", "слой-ё"));
  CHECK(is_frozen("ΣΚΊΤΣΟΣ", "σκίτσος"));
  CHECK(is_frozen("ŁÓDŹ", "łódź"));
  CHECK(is_frozen("ŽLUTÝ", "žlutý"));
  CHECK(is_frozen("NẾP", "nếp"));
  CHECK(is_frozen("ＣＵＴ", "ｃｕｔ"));
  CHECK(is_frozen("折线", "折线"));
  CHECK_FALSE(is_frozen("ÄUSSEN", "aussen"));
  CHECK_FALSE(is_frozen("÷", "×"));
  const LineWork block = read(
      drawing("0 INSERT 8 0 2 kästchen 10 0 20 0 ",
              kMm + section("BLOCKS", "0 BLOCK 8 0 2 KÄSTCHEN 70 0 0 LINE 8 0 11 2 0 ENDBLK")));
  CHECK(block.lines.size() == 1);
  const LineWork dashes = read(drawing(
      "0 LINE 8 0 6 GESTRICHELTÄ 11 100 ",
      kMm +
          section("TABLES", "0 TABLE 2 LTYPE 0 LTYPE 2 gestricheltä 73 2 49 10 49 -10 0 ENDTAB")));
  CHECK(total_mm(dashes, Operation::Cut) == Approx(50));
}

TEST_CASE("what has no length does not make a DXF larger", "[core][formats][dxf]") {
  for (const char* empty : {"0 LINE 8 0 10 400 20 0 11 400 21 0 ",
                            "0 LWPOLYLINE 8 0 90 2 70 1 10 400 20 0 10 400 20 0 ",
                            "0 CIRCLE 8 0 10 400 20 0 40 0 ", "0 LINE 8 0 10 4e5 20 0 11 4e5 "}) {
    CAPTURE(empty);
    const LineWork work = read(drawing(line_on("0", 9) + empty));
    CHECK(bounds(work).width() == Approx(9));
    CHECK(warned(work, "1 lines have no length and are left out"));
  }
}

TEST_CASE("blocks of scale 0 and splines that do not close are told", "[core][formats][dxf]") {
  const std::string blocks = section("BLOCKS", "0 BLOCK 8 0 2 B 70 0 0 LINE 8 0 11 2 0 ENDBLK");
  const auto insert = [&](const std::string& scales) {
    return read(drawing(line_on("0", 1) + "0 INSERT 8 0 2 B 10 0 20 0 " + scales, kMm + blocks));
  };
  CHECK(warned(insert("42 0 "), "1 inserts of blocks have a scale of 0"));
  CHECK(insert("41 -1 42 2 43 0 ").warnings.empty());
  const std::string spline = "0 SPLINE 8 0 71 2 40 0 40 0 40 0 40 1 40 1 40 1 10 0 20 0 10 9 20 9 ";
  const auto closed_one = [&](const std::string& flag, const std::string& end) {
    return warned(read(drawing(spline + end + " 70 " + flag + " ")), "but their ends lie apart");
  };
  CHECK(closed_one("1", "10 9 20 0"));
  CHECK_FALSE(closed_one("0", "10 9 20 0"));
  CHECK_FALSE(closed_one("1", "10 0 20 0"));
}

TEST_CASE("what cannot be seen of a DXF is left out and told", "[core][formats][dxf]") {
  const auto cut_mm = [](const std::string& entities, const std::string& before = {}) {
    const LineWork work = read(drawing(line_on("0", 1) + entities, kMm + before));
    CHECK(work.warnings.size() == 1);
    return total_mm(work, Operation::Cut);
  };
  CHECK(cut_mm("0 LINE 8 0 11 2 60 1 ") == Approx(1));
  CHECK(cut_mm("0 LINE 8 0 62 -7 11 2 ") == Approx(1));
  CHECK(cut_mm("0 LINE 8 0 440 33554432 11 2 ") == Approx(1));
  CHECK(cut_mm("0 POLYLINE 8 0 60 1 66 1 70 0 0 VERTEX 8 0 10 0 20 9 0 VERTEX 8 0 10 3 20 9 0 "
               "SEQEND ") == Approx(1));
  const std::string blocks =
      section("BLOCKS", "0 BLOCK 8 0 2 B 70 0 0 LINE 8 0 11 2 0 LINE 8 0 60 1 11 4 0 ENDBLK");
  CHECK(cut_mm("0 INSERT 8 0 2 B 60 1 10 0 20 0 ", blocks) == Approx(1));
  CHECK(cut_mm("0 INSERT 8 0 2 B 10 0 20 0 ", blocks) == Approx(3));
  const auto layer = [](const std::string& how) {
    return section("TABLES", "0 TABLE 2 LAYER 70 1 0 LAYER 2 X " + how + " 0 ENDTAB");
  };
  CHECK(cut_mm("0 INSERT 8 x 2 B 10 0 20 0 ", layer("70 1 62 7") + blocks) == Approx(1));
  CHECK(cut_mm("0 LINE 8 x 11 2 ", layer("70 0 62 7 1001 AcCmTransparency 1071 33554432")) ==
        Approx(1));
  // Half transparent, locked, or frozen in new views only.
  for (const char* how : {"440 33554559", "440 0"})
    CHECK(read(drawing(std::string("0 LINE 8 0 11 2 ") + how + " ")).lines.size() == 1);
  CHECK(read(drawing("0 LINE 8 x 11 2 ", kMm + layer("70 6 62 7"))).lines.size() == 1);
}

TEST_CASE("a DXF with site coordinates is moved to its origin", "[core][formats][dxf]") {
  const auto at = [](const std::string& x, const std::string& y) {
    return "0 CIRCLE 8 0 10 " + x + " 20 " + y + " 40 10 ";
  };
  const LineWork work =
      read(drawing(at("155000000", "-463000000") + at("155000050", "-463000000")));
  CHECK(bounds(work).width() == Approx(70).margin(0.05));
  CHECK(bounds(work).height() == Approx(20).margin(0.05));
  CHECK(warned(work, "m from its origin and is moved there"));
  CHECK(fault(drawing(at("0", "0") + at("155000000", "0"))).find("100 m from the first line") !=
        std::string::npos);
}

TEST_CASE("colours of DXF layers may be exact ones", "[core][formats][dxf]") {
  const std::string tables =
      section("TABLES",
              "0 TABLE 2 LAYER 70 2 0 LAYER 2 A 70 0 62 7 420 0 0 LAYER 2 B 70 0 62 7 420 "
              "16711680 0 ENDTAB");
  const std::string lines = line_on("A", 1) + line_on("B", 2);
  DxfOptions asks;
  asks.colours = DxfColours::Asked;
  CHECK(fault(drawing(lines, kMm + tables), asks).find("several colours") != std::string::npos);
  DxfOptions by_colour;
  by_colour.colours = DxfColours::OrigamiSim;
  const LineWork work = read(drawing(lines, kMm + tables), by_colour);
  CHECK(total_mm(work, Operation::Outline) == Approx(1));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(2));
}

TEST_CASE("lines of a DXF in space are cut as seen from above, with a warning",
          "[core][formats][dxf]") {
  const auto told = [](const std::string& entity, const std::string& before = kMm) {
    return warned(read(drawing(line_on("0", 9) + entity, before)), "are tilted in space");
  };
  for (const char* entity :
       {"0 LINE 8 0 10 0 20 0 30 0 11 5 21 0 31 5 ", "0 LINE 8 0 10 0 20 0 30 0 11 0 21 0 31 5 ",
        "0 POLYLINE 8 0 66 1 70 8 0 VERTEX 8 0 10 0 20 0 30 0 70 32 0 VERTEX 8 0 10 5 20 0 30 5 "
        "70 32 0 SEQEND ",
        "0 ELLIPSE 8 0 10 0 20 0 30 0 11 5 21 0 31 0 40 0.5 41 0 42 6.2831853 210 0 220 1 230 0 ",
        "0 SPLINE 8 0 71 1 10 0 20 0 30 0 10 5 20 5 30 5 ",
        "0 CIRCLE 8 0 10 0 20 0 40 5 210 1 220 0 230 0 "}) {
    CAPTURE(entity);
    CHECK(told(entity));
  }
  for (const char* entity :
       {"0 LINE 8 0 10 0 20 0 30 7 11 5 21 0 31 7 ", "0 LINE 8 0 10 0 20 0 30 0 11 5 21 0 31 0.01 ",
        "0 ELLIPSE 8 0 10 0 20 0 30 3 11 5 21 0 31 0 40 0.5 41 0 42 6.2831853 210 0 220 0 230 -1 ",
        "0 CIRCLE 8 0 10 0 20 0 40 5 210 0 220 0 230 -1 "}) {
    CAPTURE(entity);
    CHECK_FALSE(told(entity));
  }
  const std::string block =
      section("BLOCKS", "0 BLOCK 8 0 2 B 70 0 0 LINE 8 0 11 2 0 CIRCLE 8 0 40 2 0 ENDBLK");
  CHECK(told("0 INSERT 8 0 2 B 10 0 20 0 210 0 220 1 230 0 ", kMm + block));
  CHECK_FALSE(told("0 INSERT 8 0 2 B 10 0 20 0 41 -2 210 0 220 0 230 -1 ", kMm + block));
}

TEST_CASE("popcut warns about parts of a DXF that are in other files or clipped",
          "[core][formats][dxf]") {
  const auto block = [](const std::string& flags) {
    return kMm + section("BLOCKS", "0 BLOCK 8 0 2 B 70 " + flags + " 1 b.dwg 0 ENDBLK");
  };
  const std::string entities = line_on("0", 9) + "0 INSERT 8 0 2 B 10 0 20 0 ";
  for (const char* flags : {"4", "8", "12"})
    CHECK(warned(read(drawing(entities, block(flags))), "1 insert of the block \"B\""));
  CHECK_FALSE(warned(read(drawing(entities, block("2"))), "insert of the block"));
  const LineWork clipped = read(
      kMm + section("ENTITIES", line_on("0", 9)) +
      section("OBJECTS", "0 SPATIAL_FILTER 100 AcDbSpatialFilter 70 2 10 0 20 0 10 5 20 5 71 1") +
      groups("0 EOF"));
  CHECK(warned(clipped, "1 insert of a block is clipped (XCLIP), and cut whole"));
}

TEST_CASE("names in old code pages are decoded", "[core][formats][dxf]") {
  CHECK(dxf_name("\\M+5D5DB\\M+5CFDF") == "折线");
  CHECK(dxf_name("\\M+1 \\M+9D5DB \\M+5D5") == "\\M+1 \\M+9D5DB \\M+5D5");
  CHECK(dxf_name("Gr\xfc\xdf"
                 "e \x80") == "Grüße €");
  CHECK(dxf_name("Grüße €") == "Grüße €");
  CHECK(dxf_name("a\x01\x7f"
                 "b") == "a??b");
}

TEST_CASE("dashed DXF lines are cut as whole dashes with paper at both ends",
          "[core][formats][dxf]") {
  const std::string tables =
      section("TABLES",
              "0 TABLE 2 LTYPE 70 2 0 LTYPE 2 DASHED 70 0 3 d 72 65 73 2 40 3 49 2 49 -1 "
              "0 LTYPE 2 DOTS 70 0 73 2 40 1 49 0 49 -1 0 ENDTAB "
              "0 TABLE 2 LAYER 70 1 0 LAYER 2 Perfs 70 0 62 7 6 DASHED 0 ENDTAB");
  const LineWork work =
      read(drawing("0 LINE 8 A 6 dashed 11 31 0 LINE 8 FOLD_M 6 DASHED 11 31 "
                   "0 LINE 8 A 6 DOTS 10 0 20 9 11 5 21 9 0 LINE 8 A 6 HIDDEN2 20 8 11 7 21 8 "
                   "0 LINE 8 A 6 DASHED 20 3 11 1 21 3 0 LINE 8 A 6 Odd 20 4 11 100 21 4",
                   kMm + tables));
  // 31 mm hold ten periods of 3.1 mm: two thirds are dash.
  CHECK(count(work, Operation::Cut) == 10 + 1 + 1);
  CHECK(total_mm(work, Operation::Cut) == Approx(31 * 2 / 3.0 + 2 / 3.0 + 100));
  CHECK(work.points_of(work.lines[0])[0].x == Approx(3.1 / 6));
  CHECK(work.points_of(work.lines[9])[1].x == Approx(31 - 3.1 / 6));
  CHECK(total_mm(work, Operation::FoldMountain) == Approx(31));
  CHECK(total_mm(work, Operation::FoldValley) == Approx(5 + 7));
  CHECK(warned(work, "2 lines have a dashed line type; their dashes are cut"));
  CHECK(warned(work, "2 lines have a dashed line type whose dashes are not in the file"));
  // Dashes go round the corners of a polyline.
  const LineWork bent = read(drawing(
      "0 LWPOLYLINE 8 A 6 DASHED 90 3 70 0 10 0 20 0 10 1.5 20 0 10 1.5 20 1.5", kMm + tables));
  REQUIRE(bent.lines.size() == 1);
  CHECK(bent.lines[0].count == 3);
  CHECK(length(bent.points) == Approx(2));
}

TEST_CASE("inserts of blocks turn and scale and repeat", "[core][formats][dxf]") {
  const std::string blocks =
      section("BLOCKS",
              "0 BLOCK 8 0 2 B 70 0 10 1 20 0 30 0 3 B 0 LINE 8 0 10 1 11 3 "
              "0 LINE 8 FOLD_V 10 1 11 2 0 ENDBLK 8 0 "
              "0 BLOCK 8 0 2 OUTER 70 0 10 0 20 0 0 INSERT 8 0 2 b 10 5 20 0 0 ENDBLK");
  const LineWork turned =
      read(drawing("0 INSERT 8 CUT 2 B 10 10 20 20 41 2 42 2 50 90", kMm + blocks));
  REQUIRE(turned.lines.size() == 2);
  CHECK(turned.lines[0].operation == Operation::Cut);  // layer 0 of a block is that of its insert
  CHECK(turned.lines[1].operation == Operation::FoldValley);
  CHECK(turned.points[0].x == Approx(10));
  CHECK(turned.points[0].y == Approx(-20));
  CHECK(turned.points[1].x == Approx(10));
  CHECK(turned.points[1].y == Approx(-24));
  const LineWork rows = read(drawing("0 INSERT 2 OUTER 70 3 71 2 44 10 45 20", kMm + blocks));
  CHECK(rows.lines.size() == 12);
  CHECK(bounds(rows).width() == Approx(20 + 2));
  CHECK(bounds(rows).height() == Approx(20));
  CHECK(bounds(rows).x0 == Approx(5));
  const LineWork mirrored =
      read(drawing("0 INSERT 2 B 10 10 20 20 210 0 220 0 230 -1", kMm + blocks));
  CHECK(mirrored.points[0].x == Approx(-10));
  CHECK(mirrored.points[1].x == Approx(-12));
  const LineWork none = read(drawing("0 INSERT 2 GONE", kMm + blocks));
  CHECK(none.lines.empty());
  CHECK(warned(none, "1 insert of the block \"GONE\", which is not in the file"));
}

TEST_CASE("blocks that insert themselves or swell are refused", "[core][formats][dxf]") {
  const std::string itself =
      section("BLOCKS", "0 BLOCK 2 A 0 INSERT 2 B 0 ENDBLK 0 BLOCK 2 B 0 INSERT 2 A 0 ENDBLK");
  CHECK(fault(drawing("0 INSERT 2 A", itself)).find("inserts itself; remove this INSERT") !=
        std::string::npos);
  // Ten blocks of ten inserts each: ten thousand million lines.
  std::string bomb = "0 BLOCK 2 X0 0 LINE 8 0 11 1 0 ENDBLK ";
  for (int i = 1; i <= 10; ++i) {
    bomb += "0 BLOCK 2 X" + std::to_string(i) + " ";
    for (int k = 0; k < 10; ++k) bomb += "0 INSERT 2 X" + std::to_string(i - 1) + " ";
    bomb += "0 ENDBLK ";
  }
  DxfOptions small;
  small.most_lines = 100'000;
  CHECK(fault(drawing("0 INSERT 2 X10", section("BLOCKS", bomb)), small)
            .find("repeats blocks too often") != std::string::npos);
  small.most_points = 1000;
  CHECK(fault(drawing("0 INSERT 2 X0 70 100 71 100", section("BLOCKS", bomb)), small)
            .find("more than 1000 points") != std::string::npos);
  CHECK(fault(drawing("0 INSERT 2 X0 70 100000 71 2", section("BLOCKS", bomb)))
            .find("at most 32767") != std::string::npos);
  std::string deep = "0 BLOCK 2 D0 0 LINE 11 1 0 ENDBLK ";
  for (int i = 1; i < 50; ++i)
    deep +=
        "0 BLOCK 2 D" + std::to_string(i) + " 0 INSERT 2 D" + std::to_string(i - 1) + " 0 ENDBLK ";
  CHECK(fault(drawing("0 INSERT 2 D49", section("BLOCKS", deep))).find("32 deep") !=
        std::string::npos);
  CHECK(fault(drawing("0 INSERT 2 D20", section("BLOCKS", deep))).empty());
}

TEST_CASE("entities of a DXF that are not lines are named", "[core][formats][dxf]") {
  const LineWork work =
      read(drawing("0 POINT 10 1 20 1 0 TEXT 8 A 10 nonsense 1 hello 0 MTEXT 1 a "
                   "0 HATCH 10 0 91 1 0 DIMENSION 2 *D1 0 IMAGE 10 0 0 LINE 11 1"));
  CHECK(work.lines.size() == 1);
  CHECK(work.warnings.size() == 5);
  CHECK(warned(work, "1 MTEXT cannot be read and is left out"));
}

TEST_CASE("old polylines have bulges and are closed by their flag", "[core][formats][dxf]") {
  const LineWork work =
      read(drawing("0 POLYLINE 8 CUT 66 1 10 0 20 0 30 0 70 1 0 VERTEX 8 CUT 10 0 20 0 42 1 "
                   "0 VERTEX 10 10 20 0 0 VERTEX 10 10 20 10 0 SEQEND 0 LINE 8 CUT 11 1"));
  REQUIRE(work.lines.size() == 2);
  const auto line = work.points_of(work.lines[0]);
  CHECK(closed(line));
  // A half circle from (0, 0) to (10, 0) to the left of its way goes below, then up and back.
  double lowest = 0.0;
  for (const PagePoint& p : line) lowest = std::max(lowest, p.y);
  CHECK(lowest == Approx(5).margin(0.02));
  CHECK(length(line) == Approx(5 * M_PI + 10 + 10 * std::sqrt(2)).epsilon(2e-3));
  const LineWork mesh =
      read(drawing("0 POLYLINE 66 1 70 16 0 VERTEX 10 0 20 0 0 VERTEX 10 1 20 0 "
                   "0 SEQEND"));
  CHECK(mesh.lines.empty());
  CHECK(warned(mesh, "POLYLINE (mesh)"));
}

TEST_CASE("splines by fit points go through them", "[core][formats][dxf]") {
  const LineWork open =
      read(drawing("0 SPLINE 8 A 70 8 71 3 74 4 11 0 21 0 11 10 21 5 11 20 21 0 11 30 21 5"));
  REQUIRE(open.lines.size() == 1);
  for (const PagePoint& fit : {PagePoint{0, 0}, {10, -5}, {20, 0}, {30, -5}}) {
    double near = 1e9;
    for (const PagePoint& p : open.points) near = std::min(near, distance(p, fit));
    CHECK(near < 1e-9);
  }
  // Twelve points of a circle make one, within a hundredth of its radius.
  std::string round = "0 SPLINE 8 A 70 1 71 3 ";
  for (int i = 0; i < 12; ++i)
    round += "11 " + std::to_string(10 * std::cos(i * M_PI / 6)) + " 21 " +
             std::to_string(10 * std::sin(i * M_PI / 6)) + " ";
  const LineWork ring = read(drawing(round));
  REQUIRE(ring.lines.size() == 1);
  CHECK(closed(ring.points));
  for (const PagePoint& p : ring.points) CHECK(std::hypot(p.x, p.y) == Approx(10).margin(0.03));
}

TEST_CASE("a faulty DXF is refused with its line and what would be right", "[core][formats][dxf]") {
  CHECK(fault("") == "line 1: this is not a DXF file: it has no section (0 SECTION)");
  CHECK(fault("hello\nworld\n").find("line 1: \"hello\" is not a group code") == 0);
  CHECK(fault("AutoCAD Binary DXF\r\n\x1a").find("group 1: the first line of a binary DXF") == 0);
  CHECK(fault(groups("0 LINE 8 0")).find("line 2: \"LINE\" is outside of any section") == 0);
  const std::string whole = drawing(line_on("CUT", 5));
  CHECK(fault(whole.substr(0, whole.size() - 6)).empty());  // only EOF is gone
  CHECK(fault(whole.substr(0, whole.size() - 15))
            .find("does not end (0 ENDSEC); is the file complete?") != std::string::npos);
  CHECK(fault(whole.substr(0, whole.find("11\n") + 3)).find("ends after a group code") !=
        std::string::npos);
  CHECK(fault(drawing("0 LINE 10 abc")).find("line 18: \"abc\" is not a number (group code 10)") ==
        0);
  for (const char* wrong : {"nan", "inf", "1e999", "1,5", "0x10", "--1", "1.5.2"}) {
    CAPTURE(wrong);
    CHECK(fault(drawing(std::string("0 LINE 10 ") + wrong)).find("is not a number") !=
          std::string::npos);
  }
  CHECK(fault(drawing("0 LINE 10 1e308 11 0")).find("more than 100 m") != std::string::npos);
  CHECK(fault(drawing("0 CIRCLE 40 1e308")).find("more than 100 m") != std::string::npos);
  CHECK(fault(drawing("0 CIRCLE 40 -1")).find("line 16: the CIRCLE has a radius of -1") == 0);
  CHECK(fault(drawing("0 LWPOLYLINE 10 0 20 0 42 1e300 10 1 20 0")).find("100 m") !=
        std::string::npos);
  CHECK(fault(drawing("0 SPLINE 71 3 40 0 40 1 10 0 20 0 10 1 20 0 10 2 20 0 10 3 20 0")) ==
        "line 16: the spline has 2 knots; 4 control points of degree 3 need 8");
  CHECK(fault(drawing("0 SPLINE 71 40 10 0 20 0")).find("degree 40; use 1 to 11") !=
        std::string::npos);
  CHECK(fault(drawing("0 SPLINE 71 1 40 0 40 0 40 1 40 1 41 1 41 -1 10 0 20 0 10 1 20 0"))
            .find("weight of -1") != std::string::npos);
  CHECK(fault(drawing("99999 LINE")).find("not a group code") != std::string::npos);
  CHECK(fault(section("BLOCKS", "0 BLOCK 2 A 0 LINE")).find("does not end (0 ENDBLK)") !=
        std::string::npos);
}

TEST_CASE("popcut's own DXF reads back to the cuts and folds of its FOLD", "[core][formats][dxf]") {
  const Pattern pattern = popcut::testing::box_card_pattern();
  std::ostringstream dxf, fold;
  write_pattern_dxf(pattern, dxf);
  REQUIRE(write_fold(pattern, {}, fold));
  const LineWork a = read(dxf.str());
  const auto b = value(linework_from_fold(fold.str()));
  const auto lines = [](const LineWork& work, bool folds) {
    std::vector<std::vector<PagePoint>> out;
    for (const DrawnLine& line : work.lines) {
      const auto p = work.points_of(line);
      if (is_fold(line.operation) == folds) out.emplace_back(p.begin(), p.end());
    }
    return out;
  };
  CHECK(a.warnings.empty());
  for (const Operation fold_side : {Operation::FoldMountain, Operation::FoldValley}) {
    CHECK(count(a, fold_side) > 0);
    CHECK(total_mm(a, fold_side) == Approx(total_mm(b, fold_side)));
  }
  CHECK(total_mm(a, Operation::Cut) ==
        Approx(total_mm(b, Operation::Cut) + total_mm(b, Operation::Outline)));
  // Every line of the one lies on lines of the same kind of the other.
  for (const bool folds : {true, false})
    for (const auto& line : lines(a, folds))
      for (const PagePoint& p :
           {line[0], PagePoint{(line[0].x + line[1].x) / 2, (line[0].y + line[1].y) / 2},
            line[1]}) {
        double near = 1e9;
        for (const auto& other : lines(b, folds))
          for (std::size_t i = 1; i < other.size(); ++i)
            near = std::min(near, distance_to(p, other[i - 1], other[i]));
        CHECK(near < 1e-3);  // the DXF is rounded
      }
}

TEST_CASE("several colours on layers without a meaning are asked about", "[core][formats][dxf]") {
  DxfOptions asks;
  asks.colours = DxfColours::Asked;
  const auto coloured = [](const char* layer, const char* colour) {
    return std::string("0 LINE 8 ") + layer + " " + colour + " 10 0 20 0 11 9 21 0 ";
  };
  const std::string red_and_blue = drawing(coloured("A", "62 1") + coloured("B", "62 5"));
  const auto unclear = linework_from_dxf(red_and_blue, asks);
  REQUIRE_FALSE(unclear);
  CHECK(unclear.error().reason == ErrorReason::Unclear);
  CHECK(unclear.error().place == "layer \"B\"");
  CHECK(unclear.error().detail.find("`svg-profile` origami-sim") != std::string::npos);
  CHECK(unclear.error().detail.find("`svg-profile` popcut") != std::string::npos);
  CHECK(unclear.error().detail.find("`colors`") != std::string::npos);
  CHECK(read(red_and_blue).lines.size() == 2);
  DxfOptions looks = asks;
  looks.looks = true;
  const auto asked = value(linework_from_dxf(red_and_blue, looks));
  CHECK(asked.asks == "colors");
  CHECK(asked.unsaid == std::vector<DrawnLook>{{"A", "#ff0000"}, {"B", "#0000ff"}});
  DxfOptions says = asks;
  says.said = *parse_colour_uses("red=fold-mountain; blue=ignore");
  const auto said = value(linework_from_dxf(red_and_blue, says));
  REQUIRE(said.lines.size() == 1);
  CHECK(said.lines[0].operation == Operation::FoldMountain);
  // Where cuts were said, a colour of which nothing was said is not cut.
  says.said = *parse_colour_uses("red=cut");
  CHECK(linework_from_dxf(red_and_blue, says).error().reason == ErrorReason::Unclear);
  looks.said = says.said;
  CHECK(linework_from_dxf(red_and_blue, looks)->asks == "colors");
  // One colour, black beside white, one colour spelled twice, and colours of layers with a name.
  for (const std::string& clear :
       {coloured("A", "62 1") + coloured("B", "62 1"),
        coloured("A", "62 7") + coloured("B", "420 0"),
        coloured("A", "62 7 420 255") + coloured("B", "62 5 420 255"),
        coloured("CUT", "62 1") + coloured("FOLD_V", "62 5") + coloured("0", "62 7")})
    CHECK(read(drawing(clear), asks).lines.size() >= 2);
}

namespace {

/// The groups of an ASCII DXF in binary. Which codes are numbers is written down here again, for
/// the codes of these tests: 10 to 59 and 140 to 149 are doubles, 60 to 79 and 280 to 289 short.
std::string binary(const std::string& ascii, bool wide) {
  std::string out("AutoCAD Binary DXF\r\n\x1a\0", 22);
  std::istringstream in(ascii);
  std::string code_line, value;
  const auto put = [&](const void* bytes, std::size_t count) {
    out.append(static_cast<const char*>(bytes), count);  // little-endian machines only
  };
  while (std::getline(in, code_line) && std::getline(in, value)) {
    const auto code = static_cast<std::int16_t>(std::stoi(code_line));
    if (wide) {
      put(&code, 2);
    } else if (code < 255) {
      out += static_cast<char>(code);
    } else {
      out += '\xff';
      put(&code, 2);
    }
    if ((code >= 10 && code < 60) || (code >= 140 && code < 150)) {
      const double number = std::stod(value);
      put(&number, 8);
    } else if ((code >= 60 && code < 80) || (code >= 280 && code < 290)) {
      const auto number = static_cast<std::int16_t>(std::stoi(value));
      put(&number, 2);
    } else {
      out += value;
      out += '\0';
    }
  }
  return out;
}

}  // namespace

TEST_CASE("a binary DXF is read as the ASCII one of the same groups", "[core][formats][dxf]") {
  const std::vector<std::string> drawings{
      drawing(line_on("CUT", 5) + line_on("VALLEY", 7)),
      drawing("0 CIRCLE 8 CUT 10 1 20 2 40 3.25 0 ARC 8 MOUNTAIN 10 0 20 0 40 5 50 0 51 90 "),
      drawing("0 LWPOLYLINE 8 OUTLINE 90 3 70 1 10 0 20 0 42 0.5 10 10 20 0 10 10 20 10 "),
      section("HEADER", "9 $INSUNITS 70 1") + section("ENTITIES", line_on("CUT", 2)) +
          groups("0 EOF")};
  for (const std::string& ascii : drawings)
    for (const bool wide : {false, true}) {
      std::string bytes = binary(ascii, wide);
      // 90 is a long number: as in the file of a CAD program.
      if (const std::size_t at = ascii.find("90\n3\n"); at != std::string::npos) {
        const std::string as_text = wide ? std::string("\x5a\0003\0", 4)
                                         : std::string(
                                               "\x5a"
                                               "3\0",
                                               3);
        const std::string as_long =
            wide ? std::string("\x5a\0\3\0\0\0", 6) : std::string("\x5a\3\0\0\0", 5);
        const std::size_t where = bytes.find(as_text);
        REQUIRE(where != std::string::npos);
        bytes.replace(where, as_text.size(), as_long);
      }
      CAPTURE(ascii, wide);
      const LineWork meant = read(ascii), own = read(bytes);
      CHECK(own.points == meant.points);
      REQUIRE(own.lines.size() == meant.lines.size());
      for (std::size_t k = 0; k < own.lines.size(); ++k)
        CHECK(own.lines[k].operation == meant.lines[k].operation);
      CHECK(read(bytes + std::string(200, '\x1a')).points == meant.points);  // padding
      // Cut off anywhere before its end, it is refused, or read if only EOF is gone.
      for (std::size_t end = 0; end + 6 < bytes.size(); ++end) {
        const auto part = linework_from_dxf(bytes.substr(0, end));
        if (part) CHECK(part->points == meant.points);
      }
    }
  const std::string line = binary(drawings[0], true);
  std::string wrong = line;
  wrong[22 + 2 + 8] = '\x51';  // 81, a code that DXF does not have
  CHECK_THAT(fault(wrong), Catch::Contains("group 2: the group code 81 is none of DXF's"));
  CHECK_THAT(fault(line.substr(0, 60)), Catch::Contains("the file ends within it"));
  // What is damaged behind the drawing does not matter.
  const std::string objects = binary(section("ENTITIES", line_on("CUT", 2)) +
                                         section("OBJECTS", "0 DICTIONARY 81 1") + groups("0 EOF"),
                                     true);
  CHECK(read(objects).points.size() == 2);
  CHECK_FALSE(fault(binary(section("OBJECTS", "0 DICTIONARY 81 1") +
                               section("ENTITIES", line_on("CUT", 2)) + groups("0 EOF"),
                           true))
                  .empty());
  DxfOptions small;
  small.most_bytes = 100;
  CHECK_FALSE(fault(line, small).empty());
  CHECK_THAT(fault(binary(drawing("0 LINE 8 CUT 10 1e300 20 0 11 1 21 0"), true)),
             Catch::Contains("group "));
}

TEST_CASE("a header whose end is written into its midst is read whole", "[core][formats][dxf]") {
  const std::string lines = section("ENTITIES", line_on("CUT", 2)) + groups("0 EOF");
  const LineWork inch = read(
      section("HEADER", "9 $ACADVER 1 AC1015 0 ENDSEC 9 $INSUNITS 70 1 9 $DIMEXE 40 2") + lines);
  CHECK(inch.points == read(section("HEADER", "9 $INSUNITS 70 1") + lines).points);
  CHECK_THAT(fault(section("ENTITIES", line_on("CUT", 2) + "0 ENDSEC 0 LINE") + groups("0 EOF")),
             Catch::Contains("is outside of any section"));
}

TEST_CASE("a person's unit replaces that of a DXF and its warning", "[core][formats][dxf]") {
  const std::string no_unit = section("ENTITIES", line_on("CUT", 2)) + groups("0 EOF");
  const std::string inches = section("HEADER", "9 $INSUNITS 70 1") + no_unit;
  CHECK(read(no_unit).points[1].x == 2);
  CHECK(warned(read(no_unit), "no unit"));
  CHECK(read(inches).points[1].x == Approx(50.8));
  DxfOptions cm;
  cm.unit_mm = 10;
  CHECK(read(no_unit, cm).points[1].x == 20);
  CHECK(read(inches, cm).points[1].x == 20);
  CHECK_FALSE(warned(read(no_unit, cm), "no unit"));
}

}  // namespace dxf_reader_test
