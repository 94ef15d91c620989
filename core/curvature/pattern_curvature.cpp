// SPDX-License-Identifier: MIT
#include "core/curvature/pattern_curvature.hpp"

#include <algorithm>
#include <cmath>

#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

class RangeOf {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    range_.least = range_.count == 0 ? value : std::min(range_.least, value);
    range_.largest = range_.count == 0 ? value : std::max(range_.largest, value);
    sum_ += value;
    ++range_.count;
  }
  [[nodiscard]] CurvatureRange range() const {
    CurvatureRange out = range_;
    if (out.count > 0) out.mean = sum_ / static_cast<double>(out.count);
    return out;
  }

 private:
  CurvatureRange range_;
  double sum_{};
};

void put_or(TextSink& text, double value, std::string_view otherwise) {
  if (std::isfinite(value)) {
    text.put(value);
  } else {
    text.put(otherwise);
  }
}

}  // namespace

std::size_t inner_count(std::span<const FoldVertex> vertices) {
  return static_cast<std::size_t>(std::count_if(vertices.begin(), vertices.end(),
                                                [](const FoldVertex& p) { return p.inner(); }));
}

std::vector<PosedCurvature> pattern_curvature(std::span<const FoldVertex> vertices,
                                              double psi_rad) {
  std::vector<Point3> posed;
  posed.reserve(vertices.size());
  for (const FoldVertex& vertex : vertices) posed.push_back(vertex.posed(psi_rad));
  std::vector<PosedCurvature> out;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const FoldVertex& vertex = vertices[k];
    if (!vertex.inner()) continue;
    std::array<Point3, 4> ring;
    for (std::size_t n = 0; n < 4; ++n) ring[n] = posed[static_cast<std::size_t>(vertex.ring[n])];
    out.push_back({psi_rad, vertex.i, vertex.j, posed[k], vertex_curvature(posed[k], ring)});
  }
  return out;
}

PatternSummary summary_of(std::span<const PosedCurvature> values) {
  RangeOf K, K_area, H;
  for (const PosedCurvature& value : values) {
    K.add(value.curvature.K);
    K_area.add(value.curvature.K_area);
    H.add(value.curvature.H);
  }
  return {K.range(), K_area.range(), H.range()};
}

void write_curvature_csv(std::span<const FoldVertex> vertices, const Samples& psi_rad,
                         std::ostream& out) {
  TextSink text(out);
  text.put("psi,i,j,x,v,z,K,K_area,H,A\n");
  for (std::size_t pose = 0; pose < psi_rad.count; ++pose) {
    for (const PosedCurvature& p : pattern_curvature(vertices, psi_rad.at(pose))) {
      text(p.psi_rad, ",", p.i, ",", p.j);
      for (const double value : {p.at[0], p.at[1], p.at[2], p.curvature.K, p.curvature.K_area,
                                 p.curvature.H, p.curvature.A}) {
        text.put(",");
        put_or(text, value, "");
      }
      text.put("\n");
    }
  }
}

void write_curvature_json(std::span<const FoldVertex> vertices, const Samples& psi_rad,
                          std::ostream& out) {
  TextSink text(out);
  text("{\"vertices\": ", inner_count(vertices), ",\n\"poses\": [");
  for (std::size_t pose = 0; pose < psi_rad.count; ++pose) {
    text(pose == 0 ? "\n" : ",\n", "{\"psi_rad\": ", psi_rad.at(pose), ", \"values\": [");
    bool first = true;
    for (const PosedCurvature& p : pattern_curvature(vertices, psi_rad.at(pose))) {
      text(first ? "\n" : ",\n", "{\"i\": ", p.i, ", \"j\": ", p.j, ", \"at_mm\": [", p.at[0], ", ",
           p.at[1], ", ", p.at[2], "]");
      first = false;
      const std::pair<std::string_view, double> fields[] = {{"K", p.curvature.K},
                                                            {"K_area", p.curvature.K_area},
                                                            {"H", p.curvature.H},
                                                            {"A", p.curvature.A}};
      for (const auto& [name, value] : fields) {
        text(", \"", name, "\": ");
        put_or(text, value, "null");
      }
      text.put("}");
    }
    text.put("]}");
  }
  text.put("]}\n");
}

}  // namespace popcut
