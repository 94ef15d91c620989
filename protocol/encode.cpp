// SPDX-License-Identifier: MIT
#include "protocol/encode.hpp"

#include "protocol/page_map.hpp"

namespace popcut {

Result<EncodedProgram> encode(const Toolpath& toolpath, const Machine& machine,
                              const Material& material, const JobOptions& options) {
  const Result<Dialect> dialect = dialect_of(machine);
  if (!dialect) return tl::unexpected(dialect.error());
  return *dialect == Dialect::Gpgl ? encode_gpgl(toolpath, machine, material, options)
                                   : encode_hpgl(toolpath, machine, material, options);
}

}  // namespace popcut
