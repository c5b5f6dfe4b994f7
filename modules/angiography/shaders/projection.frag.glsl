// One part of each pixel's ray, at the samples of the view's lattice (native/Projection.h): positions count from a voxel
// in the volume's middle and depths from a plane there, so that floats keep their digits.
uniform sampler3D volume;
uniform sampler2D parts;  // depths in mm: first sample, begin, end; number of samples
uniform sampler2D borders;  // of rays that are cut into pieces: depths between which samples lie
uniform int pieces;         // 1: there are borders; else they are begin and end
uniform ivec3 middle;     // voxel
uniform vec3 origin;      // of the picture's centre on the plane, in voxels from the middle
uniform vec3 right;       // voxels per pixel, of the plane or (perspective) for each mm of depth
uniform vec3 down;
uniform vec3 forward;     // voxels per mm
uniform vec2 centre_px;
uniform vec2 spread;      // times right and down: on the plane, and for each mm behind it
uniform float raySlope;   // perspective: the ray's slope per pixel; else 0
uniform float step_mm;    // along the ray
uniform float plane_mm;   // depth of the plane
uniform int gather;       // 0 extremum, 1 cued maximum, 2 emission, 3 mean
uniform float sense;      // of an extremum: 1 greatest, -1 least
uniform vec3 cue;         // share at a depth: x + y (depth - plane) + z / depth
uniform int nearest;
uniform int sigmoid;
uniform float low;        // of the ramp, or centre of the sigmoid; values count as texels do
uniform float high;
uniform float perWidth;   // 1 / (high - low), or 4 / width
layout(location = 0) out vec4 gathered;  // extrema: value, depth; else integral over depth; length with data; 1

float windowed(float v) {
  if (sigmoid != 0) return 1.0 / (1.0 + exp(-(v - low) * perWidth));
  if (v <= low) return 0.0;
  if (v > high) return 1.0;
  return clamp((v - low) * perWidth, 0.0, 1.0);
}

// .x: weighted value, .y: weight.
vec2 sampled(vec3 p) {
  ivec3 last = textureSize(volume, 0) - 1;
  if (nearest != 0) return weighed(texelFetch(volume, clamp(middle + ivec3(floor(p + 0.5)), ivec3(0), last), 0).r, 1.0);
  vec3 whole = floor(p);
  vec3 part = p - whole;
  ivec3 corner = middle + ivec3(whole);
  ivec3 a = clamp(corner, ivec3(0), last);
  ivec3 b = clamp(corner + 1, ivec3(0), last);
  vec3 q = 1.0 - part;
  return weighed(texelFetch(volume, a, 0).r, q.x * q.y * q.z) +
         weighed(texelFetch(volume, ivec3(b.x, a.y, a.z), 0).r, part.x * q.y * q.z) +
         weighed(texelFetch(volume, ivec3(a.x, b.y, a.z), 0).r, q.x * part.y * q.z) +
         weighed(texelFetch(volume, ivec3(b.x, b.y, a.z), 0).r, part.x * part.y * q.z) +
         weighed(texelFetch(volume, ivec3(a.x, a.y, b.z), 0).r, q.x * q.y * part.z) +
         weighed(texelFetch(volume, ivec3(b.x, a.y, b.z), 0).r, part.x * q.y * part.z) +
         weighed(texelFetch(volume, ivec3(a.x, b.y, b.z), 0).r, q.x * part.y * part.z) +
         weighed(texelFetch(volume, b, 0).r, part.x * part.y * part.z);
}

void main() {
  vec4 ray = texelFetch(parts, ivec2(gl_FragCoord.xy), 0);
  int count = int(ray.w);
  if (count == 0) discard;
  vec2 border = pieces != 0 ? texelFetch(borders, ivec2(gl_FragCoord.xy), 0).xy : ray.yz;
  vec2 at = gl_FragCoord.xy - centre_px;
  vec3 across = at.x * right + at.y * down;
  vec3 begin = origin + spread.x * across;
  vec3 perMm = forward + spread.y * across;
  float stepDepth = step_mm / sqrt(1.0 + raySlope * raySlope * dot(at, at));
  bool extreme = gather < 2;
  float best = -3.0e38;
  float bestDepth = 0.0;
  float sum = 0.0;
  float len = 0.0;
  for (int n = 0; n < count; ++n) {
    float depth = ray.x + float(n) * stepDepth;
    float weight = 0.0;
    if (extreme) {
      depth = clamp(depth, ray.y, ray.z);
    } else {
      float from = depth - 0.5 * stepDepth;
      float to = depth + 0.5 * stepDepth;
      weight = max(min(to, ray.z) - max(from, ray.y), 0.0);
      depth = 0.5 * (max(from, border.x) + min(to, border.y));
    }
    vec2 read = sampled(begin + depth * perMm);
    if (read.y < kLeastWeight) continue;
    float v = slope * (read.x / read.y);
    len += extreme ? 1.0 : weight;
    if (extreme) {
      float score = sense * v;
      if (gather == 1) score = windowed(v) * min(1.0, cue.x + cue.y * depth + cue.z / (depth + plane_mm));
      if (score > best) {
        best = score;
        bestDepth = depth;
      }
    } else {
      sum += weight * (gather == 2 ? windowed(v) : v);
    }
  }
  gathered = extreme ? vec4(sense * best, bestDepth, len, 1.0) : vec4(sum, 0.0, len, 1.0);
}
