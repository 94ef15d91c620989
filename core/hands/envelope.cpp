// SPDX-License-Identifier: MIT
#include "core/hands/envelope.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace popcut::hands {
namespace {

struct NamedSize {
  const char* name;
  double wide_mm, high_mm;
};
constexpr double kInch_mm = 25.4;
constexpr std::array<NamedSize, 7> kNamed{{{"a2", 5.75 * kInch_mm, 4.375 * kInch_mm},
                                           {"a6", 6.5 * kInch_mm, 4.75 * kInch_mm},
                                           {"a7", 7.25 * kInch_mm, 5.25 * kInch_mm},
                                           {"5x7", 7.25 * kInch_mm, 5.25 * kInch_mm},
                                           {"dl", 220.0, 110.0},
                                           {"c6", 162.0, 114.0},
                                           {"c5", 229.0, 162.0}}};

/// The least outside that holds a card, the longer side first.
std::array<double, 2> least_mm(const ShutCard& card) {
  const double around = kEase_mm + card.stack_mm;
  return {std::max(card.along_mm, card.out_mm) + around,
          std::min(card.along_mm, card.out_mm) + around};
}

/// Builds a net from faces by their corners, u to the right and v up.
class Net {
 public:
  explicit Net(std::string name) {
    out_.name = std::move(name);
    out_.card = false;
    out_.face_first = {0};
  }

  using Corners = std::vector<std::array<double, 2>>;

  void face(const Corners& corners) {
    const auto number = static_cast<std::int32_t>(out_.faces());
    std::vector<std::uint32_t> at;
    at.reserve(corners.size());
    for (const auto& p : corners) at.push_back(vertex(p));
    for (std::size_t k = 0; k < at.size(); ++k) {
      const std::uint32_t from = at[k], to = at[(k + 1) % at.size()];
      out_.face_vertices.push_back(from);
      const auto twin =
          std::find_if(out_.edges.begin(), out_.edges.end(),
                       [&](const PatternEdge& e) { return e.from == to && e.to == from; });
      if (twin != out_.edges.end())
        twin->right = number, twin->role = EdgeRole::Mountain;
      else
        out_.edges.push_back({from, to, number, -1, EdgeRole::Outline});
    }
    out_.face_first.push_back(static_cast<std::uint32_t>(out_.face_vertices.size()));
  }

  /// An upright rectangle.
  void box(double u0, double v0, double u1, double v1) {
    face({{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}});
  }

  /// Its sheet begins at (0, 0).
  Pattern taken() {
    std::array<double, 2> low{1e9, 1e9}, high{-1e9, -1e9};
    for (const PatternVertex& p : out_.vertices) {
      low = {std::min(low[0], p.x), std::min(low[1], p.v)};
      high = {std::max(high[0], p.x), std::max(high[1], p.v)};
    }
    for (PatternVertex& p : out_.vertices) p.x -= low[0], p.v -= low[1];
    out_.ground_mm = high[0] - low[0], out_.width_mm = high[1] - low[1];
    for (const PatternEdge& e : out_.edges) {
      const PatternVertex &a = out_.vertices[e.from], &b = out_.vertices[e.to];
      out_.lines.push_back({a.x, a.v, b.x, b.v, e.role});
    }
    return std::move(out_);
  }

 private:
  std::uint32_t vertex(const std::array<double, 2>& p) {
    constexpr double kSame_mm = 1e-9;
    for (std::uint32_t k = 0; k < out_.vertices.size(); ++k)
      if (std::abs(out_.vertices[k].x - p[0]) < kSame_mm &&
          std::abs(out_.vertices[k].v - p[1]) < kSame_mm)
        return k;
    out_.vertices.push_back({p[0], 0.0, p[1]});
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }

  Pattern out_;
};

}  // namespace

Result<std::array<double, 2>> envelope_mm(std::string_view asked, const ShutCard& card) {
  const std::array<double, 2> least = least_mm(card);
  std::string word(asked);
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (word == "fit") return least;
  std::array<double, 2> size{};
  const auto* const named = std::find_if(kNamed.begin(), kNamed.end(),
                                         [&](const NamedSize& one) { return word == one.name; });
  if (named != kNamed.end()) {
    size = {named->wide_mm, named->high_mm};
  } else {
    const std::size_t x = word.find('x');
    const auto number = [](std::string_view text, double& mm) {
      const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), mm);
      return fault == std::errc() && end == text.data() + text.size() && mm >= 20.0 && mm <= 2000.0;
    };
    if (x == std::string::npos || !number(std::string_view(word).substr(0, x), size[0]) ||
        !number(std::string_view(word).substr(x + 1), size[1]))
      return fail(ErrorKind::Usage, "--envelope",
                  fmt::format("is \"{}\"; give fit, A2, A6, A7, 5x7, DL, C6, C5, or width and "
                              "height in mm from 20 to 2000, such as 120x170",
                              asked.substr(0, 40)));
  }
  if (size[0] < size[1]) std::swap(size[0], size[1]);
  constexpr double kRounding_mm = 1e-6;
  if (size[0] + kRounding_mm < least[0] || size[1] + kRounding_mm < least[1])
    return fail(ErrorKind::Infeasible, "--envelope",
                fmt::format("{} is {:.1f} x {:.1f} mm; the shut card, {:.1f} mm high, needs at "
                            "least {:.1f} x {:.1f} mm",
                            asked, size[0], size[1], card.stack_mm, least[0], least[1]));
  return size;
}

Pattern envelope(const ShutCard& card, std::array<double, 2> outside_mm) {
  const double wide = outside_mm[0], high = outside_mm[1];
  const double wall = card.stack_mm > kFlat_mm ? card.stack_mm : 0.0;
  const double back = 0.7 * high, over = 15.0, side = std::min(20.0, 0.3 * wide);
  const double slant = 0.25 * side;
  Net net("envelope");
  net.box(0, 0, wide, high);
  double below = 0.0, above = high, left = 0.0, right = wide;
  if (wall > 0.0) {
    net.box(0, -wall, wide, 0), net.box(0, high, wide, high + wall);
    net.box(-wall, 0, 0, high), net.box(wide, 0, wide + wall, high);
    below -= wall, above += wall, left -= wall, right += wall;
  }
  // A little narrower than what it lies on, so that nothing sticks out.
  constexpr double kIn_mm = 1.0;
  net.face({{0, below}, {kIn_mm, below - back}, {wide - kIn_mm, below - back}, {wide, below}});
  const double close = high - back + over;
  net.face(
      {{0, above}, {wide, above}, {wide - 0.2 * wide, above + close}, {0.2 * wide, above + close}});
  net.face({{left, 0}, {left, high}, {left - side, high - slant}, {left - side, slant}});
  net.face({{right, 0}, {right + side, slant}, {right + side, high - slant}, {right, high}});
  return net.taken();
}

Pattern cover(const ShutCard& card) {
  const double board = card.out_mm + kPast_mm, high = card.along_mm + 2.0 * kPast_mm;
  const double back = std::max(card.stack_mm, 0.0);
  Net net("cover");
  net.box(0, 0, board, high);
  if (back > kFlat_mm) {
    net.box(board, 0, board + back, high);
    net.box(board + back, 0, 2.0 * board + back, high);
  } else {
    net.box(board, 0, 2.0 * board, high);
  }
  return net.taken();
}

}  // namespace popcut::hands
