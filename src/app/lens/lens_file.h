#pragma once

#include "app/lens/lens_result.h"

#include "show/site/site.h"

#include "device/camera_source.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// How a camera's light is stored, as measured. Both empty: not measured.
struct KeptLight {
    std::vector<double> response;       // as show::NominalCamera's
    std::vector<glm::ivec2> hotPixels;  // likewise
    friend bool operator==(const KeptLight&, const KeptLight&) = default;
};

// A camera's lens in pictures of one size, as a lens file keeps it (docs/lens.md).
struct KeptLens {
    std::string card, serial;  // of the camera; serial may be empty
    glm::ivec2 size{0};        // of the pictures, pixels
    double fieldOfView = 0;    // radians, as show::NominalCamera's; 0: no lens was measured, only light
    glm::dvec2 centre{0};      // pixels
    double k1 = 0, k2 = 0;
    double rms = 0;  // pixels
    int views = 0;
    KeptLight light;

    static KeptLens of(const LensResult& result, const CameraDescription& camera);
    // What tells the camera from others: "HD Webcam C525, serial 1234".
    std::string camera() const;
};

// The same of a camera that is there; empty: it does not say.
std::string identityOf(const CameraDescription& camera);

// Where this person's lens files are: $XDG_DATA_HOME/fantascope/lenses, or
// ~/.local/share/fantascope/lenses. Error: the environment names no such folder.
Result<std::filesystem::path> lensFolder();

// Reads a *.lens.yaml. Strict. Error: file, line, column, key.
Result<KeptLens> readLens(const std::filesystem::path& file);
// Writes the lens into its own file in the folder, and returns that. A lens without light keeps the
// light that is there, and light without a lens keeps the lens. Error: it cannot be read or
// written.
Result<std::filesystem::path> keepLens(const std::filesystem::path& folder, KeptLens lens);
// The lens of a camera in pictures of this size; nothing: none is kept. Error: its file is damaged.
Result<std::optional<KeptLens>> keptLens(const std::filesystem::path& folder, const CameraDescription& camera, glm::ivec2 size);

// Writes a lens, and the light if there is any, into the site file's camera section, and keeps the
// file as it was as FILE.previous. A camera that does not say which it is leaves no `lens_of`.
// Error: as ConfigDocument's; the file stays as it was.
Result<void> writeLens(const show::Site& site, const KeptLens& lens);

// What is wrong if the site's lens belongs to another camera than the one that is there, and what
// to do; empty: nothing is, or one of them does not say.
std::string lensMismatch(const show::Site& site, const CameraDescription& camera);

}  // namespace fantascope::app
