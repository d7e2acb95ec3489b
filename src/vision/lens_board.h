#pragma once
// The board whose pictures tell a camera's lens: a chessboard whose white squares hold markers, so
// that a part of it is enough (ChArUco: Garrido-Jurado et al. 2014 for the markers, and OpenCV's
// module aruco for their place on a chessboard).

#include "media/image.h"

#include <glm/vec2.hpp>

#include <optional>
#include <vector>

namespace fantascope::vision {

// There is one board only, in any size: what a picture of it tells of the lens does not depend on
// the size. Thread: every function is reentrant.
struct LensBoard {
    static constexpr glm::ivec2 kSquares{9, 6};  // across and down
    // A square is so many cells wide. A marker has 6 x 6 of them, in the middle of a white square.
    static constexpr int kCells = 8;
    // How many corners lie between the squares: the places that are found in a picture.
    static constexpr int kCorners = (kSquares.x - 1) * (kSquares.y - 1);

    // A rectangle in cells, y down, from the board's top left.
    struct Box {
        glm::ivec2 low, high;
        bool dark;
    };
    // The whole drawing on white: later boxes lie on earlier ones. Where white boxes touch, others
    // cover the seam.
    static std::vector<Box> boxes();
    // The place of a corner, 0 .. kCorners - 1, in squares, y down, from the board's top left.
    static glm::dvec2 placeOf(int corner);
};

// What one picture shows of the board.
struct BoardView {
    struct Corner {
        int corner;        // of LensBoard
        glm::dvec2 pixel;  // in the picture
    };
    glm::ivec2 size{0};  // of the picture, pixels
    std::vector<Corner> corners;
};

// Finds the board in a picture of stored values. Nothing if fewer than kFewestCorners of its
// corners are seen, or if they lie on one line.
constexpr std::size_t kFewestCorners = 8;
std::optional<BoardView> findBoard(const RgbaImage& picture);

}  // namespace fantascope::vision
