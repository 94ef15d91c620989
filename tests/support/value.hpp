// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "core/result.hpp"

namespace popcut::testing {

/// The value of a result or of an optional; REQUIRE reports the error.
template <typename T>
T value(Result<T> result) {
  const std::string why = result ? std::string() : message(result.error());
  INFO(why);
  REQUIRE(result);
  return std::move(*result);
}

template <typename T>
T value(std::optional<T> found) {
  REQUIRE(found);
  return std::move(*found);
}

}  // namespace popcut::testing
