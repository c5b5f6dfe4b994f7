// The greatest or least value on one part of each ray: at the samples of the lattice and at both ends, or (CELLS) exactly.
uniform float sign_;  // 1 greatest, -1 least
layout(location = 0) out vec4 seen;   // of colour volumes: each channel by itself
layout(location = 1) out vec4 found;  // mm from the entry (-1: nothing), samples, value, cells

#ifdef CELLS
uniform int mostCells;
void keepBest(float s, float value) {
  if (found.x < 0.0 || sign_ * value > sign_ * found.z) found.x = s, found.z = value;
}

void walkCells(vec4 start, vec3 along) {
  Walk w = beginWalk(start.xyz);
  for (int n = 0; n < mostCells; ++n) {
    vec3 next = facesAhead(w, start.xyz, along);
    float end = min(min(next.x, next.y), min(next.z, start.w));
    readCell(w.cell);
    vec3 a = inCell(w, start.xyz, along, w.s);
    vec3 b = inCell(w, start.xyz, along, end);
    keepBest(w.s, fieldInCell(a));
    keepBest(end, fieldInCell(b));
    vec2 turns = turningPoints(a, b);
    for (int k = 0; k < 2; ++k)
      if (turns[k] < 1.0) keepBest(mix(w.s, end, turns[k]), fieldInCell(mix(a, b, turns[k])));
    found.w += 1.0;
    if (end >= start.w || !nextCell(w, next, along)) return;
  }
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  int steps = int(lattice.z + 0.5);
  if (steps < 1) discard;
  vec3 along = alongRay();
  float samples = 0.0;
  seen = vec4(0.0);
  found = vec4(-1.0, 0.0, 0.0, 0.0);
#ifdef CELLS
  walkCells(start, along);
  return;
#endif
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
