// SPDX-License-Identifier: MIT
#include "daemon/cli/view/daemon_devices.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/cli/answer.hpp"
#include "daemon/cli/view/job_view.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {
namespace {

using client::Api;
using client::text_of;
using Json = nlohmann::json;

double number_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0;
}

std::vector<std::string> texts_of(const Json& object, const char* key) {
  std::vector<std::string> texts;
  const auto found = object.find(key);
  if (found != object.end() && found->is_array())
    for (const Json& one : *found)
      if (one.is_string()) texts.push_back(one.get<std::string>());
  return texts;
}

bool is_enabled(const Json& device) { return device.value("enabled", Json(true)) != false; }

std::string state_of(const Json& device) {
  return is_enabled(device) ? text_of(device, "state") : "disabled";
}

std::string figures_of(const Json& device) {
  std::string text;
  if (const std::string site = text_of(device, "site"); !site.empty()) text += ", at " + site;
  if (number_of(device, "width_mm") > 0)
    text += fmt::format("; {:.0f} x {:.0f} mm", number_of(device, "width_mm"),
                        number_of(device, "length_mm"));
  const auto sheets = static_cast<std::int64_t>(number_of(device, "sheets_done"));
  text += fmt::format("; {} sheet{} done, {:.1f} m cut", sheets, sheets == 1 ? "" : "s",
                      number_of(device, "cut_mm") / 1000);
  if (const auto materials = texts_of(device, "materials"); !materials.empty())
    text += fmt::format("; set up for {}", fmt::join(materials, ", "));
  return text;
}

}  // namespace

Result<DaemonDevices> daemon_devices() {
  return with_popcutd([](Api& api) -> Result<DaemonDevices> {
    api.http().set_tries(0);
    auto devices = api.list("/v1/devices", "devices");
    if (!devices) return tl::unexpected(devices.error());
    DaemonDevices found{api.http().address().text(), std::move(*devices), {}};
    for (const Json& device : found.devices) {
      const std::string id = text_of(device, "job");
      if (id.empty()) continue;
      if (auto job = api.get("/v1/jobs/" + id, "job " + id)) found.jobs.push_back(std::move(*job));
    }
    return found;
  });
}

std::vector<std::string> device_lines(const DaemonDevices& found) {
  std::vector<std::string> lines;
  for (const Json& device : found.devices) {
    const bool simulated = device.value("simulated", Json(false)) == true;
    lines.push_back(fmt::format("{:<26} {:<13} {}{}{}", text_of(device, "id"), state_of(device),
                                text_of(device, "title"), simulated ? ", simulated" : "",
                                figures_of(device)));
    for (const std::string& reason : texts_of(device, "reasons")) lines.push_back("    " + reason);
    if (!is_enabled(device))
      lines.push_back(fmt::format("    -> popcut devices enable {}", text_of(device, "id")));
    else if (state_of(device) == "fault")
      lines.push_back(
          fmt::format("    -> fix the cause, then popcut devices reset {}", text_of(device, "id")));
    for (const Json& job : found.jobs) {
      if (text_of(job, "id") != text_of(device, "job")) continue;
      lines.push_back(
          fmt::format("    {} {}: {}", short_id(job), job_title(job), job_summary(job)));
      for (std::string& wait : waiting_lines(waiting_for(job), 4)) lines.push_back(std::move(wait));
    }
  }
  return lines;
}

Result<void> act_on_device(const std::string& id, const std::string& action,
                           const Globals& globals) {
  const auto ask = [&](Api& api) { return api.act_on_device(id, action, Json::object()); };
  return answer_of_popcutd(globals, ask, [&](const Json&) {
    if (globals.quiet) return;
    if (action == "reset")
      fmt::print(stderr, "{} is being reset; 'popcut devices' shows the result\n", id);
    else
      fmt::print(stderr, "{} is {}d\n", id, action);
  });
}

}  // namespace popcut::cli
