// SPDX-License-Identifier: MIT
// The simulated cutter beside recorded sessions of real ones. The recordings are not part of the
// repository: where they are absent the cases say so and pass.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include <catch2/catch.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "device/sim_cutter.hpp"

using namespace popcut;

namespace {

const std::filesystem::path kCaptures{POPCUT_SOURCE_DIR "/../shared/captures"};

struct Transfer {
  double seconds{};
  bool out{};
  std::string bytes;
};

std::vector<Transfer> transfers(const std::string& name) {
  std::vector<Transfer> list;
  std::ifstream file(kCaptures / (name + ".session.jsonl"));
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    Transfer transfer;
    transfer.seconds = entry["t"].is_number() ? entry["t"].get<double>() : 0.0;
    transfer.out = entry["dir"] == "out";
    const std::string hex = entry["hex"];
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
      transfer.bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    list.push_back(std::move(transfer));
  }
  return list;
}

std::chrono::nanoseconds at(double seconds) {
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

SimCutter cutter(const std::string& name) {
  const Result<Machine> machine = find_machine(name);
  REQUIRE(machine);
  Result<SimCutter> made = SimCutter::make(*machine);
  REQUIRE(made);
  return std::move(*made);
}

/// Sends what the host sent, when it sent it; seconds that the machine was busy after each write.
struct Replay {
  std::vector<double> busy_s;
  Trace trace;
};

Replay replay(SimCutter sim, const std::vector<Transfer>& session) {
  Replay result;
  for (const Transfer& transfer : session) {
    if (!transfer.out || transfer.bytes == "\x1b\x05") continue;
    sim.run_until(at(transfer.seconds));
    const double sent = std::chrono::duration<double>(sim.now()).count();
    REQUIRE(sim.accept(std::as_bytes(std::span(transfer.bytes))) == transfer.bytes.size());
    SimCutter ahead = sim;
    ahead.run_dry();
    result.busy_s.push_back(std::chrono::duration<double>(ahead.now()).count() - sent);
  }
  sim.run_dry();
  result.trace = sim.trace();
  return result;
}

}  // namespace

TEST_CASE("the simulated Cameo 3 takes about as long as the recorded one", "[device][sim]") {
  if (!std::filesystem::exists(kCaptures)) {
    WARN("skipped: no recordings at " << kCaptures);
    return;
  }
  for (const auto& entry : std::filesystem::directory_iterator(kCaptures)) {
    const std::string file = entry.path().filename().string();
    if (file.find("silhouette_cameo3") != 0 || file.find(".session.jsonl") == std::string::npos)
      continue;
    const std::string name = file.substr(0, file.find('.'));
    const Replay done = replay(cutter("cameo3"), transfers(name));
    for (double s : done.busy_s) fmt::print("{:.2f} ", s);
    fmt::print(" {} cut {:.1f} clipped {:.1f} travel {:.1f}\n", name, done.trace.cut_mm, done.trace.clipped_mm, done.trace.travel_mm);
  }
}
