// SPDX-License-Identifier: MIT
// Part of daemon/planning/engine/engine.hpp. engine.wasm: one function for a Web Worker.
#include <cstddef>
#include <string_view>

#include <emscripten.h>

#include "daemon/planning/engine/engine.hpp"
#include "daemon/planning/engine/tables.hpp"

namespace popcut::planning {
namespace {

// clang-format off
EM_JS(void, hand_over, (int kind, const char* name, std::size_t name_size, const char* bytes, std::size_t size), {
  const text = HEAPU8.subarray(name, name + name_size);
  Module.onFrame(kind, String.fromCharCode(...text), HEAPU8.slice(bytes, bytes + size));
});
// clang-format on

Result<void> send(FrameKind kind, std::string_view name, std::string_view bytes) {
  hand_over(static_cast<int>(kind), name.data(), name.size(), bytes.data(), bytes.size());
  return {};
}

}  // namespace
}  // namespace popcut::planning

/// Calls Module.onFrame with popcut's own tables as a file, see `popcut::planning::tables_text`.
extern "C" EMSCRIPTEN_KEEPALIVE void popcut_tables() {
  using namespace popcut::planning;
  if (const auto text = tables_text()) (void)send(FrameKind::File, "tables.json", *text);
}

/// Does the task of these frames; calls Module.onFrame(kind, name, bytes) for each frame of what
/// comes of it, see `popcut::planning::answer`.
extern "C" EMSCRIPTEN_KEEPALIVE void popcut_answer(const char* bytes, std::size_t size) {
  using namespace popcut::planning;
  const auto read = [&]() -> popcut::Result<WorkerTask> {
    TaskReader task;
    if (const auto fed = task.feed({bytes, size}); !fed) return tl::unexpected(fed.error());
    return task.take();
  };
  (void)answer(read, send, [] { return std::string_view(); });
}
