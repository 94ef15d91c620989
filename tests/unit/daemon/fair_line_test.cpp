// SPDX-License-Identifier: MIT
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "daemon/planning/fair_line.hpp"

namespace fair_line_test {

using popcut::daemon::FairLine;

namespace {

bool anyone(const std::string&) { return true; }

std::vector<std::uint64_t> all_of(FairLine& line) {
  std::vector<std::uint64_t> ids;
  while (const auto place = line.next(anyone)) ids.push_back(place->id);
  return ids;
}

}  // namespace

TEST_CASE("principals take turns however much each of them asks for", "[daemon][previews]") {
  FairLine line(64, 16);
  for (std::uint64_t k = 1; k <= 10; ++k) CHECK(line.add({k, "ana", ""}).is_taken);
  CHECK(line.add({11, "ben", ""}).is_taken);
  CHECK(line.add({12, "cy", ""}).is_taken);
  CHECK(line.add({13, "ben", ""}).is_taken);
  CHECK(all_of(line) == std::vector<std::uint64_t>{1, 11, 12, 2, 13, 3, 4, 5, 6, 7, 8, 9, 10});
  // Whoever was served last waits for the others also when all come again.
  CHECK(line.add({20, "ana", ""}).is_taken);
  CHECK(line.add({21, "cy", ""}).is_taken);
  CHECK(all_of(line) == std::vector<std::uint64_t>{21, 20});
}

TEST_CASE("a newer one of the same principal and key takes the place of what waits",
          "[daemon][previews]") {
  FairLine line(64, 16);
  CHECK(line.add({1, "ana", "page one"}).is_taken);
  CHECK(line.add({2, "ana", "page two"}).is_taken);
  CHECK(line.add({3, "ben", "page one"}).is_taken);
  const auto added = line.add({4, "ana", "page one"});
  CHECK(added.is_taken);
  CHECK(added.replaced == 1);
  CHECK_FALSE(line.add({5, "ana", ""}).replaced);
  CHECK_FALSE(line.add({6, "ana", ""}).replaced);  // without a key nothing is replaced
  CHECK(line.size() == 5);
  CHECK(all_of(line) == std::vector<std::uint64_t>{4, 3, 2, 5, 6});
}

TEST_CASE("a line is full for one principal before it is for all", "[daemon][previews]") {
  FairLine line(6, 4);
  std::uint64_t id = 0;
  for (int k = 0; k < 4; ++k) CHECK(line.add({++id, "ana", ""}).is_taken);
  CHECK_FALSE(line.add({++id, "ana", ""}).is_taken);
  CHECK(line.add({++id, "ben", ""}).is_taken);
  CHECK(line.add({++id, "ben", "key"}).is_taken);
  CHECK_FALSE(line.add({++id, "cy", ""}).is_taken);
  CHECK(line.add({++id, "ben", "key"}).is_taken);  // it takes no further place
  CHECK(line.remove(1));
  CHECK_FALSE(line.remove(1));
  CHECK(line.add({++id, "cy", ""}).is_taken);
}

TEST_CASE("who may not begin keeps their place", "[daemon][previews]") {
  FairLine line(64, 16);
  CHECK(line.add({1, "ana", ""}).is_taken);
  CHECK(line.add({2, "ben", ""}).is_taken);
  const auto place = line.next([](const std::string& who) { return who != "ana"; });
  REQUIRE(place);
  CHECK(place->id == 2);
  CHECK_FALSE(line.next([](const std::string&) { return false; }));
  CHECK(all_of(line) == std::vector<std::uint64_t>{1});
}

}  // namespace fair_line_test
