// SPDX-License-Identifier: MIT
#include "daemon/http/api/openapi.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/plan/plan_options.hpp"
#include "daemon/http/api/dispatch.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"

namespace popcut::daemon::http {
namespace {

using Json = nlohmann::ordered_json;
using PlanKind = PlanOption::Kind;
using Kind = InputRule::Kind;

// A problem that routes answer with: its name in components/responses.
struct ErrorResponse {
  int status;
  std::string_view name;
  std::string_view description;
  std::string_view header{}, header_type{};
};

constexpr std::array<ErrorResponse, 16> kErrors{{
    {400, "BadRequest",
     "bad-request (the request is not valid HTTP), malformed-json, or idempotency-key-missing"},
    {401, "Unauthenticated", "unauthenticated: no token, or an unknown one", "WWW-Authenticate",
     "string"},
    {403, "Forbidden",
     "forbidden: the role does not permit it, it belongs to someone else, or the request comes "
     "from a page of another origin"},
    {404, "NotFound", "not-found"},
    {405, "MethodNotAllowed", "method-not-allowed; the header Allow lists the methods", "Allow",
     "string"},
    {409, "Conflict",
     "state-conflict: not possible in this state (state and allowed_actions in the problem); "
     "device-absent; idempotency-in-progress; superseded: a newer preview with the same "
     "Preview-Key came"},
    {412, "Stale", "stale: it has changed since you read it; rev is the current revision"},
    {413, "TooLarge", "too-large"},
    {415, "UnsupportedMedia", "unsupported-media"},
    {421, "WrongHost", "wrong-host: Host names another server"},
    {422, "Invalid",
     "validation (errors[] lists what is wrong and what would be right), or "
     "idempotency-key-reused"},
    {428, "PreconditionRequired", "precondition-required: send If-Match"},
    {429, "Rate", "rate: too many requests, or failed logins; see Retry-After", "Retry-After",
     "integer"},
    {500, "Internal", "internal"},
    {503, "Unavailable", "unavailable or queue-full: try again with the same key", "Retry-After",
     "integer"},
    {507, "DiskFull", "disk-full"},
}};

/// Whether a route can answer with the problem of that status.
bool can_give(const Route& route, int status) {
  const bool changes = route.method != Method::Get, is_open = route.access.is_open();
  const Guess guess = route.guess;
  switch (status) {
    case 401:
      return !is_open || guess == Guess::Word;
    case 403:  // the role, or a page of another origin
      return !is_open || changes;
    case 404:
      return route.can_miss || route.path.find('{') != std::string_view::npos ||
             guess == Guess::Code || guess == Guess::Secret;
    case 405:  // not of a route: of a path with another method
      return false;
    case 409:
      return route.can_conflict;
    case 412:
      return route.match != MatchRule::None;
    case 415:
      return route.body != BodyRule::None;
    case 428:
      return route.match != MatchRule::None && route.match != MatchRule::Allowed;
    case 429:
    case 503:
      return !route.is_static;
    case 500:
      return !route.is_static && !route.is_constant;
    case 507:
      return changes && !route.stores_nothing;
    default:
      return true;
  }
}

Json reference(std::string_view kind, std::string_view name) {
  return {{"$ref", fmt::format("#/components/{}/{}", kind, name)}};
}

Json content_of(std::string_view words) {
  Json out = Json::object();
  for (const std::string& word : words_of(words)) {
    const std::size_t colon = word.find(':');
    if (word.find('/') == std::string::npos)
      out["application/json"] = {{"schema", reference("schemas", word)}};
    else if (colon == std::string::npos)
      out[word] = Json::object();
    else
      out[word.substr(0, colon)] = {{"schema", {{"type", word.substr(colon + 1)}}}};
  }
  return out;
}

Json headers_of(const Route& route) {
  const Json text{{"type", "string"}};
  Json out = Json::object();
  if (route.has_etag || route.is_cached) out["ETag"] = {{"schema", text}};
  for (const std::string& name : words_of(route.headers)) {
    if (name == "JobLocation")
      out["Location"] = {{"description", "URL of the new job"}, {"schema", text}};
    else
      out[name] = {{"schema", text}};
  }
  if (route.key != KeyRule::None)
    out["Idempotent-Replayed"] = {
        {"description", "true: the response to the first request with this key"}, {"schema", text}};
  return out;
}

int status_of(const Success& success) {
  if (success.status != 0) return success.status;
  return success.content.empty() ? 204 : 200;
}

Json response_of(const Route& route, const Success& success) {
  const int status = status_of(success);
  const std::string_view usual = status == 200 ? "success" : status == 201 ? "created" : "done";
  Json out{{"description", success.text.empty() ? usual : success.text}};
  if (const Json headers = headers_of(route); !headers.empty() && status < 300 && status != 204)
    out["headers"] = headers;
  if (!success.content.empty()) out["content"] = content_of(success.content);
  return out;
}

Json responses_of(const Route& route) {
  Json out = Json::object();
  out[std::to_string(status_of(route.gives))] = response_of(route, route.gives);
  const Success& other = route.gives_too;
  if (other.status < 400 && !other.content.empty())
    out[std::to_string(status_of(other))] = response_of(route, other);
  if (route.is_cached) out["304"] = {{"description", "not modified"}};
  for (const ErrorResponse& error : kErrors)
    if (can_give(route, error.status))
      out[std::to_string(error.status)] = reference("responses", error.name);
  if (other.status >= 400) {
    Json both = response_of(route, other);
    both["content"]["application/problem+json"] = {{"schema", reference("schemas", "Problem")}};
    out[std::to_string(other.status)] = both;
  }
  return out;
}

Json number_of(Kind kind, double value) {
  if (kind == Kind::Number && value != static_cast<double>(static_cast<std::int64_t>(value)))
    return value;
  return static_cast<std::int64_t>(value);
}

/// The schema of what `rule` allows, without its description.
Json bare_schema(const InputRule& rule) {
  if (!rule.schema.empty()) return Json::parse(rule.schema);
  Json out;
  const auto add_length = [&rule](Json& text) {
    if (rule.least > 0) text["minLength"] = number_of(Kind::Whole, rule.least);
    if (rule.most > 0) text["maxLength"] = number_of(Kind::Whole, rule.most);
  };
  switch (rule.kind) {
    case Kind::Text:
    case Kind::Lines:
      out["type"] = "string";
      add_length(out);
      break;
    case Kind::Texts:
      out = {{"type", "array"}, {"maxItems", rule.most_items}, {"items", {{"type", "string"}}}};
      add_length(out["items"]);
      break;
    case Kind::Whole:
    case Kind::Number:
      out["type"] = rule.kind == Kind::Whole ? "integer" : "number";
      out["minimum"] = number_of(rule.kind, rule.least);
      if (rule.most != kNoLimit) out["maximum"] = number_of(rule.kind, rule.most);
      if (rule.usual) out["default"] = number_of(rule.kind, *rule.usual);
      break;
    case Kind::Flag:
      out["type"] = "boolean";
      if (rule.usual) out["default"] = *rule.usual != 0;
      break;
    case Kind::Word: {
      const std::vector<std::string> words = words_of(rule);
      out = {{"type", "string"}, {"enum", words}};
      if (rule.usual) out["default"] = words[static_cast<std::size_t>(*rule.usual)];
      break;
    }
    case Kind::Time:
    case Kind::Other:
      out["type"] = "string";
      break;
  }
  return out;
}

Json schema_of(const Body& body) {
  Json out{{"type", "object"}};
  if (!body.description.empty()) out["description"] = body.description;
  Json required = Json::array(), properties = Json::object();
  for (const InputRule& rule : body.fields) {
    if (rule.is_required) required.push_back(rule.name);
    Json field = bare_schema(rule);
    if (!rule.description.empty()) field["description"] = rule.description;
    properties[std::string(rule.name)] = std::move(field);
  }
  if (!required.empty()) out["required"] = std::move(required);
  out["properties"] = std::move(properties);
  out["additionalProperties"] = false;
  if (body.least_fields > 0) out["minProperties"] = body.least_fields;
  out["example"] = Json::parse(body.example);
  return out;
}

/// The schema of the page of a list: "JobPage" of "Job".
Json page_schema(std::string_view name) {
  const std::string_view item = name.substr(0, name.size() - std::string_view("Page").size());
  return {{"type", "object"},
          {"required", {"items", "next_cursor"}},
          {"properties",
           {{"items", {{"type", "array"}, {"items", reference("schemas", item)}}},
            {"next_cursor", {{"type", {"string", "null"}}}}}}};
}

/// "{id}" and its like in a path.
Json path_parameters(std::string_view path) {
  Json out = Json::array();
  for (std::size_t at = path.find('{'); at != std::string_view::npos; at = path.find('{', at + 1)) {
    const std::string_view name = path.substr(at + 1, path.find('}', at) - at - 1);
    Json schema{{"type", "string"}};
    if (name == "k") schema = {{"type", "integer"}, {"minimum", 1}};
    if (name == "name") schema = {{"enum", handle::design_file_names()}};
    out.push_back({{"name", name}, {"in", "path"}, {"required", true}, {"schema", schema}});
  }
  return out;
}

Json query_parameter(const Route& route, std::string_view name) {
  InputRule rule = query_rule(name);
  if (name == "limit") rule.usual = route.usual_page_items;
  Json out{{"name", name}, {"in", "query"}};
  if (!rule.description.empty()) out["description"] = rule.description;
  out["schema"] = bare_schema(rule);
  return out;
}

std::string_view match_parameter(MatchRule match) {
  switch (match) {
    case MatchRule::None:
      return {};
    case MatchRule::Required:
      return "IfMatch";
    case MatchRule::OrAny:
      return "IfMatchOrAny";
    case MatchRule::OrNew:
      return "IfMatchOrNew";
    case MatchRule::Allowed:
      return "IfMatchAllowed";
  }
  return {};
}

Json preview_key_parameter() {
  return {
      {"name", "Preview-Key"},
      {"in", "header"},
      {"required", false},
      {"description",
       fmt::format("your own key, one per open page: {} to {} visible ASCII characters",
                   kLeastKeyCharacters, kMostKeyCharacters)},
      {"schema",
       {{"type", "string"},
        {"pattern", fmt::format("^[!-~]{{{},{}}}$", kLeastKeyCharacters, kMostKeyCharacters)}}}};
}

Json parameters_of(const Route& route) {
  Json out = path_parameters(route.path);
  for (const std::string& name : words_of(route.query)) out.push_back(query_parameter(route, name));
  const auto add = [&out](std::string_view name) {
    if (!name.empty()) out.push_back(reference("parameters", name));
  };
  add(match_parameter(route.match));
  if (route.match == MatchRule::OrNew) add("IfNoneMatchNew");
  if (route.is_cached) add("IfNoneMatch");
  if (route.parameter == "Preview-Key")
    out.push_back(preview_key_parameter());
  else
    add(route.parameter);
  if (route.key != KeyRule::None) add(route.key == KeyRule::Required ? "Key" : "KeyAllowed");
  return out;
}

Json body_of(const Route& route) {
  Json content = Json::object();
  for (const std::string_view type : upload_types(route.body))
    content[std::string(type)] = Json::object();
  if (route.takes != nullptr) content = content_of(route.takes->schema);
  return {{"required", route.takes == nullptr || !route.takes->is_optional}, {"content", content}};
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return out;
}

/// "postDevicesIdTestCut" of POST /v1/devices/{id}/actions/test-cut.
std::string operation_id(const Route& route) {
  std::string out = lower(name_of(route.method));
  std::string_view path = route.path == "/" ? "/page" : route.path;
  while (!path.empty()) {
    path.remove_prefix(1);
    const std::string_view part = path.substr(0, path.find('/'));
    path.remove_prefix(part.size());
    if (part == "v1" || part == "actions") continue;
    bool begins = true;
    for (const char c : part) {
      const bool is_letter = c >= 'a' && c <= 'z';
      if (is_letter) out += begins ? static_cast<char>(c - 'a' + 'A') : c;
      begins = !is_letter;
    }
  }
  return out;
}

Json operation_of(const Route& route) {
  const bool is_open = route.access.is_open();
  Json out{{"operationId", operation_id(route)}, {"summary", route.summary}};
  if (!route.details.empty()) out["description"] = route.details;
  out["x-popcut-role"] = is_open ? "everyone" : name_of(route.access.role());
  if (is_open) out["security"] = Json::array();
  if (Json parameters = parameters_of(route); !parameters.empty())
    out["parameters"] = std::move(parameters);
  if (route.body != BodyRule::None) out["requestBody"] = body_of(route);
  out["responses"] = responses_of(route);
  return out;
}

Json responses() {
  Json out = Json::object();
  for (const ErrorResponse& error : kErrors) {
    Json one{
        {"description", error.description},
        {"content", {{"application/problem+json", {{"schema", reference("schemas", "Problem")}}}}}};
    if (!error.header.empty())
      one["headers"] = {{std::string(error.header), {{"schema", {{"type", error.header_type}}}}}};
    out[std::string(error.name)] = std::move(one);
  }
  return out;
}

Json types(const char* type) { return Json::array({type, "string"}); }

/// The numbers that an option may have, and its default if it has one.
void add_range(const PlanOption& option, Json& schema) {
  const auto number = [&](double value) -> Json {
    if (option.kind == PlanKind::Whole) return static_cast<std::int64_t>(value);
    return value;
  };
  schema["type"] = types(option.kind == PlanKind::Whole ? "integer" : "number");
  schema["minimum"] = number(option.least);
  schema["maximum"] = number(option.most);
  const std::vector<double> usual = option.numbers(PlanOptions{});
  if (!usual.empty()) schema["default"] = number(usual.front());
  if (!option.unit.empty())
    schema["description"] = fmt::format("{} ({})", option.help, option.unit);
}

/// What a request may give for an option. Numbers and flags may be texts too.
Json schema_of(const PlanOption& option) {
  Json schema{{"type", "string"}, {"description", option.help}};
  switch (option.kind) {
    case PlanKind::Flag:
      schema["type"] = types("boolean");
      schema["default"] = false;
      break;
    case PlanKind::Number:
    case PlanKind::Whole:
      add_range(option, schema);
      break;
    case PlanKind::Lengths:
      schema["type"] = types("number");
      break;
    case PlanKind::Word:
      schema["enum"] = option.words;
      if (std::find(option.words.begin(), option.words.end(), option.usual) != option.words.end())
        schema["default"] = option.usual;
      break;
    case PlanKind::Text:
      if (!option.usual.empty()) schema["default"] = option.usual;
      break;
    case PlanKind::Place:
      break;
  }
  return schema;
}

Json plan_options_schema() {
  Json properties = Json::object();
  for (const PlanOption& option : plan_option_table()) {
    if (option.of_request) continue;
    properties[std::string(option.name)] = schema_of(option);
    if (option.opposite.empty()) continue;
    properties[std::string(option.opposite)] = {
        {"type", types("boolean")},
        {"description", fmt::format("The opposite of {}", option.name)},
        {"default", true}};
  }
  return Json{{"type", "object"},
              {"description",
               "The options of 'popcut plan', without their dashes. A list is a text with commas."},
              {"maxProperties", 32},
              {"properties", properties},
              {"additionalProperties", false}};
}

/// The schemas that routes need and openapi.json does not have: of bodies, and of pages of lists.
void add_schemas(Json& schemas) {
  schemas["PlanOptions"] = plan_options_schema();
  for (const Route& route : routes()) {
    if (route.takes != nullptr && !route.takes->is_in_source)
      schemas[std::string(route.takes->schema)] = schema_of(*route.takes);
    for (const std::string& name : words_of(route.gives.content))
      if (name.ends_with("Page") && !schemas.contains(name)) schemas[name] = page_schema(name);
  }
}

}  // namespace

std::string_view openapi_json() {
  static const std::string kText = [] {
    Json document = Json::parse(openapi_source());
    for (const Route& route : routes())
      document["paths"][std::string(route.path)][lower(name_of(route.method))] =
          operation_of(route);
    document["components"]["responses"] = responses();
    add_schemas(document["components"]["schemas"]);
    return document.dump();
  }();
  return kText;
}

}  // namespace popcut::daemon::http
