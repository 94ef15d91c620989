// SPDX-License-Identifier: MIT
#include "core/curvature/assembly.hpp"

#include <cmath>

#include "core/text/text_sink.hpp"

namespace popcut {

Point3 Assembly::centre() const { return {r * std::cos(phi_rad), 0.0, r * std::sin(phi_rad)}; }

std::array<Point3, 4> Assembly::ring() const {
  return {Point3{lambda, 1.0, 1.0 + lambda}, Point3{1.0, -1.0, 2.0},
          Point3{1.0 + lambda, -1.0, lambda}, Point3{2.0, 1.0, 1.0}};
}

VertexCurvature curvature_of(const Assembly& assembly) {
  return vertex_curvature(assembly.centre(), assembly.ring());
}

FundamentalForms forms_of(const Assembly& assembly) {
  return star_forms(assembly.centre(), assembly.ring());
}

AssemblyMaps assembly_maps(double phi_rad, const Samples& r, const Samples& lambda) {
  AssemblyMaps maps{r, lambda, {}, {}};
  maps.K.reserve(r.count * lambda.count);
  maps.H.reserve(r.count * lambda.count);
  for (std::size_t row = 0; row < lambda.count; ++row) {
    for (std::size_t column = 0; column < r.count; ++column) {
      const VertexCurvature c = curvature_of({r.at(column), lambda.at(row), phi_rad});
      maps.K.push_back(c.K);
      maps.H.push_back(c.H);
    }
  }
  return maps;
}

void write_assembly_csv(double phi_rad, const Samples& r, const Samples& lambda,
                        std::ostream& out) {
  TextSink text(out);
  text.put("r,lambda,K,H\n");
  for (std::size_t row = 0; row < lambda.count; ++row) {
    for (std::size_t column = 0; column < r.count; ++column) {
      const Assembly at{r.at(column), lambda.at(row), phi_rad};
      const VertexCurvature c = curvature_of(at);
      text(at.r, ",", at.lambda);
      for (const double value : {c.K, c.H}) {
        text.put(",");
        if (std::isfinite(value)) text.put(value);
      }
      text.put("\n");
    }
  }
}

}  // namespace popcut
