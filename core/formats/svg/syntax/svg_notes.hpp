// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/warning.hpp"

namespace popcut {

/// What popcut does not read as drawn, or reads in a way that the author may not expect.
enum class SvgNote {
  Dashed,
  Dots,
  FillCut,
  FillIgnored,
  FillBackground,
  FillUnnamed,
  FillsCross,
  Invisible,
  LeftOut,
  Hidden,
  Language,
  Needs,
  Moving,
  Scripted,
  Squashed,
  Empty,
  Clipped,
  ClipMissing,
  ClipUnread,
  Masked,
  Filtered,
  Marked,
  PaintServer,
  OutOfFrame,
  BeyondPage,
  SymbolPoint,
  ForeignUse,
  MissingUse,
  ForeignSheet,
  Selector,
  SheetBlock,
  Value,
  ColourUnread,
  SheetGeometry,
  OwnBox,
  NamedGroup,
  NamedShape,
  NoWidth,
  White,
  Assignment,
  Count_,
};

/// Counts notes, and remembers where each first occurred.
class SvgNotes {
 public:
  /// Calls `where` only for the first note of a kind.
  template <typename Where>
  void add(SvgNote note, const Where& where, std::size_t count = 1) {
    Entry& entry = entries_[static_cast<std::size_t>(note)];
    if (entry.count == 0) entry.first = where();
    entry.count += count;
  }
  /// Adds an element that cannot be read.
  template <typename Where>
  void add_element(std::string_view name, const Where& where) {
    auto found = elements_.find(name);
    if (found == elements_.end()) {
      if (elements_.size() >= kMostNames) name = "other elements";
      found = elements_.try_emplace(std::string(name.substr(0, 40))).first;
    }
    if (found->second.count == 0) found->second.first = where();
    ++found->second.count;
  }
  /// One sentence per kind: how many, what, where the first one is, and how to fix it.
  [[nodiscard]] std::vector<Warning> warnings() const;

 private:
  static constexpr std::size_t kMostNames = 50;
  struct Entry {
    std::size_t count{};
    std::string first;
  };
  std::array<Entry, static_cast<std::size_t>(SvgNote::Count_)> entries_;
  std::map<std::string, Entry, std::less<>> elements_;
};

}  // namespace popcut
