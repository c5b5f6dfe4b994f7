// The first point of each ray at which the field reaches the level: found between two samples of the lattice, then
// halved until it is exact, in the trilinear field itself.
uniform float level;
uniform float sign_;  // of the slope from values to modality values
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
layout(location = 0) out vec4 seen;
layout(location = 1) out vec4 found;

bool reaches(vec3 p, inout float samples) {
  vec2 v = fieldAt(p);
  samples += 1.0;
  return v.y > 0.0 && sign_ * v.x >= sign_ * level;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  int steps = int(lattice.z + 0.5);
  if (steps < 1) discard;
  vec3 along = alongRay();
  vec3 eye = towardsEye();
  float samples = 0.0, before = 0.0, s = 0.0;
  bool hit = reaches(positionAt(start, along, 0.0), samples), begins = hit;
  for (int n = 0; n <= steps && !hit; ++n) {
    before = s;
    s = clamp((lattice.x + float(n)) * step_mm, 0.0, start.w);
    hit = s > before && reaches(positionAt(start, along, s), samples);
  }
  found = vec4(-1.0, samples, level, 1.0);
  seen = vec4(0.0, 0.0, 0.0, 1.0);
  if (!hit) return;
  for (int n = 0; n < 20 && !begins; ++n) {
    float middle = 0.5 * (before + s);
    if (reaches(positionAt(start, along, middle), samples)) s = middle; else before = middle;
  }
  vec3 p = positionAt(start, along, s);
  vec3 n = begins ? eye : normalOf(gradientAt(p, level), eye, flat_perMm);
  seen = vec4(lit(ambientColour, diffuseColour, n, eye), 0.0);
  found = vec4(s, samples + 6.0, level, 1.0);
}
