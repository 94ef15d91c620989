// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/plan/order/tour_stops.hpp"

namespace popcut {

/// Local search on a tour; see `improve_tour`. `Tour` is `ArrayTour` or `BlockTour`.
///
/// A link joins two nodes of consecutive stops. Each node has exactly one link, to its mate. A node
/// is an exit if the tour, as stored, leaves its stop there.
template <typename Tour>
class TourSearch {
 public:
  TourSearch(TourStops& stops, const NearNodes& near, const TourOrder& order)
      : stops_(stops),
        near_(near),
        tour_(order.sequence, order.flipped),
        waiting_(stops.node.size(), 0),
        queue_(stops.node.size()) {
    for (std::uint32_t s = 0; s < stops.size(); ++s)
      if (!stops.later.empty() && !stops.later_than(s).empty()) bound_.push_back(s);
  }

  /// The cost saved since the start.
  [[nodiscard]] double gained() const { return gained_; }

  void wake(std::uint32_t stop) {
    wake_node(2 * stop);
    wake_node(2 * stop + 1);
  }

  /// Improves until all nodes rest, or until `go_on()`, called now and then, returns false.
  template <typename GoOn>
  bool descend(GoOn&& go_on) {
    for (std::uint32_t count = 0; awake_ > 0; ++count) {
      if (count % 1024 == 1023 && !go_on()) return false;
      const std::uint32_t n = queue_[head_];
      head_ = head_ + 1 == queue_.size() ? 0 : head_ + 1;
      --awake_;
      waiting_[n] = 0;
      while (improve_at(n)) {
      }
    }
    return true;
  }

  /// Marks the state to which `revert` returns.
  void keep() {
    done_.clear();
    takes_note_ = true;
  }

  /// Undoes everything since the last `keep`, when `gained` had the given value.
  void revert(double gained) {
    gained_ = gained;
    settled_ = NearNodes::kNone;
    for (std::size_t i = done_.size(); i-- > 0;) {
      const Done& d = done_[i];
      if (d.kind == Done::Seam)
        stops_.choose_seam(d.a, d.b);
      else if (d.kind == Done::Part)
        tour_.reverse(d.b, d.a);
      else
        tour_.reverse(d.a, d.b);
    }
    done_.clear();
  }

  /// Swaps two consecutive pieces, of `p` and `q` stops, that start at `first`.
  /// @return the added cost, or infinity if precedence forbids it
  double disturb(std::uint32_t first, std::uint32_t p, std::uint32_t q) {
    Links t;
    t[0] = exit(tour_.prev(first));
    t[1] = entry(first);
    std::uint32_t stop = first;
    for (std::uint32_t i = 1; i < p; ++i) stop = tour_.next(stop);
    t[4] = exit(stop);
    stop = tour_.next(stop);
    t[5] = entry(stop);
    for (std::uint32_t i = 1; i < q; ++i) stop = tour_.next(stop);
    t[2] = exit(stop);
    t[3] = mate(t[2]);
    if (t[3] / 2 == first) return std::numeric_limits<double>::infinity();
    const double cost = stops_.between(t[1], t[2]) + stops_.between(t[3], t[4]) +
                        stops_.between(t[5], t[0]) - stops_.between(t[0], t[1]) -
                        stops_.between(t[2], t[3]) - stops_.between(t[4], t[5]);
    if (!allowed(t, 3)) return std::numeric_limits<double>::infinity();
    exchange(t, Swap::Pieces);
    gained_ -= cost;
    return cost;
  }

  [[nodiscard]] TourOrder order() const {
    TourOrder out;
    out.flipped.assign(stops_.size(), 0);
    const bool forward = !tour_.flipped(0);
    std::uint32_t stop = 0;
    do {
      out.sequence.push_back(stop);
      out.flipped[stop] = static_cast<std::uint8_t>(tour_.flipped(stop) == forward ? 1 : 0);
      stop = forward ? tour_.next(stop) : tour_.prev(stop);
    } while (stop != 0);
    return out;
  }

 private:
  static constexpr double kWorthwhile = 1e-9;
  // Links t0-t1, t2-t3 and t4-t5 are removed; t1-t2, t3-t4 and t5-t0 (or t3-t0) are added.
  using Links = std::array<std::uint32_t, 6>;
  enum class Swap { Turn, TurnTwice, Pieces, TurnBoth };
  struct Done {
    enum Kind : std::uint8_t { Part, Rest, Seam };
    std::uint32_t a, b;
    Kind kind;
  };

  [[nodiscard]] std::uint32_t entry(std::uint32_t s) const {
    return 2 * s + (tour_.flipped(s) ? 1 : 0);
  }
  [[nodiscard]] std::uint32_t exit(std::uint32_t s) const { return entry(s) ^ 1u; }
  [[nodiscard]] bool is_exit(std::uint32_t n) const {
    return ((n & 1u) != 0) != tour_.flipped(n / 2);
  }
  [[nodiscard]] std::uint32_t mate(std::uint32_t n) const {
    return is_exit(n) ? entry(tour_.next(n / 2)) : exit(tour_.prev(n / 2));
  }
  void wake_node(std::uint32_t n) {
    if (waiting_[n] != 0) return;
    waiting_[n] = 1;
    const std::size_t at = head_ + awake_++;
    queue_[at < queue_.size() ? at : at - queue_.size()] = n;
  }

  void reverse(std::uint32_t from, std::uint32_t to) {
    const bool part = tour_.reverse(from, to);
    if (takes_note_) done_.push_back({from, to, part ? Done::Part : Done::Rest});
  }
  // Reverses from the stop of `n` to the stop of `m`, as seen from t0, which is an exit by
  // definition.
  void turn(std::uint32_t t0, std::uint32_t n, std::uint32_t m) {
    if (is_exit(t0))
      reverse(n / 2, m / 2);
    else
      reverse(m / 2, n / 2);
  }

  void exchange(const Links& t, Swap swap) {
    switch (swap) {
      case Swap::Turn:
        turn(t[0], t[1], t[3]);
        break;
      case Swap::TurnTwice:
        turn(t[0], t[1], t[3]);
        turn(t[0], t[3], t[5]);
        break;
      case Swap::Pieces:
        turn(t[0], t[1], t[2]);
        turn(t[0], t[2], t[5]);
        turn(t[0], t[4], t[1]);
        break;
      case Swap::TurnBoth:
        turn(t[0], t[1], t[5]);
        turn(t[0], t[4], t[2]);
        break;
    }
    for (const std::uint32_t n : t) wake_node(n);
    settled_ = NearNodes::kNone;
  }

  bool improve_at(std::uint32_t t0) {
    const std::uint32_t stop = t0 / 2;
    if (stops_.has_doors(stop) && settled_ != stop) {  // its other node was just handled
      if (improve_seam(stop) || improve_place(stop)) return true;
      settled_ = stop;
    }
    return improve_links(t0);
  }

  bool improve_links(std::uint32_t t0) {
    Links t;
    t[0] = t0;
    t[1] = mate(t0);
    const double g0 = stops_.between(t[0], t[1]);
    if (g0 <= kWorthwhile) return false;
    const bool forward = is_exit(t0);
    for (const std::uint32_t n : near_.near(t[1])) {
      if (n == NearNodes::kNone) break;
      const double g1 = g0 - stops_.between(t[1], n);
      if (g1 <= kWorthwhile) {
        if (stops_.first_door.empty()) break;
        continue;
      }
      t[2] = n;
      if (second_link(t, g1, forward)) return true;
    }
    for (std::uint32_t n = 0; n < 2; ++n) {
      if (!stops_.is_free(n) || t[1] / 2 == 0) continue;
      t[2] = n;
      if (second_link(t, g0, forward)) return true;
    }
    return false;
  }

  bool second_link(Links& t, double g1, bool forward) {
    if (t[2] == t[0]) return false;
    t[3] = mate(t[2]);
    const double g2 = g1 + stops_.between(t[2], t[3]);
    const bool enters = is_exit(t[2]) != forward;  // as seen from t0
    if (enters) {
      const double gain = g2 - stops_.between(t[3], t[0]);
      if (gain > kWorthwhile) {
        t[4] = t[3];
        t[5] = t[2];
        if (allowed(t, 2)) return accept(t, Swap::Turn, gain);
      }
    }
    for (const std::uint32_t n : near_.near(t[3])) {
      if (n == NearNodes::kNone) break;
      const double g3 = g2 - stops_.between(t[3], n);
      if (g3 <= kWorthwhile) {
        if (stops_.first_door.empty()) break;
        continue;
      }
      if (third_link(t, n, g3, forward, enters)) return true;
    }
    return false;
  }

  bool third_link(Links& t, std::uint32_t n, double g3, bool forward, bool enters) {
    if (n == t[0] || n == t[1] || n == t[2] || n == t[3]) return false;
    t[4] = n;
    t[5] = mate(n);
    const double gain = g3 + stops_.between(t[4], t[5]) - stops_.between(t[5], t[0]);
    if (gain <= kWorthwhile) return false;
    // Stops from t1 on, as seen from t0.
    const std::uint32_t begin = tour_.position(t[1] / 2), size = tour_.size();
    const auto from_t1 = [&](std::uint32_t node) {
      const std::uint32_t at = tour_.position(node / 2);
      if (forward) return at >= begin ? at - begin : at + size - begin;
      return begin >= at ? begin - at : begin + size - at;
    };
    const bool inside = from_t1(t[4]) <= from_t1(enters ? t[3] : t[2]);
    const bool exits = is_exit(t[4]) == forward;
    if (enters ? exits != inside : !inside) return false;
    if (!allowed(t, 3)) return false;
    return accept(t, enters ? Swap::TurnTwice : exits ? Swap::Pieces : Swap::TurnBoth, gain);
  }

  bool accept(const Links& t, Swap swap, double gain) {
    exchange(t, swap);
    gained_ += gain;
    return true;
  }

  // The cheapest door of a closed stop between two nodes: its cost and its number.
  [[nodiscard]] std::pair<double, std::uint32_t> best_door(std::uint32_t stop, std::uint32_t before,
                                                           std::uint32_t after) const {
    std::pair<double, std::uint32_t> best{std::numeric_limits<double>::infinity(), 0};
    for (std::uint32_t d = stops_.first_door[stop]; d < stops_.first_door[stop + 1]; ++d) {
      const double first = stops_.between(before, stops_.doors[d]);
      if (first >= best.first) continue;
      const double cost = first + stops_.between(after, stops_.doors[d]);
      if (cost < best.first) best = {cost, d};
    }
    return best;
  }

  void choose_seam(std::uint32_t stop, std::uint32_t door) {
    if (takes_note_) done_.push_back({stop, stops_.seam[stop], Done::Seam});
    stops_.choose_seam(stop, door);
    settled_ = NearNodes::kNone;
    wake(stop);
  }

  bool improve_seam(std::uint32_t stop) {
    const std::uint32_t before = mate(2 * stop), after = mate(2 * stop + 1);
    const PagePoint& here = stops_.node[2 * stop];
    const auto [cost, door] = best_door(stop, before, after);
    const double gain = stops_.between(before, here) + stops_.between(after, here) - cost;
    if (gain <= kWorthwhile) return false;
    choose_seam(stop, door);
    wake_node(before);
    wake_node(after);
    gained_ += gain;
    return true;
  }

  // Moves a closed stop into a link of a near node, through the best door for it.
  bool improve_place(std::uint32_t stop) {
    const std::uint32_t enter = entry(stop), leave = exit(stop);
    const std::uint32_t before = mate(enter), after = mate(leave);
    const double saved = stops_.between(before, enter) + stops_.between(leave, after) -
                         stops_.between(before, after);
    if (saved <= kWorthwhile) return false;
    const auto row = near_.near(enter);
    for (std::size_t k = 0; k < row.size() && row[k] != NearNodes::kNone; ++k) {
      const std::uint32_t n = row[k];
      const std::uint32_t m = mate(n);
      if (m / 2 == stop) continue;
      // Hardly any door is closer to n than this, wherever the seams are: skip the stop.
      const double least =
          stops_.cost(static_cast<double>(near_.mm[std::size_t{enter} * near_.each + k]));
      if (saved + stops_.between(n, m) - least <= kWorthwhile) continue;
      const auto [cost, door] = best_door(stop, n, m);
      const double gain = saved + stops_.between(n, m) - cost;
      if (gain <= kWorthwhile) continue;
      const bool exits = is_exit(n);
      const Links t{before, enter, exits ? n : m, exits ? m : n, leave, after};
      if (!allowed(t, 3)) continue;
      exchange(t, Swap::Pieces);
      choose_seam(stop, door);
      gained_ += gain;
      return true;
    }
    return false;
  }

  // -- Precedence. Places along the tour; home is at 0.

  [[nodiscard]] std::uint32_t place(std::uint32_t stop) const {
    const std::uint32_t home = tour_.position(0), at = tour_.position(stop), n = tour_.size();
    if (!tour_.flipped(0)) return at >= home ? at - home : at + n - home;
    return home >= at ? home - at : home + n - at;
  }
  // A link to remove, in tour direction: the tour leaves it at `out` and enters it at `in`.
  struct Cut {
    std::uint32_t at, out, in;
  };
  [[nodiscard]] Cut cut(std::uint32_t n, std::uint32_t m) const {
    if (is_exit(n) == tour_.flipped(0)) std::swap(n, m);
    return {place(n / 2), n, m};
  }
  // Stops after cut `p` up to cut `q`.
  struct Piece {
    std::uint32_t after, last, first_stop;
    [[nodiscard]] std::uint32_t size() const { return last - after; }
    [[nodiscard]] bool holds(std::uint32_t place) const { return place > after && place <= last; }
  };

  // Calls `breaks(stop)` for the stops of a piece that have precedence rules, until one returns
  // true.
  template <typename Breaks>
  [[nodiscard]] bool any(const Piece& piece, Breaks&& breaks) const {
    if (bound_.size() < piece.size()) {
      for (const std::uint32_t s : bound_)
        if (piece.holds(place(s)) && breaks(s)) return true;
      return false;
    }
    const bool forward = !tour_.flipped(0);
    std::uint32_t s = piece.first_stop;
    for (std::uint32_t i = piece.size(); i > 0; --i) {
      if (breaks(s)) return true;
      s = forward ? tour_.next(s) : tour_.prev(s);
    }
    return false;
  }
  // Whether a stop of `p` must come before a stop of `q`.
  [[nodiscard]] bool binds(const Piece& p, const Piece& q) const {
    if (bound_.size() < std::min(p.size(), q.size()) || p.size() <= q.size())
      return any(p, [&](std::uint32_t s) {
        for (const std::uint32_t t : stops_.later_than(s))
          if (q.holds(place(t))) return true;
        return false;
      });
    return any(q, [&](std::uint32_t s) {
      for (const std::uint32_t t : stops_.earlier_than(s))
        if (p.holds(place(t))) return true;
      return false;
    });
  }

  // Whether the exchange of two or three links keeps each stop before the stops that must follow
  // it.
  [[nodiscard]] bool allowed(const Links& t, int links) const {
    if (bound_.empty()) return true;
    std::array<Cut, 3> c{cut(t[0], t[1]), cut(t[2], t[3]), {}};
    if (links == 3) c[2] = cut(t[4], t[5]);
    if (c[1].at < c[0].at) std::swap(c[0], c[1]);
    if (links == 3 && c[2].at < c[1].at) std::swap(c[1], c[2]);
    if (c[1].at < c[0].at) std::swap(c[0], c[1]);
    const Piece x{c[0].at, c[1].at, c[0].in / 2};
    if (links == 2) return !binds(x, x);
    const Piece y{c[1].at, c[2].at, c[1].in / 2};
    const auto partner = [&](std::uint32_t n) {
      for (const auto& [p, q] : {std::pair{1, 2}, std::pair{3, 4}, std::pair{5, 0}}) {
        const auto i = static_cast<std::size_t>(p), j = static_cast<std::size_t>(q);
        if (t[i] == n) return t[j];
        if (t[j] == n) return t[i];
      }
      return NearNodes::kNone;
    };
    const std::uint32_t first = partner(c[0].out), last = partner(c[2].in);
    const bool swapped = first != c[1].out;
    const bool x_turned = !swapped || last == c[0].in;
    const bool y_turned = first == c[2].out || !swapped;
    return !(swapped && binds(x, y)) && !(x_turned && binds(x, x)) && !(y_turned && binds(y, y));
  }

  TourStops& stops_;
  const NearNodes& near_;
  Tour tour_;
  std::vector<std::uint8_t> waiting_;
  std::vector<std::uint32_t> queue_;  // a ring; each node is in it at most once
  std::size_t head_{0}, awake_{0};
  std::vector<Done> done_;
  bool takes_note_{false};
  std::vector<std::uint32_t> bound_;         // stops that must come before others
  std::uint32_t settled_{NearNodes::kNone};  // closed stop whose seam and place were just optimised
  double gained_{0.0};
};

}  // namespace popcut
