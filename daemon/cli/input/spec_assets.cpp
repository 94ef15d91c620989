// SPDX-License-Identifier: MIT
#include "daemon/cli/input/spec_assets.hpp"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "core/design/placement.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/user_tables.hpp"

namespace popcut::cli {

namespace {

Result<void> load_asset(const DesignSpec& spec, const std::string& spec_file,
                        const std::string& place, SurfaceAssets& assets) {
  const std::string name = asset_of(spec.surface);
  if (name.empty() || assets.contains(name)) return {};
  const auto path = std::filesystem::path(spec_file).parent_path() / name;
  // Reading what is no file may never end.
  std::error_code ignored;
  const bool is_other =
      std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored);
  auto bytes =
      is_other ? fail(ErrorKind::Malformed, path.string(), "is not a file") : read_model_file(path);
  if (!bytes)
    return tl::unexpected(
        within(fmt::format("{}/surface/{}", place, asset_field(*spec.surface)), bytes.error()));
  assets.emplace(name, std::move(*bytes));
  return {};
}

}  // namespace

Result<SurfaceAssets> load_assets(const DesignSpec& spec, const std::string& spec_file) {
  SurfaceAssets assets;
  if (auto done = load_asset(spec, spec_file, "", assets); !done)
    return tl::unexpected(done.error());
  for (std::size_t k = 0; k < spec.patches.size(); ++k)
    if (auto done = load_asset(spec.patches[k], spec_file, fmt::format("/patches/{}", k), assets);
        !done)
      return tl::unexpected(done.error());
  return assets;
}

Result<Material> material_of(const DesignSpec& spec, const std::string& spec_file) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  auto material = find_material(spec.material, tables->texts);
  if (material) return *material;
  const Error error = tables->with_file(material.error());
  return fail(error.place.empty() ? ErrorKind::OutOfRange : error.kind,
              error.place.empty() ? spec_file + ": /material" : error.place, error.detail);
}

std::vector<likeness::Rgb> asset_colours(const std::string& spec_file, const SurfaceAssets& assets,
                                         std::size_t triangles) {
  for (const auto& [name, bytes] : assets)
    if (const auto model =
            model_in_colours(std::filesystem::path(spec_file).parent_path() / name, bytes))
      return mean_colours(*model, triangles);
  return {};
}

Result<void> print_placed_spec(const DesignSpec& spec, const std::string& spec_text,
                               const SurfaceAssets& assets, bool quarter, bool quiet) {
  std::optional<LongWork> work(std::in_place, !quiet, "trying orientations of the shape");
  const auto proposed = propose_placement(spec, assets, quarter ? Stand::Quarter : Stand::Whole);
  work.reset();
  if (!proposed) return tl::unexpected(proposed.error());
  const auto text = with_placement(spec_text, *proposed);
  if (!text) return tl::unexpected(text.error());
  fmt::print("{}", *text);
  if (quiet) return {};
  fmt::print(
      stderr,
      "placed: the structure reaches {:.1f} % of the shape's area within {:g} % of its size; "
      "{}\n"
      "tried {} orientations; the curves follow what they reach to {:.3g} mm rms, {:.3g} mm "
      "at most\n",
      100.0 * proposed->reached, 100.0 * kReachedWithin,
      proposed->reached_before
          ? fmt::format("as given it is {:.1f} %", 100.0 * *proposed->reached_before)
          : "as given it cannot be designed: " + proposed->refused_before,
      proposed->tried, proposed->rms_mm, proposed->max_mm);
  if (proposed->refused > 0)
    fmt::print(stderr, "note: {} {} cannot be designed, and this is the next best: {}\n",
               proposed->refused,
               proposed->refused == 1 ? "better orientation" : "better orientations",
               proposed->refusal);
  if (proposed->slices_mm > proposed->length_mm)
    fmt::print(stderr,
               "note: the slices take {:.1f} mm along the main fold, but the shape only {:.1f} mm; "
               "use fewer or\nnarrower slices, or a larger scale_mm\n",
               proposed->slices_mm, proposed->length_mm);
  return {};
}

}  // namespace popcut::cli
