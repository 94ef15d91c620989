// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

Response new_session(const NewToken& token) {
  const auto& expires = token.record.expires;
  return json_response(201, {{"id", token.record.id},
                             {"token", token.text},
                             {"role", name_of(token.record.role)},
                             {"expires", expires ? nlohmann::ordered_json(rfc3339(*expires))
                                                 : nlohmann::ordered_json(nullptr)}});
}

constexpr std::int64_t kLongestLife_s = std::int64_t{10} * 366 * 24 * 3600;

struct TokenRequest {
  std::string name;
  Role role{};
  std::optional<int> lifetime_s;
};

TokenRequest read_token_request(FieldReader& fields) {
  TokenRequest wanted;
  fields.need("name", "give a name, for those who read the list of tokens");
  wanted.name = fields.text("name", "", line(120));
  wanted.role =
      static_cast<Role>(fields.word("role", {}, {"viewer", "submitter", "operator", "admin"}));
  if (const auto life = fields.optional_integer("lifetime_s", 60, kLongestLife_s))
    wanted.lifetime_s = static_cast<int>(*life);
  return wanted;
}

}  // namespace

void create_one_shot(const Request& request, Service& service, const HandlerContext& context,
                     Reply reply) {
  const auto body =
      read_body_as<bool>(request, context.limits.json_depth, [](FieldReader&) { return true; });
  if (!body) return reply(problem_response(body.error(), request));
  const Answer<std::string> word = service.access.create_one_shot(request.principal);
  if (!word) return reply(problem_response(word.error(), request));
  reply(json_response(201, {{"one_shot", *word}}));
}

void open_session(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  const auto word =
      read_body_as<std::string>(request, context.limits.json_depth, [](FieldReader& fields) {
        fields.need("one_shot",
                    "must be the one-shot word of the address that 'popcut open' opened");
        return fields.text("one_shot", "", line(200));
      });
  if (!word) return reply(problem_response(word.error(), request));
  const Answer<NewToken> token = service.access.open_session(*word);
  if (!token) return reply(problem_response(token.error(), request));
  reply(new_session(*token));
}

void ask_pairing(const Request& request, Service& service, const HandlerContext& context,
                 Reply reply) {
  const auto name =
      read_body_as<std::string>(request, context.limits.json_depth, [](FieldReader& fields) {
        fields.need("name", "must be what a person calls this tablet");
        return fields.text("name", "", line(120));
      });
  if (!name) return reply(problem_response(name.error(), request));
  const Answer<NewPairing> made = service.access.ask_pairing(*name, request.place);
  if (!made) return reply(problem_response(made.error(), request));
  reply(json_response(201, {{"id", made->id},
                            {"code", made->code},
                            {"secret", made->secret},
                            {"expires", rfc3339(made->expires)}}));
}

void allow_pairing(const Request& request, Service& service, const HandlerContext& context,
                   Reply reply) {
  struct Wanted {
    std::string code;
    Role role{};
  };
  const auto wanted =
      read_body_as<Wanted>(request, context.limits.json_depth, [](FieldReader& fields) {
        Wanted one;
        fields.need("code", "must be the code that the tablet shows");
        one.code = fields.text("code", "", line(20));
        one.role = static_cast<Role>(
            fields.word("role", {}, {"viewer", "submitter", "operator", "admin"}));
        return one;
      });
  if (!wanted) return reply(problem_response(wanted.error(), request));
  const Answer<AllowedPairing> allowed =
      service.access.allow_pairing(request.principal, wanted->code, wanted->role);
  if (!allowed) return reply(problem_response(allowed.error(), request));
  reply(json_response(200, {{"name", allowed->name}, {"role", name_of(allowed->role)}}));
}

void collect_pairing(const Request& request, Service& service, const HandlerContext& context,
                     Reply reply) {
  const auto secret =
      read_body_as<std::string>(request, context.limits.json_depth, [](FieldReader& fields) {
        fields.need("secret", "must be the secret that came with the code");
        return fields.text("secret", "", line(200));
      });
  if (!secret) return reply(problem_response(secret.error(), request));
  const Answer<std::optional<NewToken>> made = service.access.collect_pairing(*secret);
  if (!made) return reply(problem_response(made.error(), request));
  reply(*made ? new_session(**made) : json_response(202, {{"state", "waiting"}}));
}

void close_session(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<void> gone = service.access.close_session(request.principal);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

void list_sessions(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 's';
  std::vector<RequestFault> faults;
  const PageRequest wanted = page_request(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  reply(page_response(page_of(service.access.sessions(request.principal), wanted,
                              [](const SessionRecord& session) { return session.id; }),
                      kList, [](const SessionRecord& session) { return dump(to_json(session)); }));
}

void end_session(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<void> gone = service.access.end_session(request.principal, request.params[0]);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

void list_tokens(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 't';
  std::vector<RequestFault> faults;
  const PageRequest wanted = page_request(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  reply(page_response(
      page_of(service.access.tokens(), wanted, [](const TokenRecord& token) { return token.id; }),
      kList, [](const TokenRecord& token) { return dump(to_json(token)); }));
}

void create_token(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  const auto wanted =
      read_body_as<TokenRequest>(request, context.limits.json_depth, read_token_request);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  const Answer<NewToken> token = service.access.create_token(request.principal, wanted->name,
                                                             wanted->role, wanted->lifetime_s);
  if (!token) return reply(problem_response(token.error(), request));
  reply(json_response(201, to_json(*token)));
}

void delete_token(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<void> gone = service.access.delete_token(request.principal, request.params[0]);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

}  // namespace popcut::daemon::http::handle
