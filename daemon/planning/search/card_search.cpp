// SPDX-License-Identifier: MIT
#include "daemon/planning/search/card_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "core/deploy/standing_card.hpp"
#include "core/design/book_fit.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/hands/wobble.hpp"
#include "core/judge/book_pose.hpp"
#include "core/judge/card_pose.hpp"
#include "core/search/book_standing.hpp"
#include "core/search/coarse_mesh.hpp"
#include "core/search/halving.hpp"
#include "core/search/mesh_faults.hpp"
#include "core/search/seen_share.hpp"
#include "core/verify/book.hpp"
#include "core/verify/verify.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/plan_job.hpp"
#include "daemon/planning/search/parallel.hpp"
#include "daemon/planning/search/searched_mat.hpp"

namespace popcut::planning {
namespace {

// How many are tried, for an effort of 1.
constexpr std::size_t kDrawn = 100, kChanged = 70, kParents = 16, kFine = 28, kFineChanged = 16,
                      kFineParents = 8, kFinal = 12;
/// A search of more effort begins with these, and keeps what they found: so it finds no less.
constexpr std::array kShortSearches{0.02, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0};
constexpr double kMuchMore = 3.0;  ///< times the effort of a shorter search
constexpr std::size_t kWays = 6, kStraightWays = 2, kWaysTurnedOn = 5;
constexpr double kHardlyLonger_s = 60.0;            ///< of folding: a better likeness is worth it
constexpr double kNearFactor = 1.25, kNear = 0.02;  ///< an error that is as good as the least one
constexpr double kBroad_mm = 5.0;
/// Cards that take longer to fold go on after all others: nobody makes them, and designing one
/// takes as long as ten of few folds. The usual ones go on in any case.
constexpr double kMostFolding_s = 3600.0;
constexpr double kLeastForBroad = 0.1;  ///< effort for each card

/// How carefully candidates are judged.
struct Care {
  int pixels{};
  bool rough{};  ///< designs in fewer rounds
};
constexpr Care kCoarse{64, true}, kCareful{256, false};
constexpr std::size_t kRoundViews = 12;  ///< of books, until they are compared for the last time
constexpr int kComparePixels = 512;      // as popcut compare

// Meshes of so many triangles or fewer are used as they are.
constexpr std::size_t kCoarseTriangles = 25'000, kCarefulTriangles = 100'000;
constexpr int kCoarseCells = 96, kCarefulCells = 256;

constexpr const char* kAsset = "model.stl";
constexpr int kMostSizes = 5;       // that are tried until the card fits on the mat
constexpr double kMoreRoom = 0.98;  // of silhouettes: smaller ones have other planes

constexpr const char* kBehind = "a part of the card would stand behind its wall or ground";

/// As `popcut compare` tells cards in a corner from other structures.
bool is_behind(likeness::Triangles structure) {
  const double touch = 1e-3 * likeness::box_of(structure).diagonal();
  const likeness::Box box = likeness::box_of(structure);
  return std::min(box.low.x(), box.low.z()) < -touch;
}

/// A candidate on its way.
struct Trial : JudgedCard {
  PatchAssembly made;
  bool sized{};  ///< `shrunk` is known
};

/// From where cards or books are compared with a model that stands in their corner or about the
/// spine.
likeness::Scene scene_of(int pixels, bool is_book, std::size_t around) {
  likeness::Scene scene;
  scene.pixels = pixels;
  scene.views = is_book ? likeness::round_views(around) : likeness::cone_views();
  if (!is_book) scene.corner = likeness::Corner{};
  return scene;
}

/// A mesh, as designs read it and as they are compared with it.
struct Model {
  Model(const TriangleMesh& triangles, const std::vector<Way>& ways, int pixels, bool is_book)
      : mesh(triangles),
        targets(ways.size()),
        printed_(ways.size()),
        pixels_(pixels),
        is_book_(is_book) {
    assets.emplace(kAsset, stl_bytes(mesh));
  }
  /// The target of a way, made once.
  const likeness::Target& target(std::size_t k, const Way& way) {
    const std::lock_guard lock(mutex_);
    if (!targets[k]) {
      const auto standing = is_book_ ? standing_in_book(mesh, way) : standing_model(mesh, way);
      targets[k] = std::make_unique<const likeness::Target>(
          standing, scene_of(pixels_, is_book_, kRoundViews));
    }
    return *targets[k];
  }

  /// The same, to compare with what is printed.
  const likeness::PrintedTarget& printed(std::size_t k, const Way& way) {
    const std::lock_guard lock(mutex_);
    if (!printed_[k])
      printed_[k] = std::make_unique<const likeness::PrintedTarget>(
          standing_model(mesh, way), std::span<const likeness::Rgb>(),
          scene_of(pixels_, false, kRoundViews));
    return *printed_[k];
  }

  const TriangleMesh& mesh;
  SurfaceAssets assets;
  std::vector<std::unique_ptr<const likeness::Target>> targets;

 private:
  std::vector<std::unique_ptr<const likeness::PrintedTarget>> printed_;
  int pixels_;
  bool is_book_;
  std::mutex mutex_;
};

/// Where the model begins along the spine of its card or book, as `structure_of` has it.
struct PartStand {
  double scale_mm{}, begin_mm{};
};
std::optional<PartStand> stand_of(const PatchAssembly& made, const Way& way) {
  const auto card = std::find_if(made.parts.begin(), made.parts.end(), [](const Design& part) {
    return part.pattern.model_placement.has_value();
  });
  if (card == made.parts.end()) return std::nullopt;
  const auto& at = *card->pattern.model_placement;
  const double shift = made.book ? made.book->shift_mm : 0.0;
  return PartStand{at[0], at[5] - shift + at[0] * way.box.low[1]};
}

/// The opened card with wall and ground, or the opened cards of a book without their pages.
std::vector<float> structure_of(const PatchAssembly& made) {
  if (!made.book) return standing_triangles(made.parts.front().pattern);
  const TriangleSoup soup = book_structure(made);
  return {soup.corners.begin(), soup.corners.end()};
}

class CardSearch {
 public:
  explicit CardSearch(const SearchRequest& request)
      : request_(request), styles_(styles_for_cards(request.styles, request.cards)) {}

  Result<FoundCards> run() {
    if (auto done = look_at_mesh(); !done) return tl::unexpected(done.error());
    if (auto done = look_at_machine(); !done) return tl::unexpected(done.error());
    for (const JudgedCard& one : request_.memory.cards) judged_[one.rough ? 0 : 1].push_back(one);
    designs_.resize(judged_[0].size());
    recall_ways();
    if (is_stopped()) return stopped();
    if (ways_.empty())
      return no_card(is_book() ? "it has no size" : "it has no side that stands in a corner");
    std::vector<double> efforts;
    for (const double effort : kShortSearches)
      if (!is_book() && kMuchMore * effort <= request_.effort * (1.0 + 1e-9))
        efforts.push_back(effort);
    efforts.push_back(request_.effort);
    const double all = std::accumulate(efforts.begin(), efforts.end(), 0.0);
    for (const double effort : efforts) {
      effort_ = effort;
      share_ = {share_.second, share_.second + effort / all};
      if (auto done = try_coarsely(); !done) return tl::unexpected(done.error());
      if (auto done = try_carefully(); !done) return tl::unexpected(done.error());
      keep_for_the_end();
    }
    return finish();
  }

  /// Only judges candidates.
  Result<JudgedCards> judge_only(const WantedCards& wanted) {
    if (auto done = look_at_machine(); !done) return tl::unexpected(done.error());
    recall_ways();
    const Care& care = wanted.rough ? kCoarse : kCareful;
    Model model(wanted.rough ? coarse() : careful(), ways_, care.pixels, is_book());
    likeness::Buffers buffers;
    is_whole_mesh_ = !wanted.rough && model.mesh.size() == request_.mesh.size();
    JudgedCards out;
    for (const Candidate& candidate : wanted.candidates) {
      if (candidate.way >= ways_.size()) return stands_nowhere();
      Trial trial;
      trial.candidate = candidate;
      trial.judged.stays = candidate.usual;
      judge(trial, model, care, buffers);
      // Nearly all that are judged carefully are finished, and to design them again takes longer.
      if (is_whole_mesh_ && trial.judged.made) out.finished.push_back(finish_trial(trial, model));
      out.cards.push_back(static_cast<JudgedCard&&>(trial));
      out.cards.back().rough = wanted.rough;
      tell(request_.progress, wanted.doing,
           static_cast<double>(out.cards.size()) / static_cast<double>(wanted.candidates.size()));
    }
    return out;
  }

  /// Only finishes cards.
  Result<std::vector<FinishedCard>> finish_only(const WantedCards& wanted) {
    if (auto done = look_at_machine(); !done) return tl::unexpected(done.error());
    recall_ways();
    Model whole(request_.mesh, ways_, kComparePixels, is_book());
    std::vector<FinishedCard> out;
    for (const JudgedCard& judged : wanted.finals) {
      if (judged.candidate.way >= ways_.size()) return stands_nowhere();
      Trial trial{judged, {}, true};
      out.push_back(finish_trial(trial, whole));
      tell(request_.progress, wanted.doing,
           static_cast<double>(out.size()) / static_cast<double>(wanted.finals.size()));
    }
    return out;
  }

 private:
  using Part = std::pair<double, double>;  ///< of all the work, from and to
  static constexpr Part kFinish{0.9, 1.0};
  static constexpr const char *kFinishing = "verifying the best cards",
                              *kDrawing = "drawing the cards";

  [[nodiscard]] bool is_stopped() const {
    return waits_ || (request_.stopped && request_.stopped());
  }
  [[nodiscard]] static tl::unexpected<Error> stopped() {
    return fail(ErrorKind::Refused, "", "the search was stopped; nothing is written");
  }
  [[nodiscard]] static tl::unexpected<Error> stands_nowhere() {
    return fail(ErrorKind::OutOfRange, "steps", "a candidate stands in no way");
  }
  [[nodiscard]] bool is_book() const { return request_.cards > 1; }
  [[nodiscard]] bool is_printed() const { return !is_book() && !request_.plain; }
  [[nodiscard]] std::size_t count(std::size_t usual, std::size_t least) const {
    const double each = effort_ / request_.cards;
    return std::max(least,
                    static_cast<std::size_t>(std::floor(each * static_cast<double>(usual) + 0.5)));
  }

  /// A part of this search as one of all the work, between the ways to stand and the end.
  [[nodiscard]] Part during(double from, double to) const {
    constexpr double kBegin = 0.06, kEnd = 0.9;
    const auto at = [&](double share) {
      return kBegin + (kEnd - kBegin) * (share_.first + (share_.second - share_.first) * share);
    };
    return {at(from), at(to)};
  }

  /// Does `work` for each index, and says how far that is.
  void for_each(std::size_t count, std::string_view what, Part part,
                const std::function<void(std::size_t thread, std::size_t index)>& work) {
    std::mutex mutex;
    std::size_t done = 0;
    const auto share = [&] {
      const double of =
          static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(count, 1));
      return part.first + (part.second - part.first) * of;
    };
    tell(request_.progress, what, share());
    for_each_index(count, request_.threads, request_.stopped,
                   [&](std::size_t thread, std::size_t index) {
                     work(thread, index);
                     const std::lock_guard lock(mutex);
                     ++done;
                     tell(request_.progress, what, share());
                   });
  }

  Result<void> look_at_mesh() {
    const std::size_t triangles = request_.mesh.size();
    if (triangles > kMostSearchedTriangles)
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("has {} triangles; at most {} can be searched: reduce the mesh in a "
                              "3D program first",
                              triangles, kMostSearchedTriangles));
    const MeshFaults faults = faults_of(request_.mesh);
    if (!(faults.area > 0.0))
      return fail(ErrorKind::OutOfRange, "",
                  "has no outside: none of its triangles has an area; give a mesh of a surface");
    out_.notes = in_words(faults);
    return {};
  }

  Result<void> look_at_machine() {
    auto mat = searched_mat(request_.plan, request_.tables);
    if (!mat) return tl::unexpected(mat.error());
    auto hands = hands::hands_of(request_.tables);
    if (!hands) return tl::unexpected(hands.error());
    hands_ = std::move(*hands);
    out_.machine = std::move(mat->machine);
    out_.area_mm = mat->area_mm, room_mm_ = mat->room_mm;
    return {};
  }

  /// Ways are judged on a coarse mesh; their boxes are to be of the mesh itself.
  void take_boxes() {
    for (Way& way : ways_) {
      const double misfit = way.misfit;
      way = is_book() ? way_in_book(request_.mesh, way.rotate_deg, request_.cards)
                      : way_of(request_.mesh, way.rotate_deg);
      way.misfit = misfit;
      if (!is_book()) way.roof_off = roof_off_of(coarse(), way);
    }
  }

  /// Ways to stand about the spine: the best by what is seen along the cards' diagonals.
  void find_book_ways(const TriangleMesh& coarse) {
    const auto turns = turns_in_book(request_.up, request_.cards);
    std::vector<Way> ways(turns.size());
    for_each(turns.size(), "trying ways to stand", {0.0, 0.06}, [&](std::size_t, std::size_t k) {
      ways[k] = way_in_book(coarse, turns[k], request_.cards);
      ways[k].misfit = misfit_in_book(coarse, ways[k], request_.cards);
    });
    out_.counts.ways += turns.size();
    std::erase_if(ways,
                  [](const Way& way) { return !(way.length() > 0.0) || !(way.shut_reach > 0.0); });
    ways_ = best_ways(ways, kWays);
    drawn_ways_ = ways_.size();
    take_boxes();
  }

  [[nodiscard]] static auto is_turned(const std::array<double, 3>& degrees) {
    return [degrees](const Way& way) { return way.rotate_deg == degrees; };
  }

  /// What is seen of a turned model is more, and yet a house that stands straight becomes a better
  /// card: with few large panels. So the last of the ways make room for straight ones.
  [[nodiscard]] static std::vector<Way> with_straight(std::vector<Way> ways,
                                                      const std::vector<Way>& straight) {
    std::vector<Way> missing;
    for (const Way& way : straight)
      if (std::none_of(ways.begin(), ways.end(), is_turned(way.rotate_deg))) missing.push_back(way);
    ways.resize(std::min(ways.size(), kWays - missing.size()));
    ways.insert(ways.end(), missing.begin(), missing.end());
    return ways;
  }

  /// Looks for a front beside the given one that suits cards clearly better, by what is seen of it.
  void compare_fronts(double misfit) {
    constexpr double kClearly = 0.7;
    double least = kClearly * misfit;
    for (const std::string& word : up_words()) {
      const FrontSide front = up_side(word);
      if (!front || front == request_.front) continue;
      for (const auto& turn : upright_turns(request_.up, front)) {
        const double other = misfit_of(coarse(), way_of(coarse(), turn));
        if (!std::isfinite(other) || other >= least) continue;
        least = other, out_.better_front = word;
      }
    }
  }

  /// The ways to stand that are remembered, or else looked for.
  void recall_ways() {
    const auto& found = request_.memory.ways;
    if (!found) return find_ways();
    ways_ = found->ways, drawn_ways_ = found->drawn;
    out_.counts.ways = found->tried, out_.better_front = found->better_front;
    take_boxes();
  }
  [[nodiscard]] FoundWays found_ways() const {
    return {ways_, drawn_ways_, out_.counts.ways, out_.better_front};
  }

  /// Leaves out the ways that show little of what the model has to show. Each is measured once.
  [[nodiscard]] std::vector<Way> telling(std::vector<Way> ways, Part part) {
    const TriangleMesh& shown = request_.colours.empty() ? coarse() : request_.mesh;
    for_each(ways.size(), "looking for the front", part, [&](std::size_t, std::size_t k) {
      if (!(ways[k].detail > 0.0)) ways[k].detail = detail_of(shown, request_.colours, ways[k]);
    });
    return telling_ways(std::move(ways));
  }

  /// Ways to stand: the best by what is seen along the diagonal, straight ones, and as the file
  /// stands.
  void find_ways() {
    const TriangleMesh& coarse = this->coarse();
    if (is_book()) return find_book_ways(coarse);
    const auto judged = [&](const std::vector<std::array<double, 3>>& turns, Part part) {
      std::vector<Way> ways(turns.size());
      for_each(turns.size(), "trying ways to stand", part, [&](std::size_t, std::size_t k) {
        ways[k] = way_of(coarse, turns[k]);
        ways[k].misfit = misfit_of(coarse, ways[k]);
      });
      out_.counts.ways += turns.size();
      std::erase_if(ways, [](const Way& way) {
        return !std::isfinite(way.misfit) || !(way.length() > 0.0) || !(way.shut_reach > 0.0);
      });
      return ways;
    };
    std::vector<Way> ways = judged(upright_turns(request_.up, request_.front), {0.0, 0.02});
    constexpr std::array<double, 3> kAsTheFileStands{};
    const auto own = std::find_if(ways.begin(), ways.end(), is_turned(kAsTheFileStands));
    const auto as_the_file_stands = own == ways.end() ? std::nullopt : std::optional(*own);
    if (!request_.front) ways = telling(std::move(ways), {0.02, 0.03});
    const std::vector<Way> straight = best_ways(ways, kStraightWays);
    if (request_.up && request_.front && !ways.empty()) compare_fronts(ways.front().misfit);
    std::vector<std::array<double, 3>> near;
    for (const Way& way : best_ways(ways, request_.front ? 0 : kWaysTurnedOn))
      for (const auto& turn : turns_near(way.rotate_deg, !request_.up)) near.push_back(turn);
    for (const Way& way : judged(near, {0.03, 0.05})) ways.push_back(way);
    if (!request_.front) ways = telling(std::move(ways), {0.05, 0.06});
    ways_ = with_straight(best_ways(ways, kWays), straight);
    drawn_ways_ = ways_.size();
    if (as_the_file_stands && std::none_of(ways_.begin(), ways_.end(), is_turned(kAsTheFileStands)))
      ways_.push_back(*as_the_file_stands);
    take_boxes();
  }

  /// How much smaller a card, or each of a book, must be for the mat; 1: it fits.
  [[nodiscard]] double shrink_for(const PatchAssembly& made) const {
    constexpr double kMargins = 2.0 * kCandidateMargin_mm, kTouch = 1e-6, kRoom = 0.995;
    const double u_mm = made.u_mm, v_mm = made.book ? made.book->width_mm : made.v_mm;
    const auto fits = [&](double across, double along) {
      if (u_mm <= across + kTouch && v_mm <= along + kTouch) return 1.0;
      return kRoom * std::min({1.0, (across - kMargins) / (u_mm - kMargins),
                               (along - kMargins) / (v_mm - kMargins)});
    };
    return std::max(fits(room_mm_[0], room_mm_[1]), fits(room_mm_[1], room_mm_[0]));
  }

  /// Whether the design that a candidate gets in the first rounds is the one that it keeps: no
  /// rough one, and of the whole mesh. A card needs its target only to be shown, and a book to be
  /// compared: these are designed again, as targets are large.
  [[nodiscard]] bool keeps_design(const Candidate& candidate) const {
    return !is_book() && !request_.show && !is_quicker_rough(candidate) &&
           coarse().size() == request_.mesh.size();
  }

  /// Gives a trial the design that it got in the first rounds of this search or of a shorter one,
  /// with its spec and its cost.
  [[nodiscard]] bool recall_design(Trial& trial) const {
    const auto& known = judged_[0];
    const auto at = std::find_if(known.begin(), known.end(), [&](const JudgedCard& card) {
      return card.candidate == trial.candidate;
    });
    if (at == known.end()) return false;
    const PatchAssembly& made = designs_[static_cast<std::size_t>(at - known.begin())];
    if (made.parts.empty()) return false;
    trial.made = made;
    trial.spec = at->spec, trial.cost = at->cost, trial.shrunk = at->shrunk;
    return true;
  }

  /// How a candidate is designed: Size says little more than how large its sheet is.
  enum class Detail { Size, Rough, Whole };

  /// Designs a candidate, as large as it is wanted and fits; returns whether something came of it.
  [[nodiscard]] bool design_trial(Trial& trial, const Model& model, bool rough) const {
    const Detail detail =
        rough && is_quicker_rough(trial.candidate) ? Detail::Rough : Detail::Whole;
    // Half of all silhouettes are too large at first; rough designs tell by how much, and so do
    // those of facets where these are quicker.
    if (detail == Detail::Whole && !trial.sized &&
        (is_quicker_rough(trial.candidate) || is_silhouette(trial.candidate)) &&
        !design_to_fit(trial, model, Detail::Size))
      trial.shrunk = 1.0;
    return design_to_fit(trial, model, detail);
  }

  [[nodiscard]] static bool is_silhouette(const Candidate& candidate) {
    return candidate.style == DesignStyle::Silhouette;
  }

  /// Broad strips, and folds with a price, are quick, and rough ones say little of what their cards
  /// become.
  [[nodiscard]] bool is_quicker_rough(const Candidate& candidate) const {
    return candidate.style == DesignStyle::Facets &&
           (is_book() || (candidate.strip_mm < kBroad_mm && !(candidate.hinge_mm3 > 0.0)));
  }

  [[nodiscard]] bool design_to_fit(Trial& trial, const Model& model, Detail detail) const {
    const Way way =
        trial.candidate.kites ? off_wall(ways_[trial.candidate.way]) : ways_[trial.candidate.way];
    trial.judged.made = false;
    for (int k = 0; k < kMostSizes; ++k) {
      const double scale_mm = trial.candidate.fill * trial.shrunk * largest_scale_mm(way, room_mm_);
      if (!(scale_mm > 0.0)) {
        trial.why = "the mat has no room beside the margins of the card";
        return false;
      }
      trial.spec = spec_text(trial.candidate, way, scale_mm, request_.model);
      auto spec = parse_design_spec(trial.spec);
      if (!spec) {
        trial.why = message(spec.error());
        return false;
      }
      suit_material(request_.material, *spec);
      spec->surface = MeshSpec{kAsset};
      spec->facets.rough = detail != Detail::Whole;
      auto made = design_assembly(*spec, model.assets);
      if (!made) {
        trial.why = message(made.error());
        return false;
      }
      trial.made = std::move(*made);
      const double shrink = shrink_for(trial.made);
      if (shrink == 1.0) {
        trial.sized = true;
        return true;
      }
      trial.shrunk *=
          trial.shrunk < 1.0 && is_silhouette(trial.candidate) ? kMoreRoom * shrink : shrink;
    }
    trial.why = "its sheet does not fit on the mat";
    return false;
  }

  /// Of a book: each card is planned as it is, on a sheet of its own.
  [[nodiscard]] Result<CuttingCost> cost_of(const PatchAssembly& made) const {
    PlanOptions options = request_.plan;
    options.material = request_.material.name;
    options.no_split = true;
    CuttingCost out;
    for (const Design& part : made.parts) {
      const auto job = make_plan_job(
          options, request_.tables,
          [&](const SvgReadOptions&) -> Result<DrawingInput> {
            return DrawingInput{linework_from_pattern(part.pattern), request_.material.name};
          },
          "");
      if (!job) return tl::unexpected(job.error());
      for (const PlannedSheet& sheet : job->plan.sheets) {
        out.seconds += sheet.seconds;
        for (std::size_t k = 0; k < 2; ++k) out.seconds_range[k] += sheet.seconds_range[k];
        out.cut_mm += sheet.cut_mm, out.fold_mm += sheet.fold_mm;
      }
    }
    out.hands = hands_of(made);
    for (const Design& part : made.parts)
      if (part.report.wobble)
        out.wobble_mm = std::max(out.wobble_mm, part.report.wobble->largest_mm);
    return out;
  }

  /// What it takes to fold a card, or all cards of a book.
  [[nodiscard]] hands::Handwork hands_of(const PatchAssembly& made) const {
    std::vector<const Pattern*> cards;
    for (const Design& part : made.parts) cards.push_back(&part.pattern);
    return hands::handwork(cards, hands_);
  }

  [[nodiscard]] bool holds(const CuttingCost& cost) const {
    return request_.hands.any_hold || cost.wobble_mm <= hands::kFirm_mm;
  }
  [[nodiscard]] bool is_as_easy_as_asked(const CuttingCost& cost) const {
    const HandLimits& limits = request_.hands;
    return cost.hands.folds <= limits.most_folds &&
           (cost.hands.folds == 0 || cost.hands.shortest_mm >= limits.shortest_mm) &&
           (limits.label.empty() || cost.hands.label == limits.label || cost.hands.label == "easy");
  }
  /// What judges of candidates go by. One that would not be offered goes on after all others.
  void set_cost(Trial& trial, bool rough) const {
    constexpr double kNotOffered = 10.0;
    trial.judged.cost = trial.cost.hands.time_s;
    const bool is_offered = trial.cost.seconds <= request_.most_s &&
                            is_as_easy_as_asked(trial.cost) && (rough || holds(trial.cost));
    if (!is_offered) trial.judged.error += kNotOffered;
  }

  /// Designs, compares and plans a candidate.
  void judge(Trial& trial, Model& model, const Care& care, likeness::Buffers& buffers) const {
    const bool is_known = !care.rough && recall_design(trial);
    trial.judged.made = false;
    if (!is_known && !design_trial(trial, model, care.rough)) return;
    const Way& way = ways_[trial.candidate.way];
    const auto stand = stand_of(trial.made, way);
    if (!stand) {
      trial.why = "the pattern does not say where the model stands";
      return;
    }
    if (!is_known) {
      const auto cost = cost_of(trial.made);
      if (!cost) {
        trial.why = message(cost.error());
        return;
      }
      trial.cost = *cost;
    }
    const auto by = static_cast<float>(way.to_target() / stand->scale_mm);
    std::vector<float> structure = structure_of(trial.made);
    if (!is_book() && is_behind(structure)) {
      trial.why = kBehind;
      return;
    }
    for (std::size_t k = 0; k < structure.size(); ++k)
      structure[k] =
          by * (structure[k] - (k % 3 == 1 ? static_cast<float>(stand->begin_mm) : 0.0F));
    const std::size_t k = trial.candidate.way;
    if (is_printed() ? model.printed(k, way).is_unseen() : model.target(k, way).is_unseen()) {
      trial.why = "nothing of the model is seen from in front of the card";
      return;
    }
    trial.judged.error = is_printed() ? model.printed(k, way).measure(structure, buffers).error()
                                      : model.target(k, way).measure(structure, buffers).error();
    set_cost(trial, care.rough);
    trial.judged.made = true;
  }

  /// Judges `trials_` from one on.
  void judge_all(std::size_t from, Model& model, const Care& care, std::string_view what, Part part,
                 bool keep_designs) {
    std::vector<likeness::Buffers> buffers(std::max(1U, request_.threads));
    std::vector<JudgedCard>& known = judged_[care.rough ? 0 : 1];
    if (request_.wanted) {
      WantedCards wanted{
          found_ways(), care.rough, {}, {}, false, std::string(what), {part.first, part.second}};
      for (std::size_t k = from; k < trials_.size(); ++k)
        if (!is_among(known, trials_[k].candidate))
          wanted.candidates.push_back(trials_[k].candidate);
      // Who judges neighbours draws the model in few ways to stand.
      std::stable_sort(wanted.candidates.begin(), wanted.candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.way < b.way; });
      waits_ = !wanted.candidates.empty();
      if (waits_) return request_.wanted(std::move(wanted));
    }
    for_each(trials_.size() - from, what, part, [&](std::size_t thread, std::size_t k) {
      Trial& trial = trials_[from + k];
      const auto before = std::find_if(known.begin(), known.end(), [&](const JudgedCard& other) {
        return other.candidate == trial.candidate;
      });
      if (before != known.end()) {  // by a shorter search
        trial = {*before, {}, true};
        return;
      }
      judge(trial, model, care, buffers[thread]);
      if (care.rough ? !trial.judged.made || !keeps_design(trial.candidate) : !keep_designs)
        trial.made = {};
      if (!is_book() && !request_.show)
        for (Design& part : trial.made.parts) part.target.clear();
    });
    for (std::size_t k = from; k < trials_.size(); ++k)
      if (!is_among(known, trials_[k].candidate)) {
        known.push_back(static_cast<const JudgedCard&>(trials_[k]));
        known.back().rough = care.rough;
        if (care.rough) designs_.push_back(std::exchange(trials_[k].made, {}));
      }
  }
  template <typename Cards>
  [[nodiscard]] static bool is_among(const Cards& cards, const Candidate& candidate) {
    return std::any_of(cards.begin(), cards.end(),
                       [&](const JudgedCard& card) { return card.candidate == candidate; });
  }
  [[nodiscard]] static std::vector<Judged> judged_of(const std::vector<Trial>& trials) {
    std::vector<Judged> out;
    out.reserve(trials.size());
    for (const Trial& trial : trials) out.push_back(trial.judged);
    return out;
  }

  /// Who goes on. Coarse designs are nearer to fine ones in lattices than in facets, so that coarse
  /// errors are compared within each of both kinds only, which get half of the places each.
  [[nodiscard]] std::vector<std::size_t> best_of(const std::vector<Judged>& judged, Halving halving,
                                                 bool by_kind) const {
    halving.seed = request_.seed;
    if (!is_book()) halving.most_cost = kMostFolding_s;
    if (!by_kind) return survivors(judged, halving);
    std::array<std::vector<std::size_t>, 2> kinds;
    for (std::size_t k = 0; k < judged.size(); ++k)
      kinds.at(trials_[k].candidate.style == DesignStyle::Facets ? 0 : 1).push_back(k);
    std::vector<std::size_t> out;
    for (const auto& kind : kinds) {
      std::vector<Judged> own;
      own.reserve(kind.size());
      for (const std::size_t k : kind) own.push_back(judged[k]);
      Halving half = halving;
      half.keep = kinds[0].empty() || kinds[1].empty() ? halving.keep : (halving.keep + 1) / 2;
      for (const std::size_t n : survivors(own, half)) out.push_back(kind[n]);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  /// The few that look most like the model among the easy ones, and among the medium ones, go on.
  void keep_easy(std::vector<Judged>& judged) const {
    constexpr std::size_t kKept = 3;
    for (const char* const label : {"easy", "medium"}) {
      std::vector<std::size_t> of_label;
      for (std::size_t k = 0; k < judged.size(); ++k)
        if (judged[k].made && trials_[k].cost.hands.label == label) of_label.push_back(k);
      std::stable_sort(of_label.begin(), of_label.end(), [&](std::size_t a, std::size_t b) {
        return judged[a].error < judged[b].error;
      });
      of_label.resize(std::min(of_label.size(), kKept));
      for (const std::size_t k : of_label) judged[k].stays = true;
    }
  }

  /// Leaves those of `trials_` that go on.
  void halve(std::size_t keep, std::uint64_t step, bool by_kind) {
    Halving halving;
    halving.keep = keep, halving.step = step;
    std::vector<Judged> judged = judged_of(trials_);
    keep_easy(judged);
    std::vector<Trial> out;
    for (const std::size_t k : best_of(judged, halving, by_kind))
      out.push_back(std::move(trials_[k]));
    trials_ = std::move(out);
  }

  /// Adds candidates like the best ones, with some settings changed.
  void add_changed(std::size_t count, std::size_t parents, bool by_kind) {
    Halving halving;
    halving.keep = parents, halving.random_share = 0.0;
    std::vector<Judged> judged = judged_of(trials_);
    for (Judged& one : judged) one.stays = false;
    const std::vector<std::size_t> best = best_of(judged, halving, by_kind);
    for (std::size_t k = 0; k < count && !best.empty(); ++k)
      add_trial(changed_candidate(trials_[best[k % best.size()]].candidate, drawn_ways_,
                                  request_.seed, changed_++));
  }

  void add_trial(const Candidate& candidate) {
    Candidate usual = candidate;
    usual.usual = true;
    if (is_among(trials_, candidate) || is_among(trials_, usual)) return;
    Trial trial;
    trial.candidate = candidate;
    trial.judged.stays = candidate.usual;
    trials_.push_back(std::move(trial));
  }

  Result<void> try_coarsely() {
    trials_.clear();
    Model model(coarse(), ways_, kCoarse.pixels, is_book());
    for (const Candidate& usual : usual_candidates(styles_, request_.cards)) {
      add_trial(usual);
      Candidate as_it_stands = usual;  // the last way is as the file stands
      as_it_stands.way = ways_.size() - 1;
      if (drawn_ways_ < ways_.size()) add_trial(as_it_stands);
    }
    const bool is_quick = effort_ / request_.cards < kLeastForBroad;
    for (const Candidate& one : silhouette_candidates(
             styles_, is_quick ? std::min(drawn_ways_, kStraightWays) : drawn_ways_))
      add_trial(one);
    for (const Candidate& one : kite_candidates(
             styles_, request_.cards,
             std::span(ways_).first(is_quick ? std::min(drawn_ways_, kStraightWays) : drawn_ways_)))
      add_trial(one);
    if (!is_quick)
      for (const Candidate& broad : broad_candidates(styles_, request_.cards, drawn_ways_))
        add_trial(broad);
    for (std::size_t k = 0; k < count(kDrawn, 8); ++k)
      add_trial(drawn_candidate(styles_, request_.cards, drawn_ways_, request_.seed, k));
    judge_all(0, model, kCoarse, "designing coarse cards", during(0.0, 0.2), false);
    if (is_stopped()) return stopped();
    const std::size_t from = trials_.size();
    add_changed(count(kChanged, 6), count(kParents, 3), true);
    judge_all(from, model, kCoarse, "designing coarse cards", during(0.2, 0.3), false);
    if (is_stopped()) return stopped();
    return {};
  }

  Result<void> try_carefully() {
    for (const Trial& trial : trials_)
      if (!trial.judged.made && refusal_.empty()) refusal_ = trial.why;
    halve(count(kFine, 4), 1, true);
    Model model(careful(), ways_, kCareful.pixels, is_book());
    is_whole_mesh_ = model.mesh.size() == request_.mesh.size();
    // Else they are designed again, and each would keep its mesh until then.
    judge_all(0, model, kCareful, "designing the best of them", during(0.3, 0.75), is_whole_mesh_);
    if (is_stopped()) return stopped();
    const std::size_t from = trials_.size();
    add_changed(count(kFineChanged, 2), count(kFineParents, 1), false);
    judge_all(from, model, kCareful, "designing cards like the best", during(0.75, 1.0),
              is_whole_mesh_);
    if (is_stopped()) return stopped();
    return {};
  }

  /// Usual ones are compared to the end; of the others those that may be in the front.
  void keep_for_the_end() {
    halve(count(kFinal, 4), 2, false);
    for (Trial& trial : trials_)
      if (!is_among(finals_, trial.candidate)) finals_.push_back(std::move(trial));
    known_.push_back(finals_.size());
  }

  [[nodiscard]] static FinishedCard unfinished(const Trial& trial, std::string why) {
    return {trial.candidate, trial.cost, std::nullopt, std::move(why)};
  }
  /// Leaves the design of a trial in the card that comes of it.
  [[nodiscard]] FinishedCard finish_trial(Trial& trial, Model& whole) const {
    if (!is_whole_mesh_ || (trial.made.parts.empty() && !recall_design(trial))) {
      if (design_trial(trial, whole, false)) {
        const auto cost = cost_of(trial.made);
        trial.judged.made = cost.has_value();
        if (cost)
          trial.cost = *cost;
        else
          trial.why = message(cost.error());
      }
      if (!trial.judged.made) return unfinished(trial, trial.why);
    }
    std::vector<std::string> folds;
    for (const Design& part : trial.made.parts) {
      std::ostringstream text;
      if (const auto done = write_fold(part.pattern, {}, text); !done)
        return unfinished(trial, message(done.error()));
      folds.push_back(std::move(text).str());
    }
    auto card = is_book() ? finished_book(folds) : finished_card(folds.front());
    if (!card) return unfinished(trial, message(card.error()));
    card->candidate = trial.candidate, card->spec = trial.spec, card->cost = trial.cost;
    card->made = std::move(trial.made);
    if (request_.show) card->shown = request_.show(card->spec, card->made);
    // The surface of each part holds the mesh; only books look at it once more.
    if (!is_book())
      for (Design& part : card->made.parts) part.target.clear();
    card->facts = facts_of(card->made);
    return {trial.candidate, trial.cost, std::move(*card), {}};
  }
  [[nodiscard]] static CardFacts facts_of(const PatchAssembly& made) {
    CardFacts out;
    out.sheet_mm = {made.u_mm, made.book ? made.book->width_mm : made.v_mm};
    if (made.book) out.page_mm = made.book->page_mm;
    for (const Design& part : made.parts)
      out.warnings.insert(out.warnings.end(), part.report.warnings.begin(),
                          part.report.warnings.end());
    return out;
  }

  /// What of a card only its file decides: `popcut verify` and `popcut compare` read no more.
  [[nodiscard]] Result<FoundCard> finished_card(const std::string& fold) const {
    VerifyOptions how;
    how.degrees_of_freedom = 1;
    const auto report = verify_fold(fold, how);
    if (!report) return tl::unexpected(report.error());
    if (!report->ok()) return unsound(report->failed());
    auto opened = judge::open_card(fold, std::nullopt);
    if (!opened) return tl::unexpected(opened.error());
    if (!opened->model) return nowhere();
    if (is_behind(opened->triangles)) return fail(ErrorKind::Infeasible, "", kBehind);
    FoundCard card;
    card.placement = *opened->model;
    const std::vector<float> target = likeness::placed(request_.mesh.corners, card.placement);
    card.structure = std::move(opened->triangles);
    likeness::Scene scene = scene_of(kComparePixels, false, 0);
    scene.views = likeness::cone_views(opened->corner.opening_rad);
    scene.corner = opened->corner;
    card.figures = likeness::Target(target, scene).measure(card.structure);
    if (is_printed())
      card.printed =
          likeness::PrintedTarget(target, request_.colours, scene).measure(card.structure);
    return card;
  }

  /// The same of a book.
  [[nodiscard]] Result<FoundCard> finished_book(const std::vector<std::string>& folds) const {
    std::vector<VerifiedCard> cards;
    judge::BookPose opened;
    for (const std::string& fold : folds) {
      cards.push_back({fmt::format("card {}", cards.size() + 1), fold});
      if (const auto done = opened.add(cards.back().name, fold); !done)
        return tl::unexpected(done.error());
    }
    const auto report = verify_book(cards);
    if (!report) return tl::unexpected(report.error());
    if (!report->ok()) return unsound(report->failed());
    if (!opened.model) return nowhere();
    FoundCard card;
    card.placement = *opened.model;
    const std::vector<float> target = likeness::placed(request_.mesh.corners, card.placement);
    card.structure = std::move(opened.triangles);
    const likeness::Scene scene = scene_of(kComparePixels, true, likeness::round_views().size());
    card.figures = likeness::Target(target, scene).measure(card.structure);
    return card;
  }
  [[nodiscard]] static tl::unexpected<Error> unsound(std::size_t failed) {
    return fail(ErrorKind::Infeasible, "", fmt::format("{} checks of the verifier fail", failed));
  }
  [[nodiscard]] static tl::unexpected<Error> nowhere() {
    return fail(ErrorKind::Infeasible, "", "the pattern does not say where the model stands");
  }

  /// Gives trials what others made of them, or says which of them are wanted.
  [[nodiscard]] bool recall_finished(const std::vector<Trial>& trials,
                                     const std::vector<std::size_t>& of,
                                     const std::vector<FinishedCard>& known, WantedCards wanted,
                                     std::vector<FinishedCard>& finished) const {
    wanted.ways = found_ways();
    for (const std::size_t k : of) {
      const auto at = std::find_if(known.begin(), known.end(), [&](const FinishedCard& card) {
        return card.candidate == trials[k].candidate;
      });
      if (at != known.end())
        finished[k] = *at;
      else
        wanted.finals.push_back(trials[k]);
    }
    if (wanted.finals.empty()) return true;
    request_.wanted(std::move(wanted));
    return false;
  }

  Result<FoundCards> finish() {
    out_.counts.designed = judged_[0].size(), out_.counts.planned = judged_[1].size();
    std::vector<Trial> last = std::move(finals_);
    std::vector<FinishedCard> finished(last.size());
    if (request_.wanted) {
      std::vector<std::size_t> all(last.size());
      std::iota(all.begin(), all.end(), std::size_t{0});
      WantedCards wanted;
      wanted.doing = kFinishing, wanted.part = {kFinish.first, kFinish.second};
      if (!recall_finished(last, all, request_.memory.finished, std::move(wanted), finished))
        return stopped();
    }
    const TriangleMesh none;
    const bool all_made = std::all_of(last.begin(), last.end(),
                                      [](const Trial& trial) { return !trial.made.parts.empty(); });
    Model whole(all_made || request_.wanted ? none : request_.mesh, ways_, kComparePixels,
                is_book());
    for_each(last.size(), kFinishing, kFinish, [&](std::size_t, std::size_t k) {
      if (!request_.wanted) finished[k] = finish_trial(last[k], whole);  // else it is remembered
    });
    if (is_stopped()) return stopped();
    out_.counts.verified = last.size();
    std::vector<Judged> judged(last.size());
    for (std::size_t k = 0; k < last.size(); ++k) {
      last[k].cost = finished[k].cost;
      judged[k].made = finished[k].card.has_value();
      judged[k].error = judged[k].made ? finished[k].card->error() : 0.0;
      judged[k].cost = last[k].cost.hands.time_s;
      if (judged[k].made && finished[k].card->figures.cover < kLeastCover)
        judged[k].made = false, finished[k].why = "it shows nothing of the model";
      if (!judged[k].made && refusal_.empty()) refusal_ = finished[k].why;
    }
    if (auto offered = offer(last, judged); !offered) return tl::unexpected(offered.error());
    for (std::size_t k = 0; k < last.size(); ++k)
      if (last[k].candidate.usual)
        out_.usual.push_back({last[k].candidate, judged[k].made,
                              judged[k].made || !finished[k].why.empty()
                                  ? finished[k].why
                                  : not_offered(last[k].cost),
                              judged[k].error, last[k].cost.seconds});
    std::vector<std::size_t> front;
    for (const std::size_t known : known_)
      front = shown_front(std::span(judged).first(known), front);
    if (front.empty()) return no_card(refusal_);
    if (request_.wanted) {
      WantedCards wanted;
      wanted.doing = kDrawing, wanted.part = {kFinish.second, 1.0}, wanted.drawn = true;
      if (!recall_finished(last, front, request_.memory.drawn, std::move(wanted), finished))
        return stopped();
    }
    for (const std::size_t k : front) out_.front.push_back(std::move(*finished[k].card));
    const double near_least = kNearFactor * out_.front.back().error() + kNear;
    const auto is_good = [&](const FoundCard& card) {
      return card.error() <= near_least ||
             (card.printed && likeness::looks(*card.printed) == likeness::Looks::Good);
    };
    // The front is in order of minutes, and each card is more like the model than the one before.
    const auto recommended = [&](const char* label) {
      const auto suits = [&](const FoundCard& card) {
        return is_good(card) && card.cost.hands.label == label;
      };
      const auto easiest = std::find_if(out_.front.begin(), out_.front.end(), suits);
      auto best = easiest;
      for (auto card = easiest; card != out_.front.end(); ++card)
        if (suits(*card) && card->cost.hands.time_s <= easiest->cost.hands.time_s + kHardlyLonger_s)
          best = card;
      return best;
    };
    auto best = out_.front.end();  // few folds that are too short are no easy card
    for (const char* const label : {"easy", "medium", "hard"})
      if (best == out_.front.end()) best = recommended(label);
    out_.recommended = static_cast<std::size_t>(
        std::distance(out_.front.begin(), best == out_.front.end() ? best - 1 : best));
    out_.seen_share = seen_share_of(ways_[out_.front.back().candidate.way]);
    return std::move(out_);
  }

  /// Of the model's area, along the diagonal of a way, or those of all cards.
  [[nodiscard]] double seen_share_of(const Way& way) const {
    TriangleMesh standing;
    standing.corners = standing_model(careful(), way);
    if (is_book()) return seen_share(standing, diagonals_of_book(request_.cards));
    const std::array diagonal{Vec3(1.0, 0.0, 1.0)};
    return seen_share(standing, diagonal);
  }

  /// Why a card that was made is not offered.
  [[nodiscard]] std::string not_offered(const CuttingCost& cost) const {
    if (cost.seconds > request_.most_s)
      return fmt::format("it takes {:.1f} minutes to cut", cost.seconds / 60.0);
    if (!holds(cost)) return fmt::format("its panels move {:.1f} mm in paper", cost.wobble_mm);
    return fmt::format("it has {} folds, the shortest {:.3g} mm", cost.hands.folds,
                       cost.hands.shortest_mm);
  }

  /// Leaves those `made` that are offered: cut in time, firm, and as easy to fold as was asked, or
  /// the one of the fewest folds where none is.
  Result<void> offer(const std::vector<Trial>& trials, std::vector<Judged>& judged) {
    const char* const what = is_book() ? "book" : "card";
    // Of those that are made, the least by a figure.
    const auto least = [&](auto&& figure) {
      double out = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < trials.size(); ++k)
        if (judged[k].made) out = std::min(out, static_cast<double>(figure(trials[k].cost)));
      return out;
    };
    const auto keep = [&](auto&& is_kept) {
      std::vector<std::size_t> kept;
      for (std::size_t k = 0; k < trials.size(); ++k)
        if (judged[k].made && is_kept(trials[k].cost)) kept.push_back(k);
      if (kept.empty()) return false;
      for (std::size_t k = 0; k < trials.size(); ++k)
        judged[k].made = std::binary_search(kept.begin(), kept.end(), k);
      return true;
    };
    const auto seconds = [](const CuttingCost& cost) { return cost.seconds; };
    const auto folds = [](const CuttingCost& cost) { return cost.hands.folds; };
    if (!std::isfinite(least(seconds))) return {};
    if (!keep([&](const CuttingCost& cost) { return cost.seconds <= request_.most_s; }))
      return fail(ErrorKind::Infeasible, "",
                  fmt::format("no {} of it is cut within {:.3g} minutes: the quickest that was "
                              "found takes {:.1f}; allow more, or use a smaller mat",
                              what, request_.most_s / 60.0, least(seconds) / 60.0));
    if (!keep([&](const CuttingCost& cost) { return holds(cost); }))
      return fail(
          ErrorKind::Infeasible, "",
          fmt::format("no {} of it holds in paper: panels of the firmest that was found move "
                      "{:.1f} mm; '--any-hold' offers such cards too",
                      what, least([](const CuttingCost& c) { return c.wobble_mm; })));
    if (keep([&](const CuttingCost& cost) { return is_as_easy_as_asked(cost); })) return {};
    const double fewest = least(folds);
    keep([&](const CuttingCost& cost) { return static_cast<double>(folds(cost)) <= fewest; });
    out_.notes.push_back(fmt::format(
        "no {0} of it is as easy to fold as you ask; this is the one of the fewest folds: {1:.0f}",
        what, fewest));
    return {};
  }

  /// What share of the model one card can show at best, and how many would show most of it.
  [[nodiscard]] tl::unexpected<Error> no_card(const std::string& why) const {
    constexpr double kMostOfIt = 0.9;
    double seen = 0.0;
    for (const Way& way : ways_) seen = std::max(seen, seen_share_of(way));
    std::string more;
    for (const int cards : {4, 6, 8, 12}) {
      if (cards <= request_.cards) continue;
      const double share = share_of_book(careful(), cards);
      if (share < kMostOfIt && cards < 12) continue;
      more = fmt::format("; {} cards around one spine would see {:.0f} %", cards, 100.0 * share);
      break;
    }
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("no {0} shows it: from in front of {1} one sees at most {2:.0f} % "
                    "of its surface{3}{4}{5}",
                    is_book() ? "book" : "card", is_book() ? "the cards" : "a card", 100.0 * seen,
                    more, why.empty() ? "" : "; the first design failed: ", why));
  }

  [[nodiscard]] const TriangleMesh& coarse() const {
    if (!coarse_) coarse_ = coarse_mesh(request_.mesh, kCoarseCells, kCoarseTriangles);
    return *coarse_;
  }
  [[nodiscard]] const TriangleMesh& careful() const {
    if (!careful_) careful_ = coarse_mesh(request_.mesh, kCarefulCells, kCarefulTriangles);
    return *careful_;
  }

  const SearchRequest& request_;
  mutable std::optional<TriangleMesh> coarse_, careful_;  ///< made once, by the caller's thread
  StyleChoice styles_;
  FoundCards out_;
  hands::Hands hands_;               ///< whose time it is
  std::array<double, 2> room_mm_{};  ///< for a card: the area, or what lies between its marks
  std::vector<Way> ways_;
  std::size_t drawn_ways_{};                       ///< of `ways_`: those that are drawn
  std::uint64_t changed_{std::uint64_t{1} << 32};  ///< the next one's number, beyond those drawn
  double effort_{};                                ///< of this part of the search
  Part share_{};                                   ///< of all parts of the search
  std::vector<Trial> trials_;
  std::array<std::vector<JudgedCard>, 2> judged_;  ///< coarsely, and carefully
  std::vector<PatchAssembly> designs_;             ///< of `judged_[0]`, without their targets
  std::vector<Trial> finals_;
  std::vector<std::size_t> known_;  ///< of `finals_`, after each part of the search
  bool is_whole_mesh_{};
  bool waits_{};         ///< for candidates that others judge
  std::string refusal_;  ///< why the first one failed
};

}  // namespace

std::vector<float> model_around(const TriangleMesh& mesh, const FoundCard& card) {
  return likeness::placed(mesh.corners, card.placement);
}

Result<JudgedCards> judge_cards(const SearchRequest& request, const WantedCards& wanted) {
  return CardSearch(request).judge_only(wanted);
}

Result<std::vector<FinishedCard>> finish_cards(const SearchRequest& request,
                                               const WantedCards& wanted) {
  return CardSearch(request).finish_only(wanted);
}

Result<FoundCards> search_cards(SearchRequest request) {
  auto found = CardSearch(request).run();
  if (found) found->mesh = std::move(request.mesh);
  return found;
}

}  // namespace popcut::planning
