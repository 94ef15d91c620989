// SPDX-License-Identifier: MIT
#include "daemon/store/intent_journal.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "daemon/digest/digest.hpp"
#include "daemon/files/held_folder.hpp"
#include "daemon/model/json_object.hpp"
#include "daemon/store/database.hpp"
#include "daemon/store/ulid.hpp"

namespace popcut::daemon {
template <typename See>
void list_fields(const IntentHead*, See&& see) {
  see("attempt", &IntentHead::attempt);
  see("job", &IntentHead::job);
  see("sheet", &IntentHead::sheet);
  see("blank", &IntentHead::blank);
  see("segment", &IntentHead::segment);
  see("first_stroke", &IntentHead::first_stroke);
  see("strokes", &IntentHead::strokes);
  see("device", &IntentHead::device);
  see("device_session", &IntentHead::device_session);
  see("operator", &IntentHead::operator_name);
  see("plan_sha256", &IntentHead::plan_sha256);
  see("invocation", &IntentHead::invocation);
  see("created", &IntentHead::created);
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigestDigits = 40;
constexpr std::size_t kHeadBytes = 2048;
constexpr std::size_t kRecordBytes = 64;  // 9 + 1 + 12 + 1 + 40 + 1
// Slots lie in pages of their own, so that no torn write reaches both.
constexpr std::size_t kSlotStep = 4096;
constexpr std::size_t kSlotBytes = 105;  // 9 + 1 + 12 + 1 + 40 + 1 + 40 + 1
// Written before the first intent, so that most of them change no length and need no room.
constexpr std::size_t kReadyRecords = 1024;
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;

std::string digest_of(std::string_view chain, std::string_view text) {
  Sha256 digest;
  digest.add(chain);
  digest.add(text);
  return digest.hex().substr(0, kDigestDigits);
}

std::string record_text(std::int64_t number, std::int64_t last) {
  return fmt::format("{:09} {:012}", number, last + 1);  // from 1, so that "none" is 0
}

/// Reads what `record_text` wrote; false: it is something else.
bool read_record(std::string_view text, std::int64_t& number, std::int64_t& last) {
  const auto whole = [](std::string_view digits, std::int64_t& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc{} && end == digits.data() + digits.size();
  };
  if (text.size() != 22 || text[9] != ' ' || !whole(text.substr(0, 9), number) ||
      !whole(text.substr(10), last))
    return false;
  --last;
  return number >= 0 && text == record_text(number, last);
}

void put(JsonObject& out, std::string_view name, const std::string& text) { out.text(name, text); }
void put(JsonObject& out, std::string_view name, std::int64_t number) { out.number(name, number); }

std::string head_text(const IntentHead& head) {
  JsonObject out;
  out.number("popcut", 1);
  list_fields(&head, [&](std::string_view name, auto member) { put(out, name, head.*member); });
  std::string text = out.whole();
  constexpr std::size_t kRoom = kHeadBytes - kDigestDigits - 2;
  if (text.size() > kRoom) throw StoreFault(FaultKind::Other, "the head of a journal is too long");
  text.resize(kRoom, ' ');
  return text + " " + digest_of("", text) + "\n";
}

std::optional<IntentHead> read_head(std::string_view bytes, const std::string& attempt) {
  if (bytes.size() < kHeadBytes) return std::nullopt;
  const std::string_view text = bytes.substr(0, kHeadBytes - kDigestDigits - 2);
  if (bytes.substr(text.size() + 1, kDigestDigits) != digest_of("", text)) return std::nullopt;
  const auto json = nlohmann::json::parse(text, nullptr, false);
  IntentHead head;
  try {
    list_fields(&head, [&](const char* name, auto member) { json.at(name).get_to(head.*member); });
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
  const bool sane = head.attempt == attempt && is_ulid(head.job) && head.sheet > 0 &&
                    head.blank > 0 && head.segment > 0 && head.first_stroke >= 0 &&
                    head.strokes >= head.first_stroke;
  return sane ? std::optional(head) : std::nullopt;
}

std::string slot_text(std::int64_t number, std::int64_t last, const std::string& chain) {
  const std::string text = record_text(number, last) + " " + chain;
  return text + " " + digest_of("", text) + "\n";
}

struct Slot {
  std::int64_t number{}, last{};
  std::string chain;
};
std::optional<Slot> read_slot(std::string_view bytes, std::size_t at) {
  if (bytes.size() < at + kSlotBytes) return std::nullopt;
  const std::string_view text = bytes.substr(at, kSlotBytes - kDigestDigits - 2);
  Slot slot;
  if (!read_record(text.substr(0, 22), slot.number, slot.last) ||
      bytes.substr(at + text.size() + 1, kDigestDigits) != digest_of("", text))
    return std::nullopt;
  slot.chain = text.substr(23);
  return slot;
}

[[noreturn]] void fault(const std::string& path, const char* what) {
  // A folder that was moved away meanwhile has no room either, and the disk is sound.
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG || errno == ENOENT;
  const bool busy = errno == EMFILE || errno == ENFILE;
  throw StoreFault(full   ? FaultKind::Full
                   : busy ? FaultKind::Busy
                          : FaultKind::Io,
                   fmt::format("{}: {}: {}", path, what, std::strerror(errno)));
}

void write_at(int file, const std::string& path, std::string_view bytes, std::size_t at) {
  while (!bytes.empty()) {
    const ssize_t done = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done == 0) errno = ENOSPC;
    if (done <= 0) fault(path, "cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(done));
    at += static_cast<std::size_t>(done);
  }
}

void sync(int file, const std::string& path) {
  if (::fdatasync(file) != 0) fault(path, "cannot be synced");
}

/// Makes a file that is whole as soon as it has its name, and gives it open.
int put(const std::string& path, std::string_view bytes) {
  std::string name;
  errno = 0;
  const Result<HeldFolder> folder = HeldFolder::around(path, name);
  if (!folder) fault(path, "its folder cannot be opened");
  const std::string fresh = ".new-" + name;
  const int file = folder->create(fresh);
  if (file < 0) fault(path, "cannot be created");
  try {
    write_at(file, path, bytes, 0);
    if (::fsync(file) != 0) fault(path, "cannot be synced");
    if (folder->rename(fresh, name) != 0) fault(path, "cannot be renamed");
    if (!folder->sync()) fault(path, "its folder cannot be synced");
  } catch (...) {
    ::close(file);
    folder->remove(fresh);
    folder->remove(name);
    throw;
  }
  return file;
}

/// Removes the list first and syncs that: a list without its witness would say that anything may
/// have been sent.
void take_away(const std::string& list, const std::string& witness) {
  ::unlink(list.c_str());
  (void)sync_folder(fs::path(list).parent_path().string());
  ::unlink(witness.c_str());
}

std::string list_of(const StateFolder& folder, const std::string& attempt) {
  return folder.at("intents/" + attempt);
}
std::string witness_of(const StateFolder& folder, const std::string& attempt) {
  return folder.at("witnesses/" + attempt);
}

IntentTrail read_trail(const StateFolder& folder, const std::string& attempt) {
  IntentTrail trail;
  const std::string list = read_whole(list_of(folder, attempt), kMostBytes).value_or("");
  std::map<std::int64_t, std::string> chains;  // of the last records, by number
  if ((trail.head = read_head(list, attempt))) {
    trail.journal = {.there = true, .records = 0, .last = trail.head->first_stroke - 1};
    std::string chain = digest_of("", std::string_view(list).substr(0, kHeadBytes));
    chains[0] = chain;
    for (std::size_t at = kHeadBytes; at + kRecordBytes <= list.size(); at += kRecordBytes) {
      const std::string_view record = std::string_view(list).substr(at, kRecordBytes);
      std::int64_t number = 0, last = 0;
      if (!read_record(record.substr(0, 22), number, last) || number != trail.journal.records + 1 ||
          record.substr(23, kDigestDigits) != digest_of(chain, record.substr(0, 22)))
        break;
      chain = record.substr(23, kDigestDigits);
      chains[number] = chain;
      trail.journal.records = number;
      trail.journal.last = std::max(trail.journal.last, last);
    }
  }
  const std::string witness = read_whole(witness_of(folder, attempt), kMostBytes).value_or("");
  const auto head = read_head(witness, attempt);
  if (!head) return trail;
  if (!trail.head) trail.head = head;
  std::optional<Slot> newer = read_slot(witness, kSlotStep);
  std::optional<Slot> older = read_slot(witness, 2 * kSlotStep);
  if (newer && older && older->number > newer->number) std::swap(newer, older);
  if (!newer) std::swap(newer, older);
  if (!newer) return trail;
  const auto counted = chains.find(newer->number);
  // A list that goes on differently from what was counted is not the one that was counted.
  if (counted != chains.end() && counted->second != newer->chain) trail.journal.there = false;
  const bool in_turn = older && (older->number + 1 == newer->number || newer->number == 0);
  trail.witness = {.there = true,
                   .whole = in_turn,
                   .records = newer->number,
                   .last = newer->last,
                   .last_before = in_turn ? older->last : -1};
  return trail;
}

}  // namespace

IntentJournal::IntentJournal(const StateFolder& folder, const IntentHead& head)
    : list_path_(list_of(folder, head.attempt)), witness_path_(witness_of(folder, head.attempt)) {
  try {
    open(head);
  } catch (...) {
    shut();
    throw;
  }
}

void IntentJournal::open(const IntentHead& head) {
  const std::string text = head_text(head);
  chain_ = digest_of("", text);
  std::string witness = text;
  for (const std::size_t slot : {1, 2}) {
    witness.resize(slot * kSlotStep, '\0');
    witness += slot_text(0, head.first_stroke - 1, chain_);
  }
  // The witness first: alone, it says that nothing was sent; the list alone says nothing.
  witness_ = put(witness_path_, witness);
  const auto most =
      static_cast<std::size_t>(std::max<std::int64_t>(1, head.strokes - head.first_stroke));
  std::string list = text;
  list.resize(kHeadBytes + kRecordBytes * std::min(most, kReadyRecords), '\0');
  list_ = put(list_path_, list);
}

IntentJournal::~IntentJournal() { shut(); }

void IntentJournal::shut() {
  for (const int file : {list_, witness_})
    if (file >= 0) ::close(file);
  if (kept_) return;
  try {
    if (list_ >= 0) take_away(list_path_, witness_path_);
  } catch (const std::exception&) {  // no memory for the sync between
    ::unlink(list_path_.c_str());
  }
  if (witness_ >= 0) ::unlink(witness_path_.c_str());
}

void IntentJournal::intend(std::int64_t last) {
  if (failed_)
    throw StoreFault(FaultKind::Io, list_path_ + ": could not be written or synced before");
  const std::string text = record_text(records_ + 1, last);
  const std::string chain = digest_of(chain_, text);
  try {
    write_at(list_, list_path_, text + " " + chain + "\n",
             kHeadBytes + static_cast<std::size_t>(records_) * kRecordBytes);
    sync(list_, list_path_);
    write_at(witness_, witness_path_, slot_text(records_ + 1, last, chain),
             kSlotStep * (1 + static_cast<std::size_t>(records_ % 2)));
    sync(witness_, witness_path_);
  } catch (const StoreFault& problem) {
    // What a failed sync left is not known, so a second one proves nothing.
    failed_ = problem.kind() != FaultKind::Full;
    throw;
  }
  chain_ = chain;
  ++records_;
}

std::map<std::string, IntentTrail> IntentJournals::trails() const {
  std::map<std::string, IntentTrail> all;
  for (const char* inside : {"intents", "witnesses"}) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_.at(inside), ignored))
      if (const std::string name = entry.path().filename().string(); is_ulid(name))
        if (!all.contains(name)) all[name] = read_trail(folder_, name);
  }
  return all;
}

bool IntentJournals::has(const std::string& attempt) const {
  std::error_code ignored;
  return fs::exists(list_of(folder_, attempt), ignored) ||
         fs::exists(witness_of(folder_, attempt), ignored);
}

void IntentJournals::remove(const std::string& attempt) const {
  take_away(list_of(folder_, attempt), witness_of(folder_, attempt));
}

// As `take_away`, with one sync for all: a running cut may wait meanwhile.
void IntentJournals::checkpointed() {
  if (ended_.empty()) return;
  for (const std::string& attempt : ended_) ::unlink(list_of(folder_, attempt).c_str());
  (void)sync_folder(folder_.at("intents"));
  for (const std::string& attempt : ended_) ::unlink(witness_of(folder_, attempt).c_str());
  ended_.clear();
}

}  // namespace popcut::daemon
