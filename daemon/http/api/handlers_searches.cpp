// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "core/search/candidate.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::string_view kPictureKept = "private, max-age=86400";

CardSearchRequest read_search(FieldReader& fields) {
  std::vector<std::string> styles;
  for (const StyleChoice& style : style_choices()) styles.emplace_back(style.name);
  CardSearchRequest wanted;
  wanted.material = fields.text("material", "", line(64));
  wanted.device = fields.text("device", "", line(64));
  wanted.machine = fields.text("machine", "", line(64));
  wanted.mat = fields.text("mat", "", line(64));
  wanted.style = styles[fields.word("style", 0, styles)];
  wanted.up = up_words()[fields.word("up", 0, up_words())];
  wanted.front = up_words()[fields.word("front", 0, up_words())];
  wanted.cards = fields.integer("cards", wanted.cards, 1, kMostCards);
  wanted.marks = fields.boolean("marks", wanted.marks);
  wanted.max_minutes =
      fields.number("max_minutes", wanted.max_minutes, kLeastMinutes, kMostMinutes);
  wanted.effort = fields.number("effort", wanted.effort, kLeastEffort, kMostEffort);
  wanted.seed = fields.optional_integer("seed", 0, kMostSeed).value_or(wanted.seed);
  return wanted;
}

// "{k}" of a path.
std::optional<int> card_number(const Request& request, const Reply& reply) {
  const std::optional<int> number = path_number(request.params[1]);
  if (!number)
    reply(problem_response(Problem{ProblemKind::NotFound, "card numbers start at 1"}, request));
  return number;
}

}  // namespace

void search_cards(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  auto wanted = read_body_as<CardSearchRequest>(request, context.limits.json_depth, read_search);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  wanted->model = request.params[0];
  answer_once(request, service, reply, [&] {
    const Answer<SearchRecord> search = service.searches.request(request.principal, *wanted);
    if (!search) return problem_response(search.error(), request);
    Response response = json_response(202, to_json(*search));
    response.headers.push_back({"Location", "/v1/searches/" + search->id});
    return response;
  });
}

void get_search(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  Answer<SearchRecord> search = service.searches.find(request.params[0]);
  if (!search) return reply(problem_response(search.error(), request));
  Response response;
  response.make_body = [search = std::move(*search)] { return dump(to_json(search)); };
  reply(std::move(response));
}

void delete_search(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<void> gone = service.searches.remove(request.principal, request.params[0]);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

void card_picture(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<int> card = card_number(request, reply);
  if (!card) return;
  const Answer<std::string> path = service.searches.picture(request.params[0], *card);
  if (!path) return reply(problem_response(path.error(), request));
  // The picture of a search never changes.
  const std::string etag = fmt::format("\"{}-{}\"", request.params[0], *card);
  if (has_seen(request, etag)) return reply(unchanged(etag, kPictureKept));
  Response response;
  response.content_type = "image/png";
  response.headers.push_back({"ETag", etag});
  response.headers.push_back({"Cache-Control", std::string(kPictureKept)});
  response.file = *path;
  reply(std::move(response));
}

void pick_card(const Request& request, Service& service, const HandlerContext& context,
               Reply reply) {
  const std::optional<int> card = card_number(request, reply);
  if (!card) return;
  const Answer<std::string> name = read_body_as<std::string>(
      request, context.limits.json_depth,
      [](FieldReader& fields) { return fields.text("name", "", line_or_empty(120)); });
  if (!name) return reply(problem_response(name.error(), request));
  service.searches.pick(
      request.principal, request.params[0], *card, *name,
      [reply, target = request.target, id = request.id](const Answer<Design>& design) {
        if (!design) return reply(problem_response(design.error(), target, id));
        Response response = json_response(design->is_new ? 201 : 200, to_json(*design));
        response.headers.push_back({"Location", "/v1/designs/" + design->id});
        reply(std::move(response));
      });
}

}  // namespace popcut::daemon::http::handle
