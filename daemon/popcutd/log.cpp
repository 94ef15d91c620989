// SPDX-License-Identifier: MIT
#include "daemon/popcutd/log.hpp"
#include "core/text/utf8.hpp"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

namespace popcut::daemon {
namespace {

std::string_view payload(const spdlog::details::log_msg& message) {
  return {message.payload.data(), message.payload.size()};
}

void append(spdlog::memory_buf_t& out, std::string_view text) {
  out.append(text.data(), text.data() + text.size());
}

/// %*: the message without control characters.
class CleanText : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    append(out, without_control(payload(message)));
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<CleanText>();
  }
};

/// %*: the rest of a JSON line.
class JsonText : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    const std::string_view text = payload(message), job = job_in(text);
    if (!job.empty()) append(out, fmt::format("\"job\":\"{}\",", job));
    append(out, "\"message\":" + json_string(text));
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JsonText>();
  }
};

}  // namespace

std::string without_control(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    const auto byte = static_cast<unsigned char>(c);
    const unsigned next = at + 1 < text.size() ? static_cast<unsigned char>(text[at + 1]) : 0;
    if (is_bidi_control(text.substr(at))) {
      const auto last = static_cast<unsigned char>(text[at + 2]);
      out += fmt::format("\\u{:04x}", 0x2000U | (next & 0x3fU) << 6U | (last & 0x3fU));
      at += 2;
    } else if (byte == 0xc2 && next >= 0x80 &&
               next < 0xa0)  // U+0080 to U+009F: escapes of terminals
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(text[++at]));
    else if (c == '\n')
      out += " | ";
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\x{:02x}", byte);
    else
      out.push_back(c);
  }
  return out;
}

std::string_view job_in(std::string_view message) {
  constexpr std::string_view kBefore = "job ", kLetters = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
  constexpr std::size_t kLength = 26;
  for (std::size_t at = message.find(kBefore); at != std::string_view::npos;
       at = message.find(kBefore, at + 1)) {
    const std::string_view rest = message.substr(at + kBefore.size());
    const std::size_t end = rest.find_first_not_of(kLetters);
    if (std::min(end, rest.size()) == kLength) return rest.substr(0, kLength);
  }
  return {};
}

std::string change_line(const Event& event) {
  if (event.seq == 0 || event.kind != "job" || event.job.empty()) return {};
  const auto data = nlohmann::json::parse(event.data, nullptr, false);
  if (!data.is_object()) return {};
  std::string line = fmt::format("job {}: {}", event.job, data.value("state", "changed"));
  if (data.contains("deleted")) line += ", deleted";
  if (const std::string reason = data.value("reason", ""); !reason.empty()) line += ", " + reason;
  if (const int sheet = data.value("sheet", 0); sheet > 0)
    line += fmt::format(", sheet {} of {}", sheet, data.value("sheets_total", sheet));
  return line;
}

std::string json_string(std::string_view text) {
  return nlohmann::json(std::string(text))
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void set_level(spdlog::logger& log, const std::string& level) {
  log.set_level(level == "debug"     ? spdlog::level::debug
                : level == "warning" ? spdlog::level::warn
                : level == "error"   ? spdlog::level::err
                                     : spdlog::level::info);
}

std::shared_ptr<spdlog::logger> make_log(const LogConfig& config, bool journal) {
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  auto log = std::make_shared<spdlog::logger>("popcutd", sink);
  auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  if (config.form == LogForm::Json)
    formatter->add_flag<JsonText>('*').set_pattern(
        R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%*})");
  else
    formatter->add_flag<CleanText>('*').set_pattern(journal ? "%l: %*"
                                                            : "%Y-%m-%dT%H:%M:%S.%eZ %^%l%$: %*");
  log->set_formatter(std::move(formatter));
  log->flush_on(spdlog::level::info);
  set_level(*log, config.level);
  return log;
}

}  // namespace popcut::daemon
