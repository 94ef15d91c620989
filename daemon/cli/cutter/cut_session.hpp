// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "daemon/cli/cutter/cut_device.hpp"
#include "device/session/session.hpp"
#include "device/sim/trace.hpp"

namespace popcut::cli {

/// How a program ended on a device.
struct SentProgram {
  SessionEnd end;
  std::optional<Trace> trace;  ///< of a simulated cutter
  bool stop_asked{};           ///< also where it came too late to stop anything
};

/// A program for a device, and what is said of it.
struct ProgramToSend {
  const EncodedProgram& program;
  std::string file;               ///< where it goes, if the device is a file
  std::array<double, 2> area_mm;  ///< of the sheet, for the simulated cutter
  double seconds{};               ///< expected, for the progress bar
};

/// Sends a program to the device as the machine `driven`, with a progress bar if `progress`.
/// Ctrl-C, SIGTERM and a closed terminal stop it at the end of a stroke, with the tool up; the key
/// p pauses it. `options` may choose how the session behaves; what it says of stopping and progress
/// is replaced.
///
/// @retval DeviceGone, Refused, Unwritable  the device cannot be opened; errors after that are in
///                                          `SessionEnd::error`
[[nodiscard]] Result<SentProgram> send_program(const CutTarget& target, const Machine& driven,
                                               const ProgramToSend& what, bool progress,
                                               SessionOptions options = {});

}  // namespace popcut::cli
