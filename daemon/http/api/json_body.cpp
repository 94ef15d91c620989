// SPDX-License-Identifier: MIT
#include "daemon/http/api/json_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/text/json_fields.hpp"
#include "daemon/http/api/target.hpp"

namespace popcut::daemon::http {
namespace {

using nlohmann::json;

constexpr std::size_t kMostOptions = 32;
constexpr std::size_t kLongestOption = 200;

// Builds the value while it watches depth and doubled members.
class Builder : public nlohmann::json_sax<json> {
 public:
  explicit Builder(int max_depth) : max_depth_(max_depth) {}
  json root;
  std::string fault;
  std::size_t fault_at{0};

  bool null() override { return add(json(nullptr)); }
  bool boolean(bool value) override { return add(json(value)); }
  bool number_integer(number_integer_t value) override { return add(json(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add(json(value)); }
  bool number_float(number_float_t value, const string_t&) override {
    return std::isfinite(value) ? add(json(value)) : stop("a number is too large");
  }
  bool string(string_t& value) override { return add(json(std::move(value))); }
  bool binary(binary_t&) override { return stop("binary values are not JSON"); }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (open_.back()->contains(name))
      return stop(fmt::format("the member \"{}\" occurs twice in one object", name.substr(0, 64)));
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const json::exception& e) override {
    fault_at = position;
    return stop(e.id == 406 ? "a number is too large" : "this is not JSON");
  }

 private:
  bool stop(std::string why) {
    if (fault.empty()) fault = std::move(why);
    return false;
  }
  json* place(json value) {
    if (open_.empty()) {
      root = std::move(value);
      return &root;
    }
    json& outer = *open_.back();
    if (outer.is_object()) return &(outer[key_] = std::move(value));
    outer.push_back(std::move(value));
    return &outer.back();
  }
  bool add(json value) {
    place(std::move(value));
    return true;
  }
  bool open(json value) {
    if (static_cast<int>(open_.size()) >= max_depth_)
      return stop(fmt::format("it is nested more than {} levels deep", max_depth_));
    open_.push_back(place(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  // A pointer into an array stays good while its element is open, since nothing is added to the
  // array before that is closed.
  std::vector<json*> open_;
  std::string key_;
  int max_depth_;
};

std::size_t code_points(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;
  }));
}

std::optional<std::string> option_text(const json& value) {
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  if (value.is_number()) return fmt::format("{}", value.get<double>());
  if (!value.is_string()) return std::nullopt;
  std::string text = value.get<std::string>();
  if (text.size() > kLongestOption || has_controls(text)) return std::nullopt;
  return text;
}

bool is_option_name(std::string_view name) {
  return !name.empty() && name.size() <= 40 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

}  // namespace

Answer<json> parse_body(std::string_view text, int max_depth) {
  Builder builder(max_depth);
  const std::size_t zero = text.find('\0');  // which the parser would take for the end
  if (zero != std::string_view::npos) {
    builder.fault = "it contains a zero byte, which JSON does not allow";
    builder.fault_at = zero + 1;
  }
  const bool whole = zero == std::string_view::npos && json::sax_parse(text, &builder);
  if (whole && builder.fault.empty()) return std::move(builder.root);
  Problem problem{ProblemKind::MalformedJson,
                  builder.fault.empty() ? "this is not JSON" : builder.fault};
  if (builder.fault_at > 0) {
    problem.detail += fmt::format(" (byte {})", builder.fault_at);
    problem.errors.push_back({fmt::format("byte {}", builder.fault_at), "malformed",
                              "look for a missing comma, quote or bracket there"});
  }
  return tl::unexpected<Problem>(std::move(problem));
}

Members::Members(const json& value, std::vector<RequestFault>& faults, std::string pointer)
    : value_(value), faults_(faults), pointer_(std::move(pointer)) {
  if (!value_.is_object())
    faults_.push_back(
        {pointer_, "type", fmt::format("must be an object {{...}}, not {}", json_type(value_))});
}

bool Members::has(const std::string& name) const {
  return value_.is_object() && value_.contains(name);
}

const json* Members::find(const std::string& name) {
  known_.push_back(name);
  return has(name) ? &value_.at(name) : nullptr;
}

void Members::fault(const std::string& name, std::string code, std::string detail) {
  faults_.push_back({fmt::format("{}/{}", pointer_, json_pointer_token(name)), std::move(code),
                     std::move(detail)});
}

void Members::fault_of(const std::string& name, std::string code, std::string detail) {
  constexpr std::size_t kMostShown = 64;
  const json& value = value_.at(name);
  if (value.is_structured()) detail += ", not " + json_type(value);
  fault(name, std::move(code), std::move(detail));
  if (value.is_structured()) return;
  std::string got = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (got.size() <= kMostShown) faults_.back().got = std::move(got);
}

std::optional<std::string> Members::checked_text(const std::string& name, std::size_t least,
                                                 std::size_t most, bool lines) {
  const json* found = find(name);
  if (found == nullptr) return std::nullopt;
  if (!found->is_string()) {
    fault(name, "type", "must be a string, not " + json_type(*found));
    return std::nullopt;
  }
  std::string text = found->get<std::string>();
  const std::size_t length = code_points(text);
  if (length < least || length > most)
    fault(name, "length", fmt::format("must have {} to {} characters", least, most));
  else if (has_controls(text, lines))
    fault(name, "characters", "must not have control characters");
  return text;
}

std::optional<std::string> Members::text(const std::string& name, std::size_t most, bool lines) {
  return checked_text(name, 1, most, lines);
}

std::optional<std::string> Members::text_or_empty(const std::string& name, std::size_t most,
                                                  bool lines) {
  return checked_text(name, 0, most, lines);
}

std::optional<std::int64_t> Members::integer(const std::string& name, std::int64_t low,
                                             std::int64_t high) {
  const json* found = find(name);
  if (found == nullptr) return std::nullopt;
  const bool is_whole = found->is_number_integer();
  if (!is_whole) {
    fault_of(name, "type", "must be a whole number");
    return std::nullopt;
  }
  // Larger than any signed number: certainly out of range.
  const bool is_huge = found->is_number_unsigned() &&
                       found->get<std::uint64_t>() >
                           static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const std::int64_t got = is_huge ? 0 : found->get<std::int64_t>();
  if (is_huge || got < low || got > high) {
    fault_of(name, "range", fmt::format("must be {}..{}", low, high));
    return std::nullopt;
  }
  return got;
}

std::optional<bool> Members::boolean(const std::string& name) {
  const json* found = find(name);
  if (found == nullptr) return std::nullopt;
  if (!found->is_boolean()) {
    fault_of(name, "type", "must be true or false");
    return std::nullopt;
  }
  return found->get<bool>();
}

std::optional<std::string> Members::word(const std::string& name,
                                         const std::vector<std::string>& words) {
  const std::optional<std::string> got = text(name, 64);
  if (!got || std::find(words.begin(), words.end(), *got) != words.end()) return got;
  const std::string near = nearest_word(*got, words);
  fault_of(name, "word",
           near.empty() ? fmt::format("must be one of {}", fmt::join(words, ", "))
                        : fmt::format("did you mean {}?", near));
  return std::nullopt;
}

std::vector<std::string> Members::texts(const std::string& name, std::size_t most_items,
                                        std::size_t most_each) {
  const json* found = find(name);
  std::vector<std::string> out;
  if (found == nullptr) return out;
  if (!found->is_array() || found->size() > most_items) {
    fault(name, found->is_array() ? "length" : "type",
          fmt::format("must be a list of at most {} strings{}", most_items,
                      found->is_array() ? "" : ", not " + json_type(*found)));
    return out;
  }
  for (const json& item : *found) {
    const std::string text = item.is_string() ? item.get<std::string>() : std::string();
    if (text.empty() || code_points(text) > most_each || has_controls(text)) {
      fault(name, "item", fmt::format("each must be a string of 1 to {} characters", most_each));
      return out;
    }
    out.push_back(text);
  }
  return out;
}

std::map<std::string, std::string> Members::options(const std::string& name) {
  const json* found = find(name);
  std::map<std::string, std::string> out;
  if (found == nullptr) return out;
  if (!found->is_object() || found->size() > kMostOptions) {
    fault(name, found->is_object() ? "length" : "type",
          fmt::format("must be an object of at most {} options{}", kMostOptions,
                      found->is_object() ? "" : ", not " + json_type(*found)));
    return out;
  }
  for (const auto& [key, value] : found->items()) {
    const std::optional<std::string> text = option_text(value);
    if (is_option_name(key) && text) {
      out.emplace(key, *text);
      continue;
    }
    faults_.push_back({fmt::format("{}/{}/{}", pointer_, name, json_pointer_token(key)), "option",
                       "must be an option of 'popcut plan' without dashes, with a string, number "
                       "or boolean as its value"});
  }
  return out;
}

void Members::require(const std::string& name, const std::string& what) {
  if (value_.is_object() && !has(name)) fault(name, "missing", what);
}

void Members::finish() {
  if (!value_.is_object()) return;
  for (const auto& [name, value] : value_.items()) {
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::string near = nearest_word(name, known_);
    fault(name, "unknown_member",
          near.empty()
              ? (known_.empty() ? std::string("is unknown; this body has no members")
                                : fmt::format("must be one of {}", fmt::join(known_, ", ")))
              : fmt::format("did you mean {}/{}?", pointer_, near));
    if (faults_.size() >= 32) return;
  }
}

Problem validation(std::vector<RequestFault> faults) {
  Problem problem{ProblemKind::Validation, {}};
  if (!faults.empty())
    problem.detail =
        fmt::format("{} {}{}", faults.front().pointer.empty() ? "the body" : faults.front().pointer,
                    faults.front().detail, faults.size() > 1 ? ", and more" : "");
  problem.errors = std::move(faults);
  return problem;
}

}  // namespace popcut::daemon::http
