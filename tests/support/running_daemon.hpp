// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/client/api.hpp"
#include "device/sim/trace.hpp"
#include "tests/support/daemon_process.hpp"

namespace popcut::testing {

/// Waits until `holds`, at most `seconds`, looking every few milliseconds.
[[nodiscard]] bool happens(const std::function<bool()>& holds, double seconds = 300);

/// A running popcutd, and a person who asks it over its unix socket. What does not answer as it
/// should throws, so that it can be used on any thread.
class RunningDaemon {
 public:
  using Json = nlohmann::json;

  /// @param more  at the end of the configuration
  explicit RunningDaemon(double time_scale = 0, const std::string& more = "",
                         const std::string& device = "sim:cameo3");

  /// Starts popcutd; throws with its log if it does not serve.
  void open(const std::vector<std::string>& environment = {});
  [[nodiscard]] DaemonProcess& daemon() { return daemon_; }
  [[nodiscard]] client::Api& api() { return *api_; }
  /// GET; throws unless it is answered with 2xx.
  [[nodiscard]] Json get(const std::string& target);
  [[nodiscard]] client::HttpResponse ask(const std::string& method, const std::string& target,
                                         const std::string& body = "",
                                         const std::string& type = "application/json");

  /// A drawing of `lines` lines that lie apart, each `length_mm` long.
  [[nodiscard]] static std::string lines_svg(int lines, double length_mm = 5);
  /// Uploads a drawing; its id.
  [[nodiscard]] std::string design(const std::string& svg);
  /// A job that is ready, for a device (none: the only one).
  [[nodiscard]] std::string ready_job(const std::string& design, const std::string& device = "",
                                      const Json& more = Json::object());
  [[nodiscard]] Json job(const std::string& id) { return get("/v1/jobs/" + id); }
  [[nodiscard]] Json ledger(const std::string& id) {
    return get("/v1/jobs/" + id + "/sheets/1/ledger");
  }
  /// Does it to the job as it now is; throws if that is refused.
  Json act(const std::string& id, const std::string& action, const Json& body = Json::object());
  /// The problem's status if it is refused, else 0.
  [[nodiscard]] bool refused(const std::string& id, const std::string& action,
                             const Json& body = Json::object());
  /// Arms and starts the current sheet.
  void cut(const std::string& id);
  /// The job once `holds` of it; throws if it never does.
  Json await(const std::string& id, const std::function<bool(const Json&)>& holds);
  Json await_state(const std::string& id, const std::string& state);
  void reset(const std::string& device);
  /// "idle", ...
  [[nodiscard]] std::string device_state(const std::string& device);

 private:
  DaemonProcess daemon_;
  std::unique_ptr<client::Api> api_;
};

/// What is wrong with a ledger of `lines` strokes of which these were cut; empty: nothing. Every
/// stroke is in one of the three lists; certain ones were cut, what was cut is not called not sent.
[[nodiscard]] std::string wrong_in(const nlohmann::json& ledger, int lines,
                                   const std::set<int>& cut);
/// Which of the lines of `lines_svg` the simulated cutter of this trace folder cut in its last
/// attempt; what came twice, or was no line, throws.
[[nodiscard]] std::set<int> lines_cut(const std::filesystem::path& trace_folder, int lines);

/// Which line of `lines_svg` begins at that place (`places_cut`); -1: none.
[[nodiscard]] int line_at(const std::string& place, int lines);

/// The same of what a cutter did.
[[nodiscard]] std::set<int> lines_of(const Trace& trace, int lines);

/// The open descriptors of a process, but for those that come and go by themselves.
[[nodiscard]] std::size_t open_files(pid_t process);

}  // namespace popcut::testing
