// SPDX-License-Identifier: MIT
#include <limits>

#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

void answer_events(const Request& request, Service& service, const Reply& reply,
                   const std::string& job) {
  std::vector<RequestFault> faults;
  const auto after =
      query_integer(request, "after", 0, std::numeric_limits<std::int64_t>::max(), faults);
  const auto limit = query_integer(request, "limit", 1, 200, faults);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  Answer<std::vector<Event>> events =
      service.operations.events(after.value_or(0), static_cast<int>(limit.value_or(50)), job);
  if (!events) return reply(problem_response(events.error(), request));
  Response response;
  response.make_body = [events = std::move(*events), first = service.operations.first_event(),
                        last = service.operations.last_event()] {
    std::string out = "{\"items\":[";
    for (std::size_t i = 0; i < events.size(); ++i) {
      if (i > 0) out += ',';
      out += event_json(events[i]);
    }
    // The oldest that is still kept, and the newest.
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
