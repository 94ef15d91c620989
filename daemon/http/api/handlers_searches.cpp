// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "core/search/candidate.hpp"
#include "core/search/choices.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {
namespace {

std::vector<std::string> style_words() {
  std::vector<std::string> out;
  for (const StyleChoice& style : style_choices()) out.emplace_back(style.name);
  return out;
}

std::vector<std::string> axis_words() { return up_words(); }
std::vector<std::string> up_axis_words() { return up_choices(); }

}  // namespace

const Body body::kSearchRequest{
    .schema = "SearchRequest",
    .fields =
        {number("max_minutes", kLeastMinutes, kMostMinutes)
             .by_default(CardSearchRequest{}.max_minutes)
             .described("the longest cutting time"),
         text("mat", kIdLimit)
             .described("a mat of the machine, or a size such as 210x297; cards fit on one "
                        "sheet"),
         text("machine", kIdLimit),
         text("device", kIdLimit).described("a cutter, instead of 'machine'"),
         text("material", kIdLimit), word("style", style_words).by_default(0),
         word("up", up_axis_words)
             .by_default(0)
             .described("the axis of the file that points up; usual: by the name of the model, y "
                        "for OBJ and GLB, z for STL; any: popcut chooses the most similar card"),
         word("front", axis_words)
             .by_default(0)
             .described("the axis of the file that points out of the card, toward you; any: popcut "
                        "chooses. Only for cards; must not be the axis of 'up'"),
         whole("cards", 1, kMostCards)
             .by_default(CardSearchRequest{}.cards)
             .with_schema(R"({"type": "integer", "enum": [1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12],
                                    "default": 1})")
             .described("1: single cards; 3 to 12: books of this many cards around one spine, "
                        "which show the model from all sides. Facets: books of 4 cards only"),
         flag("marks").by_default(0).described(
             "cards fit between the registration marks that are printed with the "
             "artwork of a sheet"),
         whole("max_folds", 1, kMostFolds)
             .described("the most folds of a card. If no card keeps to the limits of folding, the "
                        "search finds the one of the fewest folds, and notes say so"),
         number("min_fold_mm", 0, kMostFold_mm)
             .by_default(CardSearchRequest{}.min_fold_mm)
             .described("the shortest fold of a card"),
         word("label", label_words)
             .by_default(0)
             .described("how hard to fold: only cards that are easy, or at most medium"),
         flag("plain").by_default(0).described(
             "judge cards as bare paper, by depths, and not as they look printed; books always "
             "are"),
         number("effort", kLeastEffort, kMostEffort)
             .by_default(CardSearchRequest{}.effort)
             .described("search effort, a factor on the number of cards tried; 1 takes one to two "
                        "minutes"),
         whole("seed", 0, kMostSeed).by_default(1)},
    .example = R"({"max_minutes": 10, "up": "z", "effort": 0.25})",
    .is_optional = true};

const Body body::kPickRequest{
    .schema = "PickRequest",
    .fields = {text_or_empty("name", kNameLimit)
                   .described("name of the design; default: the name of the model")},
    .example = R"({"name": "teapot"})",
    .is_optional = true};

namespace handle {
namespace {

constexpr std::string_view kPictureKept = "private, max-age=86400";

CardSearchRequest read_search(BodyReader& body) {
  CardSearchRequest wanted;
  wanted.material = body.text("material");
  wanted.device = body.text("device");
  wanted.machine = body.text("machine");
  wanted.mat = body.text("mat");
  wanted.style = body.word("style");
  wanted.up = body.word("up");
  wanted.front = body.word("front");
  wanted.cards = body.whole("cards");
  wanted.marks = body.flag("marks");
  wanted.max_minutes = body.number("max_minutes");
  wanted.max_folds = body.whole("max_folds");
  wanted.min_fold_mm = body.number("min_fold_mm");
  wanted.label = body.word("label");
  wanted.plain = body.flag("plain");
  wanted.effort = body.number("effort");
  wanted.seed = body.optional_large("seed").value_or(wanted.seed);
  return wanted;
}

// A file of a card. What a search found never changes.
void answer_card(const Request& request, int card, const Answer<std::string>& path,
                 std::string_view type, const Reply& reply) {
  if (!path) return reply(problem_response(path.error(), request));
  const std::string etag =
      fmt::format("\"{}-{}-{}\"", request.params[0], card, type.substr(type.rfind('.') + 1));
  if (has_seen(request, etag)) return reply(unchanged(etag, kPictureKept));
  Response response;
  response.content_type = std::string(type);
  response.headers.push_back({"ETag", etag});
  response.headers.push_back({"Cache-Control", std::string(kPictureKept)});
  response.file = *path;
  reply(std::move(response));
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
  auto wanted = read_body<CardSearchRequest>(request, context, body::kSearchRequest, read_search);
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
  Answer<SearchRecord> search = service.searches.find(request.principal, request.params[0]);
  if (!search) return reply(problem_response(search.error(), request));
  Response response;
  response.make_body = [search = std::move(*search)] { return dump(to_json(search)); };
  reply(std::move(response));
}

void list_searches(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'f';
  QueryReader query(request);
  const PageRequest wanted = query.page(kList);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  reply(page_response(service.searches.list(request.principal, wanted), kList,
                      [](const SearchRecord& search) { return dump(listed_json(search)); }));
}

void delete_search(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(done_response(request, service.searches.remove(request.principal, request.params[0])));
}

void card_picture(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<int> card = card_number(request, reply);
  if (card)
    answer_card(request, *card, service.searches.picture(request.params[0], *card), "image/png",
                reply);
}

void card_lattice(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<int> card = card_number(request, reply);
  if (card)
    answer_card(request, *card, service.searches.lattice(request.params[0], *card),
                "application/vnd.popcut.lattice", reply);
}

void pick_card(const Request& request, Service& service, const HandlerContext& context,
               Reply reply) {
  const std::optional<int> card = card_number(request, reply);
  if (!card) return;
  const auto name = read_body<std::string>(request, context, body::kPickRequest,
                                           [](BodyReader& body) { return body.text("name"); });
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

}  // namespace handle
}  // namespace popcut::daemon::http
