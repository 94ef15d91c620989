// SPDX-License-Identifier: MIT
// The jobs of the service that holds everything in memory, their queue and their devices.
#include <fmt/format.h>

#include "tests/support/fake_lookup.hpp"
#include "tests/support/fake_service.hpp"

namespace popcut::daemon {

using namespace fake;

namespace {

/// 412 with what the job is now.
Problem stale(const Job& job) {
  Problem problem{ProblemKind::Stale, "it was changed meanwhile"};
  problem.rev = job.rev;
  problem.state = std::string(name_of(job.state));
  problem.allowed_actions = job.actions;
  return problem;
}

}  // namespace

Answer<Job> FakeJobs::create(const Principal& who, const JobCreate& request) {
  if (auto problem = failure("create_job")) return tl::unexpected<Problem>(*problem);
  last_create = request;
  ++made_jobs;
  Job& job = add_job(JobState::Queued, who.name);
  job.name = request.name;
  job.copies = request.copies;
  job.priority = request.priority;
  job.tags = request.tags;
  return changed(job);
}

Answer<Page<Job>> FakeJobs::list(const JobFilter& filter, const PageRequest& request) {
  if (auto problem = failure("jobs")) return tl::unexpected<Problem>(*problem);
  last_filter = filter;
  last_page = request;
  Page<Job> page;
  for (const auto& [id, job] : job_map) {
    bool is_wanted = filter.states.empty();
    for (const JobState state : filter.states) is_wanted = is_wanted || state == job.state;
    if (id <= request.cursor || !is_wanted) continue;
    if (static_cast<int>(page.items.size()) == request.limit) {
      page.next_cursor = page.items.back().id;
      break;
    }
    page.items.push_back(job);
  }
  return page;
}

Answer<Job> FakeJobs::find(const std::string& id) {
  if (auto problem = failure("job")) return tl::unexpected<Problem>(*problem);
  return lookup(job_map, id, "job");
}

// Asked for each event that is heard: no test means this one when it tells the next to fail.
Answer<Job> FakeJobs::brief(const std::string& id) {
  Answer<Job> found = lookup(job_map, id, "job");
  if (found) found->next_actions.clear();
  return found;
}

Answer<std::vector<SheetRecord>> FakeJobs::sheets(const std::string& id, int first, int most) {
  if (auto problem = failure("sheets")) return tl::unexpected<Problem>(*problem);
  const Answer<Job> found = lookup(job_map, id, "job");
  if (!found) return tl::unexpected<Problem>(found.error());
  std::vector<SheetRecord> out;
  for (int k = first; k <= std::min(found->sheets_total, first + most - 1); ++k) {
    SheetRecord sheet;
    sheet.number = k;
    sheet.state = k == 1 ? "ready" : "waiting";
    sheet.plan.number = k;
    sheet.plan.paths = 10;
    sheet.plan.cut_mm = 100;
    out.push_back(sheet);
  }
  return out;
}

Answer<Ledger> FakeJobs::ledger(const std::string& id, int sheet) {
  if (auto problem = failure("ledger")) return tl::unexpected<Problem>(*problem);
  const Answer<Job> found = lookup(job_map, id, "job");
  if (!found) return tl::unexpected<Problem>(found.error());
  if (sheet > found->sheets_total) return nothing("the job has no such sheet");
  Ledger ledger;
  ledger.sheet = sheet;
  ledger.certain_upto = 4;
  ledger.certain = {{0, 4}};
  ledger.in_doubt = {{5, 6}};
  ledger.not_sent = {{7, 9}};
  ledger.attempts.push_back({.id = id_of(1), .started = kNow, .operator_name = "uid:0"});
  return ledger;
}

Answer<Job> FakeJobs::patch(const Principal&, const std::string& id, std::int64_t if_match,
                            const JobPatch& patch) {
  if (auto problem = failure("patch_job")) return tl::unexpected<Problem>(*problem);
  last_patch = patch;
  Job& job = job_map.at(id);
  if (job.rev != if_match) return tl::unexpected(stale(job));
  if (patch.priority) job.priority = *patch.priority;
  if (patch.name) job.name = *patch.name;
  return changed(job);
}

Answer<Job> FakeCutting::act(const Principal& who, const std::string& id, std::int64_t if_match,
                             const ActionRequest& request) {
  if (auto problem = failure("act")) return tl::unexpected<Problem>(*problem);
  last_action = request;
  Job& job = job_map.at(id);
  if (job.rev != if_match) return tl::unexpected(stale(job));
  if (is_terminal(job.state)) {
    Problem conflict{ProblemKind::StateConflict, "the job has ended"};
    conflict.state = std::string(name_of(job.state));
    return tl::unexpected<Problem>(conflict);
  }
  static const std::map<JobAction, JobState> kLeadsTo{
      {JobAction::Arm, JobState::Armed},      {JobAction::Disarm, JobState::Ready},
      {JobAction::Start, JobState::Cutting},  {JobAction::Pause, JobState::Paused},
      {JobAction::Resume, JobState::Cutting}, {JobAction::Cancel, JobState::Cancelled},
  };
  if (const auto next = kLeadsTo.find(request.action); next != kLeadsTo.end())
    job.state = next->second;
  job.operator_name = who.name;
  return changed(job);
}

Answer<void> FakeJobs::remove(const Principal&, const std::string& id) {
  if (auto problem = failure("delete_job")) return tl::unexpected<Problem>(*problem);
  job_map.erase(id);
  return {};
}

Answer<Page<Job>> FakeJobs::queue(const std::string& device, const PageRequest& request) {
  note("queue");
  last_page = request;
  Page<Job> page;
  for (const auto& [id, job] : job_map) {
    if (is_terminal(job.state) || (!device.empty() && job.device != device) || id <= request.cursor)
      continue;
    if (page.items.size() == static_cast<std::size_t>(request.limit)) {
      page.next_cursor = page.items.back().id;
      break;
    }
    page.items.push_back(job);
  }
  return page;
}

Answer<Job> FakeJobs::hold(const Principal&, const std::string& id, bool held) {
  if (auto problem = failure("hold")) return tl::unexpected<Problem>(*problem);
  const auto found = job_map.find(id);
  if (found == job_map.end()) return nothing("there is no such job");
  found->second.held = held;
  return changed(found->second);
}

Answer<Job> FakeJobs::move(const Principal&, const std::string& id, const std::string&) {
  if (auto problem = failure("move")) return tl::unexpected<Problem>(*problem);
  return lookup(job_map, id, "job");
}

std::vector<DeviceRecord> FakeDevices::list() {
  note("devices");
  std::vector<DeviceRecord> out;
  for (const auto& [id, device] : device_map) out.push_back(device);
  return out;
}

Answer<DeviceRecord> FakeDevices::find(const std::string& id) {
  if (auto problem = failure("device")) return tl::unexpected<Problem>(*problem);
  return lookup(device_map, id, "device");
}

Answer<DeviceRecord> FakeDevices::act(const Principal&, const std::string& id,
                                      std::int64_t if_match, const DeviceRequest& request) {
  if (auto problem = failure("act_on_device")) return tl::unexpected<Problem>(*problem);
  const auto found = device_map.find(id);
  if (found == device_map.end()) return nothing("there is no such device");
  DeviceRecord& device = found->second;
  if (device.rev != if_match) {
    Problem changed{ProblemKind::Stale, "it was changed meanwhile"};
    changed.rev = device.rev;
    return tl::unexpected<Problem>(changed);
  }
  if (request.action == "enable" || request.action == "disable")
    device.enabled = request.action == "enable";
  ++device.rev;
  last_device_request = request;
  DeviceRecord answer = device;
  if (request.action == "test-cut") answer.test_job = "01JD0000000000000000000777";
  return answer;
}

}  // namespace popcut::daemon
