// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "core/plan/machine_choice.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/examples/examples.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/openapi.hpp"
#include "daemon/http/api/page_response.hpp"
#include "daemon/http/api/render.hpp"
#include "daemon/model/wall_clock.hpp"

namespace popcut::daemon::http {

const Body body::kNothing{.schema = "Nothing", .is_optional = true};

namespace handle {

void page(const Request& request, Service&, const HandlerContext&, Reply reply) {
  const std::string name = request.params.empty() ? std::string() : request.params[0];
  for (const PageFile& file : page_files())
    if (file.name == name)
      return reply(page_response(file, request.header("accept-encoding").value_or("")));
  reply(problem_response(
      Problem{ProblemKind::NotFound,
              "the page of this popcutd has no such file; if popcutd was updated, reload the page"},
      request));
}

void healthz(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const ServiceHealth health = service.operations.health();
  if (!health.database && !health.waits)
    return reply(problem_response(
        Problem{ProblemKind::Unavailable, "the database is not answering"}, request));
  Response response;
  response.content_type = "text/plain; charset=utf-8";
  response.body = "ok\n";
  reply(std::move(response));
}

void readyz(const Request&, Service& service, const HandlerContext&, Reply reply) {
  const ServiceHealth health = service.operations.health();
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const DeviceRecord& device : service.devices.list())
    devices.push_back({{"id", device.id}, {"state", device.state}});
  const bool is_ready = health.database && health.accepts_work;
  reply(json_response(is_ready ? 200 : 503, {{"ready", is_ready},
                                             {"db", health.database ? "ok" : "failed"},
                                             {"disk_free_mb", health.disk_free_mb},
                                             {"accepts_work", health.accepts_work},
                                             {"remark", health.remark},
                                             {"devices", std::move(devices)}}));
}

void metrics(const Request&, Service& service, const HandlerContext& context, Reply reply) {
  Response response;
  response.content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8";
  response.make_body = [lines = service.operations.metrics(), own = context.metrics] {
    return lines + (own ? own() : std::string()) + "# EOF\n";
  };
  response.is_brief = true;
  reply(std::move(response));
}

namespace {

/// What confines workers; two empty lists while it is not known.
nlohmann::ordered_json confinement(const HandlerContext& context) {
  auto by = nlohmann::ordered_json::array(), not_by = nlohmann::ordered_json::array();
  if (context.worker_walls)
    for (const WorkerWall& wall : context.worker_walls()) {
      if (wall.holds())
        by.push_back(wall.name);
      else
        not_by.push_back({{"name", wall.name}, {"why", wall.why_not}});
    }
  return {{"confined_by", std::move(by)}, {"not_confined_by", std::move(not_by)}};
}

}  // namespace

void meta(const Request& request, Service& service, const HandlerContext& context, Reply reply) {
  const HttpLimits& limits = context.limits;
  const std::optional<SessionRecord> session =
      service.access.session_of(request.principal.credential);
  reply(json_response(
      200, {{"api", "v1"},
            {"build", context.build},
            {"page", page_stamp().substr(0, 12)},
            {"page_url", context.page_url.empty() ? nlohmann::ordered_json(nullptr)
                                                  : nlohmann::ordered_json(context.page_url)},
            {"schema_sha256", context.openapi_sha256},
            {"now", rfc3339(wall_clock_ms())},
            {"can", {"design", "plan", "search", "print", "queue", "devices", "users"}},
            {"principal",
             {{"name", request.principal.name},
              {"title", service.access.title_of(request.principal.name)},
              {"role", name_of(request.principal.role)}}},
            {"session", session.has_value()},
            {"tablet", session && !session->name.empty() ? nlohmann::ordered_json(session->name)
                                                         : nlohmann::ordered_json(nullptr)},
            {"last_event", service.operations.last_event()},
            {"workers", confinement(context)},
            {"limits",
             {{"json_bytes", limits.json_bytes},
              {"json_depth", limits.json_depth},
              {"design_bytes", limits.design_bytes},
              {"asset_bytes", limits.asset_bytes},
              {"rate_per_s", limits.rate_per_s},
              {"rate_burst", limits.rate_burst},
              {"connections", limits.connections},
              {"streams", limits.streams}}}}));
}

void openapi(const Request&, Service&, const HandlerContext& context, Reply reply) {
  Response response;
  response.body = std::string(openapi_json());
  response.headers.push_back({"ETag", fmt::format("\"{}\"", context.openapi_sha256)});
  reply(std::move(response));
}

namespace {

// A text that changes only with the program.
Response fixed_response(const std::string& text) {
  Response response;
  Sha256 hash;
  hash.add(text);
  response.body = text;
  response.headers.push_back({"ETag", fmt::format("\"{}\"", hash.hex())});
  return response;
}

}  // namespace

void list_examples(const Request&, Service&, const HandlerContext&, Reply reply) {
  static const std::string kText = [] {
    nlohmann::ordered_json items = nlohmann::ordered_json::array();
    for (const Example& example : examples()) {
      const auto spec = nlohmann::ordered_json::parse(example.json);
      items.push_back({{"name", example.name},
                       {"title", spec.value("name", std::string(example.name))},
                       {"spec", spec}});
    }
    return dump({{"items", std::move(items)}, {"next_cursor", nullptr}});
  }();
  reply(fixed_response(kText));
}

void design_schema(const Request&, Service&, const HandlerContext&, Reply reply) {
  static const std::string kText = design_spec_schema();
  reply(fixed_response(kText));
}

void list_machines(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<std::vector<Machine>> all = service.plans.machines();
  if (!all) return reply(problem_response(all.error(), request));
  reply(page_response(Page<Machine>{*all, {}}, 'x',
                      [](const Machine& machine) { return dump(machine_choice(machine)); }));
}

void usage(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  QueryReader query(request);
  const auto from = query.time("from"), to = query.time("to");
  const std::string by = query.word("by");
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  const bool is_csv = request.header("accept").value_or("").find("text/csv") != std::string::npos;
  service.operations.usage(
      from, to, by,
      [reply, by, is_csv, target = request.target,
       id = request.id](Answer<std::vector<UsageRow>> rows) {
        if (!rows) return reply(problem_response(rows.error(), target, id));
        if (!is_csv)
          return reply(page_response(Page<UsageRow>{std::move(*rows), {}}, 'u',
                                     [](const UsageRow& row) { return dump(to_json(row)); }));
        Response response;
        response.content_type = "text/csv; charset=utf-8";
        response.headers.push_back({"Content-Disposition", "attachment; filename=\"usage.csv\""});
        response.make_body = [rows = std::move(*rows), by] { return usage_csv(rows, by); };
        reply(std::move(response));
      });
}

void backup(const Request& request, Service& service, const HandlerContext& context, Reply reply) {
  if (const auto body = read_nothing(request, context); !body)
    return reply(problem_response(body.error(), request));
  service.operations.backup(request.principal, [reply, target = request.target,
                                                id = request.id](const Answer<std::string>& path) {
    reply(path ? json_response(200, {{"path", *path}})
               : problem_response(path.error(), target, id));
  });
}

void check_database(const Request& request, Service& service, const HandlerContext& context,
                    Reply reply) {
  if (const auto body = read_nothing(request, context); !body)
    return reply(problem_response(body.error(), request));
  service.operations.check_integrity(
      request.principal,
      [reply, target = request.target, id = request.id](const Answer<std::string>& found) {
        reply(found ? json_response(200, {{"result", *found}})
                    : problem_response(found.error(), target, id));
      });
}

}  // namespace handle
}  // namespace popcut::daemon::http
