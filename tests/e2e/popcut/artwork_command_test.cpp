// SPDX-License-Identifier: MIT
// popcut print: pages with artwork, in register with the program.
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/geometry/page_point.hpp"
#include "core/machines/machine.hpp"
#include "daemon/pictures/image_reader.hpp"
#include "tests/support/command_bench.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/painted_shell.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"

namespace artwork_command_test {

using namespace popcut;
using namespace popcut::testing;
using nlohmann::json;

namespace {

/// A painted shell with its spec, small enough for a mat of 130 x 190 mm.
struct ShellBench : CommandBench {
  ShellBench() {
    const PaintedShell shell = painted_shells()[0];
    const auto skin = value(png_of_image(shell.texture(64)));
    write_file(temp / "shell.obj", shell.obj());
    write_file(temp / "shell.mtl", "newmtl skin\nmap_Kd skin.png\n");
    write_file(temp / "skin.png", skin);
    write_file(temp / "shell.json", PaintedShell::spec(3, 5, 25));
    ColourImage yellow(8, 8);
    for (std::size_t k = 0; k < 64; ++k) yellow.set(k % 8, k / 8, {250, 220, 60, 255});
    const auto png = value(png_of_image(yellow));
    write_file(temp / "yellow.png", png);
  }
};

/// Grey pixels of a PDF's first page (poppler).
struct Grey {
  std::size_t width{}, height{};
  std::string pixels;
  double pixel_mm{};

  Grey(const CommandBench& bench, const std::string& pdf, int dpi) : pixel_mm(25.4 / dpi) {
    const Ran ran = run_program({"/usr/bin/pdftoppm", "-r", std::to_string(dpi), "-gray", "-f", "1",
                                 "-l", "1", "-singlefile", pdf, "page"},
                                bench.temp.path());
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    const std::string text = text_of_file(bench.temp / "page.pgm");
    REQUIRE(text.rfind("P5", 0) == 0);
    char* at = nullptr;
    width = std::strtoul(text.c_str() + 2, &at, 10);
    height = std::strtoul(at, &at, 10);
    REQUIRE(std::strtoul(at, &at, 10) == 255);
    pixels = text.substr(static_cast<std::size_t>(at - text.c_str()) + 1);
    REQUIRE(pixels.size() == width * height);
  }

  /// The box around what is nearly black above `bottom_mm`, mm.
  [[nodiscard]] Box dark(double bottom_mm) const {
    Box box;
    for (std::size_t j = 0; j < height && static_cast<double>(j) * pixel_mm < bottom_mm; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        if (static_cast<unsigned char>(pixels[j * width + i]) > 127) continue;
        box.add({static_cast<double>(i) * pixel_mm, static_cast<double>(j) * pixel_mm});
        box.add({static_cast<double>(i + 1) * pixel_mm, static_cast<double>(j + 1) * pixel_mm});
      }
    return box;
  }
};

/// Coloured pixels of a picture (PPM).
struct Rgb {
  std::size_t width{}, height{};
  std::string rgb;
};
Rgb read_ppm(const std::string& text) {
  REQUIRE(text.rfind("P6", 0) == 0);
  Rgb out;
  char* at = nullptr;
  out.width = std::strtoul(text.c_str() + 2, &at, 10);
  out.height = std::strtoul(at, &at, 10);
  REQUIRE(std::strtoul(at, &at, 10) == 255);
  out.rgb = text.substr(static_cast<std::size_t>(at - text.c_str()) + 1);
  REQUIRE(out.rgb.size() == 3 * out.width * out.height);
  return out;
}

/// The rectangle of the marks that a program searches for: height, width, top and left, in units.
std::array<double, 4> searched(const std::string& program) {
  for (const char* command : {"TB123,", "TB124,"}) {
    const std::size_t at = program.find(command);
    if (at == std::string::npos) continue;
    std::array<double, 4> out{};
    const char* text = program.c_str() + at + 6;
    for (double& value : out) {
      char* end = nullptr;
      value = std::strtod(text, &end);
      text = end + 1;
    }
    return out;
  }
  FAIL("the program searches for no marks");
  return {};
}

TEST_CASE("the marks of a printed page lie where the program of each machine looks for them",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  int machines = 0;
  const json listed = json::parse(bench.popcut({"machines", "--json"}).out);
  for (const json& row : listed["machines"]) {
    const std::string name = row["name"];
    if (row["language"] != "gpgl") continue;
    CAPTURE(name);
    const auto machine = value(find_machine(name));
    const Ran ran =
        bench.popcut({"print", "shell.json", "--mode", "flat", "--image", "yellow.png", "--machine",
                      name, "--mat", "130x190", "--dpi", "72", "-o", "pages", "-q"});
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    ++machines;
    constexpr int kDpi = 508;  // 0.05 mm; the grey of a pixel tells where in it an edge lies
    const Box printed = Grey(bench, "pages/sheet-01.pdf", kDpi).dark(190 - 29);
    const auto [height, width, top, left] =
        searched(text_of_file(bench.temp / "pages/sheet-01.gpgl"));
    const double unit = machine.unit_mm, within = 0.05;
    CHECK_THAT(printed.x0,
               Catch::WithinAbs(left * unit - machine.margin_left_mm + machine.marks.before_left_mm,
                                within));
    CHECK_THAT(
        printed.y0,
        Catch::WithinAbs(top * unit - machine.margin_top_mm + machine.marks.before_top_mm, within));
    CHECK_THAT(printed.width(), Catch::WithinAbs(width * unit, within));
    CHECK_THAT(printed.height(), Catch::WithinAbs(height * unit, within));
  }
  CHECK(machines >= 5);
}

TEST_CASE("the back of a page lies behind its front, also for printers that scale",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  for (const char* scale : {"100", "95"})
    for (const char* machine : {"none", "cameo3"}) {
      CAPTURE(scale, machine);
      const Ran ran = bench.popcut({"print", "shell.json", "--clay", "--machine", machine,
                                    "--no-marks", "--mat", "A4", "--page", "A3", "--dpi", "72",
                                    "--back", "--scale-x", scale, "-o", "pages", "-q"});
      CAPTURE(ran.err);
      REQUIRE(ran.exit == 0);
      // The middle of what is coloured on the front, from the left, is that of the back from the
      // right.
      const auto middle = [&](const char* page) {
        const Ran drawn = run_program({"/usr/bin/pdftoppm", "-r", "100", "-f", page, "-l", page,
                                       "-singlefile", "pages/sheet-01.pdf", "page"},
                                      bench.temp.path());
        REQUIRE(drawn.exit == 0);
        const auto picture = read_ppm(text_of_file(bench.temp / "page.ppm"));
        double low = 1e9, high = -1e9;
        for (std::size_t k = 0; k + 2 < picture.rgb.size(); k += 3) {
          const int red = static_cast<unsigned char>(picture.rgb[k]),
                    green = static_cast<unsigned char>(picture.rgb[k + 1]),
                    blue = static_cast<unsigned char>(picture.rgb[k + 2]);
          // Clay, not lines: red more than green more than blue, by little.
          if (red - green < 20 || red - green > 60 || green - blue < 15 || green - blue > 60)
            continue;
          const double x = static_cast<double>((k / 3) % picture.width) * 0.254;
          low = std::min(low, x), high = std::max(high, x);
        }
        REQUIRE(low < high);
        return std::pair(0.5 * (low + high), static_cast<double>(picture.width) * 0.254);
      };
      const auto [front, width] = middle("1");
      const auto [back, same] = middle("2");
      CHECK(width == same);
      CHECK_THAT(back, Catch::WithinAbs(width - front, 0.8));
    }
}

TEST_CASE("a printer that scales is answered by the opposite scale", "[cli][e2e][artwork]") {
  const ShellBench bench;
  const auto box_of = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"print",      "shell.json", "--mode",  "flat",    "--image",
                                 "yellow.png", "--mat",      "130x190", "--marks", "--dpi",
                                 "72",         "-o",         "pages",   "-q"};
    all.insert(all.end(), more.begin(), more.end());
    REQUIRE(bench.popcut(all).exit == 0);
    return Grey(bench, "pages/sheet-01.pdf", 508).dark(190 - 29);
  };
  const Box plain = box_of({}), scaled = box_of({"--scale-x", "99", "--scale-y", "101"});
  CHECK_THAT(scaled.width(), Catch::WithinAbs(plain.width() / 0.99, 0.1));
  CHECK_THAT(scaled.height(), Catch::WithinAbs(plain.height() / 1.01, 0.1));
}

TEST_CASE("popcut print writes pages, programs and a preview, and the same again",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  const std::vector<std::string> words{"print",  "shell.json", "--mat", "12x12",  "--machine",
                                       "cameo3", "--dpi",      "100",   "--back", "--preview",
                                       "-o",     "pages",      "-q"};
  REQUIRE(bench.popcut(words).exit == 0);
  const std::string pdf = text_of_file(bench.temp / "pages/sheet-01.pdf");
  CHECK(pdf.rfind("%PDF", 0) == 0);
  CHECK(text_of_file(bench.temp / "pages/preview.glb").rfind("glTF", 0) == 0);
  const std::string picture = text_of_file(bench.temp / "pages/preview.png");
  const auto tiles = value(read_image("preview.png", picture));
  CHECK(tiles.width == 3 * tiles.height);
  CHECK(says(text_of_file(bench.temp / "pages/sheet-01.gpgl"), "TB123,"));
  CHECK(bench.read_json("pages/plan.json")["sheets"][0]["registration"]["left_mm"] == 10);
  const Ran info = run_program({"/usr/bin/pdfinfo", "pages/sheet-01.pdf"}, bench.temp.path());
  CHECK(says(info.out, "Pages:           2"));
  CHECK(says(info.out, "864 x 864 pts"));  // 12 inches
  REQUIRE(bench.popcut(words).exit == 0);
  CHECK(text_of_file(bench.temp / "pages/sheet-01.pdf") == pdf);
  CHECK(text_of_file(bench.temp / "pages/preview.png") == picture);
}

TEST_CASE("the picture of a printed design shows the model, and the card from two sides",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  const auto tiles_of = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"print",     "shell.json", "--no-marks", "--dpi", "72",
                                 "--preview", "-o",         "pages",      "-q"};
    all.insert(all.end(), more.begin(), more.end());
    REQUIRE(bench.popcut(all).exit == 0);
    const auto image =
        value(read_image("preview.png", text_of_file(bench.temp / "pages/preview.png")));
    // Of each tile: pixels with colour.
    std::vector<std::size_t> out(image.width / image.height);
    for (std::size_t j = 0; j < image.height; ++j)
      for (std::size_t i = 0; i < image.width; ++i) {
        const auto [least, most] = std::minmax_element(image.at(i, j), image.at(i, j) + 3);
        out[i / image.height] += *most - *least > 40 ? 1 : 0;
      }
    return out;
  };
  const auto painted = tiles_of({});
  REQUIRE(painted.size() == 3);
  for (const std::size_t pixels : painted) CHECK(pixels > 5000);
  // A picture of your own has no model; it is laid over all of the card.
  const auto flat = tiles_of({"--mode", "flat", "--image", "yellow.png"});
  REQUIRE(flat.size() == 2);
  for (const std::size_t pixels : flat) CHECK(pixels > 20000);
  write_file(bench.temp / "shell.json",
             R"({"popcut": 1, "name": "b", "surface": {"type": "mesh", "file": "shell.obj"},
                 "scale_mm": 25, "units_per_slice": 4, "slices": 8, "widths_mm": 5,
                 "book": {"cards": 4}})");
  const auto book = tiles_of({});
  REQUIRE(book.size() == 3);
  for (std::size_t k = 0; k < 2; ++k) CHECK(book[k] > 2000);
}

TEST_CASE("a printed design that is split is cut by the same programs as it is planned",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  REQUIRE(bench
              .popcut({"print", "shell.json", "--machine", "cameo3", "--mat", "100x120", "--dpi",
                       "72", "-o", "pages", "-q"})
              .exit == 0);
  REQUIRE(bench
              .popcut({"plan", "shell.json", "--machine", "cameo3", "--mat", "100x120", "--marks",
                       "-o", "plan", "-q"})
              .exit == 0);
  const std::size_t sheets = bench.read_json("pages/plan.json")["sheets"].size();
  REQUIRE(sheets >= 2);
  for (std::size_t k = 1; k <= sheets; ++k) {
    const std::string program = fmt::format("sheet-{:02}.gpgl", k);
    CHECK(text_of_file(bench.temp / ("pages/" + program)) ==
          text_of_file(bench.temp / ("plan/" + program)));
    CHECK(std::filesystem::exists(bench.temp / fmt::format("pages/sheet-{:02}.pdf", k)));
  }
}

TEST_CASE("popcut print says how its pages are cut, or why they have no marks",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  const auto said = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"print", "shell.json", "--dpi", "72", "-o", "pages"};
    all.insert(all.end(), more.begin(), more.end());
    const Ran ran = bench.popcut(all);
    CAPTURE(ran.err);
    REQUIRE(ran.exit == 0);
    return ran.err;
  };
  const std::string marked = said({"--machine", "cameo3", "--mat", "130x190", "--order", "keep"});
  const std::string command =
      "popcut cut shell.json --machine cameo3 --mat 130x190 --order keep --marks --direct";
  CHECK(says(marked, command + " --device usb:SERIAL"));
  CHECK(says(marked, "printed side up"));
  // It cuts what was printed: the programs are the same.
  REQUIRE(bench
              .popcut({"cut", "shell.json", "--machine", "cameo3", "--mat", "130x190", "--order",
                       "keep", "--marks", "--direct", "--yes", "-o", "cut", "-q"})
              .exit == 0);
  CHECK(text_of_file(bench.temp / "cut/sheet-01.gpgl") ==
        text_of_file(bench.temp / "pages/sheet-01.gpgl"));
  CHECK(says(said({"--machine", "cameo3", "--mat", "100x120"}),
             "print pages/sheet-01.pdf to pages/sheet-02.pdf"));
  const std::string unnamed = said({"--mat", "130x190"});
  CHECK(says(unnamed, "no cutter is named"));
  CHECK_FALSE(says(unnamed, "popcut cut"));
  CHECK(says(said({"--machine", "hpgl-generic"}), "does not look for them"));
  CHECK_FALSE(says(said({"--no-marks"}), "without marks"));
}

TEST_CASE("facets are printed in every mode, in one piece and in several", "[cli][e2e][artwork]") {
  const ShellBench bench;
  write_file(bench.temp / "shell.json", PaintedShell::facet_spec(25));
  for (const char* mode : {"view", "surface", "lines"})
    for (const char* mat : {"130x190", "100x120"}) {
      CAPTURE(mode, mat);
      const Ran ran =
          bench.popcut({"print", "shell.json", "--mode", mode, "--machine", "cameo3", "--mat", mat,
                        "--dpi", "72", "--preview", "-o", std::string(mode) + mat, "-q"});
      CAPTURE(ran.err);
      REQUIRE(ran.exit == 0);
      const std::string folder = std::string(mode) + mat;
      const std::size_t sheets = bench.read_json(folder + "/plan.json")["sheets"].size();
      CHECK((sheets > 1) == (std::string(mat) == "100x120"));
      const Grey page(bench, folder + "/sheet-01.pdf", 72);
      std::size_t grey = 0;
      for (const char pixel : page.pixels)
        grey += static_cast<unsigned char>(pixel) < 240 && static_cast<unsigned char>(pixel) > 60;
      CHECK(grey > 300);
    }
}

TEST_CASE("each card of a book shows its own side of the model", "[cli][e2e][artwork]") {
  const CommandBench bench;
  // A ball whose quarters about the spine have four colours.
  constexpr std::array<std::array<int, 3>, 4> kColours{
      {{200, 30, 30}, {30, 160, 40}, {40, 60, 200}, {220, 180, 20}}};
  const auto ball = popcut::testing::icosphere(40, 3);
  std::string obj;
  for (std::size_t t = 0; t < ball.corners.size() / 9; ++t) {
    const float* c = ball.corners.data() + 9 * t;
    const bool left = c[0] + c[3] + c[6] < 0, low = c[1] + c[4] + c[7] < 0;
    const auto& colour = kColours[low ? (left ? 2 : 3) : (left ? 1 : 0)];
    for (std::size_t k = 0; k < 9; k += 3)
      obj += fmt::format("v {} {} {} {} {} {}\n", c[k], c[k + 1], c[k + 2], colour[0] / 255.0,
                         colour[1] / 255.0, colour[2] / 255.0);
    obj += "f -3 -2 -1\n";
  }
  write_file(bench.temp / "ball.obj", obj);
  write_file(bench.temp / "ball.json",
             R"({"popcut": 1, "name": "ball", "surface": {"type": "mesh", "file": "ball.obj"},
                 "units_per_slice": 4, "slices": 8, "widths_mm": 9, "book": {"cards": 4}})");
  const Ran ran = bench.popcut({"print", "ball.json", "--machine", "cameo3", "--mat", "12x12",
                                "--dpi", "60", "-o", "pages", "-q"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  // The person who cuts four cards reads which is which.
  REQUIRE(bench
              .popcut({"print", "ball.json", "--machine", "none", "--mat", "A3", "--dpi", "60",
                       "-o", "by-hand", "-q"})
              .exit == 0);
  std::string words;
  for (std::size_t k = 1; k <= bench.read_json("by-hand/plan.json")["sheets"].size(); ++k)
    words += run_program({"/usr/bin/pdftotext", fmt::format("by-hand/sheet-{:02}.pdf", k), "-"},
                         bench.temp.path())
                 .out;
  for (const char* card : {"card 1", "card 2", "card 3", "card 4"}) {
    CAPTURE(card, words);
    CHECK(says(words, card));
  }
  std::array<std::size_t, 4> seen{};
  const std::size_t sheets = bench.read_json("pages/plan.json")["sheets"].size();
  for (std::size_t k = 1; k <= sheets; ++k) {
    const Ran drawn = run_program({"/usr/bin/pdftoppm", "-r", "50", "-singlefile",
                                   fmt::format("pages/sheet-{:02}.pdf", k), "page"},
                                  bench.temp.path());
    REQUIRE(drawn.exit == 0);
    const std::string page = text_of_file(bench.temp / "page.ppm");
    for (std::size_t at = page.size() % 3; at + 2 < page.size(); at += 3)
      for (std::size_t c = 0; c < 4; ++c) {
        int off = 0;
        for (std::size_t i = 0; i < 3; ++i)
          off += std::abs(static_cast<unsigned char>(page[at + i]) - kColours[c][i]);
        if (off < 30) ++seen[c];
      }
  }
  const auto [least, most] = std::minmax_element(seen.begin(), seen.end());
  CAPTURE(seen[0], seen[1], seen[2], seen[3]);
  CHECK(*least > 1000);
  CHECK(*most < 2 * *least);
}

TEST_CASE("pages to cut by hand have lines over the artwork, exactly where they are planned",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  const std::vector<std::string> words{"print",      "shell.json", "--mode", "flat",  "--image",
                                       "yellow.png", "--machine",  "none",   "--mat", "A4",
                                       "--dpi",      "72",         "-o",     "pages"};
  const Ran ran = bench.popcut(words);
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(says(ran.err, "cut the solid ones"));
  CHECK_FALSE(says(ran.err, "popcut cut"));
  const std::string text =
      run_program({"/usr/bin/pdftotext", "pages/sheet-01.pdf", "-"}, bench.temp.path()).out;
  for (const char* entry : {"mountain fold", "valley fold", "cut", "100 mm: measure it"}) {
    CAPTURE(entry, text);
    CHECK(says(text, entry));
  }
  // The outline is drawn where plan.json says, 8 mm from the paper's edges; yellow is not dark.
  REQUIRE(
      bench.popcut({"plan", "shell.json", "--machine", "none", "--mat", "A4", "-o", "plain", "-q"})
          .exit == 0);
  const std::string plain = text_of_file(bench.temp / "plain/sheet-01.svg");
  const std::string svg = text_of_file(bench.temp / "pages/sheet-01.svg");
  const Box printed = Grey(bench, "pages/sheet-01.pdf", 508).dark(297 - 31);
  const Ran facts = bench.popcut({"plan", "pages/sheet-01.svg", "--machine", "none", "--mat", "A4",
                                  "-o", "again", "--json", "-q"});
  CAPTURE(facts.err);
  REQUIRE(facts.exit == 0);
  // Other programs get the same lines, with the picture as a layer that popcut does not cut.
  CHECK(says(svg, "inkscape:label=\"print\""));
  CHECK(says(svg, "data:image/png;base64,"));
  CHECK(says(svg, plain.substr(plain.find("<g id=\"fold"))));
  CHECK(json::parse(facts.out)["sheets"][0]["cut_mm"].get<double>() ==
        Approx(bench.read_json("plain/plan.json")["sheets"][0]["cut_mm"].get<double>()));
  CHECK(printed.x0 > 7.5);
  CHECK(printed.y0 > 7.5);
}

TEST_CASE("lines over the artwork of a cutter's page are where its program cuts",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  const auto made = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"print",      "shell.json", "--mode",  "flat",      "--image",
                                 "yellow.png", "--mat",      "130x190", "--machine", "cameo3",
                                 "--dpi",      "72",         "-o",      "pages",     "-q"};
    all.insert(all.end(), more.begin(), more.end());
    REQUIRE(bench.popcut(all).exit == 0);
    return Grey(bench, "pages/sheet-01.pdf", 254);
  };
  const Grey plain = made({});
  CHECK_FALSE(std::filesystem::exists(bench.temp / "pages/sheet-01.svg"));
  const std::string program = text_of_file(bench.temp / "pages/sheet-01.gpgl");
  const Grey lined = made({"--cut-lines", "--back"});
  CHECK(std::filesystem::exists(bench.temp / "pages/sheet-01.svg"));
  // The knife does the same; the marks are the outermost that is dark, with lines or without.
  CHECK(text_of_file(bench.temp / "pages/sheet-01.gpgl") == program);
  CHECK_THAT(lined.dark(190 - 29).x0, Catch::WithinAbs(plain.dark(190 - 29).x0, 0.11));
  CHECK_THAT(lined.dark(190 - 29).width(), Catch::WithinAbs(plain.dark(190 - 29).width(), 0.21));
  const auto darkness = [](const Grey& page) {
    return std::count_if(page.pixels.begin(), page.pixels.end(),
                         [](char grey) { return static_cast<unsigned char>(grey) < 128; });
  };
  CHECK(darkness(lined) > darkness(plain) + 1000);
}

TEST_CASE("a Cricut gets the artwork and the lines apart, around one middle",
          "[cli][e2e][artwork]") {
  const ShellBench bench;
  const Ran ran = bench.popcut(
      {"print", "shell.json", "--machine", "cricut-maker", "--dpi", "100", "-o", "pages"});
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  CHECK(says(ran.err, "Print Then Cut"));
  const auto picture =
      value(read_image("sheet-01.png", text_of_file(bench.temp / "pages/sheet-01.png")));
  const std::string svg = text_of_file(bench.temp / "pages/sheet-01-cricut.svg");
  CHECK(says(svg, "id=\"cut\""));
  CHECK_FALSE(says(svg, "<image"));
  // The picture is 1 mm larger on every side, and nothing of it is trimmed.
  for (std::size_t k = 3; k < picture.rgba.size(); k += 4) REQUIRE(picture.rgba[k] == 255);
  Box box;
  for (std::size_t at = svg.find("d=\"M"); at != std::string::npos;
       at = svg.find("d=\"M", at + 1)) {
    const std::size_t end = svg.find('"', at + 3);
    std::string data = svg.substr(at + 3, end - at - 3);
    for (char& c : data)
      if (c == 'M' || c == 'L' || c == 'Z' || c == ',') c = ' ';
    const char* from = data.c_str();
    for (char* next = nullptr;; from = next) {
      PagePoint p;
      p.x = std::strtod(from, &next);
      if (next == from) break;
      from = next;
      p.y = std::strtod(from, &next);
      box.add(p);
    }
  }
  constexpr double kPoint_mm = 25.4 / 72;
  CHECK_THAT(static_cast<double>(picture.width) * 0.254,
             Catch::WithinAbs(box.width() * kPoint_mm + 2, 0.3));
  CHECK_THAT(static_cast<double>(picture.height) * 0.254,
             Catch::WithinAbs(box.height() * kPoint_mm + 2, 0.3));
}

TEST_CASE("what popcut print cannot print is one line", "[cli][e2e][artwork]") {
  const ShellBench bench;
  const auto refused = [&](std::vector<std::string> more, int exit, const std::string& words) {
    std::vector<std::string> all{"print", "shell.json", "--dpi", "72", "-o", "pages", "-q"};
    all.insert(all.end(), more.begin(), more.end());
    check_refused(bench.popcut(all), exit, words);
    CHECK_FALSE(std::filesystem::exists(bench.temp / "pages/sheet-01.pdf"));
  };
  write_file(bench.temp / "broken.png", "\x89PNG\r\n\x1a\n and no more");
  refused({"--mode", "flat", "--image", "broken.png"}, 3,
          "broken.png: is a picture that cannot be read");
  refused({"--mode", "flat", "--image", "absent.png"}, 3, "absent.png");
  refused({"--mode", "flat"}, 2, "give it with --image FILE");
  check_refused(bench.popcut({"print", "shell.obj", "-o", "pages", "-q"}), 3,
                "shell.obj: is a 3D model; 'popcut auto shell.obj -o cards' makes cards of it");
  check_refused(bench.popcut({"verify", "shell.obj"}), 3,
                "shell.obj: is a 3D model, and verify reads a pattern");
  check_refused(bench.popcut({"deploy", "shell.obj", "-o", "poses"}), 3,
                "shell.obj: is a 3D model, and deploy reads a pattern");
  refused({"--image", "yellow.png"}, 2, "--mode flat");
  refused({"--page", "A4"}, 4, "--page: is 210 x 297 mm, smaller than the sheet of 304.8 x 304.8");
  refused({"--at", "11,11", "--mode", "surface"}, 4, "registration mark");
  refused({"--scale-x", "80"}, 2, "--scale-x");
  // Nobody asked for the marks: what was asked for is named, and what to type instead.
  refused({"--scale", "2"}, 2, "--scale: and registration marks exclude each other");
  refused({"--scale", "2"}, 2, "--no-marks");
  refused({"--per-sheet", "2"}, 2,
          "--per-sheet: and registration marks exclude each other, and popcut prints marks for");
  refused({"--per-sheet", "2", "--marks"}, 2, "--per-sheet");
  refused({"--scale", "x"}, 2, "--scale");
  refused({"--model", "absent.glb"}, 3, "absent.glb");
  std::filesystem::create_directory(bench.temp / "folder");
  REQUIRE(::mkfifo((bench.temp / "pipe").c_str(), 0600) == 0);
  for (const char* name : {"folder", "pipe", "/dev/zero"}) {
    write_file(bench.temp / "shell.mtl", fmt::format("newmtl skin\nmap_Kd {}\n", name));
    refused({}, 3, fmt::format("shell.mtl: line 2: the picture {} cannot be read", name));
  }
  write_file(bench.temp / "shell.mtl", "newmtl skin\nmap_Kd absent.png\n");
  refused({}, 3, "shell.mtl: line 2: the picture absent.png cannot be read");
  REQUIRE(
      bench.popcut({"print", "shell.json", "--clay", "--dpi", "72", "-o", "pages", "-q"}).exit ==
      0);
}

}  // namespace
}  // namespace artwork_command_test
