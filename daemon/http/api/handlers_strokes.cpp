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
  const auto file = [&](const char* ending) {
    return service.plans.file(plan, fmt::format("sheet-{:02}.{}", *number, ending));
  };
  // The sheet is there if its drawing is.
  if (const Answer<std::string> drawn = file("svg"); !drawn)
    return reply(problem_response(drawn.error(), request));
  const Answer<std::string> path = file("strokes.json");
  if (!path && path.error().kind == ProblemKind::NotFound)
    return reply(problem_response(
        Problem{ProblemKind::StateConflict,
                "this plan was made by an earlier popcutd, which kept no strokes to draw; use the "
                "sheet's .svg, or plan the design again"},
        request));
  if (!path) return reply(problem_response(path.error(), request));
  Response response;
  response.file = *path;
  response.headers = {{"ETag", fmt::format("\"{}-{}-strokes\"", plan, *number)},
                      {"Cache-Control", "private, no-cache"}};
  reply(std::move(response));
}

}  // namespace popcut::daemon::http::handle
