// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/comparison.hpp"
#include "core/compare/placement.hpp"
#include "core/compare/printed.hpp"
#include "core/design/patches.hpp"
#include "core/hands/folding.hpp"
#include "core/machines/machine.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/plan/plan_options.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/search/candidate.hpp"
#include "core/search/halving.hpp"
#include "core/search/standing.hpp"
#include "core/warning.hpp"

namespace popcut::planning {

/// What a person asks of the folding.
struct HandLimits {
  std::size_t most_folds{std::numeric_limits<std::size_t>::max()};
  double shortest_mm{};  ///< no fold is shorter
  std::string label;     ///< "easy", or "medium": no harder; empty: any
  bool any_hold{};       ///< cards that move in paper are offered too
};

/// What a card takes to cut and to fold.
struct CuttingCost {
  double seconds{};
  std::array<double, 2> seconds_range{};
  double cut_mm{}, fold_mm{};
  hands::Handwork hands;  ///< of a book: of all its cards
  double wobble_mm{};     ///< of the panel that moves most (`hands::wobble_of`)
};

/// A candidate as a search judged it, without its design.
struct JudgedCard {
  bool rough{};  ///< in the first rounds
  Candidate candidate;
  double shrunk{1.0};  ///< so that it fits on the mat
  Judged judged;
  std::string why;  ///< where nothing came of it
  std::string spec;
  CuttingCost cost;
};

/// The ways to stand that a search begins with.
struct FoundWays {
  std::vector<Way> ways;  ///< turn and misfit of each; the rest is measured again
  std::size_t drawn{};    ///< of `ways`: those that candidates are drawn for
  std::size_t tried{};
  std::string better_front;  ///< as `FoundCards`
};

/// Figures and warnings of a designed card, which its search reports.
struct CardFacts {
  std::array<double, 2> sheet_mm{};  ///< across and along the spine, of a book each of its sheets
  std::optional<double> page_mm;     ///< of a book: how far a page reaches from the spine
  std::vector<Warning> warnings;
};

/// A card that a search ended with.
struct FoundCard {
  Candidate candidate;
  std::string spec;    ///< `design` makes exactly this card from it
  PatchAssembly made;  ///< without parts: it was finished elsewhere (`finish_cards`)
  CuttingCost cost;
  likeness::Figures figures;                        ///< as `popcut compare` has them
  std::optional<likeness::PrintedFigures> printed;  ///< as `popcut compare --printed`
  likeness::ModelPlacement placement;
  std::vector<float> structure;  ///< the opened card, as `likeness::Triangles`
  std::string shown;             ///< what `SearchRequest::show` made of it
  std::string picture;           ///< a PNG file, where it was drawn already
  CardFacts facts;

  /// What cards are ranked by.
  [[nodiscard]] double error() const { return printed ? printed->error() : figures.error(); }
};

/// A card as it is written, verified and compared as `popcut verify` and `popcut compare` do it.
struct FinishedCard {
  Candidate candidate;
  CuttingCost cost;
  std::optional<FoundCard> card;  ///< none: nothing came of it
  std::string why;                ///< then
};

/// What a search need not find out again.
struct SearchMemory {
  std::optional<FoundWays> ways;
  std::vector<JudgedCard> cards;
  std::vector<FinishedCard> finished;
  std::vector<FinishedCard> drawn;  ///< those of the front once more, with their pictures
};

/// Candidates that a search wants to have judged, or cards that it wants to have finished.
struct WantedCards {
  FoundWays ways;
  bool rough{};
  std::vector<Candidate> candidates;
  std::vector<JudgedCard> finals;
  bool drawn{};                  ///< of `finals`: pictures are wanted, too
  std::string doing;             ///< in words
  std::array<double, 2> part{};  ///< of all the work
};

/// What the best cards are searched for.
struct SearchRequest {
  TriangleMesh mesh;
  /// Of the mesh's triangles, one each; empty: finished cards are compared in clay.
  std::vector<likeness::Rgb> colours;
  CandidateModel model;  ///< how specs name it
  Material material;
  PlanOptions plan;                 ///< machine, material, mat, and whether there are marks
  std::vector<std::string> tables;  ///< users' tables
  StyleChoice styles{style_choices().front()};
  int cards{1};  ///< of a book around one spine, 3 to 12; 1: a card alone
  UpSide up;
  FrontSide front;       ///< given: the model stands as it is said, turned no further
  double most_s{900.0};  ///< of cutting
  HandLimits hands;
  bool plain{};        ///< cards are judged as bare paper; books always are
  double effort{1.0};  ///< factor of how many candidates are tried
  std::uint64_t seed{1};
  unsigned threads{1};  ///< changes nothing of the result
  Progress progress;
  std::function<bool()> stopped;  ///< asked between candidates; true: the search ends
  /// Makes `FoundCard::shown` of a card and its spec, as long as its target is there. On any
  /// thread.
  std::function<std::string(const std::string& spec, PatchAssembly& made)> show;
  SearchMemory memory;
  /// If set, the search judges no candidate and finishes no card: it ends with Refused after it
  /// told this which ones are to be judged (`judge_cards`) or finished (`finish_cards`), and
  /// remembered.
  std::function<void(WantedCards)> wanted;
};

/// A usual candidate: what a style makes without a search.
struct UsualCard {
  Candidate candidate;
  bool made{};
  std::string why;  ///< where it was not made
  double error{}, seconds{};
};

/// How many were judged on the way.
struct SearchCounts {
  std::size_t ways{}, designed{}, planned{}, verified{};
};

/// What a search found.
struct FoundCards {
  /// By growing time of folding, the error falling from each to the next. No cut takes longer than
  /// `most_s`, no panel moves by more than `hands::kFirm_mm` unless `any_hold` asks for it, and
  /// each passes the verifier with one freedom. The last one is the one most like the model.
  std::vector<FoundCard> front;
  /// Of `front`: the easiest that looks good, one with the label "easy" before others; where none
  /// does, or all are judged plain, the easiest whose error is near the least one.
  std::size_t recommended{};
  std::vector<UsualCard> usual;
  SearchCounts counts;
  std::string better_front;  ///< of `up_words`: clearly better than the given one; empty: none is
  double seen_share{};  ///< of the model's area along the diagonal of the best card or its cards
  std::vector<std::string> notes;  ///< about the mesh and the search, a sentence each
  Machine machine;
  std::array<double, 2> area_mm{};  ///< of the mat that the tool reaches
  TriangleMesh mesh;                ///< that was searched
};

/// What became of candidates that others wanted.
struct JudgedCards {
  std::vector<JudgedCard> cards;
  std::vector<FinishedCard> finished;  ///< those whose designs are whole already
};

/// Judges candidates as a search of this request does, which wants them.
///
/// @retval OutOfRange, Usage  as `search_cards`
[[nodiscard]] Result<JudgedCards> judge_cards(const SearchRequest& request,
                                              const WantedCards& wanted);

/// Finishes cards as a search of this request does, which wants them: with their designs.
///
/// @retval OutOfRange, Usage  as `search_cards`
[[nodiscard]] Result<std::vector<FinishedCard>> finish_cards(const SearchRequest& request,
                                                             const WantedCards& wanted);

/// The model as it stands around a card that was found, as `likeness::Triangles`. It is large, and
/// so no part of a card.
[[nodiscard]] std::vector<float> model_around(const TriangleMesh& mesh, const FoundCard& card);

/// Triangles above which a mesh is refused: each of some hundred designs looks at all of them.
inline constexpr std::size_t kMostSearchedTriangles = 2'000'000;

/// The least share of the model that a card must show within 2 % of its size; else it shows
/// nothing.
inline constexpr double kLeastCover = 0.02;

/// Searches the cards that look most like a model, for each time of folding, by successive halving
/// (core/search): ways to stand by what is seen along the diagonal; many candidates designed and
/// compared in images of 64 pixels; of these, fewer in images of 256 pixels and planned; the best
/// verified and compared as `popcut compare` does it. Half of the coarse candidates are drawn, the
/// other half are the best of these with some settings changed. Each style with its usual settings
/// goes on to the end. The same request gives the same answer: work is counted in candidates, and
/// neither clock nor threads decide anything.
///
/// Of books, all cards are designed and planned together, and as many times fewer books are tried.
/// They are compared from all around, without their pages, and verified as `popcut verify` does it.
///
/// What is asked for goes together (`check_choices`).
///
/// @retval Refused     it was stopped
/// @retval OutOfRange  the mesh has no area or too many triangles
/// @retval Usage       an option of the plan; place is `pointer_to` it
/// Where no card keeps `hands`, the one of the fewest folds is found, and a note says so.
///
/// @retval Infeasible  no card shows the model, none is cut within `most_s`, or none holds; the
///                     detail says what share of it can be seen, and how many cards would show more
[[nodiscard]] Result<FoundCards> search_cards(SearchRequest request);

}  // namespace popcut::planning
