// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_names.hpp"

#include <algorithm>
#include <string_view>
#include <unordered_set>

#include "core/formats/pens/layer_words.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostShown = 60;  // bytes of a name

}  // namespace

std::uint32_t SvgNames::add(const pugi::xml_node& node, std::uint32_t outer,
                            std::string_view name) {
  const auto next = static_cast<std::uint32_t>(unknown_.size() + 1);
  const auto [found, is_new] = numbers_.try_emplace({node.hash_value(), outer}, next);
  if (is_new)
    unknown_.push_back({node, shown_text(trimmed(name).substr(0, kMostShown)), outer, false,
                        is_letter_of_cut(name), !is_utf8(name)});
  return found->second;
}

std::uint32_t SvgNames::add_sideless(std::string_view name) {
  const std::string shown = shown_text(trimmed(name).substr(0, kMostShown));
  const auto next = static_cast<std::uint32_t>(sideless_.size() + 1);
  const auto [at, is_new] = sideless_at_.try_emplace(shown, next);
  if (is_new) sideless_.push_back(shown);
  return at->second;
}

void SvgNames::see_known(std::string_view name) {
  has_fold_letters_ = has_fold_letters_ || is_letter_of_fold(name);
}

void SvgNames::draw(std::uint32_t number) {
  // What lies around one that is drawn in is drawn in already.
  for (; number != 0 && !unknown_[number - 1].is_drawn; number = unknown_[number - 1].outer)
    unknown_[number - 1].is_drawn = true;
}

std::vector<const SvgNames::Unknown*> SvgNames::drawn_beside_known(bool any_known) const {
  std::vector<const Unknown*> those;
  for (const Unknown& one : unknown_)
    if (one.is_drawn && (one.is_foreign || any_known) && !(one.is_cut_letter && has_fold_letters_))
      those.push_back(&one);
  return those;
}

std::vector<std::string> SvgNames::asked(bool any_known) const {
  std::vector<std::string> names;
  std::unordered_set<std::string_view> seen;
  for (const Unknown* one : drawn_beside_known(any_known))
    if (seen.insert(one->name).second) names.push_back(one->name);
  return names;
}

pugi::xml_node SvgNames::first_asked(bool any_known) const {
  const auto those = drawn_beside_known(any_known);
  return those.empty() ? pugi::xml_node() : those.front()->node;
}

}  // namespace popcut
