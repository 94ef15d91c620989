// SPDX-License-Identifier: MIT
#include "core/search/choices.hpp"

#include <catch2/catch.hpp>

#include "core/search/standing.hpp"

namespace choices_test {

using namespace popcut;

TEST_CASE("what a search is asked for goes together, or the member to change is named",
          "[core][search]") {
  CHECK(check_choices("any", 1, "any", "any"));
  CHECK(check_choices("facets", 4, "z", "any"));
  CHECK(check_choices("lattice", 12, "any", "any"));
  CHECK(check_choices("any", 6, "any", "any"));  // facets are left out
  CHECK(check_choices("any", 1, "z", "-y"));
  CHECK(check_choices("any", 1, "any", "z"));
  const auto place = [](const char* style, int cards, const char* up, const char* front) {
    const auto fit = check_choices(style, cards, up, front);
    REQUIRE_FALSE(fit);
    CHECK(fit.error().kind == ErrorKind::Usage);
    return fit.error().place;
  };
  for (const int cards : {-1, 0, 2, 13}) CHECK(place("any", cards, "any", "any") == "/cards");
  for (const int cards : {3, 5, 12}) CHECK(place("facets", cards, "any", "any") == "/style");
  CHECK(place("silhouette", 4, "any", "any") == "/style");
  CHECK(place("any", 4, "any", "x") == "/front");
  for (const char* front : {"z", "-z"}) CHECK(place("any", 1, "z", front) == "/front");
}

TEST_CASE("any two axes that differ leave one turn by right angles", "[core][search]") {
  for (const std::string& up : up_words())
    for (const std::string& front : up_words()) {
      CAPTURE(up, front);
      const bool is_fit = check_choices("any", 1, up, front).has_value();
      CHECK(is_fit == !upright_turns(up_side(up), up_side(front)).empty());
      CHECK(is_fit == (up == "any" || front == "any" || up.back() != front.back()));
    }
}

}  // namespace choices_test
