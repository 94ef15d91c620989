// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace popcut::client {

/// What a person types for a member of a request ("/from_path": "--from"), an option of a plan
/// ("/options/mat": "--mat") or a name of the query ("?limit": "--limit"). Empty: nothing does.
[[nodiscard]] std::string option_for(std::string_view pointer);

/// An action of the interface as popcut's command: "retry-sheet" is "retry".
[[nodiscard]] std::string command_for(std::string_view action);

/// `text` of popcutd with the members and actions that it names as a person types them: "say
/// i_accept_double_cut" becomes "say --accept-double-cut".
[[nodiscard]] std::string in_command_words(std::string text);

}  // namespace popcut::client
