// SPDX-License-Identifier: MIT
#include <algorithm>

#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

Response answer_device(const Request& request, const Answer<DeviceRecord>& device) {
  return device ? revised(200, device->rev, to_json(*device))
                : problem_response(device.error(), request);
}

bool is_material_id(const std::string& id) {
  return id.size() <= 64 && std::all_of(id.begin(), id.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
                  c == '.';
         });
}

}  // namespace

void list_devices(const Request& request, Service& service, const Shop&, Reply reply) {
  constexpr char kList = 'v';
  std::vector<RequestFault> faults;
  const PageWish wish = page_wish(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  reply(page_response(
      page_of(service.devices(), wish, [](const DeviceRecord& device) { return device.id; }), kList,
      [](const DeviceRecord& device) { return dump(to_json(device)); }));
}

void get_device(const Request& request, Service& service, const Shop&, Reply reply) {
  reply(answer_device(request, service.device(request.params[0])));
}

void act_on_device(const Request& request, Service& service, const Shop& shop, Reply reply) {
  DeviceWish wish;
  wish.action = request.path().substr(request.path().rfind('/') + 1);
  const auto body =
      read_body_as<std::string>(request, shop.limits.json_depth, [&wish](FieldReader& fields) {
        return wish.action == "test-cut" ? fields.text("material", "", line(64)) : std::string();
      });
  if (!body) return reply(problem_response(body.error(), request));
  wish.material = *body;
  const Answer<std::int64_t> rev = wanted_rev(request, std::nullopt);
  if (!rev) return reply(problem_response(rev.error(), request));
  answer_once(request, service, reply, [&] {
    const Answer<DeviceRecord> device =
        service.act_on_device(request.principal, request.params[0], *rev, wish);
    Response response = answer_device(request, device);
    if (device && !device->test_job.empty())
      response.headers.push_back({"Location", "/v1/jobs/" + device->test_job});
    return response;
  });
}

void list_materials(const Request& request, Service& service, const Shop&, Reply reply) {
  constexpr char kList = 'm';
  std::vector<RequestFault> faults;
  const PageWish wish = page_wish(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  reply(page_response(page_of(service.materials(), wish,
                              [](const MaterialRecord& material) { return material.id; }),
                      kList,
                      [](const MaterialRecord& material) { return dump(to_json(material)); }));
}

void get_material(const Request& request, Service& service, const Shop&, Reply reply) {
  const Answer<MaterialRecord> material = service.material(request.params[0]);
  if (!material) return reply(problem_response(material.error(), request));
  reply(revised(200, material->rev, to_json(*material)));
}

void put_material(const Request& request, Service& service, const Shop& shop, Reply reply) {
  const Answer<nlohmann::json> row = parse_body(request.body, shop.limits.json_depth);
  if (!row) return reply(problem_response(row.error(), request));
  if (!row->is_object())
    return reply(problem_response(validation({{"", "type", "must be an object {...}: a material"}}),
                                  request));
  const std::string& id = request.params[0];
  if (!is_material_id(id))
    return reply(problem_response(
        validation({{"/name", "format", "must be 1 to 64 characters of a-z, 0-9, '-', '_', '.'"}}),
        request));
  std::int64_t rev = 0;  // it must be new
  if (request.header("if-match")) {
    const Answer<std::int64_t> wanted = wanted_rev(request, std::nullopt);
    if (!wanted) return reply(problem_response(wanted.error(), request));
    rev = *wanted;
  }
  const Answer<MaterialRecord> material =
      service.put_material(request.principal, id, rev, request.body);
  if (!material) return reply(problem_response(material.error(), request));
  reply(revised(rev == 0 ? 201 : 200, material->rev, to_json(*material)));
}

void delete_material(const Request& request, Service& service, const Shop&, Reply reply) {
  const Answer<std::int64_t> rev = wanted_rev(request, std::nullopt);
  if (!rev) return reply(problem_response(rev.error(), request));
  const Answer<void> gone = service.delete_material(request.principal, request.params[0], *rev);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

}  // namespace popcut::daemon::http::handle
