// SPDX-License-Identifier: MIT
#include "daemon/planning/engine/engine.hpp"

#include <chrono>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "daemon/planning/search/freed_memory.hpp"
#include "daemon/planning/search/search_task.hpp"
#include "daemon/planning/task_json.hpp"

namespace popcut::planning {
namespace {

using daemon::PlanningOutcome;

/// Tells what is being done, but not each step of it.
Progress phases_to(const FrameSink& send) {
  using Clock = std::chrono::steady_clock;
  return [&send, last = std::string(), at = Clock::time_point()](std::string_view doing,
                                                                 double done) mutable {
    constexpr std::chrono::milliseconds kEach{200};
    const Clock::time_point now = Clock::now();
    if (doing == last && now - at < kEach) return;
    last = doing;
    at = now;
    (void)send(FrameKind::Phase, "", phase_json(doing, done));  // the outcome tells the fault
  };
}

Result<PlanningOutcome> outcome_of(const std::function<Result<WorkerTask>()>& read,
                                   const FrameSink& send,
                                   const std::function<std::string_view()>& spent) {
  const auto add = [&](const std::string& name, const std::string& bytes) {
    return send(FrameKind::File, name, bytes);
  };
  const auto too_large = [&]() -> tl::unexpected<Error> {
    return fail(ErrorKind::Infeasible, "",
                fmt::format("needs more memory than a design may use; make it smaller or simpler{}",
                            spent()));
  };
  try {
    Result<WorkerTask> task = read();
    if (!task) return tl::unexpected(task.error());
    if (task->kind == daemon::PlanningTask::Kind::Search) {
      keep_freed_memory();
      return search(*task, add, phases_to(send));
    }
    return perform(std::move(*task), add, phases_to(send));
  } catch (const std::bad_alloc&) {
    return too_large();
  } catch (const std::length_error&) {
    return too_large();
  } catch (const std::exception& fault) {
    return fail(ErrorKind::Internal, "worker", fault.what());
  }
}

}  // namespace

Result<void> TaskReader::take_in(Frame frame) {
  if (frame.kind == FrameKind::Task) {
    task_ = read_task(frame.bytes);
    return task_ ? Result<void>() : tl::unexpected(task_.error());
  }
  if (!task_) return tl::unexpected(task_.error());
  if (frame.kind == FrameKind::Design) task_->design = std::move(frame.bytes);
  if (frame.kind == FrameKind::Asset) task_->assets[frame.name] = std::move(frame.bytes);
  is_whole_ = frame.kind == FrameKind::Go;
  return {};
}

Result<void> TaskReader::feed(std::string_view bytes) {
  return frames_.feed(bytes, [this](Frame frame) { return take_in(std::move(frame)); });
}

Result<void> answer(const std::function<Result<WorkerTask>()>& read, const FrameSink& send,
                    const std::function<std::string_view()>& spent) {
  const Result<PlanningOutcome> outcome = outcome_of(read, send, spent);
  return outcome ? send(FrameKind::Outcome, "", outcome_json(*outcome))
                 : send(FrameKind::Failure, "", error_json(outcome.error()));
}

}  // namespace popcut::planning
