// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/sim/sim_cutter.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing {

/// What the simulated cutter received for one attempt at a sheet, from its own log, which survives
/// a killed popcutd. An incomplete last line was never received.
struct Received {
  std::string attempt;
  std::vector<std::byte> bytes;
};

inline std::vector<Received> received_log(const std::filesystem::path& path) {
  std::vector<Received> all;
  if (!std::filesystem::exists(path)) return all;
  const std::string text = text_of_file(path);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) break;
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.rfind("open ", 0) == 0) {
      all.push_back({line.substr(5), {}});
      continue;
    }
    for (std::size_t k = 0; k + 1 < line.size(); k += 2)
      all.back().bytes.push_back(static_cast<std::byte>(std::stoi(line.substr(k, 2), nullptr, 16)));
  }
  return all;
}

/// Where the knife came down for each stroke, as "x y" in hundredths of a millimetre.
inline std::vector<std::string> places_of(const Trace& trace) {
  std::vector<std::string> places;
  for (const TraceStroke& stroke : trace.strokes) {
    const PagePoint p = trace.points_of(stroke).front();
    places.push_back(fmt::format("{:.0f} {:.0f}", 100 * p.x, 100 * p.y));
  }
  return places;
}

/// Where the knife comes down when a cutter executes these bytes.
inline std::vector<std::string> places_cut(const std::vector<std::byte>& bytes,
                                           const Machine& machine) {
  SimOptions around;
  around.unlimited = true;
  auto cutter = SimCutter::make(machine, around);
  if (!cutter) return {"no cutter"};
  cutter->accept(bytes);
  cutter->finish();
  cutter->run_dry();
  return places_of(cutter->trace());
}

/// The strokes in a ledger's ranges.
inline std::set<int> members_of(const nlohmann::json& ranges) {
  std::set<int> all;
  for (const nlohmann::json& range : ranges) {
    const int first = range.is_array() ? range[0].get<int>() : range["first"].get<int>();
    const int last = range.is_array() ? range[1].get<int>() : range["last"].get<int>();
    for (int k = first; k <= last; ++k) all.insert(k);
  }
  return all;
}

}  // namespace popcut::testing
