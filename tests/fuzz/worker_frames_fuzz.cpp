// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#include "daemon/planning/confinement.hpp"
#include "daemon/planning/frames.hpp"

using namespace popcut;

namespace {

constexpr std::uint64_t kMost = 4096;

/// What is read of these bytes if they arrive `step` at a time.
std::string read_all(std::string_view bytes, std::size_t step) {
  planning::FrameReader reader(kMost);
  std::string seen;
  std::uint64_t taken = 0;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    const auto fed = reader.feed(bytes.substr(at, step), [&](planning::Frame frame) {
      taken += frame.bytes.size();
      if (taken > kMost || frame.name.size() > planning::kMostNameBytes) std::abort();
      if (!frame.name.empty() && !planning::is_plain_name(frame.name)) std::abort();
      seen += std::to_string(static_cast<unsigned>(frame.kind)) + frame.name + '|' + frame.bytes;
      return Result<void>();
    });
    if (!fed) {
      if (fed.error().detail.empty()) std::abort();
      return seen + " refused";
    }
  }
  return seen + (reader.at_rest() ? " whole" : " open");
}

}  // namespace

// The pipe between popcutd and a worker, in both directions: however it is cut, the same frames are
// read or refused, no more of them than allowed. And what a worker says of its walls.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (read_all(bytes, size + 1) != read_all(bytes, 3)) std::abort();
  const auto walls = planning::read_walls(bytes);
  if (!walls.empty() && planning::walls_text(walls) != bytes) std::abort();
  return 0;
}
