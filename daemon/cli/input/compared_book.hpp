// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/cli/input/compared_pair.hpp"

namespace popcut::cli {

/// Reads the cards of a book, opens each as it was designed, and puts them around the spine: the
/// first ground along x, each further card turned by the openings of those before it. What lies in
/// the pages is left out. `corner` is none.
///
/// @param files  FOLD files, in the order of the book
/// @retval Malformed, OutOfRange  one cannot be opened, all cards are plain, or they take more than
///                                a whole turn; with the file's name
[[nodiscard]] Result<ComparedStructure> read_compared_book(const std::vector<std::string>& files,
                                                           const Progress& progress);

/// The surface of a design with a book, all around the spine: each card's part turned to where it
/// stands. Read and placed by the code of the verifier.
///
/// @param structure  of that book, which says where its slices lie along the spine
/// @retval Malformed, OutOfRange  it cannot be read, or is not of a book; with the file's name
[[nodiscard]] Result<ComparedTarget> read_book_target(const std::string& file,
                                                      const std::string& text,
                                                      const ComparedStructure& structure);

}  // namespace popcut::cli
