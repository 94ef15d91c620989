// SPDX-License-Identifier: MIT
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/view/daemon_devices.hpp"
#include "daemon/files/user_tables.hpp"
#include "device/port/ports.hpp"
#include "device/usb/usb_bus.hpp"

namespace popcut::cli {
namespace machines_command {
namespace {

using Json = nlohmann::ordered_json;

std::string usb_id(const Machine& machine) {
  if (machine.usb_vendor == 0) return "-";
  return fmt::format("{:04x}:{:04x}", machine.usb_vendor, machine.usb_product);
}

Json motion_json(const Motion& motion) {
  return {{"accel_mm_s2", motion.accel_mm_s2}, {"travel_mm_s", motion.travel_mm_s},
          {"corner_mm", motion.corner_mm},     {"drop_s", motion.drop_s},
          {"lift_s", motion.lift_s},           {"setup_s", motion.setup_s},
          {"trailer_s", motion.trailer_s},     {"spread", motion.spread}};
}

Json machine_json(const Machine& machine) {
  const Json mats = json_list(machine.mats, [](const Mat& mat) {
    return Json{{"name", mat.name}, {"width_mm", mat.width_mm}, {"length_mm", mat.length_mm}};
  });
  Json row{{"name", machine.name},
           {"title", machine.title},
           {"language", machine.language},
           {"variant", machine.variant},
           {"unit_mm", machine.unit_mm},
           {"width_mm", machine.width_mm},
           {"length_mm", machine.length_mm},
           {"tool_holders", machine.tool_holders},
           {"autoblade", machine.autoblade},
           {"usb", usb_id(machine)},
           {"mats", mats},
           {"source", machine.source}};
  if (!machine.driven()) return row;
  row["axes"] = axes_name(machine.axes);
  row["mirrored"] = machine.mirrored;
  row["margin_left_mm"] = machine.margin_left_mm;
  row["margin_top_mm"] = machine.margin_top_mm;
  row["scale"] = {{"carriage", machine.scale_carriage}, {"feed", machine.scale_feed}};
  row["motion"] = motion_json(machine.motion);
  if (machine.language == "gpgl")
    row["marks"] = {{"before_left_mm", machine.marks.before_left_mm},
                    {"before_top_mm", machine.marks.before_top_mm},
                    {"again_mm", machine.marks.again_mm},
                    {"sensor_mm_s", machine.marks.sensor_mm_s},
                    {"longest_s", machine.marks.longest_s}};
  row["calibrated"] = machine.calibrated.empty() ? Json() : Json(machine.calibrated);
  return row;
}

std::string steps_words(const SteppedScale& scale, const char* unit) {
  if (scale.per_step <= 0) return "set on the machine";
  return fmt::format("{:g} to {:g} {} in steps of {:g}", scale.min_step * scale.per_step,
                     scale.max_step * scale.per_step, unit, scale.per_step);
}

/// One machine, a line for each thing that popcut knows of it.
Result<void> show_machine(const std::string& name, const Globals& globals) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto found = find_machine(name, tables->texts);
  if (!found) return tl::unexpected(tables->with_file(found.error(), "MACHINE"));
  const Machine& m = *found;
  if (globals.json) {
    print_json(machine_json(m));
    return {};
  }
  const auto line = [](const char* what, const std::string& text) {
    if (!text.empty()) fmt::print("  {:<9} {}\n", what, text);
  };
  fmt::print("{}: {}\n", m.name, m.title);
  std::string mats;
  for (const Mat& mat : m.mats)
    mats += fmt::format("{}{} ({:g} x {:g} mm)", mats.empty() ? "" : ", ", mat.name, mat.width_mm,
                        mat.length_mm);
  line("area", fmt::format("{:g} mm across, {:g} mm along the feed", m.width_mm, m.length_mm));
  line("mats", mats);
  if (m.driven()) {
    line("language", fmt::format("{} {}, in steps of {:g} mm", m.language, m.variant, m.unit_mm));
    line("axes", fmt::format("the first along the {}{}",
                             m.axes == Axes::FeedCarriage ? "feed, the second along the carriage"
                                                          : "carriage, the second along the feed",
                             m.mirrored ? "; mirrored" : ""));
    line("margins",
         fmt::format("{:g} mm at the left, {:g} mm at the top", m.margin_left_mm, m.margin_top_mm));
    if (m.scale_carriage != 1 || m.scale_feed != 1)
      line("scale", fmt::format("100 mm come out as {:.2f} mm along the carriage and {:.2f} mm "
                                "along the feed; popcut corrects that",
                                100 * m.scale_carriage, 100 * m.scale_feed));
    line("force", steps_words(m.force_gf, "gf"));
    line("speed", steps_words(m.speed_mm_s, "mm/s"));
    line("tools", fmt::format("{} holder{}{}", m.tool_holders, m.tool_holders == 1 ? "" : "s",
                              m.autoblade ? ", autoblade" : ""));
    line("motion",
         fmt::format("{:g} mm/s^2, {:g} mm/s with the tool up; times are right within {:.0f} %",
                     m.motion.accel_mm_s2, m.motion.travel_mm_s, 100 * m.motion.spread));
    line("usb", usb_id(m) == "-" ? "not known" : usb_id(m));
  }
  for (const MaterialForce& force : m.forces)
    line("cuts", fmt::format("{} with {:g} gf{}", force.material, force.cut_gf,
                             force.depth ? fmt::format(", blade depth {}", *force.depth) : ""));
  line("tested", m.calibrated.empty() ? m.driven() ? "not calibrated; see 'popcut calibrate'" : ""
                                      : "calibrated on " + m.calibrated);
  line("source", m.source.empty() ? "not known" : m.source);
  return {};
}

Result<void> list_machines(const Globals& globals) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto machines = all_machines(tables->texts);
  if (!machines) return tl::unexpected(tables->with_file(machines.error()));
  if (globals.json) {
    print_json(Json{{"machines", json_list(*machines, machine_json)}});
    return {};
  }
  for (const Machine& m : *machines) {
    std::string mats;
    for (const Mat& mat : m.mats) mats += " " + mat.name;
    fmt::print("{:<18} {:<40} {:<5} {:>6.1f} x {:<7.0f} mm  {:<9}{}{}\n", m.name, m.title,
               m.language, m.width_mm, m.length_mm, usb_id(m), mats,
               m.calibrated.empty() ? "" : "  calibrated " + m.calibrated);
  }
  return {};
}

Json material_json(const Material& material) {
  const auto tool = [](const ToolSettings& t) {
    return Json{{"tool", t.tool},
                {"force_gf", t.force_gf},
                {"speed_mm_s", t.speed_mm_s},
                {"passes", t.passes}};
  };
  const DashShape& d = material.dashes;
  return {{"name", material.name},
          {"title", material.title},
          {"thickness_mm", material.thickness_mm},
          {"dashes",
           {{"dash_mm", d.dash_mm},
            {"gap_mm", d.gap_mm},
            {"clearance_mm", d.clearance_mm},
            {"min_dash_mm", d.min_dash_mm}}},
          {"cut", tool(material.cut)},
          {"fold", tool(material.fold)},
          {"draw", tool(material.draw)},
          {"blade_offset_mm", material.blade_offset_mm},
          {"autoblade_depth", material.autoblade_depth}};
}

Result<void> list_materials(const Globals& globals) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto materials = all_materials(tables->texts);
  if (!materials) return tl::unexpected(tables->with_file(materials.error()));
  if (globals.json) {
    print_json(Json{{"materials", json_list(*materials, material_json)}});
    return {};
  }
  for (const Material& m : *materials)
    fmt::print("{:<12} {:<32} cut {:>3g} gf, {:>3g} mm/s, {} pass{}; dash {:g} mm, gap {:g} mm\n",
               m.name, m.title, m.cut.force_gf, m.cut.speed_mm_s, m.cut.passes,
               m.cut.passes == 1 ? "" : "es", m.dashes.dash_mm, m.dashes.gap_mm);
  return {};
}

// What is plugged in.

struct Listed {
  std::string id, title, state;
  Json more;  ///< beside these three, for --json
};

std::vector<Listed> usb_devices(const std::vector<Machine>& machines) {
  std::vector<Listed> list;
  const auto bus = UsbBus::open();
  if (!bus) return list;  // a computer without USB has no USB devices
  for (const UsbDevice& device : bus->devices()) {
    const std::vector<const Machine*> fits = recognise(device, machines);
    const std::string ids = fmt::format("{:04x}:{:04x}", device.vendor_id, device.product_id);
    const std::string name = device.product.empty() ? ids : device.product + ", " + ids;
    const std::string title =
        !fits.empty() ? fits.front()->title
        : known_vendor(device, machines)
            ? fmt::format("unknown model ({}); add --treat-as NAME to treat it as a known one",
                          name)
            : fmt::format("not known as a cutter ({})", name);
    const UsbUse use = usb_use(device);
    Json more{{"simulated", false}, {"usb", ids}, {"port", device.port}, {"serial", device.serial}};
    if (!fits.empty()) more["machine"] = fits.front()->name;
    if (!use.driver.empty()) more["driver"] = use.driver;
    list.push_back({device.id, title, std::string(name_of(use.state)), std::move(more)});
  }
  return list;
}

/// Prints the cutters of popcutd, or why they cannot be listed.
void say_daemon(const Result<DaemonDevices>& there, const Globals& globals) {
  if (!there) {
    const bool absent = there.error().kind == ErrorKind::DeviceGone;
    if (!absent)
      fmt::print(stderr, "cannot list the cutters of popcutd: {}\n", message(there.error()));
    else if (globals.verbose > 0)
      fmt::print(stderr, "popcutd does not run here; these cutters are for --direct\n");
    return;
  }
  fmt::print("popcutd at {}\n", there->address);
  for (const std::string& line : device_lines(*there)) fmt::print("{}\n", line);
  fmt::print("\non this computer, for 'popcut cut --direct'\n");
}

Result<void> list_devices(const Globals& globals) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto machines = all_machines(tables->texts);
  if (!machines) return tl::unexpected(tables->with_file(machines.error()));
  std::vector<Listed> list = usb_devices(*machines);
  for (const PortInfo& port : list_ports())
    list.push_back({port.id,
                    "a port; add --machine NAME for the cutter on it",
                    port.usable ? "free" : "no permission",
                    {{"simulated", false}}});
  for (const Machine& machine : *machines)
    if (machine.driven())
      list.push_back({"sim:" + machine.name,
                      machine.title + ", simulated",
                      "free",
                      {{"simulated", true}, {"machine", machine.name}}});
  const auto there = daemon_devices();
  if (!globals.json) say_daemon(there, globals);
  Json all = Json::array();
  for (const Listed& device : list) {
    Json one{{"id", device.id}, {"title", device.title}, {"state", device.state}};
    one.update(device.more);
    all.push_back(std::move(one));
    if (!globals.json) fmt::print("{:<26} {:<13} {}\n", device.id, device.state, device.title);
  }
  if (!globals.json) return {};
  Json daemon = nullptr;
  if (there) daemon = Json{{"address", there->address}, {"devices", there->devices}};
  print_json(Json{{"devices", all}, {"popcutd", std::move(daemon)}});
  return {};
}

constexpr const char* kDevicesHelp =
    "List the cutters you can use, and what each is doing.\n\n"
    "  popcut devices\n"
    "  popcut devices disable usb:51053P   # popcutd gives it no more sheets, until you enable it\n"
    "  popcut devices reset usb:51053P     # after a fault: connect to it again; this cuts "
    "nothing\n"
    "  popcut cut --test --device usb:51053P\n\n"
    "The list has the cutters of popcutd if it runs, what is plugged in here, and a simulated\n"
    "cutter for each machine. 'popcut doctor' explains why one cannot be used.";
constexpr const char* kMachinesHelp =
    "List the machines popcut knows: name, language, largest area, USB id, mats.\n\n"
    "  popcut machines\n"
    "  popcut machines cameo3       # all that popcut knows about it, with sources\n\n"
    "Add your own machines in ~/.config/popcut/machines.json or /etc/popcut/machines.json (a\n"
    "service reads only /etc):\n"
    "  {\"popcut\": 1, \"machines\": [{\"name\": \"mine\", \"like\": \"cameo3\", \"length_mm\": "
    "6000}]}";
constexpr const char* kMaterialsHelp =
    "List the materials popcut knows: name, force, speed, passes, and the dashes of folds.\n\n"
    "  popcut materials\n\n"
    "Force is in gf: the weight of that many grams. Add your own materials in\n"
    "~/.config/popcut/materials.json or /etc/popcut/materials.json (a service reads only /etc):\n"
    "  {\"popcut\": 1, \"materials\": [{\"name\": \"kraft\", \"like\": \"paper-220\", "
    "\"autoblade_depth\": 6}]}";

void add_devices(const Command& app, const Globals& globals, Run& run) {
  const Command command = app.add_command("devices", kDevicesHelp);
  command.needs_command(0, 1);
  command.on_choice([command, &globals, &run] {
    if (!command.has_chosen_command()) run = [&globals] { return list_devices(globals); };
  });
  struct Action {
    const char *name, *help;
  };
  for (const Action action :
       {Action{"enable", "Let popcutd use this cutter again"},
        Action{"disable", "Give this cutter no more sheets"},
        Action{"reset", "Connect to this cutter again after a fault; this cuts nothing"}}) {
    auto id = std::make_shared<std::string>();
    const Command one = command.add_command(action.name, action.help);
    one.add_option("DEVICE", *id, "A device that 'popcut devices' lists").required();
    when_chosen(one, run, [id, name = std::string(action.name), &globals] {
      return act_on_device(*id, name, globals);
    });
  }
}

}  // namespace
}  // namespace machines_command

void register_machines(const Command& app, const Globals& globals, Run& run) {
  using namespace machines_command;
  const Command machines = app.add_command("machines", kMachinesHelp);
  auto name = std::make_shared<std::string>();
  machines.add_option("MACHINE", *name, "Show this machine in full");
  when_chosen(machines, run, [name, &globals] {
    return name->empty() ? list_machines(globals) : show_machine(*name, globals);
  });
  add_devices(app, globals, run);
  when_chosen(app.add_command("materials", kMaterialsHelp), run,
              [&globals] { return list_materials(globals); });
}

}  // namespace popcut::cli
