// SPDX-License-Identifier: MIT
// Runs inside the virtual machine of `./run test-vm service`: the simulated cutter as a USB device
// that outlives popcutd, and tells in a file what was asked of its knife.
// usage: gadget_cutter FOLDER SPEEDUP   (SIGUSR1: a fresh sheet; SIGUSR2: this one a hundred times
// as fast as the machine)
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "tests/vm/gadget.hpp"

using namespace popcut;
using namespace popcut::testing;

namespace {

/// Pieces of line that the knife went along more than once, either way.
std::size_t cut_twice(const Trace& trace) {
  std::vector<std::tuple<long, long, long, long>> pieces;
  const auto grid = [&](double mm) { return std::lround(mm / trace.unit_mm); };
  for (const TraceStroke& stroke : trace.strokes) {
    const auto points = trace.points_of(stroke);
    for (std::size_t i = 1; i < points.size(); ++i) {
      std::pair a{grid(points[i - 1].x), grid(points[i - 1].y)},
          b{grid(points[i].x), grid(points[i].y)};
      if (b < a) std::swap(a, b);
      pieces.emplace_back(a.first, a.second, b.first, b.second);
    }
  }
  std::sort(pieces.begin(), pieces.end());
  std::size_t twice = 0;
  for (std::size_t i = 1; i < pieces.size(); ++i) twice += pieces[i] == pieces[i - 1] ? 1 : 0;
  return twice;
}

void tell(const std::string& folder, const SimCutter& sim) {
  const std::string file = folder + "/state";
  std::FILE* const out = std::fopen((file + ".new").c_str(), "w");
  if (out == nullptr) return;
  fmt::print(out, "status={} tool={} strokes={} twice={} unknown={} bytes={}\n",
             name_of(sim.status()), sim.tool_down() ? "down" : "up", sim.trace().strokes.size(),
             cut_twice(sim.trace()), sim.trace().unknown_count, sim.accepted_bytes());
  std::fclose(out);
  std::filesystem::rename(file + ".new", file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const double speedup = std::strtod(argv[2], nullptr);
  sigset_t asked;
  sigemptyset(&asked);
  sigaddset(&asked, SIGUSR1);
  sigaddset(&asked, SIGUSR2);
  pthread_sigmask(SIG_BLOCK, &asked, nullptr);
  const auto cutter = [] { return *SimCutter::make(*find_machine("cameo3")); };
  Gadget gadget(cutter(), speedup);
  if (!gadget.lawful()) return 1;
  constexpr timespec kStep{0, 200'000'000};
  for (;;) {
    const int signal = sigtimedwait(&asked, nullptr, &kStep);
    if (signal == SIGUSR1) {
      gadget.run_at(speedup);
      gadget.fresh(cutter());
    }
    if (signal == SIGUSR2) gadget.run_at(100);
    gadget.with_cutter([&](const SimCutter& sim) { tell(argv[1], sim); });
  }
}
