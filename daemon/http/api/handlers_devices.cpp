// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {

const Body body::kTestCut{.schema = "TestCut",
                          .fields = {text("material", kIdLimit).described("default: paper-220")},
                          .example = R"({"material": "paper-220"})",
                          .is_optional = true};

const Body body::kMaterialRow{.schema = "MaterialRow", .is_in_source = true};

namespace handle {
namespace {

Response answer_device(const Request& request, const Answer<DeviceRecord>& device) {
  return device ? revised(200, device->rev, to_json(*device))
                : problem_response(device.error(), request);
}

}  // namespace

void list_devices(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'v';
  reply(whole_list_response(
      request, kList, service.devices.list(), [](const DeviceRecord& device) { return device.id; },
      [](const DeviceRecord& device) { return dump(to_json(device)); }));
}

void get_device(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(answer_device(request, service.devices.find(request.params[0])));
}

void act_on_device(const Request& request, Service& service, const HandlerContext& context,
                   Reply reply) {
  DeviceRequest wanted;
  wanted.action = request.path().substr(request.path().rfind('/') + 1);
  const bool is_test = wanted.action == "test-cut";
  const auto material = read_body<std::string>(
      request, context, is_test ? body::kTestCut : body::kNothing,
      [is_test](BodyReader& body) { return is_test ? body.text("material") : std::string(); });
  if (!material) return reply(problem_response(material.error(), request));
  wanted.material = *material;
  const Answer<std::int64_t> rev = wanted_rev(request, std::nullopt);
  if (!rev) return reply(problem_response(rev.error(), request));
  answer_once(request, service, reply, [&] {
    const Answer<DeviceRecord> device =
        service.devices.act(request.principal, request.params[0], *rev, wanted);
    Response response = answer_device(request, device);
    if (device && !device->test_job.empty())
      response.headers.push_back({"Location", "/v1/jobs/" + device->test_job});
    return response;
  });
}

void list_materials(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'm';
  reply(whole_list_response(
      request, kList, service.materials.list(),
      [](const MaterialRecord& material) { return material.id; },
      [](const MaterialRecord& material) { return dump(to_json(material)); }));
}

void get_material(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<MaterialRecord> material = service.materials.find(request.params[0]);
  if (!material) return reply(problem_response(material.error(), request));
  reply(revised(200, material->rev, to_json(*material)));
}

void put_material(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  const Answer<nlohmann::json> row = parse_body(request.body, context.limits.json_depth);
  if (!row) return reply(problem_response(row.error(), request));
  if (!row->is_object())
    return reply(problem_response(
        validation({{"", "type", "must be an object with the fields of a material"}}), request));
  const std::string& id = request.params[0];
  if (!is_material_id(id))
    return reply(problem_response(
        validation({{"/name", "format",
                     fmt::format("must be 1 to {} characters of a-z, 0-9, '-', '_', '.'",
                                 kMaterialIdLimit.characters)}}),
        request));
  std::int64_t rev = 0;  // it must be new
  if (request.header("if-match")) {
    const Answer<std::int64_t> wanted = wanted_rev(request, std::nullopt);
    if (!wanted) return reply(problem_response(wanted.error(), request));
    rev = *wanted;
  }
  const Answer<MaterialRecord> material =
      service.materials.put(request.principal, id, rev, request.body);
  if (!material) return reply(problem_response(material.error(), request));
  reply(revised(rev == 0 ? 201 : 200, material->rev, to_json(*material)));
}

void delete_material(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<std::int64_t> rev = wanted_rev(request, std::nullopt);
  if (!rev) return reply(problem_response(rev.error(), request));
  reply(
      done_response(request, service.materials.remove(request.principal, request.params[0], *rev)));
}

}  // namespace handle
}  // namespace popcut::daemon::http
