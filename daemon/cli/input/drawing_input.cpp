// SPDX-License-Identifier: MIT
#include "daemon/cli/input/drawing_input.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/fold/crease_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/gzip.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/input/book_input.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/input/spec_assets.hpp"
#include "daemon/client/command_words.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/planning/pdf_task.hpp"

namespace popcut::cli {
namespace {

using planning::InputKind;

std::optional<InputKind> kind_of(const std::string& text, const std::string& ending) {
  if (pictures::is_pdf(text)) return InputKind::Pdf;
  if (ending == ".svg" || ending == ".svgz" || is_gzip(text)) return InputKind::Svg;
  if (ending == ".fold" || ending == ".cp" || ending == ".opx" || is_crease_pattern(text))
    return InputKind::Fold;
  if (ending == ".json") return InputKind::Spec;
  if (ending == ".dxf") return InputKind::Dxf;
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string::npos) return std::nullopt;
  if (text[first] == '<') return InputKind::Svg;
  if (text[first] != '{') return std::nullopt;
  return text.find("\"vertices_coords\"") == std::string::npos ? InputKind::Spec : InputKind::Fold;
}

// What is read of a file before it is known what is in it; a spec is small.
std::size_t most_bytes(const std::string& ending, const SvgReadOptions& how, unsigned factor) {
  if (ending == ".svg" || ending == ".svgz") return how.limits.bytes;
  if (ending == ".dxf") return DxfOptions{}.raised(factor).most_bytes;
  return FoldLimits{}.raised(factor).bytes;
}

// How much more than usual a drawing may take.
Result<unsigned> raised_limits() {
  const char* const text = std::getenv("POPCUT_RAISE_LIMITS");
  if (text == nullptr || *text == '\0') return 1u;
  char* end = nullptr;
  const long factor = std::strtol(text, &end, 10);
  if (*end == '\0' && factor >= 1 && factor <= 100) return static_cast<unsigned>(factor);
  return fail(ErrorKind::Usage, "POPCUT_RAISE_LIMITS",
              fmt::format("is \"{}\"; give a whole number from 1 to 100",
                          std::string_view(text).substr(0, 40)));
}

/// The cards of a book side by side, each a piece of its own.
Result<DrawingInput> drawing_of_book(const std::string& file, const SvgReadOptions& how) {
  const auto book = read_book(file);
  if (!book) return tl::unexpected(book.error());
  std::vector<LineWork> cards;
  for (std::size_t i = 0; i < book->cards.size(); ++i) {
    auto card = read_drawing(book->cards[i].file, how);
    if (!card) return tl::unexpected(card.error());
    card->drawing.name = fmt::format("card {}", i + 1);
    card->drawing.warnings.clear();
    cards.push_back(std::move(card->drawing));
  }
  DrawingInput out = planning::side_by_side(cards);
  out.drawing.name = book->name.empty() ? std::filesystem::path(file).stem().string() : book->name;
  return out;
}

}  // namespace

Error neither_design_nor_drawing(const std::string& file, std::string_view bytes) {
  std::string foreign = foreign_advice(bytes, file);
  for (std::size_t at = foreign.find("FILE"); at != foreign.npos; at = foreign.find("FILE"))
    foreign.replace(at, 4, client::quoted(file));
  if (!foreign.empty()) return {ErrorKind::Malformed, file, std::move(foreign)};
  if (is_model_file(file))
    return {ErrorKind::Malformed, file,
            fmt::format("is a 3D model; 'popcut auto {} -o cards' makes cards of it: give the "
                        "spec.json of one",
                        client::quoted(file))};
  return {ErrorKind::Malformed, file,
          "is not a design (.json) or a drawing (.svg, .svgz, .dxf, .fold, .pdf, .cp, .opx) that "
          "popcut can read"};
}

Result<DrawingInput> read_drawing(const std::string& file, SvgReadOptions how,
                                  const std::vector<std::string>& tables,
                                  const std::string& material, const Progress& progress,
                                  const DesignVisitor& designed) {
  if (names_book(file)) return drawing_of_book(file, how);
  const auto factor = raised_limits();
  if (!factor) return tl::unexpected(factor.error());
  how.limits = how.limits.raised(*factor);
  std::string ending = std::filesystem::path(file).extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const std::size_t most = most_bytes(ending, how, *factor);
  auto text = read_file(file, most);
  if (!text && text.error().reason == ErrorReason::TooMuch)
    return fail(ErrorKind::OutOfRange, file,
                fmt::format("is larger than {} bytes; simplify it, or set POPCUT_RAISE_LIMITS={}",
                            most, std::min(100u, 4 * *factor)));
  if (!text) return tl::unexpected(text.error());
  auto kind = kind_of(*text, ending);
  const bool foreign =
      kind != InputKind::Pdf && ending != ".json" && !foreign_advice(*text, file).empty();
  if (!kind || foreign) return tl::unexpected(neither_design_nor_drawing(file, *text));
  if (ending == ".cp" && !is_crease_pattern(*text) && !text->starts_with('{'))
    if (const auto none = fold_of_crease_pattern(*text); !none)
      return tl::unexpected(within(file, none.error()));
  std::vector<Warning> page_warnings;
  if (kind == InputKind::Pdf) {
    auto page = planning::pdf_page_apart(std::move(*text), how.pdf_page);
    if (!page)
      return tl::unexpected(page.error().place.empty() ? within(file, page.error()) : page.error());
    text = std::move(page->svg);
    page_warnings = std::move(page->warnings);
    kind = InputKind::Svg;
  }
  SurfaceAssets assets;
  const planning::SpecSources beside{
      [&](const DesignSpec& spec) {
        auto loaded = load_assets(spec, file);
        if (loaded) assets = *loaded;
        return loaded;
      },
      [&](const DesignSpec& spec, const PatchAssembly& made) -> Result<void> {
        if (!designed.designed) return {};
        return designed.designed(spec, assets, made);
      },
      tables,
      material,
      progress,
      [&](const DesignSpec& spec, const LayeredCard& made) -> Result<void> {
        if (!designed.layered) return {};
        return designed.layered(spec, assets, made);
      },
      designed.sliced,
      [&](const DesignSpec& spec, const BoxedCard& made) -> Result<void> {
        if (!designed.boxed) return {};
        return designed.boxed(spec, assets, made);
      }};
  auto input = planning::drawing_from_text(std::move(*text), *kind, how, *factor, beside);
  if (!input && input.error().reason == ErrorReason::TooMuch && *factor < 100)
    input.error().detail +=
        fmt::format(", or set POPCUT_RAISE_LIMITS={}", std::min(100u, 4 * *factor));
  if (!input && input.error().reason == ErrorReason::Misplaced)
    input.error().detail += ", or see 'popcut design --place'";
  // An option's error has its place.
  if (!input)
    return tl::unexpected(
        input.error().place.starts_with("/options/") ? input.error() : within(file, input.error()));
  if (input->drawing.name.empty())
    input->drawing.name = std::filesystem::path(file).stem().string();
  std::vector<Warning>& warnings = input->drawing.warnings;
  warnings.insert(warnings.begin(), page_warnings.begin(), page_warnings.end());
  return input;
}

Result<DrawingInput> read_drawing(const std::string& file, SvgProfile profile,
                                  const std::vector<std::string>& tables) {
  auto found = find_stroke_profile(svg_profile_name(profile));
  if (!found) return tl::unexpected(found.error());
  SvgReadOptions how;
  how.profile = std::move(*found);
  return read_drawing(file, std::move(how), tables);
}

}  // namespace popcut::cli
