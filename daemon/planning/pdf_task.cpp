// SPDX-License-Identifier: MIT
#include "daemon/planning/pdf_task.hpp"

#include <array>
#include <fstream>
#include <utility>

#include "daemon/planning/worker_talk.hpp"

namespace popcut::planning {

bool has_pdf(const daemon::PlanningTask& task) {
  if (task.design_path.empty()) return pictures::is_pdf(task.design_text);
  std::array<char, 5> head{};
  std::ifstream file(task.design_path, std::ios::binary);
  file.read(head.data(), head.size());
  return pictures::is_pdf({head.data(), static_cast<std::size_t>(file.gcount())});
}

Result<pictures::PdfPage> pdf_page_apart(std::string pdf, std::uint64_t page) {
  daemon::PlanningTask task;
  task.kind = daemon::PlanningTask::Kind::Svg;
  task.design_text = std::move(pdf);
  task.options["page"] = std::to_string(page);
  daemon::PlanningLimits limits;
  limits.cpu_s = 60;
  const CallOff never;
  auto outcome = run_in_worker(task, limits, "/proc/self/exe", never);
  if (!outcome && outcome.error().kind == ErrorKind::Infeasible)
    return fail(ErrorKind::Malformed, "",
                "is a PDF that cannot be read: poppler, which reads it, crashes or takes more than "
                "1 min or 2 GiB; export it again, or save it as SVG");
  if (!outcome) return tl::unexpected(outcome.error());
  if (outcome->files.size() != 1)
    return fail(ErrorKind::Internal, "worker", "sent no drawing of the PDF");
  return pictures::PdfPage{std::move(outcome->files.front().bytes), std::move(outcome->warnings)};
}

}  // namespace popcut::planning
