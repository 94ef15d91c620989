// SPDX-License-Identifier: MIT
// Part of daemon/service/repositories/job_repository.hpp: which cutter a job is planned for, and
// another plan for another one.
#include <fmt/format.h>

#include "daemon/model/warnings.hpp"
#include "daemon/service/repositories/job_repository.hpp"

namespace popcut::daemon {

std::vector<Warning> JobRepository::choice_warnings(const std::string& material) const {
  const DeviceRegistry::MachineChoice choice = parts_.devices.machine_for(material);
  if (!choice.is_set_up)
    return {{.code = "no_cutter_for_material",
             .message = fmt::format("no cutter is set up for {}; see the materials of the cutters "
                                    "in /v1/devices",
                                    material),
             .spoils = true}};
  if (choice.others.empty()) return {};
  return {{.code = "cutter_chosen",
           .message = fmt::format("the job is planned for {}, a {}; it can be planned again for {}",
                                  choice.device, choice.machine, fmt::join(choice.others, ", "))}};
}

std::optional<Way> JobRepository::way_to_plan_again(const JobRow& row, const std::string& device,
                                                    const PlanRow& plan) {
  if (!parts_.devices.wants_own_plan(device, plan) || !may_plan_again(row)) return std::nullopt;
  return Way{"change", fmt::format(R"({{"device":{},"plan_again":true}})", json_text(device))};
}

// Of a sheet that was cut the rest must come from the same plan.
bool JobRepository::may_plan_again(const JobRow& row) {
  return step_of(row.state, JobEvent::PlansAgain) != Step::Refused && row.sheet <= 1 &&
         row.segment == 1 && row.done_paths == 0 && attempts_.of_sheet(row.id, 1).empty();
}

Answer<void> JobRepository::plan_again(const Principal& who, JobRow& row, const JobPatch& request) {
  const auto before = parts_.plans.table().find(row.plan);
  if (!before || !may_plan_again(row))
    return tl::unexpected(conflict(
        row,
        "sheets of this job were cut already, so it keeps its plan; create a new job for the "
        "other cutter"));
  const std::string device = request.device.value_or(row.requested_device);
  const Answer<PlanRow> plan =
      parts_.plans.plan_again(who, *before, device, request.material.value_or(""));
  if (!plan) return tl::unexpected(plan.error());
  if (const std::string why = device.empty() ? "" : parts_.devices.misfit(device, *plan);
      !why.empty())
    return tl::unexpected(invalid_value("/device", "value", why));
  row.plan = plan->id;
  row.material = plan->material;
  row.requested_device = device;
  row.sheets_total = row.sheet = 0;
  row.paths_total = 0;
  row.low_s = row.high_s = 0;
  row.load.clear();
  row.unaccepted.clear();
  row.warnings =
      warnings_json(device.empty() ? choice_warnings(plan->material) : std::vector<Warning>());
  set_attention(row, "", "");
  take(row, step_of(row.state, JobEvent::PlansAgain), "");
  if (plan->state == PlanState::Planned)
    apply_plan(row, *plan);
  else
    parts_.store.after_commit([this] { parts_.plans.pump(); });
  return {};
}

}  // namespace popcut::daemon
