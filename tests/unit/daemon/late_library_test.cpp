// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "daemon/files/late_library.hpp"

namespace late_library_test {

using namespace popcut;
using Catch::Contains;

TEST_CASE("functions of a library that is loaded late can be called", "[daemon][files]") {
  struct Mathematics : LateLibrary {
    Mathematics() : LateLibrary("libm.so.6", "libc6") {}
    double (*floor)(double) = function("floor");
  } library;
  REQUIRE(library.fault().empty());
  CHECK(library.floor(2.5) == 2.0);
}

TEST_CASE("a library that is not installed is reported with its package", "[daemon][files]") {
  struct Missing : LateLibrary {
    Missing() : LateLibrary("libpopcut-none.so.9", "libpopcut-none9") {}
    int (*nothing)() = function("nothing");
  } library;
  CHECK_THAT(library.fault(), Contains("libpopcut-none.so.9 cannot be loaded (") &&
                                  Contains("; install the Debian package libpopcut-none9"));
  CHECK(library.nothing == nullptr);
}

TEST_CASE("a library that lacks a function is reported", "[daemon][files]") {
  struct Older : LateLibrary {
    Older() : LateLibrary("libm.so.6", "libc6") {}
    int (*newer)() = function("popcut_no_such_function");
    double (*floor)(double) = function("floor");
  } library;
  CHECK_THAT(library.fault(), Contains("popcut_no_such_function"));
  CHECK(library.floor != nullptr);
}

}  // namespace late_library_test
