// SPDX-License-Identifier: MIT
// Previews as a page meets them: from a request on loopback to its whole answer.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/bench/http_load.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/paths.hpp"

namespace preview_bench {

using namespace popcut;
using namespace popcut::testing;
using nlohmann::json;

namespace {

using Clock = std::chrono::steady_clock;

struct Size {
  int slices, units;
};

/// A radius as a hand would drag it: each one a little other than the last.
json sphere(Size size, int step) {
  return {{"popcut", 1},
          {"surface",
           {{"type", "revolution"},
            {"radius", fmt::format("sqrt({}^2 - (y - 45)^2)", 70 + 0.1 * step)}}},
          {"units_per_slice", size.units},
          {"slices", size.slices},
          {"widths_mm", 90.0 / size.slices},
          {"min_panel_mm", 0.3},
          {"lattice", "conformal"}};
}

void measure(KeptConnection& page, Size size, const std::string& quality, int times) {
  std::vector<double> ms;
  std::size_t bytes = 0;
  for (int k = 0; k < times; ++k) {
    const std::string body = json{{"spec", sphere(size, k)}, {"quality", quality}}.dump();
    const auto begun = Clock::now();
    const auto answer = page.ask(fmt::format(
        "POST /v1/preview HTTP/1.1\r\nHost: popcut\r\nContent-Type: application/json\r\n"
        "Preview-Key: one-page-of-a-bench\r\nContent-Length: {}\r\n\r\n{}",
        body.size(), body));
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begun).count());
    REQUIRE(answer.status == 200);
    bytes = answer.body.size();
  }
  const double first = ms.front();
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double part) {
    return ms[static_cast<std::size_t>(part * static_cast<double>(ms.size() - 1))];
  };
  fmt::print("{:5} units, {:5}: median {:7.1f} ms, p95 {:7.1f} ms, first {:7.1f} ms, {:5} kB\n",
             size.slices * size.units, quality, at(0.5), at(0.95), first, bytes >> 10);
}

}  // namespace

TEST_CASE("previews over HTTP", "[bench][preview]") {
  DaemonProcess daemon(popcutd_program(), 0, "previews_per_s = 100000\n");
  REQUIRE(daemon.start());
  KeptConnection page({0, daemon.socket()});
  for (const Size size : {Size{10, 5}, Size{25, 20}, Size{50, 40}}) {
    measure(page, size, "draft", 60);
    measure(page, size, "exact", 20);
  }
  daemon.signal(SIGTERM);
  CHECK(daemon.wait() == 0);
}

}  // namespace preview_bench
