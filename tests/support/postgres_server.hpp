// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace popcut::testing {

struct PostgresOptions {
  bool fsync{false};   ///< it writes as one does that a power cut must not harm; for failover
  bool tcp{false};     ///< also on 127.0.0.1, with passwords (scram)
  bool disk{false};    ///< not in memory (/dev/shm), even if there is much; to measure
  std::string more{};  ///< lines of postgresql.conf, which win over those of this class
  std::vector<std::string>
      environment{};              ///< of its processes, besides what they need: "NAME=VALUE"
  std::filesystem::path place{};  ///< where its folder is made; empty: where there is room
};

/// A PostgreSQL of its own in a temporary folder, reached by a unix socket there. Its superuser
/// `postgres` and every other role need no password on that socket. It ends with this object, and
/// with the test program however that ends. As root it runs as the user `nobody`. What fails throws
/// std::runtime_error with the server's log. Not for more than one thread.
class PostgresServer {
 public:
  /// Why there is none on this machine; empty: there is. A test then says WARN("skipped: ...").
  [[nodiscard]] static std::string why_not();

  /// A new, empty server that accepts connections.
  explicit PostgresServer(PostgresOptions options = {});
  enum class Commits { Asynchronous, Synchronous };
  /// A standby that follows `primary`. Synchronous: from now on a commit there waits until this one
  /// has it on its disk too, for ever if this one is not there.
  [[nodiscard]] static PostgresServer standby_of(PostgresServer& primary, Commits commits);
  /// A server that another program started and will end: it has databases and roles to offer, and
  /// cannot be stopped, frozen or configured. @param folder  its folder()
  [[nodiscard]] static PostgresServer of_another(const std::filesystem::path& folder);
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// By the unix socket.
  [[nodiscard]] std::string url(const std::string& database = "postgres",
                                const std::string& user = "postgres") const;
  /// By 127.0.0.1; only with `tcp`.
  [[nodiscard]] std::string tcp_url(const std::string& database, const std::string& user,
                                    const std::string& password) const;
  /// The folder of the unix socket, and the number in its name (also that of the TCP port).
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// FOLDER/.s.PGSQL.PORT
  [[nodiscard]] std::string socket() const;
  /// All that the server has said so far.
  [[nodiscard]] std::string log() const;

  /// Makes an empty database; its url.
  std::string create_database(const std::string& name);
  /// See the function of that name; as superuser.
  std::string run_sql(const std::string& sql, const std::string& database = "postgres") const;
  /// What pg_dump says of a database, for `restore`.
  [[nodiscard]] std::string dump(const std::string& database) const;
  /// Puts a database in the place of one that is there; cuts its clients off.
  void restore(const std::string& database, const std::string& dump);
  /// Adds a line to postgresql.conf, which wins over those before, and waits until the server has
  /// read it.
  void configure(const std::string& line);

  /// Starts it again and waits until it accepts connections, after it has recovered if it must.
  void start();
  enum class Stop { Smart, Fast, Immediate };
  /// Stops it, and waits for that, at most a minute. Smart waits for all clients to go.
  void stop(Stop how = Stop::Fast);
  /// SIGKILL to all its processes at once.
  void kill();
  /// SIGSTOP to all its processes: its clients wait and are told nothing.
  void freeze();
  void thaw();  ///< SIGCONT
  /// A standby gets nothing more from its primary from now on.
  void stop_following();
  /// Makes a standby a primary, and waits for that.
  void promote();
  [[nodiscard]] bool running() const { return warden_ > 0; }
  /// The process that listens; its children serve the clients.
  [[nodiscard]] pid_t pid() const { return postmaster_; }

 private:
  PostgresServer(PostgresServer& primary, Commits commits);
  explicit PostgresServer(const std::filesystem::path& folder);
  void write_configuration() const;
  void launch();
  [[nodiscard]] bool ready() const;
  void dismiss(char how);
  void join();
  [[nodiscard]] std::filesystem::path data() const { return folder_ / "data"; }

  /// A folder that is removed with this object, also when a constructor throws.
  struct Removed {
    std::filesystem::path path;
    bool kept;  ///< it is not ours
    explicit Removed(std::filesystem::path which, bool is_kept = false)
        : path(std::move(which)), kept(is_kept) {}
    ~Removed();
    Removed(const Removed&) = delete;
    Removed& operator=(const Removed&) = delete;
  };

  PostgresOptions options_;
  Removed kept_in_;
  const std::filesystem::path& folder_{kept_in_.path};
  std::uint16_t port_{5432};
  std::vector<std::string> lines_;  // added to the configuration
  pid_t warden_{-1};                // the child that starts and ends the server
  pid_t postmaster_{-1};
  int to_warden_{-1};
  bool frozen_{false};
};

/// A server that all cases share: the one that CTest started for all programs (the file that
/// POPCUT_TEST_POSTGRES names holds its folder), or in a program that is run alone one of its own,
/// which starts at the first call. Databases of cases are their own, roles are common to all.
[[nodiscard]] PostgresServer& shared_postgres();

/// Makes a role that may log in and is a member of popcut_node, if there is none. Programs that
/// share a server may do so at the same time.
void add_node_role(const PostgresServer& server, const std::string& login,
                   const std::string& password = "");

/// A database that is there as long as this object.
class FreshDatabase {
 public:
  explicit FreshDatabase(PostgresServer& server = shared_postgres());
  ~FreshDatabase();  ///< cuts its clients off
  FreshDatabase(const FreshDatabase&) = delete;
  FreshDatabase& operator=(const FreshDatabase&) = delete;
  [[nodiscard]] std::string url(const std::string& user = "postgres") const {
    return server_.url(name_, user);
  }
  [[nodiscard]] const std::string& name() const { return name_; }
  std::string run_sql(const std::string& sql) const { return server_.run_sql(sql, name_); }

 private:
  PostgresServer& server_;
  std::string name_;
};

/// @param host  an address, or the folder of a unix socket
[[nodiscard]] std::string postgres_url(const std::string& host, std::uint16_t port,
                                       const std::string& database, const std::string& user,
                                       const std::string& password = "");

/// Runs statements in a connection of their own; several are one transaction unless they say BEGIN
/// and COMMIT. The rows of the last one as `psql -At` prints them: "1|a\n2|b", NULL is empty.
/// Throws what libpqxx throws.
std::string run_sql(const std::string& url, const std::string& sql);

}  // namespace popcut::testing
