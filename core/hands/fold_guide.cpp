// SPDX-License-Identifier: MIT
#include "core/hands/fold_guide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/disjoint_sets.hpp"
#include "core/hands/waste.hpp"

namespace popcut::hands {
namespace {

constexpr double kTouching_mm = 1e-6;
constexpr std::int32_t kNone = -1;
/// A step ends where a layer or a figure does if it has so many folds; else the next one joins it,
/// so that pages stay few.
constexpr std::size_t kEnoughOfLayer = 6, kEnoughOfFigure = 3;
constexpr std::size_t kFoldsAPush = 20;  ///< no more pushes than one for so many folds, and three

bool is_fold(const PatternEdge& edge) {
  return edge.role == EdgeRole::Mountain || edge.role == EdgeRole::Valley;
}

std::string counted(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// The edges of a pattern as whole folds: those that meet end to end in one line are one.
std::vector<GuideFold> whole_folds(const Pattern& pattern) {
  std::vector<std::uint32_t> edges;
  // Of each place, the ends there: an index into `edges` and a vertex. A cut parts vertices, and a
  // crease goes on behind it.
  std::map<std::pair<double, double>, std::vector<std::pair<std::uint32_t, std::uint32_t>>> at;
  const auto rounded = [](double x) { return std::round(x * 1e6) + 0.0; };
  const auto place_of = [&](std::uint32_t vertex) {
    const PatternVertex& p = pattern.vertices[vertex];
    return std::pair(rounded(pattern.u(p)), rounded(p.v));
  };
  for (std::uint32_t e = 0; e < pattern.edges.size(); ++e) {
    if (!is_fold(pattern.edges[e])) continue;
    for (const std::uint32_t end : {pattern.edges[e].from, pattern.edges[e].to})
      at[place_of(end)].emplace_back(static_cast<std::uint32_t>(edges.size()), end);
    edges.push_back(e);
  }
  const auto along = [&](std::uint32_t k, std::uint32_t from) {  // unit vector away from a vertex
    const PatternEdge& e = pattern.edges[edges[k]];
    const PatternVertex &a = pattern.vertices[from],
                        &b = pattern.vertices[e.from == from ? e.to : e.from];
    const double u = pattern.u(b) - pattern.u(a), v = b.v - a.v, length = std::hypot(u, v);
    return std::array<double, 2>{length > 0 ? u / length : 0, length > 0 ? v / length : 0};
  };
  DisjointSets lines(edges.size());
  for (const auto& [place, here] : at)
    for (std::size_t i = 0; i < here.size(); ++i)
      for (std::size_t k = i + 1; k < here.size(); ++k) {
        const auto [one, one_end] = here[i];
        const auto [other, other_end] = here[k];
        if (pattern.edges[edges[one]].role != pattern.edges[edges[other]].role) continue;
        const auto a = along(one, one_end), b = along(other, other_end);
        if (std::abs(a[0] + b[0]) < kTouching_mm && std::abs(a[1] + b[1]) < kTouching_mm)
          lines.join(one, other);
      }
  std::vector<std::uint32_t> number;
  std::vector<GuideFold> folds(lines.number(number));
  const auto before = [&](const PatternVertex& a, const PatternVertex& b) {
    return std::pair(rounded(a.v), pattern.u(a)) < std::pair(rounded(b.v), pattern.u(b));
  };
  std::vector<bool> has_begun(folds.size(), false);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const PatternEdge& e = pattern.edges[edges[k]];
    GuideFold& fold = folds[number[k]];
    fold.role = e.role;
    for (const std::uint32_t end : {e.from, e.to}) {
      const PatternVertex& p = pattern.vertices[end];
      if (!has_begun[number[k]]) fold.from = fold.to = p, has_begun[number[k]] = true;
      if (before(p, fold.from)) fold.from = p;
      if (before(fold.to, p)) fold.to = p;
    }
    for (const std::int32_t face : {e.left, e.right})
      if (face >= 0) fold.panels.push_back(static_cast<std::uint32_t>(face));
  }
  for (GuideFold& fold : folds) {
    std::ranges::sort(fold.panels);
    fold.panels.erase(std::unique(fold.panels.begin(), fold.panels.end()), fold.panels.end());
  }
  return folds;
}

/// Of two sides that an eye may look from, which hides less of some panels at psi = pi/2, where
/// every panel is level or upright.
class Sight {
 public:
  explicit Sight(const Pattern& pattern) : pattern_(pattern) {
    for (std::size_t f = 0; f < pattern.faces(); ++f) {
      Panel panel;
      double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, z0 = x0, z1 = -x0;
      for (const std::uint32_t corner : pattern.face(f)) {
        const PatternVertex& p = pattern.vertices[corner];
        x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
        z0 = std::min(z0, p.z), z1 = std::max(z1, p.z);
      }
      panel.is_upright = x1 - x0 < z1 - z0;
      panel.plane_mm = panel.is_upright ? x0 : z0;
      panels_.push_back(panel);
    }
  }

  [[nodiscard]] LookFrom side_of(const std::vector<std::uint32_t>& panels) const {
    if (!pattern_.v_folds.empty()) return LookFrom::Right;  // they are drawn from there alone
    return seen(panels, -1) > seen(panels, 1) ? LookFrom::Left : LookFrom::Right;
  }

 private:
  struct Panel {
    bool is_upright{};
    double plane_mm{};  ///< its x, or its z
  };

  [[nodiscard]] bool covers(std::size_t face, double t, double v) const {
    bool inside = false;
    const auto corners = pattern_.face(face);
    const bool upright = panels_[face].is_upright;
    const PatternVertex* a = &pattern_.vertices[corners.back()];
    for (const std::uint32_t corner : corners) {
      const PatternVertex* b = &pattern_.vertices[corner];
      const double ta = upright ? a->z : a->x, tb = upright ? b->z : b->x;
      if ((a->v > v) != (b->v > v) && t < ta + (tb - ta) * (v - a->v) / (b->v - a->v))
        inside = !inside;
      a = b;
    }
    return inside;
  }

  /// How many of some places of the panels an eye sees from the right (1) or the left (-1).
  [[nodiscard]] int seen(const std::vector<std::uint32_t>& panels, double side) const {
    constexpr double kAhead = 0.75, kAside = 0.41, kUp = 0.52;  // as pictures look
    int count = 0;
    for (const std::uint32_t face : panels) {
      const auto corners = pattern_.face(face);
      PatternVertex middle;
      for (const std::uint32_t corner : corners) {
        const PatternVertex& p = pattern_.vertices[corner];
        const double part = 1.0 / static_cast<double>(corners.size());
        middle.x += part * p.x, middle.z += part * p.z, middle.v += part * p.v;
      }
      for (const std::uint32_t corner : corners) {
        const PatternVertex& p = pattern_.vertices[corner];
        const PatternVertex at{0.5 * (p.x + middle.x), 0.5 * (p.z + middle.z),
                               0.5 * (p.v + middle.v)};
        bool hidden = false;
        for (std::size_t f = 0; f < panels_.size() && !hidden; ++f) {
          const Panel& other = panels_[f];
          const double way =
              other.is_upright ? (other.plane_mm - at.x) / kAhead : (other.plane_mm - at.z) / kUp;
          if (f == face || way < kTouching_mm) continue;
          hidden = covers(f, other.is_upright ? at.z + way * kUp : at.x + way * kAhead,
                          at.v + side * way * kAside);
        }
        count += hidden ? 0 : 1;
      }
    }
    return count;
  }

  const Pattern& pattern_;
  std::vector<Panel> panels_;
};

class Guide {
 public:
  explicit Guide(const Pattern& pattern) : pattern_(pattern), sight_(pattern) {}

  Result<FoldGuide> run() {
    out_.folds = whole_folds(pattern_);
    if (out_.folds.size() > kMostGuideFolds)
      return fail(ErrorKind::OutOfRange, "folds",
                  fmt::format("a fold guide has at most {} folds, and this pattern has {}: nobody "
                              "folds so many by hand; design it with fewer or wider panels",
                              kMostGuideFolds, out_.folds.size()));
    out_.waste = waste_outlines(pattern_);
    out_.stands = std::ranges::any_of(
        pattern_.vertices, [](const PatternVertex& p) { return std::abs(p.z) > kTouching_mm; });
    find_card();
    measure_depths();
    find_figures();
    if (!out_.waste.empty())
      out_.steps.push_back({.kind = StepKind::Waste,
                            .words = fmt::format("Take out the {} of waste (grey).",
                                                 counted(out_.waste.size(), "piece"))});
    add_creases();
    add_pushes();
    for (GuideStep& step : out_.steps)
      if (!step.panels.empty()) step.look_from = sight_.side_of(step.panels);
    return std::move(out_);
  }

 private:
  // 1. What hangs on what.

  void find_card() {
    is_card_.assign(pattern_.faces(), false);
    if (!pattern_.card) return;
    // Not from 0 to wall and ground: a flat sheet may lie anywhere.
    double low_mm = std::numeric_limits<double>::infinity(), high_mm = -low_mm;
    for (const PatternVertex& p : pattern_.vertices)
      low_mm = std::min(low_mm, pattern_.u(p)), high_mm = std::max(high_mm, pattern_.u(p));
    for (std::size_t f = 0; f < pattern_.faces(); ++f)
      is_card_[f] = std::ranges::any_of(pattern_.face(f), [&](std::uint32_t corner) {
        const double u_mm = pattern_.u(pattern_.vertices[corner]);
        return u_mm < low_mm + kTouching_mm || u_mm > high_mm - kTouching_mm;
      });
  }

  /// How many folds each panel is from wall or ground. Where there is no card, from panels that
  /// hang on one other alone.
  void measure_depths() {
    std::vector<std::vector<std::uint32_t>> beside(pattern_.faces());
    for (const PatternEdge& e : pattern_.edges) {
      if (!is_fold(e) || e.left < 0 || e.right < 0) continue;
      beside[static_cast<std::size_t>(e.left)].push_back(static_cast<std::uint32_t>(e.right));
      beside[static_cast<std::size_t>(e.right)].push_back(static_cast<std::uint32_t>(e.left));
    }
    depth_.assign(pattern_.faces(), kNone);
    std::vector<std::uint32_t> reached;
    const auto reach = [&](std::size_t face, std::int32_t depth) {
      if (depth_[face] != kNone) return;
      depth_[face] = depth;
      reached.push_back(static_cast<std::uint32_t>(face));
    };
    std::size_t next = 0;
    const auto spread = [&] {
      for (; next < reached.size(); ++next)
        for (const std::uint32_t other : beside[reached[next]])
          reach(other, depth_[reached[next]] + 1);
    };
    for (std::size_t f = 0; f < pattern_.faces(); ++f)
      if (is_card_[f]) reach(f, 0);
    spread();
    for (std::size_t f = 0; f < pattern_.faces(); ++f)
      if (beside[f].size() == 1) reach(f, 0);
    spread();
    for (std::size_t f = 0; f < pattern_.faces(); ++f) reach(f, 0), spread();
  }

  /// Figures, from the left: panels that stand and hang together, or that lie beside each other
  /// along the spine.
  void find_figures() {
    struct Stretch {
      double v0{std::numeric_limits<double>::infinity()}, v1{-v0};
    };
    DisjointSets sets(pattern_.faces());
    for (const GuideFold& fold : out_.folds) {
      std::int32_t before = kNone;
      for (const std::uint32_t face : fold.panels) {
        if (is_card_[face]) continue;
        if (before != kNone) sets.join(static_cast<std::uint32_t>(before), face);
        before = static_cast<std::int32_t>(face);
      }
    }
    std::vector<std::uint32_t> set_of;
    std::vector<Stretch> stretches(sets.number(set_of));
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      if (is_card_[f]) continue;
      for (const std::uint32_t corner : pattern_.face(f)) {
        Stretch& all = stretches[set_of[f]];
        const double v = pattern_.vertices[corner].v;
        all.v0 = std::min(all.v0, v), all.v1 = std::max(all.v1, v);
      }
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t s = 0; s < stretches.size(); ++s)
      if (stretches[s].v1 >= stretches[s].v0) order.push_back(s);
    std::ranges::sort(order, {}, [&](std::uint32_t s) { return std::pair(stretches[s].v0, s); });
    std::vector<std::int32_t> figure(stretches.size(), kNone);
    double end = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t s : order) {
      if (stretches[s].v0 > end + kTouching_mm) ++figures_;
      end = std::max(end, stretches[s].v1);
      figure[s] = figures_ - 1;
    }
    figure_of_.assign(pattern_.faces(), kNone);
    for (std::size_t f = 0; f < pattern_.faces(); ++f)
      if (!is_card_[f]) figure_of_[f] = figure[set_of[f]];
  }

  [[nodiscard]] std::int32_t figure_of(const GuideFold& fold) const {
    for (const std::uint32_t face : fold.panels)
      if (!is_card_[face]) return figure_of_[face];
    return kNone;
  }
  [[nodiscard]] std::int32_t depth_of(const GuideFold& fold) const {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (const std::uint32_t face : fold.panels) least = std::min(least, depth_[face]);
    return least;
  }
  [[nodiscard]] static double shut_place_mm(const GuideFold& fold) {
    return 0.5 * (fold.from.x + fold.from.z + fold.to.x + fold.to.z);
  }

  [[nodiscard]] std::string figure_words(std::int32_t from, std::int32_t to) const {
    if (figures_ == 1) return "the figure";
    if (from == to) return fmt::format("figure {}", from + 1);
    return fmt::format("figures {} to {}", from + 1, to + 1);
  }

  // 2. Creases.

  void add_creases() {
    struct Place {
      std::int32_t figure, depth;
      double v_mm;
      std::uint32_t fold;
      auto operator<=>(const Place&) const = default;
    };
    std::vector<Place> order;
    for (std::uint32_t k = 0; k < out_.folds.size(); ++k) {
      const GuideFold& fold = out_.folds[k];
      order.push_back({figure_of(fold), depth_of(fold), 0.5 * (fold.from.v + fold.to.v), k});
    }
    std::ranges::sort(order);
    for (std::size_t begin = 0; begin < order.size();) {
      std::size_t end = begin + 1;
      for (; end < order.size() && end - begin < kMostFoldsAStep; ++end) {
        const bool other_figure = order[end].figure != order[end - 1].figure;
        const bool other_depth = other_figure || order[end].depth != order[end - 1].depth;
        if (other_figure && end - begin >= kEnoughOfFigure) break;
        if (other_depth && end - begin >= kEnoughOfLayer) break;
      }
      GuideStep step{.kind = StepKind::Crease};
      for (; begin < end; ++begin) step.folds.push_back(order[begin].fold);
      add_crease(std::move(step));
    }
  }

  void add_crease(GuideStep step) {
    std::ranges::sort(step.folds, {},
                      [&](std::uint32_t k) { return std::pair(shut_place_mm(out_.folds[k]), k); });
    std::size_t mountains = 0;
    std::int32_t first = figures_, last = kNone, deep = 0,
                 shallow = std::numeric_limits<std::int32_t>::max();
    bool is_spine = false;
    for (const std::uint32_t k : step.folds) {
      const GuideFold& fold = out_.folds[k];
      mountains += fold.is_mountain() ? 1 : 0;
      for (const std::uint32_t face : fold.panels)
        if (!is_card_[face]) step.panels.push_back(face);
      const std::int32_t figure = figure_of(fold);
      if (figure == kNone) {
        is_spine = true;
        continue;
      }
      first = std::min(first, figure), last = std::max(last, figure);
      shallow = std::min(shallow, depth_of(fold)), deep = std::max(deep, depth_of(fold));
    }
    sort_out(step.panels);
    const std::size_t valleys = step.folds.size() - mountains;
    std::string what;
    if (mountains > 0) what = counted(mountains, "mountain fold") + " (red, its ridge toward you)";
    if (mountains > 1) what = counted(mountains, "mountain fold") + " (red, ridges toward you)";
    if (mountains > 0 && valleys > 0) what += " and ";
    if (valleys > 0) what += counted(valleys, "valley fold") + " (blue, away from you)";
    std::string where = is_spine ? "the main fold" : "";
    if (last != kNone && is_net()) {
      if (figures_ > 1) where = figure_words(first, last);
    } else if (last != kNone) {
      const std::string figure = figure_words(first, last);
      if (is_spine) where += ", and ";
      if (deep == 0)
        where +=
            fmt::format("where {} {} wall and ground", figure, first == last ? "joins" : "join");
      else if (shallow == 0)
        where += fmt::format("{}, from wall and ground inward", figure);
      else
        where += fmt::format("{}, {} in from wall or ground", figure,
                             counted(static_cast<std::size_t>(shallow), "panel"));
    }
    step.words = where.empty() ? fmt::format("Crease {}.", what)
                               : fmt::format("Crease {}: {}.", what, where);
    out_.steps.push_back(std::move(step));
  }

  static void sort_out(std::vector<std::uint32_t>& panels) {
    std::ranges::sort(panels);
    panels.erase(std::unique(panels.begin(), panels.end()), panels.end());
  }

  // 3. What is pushed while the card shuts.

  struct Push {
    PushFrom from{};
    bool is_inner{};
    std::int32_t first{}, last{};  ///< figures
    std::vector<std::uint32_t> panels;
  };

  /// The panels beside mountain folds, on wall and ground or further in, or those beside valley
  /// folds between two panels that stand.
  [[nodiscard]] Push push_of(std::int32_t figure, PushFrom from, bool is_inner) const {
    Push out{from, is_inner, figure, figure, {}};
    for (const GuideFold& fold : out_.folds) {
      if (figure_of(fold) != figure || fold.is_mountain() != (from == PushFrom::Behind)) continue;
      const bool on_card =
          std::ranges::any_of(fold.panels, [&](std::uint32_t face) { return is_card_[face]; });
      if (from == PushFrom::Front && on_card) continue;
      if (from == PushFrom::Behind && is_inner != (depth_of(fold) > 1)) continue;
      for (const std::uint32_t face : fold.panels)
        if (!is_card_[face]) out.panels.push_back(face);
    }
    sort_out(out.panels);
    return out;
  }

  /// It has neither wall and ground nor a pose: nothing shuts, and it is folded up by hand.
  [[nodiscard]] bool is_net() const { return !pattern_.card && !out_.stands; }

  void add_pushes() {
    if (is_net()) {
      if (out_.folds.empty()) return;
      out_.steps.push_back({.kind = StepKind::Push,
                            .words = "Fold it up along its creases, until its edges meet. "
                                     "Glue or tape the edges that belong together."});
      return;
    }
    constexpr std::array<std::pair<PushFrom, bool>, 3> kStages{
        {{PushFrom::Behind, false}, {PushFrom::Behind, true}, {PushFrom::Front, false}}};
    // As many figures in one push as keep the pages few.
    const auto figures = static_cast<std::size_t>(figures_);
    const std::size_t most = std::max<std::size_t>(1, out_.folds.size() / kFoldsAPush / 2);
    const std::size_t together = std::max<std::size_t>(1, (figures + most - 1) / most);
    const std::size_t begin = out_.steps.size();
    for (const auto& [from, is_inner] : kStages) {
      std::vector<Push> pushes;
      for (std::int32_t figure = 0; figure < figures_; ++figure) {
        Push push = push_of(figure, from, is_inner);
        if (push.panels.empty()) continue;
        const bool joins =
            !pushes.empty() && static_cast<std::size_t>(figure - pushes.back().first) < together;
        if (!joins) {
          pushes.push_back(std::move(push));
          continue;
        }
        Push& all = pushes.back();
        all.last = figure;
        all.panels.insert(all.panels.end(), push.panels.begin(), push.panels.end());
      }
      for (Push& push : pushes) add_push(std::move(push), out_.steps.size() == begin);
    }
    if (out_.folds.empty()) return;
    if (out_.steps.size() == begin)
      out_.steps.push_back({.kind = StepKind::Push, .words = "Fold the card along its main fold."});
    out_.steps.back().words += " Shut the card, press it, and open it.";
  }

  void add_push(Push push, bool is_first) {
    const std::string figure = figure_words(push.first, push.last);
    std::string words;
    if (push.from == PushFrom::Front)
      words = fmt::format("From the front, push the lit valleys of {} in.", figure);
    else if (push.is_inner)
      words = fmt::format("From behind, push the inner ridges of {} out.", figure);
    else
      words = fmt::format("{}rom behind, push the lit panels of {} out, toward you.",
                          is_first ? "Shut the card halfway. F" : "F", figure);
    out_.steps.push_back({.kind = StepKind::Push,
                          .panels = std::move(push.panels),
                          .push_from = push.from,
                          .words = std::move(words)});
  }

  const Pattern& pattern_;
  Sight sight_;
  FoldGuide out_;
  std::vector<bool> is_card_;
  std::vector<std::int32_t> depth_, figure_of_;
  std::int32_t figures_{};
};

}  // namespace

double GuideFold::length_mm() const {
  // On the sheet: u grows with x and falls with z.
  return std::hypot(to.x - to.z - from.x + from.z, to.v - from.v);
}

Result<FoldGuide> fold_guide(const Pattern& pattern) { return Guide(pattern).run(); }

std::string_view sense_of(const GuideFold& fold) {
  return fold.is_mountain() ? "mountain" : "valley";
}

std::string_view name_of(StepKind kind) {
  switch (kind) {
    case StepKind::Waste:
      return "waste";
    case StepKind::Crease:
      return "crease";
    default:
      return "push";
  }
}

std::string_view name_of(LookFrom side) { return side == LookFrom::Left ? "left" : "right"; }

}  // namespace popcut::hands
