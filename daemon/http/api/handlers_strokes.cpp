// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"

namespace popcut::daemon::http::handle {

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

}  // namespace popcut::daemon::http::handle
