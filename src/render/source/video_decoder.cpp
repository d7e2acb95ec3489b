#include "render/source/video_decoder.h"

#include "render/source/premultiply.h"

#include "core/check.h"
#include "core/file.h"
#include "core/parallel.h"
#include "media/padded_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace fantascope::render {

namespace fs = std::filesystem;

namespace {

constexpr int kLargestSide = 8192;
constexpr std::int64_t kMaxPixels = std::int64_t{kLargestSide} * 4320;   // per frame: 8K, in landscape or portrait
constexpr std::int64_t kMaxDecoded = std::int64_t{kLargestSide} * 4352;  // with libav's padding of a portrait frame's rows
constexpr double kMaxMissing = 1;                                        // seconds by which a file may be shorter than it says
constexpr AVRational kNanoseconds{1, 1'000'000'000};
constexpr std::string_view kExportAgain = "export it again, as MP4 or MOV with H.264, HEVC or ProRes";

std::string reason(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

Error refusal(const fs::path& file, std::string_view why, std::string_view advice) {
    return Error(fmt::format("{}: {}; {}", file.string(), why, advice));
}

struct FormatDeleter {
    void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
struct CodecDeleter {
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct PacketDeleter {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FrameDeleter {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
using Format = std::unique_ptr<AVFormatContext, FormatDeleter>;
using Codec = std::unique_ptr<AVCodecContext, CodecDeleter>;
using Packet = std::unique_ptr<AVPacket, PacketDeleter>;
using Frame = std::unique_ptr<AVFrame, FrameDeleter>;

// An open file and its video stream.
struct Opened {
    Format format;
    AVStream* stream = nullptr;
};

// libav's names of all formats, except those that are lists of other files.
const std::string& formatsOfOneFile() {
    static const std::string formats = [] {
        constexpr std::string_view kLists[] = {"concat", "dash", "hls", "image2", "imf", "rtsp", "sdp"};
        std::string names;
        void* place = nullptr;
        while (const AVInputFormat* const format = av_demuxer_iterate(&place))
            if (std::ranges::find(kLists, std::string_view(format->name)) == std::end(kLists))
                names += std::string(format->name) + ",";
        return names;
    }();
    return formats;
}

Result<Opened> openFile(const fs::path& file) {
    av_log_set_level(AV_LOG_FATAL);  // we report a file's fault ourselves, once
    TRY(checkRegular(file));
    AVFormatContext* context = avformat_alloc_context();
    context->flags |= AVFMT_FLAG_GENPTS;
    // A file may refer to other files, pipes and the network. Only the file itself is read.
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    av_dict_set(&options, "format_whitelist", formatsOfOneFile().c_str(), 0);
    static const auto openAny = context->io_open;
    context->io_open = [](AVFormatContext* opening, AVIOContext** io, const char* url, int flags, AVDictionary** with) {
        return opening->pb == nullptr ? openAny(opening, io, url, flags, with) : AVERROR(EPERM);
    };
    const int code = avformat_open_input(&context, ("file:" + file.string()).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (code < 0)
        return refusal(file, fmt::format("not a video that can be read, or a truncated one ({})", reason(code)), kExportAgain);
    Opened opened{Format(context), nullptr};
    if (const int found = avformat_find_stream_info(context, nullptr); found < 0)
        return refusal(file, fmt::format("a damaged video ({})", reason(found)), kExportAgain);
    const int index = av_find_best_stream(context, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (index < 0 || (context->streams[index]->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0)
        return refusal(file, "there is no video in it", "name a file that has one");
    opened.stream = context->streams[index];
    return opened;
}

Result<Codec> openCodec(const fs::path& file, const AVStream& stream) {
    const AVCodec* const codec = avcodec_find_decoder(stream.codecpar->codec_id);
    if (codec == nullptr)
        return refusal(file,
                       fmt::format("coded as '{}', which cannot be decoded here", avcodec_get_name(stream.codecpar->codec_id)),
                       kExportAgain);
    Codec context(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(context.get(), stream.codecpar);
    context->pkt_timebase = stream.time_base;
    context->max_pixels = kMaxDecoded;  // for every frame, whatever the file's header says
    context->thread_count = std::min(hardwareThreads(), VideoDecoder::kThreads);
    // We start decoding only at frames where this is possible. A decoder does not know that, and
    // would withhold good frames after some keyframes without this flag.
    context->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
    if (const int code = avcodec_open2(context.get(), codec, nullptr); code < 0)
        return refusal(file, fmt::format("coded as '{}', in a way that cannot be decoded here ({})", codec->name, reason(code)),
                       kExportAgain);
    return context;
}

Result<void> checkPicture(const fs::path& file, const AVStream& stream) {
    const AVCodecParameters& picture = *stream.codecpar;
    if (picture.width < 1 || picture.height < 1) return refusal(file, "its video has no size", kExportAgain);
    if (std::max(picture.width, picture.height) > kLargestSide || std::int64_t{picture.width} * picture.height > kMaxPixels)
        return refusal(file, fmt::format("{} x {} pixels are too many", picture.width, picture.height),
                       "at most 8192 x 4320, or 4320 x 8192");
    const auto pixels = static_cast<AVPixelFormat>(picture.format);
    if (pixels != AV_PIX_FMT_NONE && sws_isSupportedInput(pixels) == 0)  // for some files it is known only after decoding
        return refusal(file, fmt::format("its pixels are stored as '{}', which cannot be converted", av_get_pix_fmt_name(pixels)),
                       kExportAgain);
    if (picture.color_trc == AVCOL_TRC_SMPTE2084 || picture.color_trc == AVCOL_TRC_ARIB_STD_B67)
        return refusal(file, "a video of high dynamic range, which no projector shows", "export it again in SDR, Rec. 709");
    if (const auto* matrix =
            reinterpret_cast<const std::int32_t*>(av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr))) {
        const double angle = av_display_rotation_get(matrix);
        if (!std::isnan(angle) && std::lround(angle) % 360 != 0)
            return refusal(file, fmt::format("its pictures are rotated by {:.0f} degrees", -angle), "export it again upright");
    }
    return {};
}

// A coded frame in the file.
struct Entry {
    std::int64_t stamp = 0, duration = 0;
    std::uint32_t decoded = 0;
    bool key = false;
};

struct Scan {
    std::vector<Entry> entries;  // in presentation order, each time stamp once
    double lasts = 0;            // seconds, of the longest stream in the file
    bool damaged = false;
};

Result<Scan> scan(const fs::path& file, const Opened& opened) {
    Scan scan;
    Packet packet(av_packet_alloc());
    std::uint32_t decoded = 0;
    int code = 0;
    for (; (code = av_read_frame(opened.format.get(), packet.get())) >= 0; av_packet_unref(packet.get())) {
        const AVStream& stream = *opened.format->streams[packet->stream_index];
        const std::int64_t stamp = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
        if (stamp != AV_NOPTS_VALUE) {
            const std::int64_t start = opened.format->start_time != AV_NOPTS_VALUE ? opened.format->start_time : 0;
            scan.lasts = std::max(scan.lasts, static_cast<double>(stamp + packet->duration) * av_q2d(stream.time_base) -
                                                  static_cast<double>(start) / AV_TIME_BASE);
        }
        if (&stream != opened.stream) continue;
        scan.damaged = scan.damaged || (packet->flags & AV_PKT_FLAG_CORRUPT) != 0;
        if (stamp == AV_NOPTS_VALUE) return refusal(file, "its frames have no time stamps", kExportAgain);
        const std::uint32_t place = decoded++;
        if ((packet->flags & AV_PKT_FLAG_DISCARD) != 0) continue;  // needed by other frames but not shown
        scan.entries.push_back({stamp, packet->duration, place, (packet->flags & AV_PKT_FLAG_KEY) != 0});
    }
    scan.damaged = scan.damaged || code != AVERROR_EOF;
    std::stable_sort(scan.entries.begin(), scan.entries.end(), [](const Entry& a, const Entry& b) { return a.stamp < b.stamp; });
    const auto same = [](const Entry& a, const Entry& b) { return a.stamp == b.stamp; };
    scan.entries.erase(std::unique(scan.entries.begin(), scan.entries.end(), same), scan.entries.end());
    return scan;
}

// Sets each frame's entry to the last keyframe that is neither decoded nor shown after it. A frame
// that is decoded after a keyframe but shown before it refers to frames before that keyframe.
void findEntries(const std::vector<Entry>& entries, std::vector<VideoContent::Frame>& frames) {
    std::vector<std::uint32_t> keys;
    for (std::uint32_t i = 0; i < entries.size(); ++i)
        if (entries[i].key) keys.push_back(i);
    if (keys.empty()) return;  // then decoding always begins at the first frame
    std::sort(keys.begin(), keys.end(),
              [&](std::uint32_t a, std::uint32_t b) { return entries[a].decoded < entries[b].decoded; });
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
        auto key = std::upper_bound(keys.begin(), keys.end(), entries[i].decoded,
                                    [&](std::uint32_t decoded, std::uint32_t k) { return decoded < entries[k].decoded; });
        while (key != keys.begin() && *std::prev(key) > i) --key;
        frames[i].entry = key == keys.begin() ? 0 : *std::prev(key);
    }
}

// How long the last frame is shown, in the stream's time base: as the file says, else as long as
// the one before.
std::int64_t lastDuration(const std::vector<Entry>& entries, const AVStream& stream) {
    if (entries.back().duration > 0) return entries.back().duration;
    if (entries.size() > 1) return entries.back().stamp - entries[entries.size() - 2].stamp;
    const AVRational rate = stream.avg_frame_rate.num > 0 ? stream.avg_frame_rate : AVRational{25, 1};
    return std::max<std::int64_t>(1, av_rescale_q(1, av_inv_q(rate), stream.time_base));
}

int matrixOf(const AVFrame& frame) {
    switch (frame.colorspace) {
        case AVCOL_SPC_BT709:
            return SWS_CS_ITU709;
        case AVCOL_SPC_BT470BG:
        case AVCOL_SPC_SMPTE170M:
            return SWS_CS_ITU601;
        case AVCOL_SPC_FCC:
            return SWS_CS_FCC;
        case AVCOL_SPC_SMPTE240M:
            return SWS_CS_SMPTE240M;
        case AVCOL_SPC_BT2020_NCL:
        case AVCOL_SPC_BT2020_CL:
            return SWS_CS_BT2020;
        default:  // a file without this information: by its height, as players do
            return frame.height >= 720 ? SWS_CS_ITU709 : SWS_CS_ITU601;
    }
}

// How a frame's values encode colours.
struct Coding {
    glm::ivec2 size{0};
    AVPixelFormat format = AV_PIX_FMT_NONE;
    int matrix = 0;
    bool fullRange = false;

    explicit Coding(const AVFrame& frame)
        : size(frame.width, frame.height),
          format(static_cast<AVPixelFormat>(frame.format)),
          matrix(matrixOf(frame)),
          fullRange(frame.color_range == AVCOL_RANGE_JPEG || has(AV_PIX_FMT_FLAG_RGB)) {}
    Coding() = default;
    bool has(std::uint64_t flag) const { return (av_pix_fmt_desc_get(format)->flags & flag) != 0; }
    friend bool operator==(const Coding&, const Coding&) = default;
};

}  // namespace

std::uint32_t VideoContent::frameAt(Time position) const {
    const auto after = std::upper_bound(frames.begin() + 1, frames.end(), position,
                                        [](Time time, const Frame& frame) { return time < frame.begins; });
    return static_cast<std::uint32_t>(after - frames.begin()) - 1;
}

struct VideoDecoder::Impl {
    std::shared_ptr<const VideoContent> content;
    Opened file;
    Codec codec;
    Packet packet{av_packet_alloc()};
    Frame frame{av_frame_alloc()};
    SwsContext* toRgba = nullptr;
    Coding coding;               // of the frames that toRgba converts
    PaddedRows<Rgba8> rows;      // for libswscale
    std::uint32_t earliest = 0;  // the lowest frame number that next() may return
    bool waiting = false;        // `packet` is not decoded yet
    bool drained = false;        // the decoder has been told that the file ended
    std::string damage;

    ~Impl() { sws_freeContext(toRgba); }

    void note(std::string_view what, int code) {
        if (damage.empty())
            damage = fmt::format("{}: after frame {}: {} ({})", content->file.string(), earliest, what, reason(code));
    }

    // The number of the frame with this time stamp, or of the last one before it.
    std::uint32_t numberOf(std::int64_t stamp) const {
        const auto& frames = content->frames;
        const auto after =
            std::upper_bound(frames.begin(), frames.end(), stamp,
                             [](std::int64_t wanted, const VideoContent::Frame& one) { return wanted < one.stamp; });
        return after == frames.begin() ? 0 : static_cast<std::uint32_t>(after - frames.begin()) - 1;
    }

    // Sets toRgba up for the frame. False: its pixels cannot be converted.
    bool converts() {
        const Coding newest(*frame);
        if (newest == coding) return toRgba != nullptr;
        coding = newest;
        sws_freeContext(toRgba);
        // Without SWS_ACCURATE_RND, most videos are converted in .7 ms instead of 11 ms (1920 x
        // 1080), with an error of less than 1 of 255.
        toRgba = sws_getContext(coding.size.x, coding.size.y, coding.format, content->size.x, content->size.y, AV_PIX_FMT_RGBA,
                                SWS_BILINEAR | SWS_FULL_CHR_H_INT, nullptr, nullptr, nullptr);
        if (toRgba == nullptr) return false;
        constexpr int kOne = 1 << 16, kFull = 1;
        const int* const matrix = sws_getCoefficients(coding.matrix);
        sws_setColorspaceDetails(toRgba, matrix, coding.fullRange ? kFull : 0, matrix, kFull, 0, kOne, kOne);
        return true;
    }

    // Reads the video's next packet. False at the end.
    bool read() {
        for (;;) {
            av_packet_unref(packet.get());
            const int code = av_read_frame(file.format.get(), packet.get());
            if (code < 0) {
                if (code != AVERROR_EOF) note("cannot be read", code);
                return false;
            }
            if (packet->stream_index == file.stream->index) return true;
        }
    }

    // Seeks to `entry` or before it. Containers index keyframes by decoding or by presentation time
    // stamps, and some only guess.
    void reach(std::uint32_t entry) {
        for (std::uint32_t target = entry;; target = content->frames[target - 1].entry) {
            const int code =
                av_seek_frame(file.format.get(), file.stream->index, content->frames[target].stamp, AVSEEK_FLAG_BACKWARD);
            waiting = code >= 0 && read();
            if (waiting && comesBefore(*packet, entry)) return;
            if (target == 0) break;
        }
        if (auto again = openFile(content->file)) file = std::move(*again);
        waiting = read();
    }
    bool comesBefore(const AVPacket& one, std::uint32_t entry) const {
        const std::int64_t stamp = one.pts != AV_NOPTS_VALUE ? one.pts : one.dts;
        return stamp != AV_NOPTS_VALUE && content->frames[numberOf(stamp)].decoded <= content->frames[entry].decoded;
    }
};

Result<std::shared_ptr<const VideoContent>> VideoDecoder::examine(const fs::path& file) {
    const Opened opened = TRY(openFile(file));
    const AVStream& stream = *opened.stream;
    TRY(checkPicture(file, stream));
    TRY(openCodec(file, stream));
    const double says = static_cast<double>(opened.format->duration) / AV_TIME_BASE;
    const bool knows = opened.format->duration > 0 && opened.format->duration_estimation_method == AVFMT_DURATION_FROM_STREAM;
    Scan found = TRY(scan(file, opened));
    if (found.entries.empty()) return refusal(file, "there is no frame in it", kExportAgain);
    if (found.damaged || (knows && found.lasts < says - kMaxMissing))
        return refusal(file, fmt::format("truncated: it ends after {:.1f} s of {:.1f} s", found.lasts, says),
                       "copy it again, whole");

    auto content = std::make_shared<VideoContent>();
    content->file = file;
    content->codec = avcodec_get_name(stream.codecpar->codec_id);
    content->size = {stream.codecpar->width, stream.codecpar->height};
    const std::int64_t first = found.entries.front().stamp;
    const auto begins = [&](std::int64_t stamp) { return Time(av_rescale_q(stamp - first, stream.time_base, kNanoseconds)); };
    for (const Entry& entry : found.entries) content->frames.push_back({begins(entry.stamp), entry.stamp, entry.decoded, 0});
    findEntries(found.entries, content->frames);
    content->length = begins(found.entries.back().stamp + lastDuration(found.entries, stream));
    return std::shared_ptr<const VideoContent>(std::move(content));
}

Result<std::unique_ptr<VideoDecoder>> VideoDecoder::open(std::shared_ptr<const VideoContent> content) {
    auto impl = std::make_unique<Impl>();
    impl->file = TRY(openFile(content->file));
    impl->codec = TRY(openCodec(content->file, *impl->file.stream));
    for (unsigned i = 0; i < impl->file.format->nb_streams; ++i)
        if (impl->file.format->streams[i] != impl->file.stream) impl->file.format->streams[i]->discard = AVDISCARD_ALL;
    impl->content = std::move(content);
    std::unique_ptr<VideoDecoder> decoder(new VideoDecoder(std::move(impl)));
    decoder->seek(0);
    return decoder;
}

VideoDecoder::VideoDecoder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoDecoder::~VideoDecoder() = default;

const std::string& VideoDecoder::damage() const { return impl_->damage; }

void VideoDecoder::seek(std::uint32_t frame) {
    FANTASCOPE_CHECK(frame < impl_->content->frames.size(), "the frame is one of the video's");
    const std::uint32_t entry = impl_->content->frames[frame].entry;
    avcodec_flush_buffers(impl_->codec.get());
    impl_->reach(entry);
    impl_->earliest = entry;
    impl_->drained = false;
}

std::optional<std::uint32_t> VideoDecoder::next() {
    Impl& impl = *impl_;
    for (;;) {
        const int code = avcodec_receive_frame(impl.codec.get(), impl.frame.get());
        if (code == AVERROR_EOF) return std::nullopt;
        if (code == AVERROR(EAGAIN)) {
            if (impl.drained) return std::nullopt;
            if (!std::exchange(impl.waiting, false) && !impl.read()) {
                impl.drained = true;
                avcodec_send_packet(impl.codec.get(), nullptr);
                continue;
            }
            if (const int sent = avcodec_send_packet(impl.codec.get(), impl.packet.get()); sent < 0) impl.note("damaged", sent);
            continue;
        }
        if (code < 0) {
            impl.note("damaged", code);
            continue;
        }
        const AVFrame& frame = *impl.frame;
        const std::int64_t stamp = frame.best_effort_timestamp;
        const std::uint32_t number = stamp == AV_NOPTS_VALUE ? impl.earliest : impl.numberOf(stamp);
        if (number < impl.earliest || number >= impl.content->frames.size())
            continue;  // it refers to frames that were not decoded
        if (frame.decode_error_flags != 0) {
            impl.note("damaged", AVERROR_INVALIDDATA);
            continue;
        }
        if (!impl.converts()) {  // a file's pixel format may change midway
            impl.note(fmt::format("its pixels are stored as '{}'", av_get_pix_fmt_name(impl.coding.format)), AVERROR(ENOSYS));
            continue;
        }
        impl.earliest = number + 1;
        return number;
    }
}

void VideoDecoder::picture(RgbaImage& picture) {
    Impl& impl = *impl_;
    const AVFrame& frame = *impl.frame;
    FANTASCOPE_CHECK(glm::ivec2(picture.width(), picture.height()) == impl.content->size, "the picture has the video's size");
    impl.rows.fill(picture, [&](std::uint8_t* rows, int stride) {
        sws_scale(impl.toRgba, frame.data, frame.linesize, 0, frame.height, &rows, &stride);
    });
    if (impl.coding.has(AV_PIX_FMT_FLAG_ALPHA)) premultiply(picture.pixels());
}

}  // namespace fantascope::render
