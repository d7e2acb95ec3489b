#pragma once
// The format of the picture on a key with a small display.

#include "device/cue_controller.h"

#include "media/image.h"

#include <cstdint>
#include <vector>

namespace fantascope::drivers {

struct KeyPictureFormat {
    enum class Coding {
        Jpeg,
        Bmp  // 24 bits, the bottom row first
    };
    enum class Turn {
        None,
        Half,       // rotated by 180 degrees
        Transposed  // rows and columns exchanged
    };
    int side = 72;  // pixels
    Coding coding = Coding::Jpeg;
    Turn turn = Turn::None;  // of the picture in the file relative to the operator's view
};

// A key's colour for a state; black when off.
Rgba8 colourOf(ButtonLight::State state);

// The picture as the operator sees it: the colour of its state, and the word as large as fits.
// `side` pixels square.
RgbaImage keyPicture(const ButtonLight& light, int side);

// The same as a file in the device's format.
std::vector<std::uint8_t> keyPictureFile(const ButtonLight& light, const KeyPictureFormat& format);

}  // namespace fantascope::drivers
