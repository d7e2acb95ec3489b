#pragma once

#include "app/reload/file_watch.h"
#include "app/reload/source_stock.h"

#include "pattern/shape/shape_pattern.h"
#include "render/source/picture_source.h"
#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"
#include "show/revision.h"
#include "show/source.h"
#include "show/source_id.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/projection.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fantascope::app {

// Takes a show over that is saved while it plays.
//
// A show that was saved, or a file of one of its sources, is read on this part's own thread. A
// source whose entry or file has changed is another source from then on, with an id of its own. The
// renderers are made ready for it (SourceStock), and only then the input comes that continues with
// the new cue list: what is seen fades from the old source to the new one (CuePlayer). If anything
// is wrong, the operator is told why and where, and the show goes on as it was. What cannot be read
// is read again every kRetry: a file that it names may only be on its way.
//
// Where the drawing of a light pattern was saved, and not the pattern, the pattern is drawn again
// from where it is (RedrawnPattern). That lasts until the show ends; the pattern's file stays.
//
// A site file that was saved gives its outputs' projections to who sets outputs up. All else of the
// site stays as it was read at the start; who saves its file is told so.
// Thread: one at a time.
class ShowReload {
public:
    // Reads the files of a source.
    using Read = std::function<Result<render::PictureSource>(const show::Source&)>;
    // The files of a run, and what becomes of them.
    struct Files {
        Read source;
        std::function<Result<show::Site>(const std::filesystem::path&)> site;
        std::function<void(std::vector<Projection>)> adopt;  // takes the projections of all outputs over
    };
    // All arguments by reference outlive this, except `showClock`. `names`: as the first revision
    // was read with them.
    ShowReload(show::PlayedShow& show, const show::SourceNames& names, Files files, SourceStock& stock, show::InputLog& inputs,
               show::EventLog& events, const show::ShowClock& showClock);

    static constexpr double kRate = 10;  // Hz; a file must stay the same from one look to the next
    static constexpr Time kRetry = std::chrono::seconds(2);
    void tick(Time moment);

private:
    using Paths = std::set<std::filesystem::path>;
    // A revision that was read.
    struct Reading {
        std::shared_ptr<const show::Revision> revision;
        SourceStock::Sources sources;
        show::SourceNames names;
        Paths saved;
        std::string news;  // of patterns that were drawn again
    };
    Result<Reading> read(const Paths& saved);
    Result<show::Show> readShow(const Paths& saved, show::SourceNames& names) const;
    void takeOver(Reading reading, Time showTime);
    void refuse(const Paths& files, const std::string& why, Time showTime);
    void readSite(Time showTime);
    Result<render::PictureSource> readSource(const show::Source& source, const Paths& saved, Reading& reading) const;
    bool isRedrawn(const show::Source& source, const Paths& saved) const;
    void readPatterns();
    void watchFiles();

    show::PlayedShow& show_;
    const Files run_;
    SourceStock& stock_;
    show::InputLog& inputs_;
    show::EventLog& events_;
    show::EventLog::Reader siteNews_ = events_.reader();
    const show::ShowClock showClock_;
    show::SourceNames names_;                                                       // of the revision that plays
    SourceStock::Sources sources_;                                                  // of that
    std::map<std::string, std::shared_ptr<const pattern::ShapePattern>> patterns_;  // as they are shown, by source
    std::optional<Reading> waits_;                                                  // for the renderers
    // What was saved and could not be read.
    struct Refused {
        Paths saved;
        std::string why;
        Time again{};  // show time
    };
    std::optional<Refused> refused_;
    FileWatch files_;
};

}  // namespace fantascope::app
