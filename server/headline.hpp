#pragma once
#include <string>

namespace quicksand {

/// What an engineer wants to read of an ended run, some lines of text: when the sand moved and by how much,
/// head and gradient then against the critical one, water-volume drift and cost. `report`: the text of
/// run.json.
std::string headline_text(const std::string& report);

/// Which result files lie in `folder` and how to open them.
std::string files_text(const std::string& folder);

}  // namespace quicksand
