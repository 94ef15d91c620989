// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::string_view kPageKept = "private, max-age=86400";

ArtworkRequest read_artwork(QueryReader& query) {
  ArtworkRequest wanted;
  wanted.mode = query.word("mode");
  wanted.dpi = static_cast<int>(query.whole("dpi").value_or(wanted.dpi));
  wanted.clay = query.flag("clay");
  wanted.back = query.flag("back");
  wanted.model = query.text("model");
  return wanted;
}

}  // namespace

// A plan never changes, so neither does this file of it.
void sheet_strokes(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::string& plan = request.params[0];
  const std::optional<int> number = path_number(request.params[1]);
  if (!number)
    return reply(
        problem_response(Problem{ProblemKind::NotFound, "sheet numbers start at 1"}, request));
  const Answer<std::string> path =
      service.plans.file(plan, fmt::format("sheet-{:02}.strokes.json", *number));
  if (!path) return reply(problem_response(path.error(), request));
  Response response;
  response.file = *path;
  response.headers = {{"ETag", fmt::format("\"{}-{}-strokes\"", plan, *number)},
                      {"Cache-Control", "private, no-cache"}};
  reply(std::move(response));
}

void sheet_artwork(const Request& request, Service& service, const HandlerContext& context,
                   Reply reply) {
  const std::optional<int> sheet = path_number(request.params[1]);
  if (!sheet)
    return reply(
        problem_response(Problem{ProblemKind::NotFound, "sheet numbers start at 1"}, request));
  QueryReader query(request);
  const ArtworkRequest wanted = read_artwork(query);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  if (const Answer<PlanRecord> plan = service.plans.find(request.params[0]); !plan)
    return reply(problem_response(plan.error(), request));
  const std::string etag =
      fmt::format("\"{}-{}-{}-{}{}{}-{}{}\"", request.params[0], *sheet, wanted.mode, wanted.dpi,
                  wanted.clay ? "-clay" : "", wanted.back ? "-back" : "", context.build,
                  wanted.model.empty() ? "" : "-" + wanted.model);
  if (has_seen(request, etag)) return reply(unchanged(etag, kPageKept));
  Designs::CancelView cancel_view =
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
  if (request.departure) request.departure->then(std::move(cancel_view));
}

}  // namespace popcut::daemon::http::handle
