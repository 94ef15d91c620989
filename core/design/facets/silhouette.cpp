// SPDX-License-Identifier: MIT
#include "core/design/facets/silhouette.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/design/facets/label_card.hpp"
#include "core/design/facets/strip_chain.hpp"
#include "core/design/facets/strip_moves.hpp"
#include "core/geometry/interval_medians.hpp"

namespace popcut {
namespace {

constexpr int kLayerSweeps = 6;
constexpr double kBorder_mm = 1.0;     ///< what 1 mm of a contour may cost in mm of depth
constexpr double kHeights_mm = 4.0;    ///< struts nearer than this hold about alike
constexpr double kLeastPins = 0.5;     ///< a strut that saves less holds nothing
constexpr int kEach = 2;               ///< of the strips and columns where struts are tried
constexpr double kStrut_mm3 = 2000.0;  ///< what a strut costs beside the paper that it takes
constexpr int kMostRounds = 200;

/// The layer of each point of the sheet.
class LayerLabels {
 public:
  LayerLabels(const SeenTarget& target, const Labelling& labelling)
      : target_(target),
        labelling_(labelling),
        layers_(uprights(labelling.planes()), {}),
        solver_(layers_, labelling.image().grid) {}

  LabelImage run() {
    LabelImage image = labelling_.image();
    for (int s = 0; s < image.grid.strips; ++s) compute(s);
    for (int sweep = 0; sweep < kLayerSweeps; ++sweep)
      for (const int parity : {0, 1})
        for (int s = parity; s < image.grid.strips; s += 2) {
          const std::vector<Label> labels = solve(image, s, sweep > 0);
          std::copy(labels.begin(), labels.end(), image.strip(s).begin());
        }
    return image;
  }

 private:
  static std::vector<int> uprights(const FacetPlanes& planes) {
    std::vector<int> out;
    for (std::size_t l = 2; l < planes.size(); ++l)
      if (const FacetPlane& plane = planes[static_cast<Label>(l)]; plane.upright)
        out.push_back(plane.offset);
    return out;
  }

  /// What a cell costs under each label: how far the layer is from what is seen; and more than any
  /// layer where something stands and the card is taken, or the other way round.
  void compute(int s) {
    const SheetRaster& raster = target_.raster;
    const FacetGrid& grid = labelling_.image().grid;
    const std::size_t across = raster.columns / static_cast<std::size_t>(grid.columns),
                      along = raster.rows / static_cast<std::size_t>(grid.strips);
    const double area = raster.column_mm * raster.row_mm;
    const double other_mm =
        2.0 * grid.step_mm * layers_[static_cast<Label>(layers_.size() - 1)].offset;
    std::vector<double> cost(layers_.size() * static_cast<std::size_t>(grid.columns), 0.0);
    for (int i = 0; i < grid.columns; ++i) {
      double* const out = cost.data() + static_cast<std::size_t>(i) * layers_.size();
      for (std::size_t r = 0; r < along; ++r)
        for (std::size_t c = 0; c < across; ++c) {
          const std::size_t row = static_cast<std::size_t>(s) * along + r,
                            at = static_cast<std::size_t>(i) * across + c;
          const bool is_empty = target_.facing[row * raster.columns + at] == Facing::Card;
          const double x_mm = target_.x_mm(row, at);
          for (std::size_t l = 0; l < layers_.size(); ++l) {
            const bool is_paper = l >= 2;
            out[l] +=
                area *
                (is_paper != is_empty
                     ? is_paper
                           ? std::abs(grid.step_mm * layers_[static_cast<Label>(l)].offset - x_mm)
                           : 0.0
                     : other_mm);
          }
        }
      for (std::size_t l = 0; l < layers_.size(); ++l) {
        const FacetPlane& plane = layers_[static_cast<Label>(l)];
        const int begin = grid.across(i);
        const bool is_behind = plane.upright ? begin + 1 > plane.offset : begin < 0;
        const double shut_mm = grid.step_mm * (2 * plane.offset - begin);
        if (is_behind || (l >= 2 && shut_mm > labelling_.limits().most_reach_mm))
          out[l] += kForbidden;
      }
    }
    cost_.push_back(std::move(cost));
  }

  std::vector<Label> solve(const LabelImage& image, int s, bool coupled) {
    const FacetGrid& grid = image.grid;
    std::vector<double> cost = cost_[static_cast<std::size_t>(s)];
    const double border = kBorder_mm * grid.step_mm;
    for (const int other : {s - 1, s + 1}) {
      if (!coupled || other < 0 || other >= grid.strips) continue;
      const auto beside = image.strip(other);
      for (std::size_t i = 0; i < beside.size(); ++i)
        cost[i * layers_.size() + static_cast<std::size_t>(beside[i])] -= border;
    }
    return solver_.solve({cost, labelling_.limits().least_run, 0.0, kBorder_mm * grid.strip_mm})
        .label;
  }

  const SeenTarget& target_;
  const Labelling& labelling_;
  FacetPlanes layers_;
  std::vector<std::vector<double>> cost_;
  FacetChainSolver solver_;
};

/// The distances from the target of one plane after another: those of a labelling lie column by
/// column, so that to walk along a strip takes many times longer there.
class PlaneDistances {
 public:
  explicit PlaneDistances(const Labelling& labelling)
      : labelling_(labelling),
        columns_(static_cast<std::size_t>(labelling.image().grid.columns)),
        strips_(static_cast<std::size_t>(labelling.image().grid.strips)) {}

  /// As `Labelling::cell_distance`.
  [[nodiscard]] double at(int strip, int column, Label label) {
    const float* const distances = of_plane(strip, label);
    return distances == nullptr ? labelling_.cell_distance(strip, column, label)
                                : static_cast<double>(distances[static_cast<std::size_t>(column)]);
  }
  /// The distances of all columns; null where none are kept.
  [[nodiscard]] const float* of_plane(int strip, Label label) {
    if (!labelling_.keeps_costs(strip)) return nullptr;
    std::vector<float>& distances = strips_[static_cast<std::size_t>(strip)];
    if (distances.empty()) turn(labelling_.kept_costs(strip), distances);
    return distances.data() + static_cast<std::size_t>(label) * columns_;
  }

 private:
  /// Column by column to plane by plane, in squares that fit in a cache.
  void turn(std::span<const float> from, std::vector<float>& to) const {
    constexpr std::size_t kSquare = 16;
    const std::size_t planes = from.size() / columns_;
    to.resize(from.size());
    for (std::size_t i = 0; i < columns_; i += kSquare)
      for (std::size_t l = 0; l < planes; l += kSquare)
        for (std::size_t column = i; column < std::min(i + kSquare, columns_); ++column)
          for (std::size_t plane = l; plane < std::min(l + kSquare, planes); ++plane)
            to[plane * columns_ + column] = from[column * planes + plane];
  }

  const Labelling& labelling_;
  std::size_t columns_;
  std::vector<std::vector<float>> strips_;
};

/// Holds the layers of a labelling.
class LayerHolder {
 public:
  LayerHolder(LabelCard& card, const SilhouetteOptions& how, Silhouette& out)
      : card_(card),
        how_(how),
        out_(out),
        distances_(card.labelling),
        width_(std::max(
            1, static_cast<int>(std::ceil(how.min_fold_mm / card.grid().strip_mm - 1e-9)))) {
    for (std::size_t l = 0; l < planes().size(); ++l)
      if (planes()[static_cast<Label>(l)].upright) uprights_.push_back(static_cast<Label>(l));
  }

  void run(const Progress& progress) {
    drop_all_small();
    for (int round = 0; round < kMostRounds && card_.holding.open > 0; ++round) {
      tell(progress, "holding the layers");
      if (improve()) continue;
      if (!give_up_smallest()) break;
      drop_all_small();
    }
    widen_or_cut_folds();
    close_short_gaps();
  }

 private:
  [[nodiscard]] const FacetGrid& grid() const { return card_.grid(); }
  [[nodiscard]] const FacetPlanes& planes() const { return card_.planes(); }
  [[nodiscard]] int least() const { return card_.labelling.limits().least_run; }
  [[nodiscard]] double mm(int steps) const { return grid().step_mm * steps; }

  /// Leaves out the smallest loose layer, and all struts that hold nothing; where there is neither,
  /// the layer beside it takes a flap of wall or ground that hangs on one fold, such as between a
  /// cat and its tail. Whether there was any.
  bool give_up_smallest() {
    enum class Kind { Layer, Strut, Flap };
    const auto kind_of = [&](const LoosePatch& one) {
      const Label label = one.cells.front().label;
      return is_card(label) ? Kind::Flap : planes()[label].upright ? Kind::Layer : Kind::Strut;
    };
    bool any = false;
    for (const Kind kind : {Kind::Layer, Kind::Strut, Kind::Flap})
      for (int round = 0; round < kMostRounds && !(any && kind == Kind::Flap); ++round) {
        const std::vector<LoosePatch> loose = loose_patches(card_);
        const auto smallest = std::find_if(loose.begin(), loose.end(), [&](const LoosePatch& one) {
          return kind_of(one) == kind;
        });
        if (smallest == loose.end()) break;
        drop(*smallest);
        any = true;
        if (kind != Kind::Strut) break;
      }
    return any;
  }

  void drop_all_small() {
    for (int round = 0; round < kMostRounds && drop_small(); ++round) {
    }
  }

  [[nodiscard]] bool changes(const NewStrips& strips) const {
    return std::any_of(strips.begin(), strips.end(), [&](const NewStrip& one) {
      return one.labels != labels_of(card_.image(), one.strip);
    });
  }

  /// Leaves out a piece: what is beside it takes its place, or the card.
  void drop(const LoosePatch& piece) {
    ++out_.dropped;
    if (const NewStrips beside = painted_over(card_, piece, true); changes(beside)) {
      card_.take(beside);
      return;
    }
    LabelImage image = card_.image();
    for (const LabelBan& cell : piece.cells)
      for (int i = cell.begin; i < cell.end; ++i)
        image.strip(cell.strip)[static_cast<std::size_t>(i)] =
            i < grid().wall ? kWallLabel : kGroundLabel;
    card_.take(image);
  }

  /// Leaves out one piece that is too small to be cut. Whether there was one.
  bool drop_small() {
    const double cell_mm2 = grid().step_mm * grid().strip_mm;
    for (const auto& [patch, piece] : patch_cells(card_, false)) {
      if (patch == patch_of_margin(0) || patch == patch_of_margin(1)) continue;
      if (piece.area * cell_mm2 >= how_.min_area_mm2 || is_strut(piece)) continue;
      const NewStrips without = painted_over(card_, piece, true);
      if (!changes(without)) continue;
      card_.take(without);
      return true;
    }
    return false;
  }
  [[nodiscard]] std::uint32_t patch_of_margin(std::size_t run) const {
    return card_.holding.patches.patch[run];
  }
  [[nodiscard]] bool is_strut(const LoosePatch& piece) const {
    return !planes()[piece.cells.front().label].upright && !is_card(piece.cells.front().label);
  }

  /// A new strut, or a foot: what it costs, and how high it holds, in steps.
  struct Strut {
    NewStrips strips;
    double cost{};
    int height{};
    int first_strip{}, line{};

    /// Of two that cost the same, the one in the first strips.
    [[nodiscard]] bool goes_before(const Strut& other) const {
      return std::tie(cost, first_strip, line) <
             std::tie(other.cost, other.first_strip, other.line);
    }
  };

  /// By what is behind, and about how high.
  using Cheapest = std::map<std::pair<Label, int>, Strut>;

  /// Where a piece lies in a strip: its longest run.
  struct Stretch {
    int begin{}, end{};
  };

  /// Makes the strut or foot that costs least for what it holds. Whether one holds anything.
  bool improve() {
    std::vector<Strut> all;
    find_costs();
    for (const LoosePatch& patch : loose_patches(card_)) add_struts(patch, all);
    const double before = looseness(card_.holding);
    std::optional<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double held = before - looseness(card_.holding_with(all[k].strips));
      const double price = (kStrut_mm3 + std::max(0.0, all[k].cost)) / held;
      if (held > kLeastPins && price < least) least = price, best = k;
    }
    if (!best) return false;
    card_.take(all[*best].strips);
    ++out_.struts;
    return true;
  }

  /// Struts and feet for a loose layer: of all that hold it about as high, the one that costs
  /// least.
  void add_struts(const LoosePatch& patch, std::vector<Strut>& out) {
    const Label label = patch.cells.front().label;
    if (!planes()[label].upright || is_card(label)) return;
    std::vector<Stretch> at(static_cast<std::size_t>(grid().strips));
    for (const LabelBan& cell : patch.cells) {
      Stretch& longest = at[static_cast<std::size_t>(cell.strip)];
      if (cell.end - cell.begin > longest.end - longest.begin) longest = {cell.begin, cell.end};
    }
    Cheapest cheapest;
    std::vector<Stretch> wide;  // what the strips from each place on have in common
    for (int s = 0; s + width_ <= grid().strips; s += kEach) {
      Stretch common{0, grid().columns};
      for (int k = s; k < s + width_; ++k) {
        common.begin = std::max(common.begin, at[static_cast<std::size_t>(k)].begin);
        common.end = std::min(common.end, at[static_cast<std::size_t>(k)].end);
      }
      wide.push_back(common);
      if (common.end - common.begin < least()) continue;
      if (auto foot = foot_at(s, label, at)) {
        Strut& best = cheapest[{kGroundLabel, 0}];
        if (best.strips.empty() || foot->cost < best.cost) best = std::move(*foot);
      }
    }
    for (int line = 0; line + least() <= grid().columns; ++line) {
      const int height = planes()[label].offset - grid().across(line);
      const Label level = planes().find({false, height});
      if (height < least() || level == kNoLabel) continue;
      LevelCosts costs(card_, distances_, costs_, level, line);
      for (std::size_t k = 0; k < wide.size(); ++k)
        if (line >= wide[k].begin && line + least() <= wide[k].end &&
            (line - wide[k].begin) % kEach == 0)
          add_backs(kEach * static_cast<int>(k), label, costs, cheapest);
    }
    for (auto& [place, strut] : cheapest)
      if (!strut.strips.empty()) out.push_back(std::move(strut));
  }

  /// The distance from the target of each cell as it is, strip by strip, into `costs_`.
  void find_costs() {
    const std::vector<Label>& labels = card_.image().label;
    const bool is_first = costs_.empty();
    costs_.resize(labels.size());
    costs_of_.resize(labels.size());
    std::size_t cell = 0;
    for (int s = 0; s < grid().strips; ++s)
      for (int i = 0; i < grid().columns; ++i, ++cell) {
        const Label label = labels[cell];
        if (!is_first && costs_of_[cell] == label) continue;
        costs_of_[cell] = label;
        costs_[cell] = label == kNoLabel ? 0.0 : card_.labelling.cell_distance(s, i, label);
      }
  }

  /// What level paper up to a line costs more than what is there, for all struts that end there.
  class LevelCosts {
   public:
    LevelCosts(const LabelCard& card, PlaneDistances& distances, std::span<const double> now,
               Label level, int line)
        : level(level),
          line(line),
          card_(card),
          distances_(distances),
          now_(now),
          from_(static_cast<std::size_t>(card.grid().strips)) {}

    /// Of a strip, from a column up to the line.
    [[nodiscard]] double from(int strip, int begin) {
      std::vector<double>& sums = from_[static_cast<std::size_t>(strip)];
      if (sums.empty()) {
        sums.reserve(static_cast<std::size_t>(line) + 1);
        sums.push_back(0.0);
      }
      if (static_cast<int>(sums.size()) <= line - begin) extend(sums, strip, begin);
      return sums[static_cast<std::size_t>(line - begin)];
    }
    [[nodiscard]] double extra(int strip, int column, Label then) const {
      const auto row = static_cast<std::size_t>(strip), at = static_cast<std::size_t>(column);
      if (card_.image().strip(strip)[at] == then) return 0.0;
      return distances_.at(strip, column, then) -
             now_[row * static_cast<std::size_t>(card_.grid().columns) + at];
    }

    const Label level;
    const int line;

   private:
    /// Sums on to a column.
    void extend(std::vector<double>& sums, int strip, int begin) {
      const std::span<const Label> labels = card_.image().strip(strip);
      const double* const now = now_.data() + static_cast<std::size_t>(strip) * labels.size();
      const float* const then = distances_.of_plane(strip, level);
      while (static_cast<int>(sums.size()) <= line - begin) {
        const auto at = static_cast<std::size_t>(line) - sums.size();
        const double more = labels[at] == level ? 0.0
                            : then == nullptr   ? extra(strip, static_cast<int>(at), level)
                                                : static_cast<double>(then[at]) - now[at];
        sums.push_back(sums.back() + more);
      }
    }

    const LabelCard& card_;
    PlaneDistances& distances_;
    const std::span<const double> now_;
    std::vector<std::vector<double>> from_;  ///< by strip and by how far before the line
  };

  /// Level paper from a layer, at a line of it, back to the wall or to a layer behind it.
  void add_backs(int s, Label label, LevelCosts& costs, Cheapest& cheapest) const {
    const int c = planes()[label].offset, line = costs.line, height = c - grid().across(line);
    for (const Label back : uprights_) {
      if (planes()[back].offset >= c) continue;
      const int begin = grid().wall + planes()[back].offset - height;
      if (begin - least() < 0 || line - begin < least()) continue;
      Strut strut{{}, 0.0, height, s, line};
      bool is_there = true;
      for (int k = s; k < s + width_ && is_there; ++k) {
        const auto now = card_.image().strip(k);
        for (int i = begin - least(); i < begin && is_there; ++i) {
          is_there = back == kWallLabel || now[static_cast<std::size_t>(i)] == back;
          strut.cost += costs.extra(k, i, back);
        }
        if (is_there) strut.cost += costs.from(k, begin);
      }
      if (!is_there) continue;
      Strut& best = cheapest[{back, static_cast<int>(mm(height) / kHeights_mm)}];
      if (!best.strips.empty() && !strut.goes_before(best)) continue;
      for (int k = s; k < s + width_; ++k) {
        std::vector<Label> labels = labels_of(card_.image(), k);
        std::fill_n(labels.begin() + (begin - least()), least(), back);
        std::fill(labels.begin() + begin, labels.begin() + line, costs.level);
        if (!is_wide(labels, least()) || !is_allowed(labels)) break;
        strut.strips.push_back({k, std::move(labels)});
      }
      if (strut.strips.size() == static_cast<std::size_t>(width_)) best = std::move(strut);
    }
  }

  /// A layer goes on down to the ground.
  std::optional<Strut> foot_at(int s, Label label, const std::vector<Stretch>& at) {
    const int fold = grid().wall + planes()[label].offset;
    if (fold + least() > grid().columns) return std::nullopt;
    Strut foot;
    for (int k = s; k < s + width_; ++k) {
      std::vector<Label> labels = labels_of(card_.image(), k);
      const Stretch& here = at[static_cast<std::size_t>(k)];
      if (here.end >= fold) return std::nullopt;
      std::fill(labels.begin() + here.end, labels.begin() + fold, label);
      std::fill(labels.begin() + fold, labels.begin() + fold + least(), kGroundLabel);
      if (!is_wide(labels, least()) || !is_allowed(labels)) return std::nullopt;
      foot.strips.push_back({k, std::move(labels)});
    }
    foot.cost = extra_cost(card_.labelling, foot.strips);
    return foot;
  }

  [[nodiscard]] bool is_allowed(const std::vector<Label>& labels) const {
    const std::vector<LabelRun> runs = runs_of(labels, planes(), grid());
    return std::all_of(runs.begin(), runs.end(),
                       [&](const LabelRun& run) { return card_.labelling.allows(run); });
  }

  /// A fold that is too short becomes long enough, or a cut: whichever costs less and leaves all
  /// held.
  void widen_or_cut_folds() {
    for (std::size_t l = 2; l < planes().size(); ++l) {
      const auto label = static_cast<Label>(l);
      if (!planes()[label].upright) continue;
      const int fold = grid().wall + planes()[label].offset;
      if (fold >= grid().columns) continue;
      for (int s = 0; s < grid().strips;) {
        if (!stands_at(label, fold, s)) {
          ++s;
          continue;
        }
        const int begin = s;
        while (s < grid().strips && stands_at(label, fold, s)) ++s;
        if (s - begin < width_) mend_foot(label, fold, begin, s);
      }
    }
  }
  /// Where the spine's fold between two layers would be too short, one of them takes the gap.
  void close_short_gaps() {
    const auto wall = static_cast<std::size_t>(grid().wall);
    const auto is_gap = [&](int s) {
      const auto strip = card_.image().strip(s);
      return strip[wall - 1] == kWallLabel && strip[wall] == kGroundLabel;
    };
    for (int s = 0; s < grid().strips;) {
      const int begin = s++;
      if (!is_gap(begin)) continue;
      while (s < grid().strips && is_gap(s)) ++s;
      if (begin == 0 || s == grid().strips || s - begin >= width_) continue;
      std::vector<Strut> ways;
      for (const int beside : {begin - 1, s}) {
        Strut way;
        for (int k = begin; k < s; ++k) way.strips.push_back({k, labels_of(card_.image(), beside)});
        way.cost = extra_cost(card_.labelling, way.strips);
        ways.push_back(std::move(way));
      }
      take_cheapest(ways);
    }
  }

  /// Makes the cheapest change that loosens nothing.
  void take_cheapest(std::vector<Strut>& ways) {
    std::stable_sort(ways.begin(), ways.end(),
                     [](const Strut& a, const Strut& b) { return a.cost < b.cost; });
    for (Strut& way : ways) {
      LabelHolding then = card_.holding_with(way.strips);
      if (then.open > card_.holding.open) continue;
      card_.take(way.strips, std::move(then));
      return;
    }
  }

  [[nodiscard]] bool stands_at(Label label, int fold, int s) const {
    const auto strip = card_.image().strip(s);
    return strip[static_cast<std::size_t>(fold) - 1] == label &&
           strip[static_cast<std::size_t>(fold)] == kGroundLabel;
  }
  void mend_foot(Label label, int fold, int begin, int end) {
    std::vector<Strut> ways;
    const auto try_strips = [&](int from, int to, auto&& change) {
      if (from < 0 || to > grid().strips) return;
      Strut way;
      for (int s = from; s < to; ++s) {
        std::vector<Label> labels = labels_of(card_.image(), s);
        change(labels);
        if (!is_wide(labels, least()) || !is_allowed(labels)) return;
        way.strips.push_back({s, std::move(labels)});
      }
      way.cost = extra_cost(card_.labelling, way.strips);
      ways.push_back(std::move(way));
    };
    if (fold - least() >= grid().wall)
      try_strips(begin, end, [&](std::vector<Label>& labels) {  // it ends above the ground
        std::fill(labels.begin() + fold - least(), labels.begin() + fold, kGroundLabel);
      });
    for (int from = end - width_; from <= begin; ++from)
      try_strips(from, from + width_, [&](std::vector<Label>& labels) {
        int up = fold;  // from the layer above it down to the ground
        while (up > 0 && labels[static_cast<std::size_t>(up) - 1] != label) --up;
        if (up == 0) up = fold - least();
        std::fill(labels.begin() + up, labels.begin() + fold, label);
      });
    take_cheapest(ways);
  }

  LabelCard& card_;
  const SilhouetteOptions& how_;
  Silhouette& out_;
  PlaneDistances distances_;
  std::vector<double> costs_;  ///< of the cells, with the labels `costs_of_`
  std::vector<Label> costs_of_;
  std::vector<Label> uprights_;  ///< few, while there are many levels
  int width_;                    ///< strips of a strut
};

}  // namespace

FacetPlanes silhouette_planes(const SeenTarget& target, const FacetGrid& grid, int layers,
                              int most_x, int most_z) {
  std::map<int, double> weight;
  int high = 0;
  for (std::size_t r = 0; r < target.raster.rows; ++r)
    for (std::size_t c = 0; c < target.raster.columns; ++c) {
      if (target.facing[r * target.raster.columns + c] == Facing::Card) continue;
      const int x = static_cast<int>(std::llround(target.x_mm(r, c) / grid.step_mm)),
                z = static_cast<int>(std::llround(target.z_mm(r, c) / grid.step_mm));
      weight[std::clamp(x, 1, std::max(1, most_x))] += 1.0;
      high = std::max(high, z);
    }
  std::vector<int> levels;
  for (int at = 1; at <= std::min(high, most_z); ++at) levels.push_back(at);
  return {interval_medians(weight, layers), levels};
}

Silhouette make_silhouette(Labelling& labelling, const SeenTarget& target,
                           const SilhouetteOptions& how, HoldRule rule, const Progress& progress) {
  rule.min_fold_mm = std::max(rule.min_fold_mm, how.min_fold_mm);
  LabelImage image = LayerLabels(target, labelling).run();
  // Holes go now; a layer that wall or ground encloses may get a strut.
  LabelImage filled = image;
  fill_enclosed(filled, labelling.planes(), rule.min_panel_mm);
  if (!how.hold) image = filled;
  for (std::size_t k = 0; k < image.label.size(); ++k)
    if (!is_card(filled.label[k])) image.label[k] = filled.label[k];
  for (int s = 0; s < image.grid.strips; ++s) labelling.set(s, labels_of(image, s));
  Silhouette out;
  if (!how.hold) return out;
  LabelCard card(labelling, rule);
  LayerHolder(card, how, out).run(progress);
  filled = labelling.image();
  if (fill_enclosed(filled, labelling.planes(), rule.min_panel_mm)) {
    card.take(filled);
    LayerHolder(card, how, out).run(progress);
  }
  return out;
}

}  // namespace popcut
