// SPDX-License-Identifier: MIT
#include "core/design/slices/slice_lattice.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace popcut {
namespace {

constexpr double kFar_mm = 1e4;  ///< beyond all paper
constexpr double kSlack_mm = 1e-3;
constexpr double kSlack_mm2 = 1e-2;

/// Connected paper before slots are cut.
struct Blank {
  std::size_t slice{};
  FlatRings paper;
  std::size_t step{};
  bool is_island{};
  FlatRings cuts;
};

/// The part of two lists of stretches that both have.
std::vector<PaperSpan> in_both(const std::vector<PaperSpan>& a, const std::vector<PaperSpan>& b) {
  std::vector<PaperSpan> out;
  for (const PaperSpan& s : a)
    for (const PaperSpan& t : b)
      if (const PaperSpan both{std::max(s.from, t.from), std::min(s.to, t.to)};
          both.length() > kSlack_mm)
        out.push_back(both);
  return out;
}

double paper_above(const std::vector<PaperSpan>& spans, double z) {
  double sum = 0.0;
  for (const PaperSpan& s : spans) sum += std::max(0.0, s.to - std::max(s.from, z));
  return sum;
}

double paper_below(const std::vector<PaperSpan>& spans, double z) {
  double sum = 0.0;
  for (const PaperSpan& s : spans) sum += std::max(0.0, std::min(s.to, z) - s.from);
  return sum;
}

/// Which family comes first.
struct FamilyOrder {
  SliceFamily ground{}, islands{};
  /// All of the other family comes in one step, between islands of the first that it goes over and
  /// those that go over it.
  bool is_between{};
};

class Lattice {
 public:
  Lattice(const std::vector<Slice>& slices, const SlotSize& slot, double least_mm2,
          FamilyOrder order)
      : slices_(slices), slot_(slot), least_mm2_(least_mm2), order_(order) {}

  SliceLattice run() {
    add_blanks();
    if (order_.is_between) put_below();
    for (std::size_t x = 0; x < blanks_.size(); ++x)
      for (std::size_t y = 0; y < blanks_.size(); ++y)
        if (family(x) == SliceFamily::X && family(y) == SliceFamily::Y) cut(x, y);
    add_pieces();
    find_crossings();
    drop_loose();
    return std::move(out_);
  }

 private:
  /// Paper that is shared by two blanks on the line in which their slices cross.
  struct Meeting {
    std::size_t x{}, y{};
    PaperSpan span;
    double split_mm{};
  };

  /// A piece, and what it was cut from.
  struct CutPiece {
    std::size_t blank{};
    SlicePiece piece;
  };

  [[nodiscard]] SliceFamily family(std::size_t blank) const {
    return slices_[blanks_[blank].slice].family;
  }
  [[nodiscard]] double at_mm(std::size_t blank) const {
    return slices_[blanks_[blank].slice].at_mm;
  }

  void add_blanks() {
    for (std::size_t s = 0; s < slices_.size(); ++s) {
      const auto step_of = [&](bool is_island) -> std::size_t {
        // Slots from below would end at the tab of a foot, so nothing is there before a foot that
        // it would come down on, but the other foot beside its tab.
        if (slices_[s].is_foot && !is_island && slices_[s].family != order_.ground) return 0;
        if (order_.is_between) return slices_[s].family == order_.ground ? (is_island ? 3 : 1) : 2;
        const SliceFamily first = is_island ? order_.islands : order_.ground;
        return (is_island ? 3 : 1) + (slices_[s].family == first ? 0 : 1);
      };
      for (const bool is_island : {false, true})
        for (FlatRings& piece : pieces_of(is_island ? slices_[s].islands : slices_[s].ground)) {
          out_.paper_mm2 += area_of(piece);
          if (area_of(piece) < least_mm2_)
            drop(s, piece, DroppedPiece::Reason::Small);
          else
            blanks_.push_back({s, std::move(piece), step_of(is_island), is_island, {}});
        }
    }
  }

  /// Islands of the first family go below the other one where less of it has to be cut for that.
  void put_below() {
    for (std::size_t b = 0; b < blanks_.size(); ++b) {
      if (blanks_[b].step != 3) continue;
      double over = 0.0, under = 0.0;
      for (std::size_t o = 0; o < blanks_.size(); ++o) {
        if (blanks_[o].step != 2) continue;
        const auto own = paper_at(blanks_[b].paper, at_mm(o)),
                   other = paper_at(blanks_[o].paper, at_mm(b));
        if (own.empty() || other.empty()) continue;
        over += paper_above(other, own.back().to), under += paper_below(other, own.front().from);
      }
      if (over > under + kSlack_mm) blanks_[b].step = 1;
    }
  }

  void drop(std::size_t slice, const FlatRings& paper, DroppedPiece::Reason reason) {
    out_.dropped.push_back({slice, area_of(paper), reason});
  }

  void cut(std::size_t x, std::size_t y) {
    const bool x_first = blanks_[x].step < blanks_[y].step;
    const std::size_t earlier = x_first ? x : y, later = x_first ? y : x;
    const auto below = paper_at(blanks_[earlier].paper, at_mm(later)),
               above = paper_at(blanks_[later].paper, at_mm(earlier));
    if (below.empty() || above.empty()) return;
    const std::vector<PaperSpan> shared = in_both(below, above);
    double split = 0.0;
    if (shared.empty()) {
      if (below.back().to <= above.front().from + kSlack_mm) return;
      // Where nothing is shared, the least is cut that lets the later one come down.
      double least = std::numeric_limits<double>::infinity();
      for (const auto* spans : {&below, &above})
        for (const PaperSpan& s : *spans)
          for (const double z : {s.from, s.to})
            if (const double lost = paper_above(below, z) + paper_below(above, z); lost < least)
              least = lost, split = z;
      ++out_.cleared;
    } else {
      const auto kept = std::max_element(
          shared.begin(), shared.end(),
          [](const PaperSpan& a, const PaperSpan& b) { return a.length() < b.length(); });
      out_.cleared += shared.size() - 1;
      split = 0.5 * (kept->from + kept->to);
      meetings_.push_back({x, y, *kept, split});
    }
    const auto slot = [&](std::size_t blank, double at, double from, double to) {
      const double half = 0.5 * slot_.width_mm;
      blanks_[blank].cuts.push_back(rectangle({at - half, from}, {at + half, to}));
    };
    slot(earlier, at_mm(later), split - slot_.overlap_mm, kFar_mm);
    slot(later, at_mm(earlier), -kFar_mm, split + slot_.overlap_mm);
  }

  void add_pieces() {
    for (std::size_t step = 0; step < 5; ++step)
      for (std::size_t s = 0; s < slices_.size(); ++s) {
        std::vector<CutPiece> cut_pieces;
        for (std::size_t b = 0; b < blanks_.size(); ++b) {
          const Blank& blank = blanks_[b];
          if (blank.step != step || blank.slice != s) continue;
          const FlatRings whole =
              without_touching(blank.cuts.empty() ? blank.paper : without(blank.paper, blank.cuts));
          for (FlatRings& paper : pieces_of(whole)) {
            if (area_of(paper) < least_mm2_)
              drop(s, paper, DroppedPiece::Reason::Small);
            else
              cut_pieces.push_back({b, {s, std::move(paper), step, blank.is_island}});
          }
        }
        add_in_order(std::move(cut_pieces));
      }
  }

  /// Pieces of one slice and step come down one after the other, those below first. What hooks into
  /// another, or is below an earlier step's paper, cannot.
  void add_in_order(std::vector<CutPiece> waiting) {
    const auto is_under = [](const SlicePiece& below, const SlicePiece& above) {
      return area_of(common(swept_from_above(below.paper, kFar_mm), above.paper)) >= kSlack_mm2;
    };
    std::vector<CutPiece> backwards;
    while (!waiting.empty()) {
      auto last = waiting.begin();
      while (last != waiting.end() &&
             std::any_of(waiting.begin(), waiting.end(), [&](const CutPiece& other) {
               return &other != &*last && is_under(last->piece, other.piece);
             }))
        ++last;
      const bool is_free = last != waiting.end();
      if (!is_free)
        last = std::min_element(waiting.begin(), waiting.end(),
                                [](const CutPiece& a, const CutPiece& b) {
                                  return area_of(a.piece.paper) < area_of(b.piece.paper);
                                });
      const bool is_blocked =
          !is_free || std::any_of(out_.pieces.begin(), out_.pieces.end(), [&](const SlicePiece& p) {
            return p.slice == last->piece.slice && is_under(last->piece, p);
          });
      if (is_blocked)
        drop(last->piece.slice, last->piece.paper, DroppedPiece::Reason::Blocked);
      else
        backwards.push_back(std::move(*last));
      waiting.erase(last);
    }
    for (auto one = backwards.rbegin(); one != backwards.rend(); ++one) {
      piece_blank_.push_back(one->blank);
      out_.pieces.push_back(std::move(one->piece));
    }
  }

  /// The piece of a blank that has paper at a stretch of a line; none if the stretch is not whole.
  [[nodiscard]] std::optional<std::size_t> piece_at(std::size_t blank, double at, double from,
                                                    double to) const {
    for (std::size_t p = 0; p < out_.pieces.size(); ++p) {
      if (piece_blank_[p] != blank) continue;
      for (const PaperSpan& s : paper_at(out_.pieces[p].paper, at))
        if (s.from <= from + kSlack_mm && s.to >= to - kSlack_mm) return p;
    }
    return std::nullopt;
  }

  void find_crossings() {
    for (const Meeting& met : meetings_) {
      if (met.span.length() < slot_.least_mm) continue;
      const bool x_first = blanks_[met.x].step < blanks_[met.y].step;
      const double lower = met.split_mm - slot_.overlap_mm, upper = met.split_mm + slot_.overlap_mm;
      const auto x = x_first ? piece_at(met.x, at_mm(met.y), met.span.from, lower)
                             : piece_at(met.x, at_mm(met.y), upper, met.span.to);
      const auto y = x_first ? piece_at(met.y, at_mm(met.x), upper, met.span.to)
                             : piece_at(met.y, at_mm(met.x), met.span.from, lower);
      if (x && y) out_.crossings.push_back({*x, *y, met.span.from, met.span.to, met.split_mm});
    }
  }

  void drop_loose() {
    std::vector<bool> holds(out_.pieces.size(), false);
    for (const SliceCrossing& one : out_.crossings)
      if (slices_[out_.pieces[one.x_piece].slice].is_foot &&
          slices_[out_.pieces[one.y_piece].slice].is_foot) {
        out_.feet = {one.x_piece, one.y_piece};
        holds[one.x_piece] = holds[one.y_piece] = true;
      }
    for (bool grown = true; grown;) {
      grown = false;
      std::vector<std::size_t> held_at(out_.pieces.size(), 0);
      for (const SliceCrossing& one : out_.crossings) {
        if (holds[one.y_piece]) ++held_at[one.x_piece];
        if (holds[one.x_piece]) ++held_at[one.y_piece];
      }
      const auto hold = [&](std::size_t p) {
        if (!holds[p]) holds[p] = grown = true;
      };
      for (std::size_t p = 0; p < out_.pieces.size(); ++p)
        if (held_at[p] >= 2) hold(p);
      for (const SliceCrossing& one : out_.crossings)
        if (!holds[one.x_piece] && !holds[one.y_piece] && held_at[one.x_piece] > 0 &&
            held_at[one.y_piece] > 0)
          hold(one.x_piece), hold(one.y_piece);
    }
    keep(holds);
  }

  void keep(const std::vector<bool>& holds) {
    std::vector<std::size_t> number(out_.pieces.size(), 0);
    std::vector<SlicePiece> kept;
    for (std::size_t p = 0; p < out_.pieces.size(); ++p) {
      number[p] = kept.size();
      if (holds[p])
        kept.push_back(std::move(out_.pieces[p]));
      else
        drop(out_.pieces[p].slice, out_.pieces[p].paper, DroppedPiece::Reason::Loose);
    }
    std::erase_if(out_.crossings, [&](const SliceCrossing& one) {
      return !holds[one.x_piece] || !holds[one.y_piece];
    });
    for (SliceCrossing& one : out_.crossings)
      one.x_piece = number[one.x_piece], one.y_piece = number[one.y_piece];
    for (std::size_t& foot : out_.feet) foot = number[foot];
    out_.pieces = std::move(kept);
  }

  const std::vector<Slice>& slices_;
  SlotSize slot_;
  double least_mm2_{};
  FamilyOrder order_;
  std::vector<Blank> blanks_;
  std::vector<Meeting> meetings_;
  std::vector<std::size_t> piece_blank_;
  SliceLattice out_;
};

}  // namespace

SliceLattice cross_slices(const std::vector<Slice>& slices, const SlotSize& slot,
                          double least_mm2) {
  constexpr SliceFamily kBoth[] = {SliceFamily::X, SliceFamily::Y};
  std::optional<SliceLattice> best;
  double most = -1.0;
  const auto consider = [&](const FamilyOrder& order) {
    SliceLattice one = Lattice(slices, slot, least_mm2, order).run();
    double kept = 0.0;
    for (const SlicePiece& piece : one.pieces) kept += area_of(piece.paper);
    if (kept > most + kSlack_mm2) most = kept, best = std::move(one);
  };
  for (const SliceFamily ground : kBoth) {
    for (const SliceFamily islands : kBoth) consider({ground, islands, false});
    consider({ground, ground, true});
  }
  return std::move(*best);
}

bool comes_down_freely(const std::vector<Slice>& slices, const SliceLattice& lattice) {
  for (std::size_t a = 0; a < lattice.pieces.size(); ++a)
    for (std::size_t b = a + 1; b < lattice.pieces.size(); ++b) {
      const SlicePiece &earlier = lattice.pieces[a], &later = lattice.pieces[b];
      const Slice &one = slices[earlier.slice], &other = slices[later.slice];
      if (earlier.slice == later.slice) {
        if (area_of(common(swept_from_above(later.paper, kFar_mm), earlier.paper)) >= kSlack_mm2)
          return false;
      } else if (one.family != other.family) {
        const auto below = paper_at(earlier.paper, other.at_mm),
                   above = paper_at(later.paper, one.at_mm);
        if (!below.empty() && !above.empty() && below.back().to > above.front().from + kSlack_mm)
          return false;
      }
    }
  return true;
}

}  // namespace popcut
