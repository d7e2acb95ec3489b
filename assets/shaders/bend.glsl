// A warp's mesh on top of its keystone: where a point goes that the keystone puts at `clip`. NODES: the side of the lattice.
layout(location = 40) uniform mat3 pictureFromClip;
layout(binding = 15) uniform sampler2D moves;

vec4 bent(vec4 clip) {
    vec3 onPicture = pictureFromClip * clip.xyw;
    vec2 node = clamp(onPicture.xy / onPicture.z, 0.0, 1.0) * (NODES - 1.0);
    clip.xy += clip.w * textureLod(moves, (node + 0.5) / NODES, 0.0).xy;
    return clip;
}
