// SPDX-License-Identifier: MIT
#include "tests/support/api_generator.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "tests/support/json_schema.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing {

using daemon::RawConnection;
using daemon::WireResponse;
using nlohmann::json;

namespace {

constexpr std::array<const char*, 4> kRoles{"viewer", "submitter", "operator", "admin"};
constexpr int kRefreshEach = 100;

int rank_of(const std::string& role) {
  for (std::size_t i = 0; i < kRoles.size(); ++i)
    if (role == kRoles[i]) return static_cast<int>(i);
  return role == "socket" ? 3 : -1;  // this process is an admin there
}

std::string percent_coded(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || c == '.' || c == '~' || c == ':';
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

// Which list an id of this name is from.
std::string pool_of(const std::string& name, const std::string& route) {
  if (name == "id") {
    for (const char* kind : {"jobs", "designs", "plans", "devices", "materials", "tokens",
                             "sessions", "assets", "searches"})
      if (route.starts_with(std::string("/v1/") + kind)) return kind;
    return "";
  }
  if (name == "job" || name == "before") return "jobs";
  for (const char* kind : {"design", "plan", "device", "material", "token", "session", "asset"})
    if (name == kind) return std::string(kind) + "s";
  return "";
}

}  // namespace

ApiGenerator::ApiGenerator(std::string socket, std::uint16_t port, std::uint64_t seed)
    : socket_(std::move(socket)), port_(port), random_(seed), caller_(socket_) {
  operations_ = all_calls(caller_);
  set_up();
}

int ApiGenerator::whole(int low, int high) {
  return low + static_cast<int>(random_() % static_cast<std::uint64_t>(high - low + 1));
}

bool ApiGenerator::chance(double probability) { return whole(0, 9999) < probability * 10000; }

WireResponse ApiGenerator::send(const Made& made) {
  RawConnection connection = made.role == "socket" ? RawConnection(socket_) : RawConnection(port_);
  connection.send(made.bytes);
  return connection.receive(60, made.is_head);
}

// Asks as an admin, outside of what is judged.
void ApiGenerator::set_up() {
  for (const char* role : kRoles) static_cast<void>(bearer(role));
  const auto upload = [&](const std::string& route, const std::string& type,
                          const std::string& body) {
    RawConnection connection(socket_);
    connection.send(fmt::format(
        "POST {} HTTP/1.1\r\nHost: a\r\nContent-Type: {}\r\nContent-Length: {}\r\n\r\n{}", route,
        type, body.size(), body));
    static_cast<void>(connection.receive());
  };
  upload("/v1/designs?name=ball", "application/json",
         text_of_file(source_file("examples/unit.json")));
  upload("/v1/assets?name=a.csv", "text/csv", "1,2\n");
  refresh();
}

std::string ApiGenerator::bearer(const std::string& role) {
  if (role.empty() || role == "socket") return "";
  std::string& token = bearers_[role];
  if (!token.empty()) return token;
  const std::string body = json{{"name", role}, {"role", role}}.dump();
  RawConnection connection(socket_);
  connection.send(
      fmt::format("POST /v1/tokens HTTP/1.1\r\nHost: a\r\nContent-Type: "
                  "application/json\r\nContent-Length: {}\r\n\r\n{}",
                  body.size(), body));
  const json made = json::parse(connection.receive().body, nullptr, false);
  token = made.is_object() ? made.value("token", "") : "";
  return token;
}

void ApiGenerator::refresh() {
  for (const char* kind :
       {"jobs", "designs", "devices", "materials", "tokens", "sessions", "assets"}) {
    RawConnection connection(socket_);
    connection.send(fmt::format("GET /v1/{}?limit=200 HTTP/1.1\r\nHost: a\r\n\r\n", kind));
    const json page = json::parse(connection.receive().body, nullptr, false);
    if (!page.is_object() || !page.contains("items")) continue;
    std::vector<std::string>& pool = pools_[kind];
    pool.clear();
    if (pool_of("job", "") == kind) actions_.clear();
    for (const json& one : page["items"]) {
      if (one.contains("actions") && one.contains("rev"))
        for (const json& action : one.at("actions"))
          actions_.emplace_back(one.at("id"), action.get<std::string>());
      pool.push_back(one.at("id"));
      if (one.contains("rev")) revs_[one.at("id")] = one.at("rev");
      if (one.contains("plan") && one.at("plan").is_string()) {
        std::vector<std::string>& plans = pools_["plans"];
        const std::string plan = one.at("plan");
        if (std::find(plans.begin(), plans.end(), plan) == plans.end()) plans.push_back(plan);
      }
    }
    // Lists are in the order of ids, and what is new is more interesting.
    if (pool.size() > 40) pool.erase(pool.begin(), pool.end() - 40);
  }
  // Tokens that were deleted are made again.
  for (const char* role : kRoles) {
    Made made{.call = {}, .role = role, .bytes = {}};
    made.bytes = fmt::format(
        "GET /v1/meta HTTP/1.1\r\nHost: localhost:{}\r\nAuthorization: Bearer "
        "{}\r\n\r\n",
        port_, bearer(role));
    if (send(made).status == 401) bearers_[role].clear();
  }
}

std::string ApiGenerator::odd_text() {
  static const std::vector<std::string> texts{"",
                                              "x",
                                              "../../etc/passwd",
                                              "01JD0000000000000000000001",
                                              "sha256-" + std::string(64, '0'),
                                              "sha256-" + std::string(63, '0'),
                                              std::string(121, 'n'),
                                              std::string(5000, 'n'),
                                              "\xF0\x9F\x93\x90 \xD8\xA7",
                                              "a\x01b",
                                              "a\nb",
                                              std::string("a\0b", 3),
                                              "'; DROP TABLE job; --",
                                              "%s%n",
                                              "<img src=x onerror=a()>",
                                              "\xC2\x85",
                                              "\xE2\x80\xAE",
                                              "-1",
                                              "0",
                                              "1e308",
                                              "9223372036854775808",
                                              "null",
                                              "2300-01-01",
                                              "9999-12-31T23:59:59Z",
                                              "1969-01-01",
                                              "2026-11-21T10:00:00+01:00",
                                              "sim:cameo3",
                                              "paper-220",
                                              "*",
                                              "\"1\""};
  return one_of(texts);
}

json ApiGenerator::odd_value() {
  switch (whole(0, 9)) {
    case 0:
      return nullptr;
    case 1:
      return whole(0, 1) == 1;
    case 2:
      return whole(-3, 3);
    case 3:
      return std::numeric_limits<std::int64_t>::max();
    case 4:
      return 1e308;
    case 5:
      return 1.5;
    case 6:
      return json::array({1, "a", json::object()});
    case 7:
      return json{{"a", json{{"b", 1}}}};
    case 8:
      return std::numeric_limits<std::uint64_t>::max();
    default: {
      const std::string text = odd_text();
      // JSON that is no UTF-8 is made of bytes, not of values.
      return json(text).dump(-1, ' ', false, json::error_handler_t::replace).empty() ? json()
                                                                                     : json(text);
    }
  }
}

std::string ApiGenerator::pooled(const std::string& name, const std::string& route) {
  const std::string kind = pool_of(name, route);
  const auto found = pools_.find(kind);
  if (found != pools_.end() && !found->second.empty() && !chance(0.15))
    return one_of(found->second);
  return chance(0.5) ? "01JD0000000000000000000001" : odd_text();
}

json ApiGenerator::value_of(const json& given, const std::string& name, const std::string& route,
                            int depth) {
  const json& schema = JsonSchema(caller_.document()).resolved(given);
  if (!pool_of(name, route).empty() && name != "id") return pooled(name, route);
  if (schema.contains("enum")) return one_of(schema.at("enum").get<std::vector<json>>());
  if (schema.contains("example") && chance(0.2)) return schema.at("example");
  std::string type = "object";
  if (schema.contains("type"))
    type = schema.at("type").is_array() ? one_of(schema.at("type").get<std::vector<std::string>>())
                                        : schema.at("type").get<std::string>();
  if (type == "boolean") return chance(0.5);
  if (type == "null") return nullptr;
  if (type == "integer" || type == "number") {
    const double low = schema.value("minimum", 0.0), high = schema.value("maximum", 100.0);
    if (chance(0.4)) return type == "integer" ? json(static_cast<std::int64_t>(low)) : json(low);
    if (chance(0.1)) return type == "integer" ? json(static_cast<std::int64_t>(high)) : json(high);
    const int most = static_cast<int>(std::min(high, low + 3));
    return whole(static_cast<int>(low), std::max(most, static_cast<int>(low)));
  }
  if (type == "string") {
    const auto least = schema.value("minLength", 0), most = schema.value("maxLength", 40);
    return std::string(static_cast<std::size_t>(std::max(least, std::min(most, whole(0, 12)))),
                       'w');
  }
  if (type == "array") {
    json list = json::array();
    if (schema.contains("items") && depth < 4)
      for (int k = whole(0, 2); k > 0; --k)
        list.push_back(value_of(schema.at("items"), "", route, depth + 1));
    return list;
  }
  json object = json::object();
  const json required = schema.value("required", json::array());
  const json properties = schema.value("properties", json::object());
  const double often = properties.size() > 12 ? 0.1 : 0.4;
  for (const auto& [key, property] : properties.items()) {
    const bool needed = std::find(required.begin(), required.end(), key) != required.end();
    if (needed || chance(often)) object[key] = value_of(property, key, route, depth + 1);
  }
  if (schema.value("minProperties", 0) > static_cast<int>(object.size()) && !properties.empty()) {
    const auto first = properties.begin();
    object[first.key()] = value_of(first.value(), first.key(), route, depth + 1);
  }
  return object;
}

void ApiGenerator::mutate(json& value, int depth) {
  if (value.is_object() && !value.empty() && depth < 3 && chance(0.7)) {
    auto member = value.begin();
    std::advance(member, whole(0, static_cast<int>(value.size()) - 1));
    if (chance(0.2)) {
      value.erase(member);
    } else {
      mutate(member.value(), depth + 1);
    }
    return;
  }
  if (value.is_object() && chance(0.5)) {
    value[chance(0.3) ? "constructor" : "desing"] = odd_value();
    return;
  }
  value = odd_value();
}

std::string ApiGenerator::body_of(Made& made, std::string& type) {
  const json& operation = caller_.operation(made.call);
  if (!operation.contains("requestBody")) return chance(0.02) ? "{}" : "";
  const json& content = operation.at("requestBody").at("content");
  if (!content.contains("application/json") || !content.at("application/json").contains("schema")) {
    // An upload. What a planner must look at takes its time.
    std::vector<std::string> types;
    for (const auto& [name, ignored] : content.items()) types.push_back(name);
    type = one_of(types);
    made.is_valid_body = false;
    if (made.call.route == "/v1/assets") return fmt::format("asset {}", whole(0, 30));
    type = chance(0.8) ? "application/json" : type;
    if (chance(0.7)) return text_of_file(source_file("examples/unit.json"));
    return chance(0.5) ? "" : odd_text();
  }
  type = "application/json";
  const json& schema = content.at("application/json").at("schema");
  json value = value_of(schema, "", made.call.route, 0);
  if (made.call.route == "/v1/session" && chance(0.5) && !pools_["words"].empty())
    value = json{{"one_shot", one_of(pools_["words"])}};
  if (chance(0.3)) mutate(value, 0);
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  const json sent = json::parse(text, nullptr, false);
  const json& whole_schema = JsonSchema(caller_.document()).resolved(schema);
  // What the schema leaves open may be anything.
  made.is_valid_body = !whole_schema.contains("additionalProperties") ||
                       JsonSchema(caller_.document()).faults(sent, schema).empty();
  if (chance(0.03)) {
    made.is_valid_body = false;
    switch (whole(0, 4)) {
      case 0:
        return text.substr(0, text.size() / 2);
      case 1:
        return std::string(200, '[');
      case 2:
        return "\xFF\xFE{}";
      case 3:
        return text + "x";
      default:
        return "{\"sheet\":1,\"sheet\":2,\"desing\":1}";
    }
  }
  return text;
}

std::string ApiGenerator::query_of(const json& operation, const std::string& route) {
  std::string query;
  for (const json& given : operation.value("parameters", json::array())) {
    const json& parameter = JsonSchema(caller_.document()).resolved(given);
    if (parameter.at("in") != "query" || !chance(0.3)) continue;
    const std::string name = parameter.at("name");
    std::string value;
    if (chance(0.7)) {
      const json made = value_of(parameter.value("schema", json::object()), name, route, 0);
      value = made.is_string() ? made.get<std::string>() : made.dump();
    } else {
      value = odd_text();
    }
    query += (query.empty() ? "?" : "&") + percent_coded(name) + "=" + percent_coded(value);
  }
  if (chance(0.02)) query += (query.empty() ? "?" : "&") + percent_coded(odd_text()) + "=1";
  if (chance(0.005)) query += "%zz";
  return query;
}

std::string ApiGenerator::headers_of(const Made& made, const json& operation,
                                     const std::string& id) {
  std::string text;
  for (const json& given : operation.value("parameters", json::array())) {
    const json& parameter = JsonSchema(caller_.document()).resolved(given);
    if (parameter.at("in") != "header") continue;
    const std::string name = parameter.at("name");
    if (name == "Idempotency-Key" && !chance(0.05)) {
      if (keys_.empty() || chance(0.85))
        keys_.push_back(fmt::format("generated-key-{:08}", ++number_));
      text += "Idempotency-Key: " +
              (chance(0.02)  ? "short"
               : chance(0.9) ? keys_.back()
                             : one_of(keys_)) +
              "\r\n";
    }
    if (name == "If-Match" && !chance(0.05)) {
      const auto rev = revs_.find(id);
      std::string value = rev == revs_.end() ? "\"1\"" : fmt::format("\"{}\"", rev->second);
      if (chance(0.1))
        value = std::vector<std::string>{"*",       "\"999\"", "7",
                                         "W/\"1\"", "\"-1\"",  "\"99999999999999999999\""}
                    .at(static_cast<std::size_t>(whole(0, 5)));
      text += "If-Match: " + value + "\r\n";
    }
    if (name == "If-None-Match" && chance(0.4))
      text += std::string("If-None-Match: ") + (chance(0.7) ? "*" : "\"1\"") + "\r\n";
  }
  if (chance(0.02)) text += "Content-Encoding: gzip\r\n";
  if (chance(0.01)) text += "Origin: http://evil.example\r\n";
  if (chance(0.01)) text += "Sec-Fetch-Site: cross-site\r\n";
  if (chance(0.01)) text += "Expect: tea\r\n";
  if (chance(0.01)) text += "X-Forwarded-For: 10.0.0.1\r\n";
  if (chance(0.005)) text += "X-Filler: " + std::string(9000, 'x') + "\r\n";
  if (made.call.method == "GET" && chance(0.02)) text += "If-None-Match: \"1\", \"2\"\r\n";
  return text;
}

ApiGenerator::Made ApiGenerator::make() {
  static const std::vector<std::string> roles{"",         "viewer", "submitter", "operator",
                                              "operator", "admin",  "socket",    "socket"};
  // Of what takes a planner or the whole database, less than of the rest.
  ContractCall call = one_of(operations_);
  while ((call.route.starts_with("/v1/db/") ||
          (call.method == "POST" &&
           (call.route == "/v1/designs" || call.route == "/v1/assets/{id}/search"))) &&
         !chance(0.15))
    call = one_of(operations_);
  std::string id = pooled("id", call.route);
  if (!actions_.empty() && chance(0.15)) {
    const auto& [of, action] = one_of(actions_);
    call.method = "POST";
    call.route = "/v1/jobs/{id}/actions/" + action;
    id = of;
  }
  Made made{.call = call, .role = one_of(roles), .bytes = {}};
  const json& operation = caller_.operation(call);
  if (call.route.starts_with("/v1/materials") && call.method == "PUT" && chance(0.7))
    id = fmt::format("mine-{}", whole(0, 5));
  std::string target = call.route;
  for (const auto& [name, value] :
       {std::pair<std::string, std::string>{"{id}", id.empty() ? "x" : id},
        {"{k}", chance(0.8) ? "1" : std::to_string(whole(-1, 10001))}})
    if (const std::size_t at = target.find(name); at != std::string::npos)
      target.replace(at, name.size(), percent_coded(value));
  std::string type;
  made.body = body_of(made, type);
  std::string job = id;
  if (call.route.starts_with("/v1/queue/")) {
    const json sent = json::parse(made.body, nullptr, false);
    if (sent.is_object() && sent.contains("job") && sent["job"].is_string()) job = sent["job"];
  }
  made.is_head = call.method == "GET" && chance(0.1);
  const std::string host = chance(0.005) ? "evil.example" : fmt::format("localhost:{}", port_);
  made.bytes = fmt::format("{} {}{} HTTP/1.1\r\nHost: {}\r\nAccept: application/json\r\n",
                           made.is_head ? "HEAD" : call.method, target,
                           query_of(operation, call.route), host);
  if (const std::string token = bearer(made.role); !token.empty())
    made.bytes += "Authorization: Bearer " + token + "\r\n";
  else if (made.role.empty() && chance(0.3))
    made.bytes +=
        "Authorization: Bearer pc_01JD0000000000000000000001_" + std::string(43, 'A') + "\r\n";
  made.bytes += headers_of(made, operation, job);
  if (!type.empty()) made.bytes += "Content-Type: " + (chance(0.02) ? "text/plain" : type) + "\r\n";
  if (!made.body.empty()) {
    if (chance(0.05)) {
      made.bytes += "Transfer-Encoding: chunked\r\n\r\n" +
                    fmt::format("{:x}\r\n{}\r\n0\r\n\r\n", made.body.size(), made.body);
      return made;
    }
    made.bytes += fmt::format("Content-Length: {}\r\n", made.body.size());
  }
  made.bytes += "\r\n" + made.body;
  return made;
}

void ApiGenerator::judge(const Made& made, const WireResponse& response) {
  const std::string name = made.call.method + " " + made.call.route;
  ++statuses_[response.status];
  produced_.insert(fmt::format("{} {}", name, response.status));
  asked_.insert(name + " " + made.role);
  const auto wrong = [&](const std::string& what) {
    int& count =
        faults_[fmt::format("{} as {:?} gave {}: {}", name, made.role, response.status, what)];
    if (count++ == 0)
      faults_[fmt::format("   {:?} -> {:?}", made.bytes.substr(0, 600),
                          response.body.substr(0, 300))] = 1;
  };
  if (response.status == 0) return wrong("no answer");
  if (response.status >= 500 && response.status != 503) wrong("a fault of popcutd itself");
  for (const std::string& fault : caller_.faults_of(made.call, response, made.is_head))
    wrong(fault);
  // Roles hold, whatever else is in the request.
  const json& operation = caller_.operation(made.call);
  const std::string needed = operation.at("x-popcut-role");
  if (needed != "everyone" && rank_of(made.role) < rank_of(needed)) {
    const std::set<int> allowed = made.role.empty() ? std::set<int>{400, 401, 413, 421, 429}
                                                    : std::set<int>{400, 401, 403, 413, 421, 429};
    if (!allowed.contains(response.status)) wrong("the role is not enough for this answer");
  }
  if (needed != "everyone" && rank_of(made.role) >= rank_of(needed) && response.status == 401 &&
      made.role == "socket")
    wrong("the user of the socket is known");
  const bool has_schema =
      operation.contains("requestBody") &&
      operation.at("requestBody").at("content").contains("application/json") &&
      operation.at("requestBody").at("content").at("application/json").contains("schema");
  if (has_schema && !made.is_valid_body && response.status < 300)
    wrong("took a body that the schema forbids");
}

// What the answers tell, for later requests.
void ApiGenerator::learn(const Made& made, const WireResponse& response) {
  if (response.status == 401 && !made.role.empty()) bearers_[made.role].clear();
  if (response.status >= 300 || made.is_head) return;
  const json body = json::parse(response.body, nullptr, false);
  if (!body.is_object()) return;
  const auto keep = [&](const std::string& kind, const std::string& id) {
    std::vector<std::string>& pool = pools_[kind];
    if (std::find(pool.begin(), pool.end(), id) == pool.end()) pool.push_back(id);
    if (pool.size() > 60) pool.erase(pool.begin());
  };
  if (body.contains("one_shot") && body["one_shot"].is_string()) keep("words", body["one_shot"]);
  if (made.call.route == "/v1/designs/{id}/plan" && body.contains("id")) keep("plans", body["id"]);
  if (made.call.route == "/v1/assets/{id}/search" && body.contains("id"))
    keep("searches", body["id"]);
  if (made.call.route == "/v1/jobs" && body.contains("id")) keep("jobs", body["id"]);
  if (body.contains("id") && body["id"].is_string() && body.contains("rev"))
    revs_[body["id"]] = body["rev"];
}

void ApiGenerator::run(int count) {
  for (int k = 0; k < count; ++k) {
    if (k % kRefreshEach == kRefreshEach - 1) refresh();
    const Made made = make();
    const WireResponse response = send(made);
    judge(made, response);
    learn(made, response);
  }
}

}  // namespace popcut::testing
