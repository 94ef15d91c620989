// SPDX-License-Identifier: MIT
// Part of daemon/service/repositories/job_repository.hpp: the cutter for which a job is planned,
// and a new plan for another cutter.
#include <fmt/format.h>

#include "daemon/service/repositories/job_repository.hpp"

namespace popcut::daemon {

std::vector<Warning> JobRepository::choice_warnings(const std::string& material,
                                                    const std::string& site) const {
  const DeviceRegistry::MachineChoice choice = parts_.devices.machine_for(material, site);
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

std::optional<NextAction> JobRepository::plan_again_action(const JobRow& row,
                                                           const std::string& device,
                                                           const PlanRow& plan) {
  if (!parts_.devices.needs_other_plan(device, plan) || !may_plan_again(row)) return std::nullopt;
  return change_action(row, device, true);
}

NextAction JobRepository::change_action(const JobRow& row, const std::string& device,
                                        bool plan_again) const {
  const bool is_there = parts_.devices.wrong_site(device, row.site).empty();
  JobPatch change{.plan_again = plan_again};
  if (is_there || plan_again || !row.requested_device.empty()) change.device = device;
  if (!is_there) change.site = parts_.devices.find(device)->site;
  return {"change", std::move(change)};
}

// After a part of a sheet is cut, the rest must come from the same plan.
bool JobRepository::may_plan_again(const JobRow& row) {
  return step_of(row.state, JobEvent::PlansAgain) != Step::Refused && row.sheet <= 1 &&
         row.segment == 1 && row.done_paths == 0 && attempts_.of_sheet(row.id, 1).empty();
}

Answer<void> JobRepository::plan_again(const Principal& who, JobRow& row, const JobPatch& request) {
  const auto before = parts_.plans.table().find(row.plan);
  if (!before || !may_plan_again(row))
    return refuse_state(
        row,
        "sheets of this job were cut already, so it keeps its plan; create a new job for the "
        "other cutter");
  const std::string device = request.device.value_or(row.requested_device);
  // The owner of the job waits for the plan, even if an operator requests it.
  Principal owner = who;
  owner.name = row.owner;
  const Answer<PlanRow> plan =
      parts_.plans.plan_again(owner, *before, device, request.material.value_or(""), row.site);
  if (!plan) return tl::unexpected(plan.error());
  if (const std::string why = device.empty() ? "" : parts_.devices.misfit(device, *plan, row.site);
      !why.empty())
    return refuse_value("/device", "value", why);
  row.plan = plan->id;
  row.material = plan->material;
  row.requested_device = device;
  row.sheets_total = row.sheet = 0;
  row.paths_total = 0;
  row.low_s = row.high_s = 0;
  row.load.reset();
  row.handwork.reset();
  row.unaccepted.clear();
  row.warnings =
      device.empty() ? choice_warnings(plan->material, row.site) : std::vector<Warning>();
  set_attention(row, "", "");
  apply(row, step_of(row.state, JobEvent::PlansAgain), "");
  if (plan->state == PlanState::Planned)
    apply_plan(row, *plan);
  else
    parts_.store.after_commit([this] { parts_.plans.pump(); });
  return {};
}

}  // namespace popcut::daemon
