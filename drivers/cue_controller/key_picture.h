#pragma once
// The picture on a key that is a small display.

#include "device/cue_controller.h"

#include "media/image.h"

#include <cstdint>
#include <vector>

namespace fantascope::drivers {

struct KeyPictureFormat {
    enum class Coding {
        Jpeg,
        Bmp  // 24 bits, its last row first
    };
    enum class Turn {
        None,
        Half,       // upside down and mirrored
        Transposed  // rows for columns
    };
    int side = 72;  // pixels
    Coding coding = Coding::Jpeg;
    Turn turn = Turn::None;  // of the picture in the file against what the operator sees
};

// What a key has as its colour: black when it is off.
Rgba8 colourOf(ButtonLight::State state);

// The picture as the operator sees it: the colour of its state, and the word as large as it fits.
// `side` pixels square.
RgbaImage keyPicture(const ButtonLight& light, int side);

// The same as the file that the device wants.
std::vector<std::uint8_t> keyPictureFile(const ButtonLight& light, const KeyPictureFormat& format);

}  // namespace fantascope::drivers
