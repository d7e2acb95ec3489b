#version 450 core
// One of four corners of the spot that a facet of a mirror ball throws on the wall: the facet's projection from the lamp's mirror image, its edges as soft as
// the lamp is wide. All lengths are metres; the wall is z = 0, its origin the canvas's middle, x right, y up, z out of the wall.

layout(location = 0) in vec3 outwards;  // of the facet's middle, from the ball's centre at rest; unit
layout(location = 1) in vec3 normal;    // nearly the same

layout(location = 0) uniform vec3 ball;
layout(location = 1) uniform vec3 lamp;
layout(location = 2) uniform vec4 measures;  // the ball's radius, half a facet's edge, the lamp's radius, the ball's angle
layout(location = 3) uniform vec2 canvas;    // its size

flat out mat2 facet;   // its half edges on the wall, where the lamp's image is the unit disc
flat out float light;  // in the spot's middle
out vec2 place;        // in the same measure

vec3 turned(vec3 v) {
    float c = cos(measures.w), s = sin(measures.w);
    return vec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
}

// Where the ray from `source` through `through` meets the wall.
vec2 onWall(vec3 source, vec3 through) { return (source + (through - source) * (source.z / (source.z - through.z))).xy; }

// Of a disc of radius 1 that an edge at distance x from its middle cuts, the share beyond the edge.
float shareBeyond(float x) { return (acos(x) - x * sqrt(1.0 - x * x)) / 3.14159265; }

void main() {
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);  // all corners in one place: nothing
    facet = mat2(1.0);
    light = 0.0;
    place = vec2(0.0);

    vec3 away = turned(outwards), mirror = turned(normal);
    vec3 middle = ball + measures.x * away;
    float height = dot(lamp - middle, mirror);
    if (height <= 0.0) return;  // in the ball's own shadow
    vec3 image = lamp - 2.0 * height * mirror;
    vec3 ray = middle - image;
    float reach = length(ray) * image.z / -ray.z;  // from the lamp's image to the wall
    if (ray.z >= 0.0 || middle.z <= 0.0 || image.z <= middle.z) return;  // away from the wall

    vec3 right = measures.y * normalize(cross(vec3(0.0, 1.0, 0.0), away)), up = measures.y * normalize(cross(away, right));
    vec3 lampRight = measures.z * normalize(cross(ray, vec3(0.0, 1.0, 0.0))), lampUp = measures.z * normalize(cross(lampRight, ray));
    vec2 centre = onWall(image, middle);
    mat2 edges = mat2(onWall(image, middle + right) - centre, onWall(image, middle + up) - centre);
    mat2 disc = mat2(onWall(image + lampRight, middle) - centre, onWall(image + lampUp, middle) - centre);
    facet = inverse(disc) * edges;

    // A facet smaller than the lamp's image shows a part of the lamp at most.
    float area = abs(determinant(facet)), inside = area / max(length(facet[0]), length(facet[1]));
    float most = min(1.0, 4.0 * area / 3.14159265) / shareBeyond(-min(inside, 1.0));
    float straight = length(lamp - ball) + ball.z;
    light = most * straight * straight / (reach * reach) * -ray.z / length(ray);

    mat2 unit = inverse(facet);
    vec2 beyond = 1.0 + vec2(length(vec2(unit[0].x, unit[1].x)), length(vec2(unit[0].y, unit[1].y)));
    place = facet * (beyond * (2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1) - 1.0));
    // A software OpenGL is slow in clipping: spots off the canvas are left out here.
    float largest = length(beyond) * (length(edges[0]) + length(edges[1]));
    if (any(greaterThan(abs(centre), canvas / 2.0 + largest))) return;
    gl_Position = vec4(vec2(2.0, -2.0) * (centre + disc * place) / canvas, 0.0, 1.0);
}
