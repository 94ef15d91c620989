// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {

const Body body::kSessionRequest{
    .schema = "SessionRequest",
    .fields = {text("one_shot", kSecretLimit)
                   .required("must be the one-time code of the address that 'popcut open' opened")},
    .example = R"({"one_shot": "one-shot-word"})"};

const Body body::kPairRequest{.schema = "PairRequest",
                              .fields = {text("name", kNameLimit)
                                             .required("must be a name for this tablet")
                                             .described("name of the tablet")},
                              .example = R"({"name": "tablet by the window"})"};

const Body body::kPairAllow{
    .schema = "PairAllow",
    .fields = {text("code", kPairingCodeLimit)
                   .required("must be the code that the tablet shows")
                   .described("case does not matter; spaces and dashes are ignored"),
               role("role").required()},
    .example = R"({"code": "K7Q2MX", "role": "viewer"})"};

const Body body::kPairCollect{
    .schema = "PairCollect",
    .fields = {text("secret", kSecretLimit).required("must be the secret that came with the code")},
    .example = R"({"secret": "0123456789"})"};

const Body body::kTokenCreate{
    .schema = "TokenCreate",
    .fields =
        {text("name", kNameLimit).required("must be a name, to recognize the token in the list"),
         role("role").required(), whole("lifetime_s", kLeastTokenLifetime_s, kMostTokenLifetime_s)},
    .example = R"({"name": "script", "role": "submitter"})"};

namespace handle {
namespace {

Response new_session(const NewToken& token) {
  const auto& expires = token.record.expires;
  return json_response(201, {{"id", token.record.id},
                             {"token", token.text},
                             {"role", name_of(token.record.role)},
                             {"expires", expires ? nlohmann::ordered_json(rfc3339(*expires))
                                                 : nlohmann::ordered_json(nullptr)}});
}

struct TokenRequest {
  std::string name;
  Role role{};
  std::optional<int> lifetime_s;
};

TokenRequest read_token_request(BodyReader& body) {
  TokenRequest wanted;
  wanted.name = body.text("name");
  wanted.role = body.role("role");
  wanted.lifetime_s = body.optional_whole("lifetime_s");
  return wanted;
}

}  // namespace

void create_one_shot(const Request& request, Service& service, const HandlerContext& context,
                     Reply reply) {
  if (const auto body = read_nothing(request, context); !body)
    return reply(problem_response(body.error(), request));
  const Answer<std::string> word = service.access.create_one_shot(request.principal);
  if (!word) return reply(problem_response(word.error(), request));
  reply(json_response(201, {{"one_shot", *word}}));
}

void open_session(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  const auto word = read_body<std::string>(request, context, body::kSessionRequest,
                                           [](BodyReader& body) { return body.text("one_shot"); });
  if (!word) return reply(problem_response(word.error(), request));
  const Answer<NewToken> token = service.access.open_session(*word);
  if (!token) return reply(problem_response(token.error(), request));
  reply(new_session(*token));
}

void ask_pairing(const Request& request, Service& service, const HandlerContext& context,
                 Reply reply) {
  const auto name = read_body<std::string>(request, context, body::kPairRequest,
                                           [](BodyReader& body) { return body.text("name"); });
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
  const auto wanted = read_body<Wanted>(request, context, body::kPairAllow, [](BodyReader& body) {
    Wanted one;
    one.code = body.text("code");
    one.role = body.role("role");
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
  const auto secret = read_body<std::string>(request, context, body::kPairCollect,
                                             [](BodyReader& body) { return body.text("secret"); });
  if (!secret) return reply(problem_response(secret.error(), request));
  const Answer<std::optional<NewToken>> made = service.access.collect_pairing(*secret);
  if (!made) return reply(problem_response(made.error(), request));
  reply(*made ? new_session(**made) : json_response(202, {{"state", "waiting"}}));
}

void close_session(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(done_response(request, service.access.close_session(request.principal)));
}

void list_sessions(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 's';
  reply(whole_list_response(
      request, kList, service.access.sessions(request.principal),
      [](const SessionRecord& session) { return session.id; },
      [](const SessionRecord& session) { return dump(to_json(session)); }));
}

void end_session(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(done_response(request, service.access.end_session(request.principal, request.params[0])));
}

void list_tokens(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 't';
  reply(whole_list_response(
      request, kList, service.access.tokens(), [](const TokenRecord& token) { return token.id; },
      [](const TokenRecord& token) { return dump(to_json(token)); }));
}

void create_token(const Request& request, Service& service, const HandlerContext& context,
                  Reply reply) {
  const auto wanted =
      read_body<TokenRequest>(request, context, body::kTokenCreate, read_token_request);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  const Answer<NewToken> token = service.access.create_token(request.principal, wanted->name,
                                                             wanted->role, wanted->lifetime_s);
  if (!token) return reply(problem_response(token.error(), request));
  reply(json_response(201, to_json(*token)));
}

void delete_token(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(done_response(request, service.access.delete_token(request.principal, request.params[0])));
}

}  // namespace handle
}  // namespace popcut::daemon::http
