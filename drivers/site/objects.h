#pragma once
// The `objects` of the `simulation:` section; README.md lists their keys.

#include "drivers/site/scene.h"

#include "core/config/config.h"

namespace fantascope::site {

// Strict. Reads the meshes and pictures that the object names. Error: file, line, column, key.
Result<SceneObject> readObject(const ConfigNode& node);

}  // namespace fantascope::site
