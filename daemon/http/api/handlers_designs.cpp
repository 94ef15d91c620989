// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {

const Body body::kPlanRequest{.schema = "PlanRequest",
                              .fields = {text("material", kIdLimit), text("device", kIdLimit),
                                         text("machine", kIdLimit), plan_options("options")},
                              .example = R"({"material": "paper-220"})",
                              .is_optional = true};

namespace handle {
namespace {

constexpr std::array<std::string_view, 12> kExports{
    "pattern.fold", "pattern.svg",  "cut.svg",    "pattern.dxf", "segments.csv",    "deploy.glb",
    "deployed.stl", "deployed.svg", "poster.svg", "report.json", "fold-guide.json", "spec.json"};
constexpr std::string_view kKept = "private, max-age=86400";
constexpr std::string_view kDrawingPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; sandbox; frame-ancestors 'none'";

// Uploaded content, or a drawing of it: never executed, never shown as a page.
Response drawing(std::string content_type) {
  Response response;
  response.content_type = std::move(content_type);
  response.headers.push_back({"Content-Security-Policy", std::string(kDrawingPolicy)});
  return response;
}

std::string type_of(std::string_view file) {
  if (file.ends_with(".svg")) return "image/svg+xml";
  if (file.ends_with(".json")) return "application/json";
  if (file.ends_with(".glb")) return "model/gltf-binary";
  if (file.ends_with(".stl")) return "model/stl";
  if (file.ends_with(".dxf")) return "application/dxf";
  if (file.ends_with(".csv")) return "text/csv; charset=utf-8";
  return "application/octet-stream";
}

void answer_file(const Request& request, const Reply& reply, const Answer<std::string>& path,
                 const std::string& name) {
  if (!path) return reply(problem_response(path.error(), request));
  Response response = drawing(type_of(name));
  response.headers.push_back(
      {"Content-Disposition", fmt::format("attachment; filename=\"{}\"", name)});
  response.file = *path;
  reply(std::move(response));
}

std::string last_part(const Request& request) {
  return std::string(request.path().substr(request.path().rfind('/') + 1));
}

// A picture of a design. It never changes, because the bytes of a design do not.
void answer_picture(const Request& request, Service& service, const HandlerContext& context,
                    const Reply& reply, const std::function<void(Designs::OnView)>& make) {
  const std::string etag =
      fmt::format("\"{}-{}-{}\"", request.params[0], last_part(request), context.build);
  if (const Answer<Design> design = service.designs.find(request.principal, request.params[0]);
      !design)
    return reply(problem_response(design.error(), request));
  if (has_seen(request, etag)) return reply(unchanged(etag, kKept));
  make([reply, etag, target = request.target, id = request.id](Answer<std::string> svg) {
    if (!svg) return reply(problem_response(svg.error(), target, id));
    Response response = drawing("image/svg+xml");
    response.body = std::move(*svg);
    response.headers.push_back({"ETag", etag});
    response.headers.push_back({"Cache-Control", std::string(kKept)});
    reply(std::move(response));
  });
}

// "{k}" of a path as the two digits of a file's name.
std::optional<std::string> sheet_name(const Request& request, const Reply& reply) {
  const std::optional<int> number = path_number(request.params[1]);
  if (number) return fmt::format("sheet-{:02}", *number);
  reply(problem_response(Problem{ProblemKind::NotFound, "sheet numbers start at 1"}, request));
  return std::nullopt;
}

PlanRequest read_plan_request(BodyReader& body) {
  PlanRequest wanted;
  wanted.material = body.text("material");
  wanted.device = body.text("device");
  wanted.machine = body.text("machine");
  wanted.options = body.options("options");
  return wanted;
}

}  // namespace

std::span<const std::string_view> design_file_names() { return kExports; }

void add_asset(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  QueryReader query(request);
  Upload upload = request.upload.value_or(Upload{});
  upload.name = query.text("name");
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  const Answer<Asset> asset = service.designs.add_asset(request.principal, upload);
  if (!asset) return reply(problem_response(asset.error(), request));
  reply(json_response(asset->is_new ? 201 : 200, to_json(*asset)));
}

void list_assets(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'a';
  QueryReader query(request);
  const PageRequest wanted = query.page(kList);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  reply(page_response(service.designs.assets(request.principal, wanted), kList,
                      [](const Asset& asset) { return dump(listed_json(asset)); }));
}

void delete_asset(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(done_response(request, service.designs.remove_asset(request.principal, request.params[0])));
}

void add_design(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  QueryReader query(request);
  const std::string name = query.text("name");
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  service.designs.add(
      request.principal, request.upload.value_or(Upload{}), request.media_type, name,
      [reply, target = request.target, id = request.id](const Answer<Design>& design) {
        if (!design) return reply(problem_response(design.error(), target, id));
        Response response = json_response(design->is_new ? 201 : 200, to_json(*design));
        response.headers.push_back({"Location", "/v1/designs/" + design->id});
        reply(std::move(response));
      });
}

void list_designs(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'd';
  QueryReader query(request);
  const PageRequest wanted = query.page(kList);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  reply(page_response(service.designs.list(request.principal, wanted), kList,
                      [](const Design& design) { return dump(to_json(design)); }));
}

void get_design(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<Design> design = service.designs.find(request.principal, request.params[0]);
  if (!design) return reply(problem_response(design.error(), request));
  Response response = json_response(200, to_json(*design));
  response.headers.push_back({"ETag", fmt::format("\"{}\"", design->id)});
  reply(std::move(response));
}

void design_content(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<Design> design = service.designs.find(request.principal, request.params[0]);
  if (!design) return reply(problem_response(design.error(), request));
  // Always sent as an attachment: a browser must never show what users upload.
  const std::string ending = design->kind == "svg" || design->kind == "dxf" || design->kind == "pdf"
                                 ? design->kind
                                 : "json";
  const Answer<std::string> path = service.designs.content(design->id);
  if (!path) return reply(problem_response(path.error(), request));
  Response response = drawing("application/octet-stream");
  response.headers.push_back(
      {"Content-Disposition", fmt::format("attachment; filename=\"design.{}\"", ending)});
  response.headers.push_back({"ETag", fmt::format("\"{}\"", design->id)});
  response.file = *path;
  reply(std::move(response));
}

void design_preview(const Request& request, Service& service, const HandlerContext& context,
                    Reply reply) {
  answer_picture(request, service, context, reply, [&](Designs::OnView done) {
    service.designs.preview(request.principal, request.params[0], std::move(done));
  });
}

void design_picture(const Request& request, Service& service, const HandlerContext& context,
                    Reply reply) {
  answer_picture(request, service, context, reply, [&](Designs::OnView done) {
    service.designs.picture(request.principal, request.params[0], last_part(request),
                            std::move(done));
  });
}

void design_file(const Request& request, Service& service, const HandlerContext& context,
                 Reply reply) {
  const std::string& name = request.params[1];
  QueryReader query(request);
  const int part = static_cast<int>(query.whole("part").value_or(1));
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  const Answer<Design> design = service.designs.find(request.principal, request.params[0]);
  if (!design) return reply(problem_response(design.error(), request));
  const bool is_known = std::find(kExports.begin(), kExports.end(), name) != kExports.end();
  if (!is_known || design->kind != "spec")
    return reply(problem_response(
        Problem{ProblemKind::NotFound, is_known
                                           ? "only specs are designed; get /content of this one"
                                           : fmt::format("there is no such file; there are {}",
                                                         fmt::join(kExports, ", "))},
        request));
  if (name == "spec.json")
    return answer_file(request, reply, service.designs.content(design->id), name);
  const std::string etag = fmt::format("\"{}-{}-{}-{}{}\"", design->id, name, part, context.build,
                                       service.designs.material_etag_suffix(design->id));
  if (has_seen(request, etag)) return reply(unchanged(etag, kKept));
  Designs::CancelView cancel_view = service.designs.file(
      request.principal, design->id, name, part,
      [reply, etag, name, target = request.target, id = request.id](Answer<std::string> bytes) {
        if (!bytes) return reply(problem_response(bytes.error(), target, id));
        Response response = drawing(type_of(name));
        response.headers.push_back(
            {"Content-Disposition", fmt::format("attachment; filename=\"{}\"", name)});
        response.headers.push_back({"ETag", etag});
        response.headers.push_back({"Cache-Control", std::string(kKept)});
        response.body = std::move(*bytes);
        reply(std::move(response));
      });
  if (request.departure) request.departure->then(std::move(cancel_view));
}

void delete_design(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<Design> design = service.designs.find(request.principal, request.params[0]);
  if (!design) return reply(problem_response(design.error(), request));
  if (const auto not_theirs = check_owner(request, design->owner))
    return reply(problem_response(*not_theirs, request));
  reply(done_response(request, service.designs.remove(request.principal, design->id)));
}

void plan_design(const Request& request, Service& service, const HandlerContext& context,
                 Reply reply) {
  auto wanted = read_body<PlanRequest>(request, context, body::kPlanRequest, read_plan_request);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  wanted->design = request.params[0];
  answer_once(request, service, reply, [&] {
    if (const Answer<Design> design = service.designs.find(request.principal, wanted->design);
        !design)
      return problem_response(design.error(), request);
    const Answer<PlanRecord> plan = service.plans.request(request.principal, *wanted);
    if (!plan) return problem_response(plan.error(), request);
    Response response = json_response(202, to_json(*plan));
    response.headers.push_back({"Location", "/v1/plans/" + plan->id});
    return response;
  });
}

void get_plan(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  service.plans.whole(request.params[0], [reply, target = request.target,
                                          id = request.id](Answer<PlanRecord> plan) {
    if (!plan) return reply(problem_response(plan.error(), target, id));
    Response response;
    response.make_body = [plan = std::move(*plan)] { return dump(to_json(plan)); };
    reply(std::move(response));
  });
}

void delete_plan(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(done_response(request, service.plans.remove(request.principal, request.params[0])));
}

void plan_file(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::string name = last_part(request);
  answer_file(request, reply, service.plans.file(request.params[0], name), name);
}

void sheet_svg(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<std::string> sheet = sheet_name(request, reply);
  if (!sheet) return;
  const std::string name = *sheet + ".svg";
  answer_file(request, reply, service.plans.file(request.params[0], name), name);
}

void sheet_program(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<std::string> sheet = sheet_name(request, reply);
  if (!sheet) return;
  std::string name = *sheet + ".gpgl";
  Answer<std::string> path = service.plans.file(request.params[0], name);
  if (!path && path.error().kind == ProblemKind::NotFound) {
    // A plan has one or the other.
    const std::string other = *sheet + ".hpgl";
    if (Answer<std::string> hpgl = service.plans.file(request.params[0], other)) {
      path = std::move(hpgl);
      name = other;
    }
  }
  answer_file(request, reply, path, name);
}

}  // namespace handle
}  // namespace popcut::daemon::http
