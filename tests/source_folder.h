#pragma once

#include <string>

namespace fantascope {

// The root of the source tree. Only source_folder.cpp is compiled with this path, so another clone
// finds all other objects in ccache.
std::string sourceFolder();

}  // namespace fantascope
