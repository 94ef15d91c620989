// SPDX-License-Identifier: MIT
#include "core/formats/fold/fold_reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/text/fold_text.hpp"
#include "core/text/near_names.hpp"
#include "core/text/words.hpp"

namespace popcut {
namespace {

constexpr std::size_t kNone = ~std::size_t{0};

std::size_t bytes_of(const FoldFrame& frame) {
  std::size_t corners = 0;
  for (const auto& face : frame.faces) corners += face.size();
  return 24 * frame.vertices.size() + 17 * frame.edges.size() + 48 * frame.faces.size() +
         4 * corners;
}

/// Reads the members of one frame into a frame that may have inherited others. Keeps the first
/// fault.
class FrameReader {
 public:
  FrameReader(const FrameText& text, FoldFrame& frame) : text_(text), frame_(frame) {}

  Result<void> read() {
    read_words();
    if (auto done = vertices(); !done) return done;
    if (auto done = edges(); !done) return done;
    if (auto done = assignments(); !done) return done;
    if (auto done = angles(); !done) return done;
    return faces();
  }

 private:
  [[nodiscard]] std::string at(const std::string& rest) const { return text_.place + rest; }

  void read_words() {
    if (!text_.title.empty()) frame_.title = text_.title;
    if (!text_.unit.empty()) frame_.unit = text_.unit;
    frame_.psi_rad = text_.psi_rad;
    if (text_.classes.empty()) return;
    const auto& classes = text_.classes;
    frame_.folded_form = std::find(classes.begin(), classes.end(), "foldedForm") != classes.end();
  }

  Result<void> vertices() {
    const FoldColumn& column = text_.vertices_coords;
    if (!column.present) return {};
    frame_.vertices.clear();
    frame_.vertices.reserve(column.rows());
    for (std::size_t i = 0; i < column.rows(); ++i) {
      const std::size_t begin = column.row_begin(i), count = column.row_end(i) - begin;
      if (count < 2 || count > 3)
        return fail(ErrorKind::Malformed, at(fmt::format("/vertices_coords/{}", i)),
                    fmt::format("has {} numbers; give two or three coordinates", count));
      std::array<double, 3> p{};
      for (std::size_t c = 0; c < count; ++c) {
        p.at(c) = column.number[begin + c];
        if (!std::isfinite(p.at(c)))
          return fail(ErrorKind::OutOfRange, at(fmt::format("/vertices_coords/{}/{}", i, c)),
                      "is not a finite number; give a coordinate");
      }
      frame_.vertices.push_back(p);
    }
    return {};
  }

  /// The vertex that entry `n` of row `i` refers to.
  [[nodiscard]] Result<std::uint32_t> index(const FoldColumn& column, const char* key,
                                            std::size_t i, std::size_t n) const {
    const double value = column.number[column.row_begin(i) + n];
    const std::size_t count = frame_.vertices.size();
    if (value >= 0.0 && value < static_cast<double>(count) && value == std::floor(value))
      return static_cast<std::uint32_t>(value);
    return fail(ErrorKind::OutOfRange, at(fmt::format("/{}/{}/{}", key, i, n)),
                count == 0 ? fmt::format("is {:g}; there are no vertices", value)
                           : fmt::format("is {:g}; give the number of a vertex, 0 to {}", value,
                                         count - 1));
  }

  Result<void> edges() {
    const FoldColumn& column = text_.edges_vertices;
    if (!column.present) return recheck();
    frame_.edges.clear();
    frame_.edges.reserve(column.rows());
    for (std::size_t i = 0; i < column.rows(); ++i) {
      const std::size_t count = column.row_end(i) - column.row_begin(i);
      if (count != 2)
        return fail(ErrorKind::Malformed, at(fmt::format("/edges_vertices/{}", i)),
                    fmt::format("has {} entries; an edge needs two vertices", count));
      std::array<std::uint32_t, 2> ends{};
      for (std::size_t e = 0; e < 2; ++e) {
        const auto vertex = index(column, "edges_vertices", i, e);
        if (!vertex) return tl::unexpected(vertex.error());
        ends.at(e) = *vertex;
      }
      frame_.edges.push_back(ends);
    }
    frame_.assignments.assign(frame_.edges.size(), 'U');
    frame_.fold_angles_deg.assign(frame_.edges.size(), 0.0);
    return {};
  }

  /// A frame that inherits edges or faces but has its own vertices must have enough of them.
  [[nodiscard]] Result<void> recheck() const {
    std::uint32_t most = 0;
    for (const auto& edge : frame_.edges) most = std::max({most, edge[0], edge[1]});
    if (!text_.faces_vertices.present)
      for (const auto& face : frame_.faces)
        for (const std::uint32_t v : face) most = std::max(most, v);
    if (most < frame_.vertices.size() || (frame_.edges.empty() && most == 0)) return {};
    return fail(ErrorKind::OutOfRange, at("/vertices_coords"),
                fmt::format("has {} vertices, but the inherited edges or faces use vertex {}",
                            frame_.vertices.size(), most));
  }

  [[nodiscard]] Result<void> same_length(const FoldColumn& column, const char* key) const {
    if (column.number.size() == frame_.edges.size()) return {};
    return fail(
        ErrorKind::Malformed, at(fmt::format("/{}", key)),
        fmt::format("has {} entries, but edges_vertices has {}; both must have the same length",
                    column.number.size(), frame_.edges.size()));
  }

  Result<void> assignments() {
    const FoldColumn& column = text_.edges_assignment;
    if (!column.present) return {};
    if (auto same = same_length(column, "edges_assignment"); !same) return same;
    for (std::size_t i = 0; i < column.number.size(); ++i) {
      const char letter = capital(static_cast<char>(column.number[i]));
      if (std::string_view("BMVFUCJ").find(letter) == std::string_view::npos)
        return fail(ErrorKind::Malformed, at(fmt::format("/edges_assignment/{}", i)),
                    "is not an assignment; use B, M, V, F, U, C or J");
      frame_.assignments[i] = letter;
    }
    return {};
  }

  Result<void> angles() {
    const FoldColumn& column = text_.edges_fold_angle;
    if (!column.present) return {};
    if (auto same = same_length(column, "edges_foldAngle"); !same) return same;
    for (std::size_t i = 0; i < column.number.size(); ++i) {
      const double degrees = column.number[i];
      if (std::isnan(degrees)) {
        frame_.fold_angles_deg[i] = 0.0;
        continue;
      }
      if (!(std::abs(degrees) <= 360.0))
        return fail(ErrorKind::OutOfRange, at(fmt::format("/edges_foldAngle/{}", i)),
                    fmt::format("is {:g} degrees; use -180 to 180", degrees));
      frame_.fold_angles_deg[i] = degrees;
    }
    return {};
  }

  Result<void> faces() {
    const FoldColumn& column = text_.faces_vertices;
    if (!column.present) return {};
    frame_.faces.clear();
    frame_.faces.reserve(column.rows());
    for (std::size_t i = 0; i < column.rows(); ++i) {
      std::vector<std::uint32_t> corners(column.row_end(i) - column.row_begin(i));
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const auto vertex = index(column, "faces_vertices", i, c);
        if (!vertex) return tl::unexpected(vertex.error());
        corners[c] = *vertex;
      }
      frame_.faces.push_back(std::move(corners));
    }
    return {};
  }

  const FrameText& text_;
  FoldFrame& frame_;
};

/// The frame that frame `i` inherits from; kNone if it does not inherit.
Result<std::size_t> parent_of(const std::vector<FrameText>& texts, std::size_t i) {
  const FrameText& text = texts[i];
  if (!text.inherit) return kNone;
  const double parent = text.parent.value_or(-1.0);
  if (parent >= 0.0 && parent < static_cast<double>(texts.size()) && parent == std::floor(parent) &&
      parent != static_cast<double>(i))
    return static_cast<std::size_t>(parent);
  return fail(
      ErrorKind::Malformed, text.place + "/frame_parent",
      fmt::format("must be the number of another frame, 0 to {}, because this frame inherits",
                  texts.size() - 1));
}

/// Reads the frames in an order in which each comes after the frame that it inherits from.
class FrameOrder {
 public:
  FrameOrder(const std::vector<FrameText>& texts, FoldFile& file, std::size_t most_bytes)
      : texts_(texts), file_(file), state_(texts.size(), State::Waiting), most_bytes_(most_bytes) {}

  Result<void> read(std::size_t i) {
    std::vector<std::pair<std::size_t, std::size_t>> chain;  // frame, its parent
    for (std::size_t at = i; at != kNone && state_[at] != State::Read;) {
      if (state_[at] == State::Under)
        return fail(ErrorKind::Malformed, texts_[at].place + "/frame_parent",
                    "the frame inherits from itself through other frames; break the circle");
      state_[at] = State::Under;
      const auto parent = parent_of(texts_, at);
      if (!parent) return tl::unexpected(parent.error());
      chain.emplace_back(at, *parent);
      at = *parent;
    }
    for (auto link = chain.rbegin(); link != chain.rend(); ++link)
      if (auto done = take(link->first, link->second); !done) return done;
    return {};
  }

 private:
  enum class State : std::uint8_t { Waiting, Under, Read };

  Result<void> take(std::size_t i, std::size_t parent) {
    FoldFrame& frame = file_.frames[i];
    const auto fits = [&](std::size_t more) { return bytes_ + more <= most_bytes_; };
    if (parent != kNone && !fits(bytes_of(file_.frames[parent]))) return too_large(i);
    if (parent != kNone) frame = file_.frames[parent];
    if (auto done = FrameReader(texts_[i], frame).read(); !done) return done;
    bytes_ += bytes_of(frame);
    if (!fits(0)) return too_large(i);
    state_[i] = State::Read;
    return {};
  }

  [[nodiscard]] tl::unexpected<Error> too_large(std::size_t i) const {
    return fail(
        ErrorKind::OutOfRange, texts_[i].place,
        fmt::format("the frames together need more than {} MB; remove some", most_bytes_ >> 20));
  }

  const std::vector<FrameText>& texts_;
  FoldFile& file_;
  std::vector<State> state_;
  std::size_t most_bytes_;
  std::size_t bytes_{0};
};

}  // namespace

Result<FoldFile> read_fold(std::string_view text, const FoldLimits& limits) {
  const auto texts = read_fold_text(text, limits);
  if (!texts) return tl::unexpected(texts.error());
  const FrameText& key = texts->front();
  // Some programs write all they have into `file_frames`.
  const bool has_frame = std::any_of(texts->begin() + 1, texts->end(), [](const FrameText& one) {
    return one.vertices_coords.present && one.edges_vertices.present;
  });
  if (!key.vertices_coords.present && !key.inherit && !has_frame) {
    const std::string near = nearest_word("vertices_coords", key.other_names);
    return fail(ErrorKind::Malformed, "/vertices_coords",
                near.empty() ? "is missing; a FOLD file needs the coordinates of its vertices"
                             : fmt::format("is missing; is \"{}\" a misspelling of it?", near));
  }
  FoldFile file;
  file.title = key.file_title;
  file.design_psi_rad = key.design_psi_rad;
  file.frames.resize(texts->size());
  // Frames may inherit what they do not have, but not all of it thousands of times.
  constexpr std::size_t kFewBytes = 32u << 20, kForEachByte = 100;
  FrameOrder order(*texts, file,
                   std::min(limits.frame_bytes, kFewBytes + kForEachByte * text.size()));
  for (std::size_t i = 0; i < texts->size(); ++i)
    if (auto done = order.read(i); !done) return tl::unexpected(done.error());
  return file;
}

}  // namespace popcut
