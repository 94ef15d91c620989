// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/result.hpp"

namespace popcut::client {

/// The command-line name of a member of a request ("/from_path": "--from"), an option of a plan
/// ("/options/mat": "--mat") or a name of the query ("?limit": "--limit"). Empty: there is none.
[[nodiscard]] std::string option_for(std::string_view pointer);

/// The popcut command for an action of the API: "retry-sheet" is "retry".
[[nodiscard]] std::string command_for(std::string_view action);

/// The whole command for a request of the API that popcutd offers (`ways`), of this job unless it
/// names another job or a device; empty: there is none. resume-from of {"from_path": 6,
/// "skip_in_doubt": true} is "popcut resume 01JDX7 --from 6 --skip-in-doubt". Values are quoted for
/// a shell where they need it.
[[nodiscard]] std::string command_line_for(const nlohmann::json& way, const std::string& job);

/// What becomes of paths in doubt, for the resumes among `ways` ("skips what is in doubt"); empty:
/// nothing is in doubt.
[[nodiscard]] std::string meaning_of(const nlohmann::json& way);

/// `text` with members, actions and plan options under their command-line names: "say
/// i_accept_double_cut" becomes "say --accept-double-cut"; "use `mat` 12x24" becomes "use --mat
/// 12x24".
[[nodiscard]] std::string in_command_words(std::string text);

/// Words an error about an option of a plan or a search for the command line: place "/options/mat"
/// becomes "--mat", and so do options in its text. Other errors stay unchanged.
[[nodiscard]] Error on_command_line(Error error);

/// A word of a command line, in single quotes for a shell where it needs them.
[[nodiscard]] std::string quoted(const std::string& word);

}  // namespace popcut::client
