#include "app/base/attendance.h"
#include "app/base/data_folder.h"
#include "app/base/output.h"
#include "app/base/progress.h"
#include "app/base/report.h"
#include "app/calibrate/calibration.h"
#include "app/calibrate/calibration_rig.h"
#include "app/calibrate/light_survey.h"
#include "app/calibrate/lit_wall.h"
#include "app/calibrate/marker_sheet.h"
#include "app/calibrate/wanted_file.h"
#include "app/command/commands.h"
#include "app/command/corner_window.h"
#include "app/lens/lens_file.h"
#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include "core/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAtWindow = "window";  // the value of --wanted

struct Options {
    fs::path site;
    std::vector<std::string> outputs;
    fs::path wanted, picture, markers, report;
    std::uint64_t seed = 1;
    bool simulate = false, write = false, undo = false;
};

void declare(Command& command, Options& options) {
    command.add("SITE", options.site, "A site's folder, or a site.yaml");
    command.add("OUTPUT", options.outputs, "The outputs to calibrate (default: all)");
    command.addFlag("--simulate", options.simulate, "Calibrate the simulated site");
    command.add("--wanted", options.wanted,
                "Where the canvases are to stand in the camera's picture: a file (docs/calibrating.md); 'window': you choose the "
                "corners with the pointer or keys, in a window that shows the camera's picture; or 'markers': one canvas "
                "between the printed corner markers. Default: the largest upright place");
    command
        .add("--picture", options.picture,
             "Also write the camera's picture of the lit wall, off which the corners for a file can be read")
        .check(onlyEnding(".png", "PNG"));
    command.add("--markers", options.markers,
                "Measure nothing: make the sheets of the four corner markers, PDF, SVG or PNG files named after this one");
    command.addFlag("--write", options.write,
                    "Write the new warps and light settings into the site file, and what was seen beside it; the file as it was "
                    "is kept as FILE.previous");
    command.addFlag("--undo", options.undo,
                    "Measure nothing: go back to the site file as it was; once more, and it is the new one");
    command.add("--report", options.report, "Write the figures to this JSON file (docs/report.md)");
    command.add("--seed", options.seed, "Seed of the simulated site's noise").showDefault();
    command.footer(
        "Nothing may move but passers-by: what they disturb is shown again. Escape, q and Ctrl-C end it; outputs that are "
        "measured by then count, unless you were to choose their place in a window.");
}

Result<std::vector<std::size_t>> chosen(const show::Site& site, const std::vector<std::string>& names) {
    std::vector<std::size_t> outputs;
    for (const std::string& name : names) {
        const std::size_t output = TRY(outputNamed(site, name));
        if (std::ranges::find(outputs, output) == outputs.end()) outputs.push_back(output);
    }
    for (std::size_t output = 0; names.empty() && output < site.outputs.size(); ++output) outputs.push_back(output);
    return outputs;
}

Report reportOf(const show::Site& site, const std::vector<OutputCalibration>& calibrations, Time took, Time latency) {
    Report report;
    report["seconds"] = seconds(took);
    report["latency_ms"] = 1000 * seconds(latency);
    int repeated = 0;
    for (const OutputCalibration& calibration : calibrations)
        if (calibration.survey) repeated += calibration.survey->repeated;
    report["repeated_frames"] = repeated;
    report["outputs"] = Report::object();
    for (const OutputCalibration& calibration : calibrations) {
        Report& output = report["outputs"][site.outputs[calibration.output].name];
        output["written"] = calibration.written;
        if (!calibration.trouble.empty()) output["trouble"] = calibration.trouble;
        if (!calibration.note.empty()) output["note"] = calibration.note;
        if (calibration.place)
            for (const glm::dvec2 corner : *calibration.place) output["camera"].push_back({corner.x, corner.y});
        if (calibration.survey) output["gamma"] = calibration.survey->gamma;
        if (calibration.light.white)
            output["white"] = {calibration.light.white->r, calibration.light.white->g, calibration.light.white->b};
        if (!calibration.light.trouble.empty()) output["light_trouble"] = calibration.light.trouble;
        if (!calibration.fit) continue;
        const vision::WarpFit& fit = *calibration.fit;
        output["rms_px"] = fit.rms;
        output["max_px"] = fit.max;
        output["keystone_rms_px"] = fit.keystoneRms;
        output["keystone_max_px"] = fit.keystoneMax;
        output["points"] = fit.points;
        output["left_out"] = fit.leftOut;
        output["flat"] = fit.flat;
    }
    return report;
}

std::string sentenceOf(const show::Site& site, const OutputCalibration& calibration) {
    const std::string& name = site.outputs[calibration.output].name;
    if (!calibration.fit) return fmt::format("{}: {}", name, calibration.trouble);
    const vision::WarpFit& fit = *calibration.fit;
    std::string words = fmt::format("{}: rms {:.2f} px, at most {:.2f}, over {} points", name, fit.rms, fit.max, fit.points);
    if (fit.flat)
        words += "; flat, by a keystone";
    else
        words += fmt::format("; uneven, by a mesh of {} x {} points (a keystone alone misses by {:.2f} px, at most {:.2f})",
                             fit.shape.mesh.points.x, fit.shape.mesh.points.y, fit.keystoneRms, fit.keystoneMax);
    if (fit.leftOut > 0.02) words += fmt::format("; {:.0f} % of the place lies on something else", 100 * fit.leftOut);
    if (!calibration.trouble.empty()) words += fmt::format("; not good enough: {}", calibration.trouble);
    if (calibration.written) words += "; written";
    if (!calibration.note.empty()) words += "; note: " + calibration.note;
    return words;
}

std::string lightSentenceOf(const show::Site& site, const OutputCalibration& calibration) {
    std::string words = wordsOf(calibration.light);
    if (!words.empty() && calibration.written) words += "; written";
    if (!calibration.light.trouble.empty()) words += fmt::format("{}{}", words.empty() ? "" : "; ", calibration.light.trouble);
    return fmt::format("{}: {}", site.outputs[calibration.output].name, words);
}

// Error: the wanted file cannot be read, or names other outputs; markers cannot say where several
// canvases are to stand; there can be no window.
Result<Wanted> wantedBy(const Options& options, const show::Site& site, const std::vector<std::size_t>& outputs) {
    Wanted wanted;
    wanted.markers = options.wanted == "markers";
    if (options.wanted == kAtWindow) {
        TRY(checkCornerWindow());  // before minutes of measuring
    } else if (wanted.markers) {
        for (const std::size_t output : outputs)
            if (site.outputs[output].canvas != site.outputs[outputs[0]].canvas)
                return Error("markers show the corners of one canvas; name its outputs: fantascope calibrate SITE OUTPUT..");
    } else if (!options.wanted.empty()) {
        wanted.corners = TRY(readWanted(options.wanted));
    }
    for (const auto& [name, corners] : wanted.corners) TRY(outputNamed(site, name).in(options.wanted.string()));
    return wanted;
}

// Writes what --picture asks for. Error: no output was measured, or the file cannot be written.
Result<void> writeWallPicture(const fs::path& file, const std::vector<OutputCalibration>& calibrations) {
    std::vector<const LightSurvey::Output*> light;
    for (const OutputCalibration& calibration : calibrations)
        if (calibration.survey) light.push_back(&*calibration.survey);
    if (light.empty()) return Error(fmt::format("{}: not written, because no output was measured", file.string()));
    return writePng(file, litWallPicture(light));
}

// Where the canvases stand, one line each, as a wanted file says it.
void printPlaces(const show::Site& site, const std::vector<OutputCalibration>& calibrations) {
    std::vector<std::string> told;
    for (const OutputCalibration& calibration : calibrations) {
        const std::string& canvas = site.outputs[calibration.output].canvas;
        if (!calibration.place || std::ranges::find(told, canvas) != told.end()) continue;
        told.push_back(canvas);
        const auto& c = *calibration.place;
        fmt::print(
            "the canvas '{}' has its corners at [[{:.1f}, {:.1f}], [{:.1f}, {:.1f}], [{:.1f}, {:.1f}], [{:.1f}, {:.1f}]] in the "
            "camera's picture\n",
            canvas, c[0].x, c[0].y, c[1].x, c[1].y, c[2].x, c[2].y, c[3].x, c[3].y);
    }
}

// Says how each output went. Error: those that are not calibrated.
Result<void> printOutcome(const show::Site& site, const std::vector<OutputCalibration>& calibrations) {
    std::string troubles;
    for (const OutputCalibration& calibration : calibrations) {
        fmt::print("{}\n", sentenceOf(site, calibration));
        if (calibration.isGood()) fmt::print("{}\n", lightSentenceOf(site, calibration));
        if (!calibration.isGood())
            troubles += fmt::format("{}{}", troubles.empty() ? "" : ", ", site.outputs[calibration.output].name);
    }
    if (!troubles.empty()) return Error(fmt::format("not calibrated: {}; what was set before is kept there", troubles));
    return {};
}

Result<void> calibrateSite(const Options& options, const show::Site& site) {
    const std::vector<std::size_t> outputs = TRY(chosen(site, options.outputs));
    Wanted wanted = TRY(wantedBy(options, site, outputs));
    if (!options.picture.empty()) TRY(checkWritable(options.picture));
    const fs::path assets = TRY(dataFolder()) / "assets";
    const CalibrationRig::Options rigOptions{options.simulate, options.seed, assets};
    std::unique_ptr<CalibrationRig> rig;
    {
        const Interrupt interrupt;
        rig = TRY(CalibrationRig::open(site, rigOptions, interrupt));
    }
    SteadyClock clock;
    Attendance attendance(clock);
    Progress progress("calibrate", clock, std::cerr, standardErrorIsTerminal());
    bool goesOn = true;  // one key ends it for all outputs
    LightSurvey survey(*rig, site,
                       {[&] { return goesOn = goesOn && attendance.goesOn(); },
                        [&](double done, const std::string& doing) { progress.update(done, doing); }});
    if (options.wanted == kAtWindow)
        wanted.choose = [&](const std::vector<OpenPlace>& places) {
            return choosePlaces(places, clock, [&] {
                progress.update(std::nullopt, "choose the corners in the window");
                return goesOn = goesOn && attendance.goesOn();
            });
        };
    const Time began = rig->now();
    std::vector<OutputCalibration> calibrations = TRY(calibrate(survey, site, outputs, wanted));
    const Time took = rig->now() - began;
    const bool anyGood = std::ranges::any_of(calibrations, &OutputCalibration::isGood);
    if (options.write && anyGood) TRY(writeCalibration(site, calibrations, survey.latency()));
    if (!options.report.empty()) TRY(writeReport(options.report, reportOf(site, calibrations, took, survey.latency())));
    if (const std::string mismatch = lensMismatch(site, rig->camera()); !options.simulate && !mismatch.empty())
        fmt::print("note: {}\n", printableLines(mismatch));
    if (!options.picture.empty()) TRY(writeWallPicture(options.picture, calibrations));
    if (!options.picture.empty() || wanted.choose) printPlaces(site, calibrations);
    return printOutcome(site, calibrations);
}

Result<void> run(const Options& options) {
    if (!options.markers.empty()) {
        for (const fs::path& file : TRY(writeMarkerSheets(options.markers))) fmt::print("{}\n", file.string());
        return {};
    }
    if (options.site.empty()) return Error("a site is needed, or --markers FILE; see fantascope calibrate --help");
    if (options.undo) {
        const fs::path file = TRY(undoWrite(options.site));
        fmt::print("{0} is again as it was; what it replaces is kept as {0}.previous\n", file.string());
        return {};
    }
    return calibrateSite(options, TRY(readSite(options.site)));
}

}  // namespace

void addCalibrateCommand(Program& program) {
    addCommand<Options>(program, "calibrate", "Find the outputs' warps and light with the camera", declare, run);
}

}  // namespace fantascope::app
