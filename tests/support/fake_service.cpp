// SPDX-License-Identifier: MIT
#include "tests/support/fake_service.hpp"

#include <fstream>
#include <iterator>
#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/support/fake_lookup.hpp"

namespace popcut::daemon {

using namespace fake;

FakeState::FakeState() {
  for (const Role role : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin}) {
    const std::string name(name_of(role));
    bearers["pc_" + name + "_0123456789"] = {"token:" + name, role};
    token_map[name] = {name, name + "'s", role, kNow, std::nullopt};
    session_map[name] = {name, "token:" + name, "", role, kNow, kNow, kNow};
  }
  device_map["sim:cameo3"] = {.id = "sim:cameo3",
                              .model = "cameo3",
                              .title = "Simulated cutter",
                              .state = "idle",
                              .simulated = true,
                              .width_mm = 304.8,
                              .length_mm = 304.8};
  material_map["paper-220"] = {"paper-220", 1, R"({"force_gf": 120})", true};
}

void FakeState::note(const char* name) {
  asked.emplace_back(name);
  if (throws) throw std::runtime_error("the fake was told to");
  if (throws_bad_alloc) throw std::bad_alloc();
}

std::optional<Problem> FakeState::failure(const char* name) {
  note(name);
  std::optional<Problem> problem = std::move(next_problem);
  next_problem.reset();
  return problem;
}

Job& FakeState::changed(Job& job) {
  ++job.rev;
  tell("job", job.id, fmt::format(R"("state":"{}","rev":{})", name_of(job.state), job.rev));
  return job;
}

Job& FakeState::add_job(JobState state, const std::string& owner) {
  Job job;
  job.id = id_of(++next_id_);
  job.rev = 1;
  job.state = state;
  job.owner = job.owner_title = owner;
  job.device = "sim:cameo3";
  job.design = "sha256-" + std::string(64, 'a');
  job.plan = id_of(900);
  job.material = "paper-220";
  job.sheets_total = 2;
  job.sheet = 1;
  job.created = kNow;
  if (state == JobState::Ready)
    job.attention = Attention{"load_sheet", 1, 2, "load sheet 1 of 2", kNow, {"arm"}};
  job.actions = {"arm", "cancel"};
  return job_map[job.id] = job;
}

void FakeState::tell(const std::string& kind, const std::string& job, const std::string& members) {
  const std::int64_t seq = ++seq_;
  const Event event{
      seq, kind, kNow, job,
      fmt::format(R"({{"seq":{},"kind":"{}","job":"{}",{}}})", seq, kind, job, members)};
  log.push_back(event);
  for (const auto& listener : listeners_) listener(event);
}

void FakeState::tell_progress(const std::string& job, const std::string& members) {
  const Event event{0, "progress", kNow, job,
                    fmt::format(R"({{"seq":0,"kind":"progress","job":"{}",{}}})", job, members)};
  for (const auto& listener : listeners_) listener(event);
}

std::optional<Principal> FakeAccess::authenticate(std::string_view bearer) {
  asked.emplace_back("authenticate");
  const auto found = bearers.find(std::string(bearer));
  if (found == bearers.end()) return std::nullopt;
  return found->second;
}

Answer<NewToken> FakeAccess::create_token(const Principal&, const std::string& name, Role role,
                                          std::optional<int> lifetime_s) {
  if (auto problem = failure("create_token")) return tl::unexpected<Problem>(*problem);
  const std::string id = id_of(++next_id_);
  TokenRecord record{id, name, role, kNow, std::nullopt};
  if (lifetime_s) record.expires = kNow + TimeMs{*lifetime_s} * 1000;
  const std::string text = "pc_" + id + "_" + std::string(43, 'x');
  token_map[id] = record;
  bearers[text] = {"token:" + id, role};
  return NewToken{record, text};
}

std::vector<TokenRecord> FakeAccess::tokens() {
  note("tokens");
  std::vector<TokenRecord> out;
  for (const auto& [id, token] : token_map) out.push_back(token);
  return out;
}

Answer<void> FakeAccess::delete_token(const Principal&, const std::string& id) {
  if (auto problem = failure("delete_token")) return tl::unexpected<Problem>(*problem);
  if (token_map.erase(id) == 0) return nothing("there is no such token");
  std::erase_if(bearers, [&](const auto& entry) { return entry.second.name == "token:" + id; });
  for (const auto& listener : access_listeners_) listener();
  return {};
}

std::vector<SessionRecord> FakeAccess::sessions(const Principal&) {
  note("sessions");
  std::vector<SessionRecord> out;
  for (const auto& [id, session] : session_map) out.push_back(session);
  return out;
}

Answer<void> FakeAccess::end_session(const Principal&, const std::string& id) {
  if (auto problem = failure("end_session")) return tl::unexpected<Problem>(*problem);
  if (session_map.erase(id) == 0) return nothing("there is no such session");
  return {};
}

std::string FakeAccess::title_of(const std::string& principal) {
  const auto found = token_map.find(principal.substr(std::min<std::size_t>(principal.size(), 6)));
  return found == token_map.end() ? principal : found->second.name;
}

std::optional<SessionRecord> FakeAccess::session_of(const std::string& credential) {
  const auto found = session_map.find(credential);
  if (found == session_map.end()) return std::nullopt;
  return found->second;
}

Answer<NewPairing> FakeAccess::ask_pairing(const std::string&, const std::string&) {
  if (auto problem = failure("ask_pairing")) return tl::unexpected<Problem>(*problem);
  const int number = ++next_id_;
  const std::string secret = "secret-" + std::to_string(number);
  const std::string code = fmt::format("CODE{:02}", number % 100);
  pairings_[secret] = code;
  return NewPairing{id_of(number), code, secret, kNow};
}

Answer<AllowedPairing> FakeAccess::allow_pairing(const Principal&, const std::string& code,
                                                 Role role) {
  if (auto problem = failure("allow_pairing")) return tl::unexpected<Problem>(*problem);
  for (auto& [secret, waiting] : pairings_)
    if (!waiting.empty() && waiting == code) {
      waiting.clear();
      return AllowedPairing{"tablet", role};
    }
  return nothing("no tablet waits with this code");
}

Answer<std::optional<NewToken>> FakeAccess::collect_pairing(const std::string& secret) {
  if (auto problem = failure("collect_pairing")) return tl::unexpected<Problem>(*problem);
  const auto found = pairings_.find(secret);
  if (found == pairings_.end()) return nothing("this pairing has ended");
  if (!found->second.empty()) return std::optional<NewToken>();
  pairings_.erase(found);
  const std::string id = id_of(++next_id_);
  return std::optional<NewToken>(
      NewToken{{id, "tablet", Role::Viewer, kNow, kNow}, "pc_" + id + "_" + std::string(43, 'x')});
}

Answer<void> FakeAccess::close_session(const Principal& who) {
  if (auto problem = failure("delete_token")) return tl::unexpected<Problem>(*problem);
  if (!who.name.starts_with("token:")) return nothing("this connection has no session");
  const std::string id = who.name.substr(6);
  if (token_map.erase(id) == 0) return nothing("there is no such token");
  std::erase_if(bearers, [&](const auto& entry) { return entry.second.name == who.name; });
  for (const auto& listener : access_listeners_) listener();
  return {};
}

void FakeAccess::on_access_change(std::function<void()> listener) {
  access_listeners_.push_back(std::move(listener));
}

Answer<std::string> FakeAccess::create_one_shot(const Principal&) {
  if (auto problem = failure("create_one_shot")) return tl::unexpected<Problem>(*problem);
  const std::string word = "one-shot-" + id_of(++next_id_);
  one_shots_[word] = true;
  return word;
}

Answer<NewToken> FakeAccess::open_session(const std::string& one_shot) {
  if (auto problem = failure("open_session")) return tl::unexpected<Problem>(*problem);
  if (one_shots_.erase(one_shot) == 0)
    return refuse(ProblemKind::Unauthenticated, "the word was used, or is too old");
  return create_token({}, "session", Role::Operator, 43200);
}

Answer<Rendered> FakeOperations::once(const Principal& who, const IdempotentRequest& request,
                                      const std::function<Rendered()>& effect) {
  asked.emplace_back("once");
  const std::string key = who.name + " " + request.key;
  if (const auto found = kept_.find(key); found != kept_.end()) {
    if (found->second.sha256 != request.sha256)
      return refuse(ProblemKind::IdempotencyKeyReused, "the key was used for another request");
    Rendered again = found->second.rendered;
    again.replayed = true;
    return again;
  }
  Rendered fresh = effect();
  if (fresh.status < 500 && fresh.status != 429) kept_[key] = {request.sha256, fresh};
  return fresh;
}

void FakeDesigns::add(const Principal& who, Upload upload, std::string media_type, std::string name,
                      std::function<void(Answer<Design>)> done) {
  if (auto problem = failure("add_design")) return done(tl::unexpected<Problem>(*problem));
  if (drops_replies) return;
  last_upload = upload;
  std::ifstream in(upload.path, std::ios::binary);
  last_upload_text.assign(std::istreambuf_iterator<char>(in), {});
  last_upload_name = name;
  last_media_type = media_type;
  const std::string id = "sha256-" + upload.sha256;
  const bool is_new = design_map.find(id) == design_map.end();
  Design design{id, name, "spec", who.name, upload.bytes, kNow, {}, is_new};
  if (is_new) design_map[id] = design;
  done(design);
}

Answer<Asset> FakeDesigns::add_asset(const Principal&, const Upload& upload) {
  if (auto problem = failure("add_asset")) return tl::unexpected<Problem>(*problem);
  last_upload = upload;
  std::ifstream in(upload.path, std::ios::binary);
  last_upload_text.assign(std::istreambuf_iterator<char>(in), {});
  return Asset{
      .id = "sha256-" + upload.sha256, .name = upload.name, .bytes = upload.bytes, .created = kNow};
}

Page<Asset> FakeDesigns::assets(const Principal&, const PageRequest&) {
  note("assets");
  Page<Asset> page;
  for (const auto& [id, asset] : asset_map) page.items.push_back(asset);
  return page;
}

Answer<void> FakeDesigns::remove_asset(const Principal&, const std::string& id) {
  if (auto problem = failure("delete_asset")) return tl::unexpected<Problem>(*problem);
  if (asset_map.erase(id) == 0) return nothing("there is no such asset");
  return {};
}

Page<Design> FakeDesigns::list(const Principal&, const PageRequest& request) {
  note("designs");
  last_page = request;
  Page<Design> page;
  for (const auto& [id, design] : design_map) {
    if (id <= request.cursor) continue;
    if (static_cast<int>(page.items.size()) == request.limit) {
      page.next_cursor = page.items.back().id;
      break;
    }
    page.items.push_back(design);
  }
  return page;
}

Answer<Design> FakeDesigns::find(const Principal&, const std::string& id) {
  if (auto problem = failure("design")) return tl::unexpected<Problem>(*problem);
  return lookup(design_map, id, "design");
}

Answer<std::string> FakeDesigns::content(const std::string& id) {
  if (auto problem = failure("design_content")) return tl::unexpected<Problem>(*problem);
  return lookup(files, id, "content of");
}

Answer<void> FakeDesigns::remove(const Principal&, const std::string& id) {
  if (auto problem = failure("delete_design")) return tl::unexpected<Problem>(*problem);
  design_map.erase(id);
  return {};
}

Answer<PlanRecord> FakePlans::request(const Principal&, const PlanRequest& request) {
  if (auto problem = failure("plan_design")) return tl::unexpected<Problem>(*problem);
  last_plan = request;
  if (design_map.find(request.design) == design_map.end())
    return nothing("there is no such design");
  PlanRecord plan;
  plan.id = id_of(++next_id_);
  plan.design = request.design;
  plan.material = request.material;
  plan.machine = request.machine;
  plan.created = kNow;
  return plan_map[plan.id] = plan;
}

Answer<void> FakePlans::remove(const Principal&, const std::string& id) {
  if (auto problem = failure("delete_plan")) return tl::unexpected<Problem>(*problem);
  if (plan_map.erase(id) == 0) return nothing("there is no such plan");
  return {};
}

Answer<PlanRecord> FakePlans::find(const std::string& id) {
  if (auto problem = failure("plan")) return tl::unexpected<Problem>(*problem);
  return lookup(plan_map, id, "plan");
}

void FakePlans::whole(const std::string& id, std::function<void(Answer<PlanRecord>)> done) {
  done(find(id));
}

Answer<SearchRecord> FakeSearches::request(const Principal& who, const CardSearchRequest& request) {
  if (auto problem = failure("search_cards")) return tl::unexpected<Problem>(*problem);
  last_search = request;
  if (asset_map.find(request.model) == asset_map.end()) return nothing("there is no such asset");
  SearchRecord search;
  search.id = id_of(++next_id_);
  search.owner = who.name;
  search.request = request;
  search.created = kNow;
  return search_map[search.id] = search;
}

Page<SearchRecord> FakeSearches::list(const Principal&, const PageRequest&) {
  note("searches");
  Page<SearchRecord> page;
  for (const auto& [id, search] : search_map) page.items.push_back(search);
  return page;
}

Answer<SearchRecord> FakeSearches::find(const Principal&, const std::string& id) {
  if (auto problem = failure("search")) return tl::unexpected<Problem>(*problem);
  return lookup(search_map, id, "search");
}

Answer<void> FakeSearches::remove(const Principal&, const std::string& id) {
  if (auto problem = failure("delete_search")) return tl::unexpected<Problem>(*problem);
  if (search_map.erase(id) == 0) return nothing("there is no such search");
  return {};
}

Answer<std::string> FakeSearches::picture(const std::string& id, int card) {
  if (auto problem = failure("card_picture")) return tl::unexpected<Problem>(*problem);
  return lookup(files, fmt::format("{}/card-{:02}.png", id, card), "picture");
}

Answer<std::string> FakeSearches::lattice(const std::string& id, int card) {
  if (auto problem = failure("card_lattice")) return tl::unexpected<Problem>(*problem);
  return lookup(files, fmt::format("{}/card-{:02}.lattice", id, card), "lattice");
}

void FakeSearches::pick(const Principal& who, const std::string& id, int card,
                        const std::string& name, std::function<void(Answer<Design>)> done) {
  if (auto problem = failure("pick_card")) return done(tl::unexpected<Problem>(*problem));
  const auto search = search_map.find(id);
  if (search == search_map.end()) return done(nothing("there is no such search"));
  if (card > static_cast<int>(search->second.front.cards.size()))
    return done(nothing("there is no such card"));
  const std::string design = "sha256-" + std::string(64, 'c');
  const bool is_new = design_map.find(design) == design_map.end();
  done(design_map[design] = {design, name, "spec", who.name, 1, kNow, {}, is_new});
}

Answer<std::vector<Machine>> FakePlans::machines() {
  if (auto problem = failure("machines")) return tl::unexpected<Problem>(*problem);
  return all_machines().value();
}

Answer<std::string> FakePlans::file(const std::string& id, const std::string& name) {
  if (auto problem = failure("plan_file")) return tl::unexpected<Problem>(*problem);
  return lookup(files, id + "/" + name, "file");
}

Designs::CallOff FakePlans::artwork(const Principal&, const std::string& id, int sheet,
                                    const ArtworkRequest& wanted, Designs::Shown done) {
  if (auto problem = failure("sheet_artwork"))
    done(tl::unexpected<Problem>(*problem));
  else if (plan_map.find(id) == plan_map.end())
    done(nothing("there is no such plan"));
  else
    done(fmt::format("{} of sheet {} at {}", wanted.mode, sheet, wanted.dpi));
  return [] {};
}

Designs::CallOff FakePlans::make(const Principal&, const std::string& way,
                                 const PlanRequest& wanted, Designs::Shown done) {
  if (auto problem = failure("make"))
    done(tl::unexpected<Problem>(*problem));
  else
    done(fmt::format(R"({{"way": "{}", "design": "{}"}})", way, wanted.design));
  return [] {};
}

void FakeDesigns::preview(const Principal&, const std::string& id,
                          std::function<void(Answer<std::string>)> done) {
  if (auto problem = failure("design_preview")) return done(tl::unexpected<Problem>(*problem));
  if (design_map.find(id) == design_map.end()) return done(nothing("there is no such design"));
  done(preview_svg);
}

Designs::CallOff FakeDesigns::show_spec(const Principal&, const PreviewRequest& request,
                                        Shown done) {
  last_preview = request;
  if (auto problem = failure("preview_spec"))
    done(tl::unexpected<Problem>(*problem));
  else if (holds_previews)
    held_previews.push_back(std::move(done));
  else
    done(lattice_blob);
  return [this] { ++previews_called_off; };
}

Designs::CallOff FakeDesigns::place_spec(const Principal&, const PreviewRequest& request,
                                         Shown done) {
  last_preview = request;
  if (auto problem = failure("place_spec"))
    done(tl::unexpected<Problem>(*problem));
  else
    done(request.spec);
  return [] {};
}

Designs::CallOff FakeDesigns::lattice(const Principal&, const std::string& id,
                                      const std::map<std::string, std::string>&, Shown done) {
  if (auto problem = failure("design_lattice"))
    done(tl::unexpected<Problem>(*problem));
  else if (design_map.find(id) == design_map.end())
    done(nothing("there is no such design"));
  else
    done(lattice_blob);
  return [] {};
}

void FakeDesigns::picture(const Principal&, const std::string& id, const std::string&, Shown done) {
  if (auto problem = failure("design_picture")) return done(tl::unexpected<Problem>(*problem));
  if (design_map.find(id) == design_map.end()) return done(nothing("there is no such design"));
  done(preview_svg);
}

Designs::CallOff FakeDesigns::file(const Principal&, const std::string& id, const std::string& name,
                                   int part, Shown done) {
  if (auto problem = failure("design_file"))
    done(tl::unexpected<Problem>(*problem));
  else if (design_map.find(id) == design_map.end())
    done(nothing("there is no such design"));
  else
    done(fmt::format("{} of part {}", name, part));
  return [] {};
}

std::vector<MaterialRecord> FakeMaterials::list() {
  note("materials");
  std::vector<MaterialRecord> out;
  for (const auto& [id, material] : material_map) out.push_back(material);
  return out;
}

Answer<MaterialRecord> FakeMaterials::find(const std::string& id) {
  if (auto problem = failure("material")) return tl::unexpected<Problem>(*problem);
  return lookup(material_map, id, "material");
}

Answer<MaterialRecord> FakeMaterials::put(const Principal&, const std::string& id,
                                          std::int64_t if_match, const std::string& json) {
  if (auto problem = failure("put_material")) return tl::unexpected<Problem>(*problem);
  const auto found = material_map.find(id);
  const std::int64_t rev = found == material_map.end() ? 0 : found->second.rev;
  if (rev != if_match) {
    Problem stale{ProblemKind::Stale, "it was changed meanwhile"};
    stale.rev = rev;
    return tl::unexpected<Problem>(stale);
  }
  return material_map[id] = {id, rev + 1, json, false};
}

Answer<void> FakeMaterials::remove(const Principal&, const std::string& id, std::int64_t) {
  if (auto problem = failure("delete_material")) return tl::unexpected<Problem>(*problem);
  if (material_map.erase(id) == 0) return nothing("there is no such material");
  return {};
}

Answer<std::vector<Event>> FakeOperations::events(std::int64_t after, int limit,
                                                  const std::string& job) {
  if (auto problem = failure("events")) return tl::unexpected<Problem>(*problem);
  std::vector<Event> out;
  for (const Event& event : log) {
    if (event.seq <= after || event.seq < first_kept) continue;
    if (!job.empty() && event.job != job) continue;
    if (static_cast<int>(out.size()) == limit) break;
    out.push_back(event);
  }
  return out;
}

std::int64_t FakeOperations::last_event() {
  note("last_event");
  return seq_;
}

std::int64_t FakeOperations::first_event() { return first_kept; }

void FakeOperations::listen(std::function<void(const Event&)> listener) {
  listeners_.push_back(std::move(listener));
}

void FakeOperations::usage(std::optional<TimeMs>, std::optional<TimeMs>, const std::string&,
                           std::function<void(Answer<std::vector<UsageRow>>)> done) {
  note("usage");
  done(std::vector<UsageRow>{{"uid:0", 12.5, 340.25, 2}, {"=cmd|' /C calc'!A0", 1, 2, 3}});
}

ServiceHealth FakeOperations::health() {
  note("health");
  return {healthy, 1024, healthy, healthy ? "" : "the disk failed", false};
}

std::string FakeOperations::metrics() {
  note("metrics");
  return "# TYPE popcut_jobs gauge\npopcut_jobs{state=\"queued\"} 0\n";
}

void FakeOperations::backup(const Principal&, std::function<void(Answer<std::string>)> done) {
  if (auto problem = failure("backup")) return done(tl::unexpected<Problem>(*problem));
  done(std::string("backups/popcut-1.db"));
}

void FakeOperations::check_integrity(const Principal&,
                                     std::function<void(Answer<std::string>)> done) {
  if (auto problem = failure("check_integrity")) return done(tl::unexpected<Problem>(*problem));
  done(std::string("ok"));
}

}  // namespace popcut::daemon
