// The greatest or least value on one part of each ray: at the samples of the lattice and at both ends.
uniform float sign_;  // 1 greatest, -1 least
layout(location = 0) out vec4 seen;   // of colour volumes: each channel by itself
layout(location = 1) out vec4 found;  // mm from the entry (-1: nothing), samples, value

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  int steps = int(lattice.z + 0.5);
  if (steps < 1) discard;
  vec3 along = alongRay();
  float samples = 0.0;
  seen = vec4(0.0);
  found = vec4(-1.0, 0.0, 0.0, 1.0);
  for (int n = -1; n <= steps; ++n) {
    float s = clamp((lattice.x + float(n)) * step_mm, 0.0, start.w);
    vec3 p = positionAt(start, along, s);
    samples += 1.0;
#ifdef RGBA
    vec4 c = vec4(rgbaAt(p).rgb, 0.0);
    if (found.x < 0.0) found.x = 0.0, seen = c;
    seen = sign_ > 0.0 ? max(seen, c) : min(seen, c);
#else
    vec2 v = fieldAt(p);
    if (v.y > 0.0 && (found.x < 0.0 || sign_ * v.x > sign_ * found.z)) found.x = s, found.z = v.x;
#endif
  }
  found.y = samples;
}
