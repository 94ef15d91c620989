// SPDX-License-Identifier: MIT
#include "core/design/slices/slice_lattice.hpp"

#include <algorithm>
#include <array>
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
  bool is_island{};
};

/// Two blanks that both have paper on the line in which their slices cross.
struct BlankPair {
  std::size_t x{}, y{};
  std::vector<PaperSpan> on_x, on_y;
};

/// What all orders of assembly have in common.
struct Uncut {
  std::vector<Blank> blanks;  ///< by slice
  std::vector<BlankPair> pairs;
  std::vector<DroppedPiece> dropped;
  double paper_mm2{};
  bool has_islands{};
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

Uncut uncut_of(const std::vector<Slice>& slices, double least_mm2) {
  Uncut out;
  for (std::size_t s = 0; s < slices.size(); ++s)
    for (const bool is_island : {false, true})
      for (FlatRings& piece : pieces_of(is_island ? slices[s].islands : slices[s].ground)) {
        const double area = area_of(piece);
        out.paper_mm2 += area;
        if (area < least_mm2)
          out.dropped.push_back({s, area, DroppedPiece::Reason::Small});
        else
          out.blanks.push_back({s, std::move(piece), is_island});
        out.has_islands = out.has_islands || is_island;
      }
  std::vector<UprightLines> lines;
  std::array<std::vector<std::size_t>, 2> of_family;
  for (std::size_t b = 0; b < out.blanks.size(); ++b) {
    lines.emplace_back(out.blanks[b].paper);
    of_family[slices[out.blanks[b].slice].family == SliceFamily::X ? 0 : 1].push_back(b);
  }
  for (const std::size_t x : of_family[0])
    for (const std::size_t y : of_family[1]) {
      const double at_x = slices[out.blanks[x].slice].at_mm,
                   at_y = slices[out.blanks[y].slice].at_mm;
      if (!lines[x].reaches(at_y) || !lines[y].reaches(at_x)) continue;
      BlankPair pair{x, y, lines[x].paper_at(at_y), lines[y].paper_at(at_x)};
      if (!pair.on_x.empty() && !pair.on_y.empty()) out.pairs.push_back(std::move(pair));
    }
  return out;
}

class Lattice {
 public:
  Lattice(const std::vector<Slice>& slices, const Uncut& uncut, const SlotSize& slot,
          double least_mm2, FamilyOrder order)
      : slices_(slices),
        blanks_(uncut.blanks),
        pairs_(uncut.pairs),
        slot_(slot),
        least_mm2_(least_mm2),
        order_(order),
        cuts_(uncut.blanks.size()) {
    out_.dropped = uncut.dropped, out_.paper_mm2 = uncut.paper_mm2;
  }

  SliceLattice run() {
    for (const Blank& blank : blanks_) step_.push_back(step_of(blank));
    if (order_.is_between) put_below();
    for (const BlankPair& pair : pairs_) cut(pair);
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

  [[nodiscard]] double at_mm(std::size_t blank) const {
    return slices_[blanks_[blank].slice].at_mm;
  }

  [[nodiscard]] std::size_t step_of(const Blank& blank) const {
    const SliceFamily family = slices_[blank.slice].family;
    // Slots from below would end at the tab of a foot, so nothing is there before a foot that it
    // would come down on, but the other foot beside its tab.
    if (slices_[blank.slice].is_foot && !blank.is_island && family != order_.ground) return 0;
    if (order_.is_between) return family == order_.ground ? (blank.is_island ? 3 : 1) : 2;
    const SliceFamily first = blank.is_island ? order_.islands : order_.ground;
    return (blank.is_island ? 3 : 1) + (family == first ? 0 : 1);
  }

  /// Islands of the first family go below the other one where less of it has to be cut for that.
  void put_below() {
    std::vector<double> over(blanks_.size(), 0.0), under(blanks_.size(), 0.0);
    for (const BlankPair& pair : pairs_) {
      const bool is_x = order_.ground == SliceFamily::X;
      const std::size_t b = is_x ? pair.x : pair.y, o = is_x ? pair.y : pair.x;
      if (step_[b] != 3 || step_[o] != 2) continue;
      const auto &own = is_x ? pair.on_x : pair.on_y, &other = is_x ? pair.on_y : pair.on_x;
      over[b] += paper_above(other, own.back().to),
          under[b] += paper_below(other, own.front().from);
    }
    for (std::size_t b = 0; b < blanks_.size(); ++b)
      if (step_[b] == 3 && over[b] > under[b] + kSlack_mm) step_[b] = 1;
  }

  void drop(std::size_t slice, const FlatRings& paper, DroppedPiece::Reason reason) {
    out_.dropped.push_back({slice, area_of(paper), reason});
  }

  void cut(const BlankPair& pair) {
    const auto& [x, y, on_x, on_y] = pair;
    const bool x_first = step_[x] < step_[y];
    const std::size_t earlier = x_first ? x : y, later = x_first ? y : x;
    const auto &below = x_first ? on_x : on_y, &above = x_first ? on_y : on_x;
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
      cuts_[blank].push_back(rectangle({at - half, from}, {at + half, to}));
    };
    slot(earlier, at_mm(later), split - slot_.overlap_mm, kFar_mm);
    slot(later, at_mm(earlier), -kFar_mm, split + slot_.overlap_mm);
  }

  void add_pieces() {
    for (std::size_t step = 0; step < 5; ++step)
      for (std::size_t b = 0; b < blanks_.size();) {
        const std::size_t slice = blanks_[b].slice;
        std::vector<CutPiece> cut_pieces;
        for (; b < blanks_.size() && blanks_[b].slice == slice; ++b) {
          if (step_[b] != step) continue;
          for (FlatRings& paper : pieces_without(blanks_[b].paper, cuts_[b])) {
            if (area_of(paper) < least_mm2_)
              drop(slice, paper, DroppedPiece::Reason::Small);
            else
              cut_pieces.push_back({b, {slice, std::move(paper), step, blanks_[b].is_island}});
          }
        }
        add_in_order(std::move(cut_pieces));
      }
  }

  /// Whether a piece that comes straight down would meet another piece of its slice that is below.
  static bool is_under(const SlicePiece& below, const SlicePiece& above) {
    const Eigen::AlignedBox2d low = box_of(below.paper.front()), high = box_of(above.paper.front());
    if (low.min().x() >= high.max().x() || high.min().x() >= low.max().x() ||
        high.max().y() <= low.min().y())
      return false;
    return area_of(common(swept_from_above(below.paper, kFar_mm), above.paper)) >= kSlack_mm2;
  }

  /// Pieces of one slice and step come down one after the other, those below first. What hooks into
  /// another, or is below an earlier step's paper, cannot.
  void add_in_order(std::vector<CutPiece> pieces) {
    // How many that are still waiting have to come before each one is the last.
    std::vector<std::vector<std::size_t>> below(pieces.size());
    std::vector<std::size_t> above(pieces.size(), 0);
    for (std::size_t a = 0; a < pieces.size(); ++a)
      for (std::size_t b = 0; b < pieces.size(); ++b)
        if (a != b && is_under(pieces[a].piece, pieces[b].piece)) below[b].push_back(a), ++above[a];
    std::vector<bool> is_done(pieces.size(), false);
    std::vector<CutPiece> backwards;
    for (std::size_t n = 0; n < pieces.size(); ++n) {
      std::size_t last = pieces.size(), least = last;
      for (std::size_t k = 0; k < pieces.size() && last == pieces.size(); ++k) {
        if (is_done[k]) continue;
        if (above[k] == 0)
          last = k;
        else if (least == pieces.size() ||
                 area_of(pieces[k].piece.paper) < area_of(pieces[least].piece.paper))
          least = k;
      }
      const bool is_free = last != pieces.size();
      if (!is_free) last = least;
      is_done[last] = true;
      for (const std::size_t k : below[last]) --above[k];
      const SlicePiece& piece = pieces[last].piece;
      const bool is_blocked =
          !is_free || std::any_of(out_.pieces.begin(), out_.pieces.end(), [&](const SlicePiece& p) {
            return p.slice == piece.slice && is_under(piece, p);
          });
      if (is_blocked)
        drop(piece.slice, piece.paper, DroppedPiece::Reason::Blocked);
      else
        backwards.push_back(std::move(pieces[last]));
    }
    for (auto one = backwards.rbegin(); one != backwards.rend(); ++one) {
      piece_blank_.push_back(one->blank);
      out_.pieces.push_back(std::move(one->piece));
    }
  }

  void find_crossings() {
    std::vector<std::vector<std::size_t>> pieces(blanks_.size());
    std::vector<UprightLines> lines;
    for (std::size_t p = 0; p < out_.pieces.size(); ++p) {
      pieces[piece_blank_[p]].push_back(p);
      lines.emplace_back(out_.pieces[p].paper);
    }
    // The piece of a blank that has paper at a stretch of a line; none if the stretch is not whole.
    const auto piece_at = [&](std::size_t blank, double at, double from,
                              double to) -> std::optional<std::size_t> {
      for (const std::size_t p : pieces[blank])
        for (const PaperSpan& s : lines[p].paper_at(at))
          if (s.from <= from + kSlack_mm && s.to >= to - kSlack_mm) return p;
      return std::nullopt;
    };
    for (const Meeting& met : meetings_) {
      if (met.span.length() < slot_.least_mm) continue;
      const bool x_first = step_[met.x] < step_[met.y];
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
  const std::vector<Blank>& blanks_;
  const std::vector<BlankPair>& pairs_;
  SlotSize slot_;
  double least_mm2_{};
  FamilyOrder order_;
  std::vector<std::size_t> step_;  ///< one a blank
  std::vector<FlatRings> cuts_;    ///< the same
  std::vector<Meeting> meetings_;
  std::vector<std::size_t> piece_blank_;
  SliceLattice out_;
};

}  // namespace

SliceLattice cross_slices(const std::vector<Slice>& slices, const SlotSize& slot,
                          double least_mm2) {
  constexpr std::array kBoth{SliceFamily::X, SliceFamily::Y};
  const Uncut uncut = uncut_of(slices, least_mm2);
  std::optional<SliceLattice> best;
  double most = -1.0;
  const auto consider = [&](const FamilyOrder& order) {
    SliceLattice one = Lattice(slices, uncut, slot, least_mm2, order).run();
    double kept = 0.0;
    for (const SlicePiece& piece : one.pieces) kept += area_of(piece.paper);
    if (kept > most + kSlack_mm2) most = kept, best = std::move(one);
  };
  for (const SliceFamily ground : kBoth) {
    if (!uncut.has_islands) {
      consider({ground, ground, false});
      continue;
    }
    for (const SliceFamily islands : kBoth) consider({ground, islands, false});
    consider({ground, ground, true});
  }
  return std::move(*best);
}

bool comes_down_freely(const std::vector<Slice>& slices, const SliceLattice& lattice) {
  std::vector<UprightLines> lines;
  for (const SlicePiece& piece : lattice.pieces) lines.emplace_back(piece.paper);
  for (std::size_t a = 0; a < lattice.pieces.size(); ++a)
    for (std::size_t b = a + 1; b < lattice.pieces.size(); ++b) {
      const SlicePiece &earlier = lattice.pieces[a], &later = lattice.pieces[b];
      const Slice &one = slices[earlier.slice], &other = slices[later.slice];
      if (earlier.slice == later.slice) {
        if (area_of(common(swept_from_above(later.paper, kFar_mm), earlier.paper)) >= kSlack_mm2)
          return false;
      } else if (one.family != other.family && lines[a].reaches(other.at_mm) &&
                 lines[b].reaches(one.at_mm)) {
        const auto below = lines[a].paper_at(other.at_mm), above = lines[b].paper_at(one.at_mm);
        if (!below.empty() && !above.empty() && below.back().to > above.front().from + kSlack_mm)
          return false;
      }
    }
  return true;
}

}  // namespace popcut
