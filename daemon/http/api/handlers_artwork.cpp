// SPDX-License-Identifier: MIT
#include <array>

#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::string_view kPageKept = "private, max-age=86400";

bool read_flag(const Request& request, std::string_view name, std::vector<RequestFault>& faults) {
  const std::string text = query_text(request, name).value_or("false");
  if (text != "true" && text != "false")
    faults.push_back({fmt::format("?{}", name), "word", "must be true or false"});
  return text == "true";
}

ArtworkRequest read_artwork(const Request& request, std::vector<RequestFault>& faults) {
  ArtworkRequest wanted;
  wanted.mode = query_text(request, "mode").value_or("view");
  if (wanted.mode != "view" && wanted.mode != "surface")
    faults.push_back({"?mode", "word",
                      "must be view (the model as it is seen) or surface (the colour of its "
                      "nearest point)"});
  wanted.dpi = static_cast<int>(query_integer(request, "dpi", 50, 600, faults).value_or(300));
  wanted.clay = read_flag(request, "clay", faults);
  wanted.back = read_flag(request, "back", faults);
  wanted.model = query_text(request, "model").value_or("");
  return wanted;
}

}  // namespace

void sheet_artwork(const Request& request, Service& service, const HandlerContext& context,
                   Reply reply) {
  const std::optional<int> sheet = path_number(request.params[1]);
  if (!sheet)
    return reply(
        problem_response(Problem{ProblemKind::NotFound, "sheet numbers start at 1"}, request));
  std::vector<RequestFault> faults;
  const ArtworkRequest wanted = read_artwork(request, faults);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  if (const Answer<PlanRecord> plan = service.plans.find(request.params[0]); !plan)
    return reply(problem_response(plan.error(), request));
  const std::string etag =
      fmt::format("\"{}-{}-{}-{}{}{}-{}{}\"", request.params[0], *sheet, wanted.mode, wanted.dpi,
                  wanted.clay ? "-clay" : "", wanted.back ? "-back" : "", context.build,
                  wanted.model.empty() ? "" : "-" + wanted.model);
  if (has_seen(request, etag)) return reply(unchanged(etag, kPageKept));
  Designs::CallOff call_off =
      service.plans.artwork(request.principal, request.params[0], *sheet, wanted,
                            [reply, etag, sheet = *sheet, target = request.target,
                             id = request.id](Answer<std::string> pdf) {
                              if (!pdf) return reply(problem_response(pdf.error(), target, id));
                              Response response;
                              response.content_type = "application/pdf";
                              response.headers.push_back(
                                  {"Content-Disposition",
                                   fmt::format("attachment; filename=\"sheet-{:02}.pdf\"", sheet)});
                              response.headers.push_back({"ETag", etag});
                              response.headers.push_back({"Cache-Control", std::string(kPageKept)});
                              response.body = std::move(*pdf);
                              reply(std::move(response));
                            });
  if (request.departure) request.departure->then(std::move(call_off));
}

}  // namespace popcut::daemon::http::handle
