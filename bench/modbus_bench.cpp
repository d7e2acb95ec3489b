// Measures the time from the end of a fault of a relay module or its line until the relays have the
// wanted states (tests/peers/modbus_campaign.h), against pymodbus.

#include "core/check.h"
#include "peers/modbus_campaign.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace fantascope {
namespace {

void tell(const std::string& name, std::vector<double> times) {
    std::sort(times.begin(), times.end());
    const auto quantile = [&](double p) { return times[static_cast<std::size_t>(p * static_cast<double>(times.size() - 1))]; };
    fmt::print("{:<14}{:>7}{:>9.3f}{:>9.3f}{:>9.3f}\n", name, times.size(), quantile(0.5), quantile(0.99), times.back());
}

int run(int argc, char** argv) {
    int faults = 1000;
    std::uint64_t seed = 1;
    ModbusPeer::Wire wire = ModbusPeer::Wire::Tcp;
    CLI::App arguments("Recovery times of Modbus relays after faults");
    arguments.add_option("--faults", faults, "Number of faults")->capture_default_str();
    arguments.add_option("--seed", seed, "Random seed of faults and states")->capture_default_str();
    arguments.add_option("--wire", wire, "tcp or rtu")
        ->transform(CLI::CheckedTransformer(
            std::map<std::string, ModbusPeer::Wire>{{"tcp", ModbusPeer::Wire::Tcp}, {"rtu", ModbusPeer::Wire::Rtu}}));
    CLI11_PARSE(arguments, argc, argv);
    if (const std::string missing = ModbusPeer::missing(); !missing.empty()) {
        fmt::print(stderr, "{}\n", missing);
        return 1;
    }
    const ModbusCampaign campaign = runModbusCampaign(wire, faults, seed);
    fmt::print("s from a fault's end to the wanted states\n{:<14}{:>7}{:>9}{:>9}{:>9}\n", "fault", "times", "p50", "p99", "max");
    std::vector<double> all;
    for (const auto& [name, times] : campaign.recovery) {
        tell(name, times);
        all.insert(all.end(), times.begin(), times.end());
    }
    tell("all", all);
    fmt::print("{} writes, {} stalls of the module's process, {} recoveries that took more than {} s, {} violations\n",
               campaign.writes, campaign.stalls, campaign.slow.size(), seconds(ModbusCampaign::kSoon), campaign.wrong.size());
    for (const std::string& slow : campaign.slow) fmt::print("  {}\n", slow);
    for (const std::string& wrong : campaign.wrong) fmt::print("  {}\n", wrong);
    return campaign.wrong.empty() ? 0 : 1;
}

}  // namespace
}  // namespace fantascope

int main(int argc, char** argv) { return fantascope::run(argc, argv); }
