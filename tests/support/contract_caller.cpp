// SPDX-License-Identifier: MIT
#include "tests/support/contract_caller.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/json_schema.hpp"

namespace popcut::testing {

using daemon::RawConnection;
using daemon::WireResponse;
using nlohmann::json;

namespace {

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

// A part of a path.
std::string encoded(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '/' ? std::string("%2F") : std::string(1, c);
  return out;
}

std::string new_key() {
  static int number = 0;
  return fmt::format("live-contract-{:08}", ++number);
}

}  // namespace

ContractCaller::ContractCaller(std::string socket) : socket_(std::move(socket)) {
  const WireResponse served =
      send(RawConnection(socket_), "GET /v1/openapi.json HTTP/1.1\r\nHost: popcut\r\n\r\n");
  document_ = json::parse(served.body);
}

WireResponse ContractCaller::send(RawConnection connection, const std::string& bytes) const {
  connection.send(bytes);
  return connection.receive(60, bytes.rfind("HEAD ", 0) == 0);
}

const json& ContractCaller::operation(const ContractCall& call) const {
  return document_.at("paths").at(call.route).at(lower(call.method));
}

std::string ContractCaller::body_of(const ContractCall& call, std::string& type) const {
  const json& operation = this->operation(call);
  if (!operation.contains("requestBody")) return call.body.value_or("");
  const json& content = operation.at("requestBody").at("content");
  type = content.contains("application/json") ? "application/json" : content.begin().key();
  if (call.body) return *call.body;
  const json& schema = content.at(type).value("schema", json::object());
  const json& whole = JsonSchema(document_).resolved(schema);
  return whole.contains("example") ? whole.at("example").dump() : "{}";
}

std::string ContractCaller::request(const ContractCall& call, const std::string& host,
                                    const std::string& more) const {
  std::string target = call.route;
  for (const auto& [name, value] : call.holes)
    if (const std::size_t at = target.find("{" + name + "}"); at != std::string::npos)
      target.replace(at, name.size() + 2, encoded(value));
  std::string type;
  const std::string body = body_of(call, type);
  std::string text =
      fmt::format("{} {}{} HTTP/1.1\r\nHost: {}\r\n", call.method, target, call.query, host);
  const json parameters = operation(call).value("parameters", json::array());
  for (const json& parameter : parameters) {
    const json& one = JsonSchema(document_).resolved(parameter);
    if (one.at("name") == "Idempotency-Key" && call.keyed && one.value("required", false))
      text += "Idempotency-Key: " + new_key() + "\r\n";
    if (one.at("name") == "If-Match" && call.matched && !call.match.empty())
      text += "If-Match: " + call.match + "\r\n";
  }
  if (call.more.find("Content-Type:") == std::string::npos && !type.empty())
    text += "Content-Type: " + type + "\r\n";
  if (call.more.find("Content-Length:") == std::string::npos && !body.empty())
    text += fmt::format("Content-Length: {}\r\n", body.size());
  return text + call.more + more + "\r\n" + body;
}

WireResponse ContractCaller::ask(const ContractCall& call) {
  const WireResponse response = send(RawConnection(socket_), request(call, "popcut", ""));
  hold(call, response);
  return response;
}

WireResponse ContractCaller::ask_tcp(const ContractCall& call, std::uint16_t port,
                                     const std::string& token, const std::string& host) {
  const std::string name = host.empty() ? fmt::format("localhost:{}", port) : host;
  const std::string more = token.empty() ? "" : "Authorization: Bearer " + token + "\r\n";
  const WireResponse response = send(RawConnection(port), request(call, name, more));
  hold(call, response);
  return response;
}

void ContractCaller::note(const WireResponse& response) {
  if (!response.problem().empty()) problems_.insert(response.problem());
}

std::vector<std::string> ContractCaller::faults_of(const ContractCall& call,
                                                   const WireResponse& response,
                                                   bool is_head) const {
  const json& responses = operation(call).at("responses");
  const std::string status = std::to_string(response.status);
  if (!responses.contains(status)) return {"this status is not documented"};
  std::vector<std::string> faults;
  const JsonSchema schema(document_);
  const json& documented = schema.resolved(responses.at(status));
  const json headers = documented.value("headers", json::object());
  for (const char* name : {"ETag", "Location", "WWW-Authenticate", "Retry-After"})
    if (headers.contains(name) && response.headers.count(lower(name)) != 1)
      faults.push_back(fmt::format("the header {} is missing", name));
  if (!documented.contains("content")) {
    if (!response.body.empty()) faults.emplace_back("a body is not documented");
    return faults;
  }
  const auto found = response.headers.find("content-type");
  if (found == response.headers.end()) {
    faults.emplace_back("Content-Type is missing");
    return faults;
  }
  const std::string type = found->second.substr(0, found->second.find(';'));
  if (!documented.at("content").contains(type)) {
    faults.push_back(type + " is not documented");
    return faults;
  }
  const json& content = documented.at("content").at(type);
  if (is_head || type.find("json") == std::string::npos || !content.contains("schema"))
    return faults;
  const json body = json::parse(response.body, nullptr, false);
  if (body.is_discarded()) {
    faults.emplace_back("the body is no JSON");
    return faults;
  }
  for (const std::string& fault : schema.faults(body, content.at("schema")))
    faults.push_back(fault);
  return faults;
}

void ContractCaller::hold(const ContractCall& call, const WireResponse& response) {
  INFO(call.method << " " << call.route << call.query << " gave " << response.status << ": "
                   << response.body.substr(0, 400));
  produced_.insert({call.method + " " + call.route, response.status});
  note(response);
  for (const std::string& fault : faults_of(call, response, call.method == "HEAD"))
    FAIL_CHECK(fault);
}

json ContractCaller::get(const std::string& route,
                         const std::map<std::string, std::string>& holes) {
  const WireResponse response = ask(
      {.method = "GET", .route = route, .holes = holes, .more = "Accept: application/json\r\n"});
  INFO(route << ": " << response.body.substr(0, 300));
  CHECK(response.status == 200);
  return json::parse(response.body, nullptr, false);
}

std::set<ContractCaller::Pair> ContractCaller::documented() const {
  std::set<Pair> all;
  for (const auto& [route, operations] : document_.at("paths").items())
    for (const auto& [method, operation] : operations.items()) {
      std::string name = method;
      for (char& c : name) c = static_cast<char>(c - 'a' + 'A');
      for (const auto& [status, ignored] : operation.at("responses").items())
        all.insert({name + " " + route, std::stoi(status)});
    }
  return all;
}

void ContractCaller::add(const ContractCaller& other) {
  produced_.insert(other.produced_.begin(), other.produced_.end());
  problems_.insert(other.problems_.begin(), other.problems_.end());
}

std::vector<ContractCall> all_calls(const ContractCaller& caller) {
  std::vector<ContractCall> calls;
  for (const auto& [route, operations] : caller.document().at("paths").items())
    for (const auto& [method, ignored] : operations.items()) {
      ContractCall call{.method = method, .route = route, .more = "Accept: application/json\r\n"};
      for (char& c : call.method) c = static_cast<char>(c - 'a' + 'A');
      call.holes = {{"id", "01JD0000000000000000000001"},
                    {"k", "1"},
                    {"name", "cut.svg"},
                    {"file", "none.js"}};
      if (route.starts_with("/v1/session/pair/"))  // of no tablet
        call.body = route.ends_with("allow") ? R"({"code":"AAAAAA","role":"viewer"})"
                                             : R"({"secret":"none"})";
      if (route.starts_with("/v1/devices/")) call.holes["id"] = "sim:nowhere";
      if (route.starts_with("/v1/materials/")) call.holes["id"] = "nothing";
      calls.push_back(std::move(call));
    }
  return calls;
}

bool documents(const ContractCaller& caller, const ContractCall& call, int status) {
  return caller.operation(call).at("responses").contains(std::to_string(status));
}

}  // namespace popcut::testing
