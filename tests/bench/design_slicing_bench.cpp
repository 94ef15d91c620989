// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/target/mesh_slicer.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/model/model.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/timing.hpp"
#include "tests/support/value.hpp"

namespace design_slicing_bench {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// A sphere of about `triangles` triangles in `slices` slices, from the bytes of an STL to curves.
void slice_sphere(int triangles, int slices) {
  const int rings = static_cast<int>(std::sqrt(triangles / 2.0));
  const std::string stl = testing::binary_stl(testing::sphere_mesh(100.0, rings, rings));
  TriangleMesh mesh;
  const double read = seconds_of([&] { mesh = value(read_mesh("sphere.stl", stl)); });
  const std::size_t count = mesh.size();
  const double planes = seconds_of([&] {
    const MeshSlicer slicer(mesh);
    std::size_t segments = 0;
    for (int j = 0; j < slices; ++j) segments += slicer.cut(95.0 * j / slices).segments.size();
    REQUIRE(segments > 0);
  });
  double error = 0.0;
  const double curves = seconds_of([&] {
    const auto surface = value(surface_of_triangles(std::move(mesh), FitMode::Exact, "mesh", true));
    for (int j = 0; j < slices; ++j) {
      const double s = 95.0 * j / slices;
      const auto cut = value(surface.cut(s));
      const CurveJet p = cut.curve.at(0.1);
      error = std::max(error, std::abs(std::hypot(p.x, s, p.z) - 100.0));
    }
  });
  fmt::print(
      "{} triangles in {} slices: read {:.2f} s, sorted and cut {:.2f} s, sorted, cut and fitted "
      "{:.2f} s; off the sphere by {:.2g} mm; peak {} MB\n",
      count, slices, read, planes, curves, error, peak_mb());
}

}  // namespace

TEST_CASE("slicing a mesh of a million triangles", "[bench]") { slice_sphere(1'000'000, 200); }
TEST_CASE("slicing a mesh of nearly ten million triangles", "[bench]") {
  slice_sphere(9'900'000, 200);
}

}  // namespace design_slicing_bench
