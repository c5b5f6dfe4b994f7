// A tool's own colour by the headlight, and its depth.
in float depth_mm;
in vec3 place_mm;
uniform vec4 eye_mm;  // w 1: the eye; w 0: the direction of view
uniform vec3 colour;
layout(location = 0) out vec4 seen;

void main() {
  seen = vec4(colour * headlight(place_mm, eye_mm.w > 0.5 ? place_mm - eye_mm.xyz : eye_mm.xyz), depth_mm);
}
