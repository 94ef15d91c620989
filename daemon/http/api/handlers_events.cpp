// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

void answer_events(const Request& request, Service& service, const Reply& reply,
                   const std::string& job) {
  QueryReader query(request);
  const auto after = query.whole("after"), limit = query.whole("limit");
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  Answer<std::vector<Event>> events = service.operations.events(
      after.value_or(0), static_cast<int>(limit.value_or(request.usual_page_items)), job);
  if (!events) return reply(problem_response(events.error(), request));
  Response response;
  response.make_body = [events = std::move(*events), first = service.operations.first_event(),
                        last = service.operations.last_event()] {
    std::string out = "{\"items\":[";
    for (std::size_t i = 0; i < events.size(); ++i) {
      if (i > 0) out += ',';
      out += event_json(events[i]);
    }
    // The numbers of the oldest event that is still kept, and of the newest one.
    return out + fmt::format("],\"first_seq\":{},\"last_seq\":{}}}", first, last);
  };
  reply(std::move(response));
}

}  // namespace

void list_events(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  answer_events(request, service, reply, "");
}

void job_events(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<Job> job = service.jobs.find(request.params[0]);
  if (!job) return reply(problem_response(job.error(), request));
  answer_events(request, service, reply, job->id);
}

}  // namespace popcut::daemon::http::handle
