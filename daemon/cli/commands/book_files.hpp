// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/patches.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// Which files of a whole book are wanted beside its report.
struct BookFiles {
  bool animation{true}, picture{true};
  double thickness_mm{};  ///< of the animation; 0: one surface
};

/// Writes book.json, book.glb (opening, as one animation) and book.svg (from eight sides).
[[nodiscard]] Result<void> add_book_files(const PatchAssembly& book, const BookFiles& files,
                                          OutputFolder& folder);

/// Prints how near a book comes to its model, its pages, and what to glue.
void say_book(const PatchAssembly& book);

}  // namespace popcut::cli
