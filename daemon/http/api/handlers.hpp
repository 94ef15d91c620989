// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/http/api/routes.hpp"

// The handlers, one for each route of routes.cpp. They speak with the service and with nothing
// else, and so are tested without sockets.
namespace popcut::daemon::http::handle {

// handlers_system.cpp
/// / and /page/{file}: a part of the program, without the service.
void page(const Request&, Service&, const HandlerContext&, Reply);
void healthz(const Request&, Service&, const HandlerContext&, Reply);
void readyz(const Request&, Service&, const HandlerContext&, Reply);
void metrics(const Request&, Service&, const HandlerContext&, Reply);
void meta(const Request&, Service&, const HandlerContext&, Reply);
void openapi(const Request&, Service&, const HandlerContext&, Reply);
void list_examples(const Request&, Service&, const HandlerContext&, Reply);
void design_schema(const Request&, Service&, const HandlerContext&, Reply);
void list_machines(const Request&, Service&, const HandlerContext&, Reply);
void usage(const Request&, Service&, const HandlerContext&, Reply);
void backup(const Request&, Service&, const HandlerContext&, Reply);
void check_database(const Request&, Service&, const HandlerContext&, Reply);

// handlers_access.cpp
void create_one_shot(const Request&, Service&, const HandlerContext&, Reply);
void open_session(const Request&, Service&, const HandlerContext&, Reply);
void ask_pairing(const Request&, Service&, const HandlerContext&, Reply);
void allow_pairing(const Request&, Service&, const HandlerContext&, Reply);
void collect_pairing(const Request&, Service&, const HandlerContext&, Reply);
void close_session(const Request&, Service&, const HandlerContext&, Reply);
void list_sessions(const Request&, Service&, const HandlerContext&, Reply);
void end_session(const Request&, Service&, const HandlerContext&, Reply);
void list_tokens(const Request&, Service&, const HandlerContext&, Reply);
void create_token(const Request&, Service&, const HandlerContext&, Reply);
void delete_token(const Request&, Service&, const HandlerContext&, Reply);

// handlers_designs.cpp
void add_asset(const Request&, Service&, const HandlerContext&, Reply);
void list_assets(const Request&, Service&, const HandlerContext&, Reply);
void delete_asset(const Request&, Service&, const HandlerContext&, Reply);
void add_design(const Request&, Service&, const HandlerContext&, Reply);
void list_designs(const Request&, Service&, const HandlerContext&, Reply);
void get_design(const Request&, Service&, const HandlerContext&, Reply);
void design_content(const Request&, Service&, const HandlerContext&, Reply);
void design_preview(const Request&, Service&, const HandlerContext&, Reply);
void delete_design(const Request&, Service&, const HandlerContext&, Reply);
void plan_design(const Request&, Service&, const HandlerContext&, Reply);
void get_plan(const Request&, Service&, const HandlerContext&, Reply);
void delete_plan(const Request&, Service&, const HandlerContext&, Reply);
/// The last part of the path is the file's name.
void plan_file(const Request&, Service&, const HandlerContext&, Reply);
void sheet_svg(const Request&, Service&, const HandlerContext&, Reply);
void sheet_program(const Request&, Service&, const HandlerContext&, Reply);

// handlers_searches.cpp
void search_cards(const Request&, Service&, const HandlerContext&, Reply);
void get_search(const Request&, Service&, const HandlerContext&, Reply);
void delete_search(const Request&, Service&, const HandlerContext&, Reply);
void card_picture(const Request&, Service&, const HandlerContext&, Reply);
void pick_card(const Request&, Service&, const HandlerContext&, Reply);

// handlers_strokes.cpp
void sheet_strokes(const Request&, Service&, const HandlerContext&, Reply);
void sheet_artwork(const Request&, Service&, const HandlerContext&, Reply);

// handlers_preview.cpp
void preview_spec(const Request&, Service&, const HandlerContext&, Reply);
void place_spec(const Request&, Service&, const HandlerContext&, Reply);
/// The last part of the path is the picture's name.
void design_picture(const Request&, Service&, const HandlerContext&, Reply);
void design_file(const Request&, Service&, const HandlerContext&, Reply);
void design_lattice(const Request&, Service&, const HandlerContext&, Reply);

// handlers_jobs.cpp
void create_job(const Request&, Service&, const HandlerContext&, Reply);
void list_jobs(const Request&, Service&, const HandlerContext&, Reply);
void get_job(const Request&, Service&, const HandlerContext&, Reply);
void patch_job(const Request&, Service&, const HandlerContext&, Reply);
void delete_job(const Request&, Service&, const HandlerContext&, Reply);
void job_sheets(const Request&, Service&, const HandlerContext&, Reply);
void job_sheet(const Request&, Service&, const HandlerContext&, Reply);
void sheet_ledger(const Request&, Service&, const HandlerContext&, Reply);
void get_queue(const Request&, Service&, const HandlerContext&, Reply);
void hold_job(const Request&, Service&, const HandlerContext&, Reply);
void release_job(const Request&, Service&, const HandlerContext&, Reply);
void move_job(const Request&, Service&, const HandlerContext&, Reply);

// handlers_actions.cpp
void act_on_job(const Request&, Service&, JobAction, const HandlerContext&, const Reply&);
template <JobAction action>
void act(const Request& request, Service& service, const HandlerContext& context, Reply reply) {
  act_on_job(request, service, action, context, reply);
}

// handlers_devices.cpp
void list_devices(const Request&, Service&, const HandlerContext&, Reply);
void get_device(const Request&, Service&, const HandlerContext&, Reply);
/// The last part of the path is the action.
void act_on_device(const Request&, Service&, const HandlerContext&, Reply);
void list_materials(const Request&, Service&, const HandlerContext&, Reply);
void get_material(const Request&, Service&, const HandlerContext&, Reply);
void put_material(const Request&, Service&, const HandlerContext&, Reply);
void delete_material(const Request&, Service&, const HandlerContext&, Reply);

// handlers_events.cpp
void list_events(const Request&, Service&, const HandlerContext&, Reply);
void job_events(const Request&, Service&, const HandlerContext&, Reply);

}  // namespace popcut::daemon::http::handle
