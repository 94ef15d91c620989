// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut::client {

/// What a person types for a member of a request ("/from_path": "--from"), an option of a plan
/// ("/options/mat": "--mat") or a name of the query ("?limit": "--limit"). Empty: nothing does.
[[nodiscard]] std::string option_for(std::string_view pointer);

/// An action of the interface as popcut's command: "retry-sheet" is "retry".
[[nodiscard]] std::string command_for(std::string_view action);

/// `text` with the members, actions and plan options that it names as a person types them: "say
/// i_accept_double_cut" becomes "say --accept-double-cut", and "use `mat` 12x24" "use --mat 12x24".
[[nodiscard]] std::string in_command_words(std::string text);

/// An error about an option of a plan as one about the command line: its place "/options/mat" is
/// "--mat", and so in its text. Others stay as they are.
[[nodiscard]] Error on_command_line(Error error);

}  // namespace popcut::client
