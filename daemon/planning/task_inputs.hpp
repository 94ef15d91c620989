// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {

/// Each file that a spec names, with its JSON pointer.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> files_of(const DesignSpec& spec);

/// The ids of the assets that stand for a spec's files.
///
/// @retval OutOfRange  a file is no asset's id
[[nodiscard]] Result<std::vector<std::string>> asset_ids(const DesignSpec& spec);

/// Takes the assets of a spec out of `given`, since they may be large.
///
/// @retval OutOfRange  a file is no asset's id, or there is no such asset
[[nodiscard]] Result<SurfaceAssets> assets_for(const DesignSpec& spec, SurfaceAssets& given);

/// Units of a spec, patches and all.
[[nodiscard]] long units_of(const DesignSpec& spec);
/// How many of them are designed while somebody waits: about a second of work.
[[nodiscard]] long most_quick_units(const DesignSpec& spec);

/// The rows that came with a task, each a table of its own.
struct RowTables {
  std::vector<std::string> texts;
  std::string machine, material;  ///< names; empty: none was given
};
/// @retval Malformed  a row is no JSON, or has no name
[[nodiscard]] Result<RowTables> tables_of(const WorkerTask& task);

}  // namespace popcut::planning
