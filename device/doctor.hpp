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
    Problem,  ///< nothing can be cut before this is mended
  };
  Level level{};
  std::string what;
  std::string remedy;  ///< in words that can be followed; empty where nothing is to be done
};
[[nodiscard]] std::string_view name_of(Finding::Level level);

/// Who asks, and what the computer has been told about cutters.
struct Surroundings {
  std::string user;             ///< login name; "$USER" if it is not known
  bool rule_installed{false};   ///< popcut's udev rule
  bool group_exists{false};     ///< popcut-usb
  bool listed_in_group{false};  ///< of that group as the system has it
  bool in_group{false};         ///< of that group in this login
};
[[nodiscard]] Surroundings look_around();

/// What a machine said of itself, or why it could not be asked.
struct Answers {
  std::optional<DeviceStatus> status;  ///< none: it takes no data just now
  std::string identity;                ///< to FG; empty: no reply
};

/// All that is known of one cutter.
struct CutterFacts {
  UsbDevice device;
  std::optional<Machine> machine;  ///< none: the model is not known
  bool treated{false};             ///< `machine` is what the user said, not what the ids say
  bool cutter_vendor{true};        ///< other cutters of this vendor are known
  UsbUse use;
  std::vector<std::string> holders;     ///< programs that have it or its printer port open
  std::optional<Result<Answers>> said;  ///< none: it was not asked
};

/// Looks at a USB device. It is only asked (its status, its name) where its model is known, its
/// language has questions, and nobody else uses it; nothing it could cut is ever sent.
[[nodiscard]] CutterFacts examine(const UsbBus& bus, const UsbDevice& device,
                                  const std::vector<Machine>& machines,
                                  const std::optional<Machine>& treat_as);

/// Asks a GPGL machine for status and name.
[[nodiscard]] Result<Answers> ask_machine(Transport& transport);

/// What the facts mean. The first problem is the one to mend first.
[[nodiscard]] std::vector<Finding> diagnose(const CutterFacts& facts,
                                            const Surroundings& surroundings);

/// What to say where no cutter was found at all.
[[nodiscard]] Finding nothing_found(const std::vector<std::string>& ports);

}  // namespace popcut
