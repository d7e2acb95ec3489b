#version 450 core
// Moves the vertices of one mesh as the joints do that they hang on: dual quaternions, blended and made unit (Kavan et al. 2008, section 4, algorithm 1).
// JOINTS is defined.

layout(local_size_x = 64) in;

struct Vertex {
    vec4 atRest;  // and four joints, a byte each
    vec4 shares;
};
layout(std430, binding = 0) restrict readonly buffer AtRest { Vertex atRest[]; };
layout(std430, binding = 1) restrict writeonly buffer Moved { vec4 moved[]; };

layout(location = 0) uniform uvec2 range;              // the first vertex, how many
layout(location = 1) uniform vec4 motions[2 * JOINTS];  // of each joint from rest: w, x, y, z of the turn, then of the dual part

void main() {
    if (gl_GlobalInvocationID.x >= range.y) return;
    uint i = range.x + gl_GlobalInvocationID.x;
    Vertex vertex = atRest[i];
    uint joints = floatBitsToUint(vertex.atRest.w);
    vec4 turn = vec4(0.0), dual = vec4(0.0);
    for (int n = 0; n < 4; ++n) {
        uint joint = joints >> (8 * n) & 255u;
        turn += vertex.shares[n] * motions[2 * joint];
        dual += vertex.shares[n] * motions[2 * joint + 1];
    }
    vec3 p = vertex.atRest.xyz, r = turn.yzw, d = dual.yzw;
    vec3 u = cross(r, p) + turn.x * p + d;
    moved[i] = vec4(p + 2.0 / dot(turn, turn) * (cross(r, u) + turn.x * d - dual.x * r), 1.0);
}
