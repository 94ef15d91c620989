// SPDX-License-Identifier: MIT
#include "tests/support/steady.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "core/plot/plot.hpp"
#include "tests/support/running_daemon.hpp"

namespace popcut::testing {
namespace {

std::vector<Held> warm(const std::vector<Held>& looks) {
  if (looks.empty()) return {};
  const double from = looks.front().s + (looks.back().s - looks.front().s) / 4;
  std::vector<Held> rest;
  std::copy_if(looks.begin(), looks.end(), std::back_inserter(rest),
               [&](const Held& look) { return look.s >= from; });
  return rest;
}

double mean(const std::vector<Held>& looks, double Held::*value) {
  double sum = 0;
  for (const Held& look : looks) sum += look.*value;
  return looks.empty() ? 0 : sum / static_cast<double>(looks.size());
}

plot::Panel panel(const std::vector<Held>& looks, double Held::*value, const char* title,
                  const char* colour) {
  plot::Panel drawn;
  plot::Curve curve{"", {}, colour}, fitted{"fitted", {}, plot::kRed};
  fitted.dashed = true;
  double most = 0;
  for (const Held& look : looks) {
    curve.points.push_back({look.s / 60, look.*value});
    most = std::max(most, look.*value);
  }
  const std::vector<Held> rest = warm(looks);
  const double slope = slope_per_h(looks, value);
  const double middle_s = mean(rest, &Held::s), middle = mean(rest, value);
  for (const Held* end : {&rest.front(), &rest.back()})
    fitted.points.push_back({end->s / 60, middle + slope * (end->s - middle_s) / 3600});
  drawn.title = fmt::format("{} ({:+.3g} an hour)", title, slope);
  drawn.x = {"minutes", 0, looks.back().s / 60};
  drawn.y = {title, 0, 1.2 * std::max(most, 1.0)};
  drawn.curves = {curve, fitted};
  return drawn;
}

}  // namespace

Held held_by(int process, double s) {
  Held now{s, 0, static_cast<double>(open_files(process))};
  std::ifstream pages(fmt::format("/proc/{}/statm", process));
  double all = 0, resident = 0;
  if (pages >> all >> resident)
    now.rss_mib = resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
  return now;
}

double slope_per_h(const std::vector<Held>& looks, double Held::*value) {
  const std::vector<Held> rest = warm(looks);
  const double middle_s = mean(rest, &Held::s), middle = mean(rest, value);
  double products = 0, squares = 0;
  for (const Held& look : rest) {
    products += (look.s - middle_s) * (look.*value - middle);
    squares += (look.s - middle_s) * (look.s - middle_s);
  }
  return squares > 0 ? 3600 * products / squares : 0;
}

std::string why_not_steady(const std::vector<Held>& looks, double most_mib, double most_files) {
  const std::vector<Held> rest = warm(looks);
  if (rest.size() < 10) return fmt::format("{} looks are too few", rest.size());
  if (std::any_of(rest.begin(), rest.end(),
                  [](const Held& look) { return look.rss_mib <= 0 || look.files <= 0; }))
    return "it was not there at one of the looks";
  const double hours = (rest.back().s - rest.front().s) / 3600;
  const double memory = slope_per_h(looks, &Held::rss_mib) * hours,
               files = slope_per_h(looks, &Held::files) * hours;
  if (memory > most_mib)
    return fmt::format("its memory grew by {:.2f} MiB, more than {:g}", memory, most_mib);
  if (files > most_files) return fmt::format("it has {:.1f} descriptors more at the end", files);
  return {};
}

std::string looks_csv(const std::vector<Held>& looks) {
  std::string text = "s,rss_mib,files\n";
  for (const Held& look : looks)
    text += fmt::format("{:.1f},{:.3f},{:.0f}\n", look.s, look.rss_mib, look.files);
  return text;
}

std::string looks_svg(const std::vector<Held>& looks) {
  if (looks.size() < 2) return {};
  const std::vector<plot::Panel> panels{
      panel(looks, &Held::rss_mib, "memory, MiB", plot::kBlue),
      panel(looks, &Held::files, "open descriptors", plot::kGreen)};
  return plot::figure_svg(panels);
}

}  // namespace popcut::testing
