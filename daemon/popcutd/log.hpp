// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "daemon/config/config.hpp"
#include "daemon/model/model.hpp"

namespace spdlog {
class logger;
}

namespace popcut::daemon {

/// The daemon's log on standard error, a line a message: text, or JSON with time, level, message
/// and the job that the message names. Under the journal, text has neither time nor colour of its
/// own.
[[nodiscard]] std::shared_ptr<spdlog::logger> make_log(const LogConfig& config, bool journal);
/// "debug", "info", "warning", "error"
void set_level(spdlog::logger& log, const std::string& level);

/// `text` with control characters as \xNN, and lines as one.
[[nodiscard]] std::string without_control(std::string_view text);
/// The id after "job " in a message, or an empty text.
[[nodiscard]] std::string_view job_in(std::string_view message);
/// "job 01JDX7...: interrupted, device_gone, sheet 2 of 3" of a stored change of a job; an empty
/// text of any other event.
[[nodiscard]] std::string change_line(const Event& event);
/// `text` as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string json_string(std::string_view text);

}  // namespace popcut::daemon
