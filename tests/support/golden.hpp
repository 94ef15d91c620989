// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/paths.hpp"

namespace popcut::testing {

/// A file of values computed from the paper; none, with a warning, where there is no such file.
inline std::optional<nlohmann::json> golden(const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::path(source_file("../shared/data/paper")) / name;
  std::ifstream in(path);
  if (!in) {
    WARN("skipped: no " << name);
    return std::nullopt;
  }
  return nlohmann::json::parse(in);
}

}  // namespace popcut::testing
