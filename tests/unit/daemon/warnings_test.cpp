// SPDX-License-Identifier: MIT
#include "daemon/model/warnings.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace warnings_test {

using namespace popcut;
using namespace popcut::daemon;

TEST_CASE("warnings come back from their JSON as they were", "[daemon][warnings]") {
  const std::vector<Warning> all{
      {.code = "no_unit", .message = "a \"quoted\" word", .place = {}, .spoils = true},
      {.code = "layer_left_out", .message = "b", .place = {.source = "layer \"Fold\""}},
      {.code = "neck_narrow",
       .message = "c",
       .place = {.sheet = 3, .u_mm = 1.25, .v_mm = -2.0},
       .spoils = true}};
  const std::string json = warnings_json(all);
  CHECK(nlohmann::json::parse(json).size() == 3);
  const std::vector<Warning> back = warnings_from_json(json);
  CHECK(warnings_json(back) == json);
  REQUIRE(back.size() == 3);
  CHECK(back[0].message == all[0].message);
  CHECK_FALSE(back[0].place.is_known());
  CHECK(back[2].place.sheet == 3);
  CHECK(back[2].place.u_mm == 1.25);
  CHECK(spoiling_codes(back) == std::vector<std::string>{"no_unit", "neck_narrow"});
  CHECK(spoiling(back).size() == 2);
  CHECK(messages_of(back).at(1) == "b");
  CHECK(warnings_json({}) == "[]");
}

TEST_CASE("what a worker says as warnings is taken with care", "[daemon][warnings]") {
  CHECK(warnings_from_json("no JSON").empty());
  CHECK(warnings_from_json("{}").empty());
  const auto odd = warnings_from_json(
      R"([1, "text", {"code":"Two Words","message":5,"place":[1],"spoils":"yes"},
          {"code":"fine_1","message":"m","place":{"sheet":-4,"u_mm":"x"},"spoils":true}])");
  REQUIRE(odd.size() == 2);
  CHECK(odd[0].code == "note");
  CHECK(odd[0].message.empty());
  CHECK_FALSE(odd[0].spoils);
  CHECK(odd[1].code == "fine_1");
  CHECK_FALSE(odd[1].place.is_known());
  // Bytes that are no UTF-8 still make JSON.
  CHECK(nlohmann::json::accept(warnings_json({{.code = "a", .message = "\xFF"}})));
}

TEST_CASE("of many warnings those that spoil a cut are kept", "[daemon][warnings]") {
  std::vector<Warning> many(30, {.code = "dashed_line", .message = std::string(500, 'x')});
  many[29] = {.code = "no_unit", .message = "m", .place = {}, .spoils = true};
  shorten(many, 10, 300);
  REQUIRE(many.size() == 11);
  CHECK(many.front().code == "no_unit");
  CHECK(many[1].message.size() == 300);
  CHECK(many.back().message == "and 20 more");
}

TEST_CASE("codes that nobody accepted are left", "[daemon][warnings]") {
  using Codes = std::vector<std::string>;
  CHECK(codes_without({"a", "b", "c"}, {"b"}) == Codes{"a", "c"});
  CHECK(codes_without({"a", "b"}, {"b", "a", "z"}).empty());
  CHECK(codes_without({"a"}, {}) == Codes{"a"});
}

}  // namespace warnings_test
