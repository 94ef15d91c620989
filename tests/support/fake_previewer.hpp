// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <utility>

#include "daemon/previews/previewer.hpp"

namespace popcut::testing {

/// A previewer that has every answer at once: what a service is tested with.
class FakePreviewer final : public daemon::Previewer {
 public:
  std::uint64_t start(daemon::PreviewTask task, Done done) override {
    daemon::PlanningOutcome made;
    for (const char* name :
         {"lattice", "spec.json", "deployed.svg", "pattern.svg", "artwork.pdf", "make.json"})
      made.files.push_back({name, "{}"});
    if (const auto file = task.task.options.find("file"); file != task.task.options.end())
      made.files.push_back({file->second, "{}"});
    done(std::move(made));
    return ++last_;
  }
  void cancel(std::uint64_t /*task*/) override {}
  void stop() override {}

 private:
  std::uint64_t last_{0};
};

}  // namespace popcut::testing
