// SPDX-License-Identifier: MIT
// What somebody looks at: made by the previewer, and not stored.
#include <utility>

#include "daemon/service/repositories/design_repository.hpp"

namespace popcut::daemon {
namespace {

constexpr const char* kLattice = "lattice";
constexpr const char* kSpec = "spec.json";

Answer<std::string> file_named(PlanningOutcome outcome, const std::string& name) {
  for (PlanningFile& file : outcome.files)
    if (file.name == name) return std::move(file.bytes);
  return refuse(ProblemKind::Internal, "the worker made no " + name);
}

}  // namespace

PreviewTask DesignRepository::task_for(const Principal& who, const PreviewRequest& request,
                                       PlanningTask::Kind kind) const {
  PreviewTask task;
  task.task.kind = kind;
  task.task.design_text = request.spec;
  task.task.design_kind = "spec";
  task.task.media_type = "application/json";
  task.task.assets_folder = store_.folder().at("assets");
  if (!request.place.empty()) task.task.options["place"] = request.place;
  task.who = who.name;
  return task;
}

Designs::CallOff DesignRepository::show(PreviewTask task, std::string name, Shown done) {
  if (!previewer_) {
    done(refuse(ProblemKind::Unavailable, "this popcutd makes no previews"));
    return [] {};
  }
  const std::uint64_t id = previewer_->start(
      std::move(task),
      [name = std::move(name), done = std::move(done)](Answer<PlanningOutcome> outcome) {
        if (!outcome) return done(tl::unexpected(std::move(outcome.error())));
        done(file_named(std::move(*outcome), name));
      });
  return [previewer = std::weak_ptr<Previewer>(previewer_), id] {
    if (const auto here = previewer.lock()) here->cancel(id);
  };
}

Designs::CallOff DesignRepository::show_spec(const Principal& who, const PreviewRequest& request,
                                             Shown done) {
  PreviewTask task = task_for(who, request, PlanningTask::Kind::Preview);
  task.task.options["quality"] = request.is_draft ? "draft" : "exact";
  task.key = request.key;
  task.is_patient = request.is_draft;
  return show(std::move(task), kLattice, std::move(done));
}

Designs::CallOff DesignRepository::place_spec(const Principal& who, const PreviewRequest& request,
                                              Shown done) {
  return show(task_for(who, request, PlanningTask::Kind::Place), kSpec, std::move(done));
}

Designs::CallOff DesignRepository::lattice(const Principal& who, const std::string& id,
                                           Shown done) {
  const Answer<Design> design = find(id);
  if (!design) {
    done(tl::unexpected(design.error()));
    return [] {};
  }
  return show({task_for(*design, PlanningTask::Kind::Lattice), who.name}, kLattice,
              std::move(done));
}

}  // namespace popcut::daemon
