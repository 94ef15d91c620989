// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::int64_t kLongestLife_s = std::int64_t{10} * 366 * 24 * 3600;

struct TokenWish {
  std::string name;
  Role role{};
  std::optional<int> lifetime_s;
};

TokenWish read_token_wish(FieldReader& fields) {
  TokenWish wish;
  fields.need("name", "give a name, for those who read the list of tokens");
  wish.name = fields.text("name", "", line(120));
  wish.role =
      static_cast<Role>(fields.word("role", {}, {"viewer", "submitter", "operator", "admin"}));
  if (const auto life = fields.optional_integer("lifetime_s", 60, kLongestLife_s))
    wish.lifetime_s = static_cast<int>(*life);
  return wish;
}

}  // namespace

void create_one_shot(const Request& request, Service& service, const Shop& shop, Reply reply) {
  const auto body =
      read_body_as<bool>(request, shop.limits.json_depth, [](FieldReader&) { return true; });
  if (!body) return reply(problem_response(body.error(), request));
  const Answer<std::string> word = service.create_one_shot(request.principal);
  if (!word) return reply(problem_response(word.error(), request));
  reply(json_response(201, {{"one_shot", *word}}));
}

void open_session(const Request& request, Service& service, const Shop& shop, Reply reply) {
  const auto word =
      read_body_as<std::string>(request, shop.limits.json_depth, [](FieldReader& fields) {
        fields.need("one_shot", "must be the word that 'popcut open' was given");
        return fields.text("one_shot", "", line(200));
      });
  if (!word) return reply(problem_response(word.error(), request));
  const Answer<NewToken> token = service.open_session(*word);
  if (!token) return reply(problem_response(token.error(), request));
  const auto& expires = token->record.expires;
  reply(json_response(201, {{"token", token->text},
                            {"role", name_of(token->record.role)},
                            {"expires", expires ? nlohmann::ordered_json(rfc3339(*expires))
                                                : nlohmann::ordered_json(nullptr)}}));
}

void close_session(const Request& request, Service& service, const Shop&, Reply reply) {
  // "Bearer pc_<id>_<secret>"; that it is a lawful one was seen at the door.
  const std::string_view sent = request.header("authorization").value_or("");
  const std::size_t begin = sent.find("pc_");
  const std::size_t end = sent.find('_', begin == std::string_view::npos ? begin : begin + 3);
  if (begin == std::string_view::npos || end == std::string_view::npos)
    return reply(problem_response(
        Problem{ProblemKind::NotFound, "this connection has no session; it is known by its user"},
        request));
  const std::string id(sent.substr(begin + 3, end - begin - 3));
  const Answer<void> gone = service.delete_token(request.principal, id);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

void list_tokens(const Request& request, Service& service, const Shop&, Reply reply) {
  constexpr char kList = 't';
  std::vector<RequestFault> faults;
  const PageWish wish = page_wish(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  reply(page_response(
      page_of(service.tokens(), wish, [](const TokenRecord& token) { return token.id; }), kList,
      [](const TokenRecord& token) { return dump(to_json(token)); }));
}

void create_token(const Request& request, Service& service, const Shop& shop, Reply reply) {
  const auto wish = read_body_as<TokenWish>(request, shop.limits.json_depth, read_token_wish);
  if (!wish) return reply(problem_response(wish.error(), request));
  const Answer<NewToken> token =
      service.create_token(request.principal, wish->name, wish->role, wish->lifetime_s);
  if (!token) return reply(problem_response(token.error(), request));
  reply(json_response(201, to_json(*token)));
}

void delete_token(const Request& request, Service& service, const Shop&, Reply reply) {
  const Answer<void> gone = service.delete_token(request.principal, request.params[0]);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

}  // namespace popcut::daemon::http::handle
