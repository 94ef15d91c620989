// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include "core/text/json_text.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {

/// Prints `document` on standard output, indented.
void print_json(const auto& document) { fmt::print("{}", json_file(document)); }

/// The answer of a command: `document` if the user gave `--json`, else what `tell()` prints.
template <typename Document, typename Tell>
Result<void> answer(const Globals& globals, const Document& document, const Tell& tell) {
  if (globals.json)
    print_json(document);
  else
    tell();
  return {};
}

/// Does `work(api)` with the popcutd that the environment names (`client::addresses`). Returns what
/// `work` returns.
///
/// @retval Usage  POPCUT_URL or POPCUT_TOKEN is not valid
template <typename Work>
auto with_popcutd(const Work& work) -> decltype(work(std::declval<client::Api&>())) {
  auto api = client::Api::from_environment();
  if (!api) return tl::unexpected(api.error());
  try {
    return work(*api);
  } catch (const nlohmann::json::exception&) {
    // Commands read answers as this version of popcutd writes them.
    return fail(ErrorKind::Refused, api->http().address().text(),
                "answers what this popcut does not understand; check POPCUT_URL, and that popcutd "
                "there has the same version");
  }
}

/// Asks popcutd with `ask(api)`, which returns a document, and answers with it: the document itself
/// if the user gave `--json`, else what `tell(document)` prints.
template <typename Ask, typename Tell>
Result<void> answer_of_popcutd(const Globals& globals, const Ask& ask, const Tell& tell) {
  return with_popcutd([&](client::Api& api) -> Result<void> {
    const auto document = ask(api);
    if (!document) return tl::unexpected(document.error());
    return answer(globals, *document, [&] { tell(*document); });
  });
}

}  // namespace popcut::cli
