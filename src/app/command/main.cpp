#include "app/command/commands.h"

#include "core/text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

namespace fantascope::app {
namespace {

// Every subcommand of the program.
constexpr AddCommand kCommands[] = {addPatternCommand,   addPoseCommand,     addDeformCommand,   addAdaptCommand,
                                    addFabricateCommand, addConvertCommand,  addRehearseCommand, addRunCommand,
                                    addExportCommand,    addTemplateCommand, addPreviewCommand,  addPlotCommand,
                                    addReportCommand,    addScheduleCommand, addCheckCommand,    addCalibrateCommand,
                                    addLensCommand,      addDevicesCommand,  addSchemaCommand,   addGuardCommand};

enum ExitStatus { Done = 0, Refused = 1, WrongUsage = 2 };

// Where a standard stream was closed before we started, the next file that is opened would take its
// number, and what is printed would go into a device.
void openMissingStreams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(stream, F_GETFD) == -1) (void)open("/dev/null", O_RDWR);  // takes the lowest number that is free: this one
}

int run(int argc, char** argv) {
    openMissingStreams();
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows over its limit is an error of its write, as on a full disk
    Program program("fantascope", "A live installation controller for night-time public projection.", FANTASCOPE_VERSION);
    for (const AddCommand add : kCommands) add(program);
    const Parsed parsed = program.parse(argc, argv);
    if (parsed != Parsed::Action) return parsed == Parsed::Help ? Done : WrongUsage;
    if (const auto done = program.action()(); !done) {
        // Whether or not it is read.
        std::fputs(fmt::format("fantascope: error: {}\n", printableLines(done.error().message())).c_str(), stderr);
        return Refused;
    }
    return Done;
}

}  // namespace
}  // namespace fantascope::app

int main(int argc, char** argv) { return fantascope::app::run(argc, argv); }
