// SPDX-License-Identifier: MIT
// The description of the API, as it is made from the routes, the bodies and openapi.json.
#include <functional>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/http/api/input.hpp"
#include "daemon/http/api/openapi.hpp"
#include "daemon/http/api/routes.hpp"
#include "tests/support/json_schema.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace openapi_test {

using namespace popcut::daemon::http;
using nlohmann::json;
using popcut::JsonSchema;
using popcut::testing::source_file;
using popcut::testing::text_of_file;

namespace {

const json& document() {
  static const json value = json::parse(openapi_json());
  return value;
}

}  // namespace

TEST_CASE("the description of a route says all that its row in the table says",
          "[daemon][http][openapi]") {
  json arm = document().at("paths").at("/v1/jobs/{id}/actions/arm").at("post");
  std::set<std::string> statuses;
  for (const auto& [status, ignored] : arm.at("responses").items()) statuses.insert(status);
  CHECK(statuses == std::set<std::string>{"200", "400", "401", "403", "404", "409", "412", "413",
                                          "415", "421", "422", "428", "429", "500", "503", "507"});
  CHECK(arm.at("responses").at("409") == json{{"$ref", "#/components/responses/Conflict"}});
  CHECK(arm.at("responses").at("200") == json::parse(R"({
    "description": "success",
    "headers": {
      "ETag": {"schema": {"type": "string"}},
      "Idempotent-Replayed": {
        "description": "true: the response to the first request with this key",
        "schema": {"type": "string"}
      }
    },
    "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Job"}}}
  })"));
  arm.erase("responses");
  CHECK(arm == json::parse(R"({
    "operationId": "postJobsIdArm",
    "summary": "Arm a sheet: confirm that the blank is loaded; valid for ten minutes",
    "x-popcut-role": "operator",
    "parameters": [
      {"name": "id", "in": "path", "required": true, "schema": {"type": "string"}},
      {"$ref": "#/components/parameters/IfMatch"},
      {"$ref": "#/components/parameters/Key"}
    ],
    "requestBody": {
      "required": true,
      "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Arm"}}}
    }
  })"));
  json page = document().at("paths").at("/").at("get");
  CHECK(page.at("security") == json::array());
  CHECK(page.at("responses").size() == 6);
  CHECK(page.at("responses").at("304") == json{{"description", "not modified"}});
}

TEST_CASE("the description of a body says all that its table of fields says",
          "[daemon][http][openapi]") {
  CHECK(document().at("components").at("schemas").at("TokenCreate") == json::parse(R"({
    "type": "object",
    "required": ["name", "role"],
    "properties": {
      "name": {"type": "string", "minLength": 1, "maxLength": 120},
      "role": {"$ref": "#/components/schemas/Role"},
      "lifetime_s": {"type": "integer", "minimum": 60, "maximum": 316224000}
    },
    "additionalProperties": false,
    "example": {"name": "script", "role": "submitter"}
  })"));
}

TEST_CASE("all that the description refers to is in it", "[daemon][http][openapi]") {
  std::set<std::string> used, operations;
  const std::function<void(const json&)> visit = [&](const json& value) {
    if (value.is_object() && value.contains("$ref")) {
      const std::string reference = value.at("$ref");
      CAPTURE(reference);
      CHECK(document().contains(json::json_pointer(reference.substr(1))));
      used.insert(reference);
    }
    if (value.is_object() && value.contains("operationId"))
      CHECK(operations.insert(value.at("operationId")).second);
    if (value.is_structured())
      for (const json& below : value) visit(below);
  };
  visit(document());
  CHECK(operations.size() == routes().size());
  for (const auto& [name, ignored] : document().at("components").at("schemas").items())
    CHECK(used.count("#/components/schemas/" + name) == 1);
}

TEST_CASE("the example of each body follows its schema", "[daemon][http][openapi]") {
  for (const Route& route : routes()) {
    if (route.takes == nullptr) continue;
    CAPTURE(route.path);
    const json& schema =
        document().at("components").at("schemas").at(std::string(route.takes->schema));
    for (const std::string& fault : JsonSchema(document()).faults(schema.at("example"), schema))
      FAIL_CHECK(fault);
  }
}

TEST_CASE("the options of a plan are described with their limits and defaults",
          "[daemon][http][openapi]") {
  const json& options = document().at("/components/schemas/PlanOptions/properties"_json_pointer);
  CHECK(options.at("snap").at("default") == 0.05);
  CHECK(options.at("snap").contains("maximum"));
  CHECK_FALSE(options.at("overcut").contains("default"));
  CHECK(options.at("finish").contains("enum"));
}

TEST_CASE("the kinds of attention are those that docs/api.md explains", "[daemon][http][openapi]") {
  const std::string page = text_of_file(source_file("docs/api.md"));
  const std::size_t begin = page.find("`attention` says what a person must do");
  REQUIRE(begin != std::string::npos);
  std::set<std::string> explained;
  std::istringstream lines(page.substr(begin, page.find("\n## ", begin) - begin));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("| `") && !line.starts_with("| `kind`"))
      explained.insert(line.substr(3, line.find('`', 3) - 3));
  const json& kinds =
      document().at("/components/schemas/Attention/properties/kind/enum"_json_pointer);
  CHECK(explained == kinds.get<std::set<std::string>>());
}

}  // namespace openapi_test
