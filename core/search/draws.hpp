// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace popcut {

/// Number `count` of the stream `stream` of a seed, evenly distributed in [0, 1). A counter-based
/// generator: each number follows from its place alone, so that it does not matter who draws first.
/// The mixer is that of SplitMix64 (Steele, Lea and Flood, Fast Splittable Pseudorandom Number
/// Generators, 2014), once for each of the three.
[[nodiscard]] inline double draw(std::uint64_t seed, std::uint64_t stream, std::uint64_t count) {
  const auto mixed = [](std::uint64_t z) {
    z += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  };
  constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return static_cast<double>(mixed(mixed(mixed(seed) ^ stream) ^ count) >> 11) * kUnit;
}

/// The numbers of one stream, one after another.
class Draws {
 public:
  Draws(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}
  [[nodiscard]] double next() { return draw(seed_, stream_, count_++); }
  /// A whole number from 0 to `count` - 1.
  [[nodiscard]] std::size_t next_below(std::size_t count) {
    return static_cast<std::size_t>(next() * static_cast<double>(count));
  }
  /// One of `values`.
  template <typename Values>
  [[nodiscard]] const auto& next_of(const Values& values) {
    return values[next_below(values.size())];
  }

 private:
  std::uint64_t seed_, stream_, count_{};
};

}  // namespace popcut
