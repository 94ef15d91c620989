// SPDX-License-Identifier: MIT
#include "daemon/cli/search/model_search.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/model/model.hpp"
#include "core/search/choices.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/input/drawn_pattern.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/client/command_words.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/planning/search/freed_memory.hpp"

namespace popcut::cli {
namespace model_search_parts {
namespace {

Result<TriangleMesh> read_model(const std::string& file, const std::string& bytes,
                                std::vector<std::string>& notes) {
  if (!is_model_file(file)) {
    if (is_design_spec(bytes))
      return fail(ErrorKind::OutOfRange, file,
                  fmt::format("is a design already; type: popcut design {} -o DIR", file));
    if (is_pattern(bytes))
      return fail(ErrorKind::OutOfRange, file, "is a pattern; give a 3D model (.stl, .obj, .glb)");
  }
  return read_mesh(file, bytes, &notes);
}

}  // namespace
}  // namespace model_search_parts

Result<SearchedModel> search_model(const ModelSearchOptions& options,
                                   const std::filesystem::path& spec_folder, bool shows_progress,
                                   const std::function<bool()>& stopped) {
  using namespace model_search_parts;
  LongWork work(shows_progress, "reading the model");
  SearchedModel out;
  auto bytes = read_model_file(options.model);
  if (!bytes) return tl::unexpected(bytes.error());
  out.bytes = std::move(*bytes);
  planning::SearchRequest request;
  std::vector<std::string> notes;
  auto mesh = read_model(options.model, out.bytes, notes);
  if (!mesh) return tl::unexpected(mesh.error());
  request.mesh = std::move(*mesh);
  if (!options.plain && options.cards == 1)
    out.colours = model_in_colours(options.model, out.bytes);
  if (out.colours) request.colours = mean_colours(*out.colours, request.mesh.size());
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  request.tables = tables->texts;
  const std::string material = options.material.empty() ? "paper-220" : options.material;
  auto found = find_material(material, tables->texts);
  if (!found) {
    const Error error = tables->with_file(found.error());
    return fail(error.place.empty() ? ErrorKind::Usage : error.kind,
                error.place.empty() ? "--material" : error.place, error.detail);
  }
  out.material = request.material = std::move(*found);
  const std::filesystem::path path(options.model);
  std::error_code error;
  out.name = path.filename().string();
  out.file = std::filesystem::relative(path, spec_folder, error).string();
  if (error || out.file.empty()) out.file = std::filesystem::absolute(path, error).string();
  request.model = {path.stem().string(), out.file, material};
  request.plan.machine = options.machine, request.plan.material = material;
  request.plan.mat = options.mat;
  request.plan.marks = options.marks;
  request.styles = style_choice(options.style);
  out.up = up_for_file(options.up, options.model, options.front);
  request.up = up_side(out.up), request.front = up_side(options.front);
  request.cards = options.cards;
  if (const auto fit = check_choices(options.style, options.cards, out.up, options.front); !fit)
    return tl::unexpected(client::on_command_line(fit.error()));
  request.most_s = 60.0 * options.max_minutes;
  if (options.most_folds > 0)
    request.hands.most_folds = static_cast<std::size_t>(options.most_folds);
  request.hands.shortest_mm = options.shortest_fold_mm;
  if (options.label != "hard") request.hands.label = options.label;
  request.hands.any_hold = options.any_hold;
  request.plain = options.plain;
  request.effort = options.effort, request.seed = options.seed;
  request.threads =
      options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
  request.progress = work.progress();
  request.stopped = stopped;
  planning::keep_freed_memory();
  TriangleMesh searched = std::move(request.mesh);
  const planning::SearchRequest asked = request;
  request.mesh = std::move(searched);
  auto cards = planning::search_cards(std::move(request));
  if (!cards) {
    const Error why = client::on_command_line(tables->with_file(cards.error()));
    const bool of_model = why.kind != ErrorKind::Usage && why.kind != ErrorKind::Refused;
    return tl::unexpected(of_model && why.place.empty() ? within(options.model, why) : why);
  }
  out.found = std::move(*cards);
  out.found.notes.insert(out.found.notes.begin(), notes.begin(), notes.end());
  out.glued = planning::glued_beside(asked, out.found);
  return out;
}

}  // namespace popcut::cli
