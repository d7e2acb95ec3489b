#pragma once
// The default site as the program opens it: the nominal site from its file, with the simulation.

#include "drivers/site/simulated_site.h"

#include "show/site/site.h"
#include "vision/camera_model.h"

#include "source_folder.h"

#include <string>

namespace fantascope::site {

inline show::Site defaultSite() { return show::readSite(sourceFolder() + "/config/simulated/site.yaml").value(); }

inline NominalSite nominalPartsOf(const show::Site& site) {
    NominalSite nominal;
    for (const show::Output& output : site.outputs) {
        const show::NominalProjector& projector = output.projector.value();
        nominal.outputs.push_back({output.name, vision::CameraModel::fromThrowRatio(projector.pose, output.size(),
                                                                                    projector.throwRatio, projector.lensShift)});
        nominal.devices.push_back(output.name);
    }
    for (const show::Fixture& fixture : site.fixtures)
        nominal.fixtures.push_back({fixture.name, fixture.universe, fixture.address, fixture.channels});
    for (const show::Relay& relay : site.relays)
        nominal.relays.push_back({relay.name, site.relayBanks[relay.bank].name, static_cast<std::size_t>(relay.coil)});
    const show::NominalCamera& camera = site.nominalCamera.value();
    nominal.camera =
        vision::CameraModel::fromFieldOfView(camera.pose, camera.size, camera.fieldOfView, camera.k1, camera.k2).value();
    return nominal;
}

}  // namespace fantascope::site
