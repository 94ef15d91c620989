// SPDX-License-Identifier: MIT
// The simulated cutter beside recorded sessions of real ones. The recordings are not part of the
// repository: where they are absent the cases say so and pass.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "device/sim/simulate.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/sim_bench.hpp"

namespace device_captures_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

const std::filesystem::path kCaptures{source_file("../shared/captures")};
const std::string kEnquiry = "\x1b\x05";

struct Transfer {
  double seconds{};
  bool out{};
  std::string bytes;
};

struct Session {
  std::string name;
  std::vector<Transfer> transfers;
};

Session read_session(const std::filesystem::path& path) {
  Session session{path.filename().string(), {}};
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    Transfer transfer;
    if (entry.contains("t") && entry["t"].is_number()) transfer.seconds = entry["t"].get<double>();
    transfer.out = entry["dir"] == "out";
    const std::string hex = entry["hex"];
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
      transfer.bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    session.transfers.push_back(std::move(transfer));
  }
  return session;
}

/// Recorded sessions whose name begins with `start`; none, with a warning, where there are none.
std::vector<Session> sessions(const std::string& start) {
  std::vector<Session> list;
  if (std::filesystem::exists(kCaptures))
    for (const auto& entry : std::filesystem::directory_iterator(kCaptures)) {
      const std::string file = entry.path().filename().string();
      if (file.rfind(start, 0) == 0 && file.find(".session.jsonl") != std::string::npos)
        list.push_back(read_session(entry.path()));
    }
  if (list.empty()) WARN("skipped: no recordings of " << start << " at " << kCaptures);
  return list;
}

double seconds(SimCutter::Time time) { return std::chrono::duration<double>(time).count(); }
SimCutter::Time at(double s) { return SimCutter::Time(std::llround(s * 1e9)); }

/// Between which two moments a machine became ready: the last 1 and the first 0 after a write.
struct Ready {
  double last_busy{}, first_ready{};
};

std::optional<Ready> ready_after(const Session& session, std::size_t write) {
  Ready ready{session.transfers[write].seconds, 0};
  bool busy = false;
  for (std::size_t k = write + 1; k < session.transfers.size(); ++k) {
    const Transfer& next = session.transfers[k];
    if (next.out && next.bytes != kEnquiry) return std::nullopt;
    if (next.bytes == "1\x03") {
      ready.last_busy = next.seconds;
      busy = true;
    }
    if (next.bytes != "0\x03" || !busy) continue;
    ready.first_ready = next.seconds;
    return ready;
  }
  return std::nullopt;
}

/// Sends what the recorded host sent, when it sent it. Tells, for each write after which the
/// machine was recorded to become ready, its index, when that was, and when the simulated one is.
/// Returns their number.
template <typename Tell>
std::size_t replay(const Session& session, const Machine& machine, Tell tell) {
  SimCutter sim = cutter(machine);
  std::size_t compared = 0;
  for (std::size_t k = 0; k < session.transfers.size(); ++k) {
    const Transfer& transfer = session.transfers[k];
    if (!transfer.out || transfer.bytes == kEnquiry) continue;
    sim.run_until(at(transfer.seconds));
    REQUIRE(sim.accept(bytes(transfer.bytes)) == transfer.bytes.size());
    const std::optional<Ready> recorded = ready_after(session, k);
    if (!recorded) continue;
    SimCutter ahead = sim;
    ahead.run_dry();
    tell(k, *recorded, seconds(ahead.now()));
    ++compared;
  }
  return compared;
}

std::string form(std::string text) {
  for (char& c : text)
    if (c >= '0' && c <= '9') c = '0';
  // Padding and digits share their columns.
  for (std::size_t i = text.size(); i-- > 1;)
    if (text[i] == '0' && text[i - 1] == ' ') text[i - 1] = '0';
  return text;
}

}  // namespace

TEST_CASE("the simulated Cameo 3 is ready when the recorded one was", "[device][sim]") {
  constexpr double kTolerance = 0.7;  // s, beside the time between two polls
  for (const Session& session : sessions("silhouette_cameo3")) {
    const auto compared =
        replay(session, machine("cameo3"), [&](std::size_t k, Ready recorded, double simulated_s) {
          CAPTURE(session.name, k, recorded.last_busy, recorded.first_ready, simulated_s);
          CHECK(simulated_s > recorded.last_busy - kTolerance);
          CHECK(simulated_s < recorded.first_ready + kTolerance);
        });
    CHECK(compared == 3);  // setup, geometry, trailer
  }
}

TEST_CASE("the simulated Portrait is ready when the recorded one was, within its told spread",
          "[device][sim]") {
  const Machine portrait = machine("portrait");
  for (const Session& session : sessions("la_silhouette_box_thickness_1")) {
    const auto first = std::find_if(session.transfers.begin(), session.transfers.end(),
                                    [](const Transfer& t) { return t.out && t.bytes != kEnquiry; });
    const auto compared =
        replay(session, portrait, [&](std::size_t k, Ready recorded, double simulated_s) {
          CAPTURE(k, recorded.last_busy, recorded.first_ready, simulated_s);
          CHECK(simulated_s == Approx(recorded.first_ready).margin(0.3));
          const double took = recorded.first_ready - first->seconds;
          CHECK(std::abs(simulated_s - first->seconds - took) < portrait.motion.spread * took);
        });
    CHECK(compared == 2);  // geometry and trailer; the settings were not waited for
  }
}

TEST_CASE("rows without a recording of their own tell a wider spread", "[device][machines]") {
  // Recordings exist of these two; see their source.
  const double best = machine("cameo3").motion.spread;
  CHECK(machine("portrait").motion.spread > best);
  for (const Machine& m : value(all_machines()))
    if (m.driven() && m.name != "cameo3" && m.name != "portrait") {
      CAPTURE(m.name);
      CHECK(m.motion.spread >= 0.35);
    }
}

TEST_CASE("simulated variants of the recorded job take as long as the recorded ones",
          "[device][sim]") {
  // Seconds from the last geometry write to the first 0, polled twice a second; one square of the
  // recorded job is 508 units wide with a lead-in and an overcut of 20. Studio's settings.
  struct Variant {
    const char* settings;
    int shift;
    double recorded_s;
  };
  const std::string window = "Z6096,6096\x03J1\x03";
  const Variant variants[] = {{"!5,1\x03"
                               "FX10,1\x03"
                               "FE0,1\x03"
                               "FF1,0,1\x03"
                               "FF1,1,1\x03"
                               "FC0,1,1\x03"
                               "FC18,1,1\x03",
                               0, 20.2},
                              {"!10,1\x03"
                               "FX33,1\x03"
                               "FE0,1\x03"
                               "FF1,0,1\x03"
                               "FF1,1,1\x03"
                               "FC0,1,1\x03"
                               "FC18,1,1\x03",
                               0, 16.8},
                              {"!10,1\x03"
                               "FX18,1\x03"
                               "FC0,1,1\x03"
                               "FE0,1\x03"
                               "FF0,0,1\x03",
                               0, 15.4},
                              {"!5,1\x03"
                               "FX10,1\x03"
                               "FE1,1\x03"
                               "FF1,0,1\x03"
                               "FF1,1,1\x03"
                               "FC0,1,1\x03"
                               "FC18,1,1\x03",
                               0, 24.1},
                              {"!5,1\x03"
                               "FX10,1\x03"
                               "FE1,1\x03"
                               "FF9,0,1\x03"
                               "FF9,9,1\x03"
                               "FC0,1,1\x03"
                               "FC18,1,1\x03",
                               0, 25.5},
                              {"!5,1\x03"
                               "FX10,1\x03"
                               "FE0,1\x03"
                               "FF1,0,1\x03"
                               "FF1,1,1\x03"
                               "FC0,1,1\x03"
                               "FC18,1,1\x03"
                               "Z5596,5900\x03",
                               -100, 15.8}};
  const auto square = [](int f, int c) {
    return fmt::format(
        "M{0},{2}\x03"
        "D{0},{1}\x03"
        "D{3},{1}\x03"
        "D{3},{4}\x03"
        "D{0},{4}\x03"
        "D{0},{1}\x03"
        "D{5},{1}\x03",
        f, c, c + 20, f + 508, c + 508, f + 20);
  };
  for (const Variant& variant : variants) {
    SimCutter sim = cutter(machine("cameo3"));
    sim.accept(
        bytes("TG1\x03"
              "FN0\x03TB50,0\x03\\0,0\x03" +
              window + variant.settings));
    sim.run_dry();
    const int c = variant.shift;
    sim.accept(bytes(square(0, c) + square(0, 5588 + c)));
    sim.run_until(sim.now() + std::chrono::milliseconds(260));
    const SimCutter::Time written = sim.now();
    sim.accept(bytes(square(5588, c) + square(5588, 5588 + c)));
    sim.run_dry();
    CAPTURE(variant.settings);
    CHECK(seconds(sim.now() - written) == Approx(variant.recorded_s).margin(0.7));
    if (variant.shift != 0) CHECK(sim.trace().clipped_mm > 200);
    if (variant.shift == 0) CHECK(sim.trace().clipped_mm == 0);
  }
}

TEST_CASE("the simulated cutter understands every command of the recorded host streams",
          "[device][sim]") {
  for (const char* start : {"silhouette_cameo3", "umockdev", "la_", "doc_tri"})
    for (const Session& session : sessions(start)) {
      const std::string name = start;
      const Machine target = machine(name == "la_"       ? "portrait"
                                     : name == "doc_tri" ? "cameo"
                                                         : "cameo3");
      std::string stream;
      for (const Transfer& transfer : session.transfers)
        if (transfer.out) stream += transfer.bytes;
      // The logic analyser's export has USB control traffic and gaps of its own.
      if (const std::size_t control = stream.find('\x80');
          name == "la_" && control != std::string::npos)
        continue;
      CAPTURE(session.name);
      const Trace trace = value(simulate(bytes(stream), target));
      CHECK(trace.unknown.empty());
      CHECK(trace.remarks.empty());
      if (name == "silhouette_cameo3") {
        CHECK(trace.strokes.size() == 4);
        CHECK(trace.cut_mm == Approx(4 * 2072 * 0.05));
      }
    }
}

TEST_CASE("the simulated cutter replies in the recorded formats", "[device][sim]") {
  std::size_t compared = 0;
  for (const char* start : {"silhouette_cameo3", "umockdev", "la_silhouette_connect"})
    for (const Session& session : sessions(start)) {
      const bool portrait = std::string(start).rfind("la_", 0) == 0;
      SimCutter sim = cutter(machine(portrait ? "portrait" : "cameo3"));
      for (std::size_t k = 0; k < session.transfers.size(); ++k) {
        const Transfer& query = session.transfers[k];
        if (!query.out || query.bytes.empty()) continue;
        sim.run_dry();
        static_cast<void>(sim.take_replies());
        sim.accept(bytes(query.bytes));
        const bool status = query.bytes == kEnquiry;
        std::string recorded;
        for (std::size_t n = k + 1; n < session.transfers.size() && n < k + 4; ++n) {
          const Transfer& reply = session.transfers[n];
          if (reply.out && reply.bytes != kEnquiry) break;
          if (reply.out || (reply.bytes.size() == 2) != status) continue;
          recorded = reply.bytes;
          break;
        }
        const std::string simulated = replies(sim);
        const bool asks = status || query.bytes.size() <= 5;
        if (recorded.empty() || !asks) continue;
        CAPTURE(session.name, k, query.bytes);
        CHECK(form(simulated) == form(recorded));
        if (query.bytes == "FG\x03") CHECK(simulated == recorded);
        ++compared;
      }
    }
  if (std::filesystem::exists(kCaptures)) CHECK(compared > 500);
}

}  // namespace device_captures_test
