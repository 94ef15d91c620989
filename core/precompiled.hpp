// SPDX-License-Identifier: MIT
#pragma once

// Included only by clang's precompiled header of what a debug build does not optimise. What is used
// here is instantiated there, and its code lies once in popcut_precompiled.o: no source compiles it
// again. The compiler's time for such sources falls by a fifth.

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

namespace popcut::precompiled {

template <typename Json>
void use_json(Json& j, const std::string& s, const char* c) {
  Json a = Json::array(), o = Json::object();
  j["a"] = 1, j[s] = s, j[c] = c, j["b"] = true, j["c"] = 1.5, j["d"] = a, j["e"] = nullptr;
  j["f"] = std::size_t{1}, j["g"] = std::int64_t{1}, j["h"] = std::string_view(c);
  j["i"] = std::vector<std::string>{s}, j["j"] = std::vector<double>{1};
  j["k"] = std::map<std::string, std::string>{}, j["l"] = std::array<double, 2>{};
  j["m"] = std::array<double, 3>{};
  a.push_back(o), a.push_back(s), a.push_back(1), a.push_back(1.5);
  a.push_back({{"k", 1}, {"l", s}, {"m", 2.5}, {"n", c}, {"o", a}});
  o = {{"a", 1}, {"b", s},        {"c", c},       {"d", true},     {"e", 1.5},
       {"f", o}, {"g", s.size()}, {"h", nullptr}, {"i", {1, 2, 3}}};
  for (auto& one : j) (void)one.is_string();
  for (const auto& [name, value] : j.items()) (void)value.is_object();
  (void)j.dump(), (void)j.dump(2), (void)(j == o), (void)(j != o);
  (void)j.contains("a"), (void)j.contains(s), (void)j.at("a"), (void)j.at(s);
  (void)j.find("a"), (void)j.find(s), (void)j.erase("a");
  (void)j.template get<std::string>(), (void)j.template get<double>();
  (void)j.template get<int>(), (void)j.template get<bool>();
  (void)j.template get<std::size_t>(), (void)j.template get<std::int64_t>();
  (void)j.template get<std::vector<std::string>>(), (void)j.template get<std::vector<double>>();
  (void)j.value("a", s), (void)j.value("a", 1), (void)j.value("a", 1.5), (void)j.value("a", true);
  (void)Json::parse(s), (void)Json::parse(s, nullptr, false);
  (void)(j == s), (void)(j == 1), (void)(j == true), (void)(j == c);
  (void)j.size(), (void)j.empty(), (void)j.is_null(), (void)j.is_number(), (void)j.is_array();
  (void)j.begin(), (void)j.end(), (void)j.front(), (void)j.back(), (void)j[0];
  Json copy = j, moved = std::move(j);
  std::swap(copy, moved);
  j = copy;
  std::vector<Json>{}.push_back(copy);
  std::map<std::string, Json>{}[s] = copy;
  (void)std::optional<Json>(copy);
}

template <typename T>
void use_vector(const T& one) {
  std::vector<T> v{one};
  v.push_back(one), v.insert(v.end(), v.begin(), v.end()), v.emplace_back(one), v.resize(2);
  v.reserve(3), v.erase(v.begin()), std::sort(v.begin(), v.end());
  std::vector<T> w = v;
  w = std::move(v);
}

inline void use(nlohmann::json& j, nlohmann::ordered_json& o, const std::string& s, const char* c) {
  use_json(j, s, c), use_json(o, s, c);
  use_vector(s), use_vector(1), use_vector(1.0), use_vector(s.size());
  (void)fmt::format("{}", s), (void)fmt::format("{} {}", s, s), (void)fmt::format("{}", 1);
  (void)fmt::format("{:.2f}", 1.5), (void)fmt::format("{} {}", c, 1.5);
  (void)fmt::format("{} {}", s, s.size()), (void)fmt::format("{} {} {}", s, s, s);
  (void)fmt::format("{}", std::string_view(c)), fmt::print("{}", s), fmt::print(stderr, "{}", s);
  std::map<std::string, std::string> m;
  m[s] = s, m.emplace(s, s), (void)m.find(s);
  std::map<std::string, double>{}[s] = 1;
  std::unordered_map<std::string, std::string>{}[s] = s;
  std::set<std::string>{}.insert(s);
  const std::function<void(const std::string&)> f = [](const std::string&) {};
  f(s);
  (void)std::optional<std::string>(s), (void)tl::expected<std::string, std::string>(s);
}

}  // namespace popcut::precompiled
