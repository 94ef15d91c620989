// SPDX-License-Identifier: MIT
#include "daemon/cli/cutter/cut_device.hpp"

#include <unistd.h>

#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "daemon/files/user_tables.hpp"
#include "device/usb/usb_bus.hpp"
#include "device/usb/usb_error.hpp"

namespace popcut::cli {
namespace {

/// A machine by name; `place` is the option it came from.
Result<Machine> named(const std::string& name, const char* place) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  auto machine = find_driven_machine(name, tables->texts);
  if (machine) return machine;
  return tl::unexpected(tables->with_file(machine.error(), place));
}

/// A model that popcut drives as another one does not give that one's name.
Result<Machine> treated(const std::string& name) {
  auto machine = named(name, "--treat-as");
  if (machine) machine->identity.clear();
  return machine;
}

Result<Machine> machine_of_usb(const CutTargetOptions& options, const UsbDevice& device) {
  if (!options.treat_as.empty()) return treated(options.treat_as);
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto machines = all_machines(tables->texts);
  if (!machines) return tl::unexpected(tables->with_file(machines.error()));
  const std::vector<const Machine*> fits = recognise(device, *machines);
  if (fits.empty())
    return fail(ErrorKind::Refused, device.id,
                fmt::format("{:04x}:{:04x} ({}) is not a cutter that popcut knows; if it is one, "
                            "name the most similar machine, as in --treat-as cameo4",
                            device.vendor_id, device.product_id,
                            device.product.empty() ? "no name" : device.product));
  for (const Machine* machine : fits)
    if (options.machine.empty() || machine->name == options.machine) return *machine;
  return fail(
      ErrorKind::Usage, "--machine",
      fmt::format("{} is a {}, not a {}; leave --machine out, or override it with --treat-as {}",
                  device.id, fits.front()->name, options.machine, options.machine));
}

Result<Machine> machine_on_usb(const CutTargetOptions& options, const std::string& id) {
  const auto bus = UsbBus::open();
  if (!bus) return tl::unexpected(bus.error());
  const auto device = bus->find(id);
  if (!device) return tl::unexpected(device.error());
  auto machine = machine_of_usb(options, *device);
  if (!machine) return machine;
  // Reported now, not after the question whether to start.
  if (const auto usable = may_be_used(*device); !usable) return tl::unexpected(usable.error());
  return machine;
}

Result<Machine> machine_on_port(const CutTargetOptions& options, const DeviceId& device) {
  if (::access(device.name.c_str(), F_OK) != 0)
    return fail(ErrorKind::DeviceGone, device.text,
                "there is no such port; 'popcut devices' lists what is plugged in");
  if (!options.treat_as.empty()) return treated(options.treat_as);
  if (!options.machine.empty()) return named(options.machine, "--machine");
  return fail(ErrorKind::Usage, "--machine",
              fmt::format("{} does not report its model; name the machine, as in --machine "
                          "hpgl-generic",
                          device.text));
}

Result<Machine> simulated_machine(const CutTargetOptions& options, const DeviceId& device) {
  if (!options.treat_as.empty())
    return fail(ErrorKind::Usage, "--treat-as",
                fmt::format("is not for simulated cutters; use --device sim:{}", options.treat_as));
  auto machine = named(device.name, "--device");
  if (machine && !options.machine.empty() && options.machine != machine->name)
    return fail(ErrorKind::Usage, "--machine",
                fmt::format("{} is not the machine of {}; leave one of them out", options.machine,
                            device.text));
  return machine;
}

}  // namespace

Result<CutTarget> choose_target(const CutTargetOptions& options) {
  std::string text = options.device;
  if (text.empty()) text = "sim:" + (options.machine.empty() ? "cameo3" : options.machine);
  const auto device = parse_device_id(text);
  if (!device) return tl::unexpected(device.error());
  Result<Machine> machine = [&] {
    switch (device->kind) {
      case DeviceKind::Usb:
        return machine_on_usb(options, device->name);
      case DeviceKind::Serial:
      case DeviceKind::Printer:
        return machine_on_port(options, *device);
      case DeviceKind::File:
        return options.treat_as.empty()
                   ? named(options.machine.empty() ? "cameo3" : options.machine, "--machine")
                   : treated(options.treat_as);
      case DeviceKind::Simulated:
        break;
    }
    return simulated_machine(options, *device);
  }();
  if (!machine) return tl::unexpected(machine.error());
  return CutTarget{*device, std::move(*machine), {}};
}

std::string sheet_path(const CutTarget& target, std::size_t sheet, std::size_t sheets) {
  if (sheets == 1) return target.device.name;
  const std::filesystem::path path(target.device.name);
  return (path.parent_path() /
          fmt::format("{}-{:02}{}", path.stem().string(), sheet + 1, path.extension().string()))
      .string();
}

}  // namespace popcut::cli
