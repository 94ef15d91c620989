// SPDX-License-Identifier: MIT
#include <map>

#include <fmt/format.h>

#include "core/search/standing.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {
namespace {

constexpr InputRule kSpec = other("spec", R"({"type": "object"})")
                                .required()
                                .described("the spec of a design; its files are ids of assets");
constexpr InputRule kPlace =
    word("place", "whole quarter").with_schema(R"({"enum": ["whole", "quarter"]})");

std::vector<std::string> side_words() { return up_words(); }

}  // namespace

const Body body::kPreviewRequest{
    .schema = "PreviewRequest",
    .fields =
        {kSpec,
         word("quality", "draft exact").required().with_schema(R"({"enum": ["draft", "exact"]})"),
         kPlace.described("first move the shape into place, like POST /v1/place")},
    .example = R"json({
      "spec": {"popcut": 1, "surface": {"type": "revolution", "radius": "sqrt(36 - y^2)"},
               "units_per_slice": 3, "slices": 4, "widths_mm": 1.2, "min_panel_mm": 0.2},
      "quality": "draft"})json"};

const Body body::kPlaceRequest{
    .schema = "PlaceRequest",
    .fields =
        {kSpec,
         kPlace.required().described(
             "whole: all of the shape stands in the corner; quarter: its middle is on the spine"),
         word("up", side_words).by_default(0).described("the axis of the file that points up"),
         word("front", side_words)
             .by_default(0)
             .described("the axis of the file that points out of the card, toward you; must not be "
                        "the axis of 'up'")},
    .example = R"({
      "spec": {"popcut": 1, "surface": {"type": "mesh", "file": "sha256-aa"},
               "units_per_slice": 3, "slices": 4, "widths_mm": 1.2},
      "place": "whole"})"};

const Body body::kMakeRequest{
    .schema = "MakeRequest",
    .fields = {word("way", "hand cricut silhouette laser drawing")
                   .required()
                   .with_schema(R"({"enum": ["hand", "cricut", "silhouette", "laser", "drawing"]})")
                   .described("how it is made; drawing: only what the drawing asks"),
               text("material", kIdLimit),
               text("machine", kIdLimit)
                   .described("default: none, cricut-maker, cameo3, or an ideal plotter"),
               plan_options("options")},
    .example = R"({"way": "hand", "options": {"mat": "A4"}})"};

namespace handle {
namespace {

constexpr std::string_view kLatticeType = "application/vnd.popcut.lattice";
constexpr std::string_view kKeptByClient = "private, max-age=86400";

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

PreviewRequest read_preview(BodyReader& body) {
  PreviewRequest wanted;
  read_spec(body.fields(), wanted);
  wanted.is_draft = body.word("quality") == "draft";
  wanted.place = body.optional_word("place").value_or("");
  return wanted;
}

PreviewRequest read_place(BodyReader& body) {
  PreviewRequest wanted;
  read_spec(body.fields(), wanted);
  wanted.place = body.word("place");
  wanted.up = body.word("up");
  wanted.front = body.word("front");
  if (upright_turns(up_side(wanted.up), up_side(wanted.front)).empty())
    body.fields().refuse("front", ErrorKind::OutOfRange, "must not be the axis of `up`", "value");
  return wanted;
}

Answer<std::string> preview_key(const Request& request) {
  const auto key = request.header("preview-key");
  if (!key) return std::string();
  if (is_key(*key)) return std::string(*key);
  return refuse(ProblemKind::BadRequest,
                fmt::format("Preview-Key must be {} to {} visible ASCII characters",
                            kLeastKeyCharacters, kMostKeyCharacters));
}

void end_with_client(const Request& request, Designs::CancelView cancel_view) {
  if (request.departure) request.departure->then(std::move(cancel_view));
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
  auto wanted = read_body<PreviewRequest>(request, context, body::kPreviewRequest, read_preview);
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
  const auto wanted = read_body<PreviewRequest>(request, context, body::kPlaceRequest, read_place);
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

void make_design(const Request& request, Service& service, const HandlerContext& context,
                 Reply reply) {
  std::string way;
  const auto read = [&way](BodyReader& body) {
    way = body.word("way");
    PlanRequest wanted;
    wanted.material = body.text("material");
    wanted.machine = body.text("machine");
    wanted.options = body.options("options");
    return wanted;
  };
  auto wanted = read_body<PlanRequest>(request, context, body::kMakeRequest, read);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  wanted->design = request.params[0];
  if (const auto design = service.designs.find(request.principal, wanted->design); !design)
    return reply(problem_response(design.error(), request));
  end_with_client(request,
                  service.plans.make(
                      request.principal, way, *wanted,
                      [reply, target = request.target, id = request.id](Answer<std::string> made) {
                        if (!made) return reply(problem_response(made.error(), target, id));
                        Response response;
                        response.body = std::move(*made);
                        reply(std::move(response));
                      }));
}

void design_lattice(const Request& request, Service& service, const HandlerContext& context,
                    Reply reply) {
  if (const Answer<Design> design = service.designs.find(request.principal, request.params[0]);
      !design)
    return reply(problem_response(design.error(), request));
  QueryReader query(request);
  std::map<std::string, std::string> reading;
  std::string mark;
  for (const char* name : {"layers", "colors", "units"})
    if (std::string text = query.text(name); !text.empty()) {
      mark += fmt::format("-{}", daemon::sha256_hex(name + text).substr(0, 12));
      reading[name] = std::move(text);
    }
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  const std::string etag =
      fmt::format("\"{}-{}{}{}\"", request.params[0], context.build,
                  service.designs.material_etag_suffix(request.params[0]), mark);
  if (has_seen(request, etag)) return reply(unchanged(etag, kKeptByClient));
  end_with_client(
      request,
      service.designs.lattice(
          request.principal, request.params[0], reading,
          [reply, etag, target = request.target, id = request.id](Answer<std::string> blob) {
            if (!blob) return reply(problem_response(blob.error(), target, id));
            Response response = lattice_response(std::move(*blob));
            response.headers.push_back({"ETag", etag});
            response.headers.push_back({"Cache-Control", std::string(kKeptByClient)});
            reply(std::move(response));
          }));
}

}  // namespace handle
}  // namespace popcut::daemon::http
