// SPDX-License-Identifier: MIT
// Equal bytes and equal requests of several people: each of them owns the one thing that these are.
#include <atomic>
#include <filesystem>
#include <string>

#include <catch2/catch.hpp>

#include "tests/support/service_bench.hpp"

namespace service_owners_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::write_text;

namespace {

namespace fs = std::filesystem;

class Owners : public ServiceBench {
 public:
  using ServiceBench::ServiceBench;
  Answer<Design> upload(const Principal& who, const std::string& text, const std::string& name,
                        const std::string& type = "application/json") {
    const Upload sent = incoming(text);
    return told<Design>(
        [&](LiveService& s, auto done) { s.designs.add(who, sent, type, name, done); });
  }
  Answer<Asset> upload_asset(const Principal& who, const std::string& text,
                             const std::string& name) {
    Upload sent = incoming(text);
    sent.name = name;
    return on([&](LiveService& s) { return s.designs.add_asset(who, sent); });
  }
  Answer<PlanRecord> plan(const Principal& who, const std::string& design) {
    return on([&](LiveService& s) { return s.plans.request(who, {.design = design}); });
  }
  Answer<SearchRecord> search(const Principal& who, const std::string& model) {
    return on([&](LiveService& s) { return s.searches.request(who, {.model = model}); });
  }
  Answer<Job> job_of(const Principal& who, const std::string& design) {
    return on([&](LiveService& s) { return s.jobs.create(who, {.design = design, .plan = {}}); });
  }
  Answer<Design> design(const Principal& who, const std::string& id) {
    return on([&](LiveService& s) { return s.designs.find(who, id); });
  }
  Answer<void> remove_design(const Principal& who, const std::string& id) {
    return on([&](LiveService& s) { return s.designs.remove(who, id); });
  }
  Answer<void> remove_asset(const Principal& who, const std::string& id) {
    return on([&](LiveService& s) { return s.designs.remove_asset(who, id); });
  }
  Answer<void> remove_plan(const Principal& who, const std::string& id) {
    return on([&](LiveService& s) { return s.plans.remove(who, id); });
  }
  Answer<void> remove_search(const Principal& who, const std::string& id) {
    return on([&](LiveService& s) { return s.searches.remove(who, id); });
  }
  std::optional<PlanState> plan_state(const std::string& id) {
    const auto found = on([&](LiveService& s) { return s.plans.find(id); });
    return found ? std::optional(found->state) : std::nullopt;
  }
  std::optional<SearchState> search_state(const std::string& id) {
    const auto found = on([&](LiveService& s) { return s.searches.find(viewer, id); });
    return found ? std::optional(found->state) : std::nullopt;
  }
  bool is_planned(const std::string& id) {
    return wait([&] { return plan_state(id) == PlanState::Planned; });
  }
  bool is_found(const std::string& id) {
    return wait([&] { return search_state(id) == SearchState::Found; });
  }

 private:
  Upload incoming(const std::string& text) {
    static std::atomic<int> number{0};
    const std::string path = folder() + "/incoming/owned-" + std::to_string(++number);
    write_text(path, text);
    return {path, sha256_hex(text), text.size()};
  }
};

}  // namespace

TEST_CASE("a design of two people stays with its plan until the last of them deletes it",
          "[daemon][service]") {
  Owners bench;
  const Design first = bench.upload(bench.student, "{\"card\":1}", "mine").value();
  const Design second = bench.upload(bench.other_student, "{\"card\":1}", "yours").value();
  CHECK(second.id == first.id);
  CHECK(second.is_new);
  CHECK(second.name == "yours");
  CHECK(second.owner == bench.other_student.name);
  CHECK_FALSE(bench.upload(bench.other_student, "{\"card\":1}", "again")->is_new);
  CHECK(bench.design(bench.student, first.id)->name == "mine");
  const auto listed = [&](const Principal& who) {
    return bench.on([&](LiveService& s) { return s.designs.list(who, {}); }).items.at(0).name;
  };
  CHECK(listed(bench.student) == "mine");
  CHECK(listed(bench.other_student) == "yours");
  CHECK(listed(bench.viewer) == "mine");
  const std::string plan = bench.plan(bench.student, first.id)->id;
  CHECK(bench.plan(bench.other_student, first.id)->id == plan);
  REQUIRE(bench.is_planned(plan));

  CHECK(bench.remove_design(bench.student, first.id));
  CHECK(bench.design(bench.other_student, first.id)->name == "yours");
  CHECK(bench.design(bench.viewer, first.id)->owner == bench.other_student.name);
  CHECK(bench.plan_state(plan) == PlanState::Planned);
  CHECK(fs::exists(bench.folder() + "/plans/" + plan));
  CHECK(bench.remove_design(bench.student, first.id).error().kind == ProblemKind::Forbidden);
  CHECK(bench.upload(bench.student, "{\"card\":1}", "back")->is_new);
  CHECK(bench.remove_design(bench.student, first.id));

  CHECK(bench.remove_design(bench.other_student, first.id));
  CHECK(bench.design(bench.viewer, first.id).error().kind == ProblemKind::NotFound);
  CHECK_FALSE(bench.plan_state(plan));
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/plans"); }));
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/designs"); }));
  CHECK(bench.store().database().number("SELECT count(*) FROM ownership") == 0);
}

TEST_CASE("who plans a design of somebody else keeps it", "[daemon][service]") {
  Owners bench;
  const std::string design = bench.upload(bench.student, "{\"card\":1}", "mine")->id;
  const std::string plan = bench.plan(bench.other_student, design)->id;
  REQUIRE(bench.is_planned(plan));
  CHECK(bench.remove_plan(bench.student, plan).error().kind == ProblemKind::Forbidden);
  CHECK(bench.remove_design(bench.student, design));
  CHECK(bench.plan_state(plan));
  CHECK(bench.design(bench.other_student, design)->owner == bench.other_student.name);
  CHECK(bench.remove_plan(bench.other_student, plan));
  CHECK_FALSE(bench.plan_state(plan));
  CHECK(bench.remove_design(bench.other_student, design));
}

TEST_CASE("a plan that two people wait for is made when one of them deletes it",
          "[daemon][service]") {
  Owners bench;
  const std::string design = bench.upload(bench.student, "slow", "mine")->id;
  const std::string plan = bench.plan(bench.student, design)->id;
  CHECK(bench.plan(bench.other_student, design)->id == plan);
  REQUIRE(bench.wait([&] { return bench.planner.started == 2; }));
  CHECK(bench.remove_plan(bench.student, plan));
  CHECK(bench.planner.cancelled == 0);
  CHECK(bench.remove_plan(bench.student, plan).error().kind == ProblemKind::Forbidden);
  bench.planner.release();
  CHECK(bench.is_planned(plan));
}

TEST_CASE("only jobs of one's own keep one from deleting a design or plan", "[daemon][service]") {
  Owners bench;
  const std::string design = bench.upload(bench.student, "{\"card\":1}", "mine")->id;
  const std::string own = bench.plan(bench.student, design)->id;
  const Job job = bench.job_of(bench.other_student, design).value();
  CHECK(job.plan == own);
  CHECK(bench.remove_design(bench.other_student, design).error().kind ==
        ProblemKind::StateConflict);
  CHECK(bench.remove_plan(bench.other_student, own).error().kind == ProblemKind::StateConflict);
  CHECK(bench.remove_plan(bench.tutor, own).error().kind == ProblemKind::StateConflict);
  CHECK(bench.remove_plan(bench.student, own));
  CHECK(bench.remove_design(bench.student, design));
  CHECK(bench.wait_for(job.id, JobState::Ready).state == JobState::Ready);
  CHECK(bench.design(bench.viewer, design));
}

TEST_CASE("a model of two people stays with its searches until the last of them deletes it",
          "[daemon][service]") {
  Owners bench;
  const Asset first = bench.upload_asset(bench.student, "vase", "vase.obj").value();
  const Asset second = bench.upload_asset(bench.other_student, "vase", "vase.obj").value();
  CHECK(second.id == first.id);
  CHECK(second.is_new);
  CHECK(second.owner == bench.other_student.name);
  CHECK_FALSE(bench.upload_asset(bench.other_student, "vase", "other")->is_new);
  const SearchRecord search = bench.search(bench.student, first.id).value();
  const SearchRecord same = bench.search(bench.other_student, first.id).value();
  CHECK(same.id == search.id);
  CHECK(same.owner == bench.other_student.name);
  REQUIRE(bench.is_found(search.id));
  CHECK(bench.remove_search(bench.student, search.id));
  CHECK(bench.search_state(search.id) == SearchState::Found);
  CHECK(bench.remove_asset(bench.student, first.id));
  CHECK(bench.search_state(search.id) == SearchState::Found);
  CHECK(fs::exists(bench.folder() + "/assets/" + first.id));
  CHECK(bench.remove_asset(bench.other_student, first.id));
  CHECK_FALSE(bench.search_state(search.id));
  CHECK_FALSE(fs::exists(bench.folder() + "/assets/" + first.id));
  // On another thread, because a large file takes long to remove.
  CHECK(bench.wait([&] { return fs::is_empty(bench.folder() + "/assets"); }));
}

TEST_CASE("a waiting search of two people goes on for the other and in either one's turn",
          "[daemon][service]") {
  Owners bench;
  const auto model = [&](const std::string& bytes) {
    return bench.upload_asset(bench.student, bytes, "vase.obj")->id;
  };
  const std::string running = bench.search(bench.student, model("slow 0"))->id;
  REQUIRE(bench.wait([&] { return bench.planner.started == 1; }));
  const std::string shared_model = model("vase");
  const std::string before = bench.search(bench.student, model("slow 1"))->id;
  const std::string shared = bench.search(bench.student, shared_model)->id;
  CHECK(bench.search(bench.other_student, shared_model)->id == shared);
  CHECK(bench.remove_search(bench.student, shared));
  CHECK(bench.search_state(shared) == SearchState::Pending);
  CHECK(bench.remove_search(bench.student, running));
  CHECK(bench.is_found(shared));  // before the older search of the first one
  CHECK(bench.search_state(before) == SearchState::Pending);
}

TEST_CASE("an asset that a design of one's own refers to stays and of others it tells nothing",
          "[daemon][service]") {
  Owners bench;
  const Asset mesh = bench.upload_asset(bench.student, "mesh", "vase.obj").value();
  const std::string spec = "{\"mesh\":\"" + mesh.id + "\"}";
  const Design design = bench.upload(bench.other_student, spec, "vase").value();
  REQUIRE(design.assets == std::vector<std::string>{mesh.id});
  CHECK(bench.remove_asset(bench.other_student, mesh.id).error().kind ==
        ProblemKind::StateConflict);
  CHECK(bench.remove_asset(bench.tutor, mesh.id).error().kind == ProblemKind::StateConflict);
  CHECK(bench.remove_asset(bench.student, mesh.id));
  CHECK(fs::exists(bench.folder() + "/assets/" + mesh.id));
  CHECK(bench.plan(bench.other_student, design.id));
  CHECK(bench.remove_design(bench.other_student, design.id));
  CHECK(bench.remove_asset(bench.other_student, mesh.id));
  CHECK_FALSE(fs::exists(bench.folder() + "/assets/" + mesh.id));
}

TEST_CASE("an operator deletes what they do not own for all and what they own for themselves",
          "[daemon][service]") {
  Owners bench;
  const std::string design = bench.upload(bench.student, "{\"card\":1}", "mine")->id;
  CHECK(bench.upload(bench.other_student, "{\"card\":1}", "yours"));
  CHECK(bench.upload(bench.tutor, "{\"card\":1}", "ours")->is_new);
  CHECK(bench.remove_design(bench.tutor, design));
  CHECK(bench.design(bench.student, design)->name == "mine");
  CHECK(bench.remove_design(bench.tutor, design));
  CHECK(bench.design(bench.student, design).error().kind == ProblemKind::NotFound);
}

TEST_CASE("bytes that somebody sent as another kind are checked again", "[daemon][service]") {
  Owners bench;
  const std::string text = "{\"card\":1}";
  CHECK(bench.upload(bench.student, text, "mine"));
  REQUIRE(bench.planner.started == 1);
  CHECK(bench.upload(bench.other_student, text, "yours", "image/svg+xml"));
  CHECK(bench.planner.started == 2);
  CHECK(bench.planner.last_task().media_type == "image/svg+xml");
}

}  // namespace service_owners_test
