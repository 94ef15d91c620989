// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"
#include "daemon/pictures/pdf_page.hpp"
#include "daemon/planning/planner.hpp"

namespace popcut::planning {

/// Whether the design of a task is a PDF, by its first bytes. Then a worker must be started for it
/// with the word "pdf" (see `run_worker`). Reads a few bytes of a stored file.
[[nodiscard]] bool has_pdf(const daemon::PlanningTask& task);

/// A page of a PDF as an SVG, drawn in a worker of its own: at most 1 min of processor time and
/// 2 GiB. For a program with `--worker`, which is started once more; blocks.
///
/// @param page  from 1
/// @retval Malformed, OutOfRange, Internal  see `pictures::pdf_page`; or poppler crashed
[[nodiscard]] Result<pictures::PdfPage> pdf_page_apart(std::string pdf, std::uint64_t page);

}  // namespace popcut::planning
