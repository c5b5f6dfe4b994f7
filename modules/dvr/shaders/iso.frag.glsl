// The first point of each ray at which the field reaches the level: cell by cell (CELLS), or found between two samples of
// the lattice and then halved, in the trilinear field itself.
uniform float level;
uniform float sign_;  // of the slope from values to modality values
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
layout(location = 0) out vec4 seen;
layout(location = 1) out vec4 found;  // mm from the entry (-1: nothing), samples, value, cells

bool reaches(vec3 p, inout float samples) {
  vec2 v = fieldAt(p);
  samples += 1.0;
  return v.y > 0.0 && sign_ * v.x >= sign_ * level;
}

#ifdef CELLS
uniform int mostCells;
bool reachesInCell(vec3 q) { return sign_ * fieldInCell(q) >= sign_ * level; }

// True where the ray reaches the level, at s; `cells` it has walked through.
bool findFirst(vec4 start, vec3 along, out float s, out bool begins, out float cells) {
  Walk w = beginWalk(start.xyz);
  cells = 0.0;
  begins = false;
  s = 0.0;
  for (int n = 0; n < mostCells; ++n) {
    vec3 next = facesAhead(w, start.xyz, along);
    float end = min(min(next.x, next.y), min(next.z, start.w));
    readCell(w.cell);
    cells += 1.0;
    vec3 a = inCell(w, start.xyz, along, w.s);
    vec3 b = inCell(w, start.xyz, along, end);
    s = w.s;
    if (reachesInCell(a)) {
      begins = n == 0;
      return true;
    }
    vec2 turns = turningPoints(a, b);
    float below = 0.0;
    for (int k = 0; k < 3; ++k) {
      float above = k == 0 ? turns.x : k == 1 ? turns.y : 1.0;
      if (!reachesInCell(mix(a, b, above))) {
        below = above;
        continue;
      }
      for (int i = 0; i < 20; ++i) {
        float middle = 0.5 * (below + above);
        if (reachesInCell(mix(a, b, middle))) above = middle; else below = middle;
      }
      s = mix(w.s, end, above);
      return true;
    }
    if (end >= start.w || !nextCell(w, next, along)) return false;
  }
  return false;
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  int steps = int(lattice.z + 0.5);
  if (steps < 1) discard;
  vec3 along = alongRay();
  vec3 eye = towardsEye();
  float samples = 0.0, cells = 0.0, s = 0.0;
#ifdef CELLS
  bool begins;
  bool hit = findFirst(start, along, s, begins, cells);
#else
  float before = 0.0;
  bool hit = reaches(positionAt(start, along, 0.0), samples), begins = hit;
  for (int n = 0; n <= steps && !hit; ++n) {
    before = s;
    s = clamp((lattice.x + float(n)) * step_mm, 0.0, start.w);
    hit = s > before && reaches(positionAt(start, along, s), samples);
  }
  for (int n = 0; n < 20 && hit && !begins; ++n) {
    float middle = 0.5 * (before + s);
    if (reaches(positionAt(start, along, middle), samples)) s = middle; else before = middle;
  }
#endif
  found = vec4(-1.0, samples, level, cells);
  seen = vec4(0.0, 0.0, 0.0, 1.0);
  if (!hit) return;
  vec3 p = positionAt(start, along, s);
  vec3 n = begins ? eye : normalOf(gradientAt(p, level), eye, flat_perMm);
  seen = vec4(lit(ambientColour, diffuseColour, n, eye), 0.0);
  found = vec4(s, samples + 6.0, level, cells);
}
