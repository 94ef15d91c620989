// SPDX-License-Identifier: MIT
// What popcutd reads from its configuration, its workers and its disk, and what clients read from a
// server that may not be popcutd.
#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include <nlohmann/json.hpp>

#include "daemon/client/address.hpp"
#include "daemon/client/problem_line.hpp"
#include "daemon/client/sse_reader.hpp"
#include "daemon/config/config.hpp"
#include "daemon/planning/frames.hpp"
#include "daemon/planning/program_file.hpp"
#include "daemon/planning/search/search_words.hpp"
#include "daemon/planning/task_json.hpp"
#include "daemon/planning/worker/confinement.hpp"
#include "daemon/store/wal_check.hpp"
#include "tests/fuzz/targets.hpp"

namespace popcut::fuzzing {
namespace {

/// popcutd.toml is refused at a place, or every limit in it is one that popcutd can keep.
void config(std::string_view text) {
  const auto config = daemon::parse_config(text);
  if (!accepted(config)) {
    demand(!config.error().place.empty());
    return;
  }
  demand(config->queue_jobs >= 1 && config->sheets_per_job >= 1 && config->planner.processes >= 1 &&
         config->planner.cpu_s > 0 && config->limits.connections >= 1);
  for (const daemon::DeviceConfig& device : config->devices)
    demand(!device.id.empty() && device.time_scale >= 0);
}

constexpr std::size_t kMostEventBytes = 256;

std::string read_events(std::string_view bytes, std::size_t step) {
  client::SseReader reader(kMostEventBytes);
  std::string seen;
  for (std::size_t at = 0; at < bytes.size() && !reader.broken(); at += step)
    for (const client::SseEvent& event : reader.feed(bytes.substr(at, step))) {
      demand(event.data.size() <= kMostEventBytes && event.kind.size() <= kMostEventBytes);
      seen += event.kind + '|' + event.data + '|' + event.id + '\n';
    }
  return seen + (reader.broken() ? "broken" : reader.last_id());
}

/// A stream of events: however it is cut, the same events are read, and none is larger than
/// allowed.
void client_events(std::string_view bytes) {
  demand(read_events(bytes, bytes.size() + 1) == read_events(bytes, 1));
}

/// An answer of a server that may not be popcutd: status, a line end, the body. And an address that
/// a person typed.
void client_problem(std::string_view bytes) {
  const std::size_t line = std::min(bytes.find('\n'), bytes.size());
  client::HttpResponse response;
  response.status = std::atoi(std::string(bytes.substr(0, std::min<std::size_t>(line, 3))).c_str());
  response.body = bytes.substr(std::min(line + 1, bytes.size()));
  const nlohmann::json sent{{"design", "x"}, {"options", {{"order", "keep"}}}};
  for (const client::Subject subject : {client::Subject::CommandLine, client::Subject::File}) {
    const Error error = client::error_from(response, "sphere.json", subject, &sent);
    demand(!message(error).empty());
    for (const char c : message(error)) demand(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
  }
  (void)accepted(client::parse_address(bytes.substr(0, line)));
}

constexpr std::uint64_t kMostFrameBytes = 4096;

/// What is read of these bytes if they arrive `step` at a time.
std::string read_frames(std::string_view bytes, std::size_t step) {
  planning::FrameReader reader(kMostFrameBytes);
  std::string seen;
  std::uint64_t taken = 0;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    const auto fed = reader.feed(bytes.substr(at, step), [&](planning::Frame frame) {
      taken += frame.bytes.size();
      demand(taken <= kMostFrameBytes && frame.name.size() <= planning::kMostNameBytes);
      demand(frame.name.empty() || planning::is_plain_name(frame.name));
      seen += std::to_string(static_cast<unsigned>(frame.kind)) + frame.name + '|' + frame.bytes;
      return Result<void>();
    });
    if (!accepted(fed)) return seen + " refused";
  }
  return seen + (reader.at_rest() ? " whole" : " open");
}

/// The pipe between popcutd and a worker, in both directions: however it is cut, the same frames
/// are read or refused, and not more of them than allowed. And the walls that a worker reports.
void worker_frames(std::string_view bytes) {
  demand(read_frames(bytes, bytes.size() + 1) == read_frames(bytes, 3));
  const auto walls = planning::read_walls(bytes);
  demand(walls.empty() || planning::walls_text(walls) == bytes);
}

/// Answers of a worker that a hostile design may have taken over, and what lies in the state
/// folder: an index, a line's end, and the program that it belongs to.
void worker_words(std::string_view text) {
  if (const auto outcome = planning::read_outcome(text); accepted(outcome))
    for (const auto& sheet : outcome->sheets)
      demand(std::isfinite(sheet.cut_mm) && std::isfinite(sheet.seconds));
  demand(!planning::read_error(text).detail.empty());
  (void)accepted(planning::read_task(text));
  if (const auto front = planning::read_front(text); accepted(front)) {
    for (const auto& card : front->cards)
      demand(std::isfinite(card.error) && std::isfinite(card.seconds));
    demand(planning::read_front(planning::front_text(*front)).has_value());
  }
  (void)accepted(planning::read_search_words(text));
  const std::size_t line = text.find('\n');
  if (line == text.npos) return;
  const auto program =
      planning::read_program(text.substr(0, line), std::string(text.substr(line + 1)));
  if (!accepted(program)) return;
  const auto check = [bytes = program->bytes.size()](const ByteRange& range) {
    demand(range.begin <= range.end && range.end <= bytes);
  };
  for (const ByteRange& range : program->setup) check(range);
  for (const ByteRange& range : program->strokes) check(range);
  for (const ByteRange& range : {program->geometry, program->trailer, program->search})
    check(range);
  for (const std::uint32_t dot : program->dots) demand(dot < program->strokes.size());
}

/// The write-ahead log in the state folder, as a failing disk or a thief leaves it.
void store_log(std::string_view bytes) {
  static const int file = ::memfd_create("log", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  demand(::ftruncate(file, 0) == 0 &&
         ::pwrite(file, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  const std::string damage = daemon::log_damage(path);
  demand(bytes.size() >= 32 || !damage.empty());
}

constexpr Target kTargets[] = {{"config", config},
                               {"client_events", client_events},
                               {"client_problem", client_problem},
                               {"worker_frames", worker_frames},
                               {"worker_words", worker_words},
                               {"store_log", store_log}};

}  // namespace

std::span<const Target> daemon_targets() { return kTargets; }

}  // namespace popcut::fuzzing
