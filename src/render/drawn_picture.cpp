#include "render/drawn_picture.h"

#include "render/gpu/paint/picture_painter.h"
#include "render/gpu/picture_texture.h"
#include "render/source/premultiply.h"

#include "core/check.h"
#include "core/geometry.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::render {
namespace {

// The maximum number of texels along a side that a pixel covers. With a keystone, it is reached in
// one of the corners.
double maxTexels(const CanvasPlace& place, glm::ivec2 size) {
    constexpr double kStep = 1e-3;  // pixels
    const Homography canvasFromProjector = place.warp.keystone().inverse();
    double most = 0;
    for (const glm::dvec2 corner : place.warp.shape().corners)
        for (const glm::dvec2 side : {glm::dvec2(kStep, 0), glm::dvec2(0, kStep)}) {
            const glm::dvec2 across = canvasFromProjector(corner + side) - canvasFromProjector(corner - side);
            most = std::max(most, glm::length(across * glm::dvec2(size)) / (2 * kStep));
        }
    return most;
}

struct PictureOnCanvas {
    gpu::PictureTexture texture;
    gpu::PicturePainter painter;

    static Result<PictureOnCanvas> create(glm::ivec2 size, const CanvasPlace& place, const gpu::Bend& bend, DrawingTools& tools) {
        // Twice: a mesh, or a warp that changes while the show runs, can make a pixel cover more.
        const bool small = 2 * maxTexels(place, size) > gpu::PicturePainter::kMaxTaps;
        auto texture = TRY(gpu::PictureTexture::create(size, small ? gpu::Mipmaps::All : gpu::Mipmaps::None));
        auto painter = TRY(gpu::PicturePainter::create(bend, tools.programs));
        painter.follow(place);
        return PictureOnCanvas{std::move(texture), std::move(painter)};
    }
    void paint(gpu::LayerPicture& picture) {
        picture.begin();
        painter.paint(texture);
    }
};

class DrawnImage : public DrawnSource {
public:
    explicit DrawnImage(PictureOnCanvas image) : image_(std::move(image)) {}

    void paint(const Moment&, gpu::LayerPicture& picture) override { image_.paint(picture); }
    void follow(const CanvasPlace& place) override { image_.painter.follow(place); }

private:
    PictureOnCanvas image_;
};

class DrawnVideo : public DrawnSource {
public:
    DrawnVideo(const VideoSource& source, PictureOnCanvas frame, gpu::PictureUploader uploader, Stopwatch& uploads)
        : source_(source), reader_(source.stream), frame_(std::move(frame)), uploader_(std::move(uploader)), uploads_(uploads) {}

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        const auto position = positionAt(source_, moment.ofLayer);
        if (!position) return picture.begin();  // nothing
        reader_.at(*position, [&](const RgbaImage& frame) { uploads_.time([&] { uploader_.upload(frame, frame_.texture); }); });
        frame_.paint(picture);
    }
    void follow(const CanvasPlace& place) override { frame_.painter.follow(place); }

private:
    VideoSource source_;
    VideoStream::Reader reader_;
    PictureOnCanvas frame_;
    gpu::PictureUploader uploader_;
    Stopwatch& uploads_;
};

class DrawnCamera : public DrawnSource {
public:
    DrawnCamera(const CameraSource& source, PictureOnCanvas frame, gpu::PictureUploader uploader, Stopwatch& uploads)
        : source_(source),
          newest_(source_.feed->addReader()),
          frame_(std::move(frame)),
          uploader_(std::move(uploader)),
          uploads_(uploads) {}

    void paint(const Moment&, gpu::LayerPicture& picture) override {
        if (newest_->update()) uploads_.time([&] { uploader_.upload(*newest_->value(), frame_.texture); });
        frame_.paint(picture);
    }
    void follow(const CanvasPlace& place) override { frame_.painter.follow(place); }

private:
    CameraSource source_;
    std::shared_ptr<PictureFeed::Slot> newest_;
    PictureOnCanvas frame_;
    gpu::PictureUploader uploader_;
    Stopwatch& uploads_;
};

using Made = Result<std::unique_ptr<DrawnSource>>;

Made imageOn(const CanvasPlace& place, const ImageSource& source, const gpu::Bend& bend, DrawingTools& tools) {
    FANTASCOPE_CHECK(source.picture != nullptr, "an image source has a picture");
    RgbaImage picture = *source.picture;
    premultiply(picture.pixels());
    auto image = TRY(PictureOnCanvas::create({picture.width(), picture.height()}, place, bend, tools));
    image.texture.set(picture);
    return std::unique_ptr<DrawnSource>(new DrawnImage(std::move(image)));
}

}  // namespace

Made makeDrawnImage(const ImageSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return imageOn(place, source, tools.bend, tools);
}

Made makeDrawnCard(const ImageSource& source, glm::ivec2 size, DrawingTools& tools) {
    return imageOn({size, Warp::straight(size)}, source, tools.straight, tools);
}

Made makeDrawnVideo(const VideoSource& source, const CanvasPlace& place, DrawingTools& tools) {
    FANTASCOPE_CHECK(source.stream != nullptr, "a video source has a stream");
    auto frame = TRY(PictureOnCanvas::create(source.stream->content().size, place, tools.bend, tools));
    auto uploader = TRY(gpu::PictureUploader::create(frame.texture.size()));
    return std::unique_ptr<DrawnSource>(new DrawnVideo(source, std::move(frame), std::move(uploader), tools.uploads));
}

Made makeDrawnCamera(const CameraSource& source, const CanvasPlace& place, DrawingTools& tools) {
    FANTASCOPE_CHECK(source.feed != nullptr, "a camera source has a feed");
    auto frame = TRY(PictureOnCanvas::create(source.feed->size(), place, tools.bend, tools));
    auto uploader = TRY(gpu::PictureUploader::create(frame.texture.size()));
    return std::unique_ptr<DrawnSource>(new DrawnCamera(source, std::move(frame), std::move(uploader), tools.uploads));
}

}  // namespace fantascope::render
