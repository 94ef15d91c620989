// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/machines/machine.hpp"
#include "daemon/model/json_object.hpp"
#include "daemon/model/model.hpp"

namespace popcut::daemon::http {

/// "2026-11-21T10:12:00.123Z".
[[nodiscard]] std::string rfc3339(TimeMs time);

// The values of the service as the API shows them. Absent values are null; units are in names.
[[nodiscard]] nlohmann::ordered_json to_json(const Asset& asset);
/// With the designs that refer to it.
[[nodiscard]] nlohmann::ordered_json listed_json(const Asset& asset);
/// As an item of a list.
[[nodiscard]] nlohmann::ordered_json listed_json(const SearchRecord& search);
[[nodiscard]] nlohmann::ordered_json to_json(const Design& design);
[[nodiscard]] nlohmann::ordered_json to_json(const SheetPlan& sheet);
[[nodiscard]] nlohmann::ordered_json to_json(const PlanRecord& plan);
[[nodiscard]] nlohmann::ordered_json to_json(const SearchRecord& search);
[[nodiscard]] nlohmann::ordered_json to_json(const SheetRecord& sheet);
[[nodiscard]] nlohmann::ordered_json to_json(const Ledger& ledger);
[[nodiscard]] nlohmann::ordered_json to_json(const DeviceRecord& device);
[[nodiscard]] nlohmann::ordered_json to_json(const MaterialRecord& material);
[[nodiscard]] nlohmann::ordered_json to_json(const TokenRecord& token);
[[nodiscard]] nlohmann::ordered_json to_json(const SessionRecord& session);
[[nodiscard]] nlohmann::ordered_json to_json(const NewToken& token);
[[nodiscard]] nlohmann::ordered_json to_json(const UsageRow& row);

// The same as text, for long lists.
[[nodiscard]] JsonObject json_of(const NextAction& action);
/// The body of its request.
[[nodiscard]] JsonObject body_of(const NextAction& action);
[[nodiscard]] std::vector<JsonObject> json_of(const std::vector<NextAction>& actions);
[[nodiscard]] std::string job_text(const Job& job);

/// `event.data`, which has "seq" and "kind" and more, with its "time". It is not parsed.
[[nodiscard]] std::string event_json(const Event& event);

/// Rows of usage as CSV, with a head line; keys are quoted, and none is a formula to a spreadsheet.
[[nodiscard]] std::string usage_csv(const std::vector<UsageRow>& rows, const std::string& by);

/// The text of a value; what is not UTF-8 in it becomes U+FFFD.
[[nodiscard]] std::string dump(const nlohmann::ordered_json& value);

}  // namespace popcut::daemon::http
