// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/http/api/routes.hpp"

// The handlers, one for each route of routes.cpp. They speak with the service and with nothing
// else, and so are tested without sockets.
namespace popcut::daemon::http::handle {

// handlers_system.cpp
void healthz(const Request&, Service&, const Shop&, Reply);
void readyz(const Request&, Service&, const Shop&, Reply);
void metrics(const Request&, Service&, const Shop&, Reply);
void meta(const Request&, Service&, const Shop&, Reply);
void openapi(const Request&, Service&, const Shop&, Reply);
void usage(const Request&, Service&, const Shop&, Reply);
void backup(const Request&, Service&, const Shop&, Reply);
void check_database(const Request&, Service&, const Shop&, Reply);

// handlers_access.cpp
void create_one_shot(const Request&, Service&, const Shop&, Reply);
void open_session(const Request&, Service&, const Shop&, Reply);
void close_session(const Request&, Service&, const Shop&, Reply);
void list_tokens(const Request&, Service&, const Shop&, Reply);
void create_token(const Request&, Service&, const Shop&, Reply);
void delete_token(const Request&, Service&, const Shop&, Reply);

// handlers_designs.cpp
void add_asset(const Request&, Service&, const Shop&, Reply);
void add_design(const Request&, Service&, const Shop&, Reply);
void list_designs(const Request&, Service&, const Shop&, Reply);
void get_design(const Request&, Service&, const Shop&, Reply);
void design_content(const Request&, Service&, const Shop&, Reply);
void design_preview(const Request&, Service&, const Shop&, Reply);
void delete_design(const Request&, Service&, const Shop&, Reply);
void plan_design(const Request&, Service&, const Shop&, Reply);
void get_plan(const Request&, Service&, const Shop&, Reply);
void delete_plan(const Request&, Service&, const Shop&, Reply);
/// The last part of the path is the file's name.
void plan_file(const Request&, Service&, const Shop&, Reply);
void sheet_svg(const Request&, Service&, const Shop&, Reply);
void sheet_program(const Request&, Service&, const Shop&, Reply);

// handlers_jobs.cpp
void create_job(const Request&, Service&, const Shop&, Reply);
void list_jobs(const Request&, Service&, const Shop&, Reply);
void get_job(const Request&, Service&, const Shop&, Reply);
void patch_job(const Request&, Service&, const Shop&, Reply);
void delete_job(const Request&, Service&, const Shop&, Reply);
void job_sheets(const Request&, Service&, const Shop&, Reply);
void job_sheet(const Request&, Service&, const Shop&, Reply);
void sheet_ledger(const Request&, Service&, const Shop&, Reply);
void get_queue(const Request&, Service&, const Shop&, Reply);
void hold_job(const Request&, Service&, const Shop&, Reply);
void release_job(const Request&, Service&, const Shop&, Reply);
void move_job(const Request&, Service&, const Shop&, Reply);

// handlers_actions.cpp
void act_on_job(const Request&, Service&, JobAction, const Shop&, const Reply&);
template <JobAction action>
void act(const Request& request, Service& service, const Shop& shop, Reply reply) {
  act_on_job(request, service, action, shop, reply);
}

// handlers_devices.cpp
void list_devices(const Request&, Service&, const Shop&, Reply);
void get_device(const Request&, Service&, const Shop&, Reply);
/// The last part of the path is the action.
void act_on_device(const Request&, Service&, const Shop&, Reply);
void list_materials(const Request&, Service&, const Shop&, Reply);
void get_material(const Request&, Service&, const Shop&, Reply);
void put_material(const Request&, Service&, const Shop&, Reply);
void delete_material(const Request&, Service&, const Shop&, Reply);

// handlers_events.cpp
void list_events(const Request&, Service&, const Shop&, Reply);
void job_events(const Request&, Service&, const Shop&, Reply);

}  // namespace popcut::daemon::http::handle
