// SPDX-License-Identifier: MIT
#include "daemon/devices/cutter_line.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "daemon/files/user_tables.hpp"
#include "device/port/file_transport.hpp"
#include "device/port/port_transport.hpp"
#include "device/sim/trace.hpp"

namespace popcut::daemon {
namespace {

/// Every byte that a simulated cutter took, a line a write, so that it outlives this process.
class ReceivedLog {
 public:
  static std::shared_ptr<int> open(const HeldFolder& folder) {
    const int file = folder.append("received.log");
    if (file < 0) return nullptr;
    return {new int(file), [](int* own) {
              ::close(*own);
              delete own;
            }};
  }
  static void put(int file, std::string line) {
    line += '\n';
    if (::write(file, line.data(), line.size()) < 0) { /* a trace is a help, never in the way */
    }
  }
};

std::string hex(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits{"0123456789abcdef"};
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::byte byte : bytes) {
    text += kDigits[std::to_integer<std::size_t>(byte) >> 4];
    text += kDigits[std::to_integer<std::size_t>(byte) & 15];
  }
  return text;
}

/// A name without anything that leads elsewhere.
std::string file_name(std::string text) {
  for (char& c : text)
    if (!((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'))) c = '_';
  return text;
}

}  // namespace

Result<CutterLine> configured_line(const DeviceConfig& config,
                                   const std::vector<std::string>& tables) {
  auto device = parse_device_id(config.id);
  if (!device) return tl::unexpected(device.error());
  if (device->kind == DeviceKind::File)
    return fail(ErrorKind::Usage, config.id,
                "is not a cutter; it must start with sim:, usb:, serial: or lp:");
  const std::string& given = config.treat_as.empty() ? config.machine : config.treat_as;
  const std::string name =
      given.empty() && device->kind == DeviceKind::Simulated ? device->name : given;
  if (name.empty())
    return fail(ErrorKind::Usage, config.id,
                "does not identify itself; name its machine, as in machine = \"hpgl-generic\"");
  auto machine = find_driven_machine(name, tables);
  if (!machine) return tl::unexpected(within(config.id, machine.error()));
  if (!config.treat_as.empty()) machine->identity.clear();  // it says another name
  CutterLine line{std::move(*device), std::move(*machine), config.time_scale, {}, {}, {}};
  auto faults = cli::read_faults(config.faults);
  if (!faults) return tl::unexpected(within(config.id, faults.error()));
  line.faults = std::move(*faults);
  if (!line.simulated()) return line;
  if (const auto valid = SimCutter::make(line.machine); !valid)
    return tl::unexpected(within(config.id, valid.error()));
  if (config.trace.empty()) return line;
  if (::mkdir(config.trace.c_str(), 0700) != 0 && errno != EEXIST)
    return fail(
        ErrorKind::Unwritable, config.trace,
        fmt::format("cannot be created: {}; name a folder for traces", std::strerror(errno)));
  auto traces = HeldFolder::open(config.trace);
  if (!traces) return tl::unexpected(traces.error());
  line.traces = std::move(*traces);
  return line;
}

Result<OpenLine> OpenLine::open(CutterLine& line, const std::string& attempt,
                                std::array<double, 2> area_mm, const std::function<void()>& beat,
                                LineFigures* figures) {
  OpenLine open;
  const auto keep = [&](auto opened) -> Result<OpenLine> {
    if (!opened) return tl::unexpected(opened.error());
    open.transport_ = std::move(*opened);
    open.beating_ = std::make_unique<BeatingTransport>(*open.transport_, beat, figures);
    return std::move(open);
  };
  switch (line.device.kind) {
    case DeviceKind::Usb:
      if (!line.bus)
        return fail(ErrorKind::DeviceGone, line.device.text,
                    "USB is not available on this computer");
      return keep(line.bus->connect(line.device.name));
    case DeviceKind::Serial:
      return keep(PortTransport::open_serial(line.device.name, line.device.serial));
    case DeviceKind::Printer:
      return keep(PortTransport::open_printer(line.device.name));
    case DeviceKind::File:
      return keep(FileTransport::create(line.file));
    case DeviceKind::Simulated:
      break;
  }
  SimOptions around;
  around.page_width_mm = area_mm[0];
  around.page_length_mm = area_mm[1];
  auto sim = SimCutter::make(line.machine, around);
  if (!sim) return tl::unexpected(sim.error());
  std::function<void(std::span<const std::byte>)> received;
  if (line.traces.holds()) open.log_ = ReceivedLog::open(line.traces);
  if (open.log_) {
    ReceivedLog::put(*open.log_, "open " + file_name(attempt));
    received = [file = *open.log_](std::span<const std::byte> bytes) {
      ReceivedLog::put(file, hex(bytes));
    };
  }
  SimTransport cable(std::move(*sim), std::exchange(line.faults, {}));
  return keep(Result<std::unique_ptr<Transport>>(std::make_unique<PacedTransport>(
      std::move(cable), line.time_scale, beat, std::move(received))));
}

OpenLine::~OpenLine() = default;

std::optional<Trace> OpenLine::trace() const {
  const auto* sim = dynamic_cast<const PacedTransport*>(transport_.get());
  if (sim == nullptr) return std::nullopt;
  return sim->cutter().trace();
}

Result<void> OpenLine::finish() {
  auto* file = dynamic_cast<FileTransport*>(transport_.get());
  return file == nullptr ? Result<void>() : file->finish();
}

void OpenLine::keep_trace(const CutterLine& line, const std::string& attempt) const {
  const auto* sim = dynamic_cast<const PacedTransport*>(transport_.get());
  if (sim == nullptr || !line.traces.holds()) return;
  // An attempt has one trace: what has its name already is not of popcutd.
  const int file = line.traces.create(file_name(attempt) + ".json");
  if (file < 0) return;
  const std::string text = trace_json(sim->cutter().trace());
  std::string_view left = text;
  while (!left.empty()) {
    const ssize_t put = ::write(file, left.data(), left.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) break;  // a trace is a help, never in the way
    left.remove_prefix(static_cast<std::size_t>(put));
  }
  ::close(file);
}

}  // namespace popcut::daemon
