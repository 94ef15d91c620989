// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/usb/usb_device.hpp"
#include "protocol/replies.hpp"

namespace popcut {

class Transport;
class UsbBus;

/// One thing that the doctor found, and what to do about it.
struct Finding {
  enum class Level : std::uint8_t {
    Fine,     ///< as it should be
    Note,     ///< worth knowing, stops nothing
    Problem,  ///< nothing can be cut until this is fixed
  };
  Level level{};
  std::string what;
  std::string remedy;  ///< instructions to follow; empty if there is nothing to do
};
[[nodiscard]] std::string_view name_of(Finding::Level level);

/// The user, and how this computer is set up for cutters.
struct Surroundings {
  std::string user;             ///< login name; "$USER" if unknown
  bool rule_installed{false};   ///< popcut's udev rule
  bool group_exists{false};     ///< the group popcut-usb
  bool listed_in_group{false};  ///< a member of it according to the system
  bool in_group{false};         ///< a member of it in this login
};
[[nodiscard]] Surroundings look_around();

/// A machine's replies.
struct Answers {
  std::optional<DeviceStatus> status;  ///< none: it takes no data at the moment
  std::string identity;                ///< to FG; empty: no reply
};

/// Everything known about one cutter.
struct CutterFacts {
  UsbDevice device;
  std::optional<Machine> machine;  ///< none: the model is not known
  bool treated{false};             ///< `machine` is the user's choice, not that of the USB ids
  bool cutter_vendor{true};        ///< other cutters of this vendor are known
  UsbUse use;
  std::vector<std::string> holders;     ///< programs that have it or its printer port open
  std::optional<Result<Answers>> said;  ///< none: it was not asked
};

/// Examines a USB device. Queries are sent to it (for its status and name) only if its model is
/// known, its language has queries, and no other program uses it. Nothing that it could cut is ever
/// sent.
[[nodiscard]] CutterFacts examine(const UsbBus& bus, const UsbDevice& device,
                                  const std::vector<Machine>& machines,
                                  const std::optional<Machine>& treat_as);

/// Queries a GPGL machine for status and name.
[[nodiscard]] Result<Answers> ask_machine(Transport& transport);

/// Findings from the facts. Fix the first problem first.
[[nodiscard]] std::vector<Finding> diagnose(const CutterFacts& facts,
                                            const Surroundings& surroundings);

/// The finding if no cutter is connected at all.
[[nodiscard]] Finding nothing_found(const std::vector<std::string>& ports);

}  // namespace popcut
