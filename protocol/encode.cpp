// SPDX-License-Identifier: MIT
#include "protocol/encode.hpp"

#include <string>

#include "protocol/decode.hpp"

#include "protocol/page_map.hpp"

namespace popcut {

Result<EncodedProgram> encode(const Toolpath& toolpath, const Machine& machine,
                              const Material& material, const JobOptions& options) {
  const Result<Dialect> dialect = dialect_of(machine);
  if (!dialect) return tl::unexpected(dialect.error());
  return *dialect == Dialect::Gpgl ? encode_gpgl(toolpath, machine, material, options)
                                   : encode_hpgl(toolpath, machine, material, options);
}

Result<EncodedProgram> frame_of(const Box& box, const Machine& machine, const Material& material,
                                JobOptions options) {
  Toolpath path;
  path.points = {
      {box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}, {box.x0, box.y0}};
  Stroke stroke{.operation = Operation::Draw, .count = 5};
  stroke.force_gf = material.draw.force_gf;
  stroke.speed_mm_s = material.draw.speed_mm_s;
  path.strokes.push_back(stroke);
  options.draw = DrawForm::Text;
  options.autoblade = false;
  options.fractions = false;
  options.marks.reset();
  options.feed_out_mm.reset();
  auto program = encode(path, machine, material, options);
  if (!program) return program;
  const auto drawn = [&]() -> Result<Program> {
    return decode(program->dialect, program->view(program->geometry));
  };
  const Result<Program> lines = drawn();
  if (!lines) return tl::unexpected(lines.error());
  for (const Command& command : lines->commands) {
    char* const word = &program->bytes[program->geometry.begin + command.begin];
    if (command.end - command.begin > 1 && word[0] == 'P' && word[1] == 'D')
      word[1] = 'U';
    else if (word[0] == 'D')
      word[0] = machine.language == "gpgl" || machine.variant.find("camm") != std::string::npos
                    ? 'M'
                    : 'U';
  }
  const Result<Program> moves = drawn();
  if (!moves) return tl::unexpected(moves.error());
  for (const Command& command : moves->commands)
    if (command.verb == Verb::Draw || command.verb == Verb::Unknown)
      return fail(ErrorKind::Internal, "", "the way round the sheet has a line with the tool down");
  return program;
}

}  // namespace popcut
