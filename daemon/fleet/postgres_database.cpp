// SPDX-License-Identifier: MIT
#include "daemon/fleet/postgres_database.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>
#include <libpq-fe.h>
#include <poll.h>
#include <sys/socket.h>

#include <pqxx/pqxx>

#include "core/text/words.hpp"
#include "daemon/fleet/fleet_url.hpp"
#include "daemon/fleet/late_libpq.hpp"

namespace popcut::daemon {
namespace {

using Clock = std::chrono::steady_clock;

std::chrono::nanoseconds seconds(double value) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(value));
}

// Classes and codes of the appendix "PostgreSQL Error Codes".
FaultKind kind_of(std::string_view state) {
  const std::string_view of_class = state.substr(0, std::min<std::size_t>(2, state.size()));
  if (of_class == "23") return FaultKind::Constraint;
  if (state == "40001" || state == "40P01" || state == "55P03") return FaultKind::Again;
  // A table has other columns than when a statement was prepared. A new connection prepares again.
  if (state == "0A000") return FaultKind::Away;
  if (state == "53100") return FaultKind::Full;
  // It is ending, full of others, or a standby that takes no writes.
  if (of_class == "08" || of_class == "57" || of_class == "53" || state == "25006" ||
      state == "25P03")
    return FaultKind::Away;
  // Raised by the functions of daemon/fleet/schema.sql.
  if (of_class == "PC") return FaultKind::Refused;
  if (of_class == "58") return FaultKind::Io;
  if (of_class == "XX") return FaultKind::Corrupt;
  return FaultKind::Other;
}

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n' || c == '\t') c = ' ';
  for (std::size_t at; (at = text.find("  ")) != std::string::npos;) text.erase(at, 1);
  return text;
}

// What a function raised: the first line of "ERROR:  sentence\nCONTEXT:  ...".
std::string sentence_of(std::string text) {
  constexpr std::string_view kError = "ERROR:";
  text.resize(std::min(text.find('\n'), text.size()));
  if (text.starts_with(kError)) text.erase(0, kError.size());
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
  return text;
}

/// Shuts a socket on which somebody waits for too long, so that the wait ends.
class Watchdog {
 public:
  Watchdog() : thread_([this] { run(); }) {}
  ~Watchdog() {
    {
      const std::lock_guard hold(lock_);
      is_over_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  void begin(int socket, double most_s) {
    {
      const std::lock_guard hold(lock_);
      socket_ = socket;
      const Clock::time_point now = Clock::now();
      until_ = now + seconds(now < hurried_until_ ? std::min(most_s, kHurriedSeconds) : most_s);
      bit_ = false;
    }
    changed_.notify_one();
  }
  /// What is waited for now, or soon, gets little time.
  void hurry() {
    {
      const std::lock_guard hold(lock_);
      hurried_until_ = Clock::now() + seconds(kHurriedSeconds);
      until_ = std::min(until_, hurried_until_);
    }
    changed_.notify_one();
  }
  /// True: it was shut.
  bool end() {
    const std::lock_guard hold(lock_);
    socket_ = -1;
    return bit_;
  }

 private:
  void run() {
    std::unique_lock hold(lock_);
    while (!is_over_) {
      if (socket_ < 0) {
        changed_.wait(hold);
      } else if (Clock::now() >= until_) {
        ::shutdown(socket_, SHUT_RDWR);
        socket_ = -1;
        bit_ = true;
      } else {
        changed_.wait_until(hold, until_);
      }
    }
  }
  std::mutex lock_;
  std::condition_variable changed_;
  static constexpr double kHurriedSeconds = 1;
  Clock::time_point until_{}, hurried_until_{};
  int socket_{-1};
  bool bit_{false}, is_over_{false};
  std::thread thread_;
};

/// Hears whether the server warns. A commit gives no other warning than that its wait for a standby
/// was given up: it is done here, and lost if that standby takes over now. The warning is in the
/// server's language, and has no code of its own.
class StandbyListener final : public pqxx::errorhandler {
 public:
  explicit StandbyListener(pqxx::connection& connection) : pqxx::errorhandler(connection) {}
  bool operator()(const char*) noexcept override {
    has_warned = true;
    return false;  // no other node is notified
  }
  bool has_warned{false};
};

/// The rows of an answer, all of which is here.
class PostgresRows final : public RowSource {
 public:
  explicit PostgresRows(const pqxx::result& answer) : answer_(answer) {}
  bool next() override { return ++at_ < static_cast<int>(answer_.size()); }
  [[nodiscard]] bool null(int column) const override { return field(column).is_null(); }
  [[nodiscard]] std::int64_t integer(int column) const override {
    const std::string_view given = text(column);
    if (given == "t") return 1;
    std::int64_t value = 0;
    std::from_chars(given.data(), given.data() + given.size(), value);
    return value;
  }
  [[nodiscard]] double real(int column) const override {
    const std::string_view given = text(column);
    double value = 0;
    std::from_chars(given.data(), given.data() + given.size(), value);
    return value;
  }
  [[nodiscard]] std::string_view text(int column) const override {
    const pqxx::field one = field(column);
    return one.is_null() ? std::string_view() : std::string_view(one.c_str(), one.size());
  }
  [[nodiscard]] Bound value(int column) const override {
    return null(column) ? Bound(nullptr) : Bound(text(column));
  }

 private:
  [[nodiscard]] pqxx::field field(int column) const {
    return answer_[static_cast<pqxx::result::size_type>(at_)]
                  [static_cast<pqxx::row::size_type>(column)];
  }
  pqxx::result answer_;
  int at_{-1};
};

// A value as text; nothing: NULL.
std::optional<std::string> text_of(const Bound& value) {
  switch (value.kind()) {
    case Bound::Kind::Null:
      break;
    case Bound::Kind::Integer:
      return std::to_string(value.integer());
    case Bound::Kind::Real:
      return fmt::format("{}", value.real());
    case Bound::Kind::Text:
      return clean_text(value.text());
  }
  return std::nullopt;
}

bool ends_transaction(std::string_view sql) { return sql == "COMMIT" || sql == "ROLLBACK"; }
constexpr std::string_view kBegin = "BEGIN; ";
bool is_control(std::string_view sql) {
  return ends_transaction(sql) || sql.starts_with("BEGIN") || sql.starts_with("SAVEPOINT") ||
         sql.starts_with("RELEASE") || sql.starts_with("ROLLBACK") || sql.starts_with("SET ");
}

// As it stands among the words of "key='value'".
std::string in_quotes(std::string_view text) {
  std::string all = "'";
  for (const char c : text) {
    if (c == '\\' || c == '\'') all += '\\';
    all += c;
  }
  return all + "'";
}

// What must hold for every connection. It notices a network that is cut and a server that hangs. It
// waits for a lock only briefly: the service's thread has cuts to look after. A client that hangs
// in a transaction soon loses its locks.
std::string connection_words(const PostgresDatabase::Options& options, const std::string& url) {
  const int wait_s = std::max(1, static_cast<int>(options.connect_s));
  const int answer_ms = static_cast<int>(options.answer_s * 1000);
  const bool is_url = url.starts_with("postgres");
  std::vector<std::pair<std::string, std::string>> own{
      {"connect_timeout", std::to_string(wait_s)},
      {"application_name", options.name},
      {"target_session_attrs", "read-write"},
      {"client_encoding", "UTF8"},
      {"keepalives_idle", "5"},
      {"keepalives_interval", "2"},
      {"keepalives_count", "3"},
      {"tcp_user_timeout", std::to_string(answer_ms)},
      {"options", fmt::format("-c search_path=popcut -c client_min_messages=warning "
                              "-c statement_timeout={} -c lock_timeout={} "
                              "-c idle_in_transaction_session_timeout={} "
                              "-c default_transaction_isolation=read\\ committed",
                              answer_ms, answer_ms / 5, answer_ms / 2)},
  };
  if (!options.password.empty()) own.emplace_back("password", options.password);
  std::string text = url;
  // What the URL says itself goes before.
  for (const auto& [key, value] : own) {
    if (url.find(key + "=") != std::string::npos) continue;
    if (is_url)
      text += fmt::format("{}{}={}", text.find('?') == std::string::npos ? '?' : '&', key,
                          percent_encoded(value));
    else
      text += fmt::format(" {}={}", key, in_quotes(value));
  }
  return text;
}

// Of each host that the URL lists. libpq gives up at the first one that accepts a connection and
// ends it, as a proxy before a dead server does, or that refuses the login.
std::vector<std::string> words_of_hosts(const PostgresDatabase::Options& options) {
  const std::vector<FleetUrl> each = FleetUrl::parse(options.url).each_host();
  if (each.size() == 1) return {connection_words(options, options.url)};
  std::vector<std::string> all;
  all.reserve(each.size());
  for (const FleetUrl& one : each) all.push_back(connection_words(options, one.text()));
  return all;
}

// The code of the server's refusal, which has no language: "28P01"; empty: it does not refuse, or
// nobody is there. libpq tells it only to whoever asks before it has connected.
std::string code_of_refusal(const std::string& words, double patience_s) {
  const std::unique_ptr<PGconn, decltype(&PQfinish)> line(PQconnectStart(words.c_str()), PQfinish);
  if (!line || PQstatus(line.get()) == CONNECTION_BAD) return {};
  PQsetErrorVerbosity(line.get(), PQERRORS_SQLSTATE);
  const Clock::time_point until = Clock::now() + seconds(patience_s);
  PostgresPollingStatusType next = PGRES_POLLING_WRITING;
  while (next == PGRES_POLLING_READING || next == PGRES_POLLING_WRITING) {
    pollfd wait{PQsocket(line.get()),
                static_cast<short>(next == PGRES_POLLING_READING ? POLLIN : POLLOUT), 0};
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    if (left <= 0 || ::poll(&wait, 1, static_cast<int>(left)) <= 0) return {};
    next = PQconnectPoll(line.get());
  }
  // "...: FATAL:  28P01"
  std::string_view said = PQerrorMessage(line.get());
  while (!said.empty() && said.back() == '\n') said.remove_suffix(1);
  const std::size_t space = said.rfind(' ');
  return next == PGRES_POLLING_FAILED && space != said.npos && said.size() == space + 6
             ? std::string(said.substr(space + 1))
             : std::string();
}

// Wrong words will not be right the next time; a server that is not there may be. What libpq says
// itself is English in popcutd, which sets no locale.
bool will_not_pass(const std::string& words, const std::string& fault, double patience_s) {
  constexpr std::array<std::string_view, 3> kOfLibpq{"no password supplied", "invalid", "missing"};
  if (std::any_of(kOfLibpq.begin(), kOfLibpq.end(),
                  [&](std::string_view said) { return fault.find(said) != std::string::npos; }))
    return true;
  // Nobody but a server has a severity and two spaces in front of what it says.
  if (fault.find(":  ") == std::string::npos) return false;
  const std::string code = code_of_refusal(words, patience_s);
  // Class 28: login or pg_hba.conf. No such database. Not allowed to connect.
  return code.starts_with("28") || code == "3D000" || code == "42501";
}

}  // namespace

std::string with_dollars(std::string_view sql) {
  std::string text;
  text.reserve(sql.size() + 16);
  int count = 0;
  char quote = 0;
  for (std::size_t at = 0; at < sql.size(); ++at) {
    const char c = sql[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '?') {
      text += '$';
      const bool is_numbered = at + 1 < sql.size() && sql[at + 1] >= '0' && sql[at + 1] <= '9';
      if (!is_numbered) text += std::to_string(++count);
      continue;
    }
    text += c;
  }
  return text;
}

std::string clean_text(std::string_view text) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
  std::string clean;
  clean.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<unsigned char>(text[at]);
    const std::size_t size = first < 0x80                    ? 1
                             : first >= 0xC2 && first < 0xE0 ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
    bool sound = size > 0 && first != 0 && at + size <= text.size();
    for (std::size_t k = 1; sound && k < size; ++k)
      sound = (static_cast<unsigned char>(text[at + k]) & 0xC0) == 0x80;
    if (sound && size > 2) {
      // Not longer than it must be, no surrogate, not beyond U+10FFFF.
      const auto second = static_cast<unsigned char>(text[at + 1]);
      sound = !(first == 0xE0 && second < 0xA0) && !(first == 0xED && second >= 0xA0) &&
              !(first == 0xF0 && second < 0x90) && !(first == 0xF4 && second >= 0x90);
    }
    clean += sound ? text.substr(at, size) : kReplacement;
    at += sound ? size : 1;
  }
  return clean;
}

struct PostgresDatabase::Line {
  explicit Line(Options given) : options(std::move(given)), hosts(words_of_hosts(options)) {}
  ~Line() {
    forget_listens();
    if (seeker.joinable()) seeker.join();
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  /// What another thread brings.
  struct Found {
    std::mutex lock;
    bool is_over{false};
    std::unique_ptr<pqxx::connection> connection;
    std::string fault;
    bool refused{false};
  };

  void seek() {
    if (seeker.joinable()) seeker.join();
    found = std::make_shared<Found>();
    seeker = std::thread([hosts = hosts, found = found, patience_s = options.connect_s] {
      std::unique_ptr<pqxx::connection> made;
      std::string faults;
      bool by_all = true;
      for (const std::string& words : hosts) {
        if (std::string fault = libpq_fault(); !fault.empty()) {
          faults = std::move(fault);
          break;
        }
        try {
          made = std::make_unique<pqxx::connection>(words);
          break;
        } catch (const std::exception& fault) {
          by_all = by_all && will_not_pass(words, fault.what(), patience_s);
          faults += (faults.empty() ? "" : "; ") + one_line(fault.what());
        }
      }
      const std::lock_guard hold(found->lock);
      found->connection = std::move(made);
      found->fault = std::move(faults);
      found->refused = !found->connection && by_all;
      found->is_over = true;
    });
  }

  /// Takes what the other thread found; begins to look again if it found nothing.
  bool take() {
    if (connection) return true;
    if (!found) {
      if (Clock::now() < again) return false;
      seek();
      return false;
    }
    {
      const std::lock_guard hold(found->lock);
      if (!found->is_over) return false;
      connection = std::move(found->connection);
      if (connection) standby = std::make_unique<StandbyListener>(*connection);
      if (!connection) why = found->fault;
      refused = found->refused;
    }
    if (seeker.joinable()) seeker.join();
    found.reset();
    again = Clock::now() + seconds(options.again_s);
    return connection != nullptr;
  }

  /// Runs a statement, or several that are not prepared, and keeps the books on the transaction.
  pqxx::result ask(std::string_view sql, std::span<const Bound> values, bool is_script = false);
  pqxx::result send(std::string_view sql, std::span<const Bound> values);
  /// Keeps a statement until the next one is sent.
  void keep(std::string_view sql, std::span<const Bound> values);
  /// The name under which the server knows the statement.
  const std::string& prepare(std::string_view sql);
  /// As text for a statement that the server knows.
  std::string execution(std::string_view sql, std::span<const Bound> values);
  /// Runs `work`, which talks to the server, and says what its faults mean. `commits`: what it did
  /// is stored when it returns.
  template <typename Work>
  pqxx::result watched(std::string_view sql, bool commits, const Work& work);
  /// Throws if the statement cannot be sent now.
  void look(std::string_view sql);
  void roll_back();
  [[nodiscard]] StoreFault failed(FaultKind kind, const std::string& what, std::string_view sql);
  // Each says UNLISTEN, and waits for the answer.
  void forget_listens() {
    constexpr double kMostSeconds = 1;
    if (listens.empty()) return;
    if (connection && connection->is_open()) watchdog.begin(connection->sock(), kMostSeconds);
    listens.clear();
    watchdog.end();
  }
  void lose(const std::string& because) {
    why = because;
    forget_listens();
    standby.reset();
    connection.reset();
    prepared.clear();
    kept.clear();
    again = Clock::now();
    dead = open;
  }

  Options options;
  std::vector<std::string> hosts;  ///< how to reach each
  std::unique_ptr<pqxx::connection> connection;
  std::unique_ptr<StandbyListener> standby;
  std::unordered_map<std::string, std::string> prepared;  ///< names by text
  int next_name{0};
  std::string kept;  ///< statements that go with the next one, each with its semicolon
  std::unordered_map<std::string, std::unique_ptr<pqxx::notification_receiver>> listens;
  std::shared_ptr<Found> found;
  std::thread seeker;
  Watchdog watchdog;
  Clock::time_point again{};
  std::string why{"it was not asked yet"};
  bool refused{false};
  bool open{false};     ///< a transaction is
  bool dead{false};     ///< its connection went away: it can only be rolled back
  bool aborted{false};  ///< a statement of it failed
};

const std::string& PostgresDatabase::Line::prepare(std::string_view sql) {
  const std::string text(sql);
  auto known = prepared.find(text);
  if (known == prepared.end()) {
    // A number is not used again: libpqxx keeps the name of one that could not be prepared.
    std::string name = fmt::format("s{}", next_name++);
    connection->prepare(name, with_dollars(sql));
    connection->prepare_now(name);
    known = prepared.emplace(text, std::move(name)).first;
  }
  return known->second;
}

std::string PostgresDatabase::Line::execution(std::string_view sql, std::span<const Bound> values) {
  std::string text = "EXECUTE " + connection->quote_name(prepare(sql));
  const char* before = "(";
  for (const Bound& value : values) {
    const std::optional<std::string> one = text_of(value);
    text += before;
    text += one ? connection->quote(*one) : "NULL";
    before = ", ";
  }
  return values.empty() ? text : text + ")";
}

pqxx::result PostgresDatabase::Line::send(std::string_view sql, std::span<const Bound> values) {
  pqxx::nontransaction work(*connection);
  if (!kept.empty()) {
    const std::string all = kept + execution(sql, values);
    kept.clear();
    return work.exec(all);
  }
  const std::string& name = prepare(sql);
  std::vector<std::optional<std::string>> texts;
  texts.reserve(values.size());
  for (const Bound& value : values) texts.push_back(text_of(value));
  std::vector<const char*> given;
  given.reserve(values.size());
  for (const auto& one : texts) given.push_back(one ? one->c_str() : nullptr);
  return work.exec_prepared(name, pqxx::prepare::make_dynamic_params(given));
}

StoreFault PostgresDatabase::Line::failed(FaultKind kind, const std::string& what,
                                          std::string_view sql) {
  const bool commits = sql == "COMMIT";
  const std::string said = one_line(what);
  if (kind != FaultKind::Away && connection->is_open()) {
    aborted = open;
    if (commits) roll_back();
    if (kind == FaultKind::Refused) return {kind, sentence_of(what)};
    return {kind, fmt::format("{} ({})", said, sql.substr(0, 200))};
  }
  lose(said);
  if (!commits) return {FaultKind::Away, said};
  open = dead = aborted = false;
  return {FaultKind::InDoubt, said};
}

// What failed may be a statement that went with the COMMIT: then nothing was rolled back yet.
void PostgresDatabase::Line::roll_back() {
  open = aborted = false;
  watchdog.begin(connection->sock(), options.answer_s + 1);
  try {
    pqxx::nontransaction(*connection).exec("ROLLBACK");
    watchdog.end();
  } catch (const std::exception& fault) {
    watchdog.end();
    lose(one_line(fault.what()));
  }
}

template <typename Work>
pqxx::result PostgresDatabase::Line::watched(std::string_view sql, bool commits, const Work& work) {
  if (standby) standby->has_warned = false;
  watchdog.begin(connection->sock(), options.answer_s + 1);
  try {
    pqxx::result rows = work();
    watchdog.end();
    if (commits && standby && standby->has_warned) {
      open = aborted = false;
      throw StoreFault(FaultKind::InDoubt, "no standby confirmed the commit");
    }
    return rows;
  } catch (const pqxx::broken_connection& fault) {
    // What libpqxx says of a connection that broke during a statement is of no use to anybody.
    const std::string_view said = fault.what();
    const bool says_nothing = said.find("client encoding") != std::string_view::npos;
    throw failed(FaultKind::Away,
                 watchdog.end() ? fmt::format("no answer for {:g} s", options.answer_s + 1)
                 : says_nothing ? std::string("the connection was lost")
                                : std::string(said),
                 sql);
  } catch (const pqxx::sql_error& fault) {
    watchdog.end();
    throw failed(kind_of(fault.sqlstate()), fault.what(), sql);
  } catch (const pqxx::transaction_rollback& fault) {
    watchdog.end();
    throw failed(FaultKind::Again, fault.what(), sql);
  } catch (const std::bad_alloc&) {
    watchdog.end();
    lose("out of memory");
    throw;
  } catch (const StoreFault&) {
    throw;
  } catch (const std::exception& fault) {
    const bool is_late = watchdog.end();
    throw failed(is_late || !connection->is_open() ? FaultKind::Away : FaultKind::Other,
                 fault.what(), sql);
  }
}

void PostgresDatabase::Line::look(std::string_view sql) {
  if (dead || !take()) throw StoreFault(FaultKind::Away, why);
  // Of a statement after it PostgreSQL would say less, and answer a COMMIT with a ROLLBACK that
  // looks like success.
  if (aborted && !sql.starts_with("ROLLBACK"))
    throw StoreFault(FaultKind::Other, "a statement of this transaction failed");
}

pqxx::result PostgresDatabase::Line::ask(std::string_view sql, std::span<const Bound> values,
                                         bool is_script) {
  if (dead && sql == "ROLLBACK") {
    open = dead = aborted = false;
    return {};
  }
  look(sql);
  if (sql == "BEGIN") {
    kept = kBegin;
    open = true;
    return {};
  }
  if (kept == kBegin && ends_transaction(sql)) {
    kept.clear();
    open = aborted = false;
    return {};
  }
  if (sql.starts_with("ROLLBACK")) kept.clear();
  const bool commits = sql == "COMMIT" || (!open && !is_script && !is_control(sql));
  pqxx::result rows = watched(sql, commits, [&] {
    if (!is_script && !is_control(sql)) return send(sql, values);
    const std::string all = std::exchange(kept, {}) + std::string(sql);
    return pqxx::nontransaction(*connection).exec(all);
  });
  if (sql.starts_with("ROLLBACK TO")) aborted = false;
  if (ends_transaction(sql)) open = aborted = false;
  return rows;
}

void PostgresDatabase::Line::keep(std::string_view sql, std::span<const Bound> values) {
  constexpr std::size_t kMostBytes = 1 << 18;
  look(sql);
  watched(sql, false, [&]() -> pqxx::result {
    kept += execution(sql, values) + "; ";
    if (kept.size() < kMostBytes) return {};
    return pqxx::nontransaction(*connection).exec(std::exchange(kept, {}));
  });
}

namespace {

class Heard final : public pqxx::notification_receiver {
 public:
  Heard(pqxx::connection_base& connection, const std::string& channel)
      : pqxx::notification_receiver(connection, channel) {}
  void operator()(const std::string& text, int) override {
    if (report != nullptr && *report) (*report)(text);
  }
  const std::function<void(const std::string&)>* report{};
};

}  // namespace

PostgresDatabase::PostgresDatabase(Options options, bool must_be_there)
    : line_(std::make_unique<Line>(std::move(options))) {
  line_->seek();
  line_->seeker.join();
  if (line_->take() || !must_be_there) return;
  throw StoreFault(line_->refused ? FaultKind::Other : FaultKind::Away, line_->why);
}

PostgresDatabase::~PostgresDatabase() = default;

bool PostgresDatabase::in_transaction() const { return line_->open; }

bool PostgresDatabase::is_there() {
  if (line_->dead) return false;
  return line_->take();
}

std::string PostgresDatabase::why_away() const { return line_->why; }

bool PostgresDatabase::is_refused() const { return !line_->connection && line_->refused; }

void PostgresDatabase::hurry() { line_->watchdog.hurry(); }

void PostgresDatabase::hold(std::string_view name) {
  Rows none = rows("SELECT pg_advisory_xact_lock(hashtextextended(?, 0))", name);
  while (none.next()) continue;
}

Rows PostgresDatabase::rows_list(std::string_view sql, std::span<const Bound> values) {
  return Rows(std::make_unique<PostgresRows>(line_->ask(sql, values)));
}

int PostgresDatabase::run_list(std::string_view sql, std::span<const Bound> values) {
  return static_cast<int>(line_->ask(sql, values).affected_rows());
}

void PostgresDatabase::later_list(std::string_view sql, std::span<const Bound> values) {
  if (line_->open)
    line_->keep(sql, values);
  else
    line_->ask(sql, values);
}

void PostgresDatabase::script(const std::string& sql) { line_->ask(sql, {}, true); }

bool PostgresDatabase::listen(std::string_view channel, double wait_s,
                              const std::function<void(const std::string& text)>& heard) {
  Line& line = *line_;
  if (!is_there()) return false;
  try {
    auto& one = line.listens[std::string(channel)];
    if (!one) {
      line.watchdog.begin(line.connection->sock(), line.options.answer_s + 1);
      one = std::make_unique<Heard>(*line.connection, std::string(channel));
      line.watchdog.end();
    }
    auto& ear = static_cast<Heard&>(*one);
    ear.report = &heard;
    const auto whole = static_cast<long>(wait_s);
    line.connection->await_notification(
        whole, static_cast<long>((wait_s - static_cast<double>(whole)) * 1e6));
    ear.report = nullptr;
    return true;
  } catch (const std::exception& fault) {
    line.watchdog.end();
    line.lose(one_line(fault.what()));
    return false;
  }
}

}  // namespace popcut::daemon
