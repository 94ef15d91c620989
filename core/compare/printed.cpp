// SPDX-License-Identifier: MIT
#include "core/compare/printed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/compare/raster.hpp"

namespace popcut::likeness {
namespace {

constexpr double kShade = 0.6;       ///< of a colour, what depends on the lamp
constexpr double kFinerPrint = 2.0;  ///< pixels of the print along each pixel of a view
constexpr Rgb kClay{204, 160, 130}, kBare{255, 255, 255};
constexpr float kMostDifference = 100.0F;
constexpr double kGood = 0.16, kFair = 0.26;

/// CIE L*a*b* of a colour of sRGB under D65 (CIE 15:2004; IEC 61966-2-1), darkened by `light`.
std::array<float, 3> lab_of(const Rgb& rgb, double light) {
  std::array<double, 3> linear{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double c = light * rgb[k] / 255.0;
    linear[k] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  const auto f = [](double t) {
    constexpr double kKnee = 6.0 / 29.0;
    return t > kKnee * kKnee * kKnee ? std::cbrt(t) : t / (3.0 * kKnee * kKnee) + 4.0 / 29.0;
  };
  const double x = f((0.4124 * linear[0] + 0.3576 * linear[1] + 0.1805 * linear[2]) / 0.9505),
               y = f(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]),
               z = f((0.0193 * linear[0] + 0.1192 * linear[1] + 0.9505 * linear[2]) / 1.089);
  return {static_cast<float>(116.0 * y - 16.0), static_cast<float>(500.0 * (x - y)),
          static_cast<float>(200.0 * (y - z))};
}

Vec3 corner_of(Triangles triangles, std::size_t corner) {
  const auto at = [&](std::size_t k) { return static_cast<double>(triangles[3 * corner + k]); };
  return {at(0), at(1), at(2)};
}

/// The side on which the triangles of a panel run counter-clockwise, as long as twice their area.
Vec3 outward_of(Triangles triangles) {
  Vec3 out(0, 0, 0);
  for (std::size_t c = 0; c + 2 < triangles.size() / 3; c += 3) {
    const Vec3 a = corner_of(triangles, c);
    out += cross(Vec3(corner_of(triangles, c + 1) - a), Vec3(corner_of(triangles, c + 2) - a));
  }
  return out;
}

/// How much light falls on a triangle, both sides as the one that looks along the diagonal.
double light_on(Triangles triangle) {
  Vec3 normal = outward_of(triangle);
  const double length = norm(normal);
  if (!(length > 0.0)) return 1.0 - kShade;
  normal = (1.0 / length) * normal;
  if (normal.x() + normal.z() < 0.0) normal = -1.0 * normal;
  const Vec3 lamp = unit(Vec3(0.5, -0.4, 0.8));  // above, to the left and in front
  return 1.0 - kShade + kShade * std::max(0.0, dot(normal, lamp));
}

/// Pixels of an image beside which there is nothing.
void find_outline(const DepthImage& image, ContourPixels& out) {
  find_contours(image, std::numeric_limits<float>::max(), out);
}

}  // namespace

Looks looks(const PrintedFigures& figures) {
  return figures.error() <= kGood   ? Looks::Good
         : figures.error() <= kFair ? Looks::Fair
                                    : Looks::Poor;
}

const char* name_of(Looks looks) {
  return looks == Looks::Good ? "good" : looks == Looks::Fair ? "fair" : "poor";
}

PrintedTarget::PrintedTarget(Triangles triangles, std::span<const Rgb> colours, const Scene& scene)
    : triangles_(triangles), scene_(scene), box_(box_of(triangles)), diagonal_mm_(box_.diagonal()) {
  scene_.pixels = std::clamp(scene_.pixels, kLeastPixels, kMostPixels);
  if (box_.empty() || !(diagonal_mm_ > 0.0) || !std::isfinite(diagonal_mm_)) return;
  lit_.resize(triangles.size() / 9);
  for (std::size_t t = 0; t < lit_.size(); ++t)
    lit_[t] = lab_of(colours.empty() ? kClay : colours[t], light_on(triangles.subspan(9 * t, 9)));
  const int finer = std::min(kMostPixels, static_cast<int>(kFinerPrint * scene_.pixels));
  print_ = seen_from(view_from(Vec3(1, 0, 1)), finer, triangles, lit_);
  for (const View& view : scene_.views)
    seen_.push_back(seen_from(view, scene_.pixels, triangles, lit_));
  for (Seen& seen : seen_) {
    for (const float depth : seen.image.depth) pixels_ += depth != kNothing ? 1 : 0;
    find_outline(seen.image, seen.outline);
    seen.distances.measure(scene_.pixels, seen.outline);
  }
}

double PrintedTarget::detail() const {
  constexpr float kBorder = 12.0F;  // of L*a*b*: more than from facet to facet of a ball
  std::size_t edges = 0;
  ContourPixels jumps;
  std::vector<char> is_edge;
  for (const Seen& seen : seen_) {
    const auto size = static_cast<std::size_t>(seen.frame.pixels);
    find_contours(seen.image, static_cast<float>(kWithin * diagonal_mm_), jumps);
    is_edge.assign(size * size, 0);
    for (const std::uint32_t pixel : jumps.pixels) is_edge[pixel] = 1;
    const auto differs = [&](std::size_t a, std::size_t b) {
      if (seen.image.depth[a] == kNothing || seen.image.depth[b] == kNothing) return false;
      float sum = 0.0F;
      for (std::size_t i = 0; i < 3; ++i) {
        const float by = seen.colour[a][i] - seen.colour[b][i];
        sum += by * by;
      }
      return sum > kBorder * kBorder && is_edge[b] == 0;
    };
    for (std::size_t row = 0; row + 1 < size; ++row)
      for (std::size_t column = 0; column + 1 < size; ++column) {
        const std::size_t at = row * size + column;
        if (is_edge[at] == 0 && (differs(at, at + 1) || differs(at, at + size))) is_edge[at] = 1;
      }
    edges += static_cast<std::size_t>(std::count(is_edge.begin(), is_edge.end(), char{1}));
  }
  if (seen_.empty()) return 0.0;
  return static_cast<double>(edges) * kSide / static_cast<double>(seen_.size()) / scene_.pixels;
}

template <typename IsBetter>
PrintedTarget::Seen PrintedTarget::painted(const Frame& frame, Triangles triangles,
                                           std::span<const Lab> colours,
                                           const IsBetter& is_better) const {
  Seen out;
  out.frame = frame;
  const auto width = static_cast<std::size_t>(frame.pixels);
  out.image.pixels = frame.pixels;
  out.image.depth.assign(width * width, kNothing);
  out.colour.assign(width * width, Lab{});
  const Raster raster(out.frame);
  for (std::size_t t = 0; t < colours.size(); ++t)
    raster.each_span(
        triangles.subspan(9 * t, 9), [&](std::size_t row, std::size_t first, std::size_t last,
                                         float at, float slope, float low, float high, int) {
          for (std::size_t x = first; x <= last; ++x) {
            const float here =
                std::clamp(at + slope * static_cast<float>(static_cast<int>(x - first)), low, high);
            float& depth = out.image.depth[row * width + x];
            if (!is_better(here, depth, x)) continue;
            depth = here;
            out.colour[row * width + x] = colours[t];
          }
        });
  return out;
}

Frame PrintedTarget::frame_of(const View& view, int pixels) const {
  return {view, box_.centre(), kSide * diagonal_mm_, pixels};
}

PrintedTarget::Seen PrintedTarget::seen_from(const View& view, int pixels, Triangles triangles,
                                             std::span<const Lab> colours) const {
  Seen out = painted(frame_of(view, pixels), triangles, colours,
                     [](float here, float before, std::size_t) { return here > before; });
  if (scene_.corner) draw(out.frame, *scene_.corner, out.backdrop);
  hide_behind(out.backdrop, kTouch * diagonal_mm_, out.image);
  return out;
}

Vec3 PrintedTarget::fallen(const PrintedLayer& layer, const Vec3& place) const {
  // As high as it is seen, so that all of the target is within the frame.
  const Vec3 centre = box_.centre();
  const double longer = std::hypot(1.0, layer.fall);
  return {place.x(), place.y(),
          centre.z() + (place.z() - centre.z() - layer.fall * (place.x() - centre.x())) / longer};
}

PrintedTarget::Seen PrintedTarget::print_of(const PrintedLayer& layer) const {
  const int pixels = std::min(kMostPixels, static_cast<int>(kFinerPrint * scene_.pixels));
  const double pitch = kSide * diagonal_mm_ / pixels;
  // Of two places on a ray, the one with the larger rank is shown, then the larger `at`.
  const auto is_better = [&](float here, float before, std::size_t column) {
    const double y = box_.centre().y() + pitch * (static_cast<double>(column) + 0.5 - 0.5 * pixels);
    const double nearer = box_.centre().x() + layer.bend * std::abs(y);
    const auto rank = [&](float depth) {
      const double x = static_cast<double>(depth) + nearer;
      return x < layer.far_mm ? 0 : x >= layer.near_mm ? 1 : 2;
    };
    if (before == kNothing || rank(here) != rank(before))
      return before == kNothing || rank(here) > rank(before);
    return rank(here) == 1 ? here < before : here > before;
  };
  std::vector<float> moved;
  moved.reserve(triangles_.size());
  for (std::size_t k = 0; k + 2 < triangles_.size(); k += 3) {
    const Vec3 at =
        fallen(layer, {static_cast<double>(triangles_[k]), static_cast<double>(triangles_[k + 1]),
                       static_cast<double>(triangles_[k + 2])});
    for (const double of : {at.x(), at.y(), at.z()}) moved.push_back(static_cast<float>(of));
  }
  return painted(frame_of(view_from(Vec3(1, 0, 0)), pixels), moved, lit_, is_better);
}

PrintedTarget::Seen PrintedTarget::print_of(const PrintedPanel& panel) const {
  const Box around = box_of(panel.triangles);
  if (panel.near_mm < 0.0 || around.empty()) return {};
  // Only as large as the panel, as fine as the prints of all of the target.
  const double fine_mm = kSide * diagonal_mm_ / (kFinerPrint * scene_.pixels);
  Frame frame{view_from(outward_of(panel.triangles)), around.centre(),
              std::max(around.diagonal(), kLeastPixels * fine_mm), kLeastPixels};
  frame.pixels = static_cast<int>(
      std::clamp(frame.side_mm / fine_mm, double{kLeastPixels}, double{kMostPixels}));
  const double plane_mm = dot(frame.view.toward, corner_of(panel.triangles, 0) - frame.centre);
  const auto is_near = [&](float depth) {
    return std::abs(static_cast<double>(depth) - plane_mm) <= panel.near_mm;
  };
  return painted(frame, triangles_, lit_, [&](float here, float before, std::size_t) {
    if (before == kNothing || is_near(here) != is_near(before))
      return before == kNothing || is_near(here);
    if (is_near(here)) return here > before;
    return std::abs(static_cast<double>(here) - plane_mm) <
           std::abs(static_cast<double>(before) - plane_mm);
  });
}

const PrintedTarget::Lab* PrintedTarget::printed_at(const Seen& print, const Vec3& place) {
  const Frame& frame = print.frame;
  const Vec3 from = place - frame.centre;
  const auto at = [&](double mm) {
    return static_cast<std::int64_t>(std::floor((mm + 0.5 * frame.side_mm) / frame.pitch_mm()));
  };
  const std::int64_t column = at(dot(from, frame.view.right)), row = at(dot(from, frame.view.up));
  if (column < 0 || row < 0 || column >= frame.pixels || row >= frame.pixels) return nullptr;
  const auto k = static_cast<std::size_t>(row * frame.pixels + column);
  return print.image.depth[k] == kNothing ? nullptr : &print.colour[k];
}

void PrintedTarget::draw_card(const Seen& seen, Triangles structure, DepthImage& image,
                              std::vector<Lab>& own) const {
  static const Lab bare = lab_of(kBare, 1.0);
  draw(seen.frame, structure, image);
  hide_behind(seen.backdrop, kTouch * diagonal_mm_, image);
  const Frame& frame = seen.frame;
  const double pitch = frame.pitch_mm(), first = 0.5 * pitch - 0.5 * frame.side_mm;
  own.resize(image.depth.size());
  std::size_t p = 0;
  for (int row = 0; row < frame.pixels; ++row)
    for (int column = 0; column < frame.pixels; ++column, ++p) {
      const bool stands = image.depth[p] != kNothing;
      const float depth = stands                        ? image.depth[p]
                          : seen.backdrop.depth.empty() ? kNothing
                                                        : seen.backdrop.depth[p];
      if (depth == kNothing) continue;
      const Lab* const print =
          printed_at(print_, frame.centre + (first + pitch * column) * frame.view.right +
                                 (first + pitch * row) * frame.view.up +
                                 static_cast<double>(depth) * frame.view.toward);
      if (print != nullptr) image.depth[p] = depth;
      own[p] = print != nullptr ? *print : bare;
    }
}

template <typename Piece, typename PrintAt>
void PrintedTarget::draw_pieces(const Seen& seen, std::span<const Piece> pieces,
                                const PrintAt& print_at, DepthImage& image,
                                std::vector<Lab>& own) const {
  static const Lab bare = lab_of(kBare, 1.0);
  draw(seen.frame, Triangles{}, image);
  own.resize(image.depth.size());
  const Frame& frame = seen.frame;
  const double pitch = frame.pitch_mm(), first = 0.5 * pitch - 0.5 * frame.side_mm;
  DepthImage one;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    draw(frame, pieces[k].triangles, one);
    hide_behind(seen.backdrop, kTouch * diagonal_mm_, one);
    std::size_t p = 0;
    for (int row = 0; row < frame.pixels; ++row)
      for (int column = 0; column < frame.pixels; ++column, ++p) {
        if (!(one.depth[p] > image.depth[p])) continue;
        image.depth[p] = one.depth[p];
        const Lab* const print =
            print_at(k, Vec3(frame.centre + (first + pitch * column) * frame.view.right +
                             (first + pitch * row) * frame.view.up +
                             static_cast<double>(one.depth[p]) * frame.view.toward));
        own[p] = print != nullptr ? *print : bare;
      }
  }
}

PrintedFigures PrintedTarget::measure(Triangles structure, Buffers& buffers) const {
  return compared(buffers, [&](const Seen& seen, DepthImage& image, std::vector<Lab>& own) {
    draw_card(seen, structure, image, own);
  });
}

PrintedFigures PrintedTarget::measure_layers(std::span<const PrintedLayer> layers) const {
  std::vector<Seen> prints;
  prints.reserve(layers.size());
  for (const PrintedLayer& layer : layers) prints.push_back(print_of(layer));
  Buffers buffers;
  return compared(buffers, [&](const Seen& seen, DepthImage& image, std::vector<Lab>& own) {
    draw_pieces(
        seen, layers,
        [&](std::size_t k, Vec3 place) {
          place.x() += layers[k].raised * std::abs(place.y());
          return printed_at(prints[k], fallen(layers[k], place));
        },
        image, own);
  });
}

PrintedFigures PrintedTarget::measure_panels(std::span<const PrintedPanel> panels) const {
  std::vector<Seen> prints;
  prints.reserve(panels.size());
  for (const PrintedPanel& panel : panels) prints.push_back(print_of(panel));
  Buffers buffers;
  return compared(buffers, [&](const Seen& seen, DepthImage& image, std::vector<Lab>& own) {
    draw_pieces(
        seen, panels,
        [&](std::size_t k, const Vec3& place) {
          const Seen& print = prints[k];
          const bool shows =
              print.frame.pixels > 0 && dot(print.frame.view.toward, seen.frame.view.toward) > 0.0;
          return shows ? printed_at(print, place) : nullptr;
        },
        image, own);
  });
}

template <typename Draw>
PrintedFigures PrintedTarget::compared(Buffers& buffers, const Draw& draw_own) const {
  PrintedFigures out;
  double difference = 0.0;
  std::size_t common = 0;
  std::vector<Lab> own;
  for (const Seen& seen : seen_) {
    draw_own(seen, buffers.image, own);
    for (std::size_t p = 0; p < own.size(); ++p) {
      if (buffers.image.depth[p] == kNothing || seen.image.depth[p] == kNothing) continue;
      ++common;
      const Lab &here = own[p], &there = seen.colour[p];
      difference += static_cast<double>(std::min(
          kMostDifference, std::hypot(here[0] - there[0], here[1] - there[1], here[2] - there[2])));
    }
    find_outline(buffers.image, buffers.contours);
    const bool none = seen.outline.pixels.empty(), none_own = buffers.contours.pixels.empty();
    double contour = none != none_own ? 1.0 : 0.0;
    if (!none && !none_own) {
      buffers.distances.measure(scene_.pixels, buffers.contours);
      const double most = diagonal_mm_ / seen.frame.pitch_mm();
      contour = 0.5 *
                (mean_distance(seen.outline, buffers.distances, most) +
                 mean_distance(buffers.contours, seen.distances, most)) /
                most;
    }
    out.contour += contour / static_cast<double>(seen_.size());
  }
  out.colour = common > 0 ? difference / static_cast<double>(common) / 100.0 : 1.0;
  out.cover = pixels_ > 0 ? static_cast<double>(common) / static_cast<double>(pixels_) : 0.0;
  return out;
}

}  // namespace popcut::likeness
