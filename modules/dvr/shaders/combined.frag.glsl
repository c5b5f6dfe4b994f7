// Slices of a stack by a combiner: reads what its registers hold, and lets it compute the fragment. TEXELS slices on a
// polygon, or (INTERPOLATED) the two textures that one slice lies between.
uniform vec2 shareOfValue;  // x * value + y: 0..1 over the volume's range
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
#ifdef LEVEL
uniform float levelShare;
#endif
layout(location = 0) out vec4 seen;
layout(location = 1) out vec4 found;

struct Texel {
  vec4 mean;      // GRADIENTS: unit normal, value
  bool data;
  float lengths;  // of the table that the ray's way through the slab is
  float at;       // mm from the entry
  bool met;
};

Texel texelOf(sampler2D lower, sampler2D upper, float alpha, int i, vec4 start, vec3 along, vec2 box) {
  Texel t = Texel(vec4(0.0), false, 0.0, 0.0, false);
  vec2 slab = slabOf(places[i], start[axis], along[axis]);
  vec2 kept = vec2(max(slab.x, 0.0), min(slab.y, start.w));
  float middle = 0.5 * (slab.x + slab.y);
#ifdef LEVEL
  t.met = middle >= 0.0 && middle <= start.w;
#else
  t.met = kept.y > kept.x;
#endif
  if (!t.met) return t;
  bool whole = slab.x >= 0.0 && slab.y <= start.w;
  t.lengths = (whole ? 2.0 * halfSlab / abs(along[axis]) : kept.y - kept.x) / table_mm;
  t.at = clamp(middle, box.x, box.y);
  vec3 p = clamp(start.xyz + t.at * along, vec3(0.0), last_vox);
  t.data = betweenPlanes(lower, upper, alpha, inPlane(p), t.mean);
  return t;
}

#ifdef CLASSIFY
vec4 colourOf(Texel t) {
  if (!t.data) return vec4(0.0);
#if defined(RGBA)
  vec4 c = clamp(t.mean * gains, 0.0, 1.0);
  return vec4(c.rgb, opacityOfLengths(c.a, t.lengths * rgbaLengths));
#elif defined(PRE)
  return t.mean.a > 0.0 ? vec4(t.mean.rgb / t.mean.a, opacityOfLengths(t.mean.a, t.lengths * preLengths)) : vec4(0.0);
#else
  vec4 c = lookedUp(t.mean.a);
  return vec4(c.rgb, opacityOfLengths(c.a, t.lengths));
#endif
}
vec4 weightedOf(Texel t) {
  vec4 c = colourOf(t);
  return vec4(c.rgb * c.a, c.a);
}
#endif

float valueOf(Texel t) { return t.data ? t.mean.a * shareOfValue.x + shareOfValue.y : 0.0; }

vec3 lightDirection(int n) {
  vec4 towards = lightsTowards[n];
  return towards.w < -0.5 ? vec3(0.0) : towards.w > 0.5 ? towards.xyz : towardsEye();
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  if (lattice.z < 0.5) discard;
  vec3 along = alongRay();
  vec2 box = boxOf(start.xyz, along);
  bool ascends = along[axis] >= 0.0;
  Texel texels[TEXELS];
  READ_TEXELS
  bool met = false;
  float depth = 0.0;
  for (int n = 0; n < TEXELS; ++n) {
    Texel t = texels[ascends ? TEXELS - 1 - n : n];  // the nearest comes last
    if (t.met) met = true, depth = t.at;
  }
  if (!met) discard;
  FILL_REGISTERS
  vec4 c = combine(REGISTERS);
#ifdef LEVEL
  if (c.a < levelShare) discard;
  seen = vec4(c.rgb, 0.0);
  found = vec4(depth, 0.0, 0.0, 1.0);
#else
  // BLEND 0: C; 1: C A + D (1 - A); 2: C + D (1 - A); 3: C + D A.
  float left = BLEND == 0 ? 0.0 : BLEND == 3 ? c.a : 1.0 - c.a;
  seen = vec4(BLEND == 1 ? c.rgb * c.a : c.rgb, left);
  found = vec4((1.0 - left) * depth, 0.0, 0.0, left);
#endif
}
