// SPDX-License-Identifier: MIT
#include "daemon/cli/view/around_card.hpp"

#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "core/formats/write/pattern_files.hpp"

namespace popcut::cli {
namespace envelope_parts {
namespace {

Result<std::string> add_net(const Pattern& net, const std::function<bool(std::string_view)>& wants,
                            OutputFolder& folder) {
  std::string names;
  for (const auto& [ending, write] :
       {std::pair("svg", &write_pattern_svg), std::pair("dxf", &write_pattern_dxf)}) {
    if (std::string_view(ending) == "dxf" && !wants("dxf")) continue;
    const std::string name = fmt::format("{}.{}", net.name, ending);
    std::ostringstream out;
    write(net, out);
    if (auto done = folder.add(name, std::move(out).str()); !done)
      return tl::unexpected(done.error());
    names += " " + name;
  }
  return names;
}

}  // namespace
}  // namespace envelope_parts

Result<void> AroundCard::check() const {
  if (envelope.empty()) return {};
  const auto size = hands::envelope_mm(envelope, {1.0, 1.0, 0.0});
  if (!size) return tl::unexpected(size.error());
  return {};
}

Result<std::string> add_envelope_files(const AroundCard& around, const hands::ShutCard& card,
                                       const std::function<bool(std::string_view)>& wants,
                                       OutputFolder& folder) {
  std::string names;
  if (!around.envelope.empty()) {
    const auto size = hands::envelope_mm(around.envelope, card);
    if (!size) return tl::unexpected(size.error());
    auto files = envelope_parts::add_net(hands::envelope(card, *size), wants, folder);
    if (!files) return files;
    names += *files;
  }
  if (!around.cover) return names;
  auto files = envelope_parts::add_net(hands::cover(card), wants, folder);
  if (!files) return files;
  return names + *files;
}

std::string envelope_words(const AroundCard& around, const hands::ShutCard& card) {
  const auto size =
      around.envelope.empty() ? tl::unexpected(Error{}) : hands::envelope_mm(around.envelope, card);
  if (!size) return {};
  return fmt::format(
      "  envelope {:.0f} x {:.0f} mm; shut, the card is {:.0f} x {:.0f} mm and {:.1f} mm high\n",
      (*size)[0], (*size)[1], card.along_mm, card.out_mm, card.stack_mm);
}

}  // namespace popcut::cli
