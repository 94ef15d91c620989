// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pugixml.hpp>

namespace popcut {

/// The names of a drawing that have words, none of which popcut knows. Such a name is asked about
/// if lines without a closer name are drawn there, and other names of the drawing are known, or if
/// it is in a code that is not read.
class SvgNames {
 public:
  /// Adds a name that is not known. @param outer  the number of the one around it; 0: none
  /// Returns its number, from 1.
  std::uint32_t add(const pugi::xml_node& node, std::uint32_t outer, std::string_view name);
  /// A line is drawn in the element with the number `number`, and nothing else says what it is for.
  void draw(std::uint32_t number);
  /// A line has a known name.
  void see_known(std::string_view name);
  /// Those to ask about, the first first. @param any_known  any line has a name that is known
  [[nodiscard]] std::vector<std::string> asked(bool any_known) const;
  /// The name with the number `number`, as `asked` gives it; empty for 0.
  [[nodiscard]] std::string name(std::uint32_t number) const {
    return number == 0 ? std::string() : unknown_[number - 1].name;
  }
  /// Adds the name of folds whose side it does not say. Returns its number, from 1.
  std::uint32_t add_sideless(std::string_view name);
  /// The name with this number of `add_sideless`.
  [[nodiscard]] const std::string& sideless(std::uint32_t number) const {
    return sideless_[number - 1];
  }
  /// The element of the first of `asked`.
  [[nodiscard]] pugi::xml_node first_asked(bool any_known) const;

 private:
  struct Unknown {
    pugi::xml_node node;
    std::string name;
    std::uint32_t outer{};
    bool is_drawn{};
    bool is_cut_letter{};  ///< B or C
    bool is_foreign{};     ///< not in UTF-8: it may be a known word in a code that is not read
  };
  [[nodiscard]] std::vector<const Unknown*> drawn_beside_known(bool any_known) const;

  std::vector<Unknown> unknown_;
  std::vector<std::string> sideless_;                 ///< each once
  std::map<std::string, std::uint32_t> sideless_at_;  ///< their numbers
  bool has_fold_letters_{};
  std::map<std::pair<std::size_t, std::uint32_t>, std::uint32_t> numbers_;  ///< by node and `outer`
};

}  // namespace popcut
