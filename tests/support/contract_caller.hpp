// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/raw_http.hpp"

namespace popcut::testing {

/// A request as documented in the OpenAPI description.
struct ContractCall {
  std::string method, route;  ///< "POST", "/v1/jobs/{id}/actions/arm"
  std::map<std::string, std::string> holes{};
  std::string query{};                ///< "?limit=3"
  std::string match{"\"1\""};         ///< If-Match, where the route takes one
  std::string more{};                 ///< header lines
  std::optional<std::string> body{};  ///< none: the example of the description
  bool keyed{true}, matched{true};    ///< false: without the header that is needed
};

/// Sends requests to a popcutd and checks every answer against the description that it serves:
/// status, media type, schema, documented headers. Remembers which answers were produced.
class ContractCaller {
 public:
  using Pair = std::pair<std::string, int>;  ///< "POST /v1/jobs" and a status

  /// Reads the description over the unix socket.
  explicit ContractCaller(std::string socket);

  /// Over the unix socket, as its user; or over TCP with `token` (none if it is empty) to `port`.
  daemon::WireResponse ask(const ContractCall& call);
  daemon::WireResponse ask_tcp(const ContractCall& call, std::uint16_t port,
                               const std::string& token, const std::string& host = "");
  /// The bytes of the request, and the judgement on an answer to it, for who sends many at once.
  [[nodiscard]] std::string request(const ContractCall& call, const std::string& host,
                                    const std::string& more) const;
  void hold(const ContractCall& call, const daemon::WireResponse& response);
  /// What of an answer is not as described; empty: nothing.
  [[nodiscard]] std::vector<std::string> faults_of(const ContractCall& call,
                                                   const daemon::WireResponse& response,
                                                   bool is_head) const;

  /// Takes note of the problem of an answer that no operation documents.
  void note(const daemon::WireResponse& response);

  /// GET that succeeds.
  nlohmann::json get(const std::string& route,
                     const std::map<std::string, std::string>& holes = {});

  [[nodiscard]] const nlohmann::json& document() const { return document_; }
  [[nodiscard]] const nlohmann::json& operation(const ContractCall& call) const;
  /// Every documented pair.
  [[nodiscard]] std::set<Pair> documented() const;
  [[nodiscard]] const std::set<Pair>& produced() const { return produced_; }
  [[nodiscard]] const std::set<std::string>& problems() const { return problems_; }
  /// What another caller has produced too.
  void add(const ContractCaller& other);

 private:
  daemon::WireResponse send(daemon::RawConnection connection, const std::string& bytes) const;
  [[nodiscard]] std::string body_of(const ContractCall& call, std::string& type) const;
  std::string socket_;
  nlohmann::json document_;
  std::set<Pair> produced_;
  std::set<std::string> problems_;
};

/// A revision in the form of If-Match.
[[nodiscard]] inline std::string quoted(const nlohmann::json& rev) {
  return "\"" + std::to_string(rev.get<std::int64_t>()) + "\"";
}

/// Every documented operation as a call with its example body, on an id that does not exist.
[[nodiscard]] std::vector<ContractCall> all_calls(const ContractCaller& caller);
[[nodiscard]] bool documents(const ContractCaller& caller, const ContractCall& call, int status);

}  // namespace popcut::testing
