// SPDX-License-Identifier: MIT
#include "daemon/devices/line_figures.hpp"

#include <fmt/format.h>

#include "daemon/devices/metric_label.hpp"

namespace popcut::daemon {
namespace {

const char* kind_of(const Error& error, bool short_write) {
  if (error.kind == ErrorKind::DeviceGone) return "nodev";
  if (error.kind == ErrorKind::Timeout) return "timeout";
  if (error.reason == ErrorReason::Overflow) return "overflow";
  if (error.reason == ErrorReason::Stalled) return "stall";
  return short_write ? "short" : "other";
}

}  // namespace

void LineFigures::note_write(double seconds) {
  std::size_t bucket = 0;
  while (bucket < kBounds.size() && seconds > kBounds[bucket]) ++bucket;
  const std::lock_guard lock(mutex_);
  ++figures_.write_buckets[bucket];
  ++figures_.writes;
  figures_.write_seconds += seconds;
}

void LineFigures::note_error(const Error& error, bool short_write) {
  const std::lock_guard lock(mutex_);
  ++figures_.errors[kind_of(error, short_write)];
}

LineFigures::Shown LineFigures::shown() const {
  const std::lock_guard lock(mutex_);
  return figures_;
}

std::string line_metrics(const std::vector<std::pair<std::string, LineFigures::Shown>>& devices) {
  std::string out =
      "# TYPE popcut_usb_errors counter\n"
      "# HELP popcut_usb_errors Errors on the line to a cutter, USB or port, by kind.\n";
  // Those that there are are shown from the start, so that their rate is known.
  for (const auto& [device, shown] : devices)
    for (const char* kind : {"timeout", "stall", "short", "nodev", "overflow", "other"}) {
      const auto found = shown.errors.find(kind);
      out +=
          fmt::format("popcut_usb_errors_total{{device=\"{}\",kind=\"{}\"}} {}\n",
                      metric_label(device), kind, found == shown.errors.end() ? 0 : found->second);
    }
  out += "# TYPE popcut_usb_write_seconds histogram\n";
  for (const auto& [device, shown] : devices) {
    const std::string name = metric_label(device);
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < shown.write_buckets.size(); ++i) {
      below += shown.write_buckets[i];
      const std::string bound =
          i < LineFigures::kBounds.size() ? fmt::format("{}", LineFigures::kBounds[i]) : "+Inf";
      out += fmt::format("popcut_usb_write_seconds_bucket{{device=\"{}\",le=\"{}\"}} {}\n", name,
                         bound, below);
    }
    out += fmt::format(
        "popcut_usb_write_seconds_sum{{device=\"{0}\"}} {1:.6f}\n"
        "popcut_usb_write_seconds_count{{device=\"{0}\"}} {2}\n",
        name, shown.write_seconds, shown.writes);
  }
  return out;
}

}  // namespace popcut::daemon
