#pragma once

#include "theatre/body/body_mesh.h"

namespace fantascope::theatre {

// Of 1.75 m.
inline const Body& theBody() {
    static const Body body = humanBody(1.75);
    return body;
}
inline const BodyMesh& theMesh() {
    static const BodyMesh mesh = humanMesh(theBody());
    return mesh;
}

}  // namespace fantascope::theatre
