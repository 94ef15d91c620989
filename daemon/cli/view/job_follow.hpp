// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {

/// While one of these is alive, Ctrl-C ends only the view; `asked` is true after Ctrl-C.
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

/// Follows a job until `enough` returns true or the job has ended. Prints on standard error, once,
/// each thing that a person has to do, and the progress. popcutd may be absent for a minute.
///
/// @return the job at that moment
/// @retval Refused  Ctrl-C was pressed; the job goes on
[[nodiscard]] Result<nlohmann::json> follow_job(
    client::Api& api, const std::string& id, const Globals& globals,
    const std::function<bool(const nlohmann::json&)>& enough);

/// Calls `changed` at once, then at each event other than progress (at most four times a second),
/// and every two seconds. Ends with Ctrl-C, or when `changed` returns false.
[[nodiscard]] Result<void> watch_events(client::Api& api,
                                        const std::function<Result<bool>()>& changed);

/// Success if the job is done, else its state as an error (exit code 5).
[[nodiscard]] Result<void> verdict(const nlohmann::json& job);

}  // namespace popcut::cli
