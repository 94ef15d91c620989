// SPDX-License-Identifier: MIT
#include "device/doctor.hpp"

#include <dirent.h>
#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "device/port/ports.hpp"
#include "device/session/inquirer.hpp"
#include "device/usb/usb_bus.hpp"

namespace popcut {
namespace {

using Level = Finding::Level;

constexpr const char* kGroup = "popcut-usb";

/// The printer port that usblp created for a device: "/dev/usb/lp0".
std::string printer_port(const UsbDevice& device) {
  const std::string folder = fmt::format("/sys/bus/usb/devices/{}:1.{}/usbmisc", device.port,
                                         unsigned{device.interface.number});
  DIR* const open = ::opendir(folder.c_str());
  if (open == nullptr) return {};
  std::string port;
  while (const dirent* entry = ::readdir(open))
    if (entry->d_name[0] != '.') port = fmt::format("/dev/usb/{}", entry->d_name);
  ::closedir(open);
  return port;
}

std::string join(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// The missing steps, numbered, up to membership in the group.
std::string how_to_get_permission(const Surroundings& s) {
  std::vector<std::string> steps;
  if (!s.group_exists) steps.push_back(fmt::format("sudo groupadd --system {}", kGroup));
  if (!s.rule_installed)
    steps.emplace_back("popcut doctor --udev-rule | sudo tee /etc/udev/rules.d/60-popcut.rules");
  if (!s.listed_in_group) steps.push_back(fmt::format("sudo usermod -aG {} {}", kGroup, s.user));
  if (!s.rule_installed || !s.group_exists)
    steps.emplace_back("sudo udevadm control --reload; sudo udevadm trigger --subsystem-match=usb");
  if (!s.in_group) steps.emplace_back("log out and in again");
  if (steps.empty()) return "plug the cutter in again, so that the udev rule applies to it";
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i)
    text += fmt::format("{}{}. {}", i == 0 ? "" : "\n", i + 1, steps[i]);
  return text;
}

Finding of_model(const CutterFacts& facts) {
  const UsbDevice& d = facts.device;
  if (facts.machine && facts.treated)
    return {Level::Note,
            fmt::format("treated as a {} because of --treat-as; its own ids are {:04x}:{:04x}",
                        facts.machine->title, d.vendor_id, d.product_id),
            "cut a small test on scrap first"};
  if (facts.machine) return {Level::Fine, fmt::format("is a {}", facts.machine->title), ""};
  const std::string name = d.product.empty() ? "without a name" : fmt::format("\"{}\"", d.product);
  if (!facts.cutter_vendor)
    return {Level::Problem,
            fmt::format("{} ({:04x}:{:04x}) is not known as a cutter; it may be a printer", name,
                        d.vendor_id, d.product_id),
            "if it is a cutter: popcut doctor " + d.id +
                " --treat-as hpgl-generic, or the name of the most similar machine"};
  return {Level::Problem,
          fmt::format("its vendor makes cutters, but the model {} ({:04x}:{:04x}) is not known",
                      name, d.vendor_id, d.product_id),
          "name the most similar machine ('popcut machines' lists them): popcut doctor " + d.id +
              " --treat-as cameo4; if that works, cut with the same option, and please report the "
              "ids"};
}

std::optional<Finding> of_use(const CutterFacts& facts, const Surroundings& surroundings) {
  const UsbUse& use = facts.use;
  const std::string holders = join(facts.holders);
  switch (use.state) {
    case UsbState::NoPermission:
      return Finding{Level::Problem,
                     fmt::format("{} may not open {}", surroundings.user, facts.device.node),
                     how_to_get_permission(surroundings)};
    case UsbState::Busy:
      return Finding{
          Level::Problem,
          holders.empty() ? "another program uses it" : fmt::format("{} uses it", holders),
          holders.empty() ? "stop that program; 'sudo popcut doctor' can name it"
                          : "wait until that program has finished, or stop it"};
    case UsbState::Absent:
      return Finding{Level::Problem, "it was unplugged a moment ago",
                     "check cable and power, then try again"};
    case UsbState::Free:
      break;
  }
  if (!holders.empty())
    return Finding{Level::Problem,
                   fmt::format("{} has its printer port open{}", holders,
                               holders.find("usb") != std::string::npos ||
                                       holders.find("cups") != std::string::npos
                                   ? "; CUPS uses it as a printer"
                                   : ""),
                   "remove its queue (lpstat -v lists queues, sudo lpadmin -x NAME removes one), "
                   "or wait until the program has finished"};
  if (use.driver.empty()) return Finding{Level::Fine, "no other program uses it", ""};
  return Finding{
      Level::Note,
      fmt::format("the kernel driver {} holds it; popcut detaches the driver while it cuts "
                  "and attaches it again",
                  use.driver),
      ""};
}

Finding of_status(const std::optional<DeviceStatus>& status) {
  if (!status)
    return {Level::Problem, "it takes no data",
            "check whether it is paused or still busy; if not, switch it off and on"};
  switch (*status) {
    case DeviceStatus::Ready:
      // A Cameo 3 (firmware 1.40) was seen to say so without a mat.
      return {Level::Fine,
              "ready; look whether a sheet is loaded, since some machines say so without one", ""};
    case DeviceStatus::Moving:
      return {Level::Note, "busy: it is moving, or has an unfinished job", "wait until it stops"};
    case DeviceStatus::NoMedia:
      return {Level::Problem, "no sheet is loaded",
              "put the sheet on the mat, hold the mat against the rollers, and press load on the "
              "machine's panel"};
    case DeviceStatus::Paused:
      return {Level::Problem, "paused on its panel",
              "press pause again to continue the job, or cancel it there"};
    case DeviceStatus::Cancelled:
      return {Level::Problem, "the last job was cancelled on its panel, and it is still resetting",
              "wait a few seconds, then try again"};
    case DeviceStatus::Unknown:
      break;
  }
  return {Level::Problem, "its status cannot be read", "switch it off and on"};
}

Finding of_identity(const std::string& reply, const CutterFacts& facts) {
  const auto said = parse_identity(reply);
  if (!said)
    return {
        Level::Problem, "it does not say what it is, or its reply cannot be read",
        "switch it off and on; if that does not help, check that it is a " + facts.machine->title};
  const std::string firmware =
      said->firmware.empty() ? "firmware unknown" : "firmware " + said->firmware;
  const std::string itself = fmt::format("calls itself {}, {}", said->model, firmware);
  const auto known = parse_identity(facts.machine->identity);
  if (!known)
    return {Level::Note, itself + "; popcut has not been tested with this machine yet",
            "cut a small test on scrap first, and please report whether it worked"};
  if (known->model != said->model && !facts.treated)
    return {Level::Problem,
            fmt::format("{}, although its USB ids are those of a {}", itself, facts.machine->title),
            "name the actual machine with --treat-as"};
  if (known->firmware != said->firmware && !facts.treated)
    return {Level::Note,
            fmt::format("{}; popcut was tested with recordings of {}", itself, known->firmware),
            "cut a small test on scrap first"};
  return {Level::Fine, itself, ""};
}

}  // namespace

std::string_view name_of(Finding::Level level) {
  constexpr std::array<std::string_view, 3> kNames{"fine", "note", "problem"};
  return kNames.at(static_cast<std::size_t>(level));
}

Surroundings look_around() {
  Surroundings s;
  const passwd* const self = ::getpwuid(::geteuid());
  s.user = self == nullptr ? "$USER" : self->pw_name;
  for (const char* folder :
       {"/etc/udev/rules.d", "/run/udev/rules.d", "/usr/local/lib/udev/rules.d",
        "/usr/lib/udev/rules.d", "/lib/udev/rules.d"})
    s.rule_installed =
        s.rule_installed || ::access(fmt::format("{}/60-popcut.rules", folder).c_str(), F_OK) == 0;
  const group* const usb = ::getgrnam(kGroup);
  if (usb == nullptr) return s;
  s.group_exists = true;
  for (char** member = usb->gr_mem; *member != nullptr; ++member)
    s.listed_in_group = s.listed_in_group || s.user == *member;
  std::array<gid_t, 256> groups{};
  const int count = ::getgroups(static_cast<int>(groups.size()), groups.data());
  s.in_group = ::getegid() == usb->gr_gid;
  for (int i = 0; i < count; ++i)
    s.in_group = s.in_group || groups[static_cast<std::size_t>(i)] == usb->gr_gid;
  s.listed_in_group = s.listed_in_group || s.in_group;
  return s;
}

Result<Answers> ask_machine(Transport& transport) {
  Inquirer inquirer(transport, {0.5, 3, 0.1});
  Answers answers;
  const auto status = inquirer.status();
  if (!status) return tl::unexpected(status.error());
  answers.status = *status;
  if (!answers.status) return answers;
  const auto identity = inquirer.ask(kIdentityQuery);
  if (!identity && identity.error().kind != ErrorKind::Timeout)
    return tl::unexpected(identity.error());
  if (identity && *identity) answers.identity = **identity;
  return answers;
}

CutterFacts examine(const UsbBus& bus, const UsbDevice& device,
                    const std::vector<Machine>& machines, const std::optional<Machine>& treat_as) {
  CutterFacts facts;
  facts.device = device;
  facts.cutter_vendor = known_vendor(device, machines);
  const std::vector<const Machine*> fits = recognise(device, machines);
  if (treat_as)
    facts.machine = treat_as;
  else if (!fits.empty())
    facts.machine = *fits.front();
  facts.treated = treat_as && (fits.empty() || fits.front()->name != treat_as->name);
  facts.use = usb_use(device);
  std::vector<std::string> nodes{device.node};
  if (const std::string port = printer_port(device); !port.empty()) nodes.push_back(port);
  facts.holders = who_has_open(nodes);
  const bool answers = facts.machine && facts.machine->language == "gpgl";
  if (!answers || facts.use.state != UsbState::Free || !facts.holders.empty()) return facts;
  const auto cable = bus.connect(device.id);
  if (!cable)
    facts.said = tl::unexpected(cable.error());
  else
    facts.said = ask_machine(**cable);
  return facts;
}

std::vector<Finding> diagnose(const CutterFacts& facts, const Surroundings& surroundings) {
  std::vector<Finding> findings;
  findings.push_back(
      {Level::Fine, fmt::format("plugged in at {}, {}", facts.device.port, facts.device.node), ""});
  findings.push_back(of_model(facts));
  // Who uses a device that is not known as a cutter is none of popcut's business.
  if (facts.machine || facts.cutter_vendor)
    if (auto use = of_use(facts, surroundings)) findings.push_back(std::move(*use));
  if (facts.machine && facts.machine->language == "hpgl")
    findings.push_back({Level::Note, "machines with this language (HPGL) answer nothing",
                        "check yourself that it is switched on and loaded"});
  if (!facts.said) return findings;
  if (!*facts.said) {
    const Error& error = facts.said->error();
    const std::size_t cut = error.detail.find("; ");
    findings.push_back(
        {Level::Problem, error.detail.substr(0, cut),
         cut == std::string::npos ? "switch it off and on" : error.detail.substr(cut + 2)});
    return findings;
  }
  const Answers& answers = **facts.said;
  findings.push_back(of_status(answers.status));
  // A machine that is busy or has no sheet may not answer with its name.
  const bool at_rest = answers.status == DeviceStatus::Ready;
  if (at_rest || !answers.identity.empty())
    findings.push_back(of_identity(answers.identity, facts));
  return findings;
}

Finding nothing_found(const std::vector<std::string>& ports) {
  std::string remedy =
      "1. switch the cutter on and wait until it stops moving\n"
      "2. plug its USB cable straight into this computer, not into a hub; try another cable\n"
      "3. 'lsusb' should list 0b4d or 3844; if not, the computer does not detect the cutter\n"
      "4. in a virtual machine or a container: pass the device through to it\n"
      "5. Bluetooth is not supported";
  if (!ports.empty())
    remedy += fmt::format(
        "\n6. a vinyl cutter may be at {}; try popcut cut --direct --device {} --machine "
        "hpgl-generic",
        join(ports), ports.front());
  return {Level::Problem, "no cutter is plugged in", std::move(remedy)};
}

}  // namespace popcut
