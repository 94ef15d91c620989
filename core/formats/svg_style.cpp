// SPDX-License-Identifier: MIT
#include "core/formats/svg_style.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/formats/svg_scan.hpp"

namespace popcut {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  return text;
}

std::vector<double> dash_list(std::string_view text) {
  std::vector<double> dashes;
  SvgScan scan(text);
  double value = 0.0;
  while (dashes.size() < 64 && scan.number_follows() && scan.number(value)) {
    (void)scan.word();  // "px" and the like
    dashes.push_back(value);
  }
  const bool lawful = std::all_of(dashes.begin(), dashes.end(), [](double d) { return d >= 0.0; });
  if (!lawful || std::accumulate(dashes.begin(), dashes.end(), 0.0) <= 0.0) return {};
  if (dashes.size() % 2 == 1) {
    const std::vector<double> once = dashes;
    dashes.insert(dashes.end(), once.begin(), once.end());
  }
  return dashes;
}

void set(SvgStyle& style, std::string_view name, std::string_view value) {
  value = trimmed(value);
  if (value == "inherit" || value.empty()) return;
  if (name == "stroke") style.stroke = lower(value);
  if (name == "fill") style.fill = lower(value);
  if (name == "display") style.display_none = value == "none";
  if (name == "visibility") style.hidden = value == "hidden" || value == "collapse";
  if (name == "stroke-dasharray") style.dashes = dash_list(value);
  if (name == "stroke-dashoffset") {
    double offset = 0.0;
    if (SvgScan(value).number(offset)) style.dash_offset = offset;
  }
}

// What a word of an assignment or a layer means: an operation, nothing ("-"), or unknown.
struct Meaning {
  bool known{};
  std::optional<Operation> operation;
};

Meaning meaning_of(const std::string& word) {
  constexpr std::array<std::pair<std::string_view, int>, 25> kWords{{{"m", 2},
                                                                     {"mountain", 2},
                                                                     {"fold-mountain", 2},
                                                                     {"mountain-fold", 2},
                                                                     {"v", 3},
                                                                     {"valley", 3},
                                                                     {"fold-valley", 3},
                                                                     {"valley-fold", 3},
                                                                     {"c", 4},
                                                                     {"cut", 4},
                                                                     {"slit", 4},
                                                                     {"cuts", 4},
                                                                     {"slits", 4},
                                                                     {"b", 5},
                                                                     {"outline", 5},
                                                                     {"border", 5},
                                                                     {"boundary", 5},
                                                                     {"mark", 0},
                                                                     {"draw", 0},
                                                                     {"label", 0},
                                                                     {"score", 1},
                                                                     {"f", -1},
                                                                     {"u", -1},
                                                                     {"j", -1},
                                                                     {"ignore", -1}}};
  for (const auto& [name, kind] : kWords)
    if (word == name)
      return {true, kind < 0 ? std::nullopt : std::optional(static_cast<Operation>(kind))};
  return {};
}

std::optional<Operation> by_colour(const std::string& colour, SvgProfile profile) {
  if (colour == "#ff0000") return Operation::FoldMountain;
  if (colour == "#0000ff") return Operation::FoldValley;
  if (profile == SvgProfile::Lightburn) return Operation::Cut;
  if (colour == "#000000") return Operation::Outline;
  if (colour == "#00ff00" || colour == "#008000") return Operation::Cut;
  return std::nullopt;  // yellow, magenta and what Origami Simulator does not know
}

}  // namespace

SvgStyle style_of(const pugi::xml_node& node, const SvgStyle& inherited) {
  SvgStyle style = inherited;
  for (const char* name :
       {"stroke", "fill", "display", "visibility", "stroke-dasharray", "stroke-dashoffset"})
    if (const auto attribute = node.attribute(name)) set(style, name, attribute.value());
  std::string_view declarations = node.attribute("style").value();
  while (!declarations.empty()) {
    const std::size_t end = std::min(declarations.find(';'), declarations.size());
    const std::string_view one = declarations.substr(0, end);
    const std::size_t colon = one.find(':');
    if (colon != std::string_view::npos)
      set(style, trimmed(one.substr(0, colon)), one.substr(colon + 1));
    declarations.remove_prefix(std::min(end + 1, declarations.size()));
  }
  if (const auto assignment = node.attribute("data-assignment"))
    style.assignment = lower(trimmed(assignment.value()));
  const std::string label = lower(trimmed(node.attribute("inkscape:label").value()));
  if (std::string_view(node.attribute("inkscape:groupmode").value()) == "layer" &&
      meaning_of(label).known)
    style.layer = label;
  return style;
}

std::optional<Operation> operation_of(const SvgStyle& style, SvgProfile profile) {
  if (profile == SvgProfile::Plain) return Operation::Cut;
  for (const std::string& word : {style.assignment, style.layer})
    if (const Meaning meaning = meaning_of(word); meaning.known) return meaning.operation;
  if (profile == SvgProfile::OrigamiSim || profile == SvgProfile::Lightburn)
    return by_colour(plain_colour(style.stroke), profile);
  return Operation::Cut;
}

std::string plain_colour(std::string_view colour) {
  const std::string c = lower(trimmed(colour));
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kNames{
      {{"black", "#000000"},
       {"red", "#ff0000"},
       {"blue", "#0000ff"},
       {"lime", "#00ff00"},
       {"green", "#008000"},
       {"yellow", "#ffff00"},
       {"magenta", "#ff00ff"},
       {"fuchsia", "#ff00ff"},
       {"white", "#ffffff"}}};
  for (const auto& [name, hex] : kNames)
    if (c == name) return std::string(hex);
  if (c.size() == 4 && c[0] == '#') return {'#', c[1], c[1], c[2], c[2], c[3], c[3]};
  if (c.rfind("rgb(", 0) != 0) return c;
  SvgScan scan(std::string_view(c).substr(4));
  std::array<double, 3> rgb{};
  for (double& channel : rgb) {
    if (!scan.number(channel)) return c;
    if (scan.peek() == '%') {
      scan.skip();
      channel *= 2.55;
    }
    channel = std::clamp(std::round(channel), 0.0, 255.0);
  }
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(rgb[0]), static_cast<int>(rgb[1]),
                     static_cast<int>(rgb[2]));
}

std::vector<std::vector<PagePoint>> dashed_by_style(const std::vector<PagePoint>& line,
                                                    const SvgStyle& style,
                                                    std::size_t most_points) {
  const double period = std::accumulate(style.dashes.begin(), style.dashes.end(), 0.0);
  double phase = std::fmod(style.dash_offset, period);
  if (phase < 0.0) phase += period;
  std::size_t at = 0;
  while (phase >= style.dashes[at] && phase > 0.0) {
    phase -= style.dashes[at];
    at = (at + 1) % style.dashes.size();
  }
  double left = style.dashes[at] - phase;  // of the present dash or gap
  std::vector<std::vector<PagePoint>> parts;
  std::size_t points = 0;
  if (at % 2 == 0) parts.push_back({line.front()});
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double l = distance(line[i - 1], line[i]);
    double t = 0.0;
    while (l - t > left) {
      t += left;
      const PagePoint p{line[i - 1].x + t / l * (line[i].x - line[i - 1].x),
                        line[i - 1].y + t / l * (line[i].y - line[i - 1].y)};
      if (at % 2 == 0)
        parts.back().push_back(p);
      else
        parts.push_back({p});
      at = (at + 1) % style.dashes.size();
      left = style.dashes[at];
      if (++points > most_points) return parts;
    }
    left -= l - t;
    if (at % 2 == 0) parts.back().push_back(line[i]);
  }
  return parts;
}

}  // namespace popcut
