// SLICES neighbouring slices of a stack on one polygon (Rezk-Salama 2000, sections 5 to 7). Each slice stands for the
// slab around it; a ray has of it the opacity of its way through, between its ends. The places at which a ray meets the
// slices are the view-dependent texture coordinates; UNCORRECTED maps all slices as the first of them lies (figure 13).
#ifdef ISO
uniform float level;
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
#endif
layout(location = 0) out vec4 seen;
layout(location = 1) out vec4 found;

struct Slice {
  vec4 colour;  // extremes: value or channels
  float at;     // mm from the entry
  bool hit;
};

Slice sliceOf(sampler2D lower, sampler2D upper, int i, vec4 start, vec3 along, vec2 box, vec3 eye) {
  Slice s = Slice(vec4(0.0), 0.0, false);
  float begin = start[axis];
  vec2 slab = slabOf(places[i], begin, along[axis]);
  vec2 kept = vec2(max(slab.x, 0.0), min(slab.y, start.w));
#ifdef UNCORRECTED
  vec2 first = slabOf(places[0], begin, along[axis]);
  vec2 mapped = vec2(max(first.x, 0.0), min(first.y, start.w));
#else
#define first slab
#define mapped kept
#endif
  float middle = 0.5 * (first.x + first.y);
#if defined(ISO) || defined(EXTREME)
  // A slice is a surface here: it counts where the ray meets it.
  if (!(middle >= 0.0 && middle <= start.w)) return s;
#else
  if (!(mapped.y > mapped.x)) return s;
#endif
  s.at = clamp(middle, box.x, box.y);
  vec3 p = clamp(start.xyz + s.at * along, vec3(0.0), last_vox);
  vec4 mean;
  if (!betweenPlanes(lower, upper, alphas[i], inPlane(p), mean)) return s;
#if defined(ISO)
  if (sign_ * mean.a < sign_ * level) return s;
  s.colour = vec4(lit(ambientColour, diffuseColour, normalOf(mean.rgb, eye, flat_perMm), eye), 1.0);
  s.hit = true;
#elif defined(EXTREME)
#ifdef RGBA
  s.colour = clamp(mean * gains, 0.0, 1.0);
#else
  s.colour = vec4(mean.a);
#endif
  s.hit = true;
#else
  s.colour = appearance(mean, eye);
  bool whole = first.x >= 0.0 && first.y <= start.w;
  float lengths = (whole ? 2.0 * halfSlab / abs(along[axis]) : mapped.y - mapped.x) / table_mm;
  s.colour.a = opacityOfLengths(s.colour.a, lengths);
  s.hit = s.colour.a > 0.0;
#endif
  return s;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  if (lattice.z < 0.5) discard;
  vec3 along = alongRay();
  vec2 box = boxOf(start.xyz, along);
#if defined(SHADED) || defined(ISO)
  vec3 eye = towardsEye();
#else
  vec3 eye = vec3(0.0);
#endif
  Slice slices[SLICES];
  READ_SLICES
  bool any = false;
  vec4 front = vec4(0.0, 0.0, 0.0, 1.0);
  float depth = 0.0;
  for (int n = 0; n < SLICES; ++n) {
    // Front to back. With two: C0 A0 (1 - A1) + C1 A1, and (1 - A0)(1 - A1) is left.
    Slice s = slices[along[axis] >= 0.0 ? n : SLICES - 1 - n];
    if (!s.hit) continue;
#if defined(ISO)
    if (!any) front = vec4(s.colour.rgb, 0.0), depth = s.at;
#elif defined(EXTREME)
    front = any ? max(front, vec4(sign_ * s.colour.rgb, 1.0)) : vec4(sign_ * s.colour.rgb, 1.0);
    if (!any) depth = -s.at;
#else
    front.rgb += front.a * s.colour.a * s.colour.rgb;
    depth += front.a * s.colour.a * s.at;
    front.a *= 1.0 - s.colour.a;
#endif
    any = true;
  }
  if (!any) discard;
  seen = front;
  found = vec4(depth, 0.0, 0.0, front.a);
}
