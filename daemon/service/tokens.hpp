// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/service/principal_titles.hpp"
#include "daemon/service/service.hpp"
#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// Tokens, and the sessions of pages. Only the digest of a secret is stored.
///
/// A session has a root: a token, or a user of the unix socket. A request of the session never has
/// a higher role than the root has at that moment, and the session ends with its root.
class Tokens : public Access {
 public:
  Tokens(ServiceStore& store, PrincipalTitles& titles, const ServiceOptions& options)
      : store_(store), titles_(titles), options_(options) {}

  std::optional<Principal> authenticate(std::string_view bearer) override;
  Answer<NewToken> create_token(const Principal& who, const std::string& name, Role role,
                                std::optional<int> lifetime_s) override;
  std::vector<TokenRecord> tokens() override;
  Answer<void> delete_token(const Principal& who, const std::string& id) override;
  std::vector<SessionRecord> sessions(const Principal& who) override;
  Answer<void> end_session(const Principal& who, const std::string& id) override;
  std::string title_of(const std::string& principal) override { return titles_.of(principal); }
  std::optional<SessionRecord> session_of(const std::string& credential) override;
  Answer<void> close_session(const Principal& who) override;
  void on_access_change(std::function<void()> listener) override {
    listeners_.push_back(std::move(listener));
  }
  Answer<std::string> create_one_shot(const Principal& who) override;
  Answer<NewToken> open_session(const std::string& one_shot) override;
  Answer<NewPairing> ask_pairing(const std::string& name, const std::string& place) override;
  Answer<AllowedPairing> allow_pairing(const Principal& who, const std::string& code,
                                       Role role) override;
  Answer<std::optional<NewToken>> collect_pairing(const std::string& secret) override;
  /// Forgets what has expired.
  void tidy();
  /// Ends the sessions of users who no longer have a role. Call this at the start and when the
  /// users have changed.
  void users_changed();
  /// Forgets who was authenticated, and calls the listeners. Call this when credentials have ended
  /// or have another role, here or at another node of a fleet.
  void forget_known();

 private:
  struct OneShot {
    Principal principal;
    std::int64_t until_ms{};  ///< monotonic
  };
  /// A tablet that waits to be allowed, or that is allowed and has not collected its session.
  struct Pairing {
    std::string id, code, secret_sha256, name, place;
    std::int64_t until_ms{};                ///< monotonic
    std::optional<Principal> allowed_by{};  ///< nothing while the tablet waits
    Role role{};
  };
  /// In a fleet: a principal that was authenticated lately, for the time when the database does not
  /// answer.
  struct Known {
    std::string secret_sha256;
    Principal principal;
    std::int64_t at_ms{};  ///< monotonic
  };
  [[nodiscard]] std::optional<Principal> known(std::string_view id, std::string_view secret) const;
  struct Session;
  [[nodiscard]] std::optional<Session> session(const std::string& id);
  [[nodiscard]] std::optional<Principal> principal_of(const Session& session);
  [[nodiscard]] std::optional<Principal> token_owner(const std::string& id, TimeMs now);
  [[nodiscard]] bool is_of_this_machine(const std::string& principal) const;
  [[nodiscard]] std::optional<Principal> authenticate_token(std::string_view id,
                                                            std::string_view secret);
  [[nodiscard]] std::optional<Principal> authenticate_session(const std::string& id,
                                                              std::string_view secret);
  [[nodiscard]] std::optional<Session> new_session(const Principal& who);
  /// Stores a new session, in a transaction. Nothing if its root has ended.
  ///
  /// @retval QueueFull  there are too many sessions, and this one comes from all of them, one from
  ///                    another, so none can be deleted
  [[nodiscard]] Answer<std::optional<NewToken>> begin_session(const Principal& who,
                                                              const std::string& name,
                                                              std::optional<Role> most);
  [[nodiscard]] std::optional<SessionRecord> record_of(const Session& session);
  /// Checks the name of a token or a tablet.
  [[nodiscard]] static Answer<void> check_name(const std::string& name);
  [[nodiscard]] std::string new_code() const;
  void forget_late_pairings();
  /// @return false  twenty tablets wait, no two of them from one address
  [[nodiscard]] bool make_room_for_pairing(const std::string& place);
  void make_room_for_one_shot(const std::string& principal);
  [[nodiscard]] Answer<void> make_room_for_session(const std::string& principal,
                                                   const std::string& via);
  void notify_access_change();
  ServiceStore& store_;
  PrincipalTitles& titles_;
  const ServiceOptions& options_;
  std::map<std::string, Known, std::less<>> known_;  ///< in a fleet, by id of the credential
  std::map<std::string, OneShot> one_shots_;         ///< by the digest of the code
  std::vector<Pairing> pairings_{};                  ///< not stored: a restart ends them
  std::vector<std::function<void()>> listeners_;
};

}  // namespace popcut::daemon
