// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/help/udev_rule.hpp"
#include "daemon/client/address.hpp"
#include "daemon/config/config.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/fleet/fleet_health.hpp"
#include "daemon/store/state_folder.hpp"
#include "device/doctor.hpp"
#include "device/port/device_id.hpp"
#include "device/port/port_transport.hpp"
#include "device/port/ports.hpp"
#include "device/usb/usb_bus.hpp"

namespace popcut::cli {
namespace doctor_command {
namespace {

using Json = nlohmann::ordered_json;
using Level = Finding::Level;

struct Options {
  std::string device, treat_as, config;
  bool rule{false};
};

/// What was found of one cutter, or of none.
struct Report {
  std::string id, title;
  std::vector<Finding> findings;

  [[nodiscard]] const Finding* first_problem() const {
    const auto at = std::find_if(findings.begin(), findings.end(), [](const Finding& finding) {
      return finding.level == Level::Problem;
    });
    return at == findings.end() ? nullptr : &*at;
  }
};

Result<std::optional<Machine>> stand_in(const Options& options,
                                        const std::vector<std::string>& tables) {
  if (options.treat_as.empty()) return std::nullopt;
  auto machine = find_driven_machine(options.treat_as, tables);
  if (!machine) return fail(ErrorKind::Usage, "--treat-as", machine.error().detail);
  return std::move(*machine);
}

std::vector<std::string> port_ids() {
  std::vector<std::string> ids;
  for (const PortInfo& port : list_ports()) ids.push_back(port.id);
  return ids;
}

/// A port: all that can be known is whether it opens.
Report look_at_port(const DeviceId& id) {
  Report report{id.text, "a port", {}};
  const auto port = id.kind == DeviceKind::Serial ? PortTransport::open_serial(id.name, id.serial)
                                                  : PortTransport::open_printer(id.name);
  if (port) {
    report.findings.push_back({Level::Fine, "it can be opened, and no other program uses it", ""});
    report.findings.push_back(
        {Level::Note, "a port does not report which machine is connected, or whether it is on",
         "name the machine yourself: popcut cut --direct --device " + id.text +
             " --machine hpgl-generic"});
    return report;
  }
  const std::string& detail = port.error().detail;
  const std::size_t cut = detail.find("; ");
  report.findings.push_back({Level::Problem, detail.substr(0, cut),
                             cut == std::string::npos ? "" : detail.substr(cut + 2)});
  return report;
}

Result<std::vector<Report>> look_at_usb(const Options& options) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto machines = all_machines(tables->texts);
  if (!machines) return tl::unexpected(tables->with_file(machines.error()));
  const auto treat_as = stand_in(options, tables->texts);
  if (!treat_as) return tl::unexpected(treat_as.error());
  const auto bus = UsbBus::open();
  if (!bus) return tl::unexpected(bus.error());
  std::vector<UsbDevice> devices;
  if (options.device.empty()) {
    devices = bus->devices();
  } else {
    auto one = bus->find(options.device);
    if (!one) return tl::unexpected(one.error());
    devices.push_back(std::move(*one));
  }
  if (*treat_as && devices.size() != 1)
    return fail(ErrorKind::Usage, "--treat-as",
                "needs one device; name it, as in popcut doctor usb:ID --treat-as NAME "
                "('popcut devices' lists them)");
  const Surroundings surroundings = look_around();
  std::vector<Report> reports;
  for (const UsbDevice& device : devices) {
    const CutterFacts facts = examine(*bus, device, *machines, *treat_as);
    reports.push_back({device.id, facts.machine ? facts.machine->title : "unknown model",
                       diagnose(facts, surroundings)});
  }
  return reports;
}

/// The file that popcutd reads; empty: there is none.
std::string configuration_file(const Options& options) {
  if (!options.config.empty()) return options.config;
  for (const std::string& file :
       client::configuration_files([](const char* name) { return std::getenv(name); }))
    if (::access(file.c_str(), F_OK) == 0) return file;
  return {};
}

Finding told(const daemon::FleetFinding& finding) {
  return {finding.level == daemon::FleetFinding::Level::Fine   ? Level::Fine
          : finding.level == daemon::FleetFinding::Level::Note ? Level::Note
                                                               : Level::Problem,
          finding.what, finding.remedy};
}

/// The fleet of this machine's popcutd; nothing: its configuration names none.
std::optional<Report> look_at_fleet(const Options& options) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 20, kMostSecret = 4096;
  const std::string file = configuration_file(options);
  if (file.empty()) return std::nullopt;
  if (::access(file.c_str(), R_OK) != 0)
    return Report{
        "fleet",
        file,
        {{Level::Note, "the configuration of popcutd cannot be read", "sudo popcut doctor"}}};
  const auto text = daemon::read_whole(file, kMostBytes);
  const auto config = text ? daemon::parse_config(*text) : tl::unexpected(text.error());
  if (!config)
    return Report{"fleet",
                  file,
                  {{Level::Problem, message(config.error()),
                    fmt::format("popcutd --config {} --check-config", file)}}};
  const daemon::FleetConfig& fleet = config->fleet;
  if (fleet.database.empty()) return std::nullopt;
  daemon::FleetProbe probe{.url = fleet.database, .password = {}, .node = fleet.node};
  if (probe.node.empty()) {
    std::array<char, 65> name{};
    (void)::gethostname(name.data(), name.size() - 1);
    probe.node = name.data();
  }
  Report report{"fleet", "node " + probe.node, {}};
  if (!fleet.password_file.empty()) {
    const auto secret = daemon::read_whole(fleet.password_file, kMostSecret);
    if (!secret) {
      const bool is_there = ::access(fleet.password_file.c_str(), F_OK) == 0;
      report.findings.push_back(
          {is_there ? Level::Note : Level::Problem,
           is_there
               ? fleet.password_file + ": you may not read it, so popcut did not check the fleet"
               : fleet.password_file + ", the password_file of [fleet], does not exist",
           is_there
               ? "sudo popcut doctor"
               : fmt::format(
                     "as the administrator of the database: popcut fleet join --node {} --again",
                     probe.node)});
      return report;
    }
    probe.password = secret->substr(0, secret->find('\n'));
  }
  for (const daemon::FleetFinding& finding : daemon::fleet_findings(probe))
    report.findings.push_back(told(finding));
  return report;
}

Json to_json(const Report& report) {
  Json findings = Json::array();
  for (const Finding& finding : report.findings) {
    Json one{{"level", name_of(finding.level)}, {"what", finding.what}};
    if (!finding.remedy.empty()) one["do"] = finding.remedy;
    findings.push_back(std::move(one));
  }
  return {{"id", report.id}, {"title", report.title}, {"findings", findings}};
}

void print(const Report& report) {
  fmt::print("{}  {}\n", report.id, report.title);
  for (const Finding& finding : report.findings) {
    const bool problem = finding.level == Level::Problem;
    fmt::print("  {:<8} {}\n", problem ? "PROBLEM" : name_of(finding.level), finding.what);
    for (std::size_t from = 0; from < finding.remedy.size();) {
      const std::size_t end = std::min(finding.remedy.find('\n', from), finding.remedy.size());
      fmt::print("  {:<8} {}\n", from == 0 ? "  do:" : "",
                 std::string_view(finding.remedy).substr(from, end - from));
      from = end + 1;
    }
  }
}

/// Good if one cutter has no problem, and the fleet, if there is one; else the first problem is the
/// error.
Result<void> verdict(const std::vector<Report>& reports, const std::optional<Report>& fleet) {
  const bool fleet_is_well = !fleet || fleet->first_problem() == nullptr;
  for (const Report& report : reports)
    if (report.first_problem() == nullptr && fleet_is_well) return {};
  const Report& worst = fleet_is_well ? reports.front() : *fleet;
  const Finding& first = *worst.first_problem();
  std::string remedy = first.remedy.empty() ? "see above" : first.remedy;
  std::replace(remedy.begin(), remedy.end(), '\n', ' ');
  return fail(
      ErrorKind::Refused, worst.id,
      fmt::format("{}; {}", first.what,
                  first.remedy.find('\n') == std::string::npos ? remedy : "see the steps above"));
}

Result<void> run_doctor(const Options& options, const Globals& globals) {
  if (options.rule) {
    fmt::print("{}", udev_rule());
    return {};
  }
  std::vector<Report> reports;
  std::optional<DeviceId> id;
  if (!options.device.empty()) {
    auto parsed = parse_device_id(options.device);
    if (!parsed) return fail(ErrorKind::Usage, "DEVICE", parsed.error().detail);
    id = std::move(*parsed);
  }
  if (id && (id->kind == DeviceKind::Simulated || id->kind == DeviceKind::File))
    return fail(ErrorKind::Usage, "DEVICE",
                fmt::format("{} cannot be examined; give a usb:, serial: or lp: device", id->text));
  if (id && id->kind != DeviceKind::Usb) {
    reports.push_back(look_at_port(*id));
  } else {
    auto found = look_at_usb(options);
    if (!found) return tl::unexpected(found.error());
    reports = std::move(*found);
    if (reports.empty()) reports.push_back({"USB", "no cutter", {nothing_found(port_ids())}});
  }
  const std::optional<Report> fleet =
      options.device.empty() ? look_at_fleet(options) : std::nullopt;
  if (globals.json) {
    Json json{{"usable", verdict(reports, fleet).has_value()},
              {"devices", json_list(reports, to_json)}};
    if (fleet) json["fleet"] = to_json(*fleet);
    print_json(json);
  } else if (!globals.quiet) {
    for (const Report& report : reports) print(report);
    if (fleet) print(*fleet);
  }
  std::fflush(stdout);
  return verdict(reports, fleet);
}

constexpr const char* kHelp =
    "Find out why a cutter cannot be used, and what to do about it.\n\n"
    "  popcut doctor                              # examine everything that is plugged in\n"
    "  popcut doctor usb:1-2 --treat-as cameo4    # a model that popcut does not know\n"
    "  popcut doctor --udev-rule                  # print the rule that grants permission\n\n"
    "popcut asks a known cutter for its status and name, and sends it nothing else. If the\n"
    "configuration of popcutd names a fleet, popcut checks that, too: database, login, lease,\n"
    "clock, other nodes.\n"
    "Exit code 0 if a cutter is ready and the fleet is in order, 5 if not.";

}  // namespace
}  // namespace doctor_command

void register_doctor(const Command& app, const Globals& globals, Run& run) {
  using namespace doctor_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("doctor", kHelp);
  command.add_option("DEVICE", options->device,
                     "Examine only this device; 'popcut devices' lists them");
  command
      .add_option("--treat-as", options->treat_as,
                  "Drive an unknown cutter as if it were this machine, such as cameo4")
      .value_text("NAME");
  command
      .add_option("--config", options->config,
                  "popcutd's configuration, for its fleet. Default: the one that popcutd reads")
      .value_text("FILE");
  command.add_flag("--udev-rule", options->rule, "Print popcut's udev rule and do nothing else");
  when_chosen(command, run, [options, &globals] { return run_doctor(*options, globals); });
}

}  // namespace popcut::cli
