// SPDX-License-Identifier: MIT
// Drives a fuzz target without libFuzzer: FOLDER ROUNDS. Gives it every seed of FOLDER, then ROUNDS
// inputs made from them by chance, the same ones each time.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<Bytes> seeds_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Bytes> seeds{{}};
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return seeds;
}

// What a changed place becomes: bytes that parsers have reason to look at.
constexpr std::string_view kTelling = "<>\"'&;:#%(){}[],.-+eE0123456789 \n\0\xFF/=!*";

void change(Bytes& bytes, const std::vector<Bytes>& seeds, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const auto at = [&](std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t where = below(bytes.size() + 1);
  const std::size_t room = bytes.size() - where;
  switch (below(5)) {
    case 0:
      if (room > 0) bytes[where] = static_cast<std::uint8_t>(kTelling[below(kTelling.size())]);
      break;
    case 1:
      bytes.insert(at(where), static_cast<std::uint8_t>(kTelling[below(kTelling.size())]));
      break;
    case 2:
      if (room > 0) bytes.erase(at(where), at(where + 1 + below(std::min<std::size_t>(room, 16))));
      break;
    case 3:
      if (room > 0) {
        const std::size_t n = 1 + below(std::min<std::size_t>(room, 64));
        const Bytes part(at(where), at(where + n));
        bytes.insert(at(below(bytes.size() + 1)), part.begin(), part.end());
      }
      break;
    default: {
      const Bytes& other = seeds[below(seeds.size())];
      if (other.empty()) break;
      const std::size_t from = below(other.size());
      const std::size_t n = 1 + below(std::min<std::size_t>(other.size() - from, 64));
      bytes.insert(at(where), other.begin() + static_cast<std::ptrdiff_t>(from),
                   other.begin() + static_cast<std::ptrdiff_t>(from + n));
    }
  }
}

void give(const Bytes& bytes) { LLVMFuzzerTestOneInput(bytes.data(), bytes.size()); }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FOLDER ROUNDS\n", argv[0]);
    return 2;
  }
  const std::vector<Bytes> seeds = seeds_of(argv[1]);
  for (const Bytes& seed : seeds) give(seed);
  std::mt19937 random(20261121);
  const int rounds = std::atoi(argv[2]);
  for (int round = 0; round < rounds; ++round) {
    // The first seed is empty and is given once.
    Bytes bytes = seeds[seeds.size() == 1 ? 0 : 1 + random() % (seeds.size() - 1)];
    for (std::size_t n = 1 + random() % 8; n > 0; --n) change(bytes, seeds, random);
    give(bytes);
  }
  std::printf("%zu seeds and %d changed inputs\n", seeds.size(), rounds);
  return 0;
}
