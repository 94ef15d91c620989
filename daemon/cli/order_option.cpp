// SPDX-License-Identifier: MIT
#include "daemon/cli/order_option.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "daemon/cli/progress_bar.hpp"

namespace popcut::cli {
namespace {

using std::chrono::steady_clock;

constexpr double kSecondsPerEffort = 60.0;  // at most; on most machines it takes a few
constexpr double kBandMm = 20.0;
constexpr double kCornerDeg = 60.0;

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
  command
      .add_option("--effort", words.effort,
                  "How long best looks: a factor of its moves, ended after a minute a unit")
      ->option_text("N [1]");
  command
      .add_option("--seed", words.seed, "Of the moves that best tries; the same, the same order")
      ->option_text("N [1]");
  command.add_flag(
      "--mat-free", words.mat_free,
      "Without a mat: the sheet in bands along the feed, no cut round a sharp corner, the "
      "outline last");
}

Result<OrderOptions> order_options(const OrderWords& words) {
  OrderOptions out;
  if (words.method == "best") {
    out.method = OrderMethod::Best;
  } else if (words.method == "keep") {
    out.method = OrderMethod::Keep;
  } else if (words.method != "quick") {
    return fail(ErrorKind::Usage, "--order",
                fmt::format("{} is not known; quick, best or keep", words.method));
  }
  if (!(words.effort >= 0.01 && words.effort <= 1000.0))
    return fail(ErrorKind::Usage, "--effort",
                fmt::format("{} is out of range; from 0.01 to 1000", words.effort));
  if (words.mat_free && out.method == OrderMethod::Keep)
    return fail(ErrorKind::Usage, "--mat-free",
                "it changes the order that --order keep keeps; leave one of them out");
  out.effort = words.effort;
  out.seed = words.seed;
  out.band_mm = words.mat_free ? kBandMm : 0.0;
  out.corner_deg = words.mat_free ? kCornerDeg : 0.0;
  const double most_s = kSecondsPerEffort * std::max(words.effort, 1.0);
  const auto watch = std::make_shared<Watch>(words.progress, most_s);
  out.keep_going = [watch](double done) { return watch->go_on(done); };
  return out;
}

}  // namespace popcut::cli
