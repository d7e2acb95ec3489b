#version 450 core
// The light of one sheet of refracted rays: as much denser as the sheet is narrower. The sun is no point and the floor no mirror, so
// that no line is endlessly bright.

in float spread;
layout(location = 0) out float light;

const float least = 0.1;

void main() { light = inversesqrt(spread * spread + least * least); }
