// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::string_view kLatticeType = "application/vnd.popcut.lattice";
constexpr std::string_view kKeptByClient = "private, max-age=86400";
const std::vector<std::string> kStands{"whole", "quarter"};

void read_spec(FieldReader& fields, PreviewRequest& wanted) {
  const nlohmann::json* const spec = fields.value("spec");
  if (spec != nullptr && spec->is_object()) {
    wanted.spec = spec->dump();
    const auto material = spec->find("material");
    if (material != spec->end() && material->is_string()) wanted.material = *material;
    return;
  }
  fields.refuse("spec", ErrorKind::Malformed,
                spec == nullptr ? "is missing; must be the spec of a design"
                                : "must be the spec of a design, an object",
                spec == nullptr ? "missing" : "type");
}

PreviewRequest read_preview(FieldReader& fields) {
  PreviewRequest wanted;
  read_spec(fields, wanted);
  wanted.is_draft = fields.word("quality", {}, {"draft", "exact"}) == 0;
  if (const auto stand = fields.optional_word("place", kStands)) wanted.place = kStands[*stand];
  return wanted;
}

PreviewRequest read_place(FieldReader& fields) {
  PreviewRequest wanted;
  read_spec(fields, wanted);
  wanted.place = kStands[fields.word("place", {}, kStands)];
  return wanted;
}

Answer<std::string> preview_key(const Request& request) {
  const auto key = request.header("preview-key");
  if (!key) return std::string();
  const bool has_form =
      key->size() >= 16 && key->size() <= 128 &&
      std::all_of(key->begin(), key->end(), [](char c) { return c > ' ' && c < '\x7F'; });
  if (has_form) return std::string(*key);
  return refuse(ProblemKind::BadRequest, "Preview-Key must be 16 to 128 visible ASCII characters");
}

void end_with_client(const Request& request, Designs::CallOff call_off) {
  if (request.departure) request.departure->then(std::move(call_off));
}

Response lattice_response(std::string blob) {
  Response response;
  response.content_type = std::string(kLatticeType);
  response.body = std::move(blob);
  return response;
}

}  // namespace

void preview_spec(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  const Answer<std::string> key = preview_key(request);
  if (!key) return reply(problem_response(key.error(), request));
  auto wanted = read_body_as<PreviewRequest>(request, context.limits.json_depth, read_preview);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  wanted->key = *key;
  end_with_client(request,
                  service.designs.show_spec(
                      request.principal, *wanted,
                      [reply, target = request.target, id = request.id](Answer<std::string> blob) {
                        if (!blob) return reply(problem_response(blob.error(), target, id));
                        reply(lattice_response(std::move(*blob)));
                      }));
}

void place_spec(const Request& request, Service& service, const HandlerContext& context,
                Reply reply) {
  const auto wanted = read_body_as<PreviewRequest>(request, context.limits.json_depth, read_place);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  end_with_client(request,
                  service.designs.place_spec(
                      request.principal, *wanted,
                      [reply, target = request.target, id = request.id](Answer<std::string> spec) {
                        if (!spec) return reply(problem_response(spec.error(), target, id));
                        Response response;
                        response.body = "{\"spec\":" + *spec + "}";
                        reply(std::move(response));
                      }));
}

void design_lattice(const Request& request, Service& service, const HandlerContext& context,
                    Reply reply) {
  if (const Answer<Design> design = service.designs.find(request.params[0]); !design)
    return reply(problem_response(design.error(), request));
  const std::string etag = fmt::format("\"{}-{}{}\"", request.params[0], context.build,
                                       service.designs.material_mark(request.params[0]));
  if (has_seen(request, etag)) return reply(unchanged(etag, kKeptByClient));
  end_with_client(
      request,
      service.designs.lattice(
          request.principal, request.params[0],
          [reply, etag, target = request.target, id = request.id](Answer<std::string> blob) {
            if (!blob) return reply(problem_response(blob.error(), target, id));
            Response response = lattice_response(std::move(*blob));
            response.headers.push_back({"ETag", etag});
            response.headers.push_back({"Cache-Control", std::string(kKeptByClient)});
            reply(std::move(response));
          }));
}

}  // namespace popcut::daemon::http::handle
