// SPDX-License-Identifier: MIT
#include "core/search/halving.hpp"

#include <algorithm>
#include <cmath>

#include "core/search/draws.hpp"

namespace popcut {
namespace {

/// Hands out places.
class Places {
 public:
  Places(std::span<const Judged> candidates, const Halving& step)
      : candidates_(candidates), step_(step), chosen_(candidates.size(), 0) {}

  std::vector<std::size_t> run() {
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (candidates_[k].made && candidates_[k].stays) chosen_[k] = 1;
    const auto at_random = static_cast<std::size_t>(
        std::floor(step_.random_share * static_cast<double>(step_.keep) + 0.5));
    const std::size_t ranked = step_.keep - std::min(at_random, step_.keep);
    take_least_error((ranked + 1) / 2);
    take_layers(ranked / 2);
    take_at_random(step_.keep - taken_);
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < chosen_.size(); ++k)
      if (chosen_[k] != 0) out.push_back(k);
    return out;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> left() const {
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < candidates_.size(); ++k)
      if (candidates_[k].made && chosen_[k] == 0) out.push_back(k);
    return out;
  }
  void take(std::size_t k) { chosen_[k] = 1, ++taken_; }
  [[nodiscard]] bool is_dear(std::size_t k) const { return candidates_[k].cost > step_.most_cost; }

  void take_least_error(std::size_t count) {
    std::vector<std::size_t> order = left();
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      if (is_dear(a) != is_dear(b)) return is_dear(b);
      return candidates_[a].error < candidates_[b].error;
    });
    for (std::size_t n = 0; n < std::min(count, order.size()); ++n) take(order[n]);
  }

  void take_layers(std::size_t count) {
    while (count > 0) {
      std::vector<std::size_t> open = left();
      const bool any_cheap =
          std::any_of(open.begin(), open.end(), [&](std::size_t k) { return !is_dear(k); });
      if (any_cheap) std::erase_if(open, [&](std::size_t k) { return is_dear(k); });
      if (open.empty()) return;
      std::vector<Judged> judged;
      judged.reserve(open.size());
      for (const std::size_t k : open) judged.push_back(candidates_[k]);
      // The least errors first, where a layer has more than there are places.
      std::vector<std::size_t> layer = pareto_front(judged);
      std::reverse(layer.begin(), layer.end());
      for (const std::size_t n : layer) {
        if (count == 0) return;
        take(open[n]), --count;
      }
    }
  }

  void take_at_random(std::size_t count) {
    std::vector<std::pair<double, std::size_t>> order;
    for (const std::size_t k : left()) order.emplace_back(draw(step_.seed, step_.step, k), k);
    std::sort(order.begin(), order.end());
    for (std::size_t n = 0; n < std::min(count, order.size()); ++n) take(order[n].second);
  }

  std::span<const Judged> candidates_;
  const Halving& step_;
  std::vector<char> chosen_;
  std::size_t taken_{};
};

}  // namespace

std::vector<std::size_t> survivors(std::span<const Judged> candidates, const Halving& step) {
  return Places(candidates, step).run();
}

std::vector<std::size_t> pareto_front(std::span<const Judged> candidates, double most_cost) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (candidates[k].made && candidates[k].cost <= most_cost) order.push_back(k);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Judged &p = candidates[a], &q = candidates[b];
    return p.cost != q.cost ? p.cost < q.cost : p.error < q.error;
  });
  std::vector<std::size_t> out;
  for (const std::size_t k : order)
    if (out.empty() || candidates[k].error < candidates[out.back()].error) out.push_back(k);
  return out;
}

std::vector<std::size_t> shown_front(std::span<const Judged> candidates,
                                     std::span<const std::size_t> shorter) {
  constexpr double kAboutTheSame = 1.1;
  constexpr std::size_t kMost = 8;
  const std::vector<std::size_t> front = pareto_front(candidates);
  std::vector<std::size_t> needed;  // the least error that costs no more than each of `shorter`
  for (const std::size_t before : shorter)
    for (auto k = front.rbegin(); k != front.rend(); ++k)
      if (candidates[*k].cost <= candidates[before].cost) {
        needed.push_back(*k);
        break;
      }
  const auto is_needed = [&](std::size_t k) {
    return std::find(needed.begin(), needed.end(), k) != needed.end();
  };
  std::vector<std::size_t> out;
  for (auto k = front.rbegin(); k != front.rend(); ++k)
    if (out.empty() || is_needed(*k) ||
        kAboutTheSame * candidates[*k].cost < candidates[out.back()].cost)
      out.push_back(*k);
  std::reverse(out.begin(), out.end());
  while (out.size() > kMost) {
    const auto gain = [&](std::size_t n) {
      return candidates[out[n - 1]].error - candidates[out[n]].error;
    };
    std::size_t least = 0;  // none
    for (std::size_t n = 1; n + 1 < out.size(); ++n)
      if (!is_needed(out[n]) && (least == 0 || gain(n) < gain(least))) least = n;
    if (least == 0) break;
    out.erase(out.begin() + static_cast<std::ptrdiff_t>(least));
  }
  return out;
}

}  // namespace popcut
