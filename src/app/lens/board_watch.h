#pragma once

#include "vision/lens_fit.h"
#include "vision/picture_trouble.h"

#include "media/image.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// How many pictures showed what, where no board was found in them.
struct Missed {
    int pictures = 0, black = 0, saturated = 0;
    bool frozen = false;  // the camera went on with one picture to the end

    void count(vision::PictureTrouble trouble);
    // Why no board was found, and what to do: "the pictures are black; light the board, ...".
    std::string why() const;
};

// Collects views of the board from a camera's frames while a person moves it, and says what to do
// next. A view counts if the board stood still and lay elsewhere before. A view that does not fit
// the others is thrown away, so its place is asked for again. Thread: one at a time.
class BoardWatch {
public:
    // Takes a frame into account, in some 10 ms, or some 100 ms for a new view. All frames have one
    // size. True: it is a new view.
    bool look(const RgbaImage& frame);

    // What the person with the board is to do now.
    const std::string& advice() const { return advice_; }
    // The finished share, 0..1.
    double done() const;
    // Whether nothing is missing any more.
    bool isComplete() const { return fit_ && needs_.none(); }
    const std::vector<vision::BoardView>& views() const { return views_; }
    int thrownAway() const { return thrownAway_; }
    const Missed& missed() const { return missed_; }

private:
    bool isFrozen(const RgbaImage& frame);
    bool isStill(const vision::BoardView& view) const;
    bool isNew(const vision::BoardView& view) const;
    void fit();

    std::vector<vision::BoardView> views_;
    std::optional<vision::LensFit> fit_;
    vision::LensNeeds needs_ = vision::needsOf({}, nullptr);
    std::optional<vision::BoardView> before_;  // in the last frame
    std::string advice_ = "show the board to the camera";
    Missed missed_;
    RgbaImage last_;
    int same_ = 0;  // frames that were the last one again
    int thrownAway_ = 0;
};

}  // namespace fantascope::app
