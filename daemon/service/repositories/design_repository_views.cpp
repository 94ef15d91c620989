// SPDX-License-Identifier: MIT
// Part of daemon/service/repositories/design_repository.hpp: views, which the previewer makes.
#include <filesystem>
#include <utility>

#include "daemon/digest/digest.hpp"
#include "daemon/planning/views/preview.hpp"
#include "daemon/service/repositories/design_repository.hpp"

namespace popcut::daemon {
namespace {

constexpr const char* kLattice = "lattice";
constexpr const char* kSpec = "spec.json";
constexpr std::uint64_t kMostRead = 64u << 20;

tl::unexpected<Problem> no_previewer() {
  return refuse(ProblemKind::Unavailable, "this popcutd makes no previews");
}

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
  task.task.material_json = row_of_material(request.material);
  if (!request.place.empty())
    task.task.options = {{"place", request.place}, {"up", request.up}, {"front", request.front}};
  task.who = who.name;
  return task;
}

Designs::CancelView DesignRepository::show(PreviewTask task, std::string name, OnView done) {
  if (!previewer_) {
    done(no_previewer());
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

Designs::CancelView DesignRepository::show_spec(const Principal& who, const PreviewRequest& request,
                                                OnView done) {
  PreviewTask task = task_for(who, request, PlanningTask::Kind::Preview);
  task.task.options["quality"] = request.is_draft ? "draft" : "exact";
  task.key = request.key;
  task.is_patient = request.is_draft;
  return show(std::move(task), kLattice, std::move(done));
}

Designs::CancelView DesignRepository::place_spec(const Principal& who,
                                                 const PreviewRequest& request, OnView done) {
  return show(task_for(who, request, PlanningTask::Kind::Place), kSpec, std::move(done));
}

Designs::CancelView DesignRepository::lattice(const Principal& who, const std::string& id,
                                              const std::map<std::string, std::string>& reading,
                                              OnView done) {
  const Answer<Design> design = find_and_fetch(id);
  if (!design) {
    done(tl::unexpected(design.error()));
    return [] {};
  }
  PreviewTask task{task_for(*design, PlanningTask::Kind::Lattice), who.name};
  if (design->kind != "spec") task.task.options = reading;
  return show(std::move(task), kLattice, std::move(done));
}

Designs::CancelView DesignRepository::file(const Principal& who, const std::string& id,
                                           const std::string& name, int part, OnView done) {
  const Answer<Design> design = find_and_fetch(id);
  if (!design) {
    done(tl::unexpected(design.error()));
    return [] {};
  }
  PreviewTask task{task_for(*design, PlanningTask::Kind::Export), who.name};
  task.task.options["file"] = name;
  task.task.options["part"] = std::to_string(part);
  return show(std::move(task), name, std::move(done));
}

std::string DesignRepository::material_etag_suffix(const std::string& id) {
  constexpr std::size_t kDigits = 12;
  const Answer<Design> design = find_and_fetch(id);
  if (!design || design->kind != "spec") return {};
  return "-" + sha256_hex(row_of_material(material_in_spec(*design))).substr(0, kDigits);
}

std::string DesignRepository::picture_path(const std::string& id, const std::string& name) const {
  return store_.folder().at("previews/" + id + "." + name);
}

void DesignRepository::read_on_side_thread(const std::string& place, OnView done) {
  auto kept = std::make_shared<Result<std::string>>(fail(ErrorKind::Internal, "", "not read"));
  side_thread_.run([kept, place] { *kept = read_whole(place, kMostRead); },
                   [kept, done = std::move(done)] {
                     if (*kept) return done(std::move(**kept));
                     done(tl::unexpected(problem_from(kept->error())));
                   });
}

void DesignRepository::picture(const Principal& who, const std::string& id, const std::string& name,
                               OnView done) {
  const Answer<Design> design = find_and_fetch(id);
  if (!design) return done(tl::unexpected(design.error()));
  const std::string place = picture_path(id, name);
  std::error_code ignored;
  if (const auto bytes = std::filesystem::file_size(place, ignored); !ignored && bytes > 0)
    return read_on_side_thread(place, std::move(done));
  if (!previewer_) return done(no_previewer());
  const auto drawn = picture_requests_.find(id);
  if (drawn != picture_requests_.end()) return drawn->second.push_back({name, std::move(done)});
  // Later requests for this design wait for the task of this one. So add this request to
  // `picture_requests_` only after its task has begun.
  Answer<PreviewTask> task = store_.read([&]() -> Answer<PreviewTask> {
    return PreviewTask{task_for(*design, PlanningTask::Kind::Picture), who.name};
  });
  if (!task) return done(tl::unexpected(task.error()));
  previewer_->start(std::move(*task), [this, id, post = post_,
                                       folder = &store_.folder()](Answer<PlanningOutcome> outcome) {
    // If the design cannot be drawn, keep a picture that says so, and do not try it again each
    // time.
    if (!outcome && outcome.error().kind == ProblemKind::Validation) {
      outcome = PlanningOutcome{};
      for (const char* const one : kPictures)
        outcome->files.push_back({one, planning::no_preview_svg("its preview says why")});
    }
    if (outcome)
      for (const PlanningFile& file : outcome->files)
        (void)write_file(folder->at("previews/" + id + "." + file.name), file.bytes);
    post([this, id, made = std::move(outcome)] { pictures_made(id, made); });
  });
  picture_requests_[id].push_back({name, std::move(done)});
}

void DesignRepository::pictures_made(const std::string& id,
                                     const Answer<PlanningOutcome>& outcome) {
  name_turn("pictures made");
  std::vector<PictureRequest> waiting;
  waiting.swap(picture_requests_[id]);
  picture_requests_.erase(id);
  for (const PictureRequest& one : waiting) {
    if (outcome)
      one.done(file_named(*outcome, one.name));
    else
      one.done(tl::unexpected(outcome.error()));
  }
  // If the design was removed meanwhile, remove its pictures, too.
  if (!find(id))
    for (const char* const name : kPictures) side_thread_.remove(picture_path(id, name));
}

}  // namespace popcut::daemon
