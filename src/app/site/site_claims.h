#pragma once

#include "app/base/interrupt.h"
#include "drivers/common/claim.h"

#include "show/site/site.h"

#include "core/result.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// A device of a site that is no output, and the claim that it needs.
struct DeclaredDevice {
    std::string name, driver;            // as its status has them
    std::function<std::string()> claim;  // of drivers::Opening: current name; "" if many programs may use it
};
// Error: a driver's, about its part of the site file.
Result<std::vector<DeclaredDevice>> declaredDevices(const show::Site& site);

// The error that says who has `what`, and how to end that program.
Error inUse(const std::string& what, const drivers::ClaimHolder& holder);

// The claims of a run: the site, and each device, whichever file declares it
// (docs/decisions/0031-what-a-run-claims.md).
class SiteClaims {
public:
    // Waits for a relay guard of an earlier run that still has a claim. Error: another program has
    // the site or a device (it says which, and who); it was interrupted; or a driver's, about its
    // part of the site file.
    static Result<SiteClaims> take(const show::Site& site, const Interrupt& interrupt);

    SiteClaims() = default;  // no claims, for simulated devices
    std::vector<int> files() const;

private:
    std::vector<drivers::Claim> claims_;
};

// Whether a program has claimed the device or the whole site. May be called any number of times.
bool isClaimed(const show::Site& site, const DeclaredDevice& device);
// The program that has claimed the device or the whole site; nothing if none has.
std::optional<drivers::ClaimHolder> holderOf(const show::Site& site, const DeclaredDevice& device);

}  // namespace fantascope::app
