// SPDX-License-Identifier: MIT
#include "daemon/cli/options/order_option.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/progress_bar.hpp"

namespace popcut::cli {
namespace {

using std::chrono::steady_clock;

constexpr double kSecondsPerEffort = 60.0;  // at most; on most machines it takes a few

// Shows how far the search is, and ends it when its time is over.
class Watch {
 public:
  Watch(bool progress, double most_s) : bar_(progress), most_s_(most_s) {}

  bool go_on(double done) {
    if (!begun_) begun_ = steady_clock::now();
    const std::chrono::duration<double> taken = steady_clock::now() - *begun_;
    const double left = done > 0.0 ? taken.count() * (1.0 - done) / done : most_s_;
    bar_.show("looking for a short way", done, std::min(left, most_s_ - taken.count()));
    return taken.count() < most_s_;
  }

 private:
  ProgressBar bar_;
  double most_s_;
  std::optional<steady_clock::time_point> begun_;  // by the first question
};

}  // namespace

void add_order_options(CLI::App& command, OrderWords& words) {
  command
      .add_option("--order", words.method,
                  "Order of the strokes: quick, best (looks longer for a short way), or keep (as "
                  "drawn)")
      ->option_text("WORD [quick]");
  real_number(
      command.add_option("--effort", words.effort,
                         "How long best looks: a factor of its moves, ended after a minute a unit"),
      0.01, 1000)
      ->option_text("N [1]");
  whole_number(command.add_option("--seed", words.seed,
                                  "Of the moves that best tries; the same, the same order"),
               0, std::numeric_limits<std::int64_t>::max())
      ->option_text("N [1]");
  command.add_flag(
      "--mat-free", words.mat_free,
      "Without a mat: the sheet in bands along the feed, no cut round a sharp corner, the "
      "outline last");
}

std::function<bool(double)> watched_search(const OrderWords& words) {
  const double most_s = kSecondsPerEffort * std::max(words.effort, 1.0);
  const auto watch = std::make_shared<Watch>(words.progress, most_s);
  return [watch](double done) { return watch->go_on(done); };
}

}  // namespace popcut::cli
