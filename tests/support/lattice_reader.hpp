// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace popcut::testing {

/// A reader of lattice blobs of its own, from the words of docs/geometry.md, section 9. Throws
/// where the bytes are not as they are described there.
class LatticeReader {
 public:
  explicit LatticeReader(std::string bytes) : bytes_(std::move(bytes)) {
    need(bytes_.size() >= 12 && bytes_.compare(0, 4, "PCLB") == 0, "no lattice blob");
    need(u32_at(4) == 1, "not version 1");
    const std::size_t json = u32_at(8);
    need(json % 4 == 0 && 12 + json <= bytes_.size(), "head of a wrong size");
    head = nlohmann::json::parse(bytes_.substr(12, json));
    data_ = 12 + json;
    std::size_t end = 0;
    for (const auto& [name, array] : head.at("arrays").items()) {
      const std::size_t offset = array.at("offset");
      const std::size_t size = array.at("length").get<std::size_t>() *
                               (array.at("type") == "u8" ? std::size_t{1} : std::size_t{4});
      need(offset % 4 == 0 && data_ + offset + size <= bytes_.size(), name);
      end = std::max(end, offset + (size + 3) / 4 * 4);
    }
    need(data_ + end == bytes_.size(), "bytes that belong to no array");
  }

  [[nodiscard]] bool has(const std::string& name) const { return head.at("arrays").contains(name); }
  [[nodiscard]] std::vector<float> floats(const std::string& name) const {
    std::vector<float> out;
    each(name, "f32", [&](std::uint32_t word) {
      float value = 0;
      std::memcpy(&value, &word, 4);
      out.push_back(value);
    });
    return out;
  }
  [[nodiscard]] std::vector<std::uint32_t> words(const std::string& name) const {
    std::vector<std::uint32_t> out;
    each(name, "u32", [&](std::uint32_t word) { out.push_back(word); });
    return out;
  }
  [[nodiscard]] std::vector<int> numbers(const std::string& name) const {
    std::vector<int> out;
    each(name, "i32", [&](std::uint32_t word) {
      out.push_back(
          static_cast<int>(static_cast<std::int64_t>(word) - (word >> 31 ? 4294967296 : 0)));
    });
    return out;
  }
  [[nodiscard]] std::vector<int> bytes(const std::string& name) const {
    std::vector<int> out;
    const auto& array = of(name, "u8");
    for (std::size_t k = 0; k < array.at("length"); ++k)
      out.push_back(
          static_cast<unsigned char>(bytes_[data_ + array.at("offset").get<std::size_t>() + k]));
    return out;
  }

  /// Places (X, V, Z) of all points at the opening `psi`, by the formula of the page.
  [[nodiscard]] std::vector<std::array<double, 3>> opened(double psi) const {
    const auto p = floats("points");
    std::vector<std::array<double, 3>> out;
    for (std::size_t i = 0; i + 2 < p.size(); i += 3)
      out.push_back({p[i] + p[i + 1] * std::cos(psi), p[i + 2], p[i + 1] * std::sin(psi)});
    if (!has("tips")) return out;
    const auto tips = words("tips");
    const auto apex = floats("tip_apex"), w = floats("tip_w"), alpha = floats("tip_alpha");
    for (std::size_t k = 0; k < tips.size(); ++k) {
      const double theta = 2 * std::atan(alpha[k] * std::cos(psi / 2));
      const double x = apex[3 * k], z = apex[3 * k + 1], v = apex[3 * k + 2];
      out[tips[k]] = {x + z * std::cos(psi) + w[k] * std::sin(theta) * std::cos(psi / 2),
                      v + w[k] * std::cos(theta),
                      z * std::sin(psi) + w[k] * std::sin(theta) * std::sin(psi / 2)};
    }
    return out;
  }

  nlohmann::json head;

 private:
  static void need(bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error("lattice blob: " + what);
  }
  [[nodiscard]] std::uint32_t u32_at(std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t k = 4; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes_.at(at + k));
    return value;
  }
  [[nodiscard]] const nlohmann::json& of(const std::string& name, const char* type) const {
    const auto& array = head.at("arrays").at(name);
    need(array.at("type") == type, name + " is not " + type);
    return array;
  }
  template <typename Take>
  void each(const std::string& name, const char* type, Take take) const {
    const auto& array = of(name, type);
    for (std::size_t k = 0; k < array.at("length"); ++k)
      take(u32_at(data_ + array.at("offset").get<std::size_t>() + 4 * k));
  }

  std::string bytes_;
  std::size_t data_{};
};

}  // namespace popcut::testing
