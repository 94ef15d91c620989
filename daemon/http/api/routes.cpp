// SPDX-License-Identifier: MIT
#include "daemon/http/api/routes.hpp"

#include <algorithm>
#include <array>

#include "daemon/http/api/handlers.hpp"

namespace popcut::daemon::http {
namespace {

constexpr RouteAccess kEveryone = RouteAccess::everyone();
constexpr RouteAccess kViewer{Role::Viewer};
constexpr RouteAccess kSubmitter{Role::Submitter};
constexpr RouteAccess kOperator{Role::Operator};
constexpr RouteAccess kAdmin{Role::Admin};

constexpr auto kJson = BodyRule::Json;
constexpr auto kKeyed = KeyRule::Required;

// What a row says beyond method, path, role and handler.
struct Rules {
  BodyRule body{BodyRule::None};
  KeyRule key{KeyRule::None};
  MatchRule match{MatchRule::None};
  std::string_view query{};
  bool is_urgent{false};
  Patience patience{Patience::Usual};
  bool is_stream{false};
  bool is_static{false};
  Bucket bucket{Bucket::Usual};
  bool ends_with_client{false};
  Guess guess{Guess::None};
};

constexpr Route route(Method method, std::string_view path, RouteAccess access, Handler handler,
                      const Rules& rules) {
  return {method,          path,
          access,          handler,
          rules.body,      rules.key,
          rules.match,     rules.query,
          rules.is_urgent, rules.patience,
          rules.is_stream, rules.is_static,
          rules.bucket,    rules.ends_with_client,
          rules.guess};
}

constexpr Route get(std::string_view path, RouteAccess access, Handler handler,
                    const Rules& rules = {}) {
  return route(Method::Get, path, access, handler, rules);
}
constexpr Route post(std::string_view path, RouteAccess access, Handler handler,
                     const Rules& rules) {
  return route(Method::Post, path, access, handler, rules);
}
constexpr Route remove(std::string_view path, RouteAccess access, Handler handler,
                       const Rules& rules = {}) {
  return route(Method::Delete, path, access, handler, rules);
}

// An action: a person asks it of a revision that was seen, and it takes effect once.
constexpr Route action(std::string_view path, RouteAccess access, Handler handler,
                       MatchRule match = MatchRule::Required, bool is_urgent = false) {
  return post(path, access, handler,
              {.body = kJson, .key = kKeyed, .match = match, .is_urgent = is_urgent});
}

constexpr auto kTable = std::to_array<Route>({
    get("/", kEveryone, handle::page, {.is_static = true}),
    get("/page/{file}", kEveryone, handle::page, {.is_static = true}),
    get("/healthz", kEveryone, handle::healthz, {.patience = Patience::Probe}),
    get("/readyz", kEveryone, handle::readyz, {.patience = Patience::Probe}),
    get("/metrics", kViewer, handle::metrics),
    get("/v1/meta", kViewer, handle::meta),
    get("/v1/openapi.json", kViewer, handle::openapi),
    get("/v1/examples", kViewer, handle::list_examples),
    get("/v1/design-schema", kViewer, handle::design_schema),
    get("/v1/machines", kViewer, handle::list_machines),
    get("/v1/usage", kViewer, handle::usage, {.query = "from to by"}),

    post("/v1/session/one-shot", kViewer, handle::create_one_shot, {.body = kJson}),
    post("/v1/session", kEveryone, handle::open_session, {.body = kJson, .guess = Guess::Word}),
    post("/v1/session/pair", kEveryone, handle::ask_pairing,
         {.body = kJson, .guess = Guess::Another}),
    post("/v1/session/pair/allow", kViewer, handle::allow_pairing,
         {.body = kJson, .guess = Guess::Code}),
    post("/v1/session/pair/collect", kEveryone, handle::collect_pairing,
         {.body = kJson, .guess = Guess::Secret}),
    remove("/v1/session", kViewer, handle::close_session),
    get("/v1/tokens", kAdmin, handle::list_tokens, {.query = "limit cursor"}),
    post("/v1/tokens", kAdmin, handle::create_token, {.body = kJson}),
    remove("/v1/tokens/{id}", kAdmin, handle::delete_token),

    get("/v1/sessions", kViewer, handle::list_sessions, {.query = "limit cursor"}),
    remove("/v1/sessions/{id}", kViewer, handle::end_session),

    post("/v1/assets", kSubmitter, handle::add_asset, {.body = BodyRule::Asset, .query = "name"}),
    get("/v1/assets", kViewer, handle::list_assets, {.query = "limit cursor"}),
    remove("/v1/assets/{id}", kSubmitter, handle::delete_asset),
    post("/v1/assets/{id}/search", kSubmitter, handle::search_cards,
         {.body = kJson, .key = KeyRule::Allowed}),
    get("/v1/searches/{id}", kViewer, handle::get_search),
    remove("/v1/searches/{id}", kSubmitter, handle::delete_search),
    get("/v1/searches/{id}/cards/{k}.png", kViewer, handle::card_picture,
        {.bucket = Bucket::Picture}),
    post("/v1/searches/{id}/cards/{k}/design", kSubmitter, handle::pick_card,
         {.body = kJson, .patience = Patience::Design}),
    post("/v1/designs", kSubmitter, handle::add_design,
         {.body = BodyRule::Design, .query = "name", .patience = Patience::Design}),
    get("/v1/designs", kViewer, handle::list_designs, {.query = "limit cursor"}),
    get("/v1/designs/{id}", kViewer, handle::get_design),
    get("/v1/designs/{id}/content", kViewer, handle::design_content),
    get("/v1/designs/{id}/preview.svg", kViewer, handle::design_preview,
        {.patience = Patience::Design, .bucket = Bucket::Picture}),
    remove("/v1/designs/{id}", kSubmitter, handle::delete_design),
    post("/v1/designs/{id}/plan", kSubmitter, handle::plan_design,
         {.body = kJson, .key = KeyRule::Allowed}),
    get("/v1/plans/{id}", kViewer, handle::get_plan),
    remove("/v1/plans/{id}", kSubmitter, handle::delete_plan),
    get("/v1/plans/{id}/plan.json", kViewer, handle::plan_file),
    get("/v1/plans/{id}/pattern.svg", kViewer, handle::plan_file),
    get("/v1/plans/{id}/assembly.svg", kViewer, handle::plan_file),
    get("/v1/plans/{id}/deploy.glb", kViewer, handle::plan_file),
    get("/v1/plans/{id}/report.json", kViewer, handle::plan_file),
    get("/v1/plans/{id}/sheets/{k}.svg", kViewer, handle::sheet_svg),
    get("/v1/plans/{id}/sheets/{k}/program", kViewer, handle::sheet_program),
    get("/v1/plans/{id}/sheets/{k}/strokes", kViewer, handle::sheet_strokes),
    get("/v1/plans/{id}/sheets/{k}/artwork.pdf", kViewer, handle::sheet_artwork,
        {.query = "mode dpi clay back model",
         .patience = Patience::Design,
         .ends_with_client = true}),

    // What somebody looks at while they design.
    post("/v1/preview", kSubmitter, handle::preview_spec,
         {.body = kJson, .bucket = Bucket::Preview, .ends_with_client = true}),
    post("/v1/place", kSubmitter, handle::place_spec,
         {.body = kJson,
          .patience = Patience::Design,
          .bucket = Bucket::Preview,
          .ends_with_client = true}),
    get("/v1/designs/{id}/deployed.svg", kViewer, handle::design_picture,
        {.patience = Patience::Design, .bucket = Bucket::Picture}),
    get("/v1/designs/{id}/pattern.svg", kViewer, handle::design_picture,
        {.patience = Patience::Design, .bucket = Bucket::Picture}),
    get("/v1/designs/{id}/files/{name}", kViewer, handle::design_file,
        {.query = "part", .patience = Patience::Design, .ends_with_client = true}),
    get("/v1/designs/{id}/lattice", kViewer, handle::design_lattice,
        {.patience = Patience::Design, .bucket = Bucket::Picture, .ends_with_client = true}),

    get("/v1/materials", kViewer, handle::list_materials, {.query = "limit cursor"}),
    get("/v1/materials/{id}", kViewer, handle::get_material),
    route(Method::Put, "/v1/materials/{id}", kAdmin, handle::put_material,
          {.body = kJson, .match = MatchRule::OrNew}),
    remove("/v1/materials/{id}", kAdmin, handle::delete_material, {.match = MatchRule::Required}),

    get("/v1/devices", kViewer, handle::list_devices, {.query = "limit cursor"}),
    get("/v1/devices/{id}", kViewer, handle::get_device),
    action("/v1/devices/{id}/actions/enable", kAdmin, handle::act_on_device),
    action("/v1/devices/{id}/actions/disable", kAdmin, handle::act_on_device),
    action("/v1/devices/{id}/actions/reset", kOperator, handle::act_on_device),
    action("/v1/devices/{id}/actions/test-cut", kOperator, handle::act_on_device),

    post("/v1/jobs", kSubmitter, handle::create_job, {.body = kJson, .key = kKeyed}),
    get("/v1/jobs", kViewer, handle::list_jobs,
        {.query = "limit cursor state order owner device site since"}),
    get("/v1/jobs/{id}", kViewer, handle::get_job, {.is_urgent = true}),
    route(Method::Patch, "/v1/jobs/{id}", kSubmitter, handle::patch_job,
          {.body = kJson, .key = KeyRule::Allowed, .match = MatchRule::Required}),
    remove("/v1/jobs/{id}", kSubmitter, handle::delete_job, {.match = MatchRule::Allowed}),
    get("/v1/jobs/{id}/sheets", kViewer, handle::job_sheets, {.query = "limit cursor"}),
    get("/v1/jobs/{id}/sheets/{k}", kViewer, handle::job_sheet),
    get("/v1/jobs/{id}/sheets/{k}/ledger", kViewer, handle::sheet_ledger),
    get("/v1/jobs/{id}/events", kViewer, handle::job_events, {.query = "after limit"}),
    action("/v1/jobs/{id}/actions/arm", kOperator, handle::act<JobAction::Arm>),
    action("/v1/jobs/{id}/actions/disarm", kOperator, handle::act<JobAction::Disarm>,
           MatchRule::OrAny),
    action("/v1/jobs/{id}/actions/start", kOperator, handle::act<JobAction::Start>),
    action("/v1/jobs/{id}/actions/pause", kOperator, handle::act<JobAction::Pause>,
           MatchRule::OrAny, true),
    action("/v1/jobs/{id}/actions/resume", kOperator, handle::act<JobAction::Resume>),
    action("/v1/jobs/{id}/actions/cancel", kSubmitter, handle::act<JobAction::Cancel>,
           MatchRule::OrAny, true),
    action("/v1/jobs/{id}/actions/confirm-result", kOperator,
           handle::act<JobAction::ConfirmResult>),
    action("/v1/jobs/{id}/actions/retry-sheet", kOperator, handle::act<JobAction::RetrySheet>),
    action("/v1/jobs/{id}/actions/skip-sheet", kOperator, handle::act<JobAction::SkipSheet>),
    action("/v1/jobs/{id}/actions/resume-from", kOperator, handle::act<JobAction::ResumeFrom>),

    get("/v1/queue", kViewer, handle::get_queue, {.query = "limit cursor device"}),
    action("/v1/queue/actions/hold", kOperator, handle::hold_job, MatchRule::Allowed),
    action("/v1/queue/actions/release", kOperator, handle::release_job, MatchRule::Allowed),
    action("/v1/queue/actions/move", kOperator, handle::move_job, MatchRule::Allowed),

    get("/v1/events", kViewer, handle::list_events, {.query = "after limit", .is_stream = true}),

    // A copy of the database cannot be made inside the transaction that a key would need, and both
    // may well be done twice.
    post("/v1/db/actions/backup", kAdmin, handle::backup, {.body = kJson}),
    post("/v1/db/actions/check", kAdmin, handle::check_database, {.body = kJson}),
});

constexpr bool is_action(const Route& route) {
  return route.path.find("/actions/") != std::string_view::npos;
}

// Whoever adds a route that moves a knife and forgets its key, its revision or its role learns it
// from the compiler.
constexpr bool is_sound(const Route& route) {
  const bool changes = route.method != Method::Get;
  if (route.path.empty() || route.path.front() != '/') return false;
  if (route.path.size() > 1 && route.path.back() == '/') return false;
  if (route.is_static && (changes || !route.access.is_open())) return false;
  // What everyone may change is a session that begins, and nobody may try as often as they like.
  if (changes && route.access.is_open() &&
      (!route.path.starts_with("/v1/session") || route.guess == Guess::None))
    return false;
  if (changes && !route.access.is_open() && route.access.role() < Role::Submitter &&
      !route.path.starts_with("/v1/session"))
    return false;
  if (is_action(route) && route.path.starts_with("/v1/jobs/") &&
      (route.key != KeyRule::Required || route.match == MatchRule::None))
    return false;
  if (!changes && (route.body != BodyRule::None || route.key != KeyRule::None)) return false;
  return true;
}
static_assert(std::all_of(kTable.begin(), kTable.end(), is_sound));

constexpr bool has_twins() {
  for (std::size_t i = 0; i < kTable.size(); ++i)
    for (std::size_t k = i + 1; k < kTable.size(); ++k)
      if (kTable[i].method == kTable[k].method && kTable[i].path == kTable[k].path) return true;
  return false;
}
static_assert(!has_twins(), "a method and path occur twice in the table");

// Matches one part of a path: a word, "{id}", or "{k}.svg".
bool match_part(std::string_view pattern, const std::string& part,
                std::vector<std::string>& params) {
  if (pattern.empty() || pattern.front() != '{') return pattern == part;
  const std::string_view ending = pattern.substr(pattern.find('}') + 1);
  if (part.size() <= ending.size() || !std::string_view(part).ends_with(ending)) return false;
  params.push_back(part.substr(0, part.size() - ending.size()));
  return true;
}

std::optional<std::vector<std::string>> match_path(std::string_view path,
                                                   const std::vector<std::string>& segments) {
  std::vector<std::string> params;
  for (const std::string& segment : segments) {
    if (path.empty()) return std::nullopt;
    path.remove_prefix(1);
    const std::size_t end = std::min(path.find('/'), path.size());
    if (!match_part(path.substr(0, end), segment, params)) return std::nullopt;
    path.remove_prefix(end);
  }
  if (!path.empty()) return std::nullopt;
  return params;
}

}  // namespace

std::span<const Route> routes() { return kTable; }

Match find_route(Method method, const std::vector<std::string>& segments) {
  Match match;
  const Method wanted = method == Method::Head ? Method::Get : method;
  for (const Route& route : kTable) {
    auto params = match_path(route.path, segments);
    if (!params) continue;
    match.allowed.push_back(route.method);
    if (route.method == Method::Get) match.allowed.push_back(Method::Head);
    if (route.method != wanted || match.route != nullptr) continue;
    match.route = &route;
    match.params = std::move(*params);
  }
  return match;
}

std::string allow_header(const std::vector<Method>& allowed) {
  std::string out;
  for (const Method method : allowed) {
    if (!out.empty()) out += ", ";
    out += name_of(method);
  }
  return out;
}

}  // namespace popcut::daemon::http
