// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/verify.hpp"

namespace popcut {

/// A card of a book, by its FOLD file.
struct VerifiedCard {
  std::string name;  ///< how failures call it
  std::string_view fold_text;
};

/// What a book is and whether it is sound.
struct BookVerifyReport {
  std::vector<std::string> names;  ///< of the cards
  std::vector<VerifyReport> cards;
  std::vector<VerifyCheck> checks;  ///< of the glued whole
  double page_mm{}, width_mm{};     ///< of the smallest page
  double closed_mm{};               ///< how far the structures reach from the spine when it is shut
  double open_deg{};                ///< what all cards take when each is as it was designed

  [[nodiscard]] bool ok() const;
  /// How many things fail, over all checks.
  [[nodiscard]] std::size_t failed() const;
};

/// Judges a book: cards around one spine, in order, the wall of each glued back to back onto the
/// ground of the next one. Each card is judged by `verify_fold`, and must have one freedom. Of the
/// glued whole:
///
///     seams    wall and next ground are rectangles of the same size, so that they coincide at
///     every
///              opening: both hang on the spine
///     around   the cards take at most a whole turn
///     apart    no face of a card leaves the wedge between its own ground and its own wall. Wedges
///              of different cards have only a page in common, so that faces of two cards never
///              cross. Where every pose of the file is X e1 + Z e2(psi) with the same X, Z >= 0,
///              this holds at every opening (docs/geometry.md, section 2); else for the poses of
///              the file
///     closed   shut, each structure lies inside the pages: X + Z is at most the page
///
/// @retval OutOfRange   no cards
/// @retval Malformed, OutOfRange  a card cannot be read; place begins with its name
[[nodiscard]] Result<BookVerifyReport> verify_book(std::span<const VerifiedCard> cards,
                                                   const Progress& progress = {});

/// The report as text: a line a card and a line a check, with the first failures.
[[nodiscard]] std::string verify_text(const BookVerifyReport& report);
/// The report as a JSON document; `cards` has `verify_json` of each.
[[nodiscard]] std::string verify_json(const BookVerifyReport& report);

}  // namespace popcut
