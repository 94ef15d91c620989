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

constexpr Route get(std::string_view path, RouteAccess access, Handler handler,
                    std::string_view query = {}) {
  return {
      .method = Method::Get, .path = path, .access = access, .handler = handler, .query = query};
}

// An action: a person asks it of a revision that was seen, and it takes effect once.
constexpr Route action(std::string_view path, RouteAccess access, Handler handler,
                       MatchRule match = MatchRule::Required, bool is_urgent = false) {
  return {.method = Method::Post,
          .path = path,
          .access = access,
          .handler = handler,
          .body = kJson,
          .key = kKeyed,
          .match = match,
          .is_urgent = is_urgent};
}

constexpr auto kTable = std::to_array<Route>({
    {.method = Method::Get,
     .path = "/healthz",
     .access = kEveryone,
     .handler = handle::healthz,
     .patience = Patience::Probe},
    {.method = Method::Get,
     .path = "/readyz",
     .access = kEveryone,
     .handler = handle::readyz,
     .patience = Patience::Probe},
    get("/metrics", kViewer, handle::metrics),
    get("/v1/meta", kViewer, handle::meta),
    get("/v1/openapi.json", kViewer, handle::openapi),
    get("/v1/usage", kViewer, handle::usage, "from to by"),

    {.method = Method::Post,
     .path = "/v1/session/one-shot",
     .access = kViewer,
     .handler = handle::create_one_shot,
     .body = kJson},
    {.method = Method::Post,
     .path = "/v1/session",
     .access = kEveryone,
     .handler = handle::open_session,
     .body = kJson},
    {.method = Method::Delete,
     .path = "/v1/session",
     .access = kViewer,
     .handler = handle::close_session},
    get("/v1/tokens", kAdmin, handle::list_tokens, "limit cursor"),
    {.method = Method::Post,
     .path = "/v1/tokens",
     .access = kAdmin,
     .handler = handle::create_token,
     .body = kJson},
    {.method = Method::Delete,
     .path = "/v1/tokens/{id}",
     .access = kAdmin,
     .handler = handle::delete_token},

    {.method = Method::Post,
     .path = "/v1/assets",
     .access = kSubmitter,
     .handler = handle::add_asset,
     .body = BodyRule::Asset},
    {.method = Method::Post,
     .path = "/v1/designs",
     .access = kSubmitter,
     .handler = handle::add_design,
     .body = BodyRule::Design,
     .query = "name",
     .patience = Patience::Design},
    get("/v1/designs", kViewer, handle::list_designs, "limit cursor"),
    get("/v1/designs/{id}", kViewer, handle::get_design),
    get("/v1/designs/{id}/content", kViewer, handle::design_content),
    {.method = Method::Get,
     .path = "/v1/designs/{id}/preview.svg",
     .access = kViewer,
     .handler = handle::design_preview,
     .patience = Patience::Design},
    {.method = Method::Delete,
     .path = "/v1/designs/{id}",
     .access = kSubmitter,
     .handler = handle::delete_design},
    {.method = Method::Post,
     .path = "/v1/designs/{id}/plan",
     .access = kSubmitter,
     .handler = handle::plan_design,
     .body = kJson,
     .key = KeyRule::Allowed},
    get("/v1/plans/{id}", kViewer, handle::get_plan),
    {.method = Method::Delete,
     .path = "/v1/plans/{id}",
     .access = kSubmitter,
     .handler = handle::delete_plan},
    get("/v1/plans/{id}/plan.json", kViewer, handle::plan_file),
    get("/v1/plans/{id}/pattern.svg", kViewer, handle::plan_file),
    get("/v1/plans/{id}/assembly.svg", kViewer, handle::plan_file),
    get("/v1/plans/{id}/deploy.glb", kViewer, handle::plan_file),
    get("/v1/plans/{id}/report.json", kViewer, handle::plan_file),
    get("/v1/plans/{id}/sheets/{k}.svg", kViewer, handle::sheet_svg),
    get("/v1/plans/{id}/sheets/{k}/program", kViewer, handle::sheet_program),

    get("/v1/materials", kViewer, handle::list_materials, "limit cursor"),
    get("/v1/materials/{id}", kViewer, handle::get_material),
    {.method = Method::Put,
     .path = "/v1/materials/{id}",
     .access = kAdmin,
     .handler = handle::put_material,
     .body = kJson,
     .match = MatchRule::OrNew},
    {.method = Method::Delete,
     .path = "/v1/materials/{id}",
     .access = kAdmin,
     .handler = handle::delete_material,
     .match = MatchRule::Required},

    get("/v1/devices", kViewer, handle::list_devices, "limit cursor"),
    get("/v1/devices/{id}", kViewer, handle::get_device),
    action("/v1/devices/{id}/actions/enable", kAdmin, handle::act_on_device),
    action("/v1/devices/{id}/actions/disable", kAdmin, handle::act_on_device),
    action("/v1/devices/{id}/actions/reset", kOperator, handle::act_on_device),
    action("/v1/devices/{id}/actions/test-cut", kOperator, handle::act_on_device),

    {.method = Method::Post,
     .path = "/v1/jobs",
     .access = kSubmitter,
     .handler = handle::create_job,
     .body = kJson,
     .key = kKeyed},
    get("/v1/jobs", kViewer, handle::list_jobs, "limit cursor state owner device since"),
    {.method = Method::Get,
     .path = "/v1/jobs/{id}",
     .access = kViewer,
     .handler = handle::get_job,
     .is_urgent = true},
    {.method = Method::Patch,
     .path = "/v1/jobs/{id}",
     .access = kSubmitter,
     .handler = handle::patch_job,
     .body = kJson,
     .key = KeyRule::Allowed,
     .match = MatchRule::Required},
    {.method = Method::Delete,
     .path = "/v1/jobs/{id}",
     .access = kSubmitter,
     .handler = handle::delete_job,
     .match = MatchRule::Allowed},
    get("/v1/jobs/{id}/sheets", kViewer, handle::job_sheets, "limit cursor"),
    get("/v1/jobs/{id}/sheets/{k}", kViewer, handle::job_sheet),
    get("/v1/jobs/{id}/sheets/{k}/ledger", kViewer, handle::sheet_ledger),
    get("/v1/jobs/{id}/events", kViewer, handle::job_events, "after limit"),
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

    get("/v1/queue", kViewer, handle::get_queue, "limit cursor device"),
    action("/v1/queue/actions/hold", kOperator, handle::hold_job, MatchRule::Allowed),
    action("/v1/queue/actions/release", kOperator, handle::release_job, MatchRule::Allowed),
    action("/v1/queue/actions/move", kOperator, handle::move_job, MatchRule::Allowed),

    {.method = Method::Get,
     .path = "/v1/events",
     .access = kViewer,
     .handler = handle::list_events,
     .query = "after limit",
     .is_stream = true},

    // A copy of the database cannot be made inside the transaction that a key would need, and both
    // may well be done twice.
    {.method = Method::Post,
     .path = "/v1/db/actions/backup",
     .access = kAdmin,
     .handler = handle::backup,
     .body = kJson},
    {.method = Method::Post,
     .path = "/v1/db/actions/check",
     .access = kAdmin,
     .handler = handle::check_database,
     .body = kJson},
});

constexpr bool is_action(const Route& route) {
  return route.path.find("/actions/") != std::string_view::npos;
}

// Whoever adds a route that moves a knife and forgets its key, its revision or its role learns it
// from the compiler.
constexpr bool is_sound(const Route& route) {
  const bool changes = route.method != Method::Get;
  if (route.path.empty() || route.path.front() != '/' || route.path.back() == '/') return false;
  if (changes && route.access.is_open() && route.path != "/v1/session") return false;
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
