// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/deploy_book.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <ostream>

#include <fmt/format.h>

#include "core/deploy/loaded_pattern.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/deploy/stl.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "daemon/cli/input/book_input.hpp"

namespace popcut::cli {
namespace deploy_book_parts {
namespace {

constexpr std::uintmax_t kCardBytes = 1u << 29;

/// The table of all cards in one pose, each turned about the spine by the openings of those before
/// it. Only the motions are those of the whole.
Result<PoseTable> whole_pose(const DeployedBook& book, double psi_rad) {
  PoseTable whole;
  whole.psi_rad = {psi_rad};
  const std::array one{psi_rad};
  for (std::size_t i = 0; i < book.cards.size(); ++i) {
    auto table = pose_table(book.cards[i], one);
    if (!table) return tl::unexpected(table.error());
    // x, along the ground, turns toward z.
    const rigid::Turn turn(Eigen::AngleAxisd(-static_cast<double>(i) * psi_rad, Vec3(0, 1, 0)));
    for (const rigid::Motion& motion : table->motions)
      whole.motions.push_back({turn * motion.turn, Vec3(turn * motion.shift)});
    whole.parent.insert(whole.parent.end(), table->parent.begin(), table->parent.end());
    whole.pivot.insert(whole.pivot.end(), table->pivot.begin(), table->pivot.end());
    whole.faces += table->bodies();
  }
  return whole;
}

}  // namespace
}  // namespace deploy_book_parts

std::vector<const Pattern*> DeployedBook::pointers() const {
  std::vector<const Pattern*> out;
  out.reserve(cards.size());
  for (const Pattern& card : cards) out.push_back(&card);
  return out;
}

Result<DeployedBook> read_deployed_book(const std::string& file) {
  using namespace deploy_book_parts;
  const auto book = read_book(file);
  if (!book) return tl::unexpected(book.error());
  DeployedBook out;
  out.name = book->name;
  for (const BookCardFile& card : book->cards) {
    const auto text = read_file(card.file, kCardBytes);
    if (!text) return tl::unexpected(text.error());
    const auto fold = read_fold(*text);
    if (!fold) return tl::unexpected(within(card.file, fold.error()));
    auto pattern = pattern_from_fold(*fold);
    if (!pattern) return tl::unexpected(within(card.file, pattern.error()));
    out.cards.push_back(std::move(*pattern));
    constexpr double kRounding = 1e-9;
    const double first = out.cards.front().design_psi_rad, own = out.cards.back().design_psi_rad;
    if (std::abs(own - first) > kRounding)
      return fail(ErrorKind::OutOfRange, card.file,
                  fmt::format("is designed for {:.6g} rad, and the first card for {:.6g} rad; give "
                              "the cards of one book",
                              own, first));
  }
  return out;
}

Result<SheetMesh> book_mesh(const DeployedBook& book, double thickness_mm) {
  SheetMesh out;
  std::uint32_t bodies = 0;
  for (const Pattern& card : book.cards) {
    const auto mesh = thickness_mm > 0.0 ? solid_mesh(card, thickness_mm) : surface_mesh(card);
    if (!mesh) return mesh;
    const auto corners = static_cast<std::uint32_t>(out.at.size());
    out.at.insert(out.at.end(), mesh->at.begin(), mesh->at.end());
    for (const std::uint32_t body : mesh->body) out.body.push_back(body + bodies);
    for (const auto& [a, b, c] : mesh->triangles)
      out.triangles.push_back({a + corners, b + corners, c + corners});
    const std::array any{card.design_psi_rad};
    const auto table = pose_table(card, any);
    if (!table) return tl::unexpected(table.error());
    bodies += static_cast<std::uint32_t>(table->bodies());
  }
  return out;
}

Result<void> add_book_meshes(const DeployedBook& book, const SheetMesh& mesh,
                             const std::vector<double>& psi_rad, OutputFolder& folder,
                             const Progress& progress) {
  using namespace deploy_book_parts;
  for (std::size_t k = 0; k < psi_rad.size(); ++k) {
    tell(progress, "writing the poses",
         static_cast<double>(k) / static_cast<double>(psi_rad.size()));
    const auto pose = whole_pose(book, psi_rad[k]);
    if (!pose) return tl::unexpected(pose.error());
    const std::string title = fmt::format("psi {:.6f} rad, {}", psi_rad[k], book.name);
    const std::function<Result<void>(std::ostream&)> write =
        [&](std::ostream& out) -> Result<void> {
      write_stl(mesh, *pose, 0, MeshAxes::Upright, title, out);
      return {};
    };
    if (auto done = folder.add(fmt::format("psi_{:03}.stl", k + 1), write); !done) return done;
  }
  return {};
}

}  // namespace popcut::cli
