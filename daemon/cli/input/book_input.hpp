// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut::cli {

/// A card of a book that was designed.
struct BookCardFile {
  std::string name;  ///< "card-01", its folder
  std::string file;  ///< its FOLD file
};

/// A book as `popcut design` wrote it.
struct BookInput {
  std::string name;
  std::vector<BookCardFile> cards;  ///< in the order around the spine
};

/// Whether an argument means a book: a folder, or a file that says it is a book's.
[[nodiscard]] bool names_book(const std::string& file);

/// Finds the cards of a book by its folder or its book.json. The cards are not read.
///
/// @retval Malformed   no book.json there, or not one of popcut's
/// @retval OutOfRange  no cards, or a folder that leads out of the book's
[[nodiscard]] Result<BookInput> read_book(const std::string& file);

}  // namespace popcut::cli
