// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/contract_caller.hpp"

namespace popcut::testing {

/// Makes requests from the OpenAPI description that a popcutd serves: each route, each role, ids
/// that are there and ids that are not, bodies that the schemas allow and bodies that they do not,
/// headers that are right, missing, stale or nonsense. Each answer is held against the description.
class ApiGenerator {
 public:
  /// `socket` and `port` of a popcutd whose unix socket lets this process do anything.
  ApiGenerator(std::string socket, std::uint16_t port, std::uint64_t seed);

  /// Sends `count` requests. What was wrong is in `faults` then.
  void run(int count);

  [[nodiscard]] const std::map<std::string, int>& faults() const { return faults_; }
  /// How often each status came.
  [[nodiscard]] const std::map<int, int>& statuses() const { return statuses_; }
  /// "POST /v1/jobs 201", ...
  [[nodiscard]] const std::set<std::string>& produced() const { return produced_; }
  /// Routes and roles that were asked: "GET /v1/jobs viewer".
  [[nodiscard]] const std::set<std::string>& asked() const { return asked_; }

 private:
  struct Made {
    ContractCall call;  ///< method and route of the description
    std::string role;   ///< "", "viewer", ..., "socket"
    std::string bytes;
    bool is_head{false};
    bool is_valid_body{true};
    std::string body{};
  };

  int whole(int low, int high);
  bool chance(double probability);
  template <typename List>
  const typename List::value_type& one_of(const List& list) {
    return list[static_cast<std::size_t>(whole(0, static_cast<int>(list.size()) - 1))];
  }

  void set_up();
  void refresh();
  std::string bearer(const std::string& role);
  [[nodiscard]] std::string pooled(const std::string& name, const std::string& route);
  [[nodiscard]] std::string odd_text();
  [[nodiscard]] nlohmann::json odd_value();
  [[nodiscard]] nlohmann::json value_of(const nlohmann::json& schema, const std::string& name,
                                        const std::string& route, int depth);
  void mutate(nlohmann::json& value, int depth);
  [[nodiscard]] std::string body_of(Made& made, std::string& type);
  [[nodiscard]] std::string query_of(const nlohmann::json& operation, const std::string& route);
  [[nodiscard]] std::string headers_of(const Made& made, const nlohmann::json& operation,
                                       const std::string& job);
  [[nodiscard]] Made make();
  void judge(const Made& made, const daemon::WireResponse& response);
  void learn(const Made& made, const daemon::WireResponse& response);
  daemon::WireResponse send(const Made& made);

  std::string socket_;
  std::uint16_t port_;
  std::mt19937_64 random_;
  ContractCaller caller_;
  std::vector<ContractCall> operations_;
  std::map<std::string, std::string> bearers_;                ///< by role
  std::map<std::string, std::vector<std::string>> pools_;     ///< ids by what they are of
  std::map<std::string, std::int64_t> revs_;                  ///< of jobs, devices, materials
  std::vector<std::pair<std::string, std::string>> actions_;  ///< a job, and what it allows
  std::vector<std::string> keys_;                             ///< that were sent
  int number_{0};
  std::map<std::string, int> faults_;
  std::map<int, int> statuses_;
  std::set<std::string> produced_, asked_;
};

}  // namespace popcut::testing
