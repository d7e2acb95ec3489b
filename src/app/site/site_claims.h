#pragma once

#include "app/base/interrupt.h"
#include "drivers/common/claim.h"

#include "show/site.h"

#include "core/result.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// A device of a site, outputs left out, and what it takes for one program alone.
struct DeclaredDevice {
    std::string name, driver;            // as its status has them
    std::function<std::string()> claim;  // drivers::Opening's: as of now, "" where many may use it
};
// Error: what a driver says of its part of the site file.
Result<std::vector<DeclaredDevice>> declaredDevices(const show::Site& site);

// Who has `what`, and how to end that.
Error inUse(const std::string& what, const drivers::ClaimHolder& holder);

// What a run on a site has for itself alone: the site, and each device, whichever file declares it
// (docs/decisions/0031-what-a-run-claims.md).
class SiteClaims {
public:
    // A relay guard of an earlier run that still has something is waited for. Error: another
    // program has the site or a device: which, and who; or it was interrupted; or what a driver
    // says of its part of the site file.
    static Result<SiteClaims> take(const show::Site& site, const Interrupt& interrupt);

    SiteClaims() = default;  // of what is simulated: none
    std::vector<int> files() const;

private:
    std::vector<drivers::Claim> claims_;
};

// Whether somebody has claimed the device, or the whole site. May be asked for ever.
bool isClaimed(const show::Site& site, const DeclaredDevice& device);
// Who has claimed the device, or the whole site; nothing: nobody.
std::optional<drivers::ClaimHolder> holderOf(const show::Site& site, const DeclaredDevice& device);

}  // namespace fantascope::app
