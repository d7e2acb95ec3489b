#include "vision/lens_fit.h"

#include "core/geometry.h"
#include "core/median.h"

#include <Eigen/Dense>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <opencv2/calib3d.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace fantascope::vision {
namespace {

// Fields of view, degrees, from which the search starts; the best end counts. From a far one it may
// end at a lens that mirrors the views' depths.
constexpr double kStarts[] = {50, 80, 110};
constexpr int kRounds = 5;  // of leaving out what lies far off
// A view is left out if the median distance of its corners is so many times that of all, and at
// least so many pixels; a corner likewise by its distance.
constexpr double kFarView = 2.5, kFarCorner = 5, kNear = 0.4;
constexpr double kMedianDistance = 1.1774;  // of a normal error in the plane, in standard deviations
constexpr int kUnknowns = 5;                // of the lens: focal, centre, k1, k2
constexpr double kMostDistortion = 1;       // the site file's range

// A view's corners, those that are left.
struct Points {
    std::size_t view = 0;  // of those that were given
    std::vector<cv::Point3f> board;
    std::vector<cv::Point2f> seen;
    cv::Mat turn, place;  // from the board to the camera
    double rms = 0;
    std::vector<double> distances;  // between seen and drawn
};

struct Solution {
    cv::Matx33d matrix;
    cv::Mat distortion = cv::Mat::zeros(5, 1, CV_64F);
    double rms = std::numeric_limits<double>::infinity();
    double k1() const { return distortion.at<double>(0); }
    double k2() const { return distortion.at<double>(1); }
};

std::vector<Points> pointsOf(const std::vector<BoardView>& views) {
    std::vector<Points> all;
    for (std::size_t view = 0; view < views.size(); ++view) {
        Points& points = all.emplace_back();
        points.view = view;
        for (const auto& [corner, pixel] : views[view].corners) {
            const glm::dvec2 place = LensBoard::placeOf(corner);
            points.board.emplace_back(float(place.x), float(place.y), 0.0f);
            points.seen.emplace_back(float(pixel.x), float(pixel.y));
        }
    }
    return all;
}

// Finds the lens and the views' poses, from `guess` if there is one. `terms`: how many terms of the
// distortion are free.
Solution solve(std::vector<Points>& all, glm::ivec2 size, int terms, const Solution* guess = nullptr) {
    std::vector<std::vector<cv::Point3f>> board;
    std::vector<std::vector<cv::Point2f>> seen;
    for (const Points& points : all) {
        board.push_back(points.board);
        seen.push_back(points.seen);
    }
    int flags = cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_ASPECT_RATIO | cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K3;
    if (terms < 2) flags |= cv::CALIB_FIX_K2;
    if (terms < 1) flags |= cv::CALIB_FIX_K1;
    Solution best;
    for (const double start : kStarts) {
        if (guess != nullptr && start != kStarts[0]) break;
        const double focal = size.x / 2.0 / std::tan(radians(start) / 2);
        cv::Mat matrix(cv::Matx33d(focal, 0, size.x / 2.0, 0, focal, size.y / 2.0, 0, 0, 1));
        Solution found;
        if (guess != nullptr) {
            matrix = cv::Mat(guess->matrix).clone();
            found.distortion = guess->distortion.clone();
        }
        std::vector<cv::Mat> turns, places;
        try {
            found.rms = cv::calibrateCamera(board, seen, {size.x, size.y}, matrix, found.distortion, turns, places, flags,
                                            {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12});
        } catch (const cv::Exception&) {  // no lens from this start; another may do
            continue;
        }
        if (!(found.rms < best.rms) || !cv::checkRange(matrix) || matrix.at<double>(0, 0) <= 0) continue;
        found.matrix = cv::Matx33d(matrix.ptr<double>());
        best = found;
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i].turn = turns[i].clone();
            all[i].place = places[i].clone();
        }
    }
    return best;
}

void measure(std::vector<Points>& all, const Solution& solution) {
    for (Points& points : all) {
        std::vector<cv::Point2f> drawn;
        cv::projectPoints(points.board, points.turn, points.place, solution.matrix, solution.distortion, drawn);
        points.distances.clear();
        double sum = 0;
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            points.distances.push_back(cv::norm(drawn[i] - points.seen[i]));
            sum += points.distances.back() * points.distances.back();
        }
        points.rms = std::sqrt(sum / static_cast<double>(drawn.size()));
    }
}

// Leaves out the views and the corners that lie far off. False: there are none.
bool leaveOut(std::vector<Points>& all) {
    std::vector<double> distances;
    for (const Points& points : all) distances.insert(distances.end(), points.distances.begin(), points.distances.end());
    const double usual = medianOf(distances);
    const double farView = std::max(kNear, kFarView * usual), farCorner = std::max(kNear, kFarCorner * usual / kMedianDistance);
    // The worst view alone: it may have spoilt the others.
    const auto middle = [](const Points& points) { return medianOf(points.distances); };
    const auto worst = std::ranges::max_element(all, {}, middle);
    if (middle(*worst) > farView && static_cast<int>(all.size()) > kFewestFitted) {
        all.erase(worst);
        return true;
    }
    bool any = false;
    for (Points& points : all)
        for (std::size_t i = points.seen.size(); i-- > 0;) {
            if (points.distances[i] <= farCorner || points.seen.size() <= kFewestCorners) continue;
            const auto at = static_cast<std::ptrdiff_t>(i);
            points.seen.erase(points.seen.begin() + at);
            points.board.erase(points.board.begin() + at);
            points.distances.erase(points.distances.begin() + at);
            any = true;
        }
    return any;
}

// The derivatives of a view's pixels, two rows a point: by its pose, and by the lens.
struct Slopes {
    Eigen::MatrixXd pose, lens;
};
Slopes slopesOf(const Points& points, const Solution& solution) {
    std::vector<cv::Point2f> drawn;
    cv::Mat jacobian;  // rotation, translation, two focal lengths, centre, distortion
    cv::projectPoints(points.board, points.turn, points.place, solution.matrix, solution.distortion, drawn, jacobian);
    Slopes slopes{Eigen::MatrixXd(jacobian.rows, 6), Eigen::MatrixXd(jacobian.rows, kUnknowns)};
    for (int row = 0; row < jacobian.rows; ++row) {
        for (int i = 0; i < 6; ++i) slopes.pose(row, i) = jacobian.at<double>(row, i);
        slopes.lens(row, 0) = jacobian.at<double>(row, 6) + jacobian.at<double>(row, 7);
        for (int i = 1; i < kUnknowns; ++i) slopes.lens(row, i) = jacobian.at<double>(row, 7 + i);
    }
    return slopes;
}

// The covariance of the lens's first `free` unknowns; nothing if the views leave one of them open.
// The poses are eliminated from the normal equations (Schur complement).
std::optional<Eigen::MatrixXd> covarianceOf(const std::vector<Points>& all, const Solution& solution, int free) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
    double square = 0;
    int rows = 0;
    for (const Points& points : all) {
        const Slopes slopes = slopesOf(points, solution);
        const Eigen::MatrixXd across = slopes.pose.transpose() * slopes.lens;
        normal += slopes.lens.transpose() * slopes.lens -
                  across.transpose() * (slopes.pose.transpose() * slopes.pose).ldlt().solve(across);
        for (const double distance : points.distances) square += distance * distance;
        rows += static_cast<int>(slopes.pose.rows()) - 6;
    }
    if (rows <= free) return std::nullopt;
    const Eigen::MatrixXd known = normal.topLeftCorner(free, free);
    // Directions that nothing tells of have an eigenvalue of 0 in numbers of like size.
    const Eigen::VectorXd scale = known.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(scale.asDiagonal() * known * scale.asDiagonal());
    constexpr double kNothing = 1e-12;
    if (!(parts.eigenvalues().minCoeff() > kNothing)) return std::nullopt;
    const Eigen::MatrixXd ways = scale.asDiagonal() * parts.eigenvectors();
    return square / (rows - free) * (ways * parts.eigenvalues().cwiseInverse().asDiagonal() * ways.transpose());
}

// How the pixels of directions all over the picture, two rows each, move with the lens's unknowns
// and with turns of the camera about its axes.
struct PictureSlopes {
    Eigen::MatrixXd lens, turns;
};
PictureSlopes pictureSlopesOf(const CameraModel& lens) {
    constexpr int kSteps = 8, kPlaces = (kSteps + 1) * (kSteps + 1);
    constexpr double kTurn = 1e-5;  // radians
    PictureSlopes slopes{Eigen::MatrixXd::Zero(2 * kPlaces, kUnknowns), Eigen::MatrixXd::Zero(2 * kPlaces, 3)};
    for (int i = 0; i < kPlaces; ++i) {
        const glm::dvec2 pixel = glm::dvec2(lens.size) * glm::dvec2(i % (kSteps + 1), i / (kSteps + 1)) / double(kSteps);
        const glm::dvec3 ray = lens.rayThrough(pixel).direction;
        const glm::dvec2 ideal = glm::dvec2(ray) / ray.z;
        const double r2 = glm::dot(ideal, ideal);
        const glm::dvec2 distorted = ideal * (1 + r2 * (lens.k1 + r2 * lens.k2));
        for (int axis = 0; axis < 2; ++axis)
            slopes.lens.row(2 * i + axis) << distorted[axis], axis == 0, axis == 1, lens.focal * ideal[axis] * r2,
                lens.focal * ideal[axis] * r2 * r2;
        for (int turn = 0; turn < 3; ++turn) {
            glm::dvec3 angles(0);
            angles[turn] = kTurn;
            const glm::dvec2 moved = lens.pixelFromWorld(rotationXyz(angles) * ray).value_or(pixel);
            slopes.turns(2 * i, turn) = (moved.x - pixel.x) / kTurn;
            slopes.turns(2 * i + 1, turn) = (moved.y - pixel.y) / kTurn;
        }
    }
    return slopes;
}

// The largest standard deviation of where the lens draws a direction of its picture, apart from a
// turn of all directions.
double uncertaintyOf(const std::vector<Points>& all, const Solution& solution, const CameraModel& lens, int terms) {
    const int free = kUnknowns - 2 + terms;
    const auto covariance = covarianceOf(all, solution, free);
    if (!covariance) return std::numeric_limits<double>::infinity();
    const PictureSlopes slopes = pictureSlopesOf(lens);
    const Eigen::MatrixXd seen = slopes.lens.leftCols(free);
    const Eigen::MatrixXd left = seen - slopes.turns * slopes.turns.colPivHouseholderQr().solve(seen);
    const Eigen::VectorXd variances = (left * *covariance).cwiseProduct(left).rowwise().sum();
    double most = 0;
    for (Eigen::Index row = 0; row < variances.size(); row += 2) most = std::max(most, variances(row) + variances(row + 1));
    return std::sqrt(most);
}

CameraModel modelOf(const Solution& solution, glm::ivec2 size) {
    CameraModel lens;
    lens.pose = Pose();
    lens.size = size;
    lens.focal = solution.matrix(0, 0);
    lens.centre = {solution.matrix(0, 2), solution.matrix(1, 2)};
    lens.k1 = solution.k1();
    lens.k2 = solution.k2();
    return lens;
}

}  // namespace

int LensFit::usedViews() const { return static_cast<int>(std::ranges::count_if(views, &View::used)); }

Result<LensFit> fitLens(const std::vector<BoardView>& views) {
    if (static_cast<int>(views.size()) < kFewestFitted)
        return Error(fmt::format("a lens needs at least {} views of the board, there are {}", kFewestFitted, views.size()));
    const glm::ivec2 size = views[0].size;
    std::vector<Points> all = pointsOf(views);
    int terms = 2;
    Solution solution = solve(all, size, terms);
    LensFit fit;
    fit.views.resize(views.size());
    for (int round = 0; std::isfinite(solution.rms); ++round) {
        if (terms == 2 && std::abs(solution.k2()) > kMostDistortion) {
            solution = solve(all, size, --terms);
            continue;
        }
        if (terms == 1 && std::abs(solution.k1()) > kMostDistortion) {
            solution = solve(all, size, --terms);
            continue;
        }
        measure(all, solution);
        for (const Points& points : all) fit.views[points.view].rms = points.rms;
        if (round >= kRounds + static_cast<int>(views.size()) || !leaveOut(all)) break;
        solution = solve(all, size, terms, &solution);
    }
    if (!std::isfinite(solution.rms)) return Error("no lens draws the board as these views show it");
    fit.lens = modelOf(solution, size);
    double square = 0;
    for (const Points& points : all) {
        LensFit::View& view = fit.views[points.view];
        view.used = true;
        cv::Mat turn;
        cv::Rodrigues(points.turn, turn);
        view.normal = {turn.at<double>(0, 2), turn.at<double>(1, 2), turn.at<double>(2, 2)};
        fit.points += static_cast<int>(points.seen.size());
        square += points.rms * points.rms * static_cast<double>(points.seen.size());
    }
    fit.rms = std::sqrt(square / fit.points);
    fit.uncertainty = uncertaintyOf(all, solution, fit.lens, terms);
    return fit;
}

LensNeeds needsOf(const std::vector<BoardView>& views, const LensFit* fit) {
    LensNeeds needs;
    const auto isUsed = [&](std::size_t view) { return fit == nullptr || fit->views[view].used; };
    std::array<bool, kParts.x * kParts.y> seen{};
    int used = 0;
    for (std::size_t view = 0; view < views.size(); ++view) {
        if (!isUsed(view)) continue;
        ++used;
        for (const BoardView::Corner& corner : views[view].corners) {
            const glm::ivec2 part(corner.pixel / glm::dvec2(views[view].size) * glm::dvec2(kParts));
            seen[static_cast<std::size_t>(std::clamp(part.y, 0, kParts.y - 1) * kParts.x + std::clamp(part.x, 0, kParts.x - 1))] =
                true;
        }
    }
    needs.views = std::max(0, kEnoughViews - used);
    constexpr const char* kPlaces[] = {"top left", "top",         "top right", "left",        "middle",
                                       "right",    "bottom left", "bottom",    "bottom right"};
    for (std::size_t part = 0; part < seen.size(); ++part)
        if (!seen[part]) needs.places.emplace_back(kPlaces[part]);
    // The normal points away from the camera: it leans to the edge that is nearer.
    glm::dvec2 low(0), high(0);
    for (std::size_t view = 0; fit != nullptr && view < views.size(); ++view) {
        if (!isUsed(view)) continue;
        const glm::dvec2 lean(fit->views[view].normal);
        low = glm::min(low, lean);
        high = glm::max(high, lean);
    }
    const double least = std::sin(radians(kLeastTilt));
    if (low.x > -least) needs.tilts.emplace_back("its left edge");
    if (high.x < least) needs.tilts.emplace_back("its right edge");
    if (low.y > -least) needs.tilts.emplace_back("its upper edge");
    if (high.y < least) needs.tilts.emplace_back("its lower edge");
    needs.isUncertain = fit == nullptr || fit->uncertainty > goodUncertainty(fit->lens.size);
    return needs;
}

std::string LensNeeds::sentence() const {
    std::vector<std::string> steps;
    if (!places.empty()) steps.push_back(fmt::format("hold the board at the {} of the picture", places[0]));
    if (!tilts.empty()) steps.push_back(fmt::format("turn {} towards the camera", tilts[0]));
    if (steps.empty() && (views > 0 || isUncertain)) steps.emplace_back("show the board from other sides and distances");
    return fmt::format("{}", fmt::join(steps, ", or "));
}

}  // namespace fantascope::vision
