// SPDX-License-Identifier: MIT
#include "daemon/store/wal_check.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

// The file format is SQLite's: sqlite.org/fileformat2.html, section 4.
constexpr std::size_t kHeaderBytes = 32;
constexpr std::size_t kFrameHeaderBytes = 24;

std::uint32_t word(const unsigned char* bytes, bool big_endian) {
  const std::array<unsigned, 4> b{bytes[0], bytes[1], bytes[2], bytes[3]};
  return big_endian ? b[0] << 24 | b[1] << 16 | b[2] << 8 | b[3]
                    : b[3] << 24 | b[2] << 16 | b[1] << 8 | b[0];
}

struct Sum {
  std::uint32_t first{}, second{};
  void add(const unsigned char* bytes, std::size_t count, bool big_endian) {
    for (std::size_t i = 0; i + 8 <= count; i += 8) {
      first += word(bytes + i, big_endian) + second;
      second += word(bytes + i + 4, big_endian) + first;
    }
  }
  [[nodiscard]] bool is(const unsigned char* bytes) const {
    return first == word(bytes, true) && second == word(bytes + 4, true);
  }
};

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

}  // namespace

std::string log_damage(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rbe"), &std::fclose);
  if (!file) return "is missing, and the last changes with it";
  std::array<unsigned char, kHeaderBytes> header{};
  if (std::fread(header.data(), 1, kHeaderBytes, file.get()) != kHeaderBytes)
    return "is truncated, and the last changes are lost";
  const std::uint32_t magic = word(header.data(), true);
  const bool big_endian = magic == 0x377F0683;
  Sum sum;
  sum.add(header.data(), 24, big_endian);
  const std::uint32_t page = word(header.data() + 8, true);
  if ((magic & ~1U) != 0x377F0682 || !sum.is(header.data() + 24) || page < 512 || page > 65536)
    return "has a damaged header";

  // Frames lie in the order in which they were written, and the sum of each goes on from the one
  // before. A run that was killed in a transaction leaves frames that the next ones write over, so
  // behind the last commit anything may lie. What was written in one go behind a commit proves that
  // this commit was on the disk: then a frame before it that is not sound was damaged later.
  std::vector<unsigned char> frame(kFrameHeaderBytes + page);
  std::uint64_t broken = 0;       // the first frame that is not sound; 0: all are
  bool committed_before = false;  // the frame before is a commit, and none before `broken`
  for (std::uint64_t number = 1;; ++number) {
    if (std::fread(frame.data(), 1, frame.size(), file.get()) != frame.size()) break;
    const bool ours = std::equal(header.begin() + 16, header.begin() + 24, frame.begin() + 8);
    sum.add(frame.data(), 8, big_endian);
    sum.add(frame.data() + kFrameHeaderBytes, page, big_endian);
    const bool follows = ours && sum.is(frame.data() + 16);
    if (follows && committed_before)
      return fmt::format("is damaged in frame {}, before later changes", broken);
    if (!follows && broken == 0) broken = number;
    committed_before = broken != 0 && ours && word(frame.data() + 4, true) != 0;
    sum = {word(frame.data() + 16, true), word(frame.data() + 20, true)};
  }
  return {};
}

}  // namespace popcut::daemon
