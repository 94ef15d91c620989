// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string_view>

#include "daemon/http/api/input.hpp"
#include "daemon/http/api/routes.hpp"

// The bodies that the routes take: their fields, limits and examples. Each is defined beside the
// handler that reads it.
namespace popcut::daemon::http::body {

// handlers_system.cpp
extern const Body kNothing;
// handlers_access.cpp
extern const Body kSessionRequest, kPairRequest, kPairAllow, kPairCollect, kTokenCreate;
// handlers_designs.cpp
extern const Body kPlanRequest;
// handlers_searches.cpp
extern const Body kSearchRequest, kPickRequest;
// handlers_preview.cpp
extern const Body kPreviewRequest, kPlaceRequest, kMakeRequest;
// handlers_jobs.cpp
extern const Body kJobCreate, kJobPatch, kHold, kMove;
// handlers_actions.cpp
extern const Body kArm, kStart, kCancel, kConfirmResult, kSheetChoice, kResumeFrom;
// handlers_devices.cpp
extern const Body kTestCut, kMaterialRow;

}  // namespace popcut::daemon::http::body

// The handlers, one for each route of routes.cpp. They speak with the service and with nothing
// else, and so are tested without sockets.
namespace popcut::daemon::http::handle {

// handlers_system.cpp
HandlerFunction page;  ///< / and /page/{file}: a part of the program, without the service
HandlerFunction healthz, readyz, metrics, meta, openapi, list_examples, design_schema;
HandlerFunction list_machines, usage, backup, check_database;

// handlers_access.cpp
HandlerFunction create_one_shot, open_session, close_session, list_sessions, end_session;
HandlerFunction ask_pairing, allow_pairing, collect_pairing;
HandlerFunction list_tokens, create_token, delete_token;

// handlers_designs.cpp
HandlerFunction add_asset, list_assets, delete_asset;
HandlerFunction add_design, list_designs, get_design, delete_design;
HandlerFunction design_content, design_preview;
HandlerFunction design_picture;  ///< the last part of the path is the picture's name
HandlerFunction design_file;     ///< one of `design_file_names`
[[nodiscard]] std::span<const std::string_view> design_file_names();
HandlerFunction plan_design, get_plan, delete_plan;
HandlerFunction plan_file;  ///< the last part of the path is the file's name
HandlerFunction sheet_svg, sheet_program;

// handlers_sheets.cpp
HandlerFunction sheet_strokes, sheet_artwork;

// handlers_searches.cpp
HandlerFunction search_cards, get_search, list_searches, delete_search, card_picture, card_lattice,
    pick_card;

// handlers_preview.cpp
HandlerFunction preview_spec, place_spec, make_design, design_lattice;

// handlers_jobs.cpp
HandlerFunction create_job, list_jobs, get_job, patch_job, delete_job;
HandlerFunction job_sheets, job_sheet, sheet_ledger;
HandlerFunction get_queue, hold_job, release_job, move_job;

// handlers_actions.cpp
void act_on_job(const Request&, Service&, JobAction, const HandlerContext&, const Reply&);
template <JobAction action>
void act(const Request& request, Service& service, const HandlerContext& context, Reply reply) {
  act_on_job(request, service, action, context, reply);
}

// handlers_devices.cpp
HandlerFunction list_devices, get_device;
HandlerFunction act_on_device;  ///< the last part of the path is the action
HandlerFunction list_materials, get_material, put_material, delete_material;

// handlers_events.cpp
HandlerFunction list_events, job_events;

}  // namespace popcut::daemon::http::handle
