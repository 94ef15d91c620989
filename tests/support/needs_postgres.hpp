// SPDX-License-Identifier: MIT
#pragma once

#include <catch2/catch.hpp>

#include "tests/support/postgres_server.hpp"

/// The first line of a case that needs PostgreSQL: where there is none, the case says so and ends.
#define NEEDS_POSTGRES()                                                                  \
  if (const std::string why = popcut::testing::PostgresServer::why_not(); !why.empty()) { \
    WARN("skipped: " << why);                                                             \
    return;                                                                               \
  }
