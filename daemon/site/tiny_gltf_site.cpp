// SPDX-License-Identifier: MIT
// Part of core/model/model.hpp. tinygltf without a reader of pictures: popcut reads those itself.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
