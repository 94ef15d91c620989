// SPDX-License-Identifier: MIT
#include "core/verify/book.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/text/json_text.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/target/target.hpp"
#include "core/verify/verify_json.hpp"

namespace popcut {
namespace {

using namespace verify;
using Json = nlohmann::ordered_json;

constexpr double kNearlyFlatRad = 0.02;  ///< psi this near to 0 or pi tells nothing of X and Z

/// A card as it stands between its pages.
struct Standing {
  double slack_mm{};
  double psi_rad{};  ///< that it is designed for
  double wall_mm{}, ground_mm{}, begin_mm{}, end_mm{};
  double reach_mm{};       ///< largest X + Z
  std::size_t farthest{};  ///< vertex of it
  double least_mm{};       ///< least X or Z of all poses
  std::size_t outside{};   ///< vertices out of the wedge
  std::size_t first_outside{};
  std::size_t poses{};   ///< that were looked at
  bool is_affine{true};  ///< all of them have the same X and Z
};

/// Places of a card's vertices in its wedge, from all poses that state their opening.
std::optional<Standing> standing_of(const FoldModel& file) {
  Standing out;
  out.slack_mm = limits_of(file).slack_mm;
  std::vector<FoldVertex> first;
  std::vector<bool> is_out(file.flat.size());
  double least = std::numeric_limits<double>::infinity();
  for (const Pose& pose : file.poses) {
    if (!pose.psi_rad || *pose.psi_rad < kNearlyFlatRad ||
        *pose.psi_rad > std::numbers::pi - kNearlyFlatRad)
      continue;
    ++out.poses;
    std::vector<FoldVertex> at;
    at.reserve(pose.at.size());
    for (const Vec3& p : pose.at) at.push_back(unposed(p, *pose.psi_rad));
    for (std::size_t v = 0; v < at.size(); ++v) {
      least = std::min({least, at[v].x, at[v].z});
      is_out[v] = is_out[v] || at[v].x < -out.slack_mm || at[v].z < -out.slack_mm;
      if (!first.empty())
        out.is_affine = out.is_affine && std::abs(at[v].x - first[v].x) <= 10.0 * out.slack_mm &&
                        std::abs(at[v].z - first[v].z) <= 10.0 * out.slack_mm;
    }
    if (first.empty()) first = std::move(at);
  }
  if (first.empty()) return std::nullopt;
  out.psi_rad = file.design_psi_rad.value_or(std::numbers::pi / 2);
  out.least_mm = least;
  out.begin_mm = std::numeric_limits<double>::infinity(), out.end_mm = -out.begin_mm;
  for (std::size_t v = 0; v < first.size(); ++v) {
    const auto [x, z] = first[v];
    if (is_out[v] && out.outside++ == 0) out.first_outside = v;
    const bool on_wall = std::abs(x) <= out.slack_mm, on_ground = std::abs(z) <= out.slack_mm;
    if (on_wall) out.wall_mm = std::max(out.wall_mm, z);
    if (on_ground) out.ground_mm = std::max(out.ground_mm, x);
    if (on_wall || on_ground) {
      out.begin_mm = std::min(out.begin_mm, file.flat[v].y());
      out.end_mm = std::max(out.end_mm, file.flat[v].y());
    } else if (x + z > out.reach_mm) {
      out.reach_mm = x + z, out.farthest = v;
    }
  }
  return out;
}

std::string vertex_of(const std::string& card, std::size_t v) {
  return fmt::format("{}: /vertices_coords/{}", card, v);
}

class Judge {
 public:
  Judge(std::span<const VerifiedCard> cards, BookVerifyReport& report)
      : cards_(cards), report_(report) {}

  Result<void> read(std::size_t i) {
    const auto file = read_fold_model(cards_[i].fold_text);
    if (!file) return tl::unexpected(within(cards_[i].name, file.error()));
    standing_.push_back(standing_of(*file));
    return {};
  }

  void judge() {
    std::string unknown;
    for (std::size_t i = 0; i < cards_.size(); ++i)
      if (!standing_[i] && unknown.empty()) unknown = cards_[i].name;
    for (VerifyCheck (Judge::*check)() :
         {&Judge::seams, &Judge::around, &Judge::apart, &Judge::closed}) {
      if (unknown.empty()) {
        report_.checks.push_back((this->*check)());
        continue;
      }
      VerifyCheck left_out = named("book");
      left_out.fail(unknown,
                    "no frame has an opening angle (frame_popcut:psi_rad), so it is not "
                    "known how the card stands");
      report_.checks.push_back(std::move(left_out));
      return;
    }
  }

 private:
  [[nodiscard]] const Standing& at(std::size_t i) const { return *standing_[i]; }

  VerifyCheck seams() {
    VerifyCheck check = named("seams");
    double most = 0.0;
    for (std::size_t i = 0; i + 1 < cards_.size(); ++i) {
      const Standing &a = at(i), &b = at(i + 1);
      const double slack = a.slack_mm + b.slack_mm;
      const double off =
          std::max({std::abs(a.wall_mm - b.ground_mm), std::abs(a.begin_mm - b.begin_mm),
                    std::abs(a.end_mm - b.end_mm)});
      most = std::max(most, off);
      if (!(off <= slack))
        check.fail(fmt::format("{} and {}", cards_[i].name, cards_[i + 1].name),
                   fmt::format("the wall is {:.6g} mm high and reaches from {:.6g} to {:.6g} mm "
                               "along the spine, the ground that it is glued to {:.6g} mm deep "
                               "and from {:.6g} to {:.6g} mm",
                               a.wall_mm, a.begin_mm, a.end_mm, b.ground_mm, b.begin_mm, b.end_mm));
    }
    report_.page_mm = std::numeric_limits<double>::infinity();
    report_.width_mm = report_.page_mm;
    for (const auto& card : standing_) {
      report_.page_mm = std::min({report_.page_mm, card->wall_mm, card->ground_mm});
      report_.width_mm = std::min(report_.width_mm, card->end_mm - card->begin_mm);
    }
    check.detail = fmt::format("{} glued pages, each on the back of the next ground, {:.2g} mm off",
                               cards_.size() - 1, most);
    return check;
  }

  VerifyCheck around() {
    VerifyCheck check = named("around");
    double sum = 0.0;
    for (const auto& card : standing_) sum += card->psi_rad;
    report_.open_deg = degrees(sum);
    constexpr double kRoundingDeg = 1e-6;
    if (report_.open_deg > 360.0 + kRoundingDeg)
      check.fail("", fmt::format("the cards take {:.6g} degrees, more than a whole turn",
                                 report_.open_deg));
    const bool is_whole = std::abs(report_.open_deg - 360.0) <= kRoundingDeg;
    check.detail = fmt::format("open, {} cards take {:.6g} degrees{}", cards_.size(),
                               report_.open_deg, is_whole ? ": the covers meet" : "");
    return check;
  }

  VerifyCheck apart() {
    VerifyCheck check = named("apart");
    std::size_t sampled = 0;
    for (std::size_t i = 0; i < cards_.size(); ++i) {
      const Standing& card = at(i);
      sampled += card.is_affine ? 0 : 1;
      if (card.outside == 0) continue;
      check.fail(vertex_of(cards_[i].name, card.first_outside),
                 fmt::format("{} vertices are behind the card's own wall or ground, by {:.3g} mm "
                             "at most, where the next card is",
                             card.outside, -card.least_mm));
    }
    check.detail =
        sampled == 0
            ? std::string(
                  "each card stays between its own pages at every opening, so faces of two "
                  "cards never cross")
            : fmt::format(
                  "each card stays between its own pages; of {} cards this was looked at "
                  "in the poses of their files only",
                  sampled);
    return check;
  }

  VerifyCheck closed() {
    VerifyCheck check = named("closed");
    for (std::size_t i = 0; i < cards_.size(); ++i) {
      const Standing& card = at(i);
      report_.closed_mm = std::max(report_.closed_mm, card.reach_mm);
      const double page = std::min(card.wall_mm, card.ground_mm);
      if (card.reach_mm > page + card.slack_mm)
        check.fail(vertex_of(cards_[i].name, card.farthest),
                   fmt::format("shut, it is {:.6g} mm from the spine, out of the page of {:.6g} mm",
                               card.reach_mm, page));
    }
    check.detail = fmt::format("shut, the structures reach {:.1f} of {:.1f} mm", report_.closed_mm,
                               report_.page_mm);
    return check;
  }

  std::span<const VerifiedCard> cards_;
  BookVerifyReport& report_;
  std::vector<std::optional<Standing>> standing_;
};

std::string failed_checks(const VerifyReport& card) {
  std::string out;
  for (const VerifyCheck& check : card.checks)
    if (!check.ok())
      out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", check.name, check.failed);
  return out;
}

}  // namespace

bool BookVerifyReport::ok() const { return failed() == 0; }

std::size_t BookVerifyReport::failed() const {
  std::size_t sum = 0;
  for (const VerifyReport& card : cards) sum += card.failed();
  for (const VerifyCheck& check : checks) sum += check.failed;
  return sum;
}

Result<BookVerifyReport> verify_book(std::span<const VerifiedCard> cards,
                                     const Progress& progress) {
  if (cards.empty()) return fail(ErrorKind::OutOfRange, "", "a book without cards");
  BookVerifyReport report;
  Judge judge(cards, report);
  for (std::size_t i = 0; i < cards.size(); ++i) {
    tell(progress, fmt::format("checking card {} of {}", i + 1, cards.size()),
         static_cast<double>(i) / static_cast<double>(cards.size()));
    VerifyOptions how;
    how.degrees_of_freedom = 1;
    auto card = verify_fold(cards[i].fold_text, how);
    if (!card) return tl::unexpected(within(cards[i].name, card.error()));
    report.names.push_back(cards[i].name);
    report.cards.push_back(std::move(*card));
    if (auto done = judge.read(i); !done) return tl::unexpected(done.error());
  }
  tell(progress, "checking the glued book");
  judge.judge();
  return report;
}

std::string verify_text(const BookVerifyReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.cards.size(); ++i) {
    const VerifyReport& card = report.cards[i];
    const std::string freedoms =
        card.degrees_of_freedom ? fmt::format("degrees of freedom: {}", *card.degrees_of_freedom)
                                : std::string("degrees of freedom not counted");
    text += fmt::format("{:<7} {:<19} {}, {} rigid faces{}\n", card.ok() ? "ok" : "FAILED",
                        report.names[i], freedoms, card.faces,
                        card.ok() ? "" : "; fails: " + failed_checks(card));
  }
  VerifyReport whole;
  whole.checks = report.checks;
  return text + verify_text(whole);
}

std::string verify_json(const BookVerifyReport& report) {
  Json json{{"ok", report.ok()},
            {"page_mm", {report.page_mm, report.width_mm}},
            {"closed_mm", report.closed_mm},
            {"open_deg", report.open_deg},
            {"failed", report.failed()},
            {"checks", checks_json(report.checks)},
            {"cards", Json::array()}};
  for (std::size_t i = 0; i < report.cards.size(); ++i) {
    Json card{{"name", report.names[i]}};
    card.update(verify_report_json(report.cards[i]));
    json["cards"].push_back(std::move(card));
  }
  return json_file(json);
}

}  // namespace popcut
