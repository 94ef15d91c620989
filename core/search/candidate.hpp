// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/spec/spec.hpp"
#include "core/search/standing.hpp"

namespace popcut {

/// A card that may be made of a model: what a search chooses.
struct Candidate {
  DesignStyle style{DesignStyle::Facets};
  LatticeMethod lattice{LatticeMethod::Auto};  ///< of a lattice
  std::size_t way{};                           ///< index of the way that the model stands
  double fill{1.0};                            ///< its size, of the largest that fits on the mat
  int cards{1};                                ///< of a book; 1: a card alone
  int units{12};                               ///< of a lattice, per slice
  int slices{20};                              ///< of a lattice
  double strip_mm{2.0};                        ///< of facets, as the next two
  double pitch_mm{2.0};
  double line_cost{1.0};  ///< factor of the costs of folds and cuts
  double hinge_mm3{};     ///< cost of a fold, however long, where the model's diagonal is 100 mm
  int layers{2};          ///< of a silhouette
  bool kites{};           ///< facets whose roofs are sloped panels, off the wall as these ask
  bool usual{};           ///< a style as it is without a search: goes on to the end

  friend bool operator==(const Candidate&, const Candidate&) = default;
};

/// Which styles a search may choose.
struct StyleChoice {
  std::string_view name;
  bool facets{};
  std::vector<LatticeMethod> lattices;
  bool silhouettes{};
};
/// "any", "facets", "silhouette", "lattice", and each lattice by its name.
[[nodiscard]] const std::vector<StyleChoice>& style_choices();

/// The one of that name. @param name  one of theirs
[[nodiscard]] const StyleChoice& style_choice(std::string_view name);

/// "facets", "silhouette", or the name of its lattice.
[[nodiscard]] std::string_view style_name(const Candidate& candidate);

/// What of a choice a book of so many cards can be made of: facets are for openings of 90 degrees,
/// silhouettes for a card alone.
[[nodiscard]] StyleChoice styles_for_cards(StyleChoice styles, int cards);

/// Each style with the usual settings, standing in the first way.
[[nodiscard]] std::vector<Candidate> usual_candidates(const StyleChoice& styles, int cards);

/// Facets whose folds have a price, standing in each way: cards of few long folds.
[[nodiscard]] std::vector<Candidate> broad_candidates(const StyleChoice& styles, int cards,
                                                      std::size_t ways);

/// Facets with sloped panels, in each way in which the model has a roof: few panels, whose sides
/// are easy to fold, or narrow.
[[nodiscard]] std::vector<Candidate> kite_candidates(const StyleChoice& styles, int cards,
                                                     std::span<const Way> ways);

/// Silhouettes of few layers, standing in each way: the easiest cards there are.
[[nodiscard]] std::vector<Candidate> silhouette_candidates(const StyleChoice& styles,
                                                           std::size_t ways);

/// Candidate `index` of a seed. Better ways are drawn more often.
[[nodiscard]] Candidate drawn_candidate(const StyleChoice& styles, int cards, std::size_t ways,
                                        std::uint64_t seed, std::uint64_t index);
/// One with one or two settings changed a little.
[[nodiscard]] Candidate changed_candidate(const Candidate& from, std::size_t ways,
                                          std::uint64_t seed, std::uint64_t index);

/// Plain card beside the structure, mm: that of `CardSpec`.
inline constexpr double kCandidateMargin_mm = 15.0;

/// The length of one unit of the model, mm, with which its card about fills a sheet of this size,
/// either way round: the sheet takes twice the shut reach and the margins across the spine, and the
/// length and the margins along it.
[[nodiscard]] double largest_scale_mm(const Way& way, const std::array<double, 2>& sheet_mm);

/// What a spec needs beside the candidate.
struct CandidateModel {
  std::string name;      ///< of the design
  std::string file;      ///< of the mesh, as the spec gives it
  std::string material;  ///< by name
};

/// The candidate as a design spec (JSON), which `popcut design` takes as it is.
///
/// @param scale_mm  of one unit of the model
[[nodiscard]] std::string spec_text(const Candidate& candidate, const Way& way, double scale_mm,
                                    const CandidateModel& model);

}  // namespace popcut
