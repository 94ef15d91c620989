// SPDX-License-Identifier: MIT
#include "core/design/facets/facet_repair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "core/design/facets/enclosed.hpp"
#include "core/design/facets/label_card.hpp"
#include "core/design/facets/strip_moves.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostDrops = 8, kMostPaintings = 60, kMostTried = 600,
                      kMostTriedRoughly = 150;
constexpr int kManyIdle = 20;  ///< rounds in which nothing held: most cards have fewer
constexpr int kMostTries = 8, kShiftRounds = 14, kMostBridges = 4;
constexpr double kLeastHeld = 0.05;        ///< less is rounding
constexpr double kDearer = 2.0;            ///< than the best move of a round
constexpr std::size_t kMadeOf = 8;         ///< a round makes one of so many good moves
constexpr std::size_t kOnUntilOne = 10;    ///< times `kMostTried`, where none of those holds
constexpr double kHoldsMore = 2.0;         ///< than any move of the round that was looked at
constexpr double kLeastBetter_mm3 = 1e-6;  ///< less is rounding

/// New labels for some strips, and what they cost more.
struct Move {
  enum class Kind { Strut, Shift, Drop } kind{};
  NewStrips strips;
  double cost{};
};

/// What wall or ground enclose gets a strip that goes on from it to both, where that costs less
/// than to do without it: a bridge to one of them would still leave a hole in that face.
void hold_enclosed(Labelling& labelling, double min_panel_mm, std::vector<FacetStrut>& struts) {
  for (int round = 0; round < kMostBridges; ++round) {
    LabelImage filled = labelling.image();
    if (!fill_enclosed(filled, labelling.planes(), min_panel_mm)) return;
    bool any = false;
    for (const EnclosedPiece& piece : enclosed_pieces(labelling.image(), filled, true)) {
      const std::optional<NewStrip> strip = bridge(labelling, piece, filled);
      if (!strip) continue;
      struts.push_back({strip->strip, labels_of(labelling.image(), strip->strip)});
      labelling.set(strip->strip, strip->labels);
      any = true;
    }
    if (!any) return;
  }
}

/// Chooses among the moves of strip_moves.hpp until everything is held.
class Repairer {
 public:
  Repairer(LabelCard& card, const RepairOptions& how, FacetRepair& out)
      : card_(card),
        how_(how),
        out_(out),
        tries_(static_cast<std::size_t>(card.grid().strips), 0),
        holds_nothing_(static_cast<std::size_t>(card.grid().strips)),
        most_tried_(how.rough ? kMostTriedRoughly : kMostTried),
        work_(work_of(card.holding)) {}

  /// Until everything is held, or the work is over.
  void run(const Progress& progress) {
    const int most = 100 + 4 * card_.grid().strips;
    for (round_ = 0; card_.holding.open > 0; ++round_) {
      tell(progress, "making loose panels hold");
      if (work_ / 2 > how_.most_work) {
        out_.unfinished = true;
        return;
      }
      if (round_ > most)
        clear_loose();
      else if (work_ > how_.most_work || !improve())
        give_up_smallest();
    }
  }

 private:
  static std::size_t work_of(const LabelHolding& holding) { return holding.patches.runs.size(); }

  template <typename Labels>
  void take(const Labels& labels) {
    card_.take(labels);
    work_ += work_of(card_.holding);
  }

  /// Remembers the moves of a round in which none held anything, once there were many such rounds.
  /// Those of one strip are not tried again before that strip or one beside it changes, or another
  /// move holds something.
  void remember(std::span<const Move> tried) {
    if (++idle_rounds_ < kManyIdle) return;
    for (const Move& move : tried)
      if (move.strips.size() == 1)
        holds_nothing_[static_cast<std::size_t>(move.strips[0].strip)].insert(
            move.strips[0].labels);
  }
  void forget_beside(int s) {
    for (int k = std::max(0, s - 1); k <= std::min(card_.grid().strips - 1, s + 1); ++k)
      holds_nothing_[static_cast<std::size_t>(k)].clear();
  }
  void forget_all() {
    for (auto& labels : holds_nothing_) labels.clear();
  }
  [[nodiscard]] bool is_remembered(const NewStrips& strips) const {
    return strips.size() == 1 &&
           holds_nothing_[static_cast<std::size_t>(strips[0].strip)].contains(strips[0].labels);
  }

  void add(Move::Kind kind, NewStrips strips, std::vector<Move>& moves) {
    if (is_remembered(strips) ||
        std::any_of(strips.begin(), strips.end(), [&](const NewStrip& one) {
          return was_given_up(one) || card_.labelling.is_fixed(one.strip);
        }))
      return;
    const double cost = extra_cost(card_.labelling, strips);
    moves.push_back({kind, std::move(strips), cost});
  }

  /// Struts and shifts in a strip that has loose runs.
  void add_struts(int s, std::vector<Move>& moves) {
    const std::size_t runs = card_.runs_of_strip(s).size();
    const auto any_loose = [&](std::size_t from, std::size_t to) {
      for (std::size_t r = from; r <= to; ++r)
        if (card_.is_loose(s, r)) return true;
      return false;
    };
    const auto add_strut = [&](std::vector<Label> labels) {
      add(Move::Kind::Strut, {{s, std::move(labels)}}, moves);
    };
    const auto meet = [&](std::size_t a, std::size_t b) {
      if (b >= runs || !any_loose(a, b)) return;
      if (auto labels = with_meeting(card_, s, a, b)) add_strut(std::move(*labels));
    };
    if (is_worn(s) || !any_loose(0, runs - 1)) return;
    bool cuts = false;
    for (std::size_t r = 1; r < runs; ++r) {
      if (!card_.runs_of_strip(s)[r].folds_on) {
        cuts = true;
        meet(r - 1, r);
        if (any_loose(r - 1, r))
          for (std::vector<Label>& labels : with_ledges(card_, s, r)) add_strut(std::move(labels));
      }
      meet(r - 1, r + 1);
      meet(r - 1, r + 2);
    }
    if (cuts) add_strut(card_.labelling.best(s, false));
    if (how_.shifts && round_ < kShiftRounds)
      for (std::size_t r = 1; r + 1 < runs; ++r)
        if (any_loose(r - 1, r + 1))
          for (std::vector<Label>& labels : shifted(card_, s, r))
            add(Move::Kind::Shift, {{s, std::move(labels)}}, moves);
  }

  /// All moves of a round, cheap ones first.
  std::vector<Move> moves() {
    std::vector<Move> out;
    for (int s = 0; s < card_.grid().strips; ++s) add_struts(s, out);
    const std::vector<LoosePatch> loose = loose_patches(card_);
    for (std::size_t k = 0; k < loose.size() && k < kMostPaintings; ++k) {
      if (how_.jumps) add(Move::Kind::Drop, painted_over(card_, loose[k], true), out);
      if (k < kMostDrops && !is_worn(loose[k].cells.front().strip))
        add(Move::Kind::Drop, without_patch(card_, loose[k], how_.jumps), out);
    }
    // Stable, so that every standard library makes the same card.
    std::stable_sort(out.begin(), out.end(),
                     [](const Move& a, const Move& b) { return a.cost < b.cost; });
    return out;
  }

  /// Makes the moves that cost least for what they hold. Whether any was made.
  bool improve() {
    const std::vector<Move> all = moves();
    // What costs so much that it would have to hold far more than any yet is not looked at.
    std::vector<std::pair<double, const Move*>> good;
    double least_price = std::numeric_limits<double>::infinity(), most_held = 1.0;
    std::size_t k = 0;
    for (; k < all.size(); ++k) {
      const Move& move = all[k];
      if (k >= most_tried_ && (!good.empty() || k >= kOnUntilOne * most_tried_)) break;
      if (move.cost > (kDearer * least_price + 1e-6) * kHoldsMore * most_held) break;
      const LabelHolding then = card_.holding_with(move.strips);
      work_ += work_of(then);
      const double held = looseness(card_.holding) - looseness(then);
      if (held <= kLeastHeld) continue;
      const double price = std::max(0.0, move.cost) / held;
      good.emplace_back(price, &move);
      least_price = std::min(least_price, price), most_held = std::max(most_held, held);
    }
    if (good.empty()) {
      remember(std::span(all).first(k));
      return false;
    }
    forget_all();
    std::stable_sort(good.begin(), good.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    const double dearest =
        std::max(kDearer * good.front().first, good[good.size() / kMadeOf].first) + 1e-6;
    bool any = false;
    std::vector<std::uint8_t> touched(static_cast<std::size_t>(card_.grid().strips), 0);
    for (const auto& [price, move] : good) {
      if (price > dearest || card_.holding.open == 0) break;
      if (std::any_of(move->strips.begin(), move->strips.end(), [&](const NewStrip& one) {
            return touched[static_cast<std::size_t>(one.strip)] != 0;
          }))
        continue;
      if (!accept(*move, dearest)) continue;
      any = true;
      for (const NewStrip& one : move->strips) touched[static_cast<std::size_t>(one.strip)] = 1;
    }
    return any;
  }

  /// Makes a move if it still holds enough for what it costs beside those that were made before.
  bool accept(const Move& move, double dearest) {
    LabelHolding then = card_.holding_with(move.strips);
    const double held = looseness(card_.holding) - looseness(then);
    if (held <= kLeastHeld || extra_cost(card_.labelling, move.strips) > dearest * held)
      return false;
    if (move.kind == Move::Kind::Drop) ++out_.dropped;
    if (move.kind == Move::Kind::Shift) ++out_.shifted;
    for (const NewStrip& one : move.strips) {
      if (move.kind != Move::Kind::Drop)
        out_.struts.push_back({one.strip, labels_of(card_.image(), one.strip)});
      ++tries_[static_cast<std::size_t>(one.strip)];
    }
    work_ += work_of(then);
    card_.take(move.strips, std::move(then));
    return true;
  }

  /// Whether a strip was changed so often that it is not to be again, but for giving patches up.
  [[nodiscard]] bool is_worn(int s) const {
    return tries_[static_cast<std::size_t>(s)] > kMostTries;
  }

  /// The smallest loose patch goes: the runs before or after it take its place, so that there are
  /// fewer runs each time. Without jumps its label is not taken again.
  void give_up_smallest() {
    const std::vector<LoosePatch> loose = loose_patches(card_);
    if (loose.empty()) return clear_loose();
    const LoosePatch& smallest = loose.front();
    for (const LabelBan& cell : smallest.cells) {
      given_up_.emplace(cell.strip, labels_of(card_.image(), cell.strip));
      forget_beside(cell.strip);
    }
    if (how_.jumps) {
      take(painted_over(card_, smallest, false));
    } else {
      for (const LabelBan& ban : smallest.cells)
        if (ban.label != kWallLabel && ban.label != kGroundLabel) card_.labelling.ban(ban);
      take(without_patch(card_, smallest, false));
    }
    ++out_.dropped;
  }

  /// Whether a strip had these labels when a patch of it was given up: it does not get them back.
  [[nodiscard]] bool was_given_up(const NewStrip& one) const {
    return given_up_.contains({one.strip, one.labels});
  }

  /// Plain card in the strips that have anything loose; in all of them if no strip has.
  void clear_loose() {
    LabelImage image = card_.image();
    bool any = false;
    for (const bool all : {false, true}) {
      for (int s = 0; s < card_.grid().strips; ++s) {
        const std::size_t runs = card_.runs_of_strip(s).size();
        bool loose = all;
        for (std::size_t r = 0; r < runs && !loose; ++r) loose = card_.is_loose(s, r);
        if (!loose || runs == 2) continue;
        any = true;
        const auto strip = image.strip(s);
        std::fill(strip.begin(), strip.begin() + card_.grid().wall, kWallLabel);
        std::fill(strip.begin() + card_.grid().wall, strip.end(), kGroundLabel);
      }
      if (any) break;
    }
    ++out_.dropped;
    fill_enclosed(image, card_.planes(), card_.rule.min_panel_mm);
    forget_all();
    take(image);
  }

  LabelCard& card_;
  RepairOptions how_;
  FacetRepair& out_;
  std::vector<int> tries_;                                   ///< changes of each strip
  std::vector<std::set<std::vector<Label>>> holds_nothing_;  ///< labels for each strip (`remember`)
  std::set<std::pair<int, std::vector<Label>>> given_up_;
  int round_{}, idle_rounds_{};
  std::size_t most_tried_, work_;
};

/// Takes strips that come nearer to the target without loosening anything.
void polish(LabelCard& card, bool with_jumps) {
  constexpr int kRounds = 3;
  bool any = true;
  for (int round = 0; round < kRounds && any; ++round) {
    any = false;
    for (int s = 0; s < card.grid().strips; ++s)
      for (const bool jumps : {true, false}) {
        if (jumps && !with_jumps) continue;
        const NewStrips strips{{s, card.labelling.best(s, jumps)}};
        if (extra_cost(card.labelling, strips) >= -kLeastBetter_mm3) continue;
        LabelHolding then = card.holding_with(strips);
        if (then.open > 0) continue;
        card.take(strips, std::move(then));
        any = true;
        break;
      }
  }
}

/// Whether wall or ground takes the place of something.
bool falls_into_card(const LabelImage& image, const LabelImage& filled) {
  for (std::size_t k = 0; k < image.label.size(); ++k)
    if (filled.label[k] != image.label[k] &&
        (filled.label[k] == kWallLabel || filled.label[k] == kGroundLabel))
      return true;
  return false;
}

}  // namespace

Result<FacetRepair> repair(Labelling& labelling, const FacetCardSize& size, const HoldRule& rule,
                           const RepairOptions& how, const Progress& progress) {
  FacetRepair out;
  if (how.jumps) hold_enclosed(labelling, rule.min_panel_mm, out.struts);
  LabelImage whole = labelling.image();
  fill_enclosed(whole, labelling.planes(), rule.min_panel_mm);
  const LabelImage begin = how.shifts ? with_worthy_pieces(labelling, whole) : whole;
  const auto first = pattern_of(whole, labelling.planes(), size, rule.min_panel_mm);
  if (!first) return tl::unexpected(first.error());
  out.loose_before = first->motion.degrees_of_freedom - 1;
  for (int s = 0; s < begin.grid.strips; ++s) labelling.set(s, labels_of(begin, s));
  LabelCard card(labelling, rule);
  Repairer(card, how, out).run(progress);
  if (how.rough || out.unfinished) return out;
  polish(card, how.jumps);
  return out;
}

void keep_real_struts(const LabelImage& image, const FacetPlanes& planes, const FacetCardSize& size,
                      double min_panel_mm, FacetRepair& out) {
  std::erase_if(out.struts, [&](const FacetStrut& strut) {
    LabelImage without = image;
    std::copy(strut.without.begin(), strut.without.end(), without.strip(strut.strip).begin());
    LabelImage filled = without;
    if (fill_enclosed(filled, planes, min_panel_mm)) {
      ++(falls_into_card(without, filled) ? out.bridges : out.inner);
      return true;
    }
    const auto made = pattern_of(without, planes, size, min_panel_mm);
    return !made || made->motion.degrees_of_freedom == 1;
  });
}

}  // namespace popcut
