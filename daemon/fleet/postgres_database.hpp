// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// A connection to the PostgreSQL of a fleet, in its schema "popcut". Transactions are READ
/// COMMITTED.
///
/// A statement waits at most `answer_s` for its answer; then the connection is given up (Away, or
/// InDoubt if it was a COMMIT). Until there is a new one, which another thread looks for, every
/// statement fails at once: a server that is gone holds nobody up twice.
///
/// A BEGIN, and what is for `later`, goes with the next statement that needs an answer: each way to
/// the server and back costs more than most statements.
class PostgresDatabase final : public Database {
 public:
  struct Options {
    std::string url;         ///< "postgresql://..." or "key=value ..."; several hosts: the one that
                             ///< can be written to
    std::string password{};  ///< empty: that of the URL or of ~/.pgpass
    std::string name{"popcutd"};  ///< as PostgreSQL lists it: application_name
    double connect_s{3};          ///< for each host
    double answer_s{5};           ///< also of a lock that others hold
    double again_s{0.5};          ///< between attempts to connect
  };
  /// Begins to connect, and waits for it.
  ///
  /// @param must_be_there  false: without a server it begins as if the server had just gone away
  /// @throws StoreFault  Away: nobody answers; Other: the server refuses, or the URL is wrong
  explicit PostgresDatabase(Options options, bool must_be_there = true);
  ~PostgresDatabase() override;

  void hold(std::string_view name) override;
  int run_list(std::string_view sql, std::span<const Bound> values) override;
  void later_list(std::string_view sql, std::span<const Bound> values) override;
  [[nodiscard]] Rows rows_list(std::string_view sql, std::span<const Bound> values) override;
  void script(const std::string& sql) override;
  [[nodiscard]] bool in_transaction() const override;
  [[nodiscard]] bool is_shared() const override { return true; }

  /// Whether a statement would be sent now. Takes over a new connection if there is one.
  [[nodiscard]] bool is_there();
  /// Why it is not: the server's words, in one line.
  [[nodiscard]] std::string why_away() const;
  /// Whether it refused the last connection in a way that will not pass by itself: a wrong
  /// password, no such database, a URL that is none.
  [[nodiscard]] bool is_refused() const;
  /// Gives up the connection if the statement that is under way, or one that begins in the next
  /// second, has no answer a second later: somebody wants to stop a knife. From any thread.
  void hurry();
  /// Waits up to `wait_s` for notifications of `channel`, to which it listens from then on, and
  /// gives each one's text to `heard`. False: the server is away.
  bool listen(std::string_view channel, double wait_s,
              const std::function<void(const std::string& text)>& heard);

 private:
  [[nodiscard]] std::string_view begin_words() const override { return "BEGIN"; }
  struct Line;
  std::unique_ptr<Line> line_;
};

/// `sql` with "$1", "$2", ... for "?" and "?1"; what stands in quotes is left alone.
[[nodiscard]] std::string with_dollars(std::string_view sql);

/// `text` as PostgreSQL takes it: without NUL, and what is not UTF-8 replaced by U+FFFD.
[[nodiscard]] std::string clean_text(std::string_view text);

}  // namespace popcut::daemon
