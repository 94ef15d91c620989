// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/contract_caller.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/fault_page.hpp"

namespace popcut::testing {

/// Drives a popcutd until it has produced every answer that its OpenAPI description documents.
class ContractLife {
 public:
  ContractLife();

  ContractCaller& caller() { return *caller_; }
  int end();

  void make_design_and_plans();
  void use_an_asset();
  void finish_searches();
  void look_at(const nlohmann::json& spec);
  void knock();
  void use_devices_and_materials();
  void see_a_job_through();
  void pause_a_cut();
  void mend_a_sheet();
  void read_everything();
  void open_sessions();
  /// A tablet that was let in: what it sends to get its session.
  [[nodiscard]] nlohmann::json let_in();
  void fill_the_queue();
  void fill_the_disk();

 private:
  std::string configuration();
  daemon::WireResponse ask(const ContractCall& call) { return caller_->ask(call); }
  nlohmann::json job(const std::string& id) { return caller_->get("/v1/jobs/{id}", {{"id", id}}); }
  nlohmann::json job_in(const std::string& id, const std::string& state);
  std::string new_job(const nlohmann::json& request);
  int act(const std::string& id, const std::string& action,
          const nlohmann::json& body = nlohmann::json::object());
  int queue(const std::string& action, const std::string& id);
  ContractCall on_device(const std::string& device, const std::string& action);
  daemon::WireResponse ask_device(const std::string& device, const std::string& action);
  std::string test_cut(const std::string& device);
  std::string new_token(const std::string& role);
  nlohmann::json new_session();
  nlohmann::json plan_until(const nlohmann::json& body, const std::string& state);
  std::string begin_search(const std::string& asset);
  void wait_for_search(const std::string& id, const std::string& state);

  TempFolder files_;
  DaemonProcess daemon_;
  FaultPage page_;
  std::optional<ContractCaller> caller_;
  std::uint16_t port_{};
  std::string viewer_, admin_;
  std::string used_asset_, spare_asset_;
  std::string search_, failed_search_;
  std::string design_, spare_design_, plan_, failed_plan_;
  std::string done_, ready_;  ///< jobs
};

}  // namespace popcut::testing
