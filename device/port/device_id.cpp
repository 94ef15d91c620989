// SPDX-License-Identifier: MIT
#include "device/port/device_id.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr std::string_view kForms =
    "use sim:NAME, usb:ID, serial:/dev/ttyUSB0, lp:/dev/usb/lp0 or file:NAME; 'popcut devices' "
    "lists what is plugged in";

tl::unexpected<Error> usage(std::string detail) {
  return fail(ErrorKind::Usage, "--device", std::move(detail));
}

Result<void> take_setting(std::string_view setting, SerialSettings& serial) {
  const std::size_t sign = setting.find('=');
  const std::string_view name = setting.substr(0, sign);
  const std::string_view value = sign == std::string_view::npos ? "" : setting.substr(sign + 1);
  if (name == "baud") {
    const auto [end, code] =
        std::from_chars(value.data(), value.data() + value.size(), serial.baud);
    if (code == std::errc() && end == value.data() + value.size() && serial.baud > 0) return {};
    return usage(fmt::format("baud={} is not a speed; use a number, as in baud=9600", value));
  }
  if (name != "flow")
    return usage(
        fmt::format("{} is not a setting of a serial port; use baud=N or flow=WORD", name));
  if (value == "none")
    serial.flow = FlowControl::None;
  else if (value == "rtscts")
    serial.flow = FlowControl::RtsCts;
  else if (value == "xonxoff")
    serial.flow = FlowControl::XonXoff;
  else
    return usage(fmt::format("flow={} is not known; use none, rtscts or xonxoff", value));
  return {};
}

Result<void> take_settings(DeviceId& id) {
  // Names of ports may contain commas (/dev/serial/by-path), so search for the settings.
  const std::size_t settings = std::min(id.name.find(",baud="), id.name.find(",flow="));
  if (settings == std::string::npos) return {};
  std::string_view rest = std::string_view(id.name).substr(settings + 1);
  for (;;) {
    const std::size_t comma = rest.find(',');
    if (const auto taken = take_setting(rest.substr(0, comma), id.serial); !taken) return taken;
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  id.name.resize(settings);
  return {};
}

}  // namespace

Result<DeviceId> parse_device_id(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  DeviceId id{{}, std::string(text), {}, {}};
  if (colon != std::string_view::npos) id.name = text.substr(colon + 1);
  if (kind == "sim")
    id.kind = DeviceKind::Simulated;
  else if (kind == "usb")
    id.kind = DeviceKind::Usb;
  else if (kind == "serial")
    id.kind = DeviceKind::Serial;
  else if (kind == "lp")
    id.kind = DeviceKind::Printer;
  else if (kind == "file")
    id.kind = DeviceKind::File;
  else
    return usage(fmt::format("'{}' is not a device; {}", text, kForms));
  if (id.kind == DeviceKind::Serial)
    if (const auto taken = take_settings(id); !taken) return tl::unexpected(taken.error());
  if (id.name.empty()) return usage(fmt::format("'{}' names no device; {}", text, kForms));
  if (id.kind == DeviceKind::Usb) id.name = id.text;
  return id;
}

}  // namespace popcut
