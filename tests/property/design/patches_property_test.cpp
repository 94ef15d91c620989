// SPDX-License-Identifier: MIT
// Patches, regions and bridges: whatever is made is checked by the verifier.
#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace patches_property_test {

using namespace popcut;

namespace {

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  std::string lattice() {
    const char* names[] = {"branching", "slices", "conformal", "levels", "direct"};
    return names[whole(0, 4)];
  }

 private:
  std::mt19937 random_;
};

/// Regions of random N, on a radius that goes on smoothly or jumps.
std::string random_regions(Random& random, double size) {
  std::string out;
  for (int r = random.whole(1, 4); r > 0; --r)
    out += fmt::format(
        R"j({}{{"units_per_slice":{},"slices":{},"width_mm":{:.3f},"radius":"{:.3f}*(1+{:.3f}*sin(pi*y/L))"}})j",
        out.empty() ? "" : ",", random.whole(1, 12), random.whole(1, 6), random.real(2, 20), size,
        random.real(-0.3, 0.5));
  return out;
}

void check_sound(const Pattern& pattern) {
  std::ostringstream fold;
  REQUIRE(write_fold(pattern, {}, fold));
  VerifyOptions options;
  options.degrees_of_freedom = 1;
  const auto report = testing::value(verify_fold(fold.str(), options));
  if (!report.ok()) FAIL(verify_text(report));
}

/// The shortest slit, and the shortest stretch of paper between two slits of one line, mm.
struct Narrowest {
  double slit_mm{1e9}, joint_mm{1e9};
};

Narrowest narrowest_of(const Pattern& pattern) {
  std::vector<SheetLine> slits;
  for (const SheetLine& line : pattern.lines)
    if (line.role == EdgeRole::Slit) slits.push_back(line);
  std::sort(slits.begin(), slits.end(), [](const SheetLine& a, const SheetLine& b) {
    return a.v0 != b.v0 ? a.v0 < b.v0 : a.u0 < b.u0;
  });
  Narrowest out;
  for (std::size_t k = 0; k < slits.size(); ++k) {
    out.slit_mm = std::min(out.slit_mm, slits[k].u1 - slits[k].u0);
    if (k > 0 && slits[k].v0 == slits[k - 1].v0)
      out.joint_mm = std::min(out.joint_mm, slits[k].u0 - slits[k - 1].u1);
  }
  return out;
}

}  // namespace

TEST_CASE("regions of any units verify with one freedom and bridges between them",
          "[property][design][bridge]") {
  const unsigned seed = 20261122;
  Random random(seed);
  int made = 0, bridged = 0;
  for (int k = 0; k < 80; ++k) {
    const std::string text = fmt::format(
        R"({{"popcut":1,"regions":[{}],"lattice":"{}","min_panel_mm":{:.3f}}})",
        random_regions(random, random.real(25, 100)), random.lattice(), random.real(0.05, 0.8));
    CAPTURE(seed, k, text);
    const auto result = design(testing::value(parse_design_spec(text)));
    if (!result) {
      CHECK(result.error().kind == ErrorKind::Infeasible);
      continue;
    }
    ++made;
    bridged += static_cast<int>(result->report.bridges.size());
    check_sound(result->pattern);
  }
  CHECK(made > 70);
  CHECK(bridged > 60);
}

TEST_CASE("random patches verify each on its own and as one sheet", "[property][design][patches]") {
  const unsigned seed = 20261123;
  Random random(seed);
  int sheets = 0, seams = 0;
  const int all = testing::rounds(60, 3);
  for (int k = 0; k < all; ++k) {
    const double size = random.real(25, 100);
    std::string patches;
    for (int p = random.whole(2, 4); p > 0; --p) {
      patches += fmt::format(R"({}{{"regions":[{}],"lattice":"{}")", patches.empty() ? "" : ",",
                             random_regions(random, size), random.lattice());
      if (random.whole(0, 3) == 0)
        patches += fmt::format(R"(,"card":{{"wall_mm":{:.3f}}})", size * random.real(1.6, 2));
      patches += "}";
    }
    const std::string text =
        fmt::format(R"({{"popcut":1,"patches":[{}],"join":"{}","min_panel_mm":{:.3f}}})", patches,
                    random.whole(0, 3) == 0 ? "seam" : "auto", random.real(0.05, 0.8));
    CAPTURE(seed, k, text);
    const auto made = design_assembly(testing::value(parse_design_spec(text)));
    if (!made) {
      CHECK(made.error().kind == ErrorKind::Infeasible);
      continue;
    }
    double v = 0.0;
    std::size_t ends = 0;
    for (const Design& part : made->parts) {
      check_sound(part.pattern);
      CHECK(part.pattern.place.v_mm == Approx(v));
      v += part.pattern.width_mm;
      ends += part.pattern.seams.size();
      for (const Seam& seam : part.pattern.seams) {
        CHECK((seam.v_mm == 0.0 || seam.v_mm == part.pattern.width_mm));
        CHECK(seam.u0_mm >= 0.0);
        CHECK(seam.u1_mm <= part.pattern.wall_mm + part.pattern.ground_mm + 1e-9);
      }
    }
    CHECK(ends == 2 * (made->parts.size() - 1));
    for (std::size_t p = 1; p < made->patches.size(); ++p)
      CHECK(made->patches[p].v_begin_mm == Approx(made->patches[p - 1].v_end_mm));
    (made->parts.size() == 1 ? sheets : seams) += 1;
  }
  CHECK(sheets > all / 6);
  CHECK(seams > all / 6);
}

TEST_CASE("no slit and no joint is narrower than the smallest panel", "[property][design]") {
  const unsigned seed = 20261124;
  Random random(seed);
  int made = 0;
  for (int k = 0; k < 60; ++k) {
    const int slices = random.whole(1, 20);
    std::string widths;
    for (int j = 0; j < slices; ++j)
      widths += fmt::format("{}{:.3f}", j == 0 ? "" : ",", random.real(1, 20));
    const std::string text = fmt::format(
        R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"{:.3f}*(1+{:.3f}*sin({:.4f}*y+{:.3f}))"}},
             "units_per_slice":{},"slices":{},"widths_mm":[{}],"lattice":"{}","min_panel_mm":{:.3f}}})j",
        random.real(25, 100), random.real(0, 0.6), random.real(0, 0.1), random.real(0, 6),
        random.whole(2, 30), slices, widths, random.lattice(), random.real(0.05, 0.8));
    CAPTURE(seed, k, text);
    const auto spec = testing::value(parse_design_spec(text));
    const auto result = design(spec);
    if (!result) continue;
    ++made;
    const Narrowest narrowest = narrowest_of(result->pattern);
    CHECK(narrowest.slit_mm > spec.min_panel_mm - 1e-6);
    CHECK(narrowest.joint_mm > spec.min_panel_mm - 1e-6);
    for (const PatternEdge& e : result->pattern.edges) {
      const PatternVertex &a = result->pattern.vertices[e.from],
                          &b = result->pattern.vertices[e.to];
      if (std::hypot(result->pattern.u(a) - result->pattern.u(b), a.v - b.v) < 1e-10)
        FAIL_CHECK("an edge has no length");
    }
  }
  CHECK(made > 50);
}

}  // namespace patches_property_test
