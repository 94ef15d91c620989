// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/model/model.hpp"
#include "core/text/words.hpp"

/// The readers behind `read_model`, one for each format, and what they share.
namespace popcut::model_readers {

/// See `read_model`, for the errors too.
[[nodiscard]] Result<Model> read_gltf(const std::string& name, std::string_view bytes,
                                      const ModelOptions& options);
[[nodiscard]] Result<Model> read_obj(const std::string& name, std::string_view bytes,
                                     const ModelOptions& options);
[[nodiscard]] Result<Model> read_stl(const std::string& name, std::string_view bytes);

/// Whether a file is exactly as long as the head of a binary STL says. Then it is one, whatever it
/// begins with.
[[nodiscard]] bool is_whole_binary_stl(std::string_view bytes);

/// @retval OutOfRange  more triangles than are read
[[nodiscard]] Result<void> check_triangles(const std::string& name, std::size_t count);

/// The text of a model: as `plain_text`, and what editors show as a blank (no-break spaces, byte
/// order marks where files were put together) is one.
///
/// @param kept  holds a text that was changed
[[nodiscard]] std::string_view plain_lines(std::string_view bytes, std::string& kept);

/// Removes the first word from a line.
[[nodiscard]] inline std::string_view next_word(std::string_view& line,
                                                std::string_view blanks = " \t") {
  const std::size_t begin = std::min(line.find_first_not_of(blanks), line.size());
  const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Adds a picture to a model and hands over its bytes.
///
/// @param place  where the model names it, for errors
/// @return its index of `Model::pictures`, or the error of who takes it
[[nodiscard]] Result<std::int32_t> add_picture(Model& model, const ModelOptions& options,
                                               const std::string& place, ModelPicture picture,
                                               std::string_view bytes);

/// The place of a line, for errors.
[[nodiscard]] inline std::string line_place(const std::string& name, std::size_t number) {
  return fmt::format("{}: line {}", name, number);
}

/// A coordinate of a vertex.
///
/// @param number  of the line, counted from 1
/// @retval Malformed   the word is not a number
/// @retval OutOfRange  the number is not finite, or larger than a float holds
[[nodiscard]] Result<double> read_coordinate(const std::string& name, std::size_t number,
                                             std::string_view word);

/// Removes the three finite numbers of a vertex from the front of a line; more words may follow.
///
/// @param number  of the line, counted from 1
/// @retval Malformed   a word is not a number
/// @retval OutOfRange  a number is not finite
[[nodiscard]] Result<std::array<double, 3>> read_vertex(const std::string& name, std::size_t number,
                                                        std::string_view& words);

/// Visits the lines of a text that are not empty, without the blanks around them, and their
/// numbers. A line ends with LF, CR or both. An error of `visit` ends it.
template <typename Visit>
[[nodiscard]] Result<void> for_each_line(std::string_view text, const Visit& visit) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = trimmed(text.substr(0, end), " \t");
    text.remove_prefix(
        std::min(text.size(), text.substr(end).starts_with("\r\n") ? end + 2 : end + 1));
    if (line.empty()) continue;
    if (auto done = visit(line, number); !done) return done;
  }
  return {};
}

}  // namespace popcut::model_readers
