// SPDX-License-Identifier: MIT
#include "daemon/pictures/png.hpp"

#include <cstdint>

#include <png.h>

namespace popcut {

/// Compressed quickly: drawings are small anyway, and a design should not wait for its pictures.
Result<std::string> png_of_pixels(std::span<const std::uint8_t> rgb, int width, int height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width), image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  std::string png(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = png.size();
  if (png_image_write_to_memory(&image, png.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    return fail(ErrorKind::Internal, "picture", std::string("cannot be written: ") + image.message);
  png.resize(size);
  return png;
}

}  // namespace popcut
