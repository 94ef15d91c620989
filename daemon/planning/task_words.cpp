// SPDX-License-Identifier: MIT
#include "daemon/planning/task_words.hpp"

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/text/near_names.hpp"

namespace popcut::planning {
namespace {

/// Where the value of an option goes.
struct Slots {
  std::map<std::string, std::string*> texts;
  std::map<std::string, double*> numbers;
  std::map<std::string, std::vector<double>*> lists;
  std::map<std::string, bool*> flags;

  explicit Slots(PlanWords& words)
      : texts{{"mat", &words.mat},
              {"at", &words.at},
              {"dialect", &words.dialect},
              {"svg-profile", &words.svg_profile},
              {"order", &words.order.method},
              {"folds", &words.knife.folds},
              {"direction", &words.knife.direction},
              {"overcut", &words.knife.overcut},
              {"snap", &words.knife.snap},
              {"labels", &words.split.labels},
              {"mark-form", &words.marks.form}},
        numbers{{"effort", &words.order.effort},
                {"curve-tolerance", &words.curve_tolerance_mm},
                {"svg-dpi", &words.svg_dpi}},
        lists{{"seam-x", &words.split.seams_x}, {"seam-y", &words.split.seams_y}},
        flags{{"mat-free", &words.order.mat_free},
              {"clip", &words.clip},
              {"marks", &words.marks.wanted},
              {"no-split", &words.split.never}} {}

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all{"seed", "split"};
    for (const auto& [name, slot] : texts) all.push_back(name);
    for (const auto& [name, slot] : numbers) all.push_back(name);
    for (const auto& [name, slot] : lists) all.push_back(name);
    for (const auto& [name, slot] : flags) all.push_back(name);
    return all;
  }
};

bool read_number(std::string_view text, double& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() && std::isfinite(value);
}

bool read_list(std::string_view text, std::vector<double>& values) {
  constexpr std::size_t kMost = 1000;
  while (values.size() < kMost) {
    const std::string_view item = text.substr(0, text.find(','));
    if (!read_number(item, values.emplace_back())) return false;
    if (item.size() == text.size()) return true;
    text.remove_prefix(item.size() + 1);
  }
  return false;
}

bool read_flag(std::string_view text, bool& value) {
  value = text == "true";
  return value || text == "false";
}

}  // namespace

Result<PlanWords> words_of_options(const std::map<std::string, std::string>& options) {
  PlanWords words;
  Slots slots(words);
  for (const auto& [name, value] : options) {
    const std::string shown = fmt::format("is \"{}\"", value.substr(0, 40));
    const auto wrong = [&, &place = name](const char* right) {
      return fail(ErrorKind::OutOfRange, "/options/" + place,
                  fmt::format("{}; {} is needed", shown, right));
    };
    if (const auto text = slots.texts.find(name); text != slots.texts.end()) {
      *text->second = value;
    } else if (const auto number = slots.numbers.find(name); number != slots.numbers.end()) {
      if (!read_number(value, *number->second)) return wrong("a number");
    } else if (const auto list = slots.lists.find(name); list != slots.lists.end()) {
      if (!read_list(value, *list->second)) return wrong("numbers with commas between (mm)");
    } else if (const auto flag = slots.flags.find(name); flag != slots.flags.end()) {
      if (!read_flag(value, *flag->second)) return wrong("true or false");
    } else if (name == "split") {
      bool split = true;
      if (!read_flag(value, split)) return wrong("true or false");
      words.split.never = !split;
    } else if (name == "seed") {
      double seed = 0;
      if (!read_number(value, seed) || seed < 0 || seed > 9e15 || seed != std::floor(seed))
        return wrong("a whole number");
      words.order.seed = static_cast<std::uint64_t>(seed);
    } else {
      return fail(ErrorKind::OutOfRange, "/options/" + name.substr(0, 80),
                  fmt::format("there is no such option; {}", suggestion(name, slots.names())));
    }
  }
  return words;
}

Error in_request(Error error) {
  if (error.place.rfind("--", 0) != 0) return error;
  const std::string option = error.place.substr(2);
  error.place = (option == "material" || option == "machine" ? "/" : "/options/") + option;
  if (error.kind == ErrorKind::Usage) error.kind = ErrorKind::OutOfRange;
  return error;
}

}  // namespace popcut::planning
