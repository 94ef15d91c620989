// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {

/// True once Ctrl-C was pressed. While one of these is alive, Ctrl-C ends the view and nothing
/// else.
class ViewEnd {
 public:
  ViewEnd();
  ~ViewEnd();
  ViewEnd(const ViewEnd&) = delete;
  ViewEnd& operator=(const ViewEnd&) = delete;
  [[nodiscard]] static bool asked();

 private:
  void (*before_)(int);
};

/// Follows a job until `enough` says so or it has ended, telling on standard error each thing that
/// waits for a person, once, and how far the cut is. popcutd may be away for a minute meanwhile.
///
/// @return the job as it is then
/// @retval Refused  Ctrl-C was pressed; the job goes on
[[nodiscard]] Result<nlohmann::json> follow_job(
    client::Api& api, const std::string& id, const Globals& globals,
    const std::function<bool(const nlohmann::json&)>& enough);

/// Calls `changed` at once, at each event that is not only progress, at most four times a second,
/// and now and then without one. Ends with Ctrl-C or when it says so.
[[nodiscard]] Result<void> watch_events(client::Api& api,
                                        const std::function<Result<bool>()>& changed);

/// Nothing if the job is done, else what became of it (exit code 5).
[[nodiscard]] Result<void> verdict(const nlohmann::json& job);

}  // namespace popcut::cli
