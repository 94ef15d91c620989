// SPDX-License-Identifier: MIT
#include "daemon/devices/line_figures.hpp"

#include <fmt/format.h>

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
  const std::lock_guard lock(mutex_);
  figures_.writes.add(seconds);
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
      "# HELP popcut_usb_errors Errors on the line to a cutter (USB or port), by kind.\n";
  // Show all kinds from the start, so that their rates are known.
  for (const auto& [device, shown] : devices)
    for (const char* kind : {"timeout", "stall", "short", "nodev", "overflow", "other"}) {
      const auto found = shown.errors.find(kind);
      out +=
          fmt::format("popcut_usb_errors_total{{device=\"{}\",kind=\"{}\"}} {}\n",
                      metric_label(device), kind, found == shown.errors.end() ? 0 : found->second);
    }
  out +=
      "# TYPE popcut_usb_write_seconds histogram\n"
      "# HELP popcut_usb_write_seconds Duration of writes to a cutter.\n";
  for (const auto& [device, shown] : devices)
    shown.writes.append(out, "popcut_usb_write_seconds",
                        fmt::format("device=\"{}\"", metric_label(device)));
  return out;
}

}  // namespace popcut::daemon
