// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/dxf/dxf_binary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/formats/dxf/dxf_curves.hpp"
#include "core/formats/dxf/dxf_entity.hpp"
#include "core/formats/dxf/dxf_tables.hpp"
#include "core/formats/pens/pen_finder.hpp"
#include "core/text/code_page.hpp"
#include "core/text/utf8.hpp"

namespace popcut {
namespace {

constexpr double kMostDashes = 1e6;  // of one line
constexpr int kMostInArray = 32767;  // rows or columns of an INSERT
constexpr std::size_t kMostNamed = 8;
constexpr std::size_t kLinesOfInsert = 20;  // cost of an INSERT, plus the lines that it reads

/// What an entity of a block takes from its INSERT, and where it lies.
struct Place {
  DxfFrame frame;
  std::string_view layer{"0"};
  std::string linetype{"CONTINUOUS"};
  int colour{7};
  int rgb{-1};
  LayerMeaning of_block{LayerMeaning::Wordless};  ///< by the name of a block around it
};

/// A layer, what its name means, how many of its entities were left out, and its line type.
struct LayerUse {
  DxfLayer layer;
  LayerMeaning meaning{};
  std::size_t left_out{};
  bool is_named{false};  ///< in `unknown_`
};

enum class Kind { Drawn, Insert, Silent, Unread };

Kind kind_of(std::string_view type) {
  for (const std::string_view drawn :
       {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"})
    if (type == drawn) return Kind::Drawn;
  if (type == "INSERT") return Kind::Insert;
  for (const std::string_view silent : {"POINT", "SEQEND", "VERTEX", "VIEWPORT", "ENDBLK"})
    if (type == silent) return Kind::Silent;
  return Kind::Unread;
}

bool sounds_dashed(std::string_view linetype) {
  for (const std::string_view word :
       {"DASH", "HIDDEN", "DOT", "CENTER", "PHANTOM", "DIVIDE", "FOLD", "PERF"})
    if (linetype.find(word) != std::string_view::npos) return true;
  return false;
}

std::optional<Operation> by_colour(int index, int rgb, DxfColours colours) {
  const bool exact = rgb >= 0;
  if (exact ? rgb == 0xff0000 : index == 1) return Operation::FoldMountain;
  if (exact ? rgb == 0x0000ff : index == 5) return Operation::FoldValley;
  if (colours == DxfColours::Lightburn) return Operation::Cut;
  if (exact ? rgb == 0 || rgb == 0xffffff : index == 7) return Operation::Outline;
  if (exact ? rgb == 0x00ff00 : index == 3) return Operation::Cut;
  return std::nullopt;
}

class DxfReader {
 public:
  /// @param from  what becomes the origin, page mm
  DxfReader(DxfTables tables, const DxfOptions& options, PagePoint from = {})
      : tables_(std::move(tables)),
        from_(from),
        options_(options),
        pens_(options.pens),
        looks_(options.looks),
        lines_left_(options.most_lines) {
    for (auto& [key, layer] : tables_.layers) {
      const LayerMeaning meaning = meaning_of(layer.name);
      layers_.emplace(key, LayerUse{std::move(layer), meaning, 0});
    }
    for (const auto& [key, linetype] : tables_.linetypes)
      dashes_.emplace(key, dxf_dashes(linetype.elements));
  }

  /// Where the line is that stopped the reading because it is far from the origin.
  [[nodiscard]] const std::optional<PagePoint>& far() const { return far_; }

  Result<LineWork> read() {
    work_.warnings = std::move(tables_.warnings);
    Place place;
    const double mm = tables_.unit_mm;
    place.frame = {{mm, 0, 0}, {0, mm, 0}, {0, 0, mm}, {-from_.x, from_.y, 0}};
    for (const DxfCursor& section : tables_.entities) {
      DxfCursor cursor = section;
      cursor.next();
      if (!entities(cursor, place, 0)) return tl::unexpected(*error_);
    }
    if (auto clear = names_clear(); !clear) {
      if (!looks_.any()) return tl::unexpected(clear.error());
      work_.asks = "layers";
    }
    // Black beside explained colours is the outline, as programs draw it.
    if (cut_is_said_ && first_colour_ && *first_colour_ != std::pair(7, -1) && !second_colour_)
      second_colour_ = unclear_colours(first_layer_);
    if (second_colour_) {
      if (!looks_.any()) return tl::unexpected(*second_colour_);
      if (work_.asks.empty()) work_.asks = "colors";
    }
    work_.unsaid = std::move(looks_.seen());
    add_warnings();
    work_.looks = pens_.seen();
    return std::move(work_);
  }

 private:
  bool stop(std::size_t line, std::string detail, ErrorKind kind = ErrorKind::Malformed) {
    if (!error_) error_ = Error{kind, dxf_line(line), std::move(detail)};
    return false;
  }

  /// Draws from the current group to the end of the section or block.
  bool entities(DxfCursor& cursor, const Place& place, std::size_t depth) {
    DxfEntity entity;
    bool more = true;
    while (more && cursor.group().code != 0) more = cursor.next();
    while (more && !cursor.group().is(0, "ENDSEC") && !cursor.group().is(0, "ENDBLK")) {
      const std::size_t from = cursor.group().line;
      const Kind kind = kind_of(cursor.group().value);
      more = read_dxf_entity(cursor, kind == Kind::Drawn || kind == Kind::Insert, entity);
      if (more && entity.type == "POLYLINE") more = corners(cursor, entity);
      if (cursor.error()) break;
      if (depth > 0 && !pay(cursor.group().line - from, from)) return false;
      if (!one(entity, kind, place, depth)) return false;
    }
    if (cursor.error() && !error_) error_ = *cursor.error();
    return !error_;
  }

  bool pay(std::size_t lines, std::size_t line) {
    if (lines > lines_left_)
      return stop(line, "the drawing repeats blocks too often; explode the blocks or insert fewer",
                  ErrorKind::OutOfRange);
    lines_left_ -= lines;
    return true;
  }

  /// The VERTEX entities of a POLYLINE; the cursor ends after its SEQEND.
  bool corners(DxfCursor& cursor, DxfEntity& polyline) {
    DxfEntity vertex;
    const bool splined = (polyline.flag[0] & 4) != 0;
    while (cursor.group().is(0, "VERTEX")) {
      if (!read_dxf_entity(cursor, true, vertex)) return false;
      const bool frame = splined && (vertex.flag[0] & 16) != 0;  // control point of a spline
      if (!frame) polyline.vertices.push_back({vertex.p10, vertex.real_or(42, 0.0)});
      if (polyline.vertices.size() > kMostInDxfEntity)
        return cursor.refuse(polyline.line, "the POLYLINE has too many vertices; split it",
                             ErrorKind::OutOfRange);
    }
    return !cursor.group().is(0, "SEQEND") || read_dxf_entity(cursor, false, vertex);
  }

  bool one(const DxfEntity& entity, Kind kind, const Place& place, std::size_t depth) {
    if (kind == Kind::Silent) return true;
    if (entity.paper && depth == 0) {
      ++paper_;
      return true;
    }
    if (entity.hidden) {
      if (hidden_++ == 0) first_hidden_ = entity.line;
      return true;
    }
    const std::string_view layer = entity.layer == "0" ? place.layer : entity.layer;
    LayerUse& use = layer_use(layer);
    if (layers_.size() > kMostDxfNames)
      return stop(entity.line, fmt::format("more than {} layers", kMostDxfNames),
                  ErrorKind::OutOfRange);
    const bool shut = use.layer.frozen || (kind != Kind::Insert && use.layer.off);
    if (shut || (kind != Kind::Insert && use.layer.unplotted) ||
        use.meaning == LayerMeaning::Ignore) {
      ++use.left_out;
      return true;
    }
    if (kind == Kind::Unread) {
      if (unread_.size() < 100) ++unread_[dxf_shown(entity.type)];
      return true;
    }
    Place own{place.frame,   layer,      linetype_of(entity, use, place),
              entity.colour, entity.rgb, place.of_block};
    if (entity.colour == 0) own.colour = place.colour, own.rgb = place.rgb;
    if (entity.colour == 256 && entity.rgb < 0)
      own.colour = use.layer.colour, own.rgb = use.layer.rgb;
    return kind == Kind::Insert ? insert(entity, own, depth) : draw(entity, own, use);
  }

  LayerUse& layer_use(std::string_view name) {
    if (last_ != nullptr && last_name_ == name) return *last_;
    const auto [found, is_new] = layers_.try_emplace(dxf_key(name.substr(0, 1024)));
    if (is_new) {
      found->second.layer.name = dxf_name(name);
      found->second.meaning = meaning_of(found->second.layer.name);
    }
    last_name_ = name;
    last_ = &found->second;
    return *last_;
  }

  static std::string linetype_of(const DxfEntity& entity, const LayerUse& use, const Place& place) {
    std::string own = dxf_key(entity.linetype.substr(0, 1024));
    if (own == "BYBLOCK") return place.linetype;
    return own == "BYLAYER" ? use.layer.linetype : own;
  }

  bool insert(const DxfEntity& entity, const Place& own, std::size_t depth) {
    const auto found = tables_.blocks.find(dxf_key(entity.block.substr(0, 1024)));
    if (found == tables_.blocks.end() || found->second.external) {
      if (missing_.size() < 100) ++missing_[dxf_name(entity.block)];
      return true;
    }
    const DxfBlock& block = found->second;
    if (std::find(path_.begin(), path_.end(), &block) != path_.end())
      return stop(entity.line, fmt::format("the block \"{}\" inserts itself; remove this INSERT",
                                           dxf_shown(block.name)));
    if (depth >= options_.most_deep)
      return stop(
          entity.line,
          fmt::format("blocks are nested more than {} deep; explode some", options_.most_deep),
          ErrorKind::OutOfRange);
    const int columns = std::max(entity.flag[0], 1), rows = std::max(entity.flag[1], 1);
    if (columns > kMostInArray || rows > kMostInArray)
      return stop(entity.line,
                  fmt::format("the INSERT has {} columns and {} rows; use at most {} of each",
                              columns, rows, kMostInArray),
                  ErrorKind::OutOfRange);
    if (entity.real_or(41, 1.0) == 0.0 || entity.real_or(42, 1.0) == 0.0) ++squashed_;
    LayerMeaning named = meaning_of(block.name);
    if (!is_known(named) || named == LayerMeaning::Ignore) named = own.of_block;
    path_.push_back(&block);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        Place inner = own;
        inner.of_block = named;
        inner.frame = own.frame * insert_frame(entity, block.base, column * entity.real_or(44, 0.0),
                                               row * entity.real_or(45, 0.0));
        DxfCursor cursor = block.at;
        if (!pay(kLinesOfInsert, entity.line) || !cursor.next() ||
            !entities(cursor, inner, depth + 1)) {
          if (!error_) stop(entity.line, "the block cannot be read");
          return false;
        }
      }
    path_.pop_back();
    return true;
  }

  bool draw(const DxfEntity& entity, const Place& own, LayerUse& use) {
    const auto operation = operation_for(own, use);
    if (!operation) {
      ++by_colour_;
      return true;
    }
    line_.clear();
    std::string wrong;
    const DxfShape shape =
        outline_of(entity, own.frame, options_.tolerance_mm, options_.most_points, line_, wrong);
    if (!wrong.empty()) return stop(entity.line, std::move(wrong));
    if (shape == DxfShape::Mesh) {
      ++unread_["POLYLINE (mesh)"];
      return true;
    }
    if (shape == DxfShape::Tilted) ++tilted_;
    // Points apart from the drawing would make it larger.
    if (std::all_of(line_.begin(), line_.end(),
                    [&](const PagePoint& p) { return p == line_[0]; })) {
      ++empty_;
      return true;
    }
    const PenOperation drawn{*operation, pens_.any() ? pen_of(own, use) : look_};
    if (entity.type == "SPLINE" && (entity.flag[0] & 1) != 0 && !line_.empty() &&
        distance(line_.front(), line_.back()) > options_.tolerance_mm)
      ++unclosed_;
    for (const PagePoint& p : line_)
      if (!(std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate)) {
        far_ = p;
        return stop(
            entity.line,
            fmt::format("the {} lies more than 100 m from {} (one unit is 1 {}); delete what is "
                        "far from the drawing, or give its unit with `units`",
                        entity.type, from_ == PagePoint{} ? "the origin" : "the first line",
                        tables_.unit_name),
            ErrorKind::OutOfRange);
      }
    return is_fold(drawn) || drawn == Operation::Score ? append(drawn, line_, entity.line)
                                                       : dashed(drawn, own.linetype, entity);
  }

  // The pen of a line's layer, else of its colour.
  std::uint8_t pen_of(const Place& own, const LayerUse& use) {
    const std::uint8_t by_layer = pens_.of_layer(use.layer.name);
    const std::uint8_t by_colour = own.rgb >= 0
                                       ? pens_.of_colour(static_cast<std::uint32_t>(own.rgb))
                                       : pens_.of_index(own.colour);
    return by_layer != 0 ? by_layer : by_colour;
  }

  // What was said of the colour of a line.
  [[nodiscard]] std::optional<LayerMeaning> said_of(const Place& own) const {
    return own.rgb >= 0 ? use_of_colour(options_.said, static_cast<std::uint32_t>(own.rgb))
                        : use_of_index(options_.said, own.colour);
  }

  std::optional<Operation> operation_for(const Place& own, LayerUse& use) {
    look_ = 0;
    const LayerMeaning meaning = use.meaning == LayerMeaning::Wordless ? own.of_block : use.meaning;
    if (meaning == LayerMeaning::Fold) ++sideless_;
    if (is_known(meaning)) {
      any_known_ = true;
      // A person who is asked may say the side, or that a scored line is a fold.
      const bool has_no_side = meaning == LayerMeaning::Fold || meaning == LayerMeaning::Score;
      if (has_no_side && looks_.any() && use.meaning == meaning)
        look_ = looks_.of_index(use.layer.name, own.colour);
      fold_letters_ = fold_letters_ || is_letter_of_fold(use.layer.name);
      const Operation meant = operation_of(meaning);
      if (is_cut(meant)) cut_colours_.insert(colour_of(own));
      return meant;
    }
    if (const auto said = said_of(own)) {
      if (*said == LayerMeaning::Ignore) return std::nullopt;
      cut_is_said_ = cut_is_said_ || is_cut(operation_of(*said));
      return operation_of(*said);
    }
    if (options_.colours == DxfColours::Ignored) return Operation::Cut;
    if (options_.colours == DxfColours::Asked) {
      if (is_solid(own)) see_colour(own, use);
      if (is_solid(own) && looks_.any()) look_ = look_of(own, use);
      return Operation::Cut;
    }
    return by_colour(own.colour, own.rgb, options_.colours);
  }

  std::uint8_t look_of(const Place& own, const LayerUse& use) {
    const std::pair<int, int> colour = colour_of(own);
    const std::string name = use.meaning == LayerMeaning::Unknown ? use.layer.name : "";
    return colour.second >= 0 ? looks_.of_colour(name, static_cast<std::uint32_t>(colour.second))
                              : looks_.of_index(name, colour.first);
  }

  // Black and white are one colour: both are "the other than the background".
  static std::pair<int, int> colour_of(const Place& own) {
    const bool plain = own.rgb < 0 ? own.colour == 7 : own.rgb == 0 || own.rgb == 0xffffff;
    if (plain) return {7, -1};
    return own.rgb >= 0 ? std::pair(-1, own.rgb) : std::pair(own.colour, -1);
  }

  // The dashes of a line say what to do with it: cut them.
  [[nodiscard]] bool is_solid(const Place& own) const {
    const auto found = dashes_.find(own.linetype);
    return !sounds_dashed(own.linetype) && (found == dashes_.end() || found->second.dashes.empty());
  }

  [[nodiscard]] LayerMeaning meaning_of(std::string_view name) const {
    return meaning_of_name(options_.layers, name);
  }

  // No layer is cut whose name may be a fold's in words that nobody knows here.
  [[nodiscard]] Result<void> names_clear() {
    if (fold_letters_)
      std::erase_if(unknown_, [](const std::string& one) { return is_letter_of_cut(one); });
    const auto foreign = std::find_if(unknown_.begin(), unknown_.end(), [](const std::string& one) {
      return std::any_of(one.begin(), one.end(), [](char c) { return (c & 0x80) != 0; });
    });
    const bool coded = tables_.foreign_names && unknown_.size() > 1 && foreign != unknown_.end();
    if (unknown_.empty() || (!any_known_ && !coded)) return {};
    std::string detail = unknown_names(unknown_);
    if (tables_.foreign_names && foreign != unknown_.end())
      detail +=
          "; this computer does not know the file's code page; save it as a DXF of 2007 or later";
    return tl::unexpected(Error{ErrorKind::Malformed, fmt::format("layer \"{}\"", unknown_.front()),
                                std::move(detail), ErrorReason::Unclear});
  }

  void see_colour(const Place& own, LayerUse& use) {
    if (use.meaning == LayerMeaning::Unknown && !std::exchange(use.is_named, true))
      unknown_.push_back(use.layer.name);
    has_wordless_ = has_wordless_ || use.meaning == LayerMeaning::Wordless;
    const std::pair<int, int> colour = colour_of(own);
    if (!first_colour_) first_colour_ = colour, first_layer_ = use.layer.name;
    if (*first_colour_ == colour || second_colour_) return;
    second_colour_ = unclear_colours(use.layer.name);
  }

  [[nodiscard]] static Error unclear_colours(const std::string& layer) {
    return {
        ErrorKind::Malformed, fmt::format("layer \"{}\"", layer),
        "lines on layers whose names say neither cut nor fold have several colours, and popcut "
        "does not guess which of them are folds; say it with `colors` such as "
        "\"red=fold-mountain\", "
        "or use `svg-profile` origami-sim or lightburn if red is a mountain fold and blue a valley "
        "fold, `svg-profile` popcut to cut them all, or name the layers CUT, MOUNTAIN and VALLEY",
        ErrorReason::Unclear};
  }

  /// Appends `line_`, as dashes if its line type has any.
  bool dashed(PenOperation operation, const std::string& linetype, const DxfEntity& entity) {
    const auto found = dashes_.find(linetype);
    const bool known = found != dashes_.end();
    if (!known || found->second.dashes.empty()) {
      const bool unclear = sounds_dashed(linetype);
      if (!unclear) return append(operation, line_, entity.line);
      ++unclear_;
      return append({Operation::FoldValley, operation.pen}, line_, entity.line);
    }
    const DxfDashes& dashes = found->second;
    const double scale = entity.linetype_scale > 0.0 ? entity.linetype_scale : 1.0;
    const double period = dashes.period * tables_.linetype_scale * scale * tables_.unit_mm;
    const double all = length(line_);
    const double periods = dxf_periods(all, period);
    if (!(periods * static_cast<double>(dashes.dashes.size()) <= kMostDashes))
      return stop(
          entity.line,
          fmt::format("the dashes of line type {} are too fine for this line; make them longer",
                      dxf_shown(linetype)),
          ErrorKind::OutOfRange);
    if (!(all > 0.0)) return true;
    ++dashed_;
    return each_dash(
        std::span<const PagePoint>(line_), dashes, periods,
        [&](std::span<const PagePoint> dash) { return append(operation, dash, entity.line); });
  }

  bool append(PenOperation operation, std::span<const PagePoint> line, std::size_t at) {
    if (work_.points.size() + line.size() > options_.most_points)
      return stop(
          at, fmt::format("the drawing has more than {} points; split it", options_.most_points),
          ErrorKind::OutOfRange);
    work_.append(operation, line);
    return true;
  }

  void add_warnings() {
    const auto say = [&](std::size_t count, const char* code, const char* what,
                         bool spoils = false) {
      if (count > 0)
        work_.warnings.push_back(
            {.code = code, .message = fmt::format("{} {}", count, what), .spoils = spoils});
    };
    for (const auto& [type, count] : unread_)
      work_.warnings.push_back(
          {.code = "entity_unread",
           .message =
               fmt::format("{} {} cannot be read and {} left out; explode or redraw {} as lines",
                           count, type, count == 1 ? "is" : "are", count == 1 ? "it" : "them"),
           .spoils = true});
    for (const auto& [name, count] : missing_)
      work_.warnings.push_back(
          {.code = "missing_block",
           .message =
               fmt::format("{} insert{} of the block \"{}\", which is not in the file, {} left out",
                           count, count == 1 ? "" : "s", name, count == 1 ? "is" : "are"),
           .place = {.source = fmt::format("block \"{}\"", name)},
           .spoils = true});
    if (first_colour_ && !cut_colours_.empty() && cut_colours_.count(*first_colour_) == 0)
      work_.warnings.push_back(
          {.code = "strokes_without_name",
           .message = fmt::format("the name of layer \"{}\" says neither cut nor fold: its lines "
                                  "are cut; if they are folds, name it MOUNTAIN or VALLEY",
                                  dxf_shown(first_layer_)),
           .place = {.source = fmt::format("layer \"{}\"", first_layer_)},
           .spoils = true});
    if (!any_known_ && !looks_.any() && !unknown_.empty() &&
        unknown_.size() + (has_wordless_ ? 1 : 0) > 1)
      work_.warnings.push_back({.code = "names_unknown", .message = only_unknown_names(unknown_)});
    add_layer_warnings();
    say(paper_, "paper_layout",
        "entities on a paper layout are left out; only the model space is cut");
    if (hidden_ > 0)
      work_.warnings.push_back(
          {.code = "hidden",
           .message = fmt::format("{} invisible {} left out; {} at {}; make {} visible to cut {}",
                                  hidden_, hidden_ == 1 ? "entity is" : "entities are",
                                  hidden_ == 1 ? "it is" : "the first is", dxf_line(first_hidden_),
                                  hidden_ == 1 ? "it" : "them", hidden_ == 1 ? "it" : "them")});
    say(tilted_, "tilted", "entities are tilted in space; they are cut as seen from above");
    say(empty_, "no_size", "lines have no length and are left out");
    say(squashed_, "squashed", "inserts of blocks have a scale of 0, which leaves no width; set it",
        true);
    say(unclosed_, "spline_open",
        "splines are marked as closed, but their ends lie apart; they are cut open", true);
    say(by_colour_, "stroke_left_out",
        "lines are left out because their colour means neither cut nor fold", true);
    say(sideless_, "fold_side_unknown",
        "folds are on layers that do not name mountain or valley; they become valley folds");
    say(dashed_, "dashed_line", "lines have a dashed line type; their dashes are cut");
    say(unclear_, "dashes_unknown",
        "lines have a dashed line type whose dashes are not in the file; they become "
        "valley folds");
  }

  void add_layer_warnings() {
    std::vector<const LayerUse*> left_out;
    for (const auto& [key, use] : layers_)
      if (use.left_out > 0) left_out.push_back(&use);
    std::sort(left_out.begin(), left_out.end(),
              [](const LayerUse* a, const LayerUse* b) { return a->layer.name < b->layer.name; });
    for (std::size_t i = 0; i < std::min(left_out.size(), kMostNamed); ++i) {
      const DxfLayer& layer = left_out[i]->layer;
      const char* why = layer.frozen      ? "is frozen"
                        : layer.off       ? "is off"
                        : layer.unplotted ? "is not plotted or transparent"
                                          : "has a name that means not to cut it";
      work_.warnings.push_back(
          {.code = "layer_left_out",
           .message =
               fmt::format("the layer \"{}\" {}; {} of its entities {} left out", layer.name, why,
                           left_out[i]->left_out, left_out[i]->left_out == 1 ? "is" : "are"),
           .place = {.source = fmt::format("layer \"{}\"", layer.name)}});
    }
    if (left_out.size() > kMostNamed)
      work_.warnings.push_back(
          {.code = "layer_left_out",
           .message = fmt::format("{} more layers are left out", left_out.size() - kMostNamed)});
  }

  DxfTables tables_;
  PagePoint from_;
  std::optional<PagePoint> far_;
  DxfOptions options_;
  PenFinder pens_;
  LookFinder looks_;
  std::uint8_t look_{};  // of the line that is drawn; 0: it has a meaning
  LineWork work_;
  std::unordered_map<std::string, LayerUse> layers_;
  std::unordered_map<std::string, DxfDashes> dashes_;
  std::string_view last_name_;
  LayerUse* last_{nullptr};
  std::vector<const DxfBlock*> path_;
  std::vector<PagePoint> line_;
  std::map<std::string, std::size_t> unread_, missing_;
  std::size_t paper_{}, hidden_{}, tilted_{}, squashed_{}, unclosed_{}, empty_{}, by_colour_{},
      sideless_{}, dashed_{}, unclear_{};
  std::size_t lines_left_, first_hidden_{};
  std::optional<Error> error_;
  std::optional<std::pair<int, int>> first_colour_;  // index and rgb
  std::string first_layer_;                          // where it is first used
  std::set<std::pair<int, int>> cut_colours_;        // on layers whose names mean cuts
  std::optional<Error> second_colour_;
  bool cut_is_said_{false};           // of a colour
  bool has_wordless_{false};          // a line's layer has a name that says nothing
  std::vector<std::string> unknown_;  // names of layers, in the order of their first lines
  bool fold_letters_{false};          // lines lie on a layer M or V
  bool any_known_{false};             // any line's layer or block has a known name
};

}  // namespace

DxfOptions DxfOptions::raised(unsigned factor) const {
  constexpr std::size_t kMost = 0x7fffffff;
  DxfOptions more = *this;
  more.most_bytes = std::min(kMost, most_bytes * factor);
  more.most_points = std::min(kMost, most_points * factor);
  more.most_lines *= factor;
  return more;
}

// Two lines of the text are one group of the file.
Error of_groups(Error error) {
  constexpr std::string_view kLine = "line ";
  std::size_t line = 0;
  if (error.place.starts_with(kLine))
    for (const char c : error.place.substr(kLine.size())) {
      if (c < '0' || c > '9') return error;
      line = 10 * line + static_cast<std::size_t>(c - '0');
    }
  if (line > 0) error.place = fmt::format("group {}", (line + 1) / 2);
  return error;
}

namespace {

/// The code page of a text, if it is not one in which names are read as they are.
std::string code_page_of(std::string_view text) {
  constexpr std::size_t kMostHead = 1u << 20;
  const std::string_view head = text.substr(0, kMostHead);
  const std::size_t at = head.find("$DWGCODEPAGE");
  if (at == head.npos || is_utf8(text)) return {};
  DxfCursor cursor(head.substr(head.find('\n', at) + 1));
  return cursor.next() ? std::string(cursor.group().value) : std::string();
}

Result<DxfTables> tables_of(std::string_view text, const DxfOptions& options) {
  auto tables = read_dxf_tables(text);
  if (tables) tables->foreign_names = tables->foreign_names && !is_utf8(text);
  if (tables && options.unit_mm) {
    tables->unit_mm = *options.unit_mm;
    std::erase_if(tables->warnings,
                  [](const Warning& warning) { return warning.code == "no_unit"; });
  }
  return tables;
}

}  // namespace

Result<LineWork> linework_from_dxf(std::string_view given, const DxfOptions& options) {
  std::string plain;
  std::string_view text = plain_text(given, plain);
  if (text.size() > options.most_bytes)
    return tl::unexpected(too_much(
        fmt::format("the DXF has {} bytes; the limit is {}", text.size(), options.most_bytes)));
  if (is_binary_dxf(text)) {
    const auto ascii = ascii_dxf(text, options.most_bytes);
    if (!ascii) return tl::unexpected(ascii.error());
    auto read = linework_from_dxf(*ascii, options);
    if (!read) return tl::unexpected(of_groups(read.error()));
    return read;
  }
  if (text.size() > 6 && text.substr(0, 4) == "AC10" && text[6] == '\0')
    return fail(ErrorKind::Malformed, "line 1", "is a DWG; save it as ASCII DXF");
  if (const std::string page = code_page_of(text); !page.empty())
    if (auto converted = utf8_of_code_page(text, page)) {
      plain = std::move(*converted);
      text = plain;
    }
  auto tables = tables_of(text, options);
  if (!tables) return tl::unexpected(tables.error());
  DxfReader reader(std::move(*tables), options);
  auto work = reader.read();
  // Site coordinates: where the first line is becomes the origin.
  const auto far = reader.far();
  if (work || !far || !(std::hypot(far->x, far->y) < 1e12)) return work;
  tables = tables_of(text, options);
  if (!tables) return tl::unexpected(tables.error());
  work = DxfReader(std::move(*tables), options, *far).read();
  if (work)
    work->warnings.push_back(
        {.code = "far_away",
         .message = fmt::format("the drawing lies {:.0f} m from its origin and is moved there",
                                std::hypot(far->x, far->y) / 1000.0)});
  return work;
}

}  // namespace popcut
