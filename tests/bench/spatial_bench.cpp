// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <catch2/catch.hpp>

#include "core/geometry/node_index.hpp"
#include "core/geometry/point_tree.hpp"
#include "core/geometry/segment_grid.hpp"

using namespace popcut;

namespace {

namespace bg = boost::geometry;
namespace bgi = boost::geometry::index;
using Point = bg::model::d2::point_xy<double>;
using BoostBox = bg::model::box<Point>;
using BoxOf = std::pair<BoostBox, std::uint32_t>;
using PointOf = std::pair<Point, std::uint32_t>;
using Split = bgi::quadratic<16>;

constexpr double kPage_mm = 500.0;
constexpr std::size_t kCount = 100'000;

/// Short lines all over a page, as drawings have them.
std::vector<Segment> drawing() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, kPage_mm), way(-2.0, 2.0);
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < kCount; ++i) {
    const PagePoint a{place(random), place(random)};
    segments.push_back({a, {a.x + way(random), a.y + way(random)}});
  }
  return segments;
}

std::vector<PagePoint> points() {
  std::vector<PagePoint> all;
  for (const Segment& s : drawing()) all.push_back(s.a);
  return all;
}

BoostBox around(const Segment& s, double reach) {
  return {{std::min(s.a.x, s.b.x) - reach, std::min(s.a.y, s.b.y) - reach},
          {std::max(s.a.x, s.b.x) + reach, std::max(s.a.y, s.b.y) + reach}};
}

double seconds(const std::function<std::size_t()>& work, std::size_t& sum) {
  double best = 1e9;
  for (int round = 0; round < 5; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    sum = work();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

void compare(const char* use, const std::function<std::size_t()>& ours,
             const std::function<std::size_t()>& rtree) {
  std::size_t a = 0, b = 0;
  const double own_s = seconds(ours, a), boost_s = seconds(rtree, b);
  WARN(fmt::format("{}: ours {:.1f} ms, rtree {:.1f} ms, {:.2f} times as long (found {} and {})",
                   use, 1e3 * own_s, 1e3 * boost_s, boost_s / own_s, a, b));
}

}  // namespace

TEST_CASE("the indexes of core/geometry beside Boost.Geometry's rtree", "[.][bench][spatial]") {
  const std::vector<Segment> segments = drawing();
  const std::vector<PagePoint> all = points();
  constexpr double kReach = 0.1;
  compare(
      "segments near a segment, built at once (planar graph, loops, seams, expectation)",
      [&] {
        SegmentGrid grid(segments, kReach);
        std::vector<std::uint32_t> near;
        std::size_t sum = 0;
        for (const Segment& s : segments) {
          grid.near(s, near);
          sum += near.size();
        }
        return sum;
      },
      [&] {
        std::vector<BoxOf> boxes;
        for (std::uint32_t i = 0; i < segments.size(); ++i)
          boxes.emplace_back(around(segments[i], 0.0), i);
        const bgi::rtree<BoxOf, Split> tree(boxes);
        std::size_t sum = 0;
        for (const Segment& s : segments)
          for (auto at = tree.qbegin(bgi::intersects(around(s, kReach))); at != tree.qend(); ++at)
            ++sum;
        return sum;
      });
  compare(
      "ends that become one node, one after the other (clean, loops, FOLD's drawings)",
      [&] {
        NodeIndex nodes(kReach, all.size());
        for (const PagePoint& p : all)
          if (nodes.find(p, kReach) == NodeIndex::kNone) nodes.add(p);
        return nodes.size();
      },
      [&] {
        bgi::rtree<PointOf, Split> tree;
        for (const PagePoint& p : all) {
          const Point at(p.x, p.y);
          auto near = tree.qbegin(bgi::nearest(at, 1));
          if (near == tree.qend() || bg::distance(near->first, at) > kReach)
            tree.insert({at, static_cast<std::uint32_t>(tree.size())});
        }
        return tree.size();
      });
  compare(
      "the five nearest ends of each end (order)",
      [&] {
        std::vector<std::uint32_t> tags(all.size());
        for (std::uint32_t i = 0; i < tags.size(); ++i) tags[i] = i;
        const PointTree tree(all, tags);
        PointTree::NearList near(5);
        std::size_t sum = 0;
        for (std::uint32_t i = 0; i < all.size(); ++i)
          tree.nearest(i, near, [](std::uint32_t) { return true; }), sum += near.all().size();
        return sum;
      },
      [&] {
        std::vector<PointOf> ends;
        for (std::uint32_t i = 0; i < all.size(); ++i)
          ends.emplace_back(Point(all[i].x, all[i].y), i);
        const bgi::rtree<PointOf, Split> tree(ends);
        std::vector<PointOf> near;
        std::size_t sum = 0;
        for (std::uint32_t i = 0; i < all.size(); ++i) {
          near.clear();
          tree.query(bgi::nearest(ends[i].first, 6), std::back_inserter(near));
          sum += near.size() - 1;  // itself
        }
        return sum;
      });
}
