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

constexpr auto kKeyed = KeyRule::Required;

constexpr Route route(Method method, std::string_view path, RouteAccess access, Handler handler,
                      std::string_view summary, RouteRules rules = {}) {
  if (rules.takes != nullptr) rules.body = BodyRule::Json;
  return {rules, method, path, access, handler, summary};
}

constexpr Route get(std::string_view path, RouteAccess access, Handler handler,
                    std::string_view summary, const RouteRules& rules) {
  return route(Method::Get, path, access, handler, summary, rules);
}
constexpr Route post(std::string_view path, RouteAccess access, Handler handler,
                     std::string_view summary, const RouteRules& rules) {
  return route(Method::Post, path, access, handler, summary, rules);
}
constexpr Route remove(std::string_view path, RouteAccess access, Handler handler,
                       std::string_view summary, const RouteRules& rules = {}) {
  return route(Method::Delete, path, access, handler, summary, rules);
}

// An action of a person on the revision that they saw; it takes effect once.
constexpr Route action(std::string_view path, RouteAccess access, Handler handler,
                       std::string_view summary, RouteRules rules) {
  if (rules.takes == nullptr) rules.takes = &body::kNothing;
  if (rules.match == MatchRule::None) rules.match = MatchRule::Required;
  rules.key = kKeyed;
  rules.has_etag = true;
  return post(path, access, handler, summary, rules);
}

// An action on a job, which answers with the job.
constexpr Route job_action(std::string_view path, RouteAccess access, Handler handler,
                           std::string_view summary, RouteRules rules = {}) {
  rules.gives = {"Job"};
  rules.can_conflict = true;
  return action(path, access, handler, summary, rules);
}

constexpr auto kTable = std::to_array<Route>({
    get("/", kEveryone, handle::page,
        "Get the web page. Built in; needs no token and is not rate limited",
        {.gives = {"text/html:string"}, .is_cached = true, .is_static = true}),
    get("/page/{file}", kEveryone, handle::page,
        "Get a file of the web page. Its name changes with its content, so it can be cached "
        "forever",
        {.gives = {"text/css:string text/javascript:string text/plain:string image/svg+xml:string"},
         .is_cached = true,
         .is_static = true}),
    get("/healthz", kEveryone, handle::healthz,
        "Check that popcutd runs and that its database answers",
        {.gives = {"text/plain:string"}, .patience = Patience::Probe}),
    get("/readyz", kEveryone, handle::readyz,
        "Check whether popcutd accepts work; if not, the status is 503 with the same body",
        {.gives = {"Ready"},
         .gives_too = {"Ready", 503, "popcutd does not accept work, or is unavailable"},
         .patience = Patience::Probe}),
    get("/metrics", kViewer, handle::metrics, "Get metrics (OpenMetrics)",
        {.gives = {"application/openmetrics-text:string"}}),
    get("/v1/meta", kViewer, handle::meta, "Get versions, limits and your identity",
        {.gives = {"Meta"}}),
    get("/v1/openapi.json", kViewer, handle::openapi, "Get this file",
        {.gives = {"application/json:object"}, .is_cached = true, .is_constant = true}),
    get("/v1/examples", kViewer, handle::list_examples,
        "List the example designs, with their specs",
        {.gives = {"ExamplePage"}, .is_cached = true, .is_constant = true}),
    get("/v1/design-schema", kViewer, handle::design_schema, "Get the JSON Schema of a spec",
        {.gives = {"application/json:object"}, .is_cached = true, .is_constant = true}),
    get("/v1/machines", kViewer, handle::list_machines,
        "List the machines that sheets can be planned for, with their mats",
        {.gives = {"MachinePage"}}),
    get("/v1/usage", kViewer, handle::usage,
        "Get usage: seconds of cutting, mm of cuts, sheets; as CSV if you send Accept: text/csv",
        {.query = "from to by", .gives = {"UsageRowPage text/csv:string"}}),

    post("/v1/session/one-shot", kViewer, handle::create_one_shot,
         "Create a code that opens one session of the web page within 60 s; programs need no "
         "session",
         {.takes = &body::kNothing, .gives = {"OneShot", 201}, .stores_nothing = true}),
    post("/v1/session", kEveryone, handle::open_session, "Open a session",
         {.takes = &body::kSessionRequest, .gives = {"Session", 201}, .guess = Guess::Word}),
    post("/v1/session/pair", kEveryone, handle::ask_pairing,
         "Request access for a tablet: it shows the code, and a signed-in user enters it",
         {.takes = &body::kPairRequest,
          .gives = {"Pairing", 201},
          .stores_nothing = true,
          .guess = Guess::Another}),
    post("/v1/session/pair/allow", kViewer, handle::allow_pairing,
         "Allow the tablet that shows this code, with your role or a lower one",
         {.takes = &body::kPairAllow,
          .gives = {"PairAllowed"},
          .stores_nothing = true,
          .guess = Guess::Code}),
    post("/v1/session/pair/collect", kEveryone, handle::collect_pairing,
         "Collect the session of an allowed tablet; possible once",
         {.takes = &body::kPairCollect,
          .gives = {"Session", 201},
          .gives_too = {"PairWaiting", 202, "not allowed yet"},
          .guess = Guess::Secret}),
    remove("/v1/session", kViewer, handle::close_session, "End your session", {.can_miss = true}),
    get("/v1/tokens", kAdmin, handle::list_tokens, "List tokens, without their secrets",
        {.query = "limit cursor", .usual_page_items = kMostPageItems, .gives = {"TokenPage"}}),
    post("/v1/tokens", kAdmin, handle::create_token,
         "Create a token; only this response contains its secret",
         {.takes = &body::kTokenCreate, .gives = {"NewToken", 201}}),
    remove("/v1/tokens/{id}", kAdmin, handle::delete_token,
           "Delete a token; it stops working at once"),

    get("/v1/sessions", kViewer, handle::list_sessions, "List the open sessions of the web page",
        {.query = "limit cursor",
         .usual_page_items = kMostPageItems,
         .gives = {"SessionPage"},
         .details = "An admin sees all sessions; others see those of their own user or token."}),
    remove("/v1/sessions/{id}", kViewer, handle::end_session,
           "End a session and those that it opened; its event streams end at once",
           {.details =
                "An admin can end any session; others can end those of their own user or token."}),

    post("/v1/assets", kSubmitter, handle::add_asset,
         "Upload an asset for a spec: a mesh, grid or drawing",
         {.body = BodyRule::Asset,
          .query = "name",
          .gives = {"Asset", 201},
          .gives_too = {"Asset"},
          .details = "The body is the file. In a spec, set 'file' to the returned id. 200 means "
                     "that you have uploaded the asset before."}),
    get("/v1/assets", kViewer, handle::list_assets,
        "List assets, with the designs that refer to them",
        {.query = "limit cursor", .gives = {"AssetPage"}}),
    remove("/v1/assets/{id}", kSubmitter, handle::delete_asset, "Delete an asset of yours",
           {.can_conflict = true,
            .details = "409 if a design of yours refers to it; the response names the designs. If "
                       "others uploaded the asset too, they keep it."}),
    post("/v1/assets/{id}/search", kSubmitter, handle::search_cards,
         "Search for the best cards or books of a 3D model",
         {.takes = &body::kSearchRequest,
          .key = KeyRule::Allowed,
          .gives = {"Search", 202, "accepted; read the search until its state is found or failed"},
          .headers = "Location",
          .details = "Works like 'popcut auto': popcut tries styles, orientations, sizes and "
                     "levels of detail. The same request returns the same search."}),
    get("/v1/searches", kViewer, handle::list_searches, "List searches, without their cards",
        {.query = "limit cursor", .gives = {"SearchPage"}}),
    get("/v1/searches/{id}", kViewer, handle::get_search,
        "Get a search; it has cards when its state is found", {.gives = {"Search"}}),
    remove("/v1/searches/{id}", kSubmitter, handle::delete_search,
           "Delete a search, and stop it if it runs",
           {.details = "Designs made from its cards are kept. If others asked for the same search, "
                       "they keep it."}),
    get("/v1/searches/{id}/cards/{k}.png", kViewer, handle::card_picture,
        "Get a picture of a printed card of the search, from in front and from aside",
        {.gives = {"image/png", 200, "success; 800 by 400 pixels"},
         .is_cached = true,
         .can_conflict = true,
         .bucket = Bucket::Picture,
         .details = "A book, and a card of a search for plain ones, is bare beside the model."}),
    get("/v1/searches/{id}/cards/{k}/lattice", kViewer, handle::card_lattice,
        "Get the lattice blob of a card of the search, as the search designed it",
        {.gives = {"application/vnd.popcut.lattice", 200, "the lattice blob"},
         .is_cached = true,
         .can_conflict = true,
         .bucket = Bucket::Picture}),
    post("/v1/searches/{id}/cards/{k}/design", kSubmitter, handle::pick_card,
         "Create a design from a card of the search",
         {.takes = &body::kPickRequest,
          .gives = {"Design", 200, "this design exists already"},
          .gives_too = {"Design", 201},
          .headers = "Location",
          .can_conflict = true,
          .patience = Patience::Design,
          .details = "Same as uploading the spec of the card."}),
    post("/v1/designs", kSubmitter, handle::add_design,
         "Upload a design: a spec or FOLD (JSON), SVG or DXF",
         {.body = BodyRule::Design,
          .query = "name",
          .gives = {"Design", 201},
          .gives_too = {"Design"},
          .headers = "Location",
          .patience = Patience::Design,
          .details =
              "The body is the file. The id of a design contains the SHA-256 of the file, so "
              "the same bytes are the same design. 200 means that you have uploaded it before."}),
    get("/v1/designs", kViewer, handle::list_designs, "List designs, ordered by id",
        {.query = "limit cursor", .gives = {"DesignPage"}}),
    get("/v1/designs/{id}", kViewer, handle::get_design, "Get a design",
        {.gives = {"Design"}, .is_cached = true}),
    get("/v1/designs/{id}/content", kViewer, handle::design_content, "Download the uploaded file",
        {.gives = {"application/octet-stream"}, .is_cached = true}),
    get("/v1/designs/{id}/preview.svg", kViewer, handle::design_preview,
        "Get a preview picture, drawn from what popcutd read",
        {.gives = {"image/svg+xml"},
         .is_cached = true,
         .patience = Patience::Design,
         .bucket = Bucket::Picture}),
    remove("/v1/designs/{id}", kSubmitter, handle::delete_design,
           "Delete a design of yours that no unfinished job of yours uses",
           {.can_conflict = true,
            .details = "Your plans of the design go, too. If others uploaded or planned the same "
                       "design, they keep it."}),
    post("/v1/designs/{id}/plan", kSubmitter, handle::plan_design,
         "Plan sheets for a machine and a material",
         {.takes = &body::kPlanRequest,
          .key = KeyRule::Allowed,
          .gives = {"Plan", 202, "accepted; read the plan until its state is planned or failed"},
          .headers = "Location"}),
    get("/v1/plans/{id}", kViewer, handle::get_plan,
        "Get a plan; it has sheets when its state is planned", {.gives = {"Plan"}}),
    remove(
        "/v1/plans/{id}", kSubmitter, handle::delete_plan,
        "Delete a plan of yours, and stop its planning if necessary",
        {.can_conflict = true,
         .details = "409 if a job of yours uses it. If others asked for the same plan, they keep "
                    "it."}),
    get("/v1/plans/{id}/plan.json", kViewer, handle::plan_file, "Get plan.json",
        {.gives = {"application/json"}, .can_conflict = true}),
    get("/v1/plans/{id}/pattern.svg", kViewer, handle::plan_file, "Get pattern.svg",
        {.gives = {"image/svg+xml"}, .can_conflict = true}),
    get("/v1/plans/{id}/assembly.svg", kViewer, handle::plan_file, "Get assembly.svg",
        {.gives = {"image/svg+xml"}, .can_conflict = true}),
    get("/v1/plans/{id}/deploy.glb", kViewer, handle::plan_file, "Get deploy.glb",
        {.gives = {"model/gltf-binary"}, .can_conflict = true}),
    get("/v1/plans/{id}/report.json", kViewer, handle::plan_file,
        "Get report.json, the figures of the design; 'fit' is the distance of the opened structure "
        "from the target",
        {.gives = {"application/json"}, .can_conflict = true}),
    get("/v1/plans/{id}/sheets/{k}.svg", kViewer, handle::sheet_svg,
        "Get a drawing of what will be cut on a sheet, in mm",
        {.gives = {"image/svg+xml"}, .can_conflict = true}),
    get("/v1/plans/{id}/sheets/{k}/program", kViewer, handle::sheet_program,
        "Get the bytes that are sent to the cutter",
        {.gives = {"application/octet-stream"}, .can_conflict = true}),
    get("/v1/plans/{id}/sheets/{k}/strokes", kViewer, handle::sheet_strokes,
        "Get the strokes of a sheet to draw them: stroke i is path i of the program",
        {.gives = {"Strokes"}, .is_cached = true, .can_conflict = true}),
    get("/v1/plans/{id}/sheets/{k}/artwork.pdf", kViewer, handle::sheet_artwork,
        "Get the artwork to print on a sheet before you cut it, with the registration marks that "
        "its program detects",
        {.query = "mode dpi clay back model",
         .gives = {"application/pdf", 200, "the page; print it at actual size"},
         .headers = "Content-Disposition",
         .is_cached = true,
         .can_conflict = true,
         .patience = Patience::Design,
         .ends_with_client = true,
         .details = "Only for plans of specs. The artwork is placed like the program. The colours "
                    "come from the mesh of the spec, or from 'model'."}),

    // What a page shows while somebody designs.
    post(
        "/v1/preview", kSubmitter, handle::preview_spec, "Preview a spec while you design it",
        {.takes = &body::kPreviewRequest,
         .parameter = "Preview-Key",
         .gives = {"application/vnd.popcut.lattice", 200, "the lattice blob"},
         .can_conflict = true,
         .stores_nothing = true,
         .bucket = Bucket::Preview,
         .ends_with_client = true,
         .details =
             "Designs the spec in a worker process and returns its lattice blob (docs/geometry.md, "
             "section 9). Nothing is stored. draft: fast; uses the lattice levels, or slices if "
             "levels is impossible, whatever the spec says. exact: as it would be cut. A newer "
             "request with the same Preview-Key cancels the older one: 409 superseded. Close the "
             "connection to cancel the request. Error pointers are relative to the spec."}),
    post("/v1/place", kSubmitter, handle::place_spec, "Move the shape of a spec into place",
         {.takes = &body::kPlaceRequest,
          .gives = {"PlacedSpec"},
          .stores_nothing = true,
          .patience = Patience::Design,
          .bucket = Bucket::Preview,
          .ends_with_client = true,
          .details =
              "Returns the spec with its 3D model or height table turned and moved so that the "
              "pattern reaches as much of it as possible, like 'popcut design --place'. Takes at "
              "most two minutes; close the connection to cancel it. Nothing is stored."}),
    post("/v1/designs/{id}/make", kSubmitter, handle::make_design,
         "Get the sheets of a design to make it without a cutter that popcut drives",
         {.takes = &body::kMakeRequest,
          .gives = {"MadeSheets"},
          .stores_nothing = true,
          .patience = Patience::Design,
          .bucket = Bucket::Preview,
          .ends_with_client = true,
          .details =
              "hand: pages to print (PDF). cricut: SVG for Design Space. silhouette: DXF whose "
              "folds "
              "are dashes, and SVG, for Silhouette Studio. laser: SVG with a colour for each "
              "operation, for LightBurn. The files are those of 'popcut plan --formats'. drawing: "
              "gives a DrawingQuestion instead. 422 with 'asks' if the drawing does not say what "
              "its "
              "lines are for. Takes at most two minutes; nothing is stored."}),
    get("/v1/designs/{id}/deployed.svg", kViewer, handle::design_picture,
        "Get a small picture of the opened card; flat, if popcut does not know how it opens",
        {.gives = {"image/svg+xml"},
         .is_cached = true,
         .patience = Patience::Design,
         .bucket = Bucket::Picture}),
    get("/v1/designs/{id}/pattern.svg", kViewer, handle::design_picture,
        "Get a picture of the flat pattern",
        {.gives = {"image/svg+xml"},
         .is_cached = true,
         .patience = Patience::Design,
         .bucket = Bucket::Picture}),
    get("/v1/designs/{id}/files/{name}", kViewer, handle::design_file,
        "Get a file of a spec, as popcut design writes it",
        {.query = "part",
         .gives = {"application/octet-stream image/svg+xml application/dxf text/csv "
                   "model/gltf-binary model/stl application/json",
                   200, "the file, as an attachment"},
         .headers = "Content-Disposition",
         .is_cached = true,
         .patience = Patience::Design,
         .ends_with_client = true}),
    get("/v1/designs/{id}/lattice", kViewer, handle::design_lattice,
        "Get the lattice blob of a design, to draw it in three dimensions",
        {.query = "layers colors units",
         .gives = {"application/vnd.popcut.lattice", 200, "the lattice blob"},
         .is_cached = true,
         .patience = Patience::Design,
         .bucket = Bucket::Picture,
         .ends_with_client = true,
         .details = "A spec is shown as it would be cut. Any other pattern opens as 'popcut "
                    "deploy' opens it, or lies flat."}),

    get("/v1/materials", kViewer, handle::list_materials, "List materials",
        {.query = "limit cursor", .usual_page_items = kMostPageItems, .gives = {"MaterialPage"}}),
    get("/v1/materials/{id}", kViewer, handle::get_material, "Get a material",
        {.gives = {"Material"}, .is_cached = true}),
    route(Method::Put, "/v1/materials/{id}", kAdmin, handle::put_material,
          "Change or add a material",
          {.takes = &body::kMaterialRow,
           .match = MatchRule::OrNew,
           .gives = {"Material"},
           .gives_too = {"Material", 201},
           .has_etag = true}),
    remove("/v1/materials/{id}", kAdmin, handle::delete_material,
           "Delete a material that was added",
           {.match = MatchRule::Required, .can_conflict = true}),

    get("/v1/devices", kViewer, handle::list_devices, "List cutters",
        {.query = "limit cursor", .usual_page_items = kMostPageItems, .gives = {"DevicePage"}}),
    get("/v1/devices/{id}", kViewer, handle::get_device, "Get a cutter",
        {.gives = {"Device"}, .is_cached = true}),
    action("/v1/devices/{id}/actions/enable", kAdmin, handle::act_on_device, "Enable a cutter",
           {.gives = {"Device"}}),
    action("/v1/devices/{id}/actions/disable", kAdmin, handle::act_on_device,
           "Disable a cutter: popcutd starts no sheet on it and resumes none",
           {.gives = {"Device"}}),
    action("/v1/devices/{id}/actions/reset", kOperator, handle::act_on_device,
           "Reset a cutter after a fault: clear the connection and reopen it; cuts nothing",
           {.gives = {"Device"}, .can_conflict = true}),
    action(
        "/v1/devices/{id}/actions/test-cut", kOperator, handle::act_on_device,
        "Create a job that cuts a small test shape; a person arms and starts it like any other job",
        {.takes = &body::kTestCut,
         .gives = {"Device"},
         .headers = "JobLocation",
         .can_conflict = true}),

    post("/v1/jobs", kSubmitter, handle::create_job, "Queue a job",
         {.takes = &body::kJobCreate,
          .key = kKeyed,
          .gives = {"Job", 201},
          .headers = "Location",
          .has_etag = true}),
    get("/v1/jobs", kViewer, handle::list_jobs,
        "List jobs, ordered by id: the oldest first, or the newest",
        {.query = "limit cursor state order owner device site since", .gives = {"JobPage"}}),
    get("/v1/jobs/{id}", kViewer, handle::get_job, "Get a job",
        {.gives = {"Job"}, .is_cached = true, .is_urgent = true}),
    route(Method::Patch, "/v1/jobs/{id}", kSubmitter, handle::patch_job,
          "Change a job that is queued, planning or ready: your own, or any as an operator",
          {.takes = &body::kJobPatch,
           .key = KeyRule::Allowed,
           .match = MatchRule::Required,
           .gives = {"Job"},
           .has_etag = true,
           .can_conflict = true}),
    remove("/v1/jobs/{id}", kSubmitter, handle::delete_job,
           "Delete a finished job; its history is kept",
           {.match = MatchRule::Allowed, .can_conflict = true}),
    get("/v1/jobs/{id}/sheets", kViewer, handle::job_sheets, "List the sheets of a job",
        {.query = "limit cursor", .usual_page_items = kMostPageItems, .gives = {"SheetPage"}}),
    get("/v1/jobs/{id}/sheets/{k}", kViewer, handle::job_sheet, "Get a sheet",
        {.gives = {"Sheet"}}),
    get("/v1/jobs/{id}/sheets/{k}/ledger", kViewer, handle::sheet_ledger,
        "Get which paths of a sheet are cut, in doubt, or not sent", {.gives = {"Ledger"}}),
    get("/v1/jobs/{id}/events", kViewer, handle::job_events, "List the events of a job",
        {.query = "after limit", .gives = {"EventList"}}),
    job_action("/v1/jobs/{id}/actions/arm", kOperator, handle::act<JobAction::Arm>,
               "Arm a sheet: confirm that the blank is loaded; valid for ten minutes",
               {.takes = &body::kArm}),
    job_action("/v1/jobs/{id}/actions/disarm", kOperator, handle::act<JobAction::Disarm>,
               "Disarm a sheet", {.match = MatchRule::OrAny}),
    job_action("/v1/jobs/{id}/actions/start", kOperator, handle::act<JobAction::Start>,
               "Cut the armed sheet", {.takes = &body::kStart}),
    job_action("/v1/jobs/{id}/actions/pause", kOperator, handle::act<JobAction::Pause>,
               "Pause at the end of the current stroke, with the tool up",
               {.match = MatchRule::OrAny, .is_urgent = true}),
    job_action("/v1/jobs/{id}/actions/resume", kOperator, handle::act<JobAction::Resume>,
               "Continue after a pause"),
    job_action(
        "/v1/jobs/{id}/actions/cancel", kSubmitter, handle::act<JobAction::Cancel>,
        "Cancel a job: your own, or any as an operator; a running cut stops at the end of the "
        "stroke",
        {.takes = &body::kCancel, .match = MatchRule::OrAny, .is_urgent = true}),
    job_action("/v1/jobs/{id}/actions/confirm-result", kOperator,
               handle::act<JobAction::ConfirmResult>, "Record whether a sheet came out well",
               {.takes = &body::kConfirmResult}),
    job_action("/v1/jobs/{id}/actions/retry-sheet", kOperator, handle::act<JobAction::RetrySheet>,
               "Cut a sheet again on a new blank; then arm and start it",
               {.takes = &body::kSheetChoice}),
    job_action("/v1/jobs/{id}/actions/skip-sheet", kOperator, handle::act<JobAction::SkipSheet>,
               "Skip a sheet and go on with the next", {.takes = &body::kSheetChoice}),
    job_action(
        "/v1/jobs/{id}/actions/resume-from", kOperator, handle::act<JobAction::ResumeFrom>,
        "Continue an interrupted sheet on the same blank from a given path; then arm and start it",
        {.takes = &body::kResumeFrom}),

    get("/v1/queue", kViewer, handle::get_queue,
        "List unfinished jobs in queue order; a page can have fewer items than limit even if "
        "another page follows",
        {.query = "limit cursor device", .usual_page_items = kMostPageItems, .gives = {"JobPage"}}),
    job_action("/v1/queue/actions/hold", kOperator, handle::hold_job,
               "Hold a job back: nobody can arm it",
               {.takes = &body::kHold, .match = MatchRule::Allowed, .can_miss = true}),
    job_action("/v1/queue/actions/release", kOperator, handle::release_job, "Release a held job",
               {.takes = &body::kHold, .match = MatchRule::Allowed, .can_miss = true}),
    job_action(
        "/v1/queue/actions/move", kOperator, handle::move_job,
        "Move a job before another job of the same priority, or after all others of its priority",
        {.takes = &body::kMove, .match = MatchRule::Allowed, .can_miss = true}),

    get("/v1/events", kViewer, handle::list_events,
        "Stream events (text/event-stream), or list them (application/json)",
        {.query = "after limit",
         .parameter = "LastEventId",
         .gives = {"text/event-stream:string EventList"},
         .is_stream = true,
         .details = "To get a stream, send Accept: text/event-stream. Without Last-Event-ID, or if "
                    "that event is too old, the stream starts with 'reset' and a 'snapshot' of "
                    "devices and jobs. Each 'id' is the 'seq' of an event. 'progress' has no 'id', "
                    "its 'seq' is 0, and it is not stored; it reports the progress of a sheet that "
                    "is being cut, or of the plan of a job in 'planning'. If you read too slowly, "
                    "popcutd sends 'overflow' and ends the stream; reconnect with the last id."}),

    // No key: a database cannot be copied inside the transaction of a key, and both actions can be
    // repeated.
    post("/v1/db/actions/backup", kAdmin, handle::backup, "Back up the database",
         {.takes = &body::kNothing, .gives = {"Backup"}, .can_conflict = true}),
    post("/v1/db/actions/check", kAdmin, handle::check_database, "Check the database",
         {.takes = &body::kNothing,
          .gives = {"Check"},
          .can_conflict = true,
          .stores_nothing = true}),
});

constexpr bool is_action(const Route& route) {
  return route.path.find("/actions/") != std::string_view::npos;
}

// The compiler refuses a route that moves a knife without a key, a revision or a role.
constexpr bool is_sound(const Route& route) {
  const bool changes = route.method != Method::Get;
  if (route.path.empty() || route.path.front() != '/') return false;
  if (route.path.size() > 1 && route.path.back() == '/') return false;
  if (route.is_static && (changes || !route.access.is_open())) return false;
  // Without authentication one can only start a session, and only with limited attempts.
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
