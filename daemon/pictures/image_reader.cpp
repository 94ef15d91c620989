// SPDX-License-Identifier: MIT
#include "daemon/pictures/image_reader.hpp"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <jerror.h>
#include <jpeglib.h>
#include <png.h>

namespace popcut {
namespace {

tl::unexpected<Error> unreadable(const std::string& name, std::string_view why) {
  return fail(
      ErrorKind::Malformed, name,
      fmt::format("is a picture that cannot be read: {}; save it again as PNG or JPEG", why));
}

constexpr int kMostScans = 200;  // of a JPEG; each is a pass over all its pixels

Result<void> check_size(const std::string& name, std::size_t width, std::size_t height,
                        std::size_t most) {
  if (width > 0 && height > 0 && width <= most / height) return {};
  const std::size_t tenths = most / 100'000;  // of a million
  return fail(ErrorKind::OutOfRange, name,
              fmt::format("has {} x {} pixels; a picture has from 1 to {} million: make it smaller",
                          width, height, static_cast<double>(tenths) / 10));
}

Result<ColourImage> read_png(const std::string& name, std::string_view bytes, std::size_t most) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0)
    return unreadable(name, image.message);
  if (auto sized = check_size(name, image.width, image.height, most); !sized) {
    png_image_free(&image);
    return tl::unexpected(sized.error());
  }
  image.format = PNG_FORMAT_RGBA;
  ColourImage out(image.width, image.height);
  if (png_image_finish_read(&image, nullptr, out.rgba.data(), 0, nullptr) == 0)
    return unreadable(name, image.message);
  return out;
}

/// libjpeg ends a program on an error unless it is told where to go on.
struct JpegErrors : jpeg_error_mgr {
  std::jmp_buf back;
  std::array<char, JMSG_LENGTH_MAX> words;
};

void leave(j_common_ptr info) {
  auto* errors = static_cast<JpegErrors*>(info->err);
  errors->format_message(info, errors->words.data());
  if (errors->msg_code == JERR_CONVERSION_NOTIMPL)
    std::snprintf(errors->words.data(), errors->words.size(),
                  "its colours are CMYK and must be RGB");
  std::longjmp(errors->back, 1);
}

void say_nothing(j_common_ptr) {}

/// Called while a picture of several scans is read.
void count_scans(j_common_ptr info) {
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number <= kMostScans) return;
  auto* errors = static_cast<JpegErrors*>(info->err);
  std::snprintf(errors->words.data(), errors->words.size(), "it has more than %d scans",
                kMostScans);
  std::longjmp(errors->back, 1);
}

/// Of what libjpeg would only warn of, an end in the middle is an error: it fills the rest with
/// grey.
void on_message(j_common_ptr info, int level) {
  const int code = info->err->msg_code;
  if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) leave(info);
}

/// Only plain values live here, since a jump skips destructors. `take` gets the size, once, and
/// says where the pixels go, or null to end.
bool decode_jpeg(std::string_view bytes, JpegErrors& errors, void* user,
                 unsigned char* (*take)(void* user, std::size_t width, std::size_t height)) {
  jpeg_decompress_struct info{};
  jpeg_progress_mgr progress{};
  progress.progress_monitor = count_scans;
  info.err = jpeg_std_error(&errors);
  errors.error_exit = leave;
  errors.output_message = say_nothing;
  errors.emit_message = on_message;
  if (setjmp(errors.back) != 0) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  info.progress = &progress;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  info.out_color_space = JCS_EXT_RGBA;
  unsigned char* row = take(user, info.image_width, info.image_height);
  if (row != nullptr) {
    jpeg_start_decompress(&info);
    const std::size_t stride = 4 * static_cast<std::size_t>(info.output_width);
    while (info.output_scanline < info.output_height) {
      jpeg_read_scanlines(&info, &row, 1);
      row += stride;
    }
    jpeg_finish_decompress(&info);
  }
  jpeg_destroy_decompress(&info);
  return row != nullptr;
}

Result<ColourImage> read_jpeg(const std::string& name, std::string_view bytes, std::size_t most) {
  struct Taken {
    const std::string& name;
    std::size_t most;
    ColourImage image{};
    Result<void> sized{};
  } taken{name, most};
  JpegErrors errors{};
  const bool read =
      decode_jpeg(bytes, errors, &taken,
                  [](void* user, std::size_t width, std::size_t height) -> unsigned char* {
                    auto& to = *static_cast<Taken*>(user);
                    to.sized = check_size(to.name, width, height, to.most);
                    if (!to.sized) return nullptr;
                    to.image = ColourImage(width, height);
                    return to.image.rgba.data();
                  });
  if (!taken.sized) return tl::unexpected(taken.sized.error());
  if (!read) return unreadable(name, errors.words.data());
  return std::move(taken.image);
}

}  // namespace

Result<ColourImage> read_image(const std::string& name, std::string_view bytes,
                               std::size_t most_pixels) {
  if (bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n") return read_png(name, bytes, most_pixels);
  if (bytes.substr(0, 2) == "\xFF\xD8") return read_jpeg(name, bytes, most_pixels);
  return unreadable(name, "it is neither PNG nor JPEG");
}

Result<std::string> png_of_image(const ColourImage& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.width);
  image.height = static_cast<png_uint_32>(pixels.height);
  image.format = PNG_FORMAT_RGBA;
  image.flags = PNG_IMAGE_FLAG_FAST;
  std::string png(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = png.size();
  if (png_image_write_to_memory(&image, png.data(), &size, 0, pixels.rgba.data(), 0, nullptr) == 0)
    return fail(ErrorKind::Internal, "picture", fmt::format("cannot be packed: {}", image.message));
  png.resize(size);
  return png;
}

}  // namespace popcut
