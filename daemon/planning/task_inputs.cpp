// SPDX-License-Identifier: MIT
#include "daemon/planning/task_inputs.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"

namespace popcut::planning {
namespace {

constexpr const char* kUsualMachine = "cameo3";

bool is_asset_id(std::string_view name) {
  constexpr std::string_view kPrefix{"sha256-"};
  if (name.size() != kPrefix.size() + 64 || name.substr(0, kPrefix.size()) != kPrefix) return false;
  return name.find_first_not_of("0123456789abcdef", kPrefix.size()) == std::string_view::npos;
}

/// Makes a row a table of its own; gives its name.
Result<std::string> add_row(const std::string& json, const char* list,
                            std::vector<std::string>& texts) {
  if (json.empty()) return std::string();
  auto row = parse_json(json, 16);
  if (!row) return tl::unexpected(row.error());
  if (!row->is_object() || !row->contains("name") || !(*row)["name"].is_string())
    return fail(ErrorKind::Malformed, "/name", "must be a row of a table, with its name");
  std::string name = (*row)["name"].get<std::string>();
  nlohmann::json table{{"popcut", 1}};
  table[list] = nlohmann::json::array({std::move(*row)});
  texts.push_back(table.dump());
  return name;
}

long most_of_one(const DesignSpec& spec) {
  if (spec.curvature) return 150;
  switch (spec.lattice) {
    case LatticeMethod::Conformal:
    case LatticeMethod::Auto:
      return 2'500;
    case LatticeMethod::Direct:
      return 5'000;
    default:
      return 100'000;
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> files_of(const DesignSpec& spec) {
  std::vector<std::pair<std::string, std::string>> files;
  const auto note = [&](const std::string& place, const std::optional<SurfaceSpec>& surface) {
    const std::string name = asset_of(surface);
    if (!name.empty())
      files.emplace_back(fmt::format("{}/surface/{}", place, asset_field(*surface)), name);
  };
  note("", spec.surface);
  for (std::size_t k = 0; k < spec.patches.size(); ++k)
    note(fmt::format("/patches/{}", k), spec.patches[k].surface);
  return files;
}

Result<std::vector<std::string>> asset_ids(const DesignSpec& spec) {
  std::vector<std::string> ids;
  for (const auto& [place, name] : files_of(spec)) {
    if (!is_asset_id(name))
      return fail(ErrorKind::OutOfRange, place,
                  fmt::format("is \"{}\", which is not the id of an asset; upload the file to "
                              "/v1/assets and use the id in the answer (sha256-...)",
                              name.substr(0, 60)));
    if (std::find(ids.begin(), ids.end(), name) == ids.end()) ids.push_back(name);
  }
  return ids;
}

Result<SurfaceAssets> assets_for(const DesignSpec& spec, SurfaceAssets& given) {
  if (const auto valid = asset_ids(spec); !valid) return tl::unexpected(valid.error());
  SurfaceAssets assets;
  for (const auto& [place, name] : files_of(spec)) {
    if (assets.contains(name)) continue;
    const auto found = given.find(name);
    if (found == given.end())
      return fail(ErrorKind::OutOfRange, place,
                  fmt::format("there is no asset {}; upload the file to /v1/assets first", name));
    assets.emplace(name, std::move(found->second));
  }
  return assets;
}

Result<RowTables> tables_of(const WorkerTask& task) {
  RowTables tables;
  auto machine = add_row(task.machine_json, "machines", tables.texts);
  if (!machine) return tl::unexpected(within("machine", machine.error()));
  auto material = add_row(task.material_json, "materials", tables.texts);
  if (!material) return tl::unexpected(within("material", material.error()));
  auto profile = add_row(task.profile_json, "svg_profiles", tables.texts);
  if (!profile) return tl::unexpected(within("svg-profile", profile.error()));
  tables.machine = machine->empty() ? kUsualMachine : std::move(*machine);
  tables.material = std::move(*material);
  return tables;
}

long units_of(const DesignSpec& spec) {
  long units = 0;
  for (const RegionSpec& region : spec.regions)
    units += static_cast<long>(region.slices) * region.units_per_slice;
  for (const DesignSpec& patch : spec.patches) units += units_of(patch);
  return units;
}

long most_quick_units(const DesignSpec& spec) {
  long most = most_of_one(spec);
  for (const DesignSpec& patch : spec.patches) most = std::min(most, most_quick_units(patch));
  return most;
}

}  // namespace popcut::planning
