#include "app/live/show_run.h"

#include "app/base/data_folder.h"
#include "app/live/run_parts.h"
#include "app/site/site_claims.h"

#include "core/check.h"

#include <utility>

namespace fantascope::app {

Result<RunReport> runShow(const RunOptions& options, const Interrupt& interrupt,
                          const std::function<void(const RunStatus&)>& progress) {
    FANTASCOPE_CHECK(options.length || !options.asFastAsPossible, "as fast as possible needs an end");
    const Programme programme = TRY(readProgramme(options));
    const std::filesystem::path assets = TRY(dataFolder()) / "assets";

    SteadyClock steadyClock;
    SteppedClock steppedClock;
    Clock& clock = options.asFastAsPossible ? static_cast<Clock&>(steppedClock) : steadyClock;
    SiteClaims claims;  // a simulated site needs none
    if (options.backends == Backends::AsDeclared) claims = TRY(SiteClaims::take(programme.site, interrupt));
    const bool hasRelays = options.backends == Backends::AsDeclared && !programme.site.relayBanks.empty();
    const auto guard = hasRelays ? TRY(RelayGuard::start(programme.site, claims.files())) : nullptr;
    Supervisor supervisor(interrupt, guard.get());
    supervisor.step("opening the devices: look at the X server");
    if (!options.asFastAsPossible) setThreadRank(Rank::Render);  // before the displays start threads, which inherit it
    const auto openSite = TRY(OpenSite::open(programme.site, options.backends, options.seed, clock));
    std::unique_ptr<WallClock> wall = std::make_unique<SystemWallClock>();
    if (programme.wallFrom) wall = std::make_unique<RunningWallClock>(clock, *programme.wallFrom);
    const auto journal = TRY(NightJournal::open(options.journal, !options.fromCue.empty(), options.asFastAsPossible, *wall));
    const auto recording = TRY(Recording::ofSite(options.recordTo, programme.site));
    supervisor.step("preparing the pictures: look at the graphics card");
    RunParts run(options, programme, *openSite, recording.get(), clock, assets, supervisor, guard.get(), journal.get(), *wall);
    TRY(run.openPage(assets / "page"));
    if (guard) guard->arm();
    supervisor.attend(run.supervised());
    supervisor.step("showing the pictures: look at the X server and the graphics card");
    Result<void> drawn;
    if (options.asFastAsPossible) {
        auto parts = run.lightParts();
        for (Part& part : run.otherParts(progress)) parts.push_back(std::move(part));
        steppedClock.setParts(std::move(parts));
        drawn = run.draw();
        steppedClock.endAllBut(Rank::Lighting);
    } else {
        run.startLights();
        const PartThreads others(clock, run.otherParts(progress));
        drawn = run.draw();
        supervisor.step("ending the show's parts");
    }
    run.endLights();
    supervisor.step("making the relays safe", Supervisor::kSafeWithin + programme.site.endFade + 2 * Supervisor::kPatience);
    run.awaitLights();
    steppedClock.setParts({});
    run.closeLights();
    run.tellTheRest(progress);
    auto reported = [&]() -> Result<RunReport> {
        TRY(std::move(drawn));
        supervisor.step("finishing the recording", 3 * Supervisor::kPatience);
        RunReport report = run.report();
        run.tellTheRest(progress);
        supervisor.step("writing the report");
        if (!options.report.empty()) TRY(writeReport(options.report, jsonOf(report)));
        return report;
    }();
    if (!reported && !run.unsafe().empty()) return Error(reported.error().message() + "; " + sentenceOf(run.unsafe()));
    return reported;
}

}  // namespace fantascope::app
