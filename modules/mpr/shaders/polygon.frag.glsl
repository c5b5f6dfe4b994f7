// One polygon on a 3-D texture. A slab's samples are combined in a loop; a mean adds differences to the first sample,
// so that its rounding counts against the local range only.
uniform sampler3D volume;
uniform int samples;
uniform int nearest;
uniform int mode;  // 0 maximum, 1 minimum, 2 mean
layout(location = 0) out vec4 accumulated;

#ifdef FIXED
vec2 sampled(vec3 whole, vec3 part, vec3 size) {
  return vec2(textureLod(volume, (whole + part + 0.5) / size, 0.0).r * texelScale - texelBias, 1.0);
}
#else
vec2 sampled(vec3 whole, vec3 part, vec3 size) {
  ivec3 last = ivec3(size) - 1;
  if (nearest != 0) {
    ivec3 at = clamp(ivec3(whole + floor(part + 0.5)), ivec3(0), last);
    return weighed(texelFetch(volume, at, 0).r, 1.0);
  }
  ivec3 a = clamp(ivec3(whole), ivec3(0), last);
  ivec3 b = clamp(ivec3(whole) + 1, ivec3(0), last);
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
#endif

void main() {
  vec3 size = vec3(textureSize(volume, 0));
  float count = 0.0;
  float first = 0.0;
  float result = 0.0;
  for (int n = 0; n < samples; ++n) {
    vec3 whole, part;
    position(float(n), whole, part);
    if (!inside(whole.x, part.x, size.x) || !inside(whole.y, part.y, size.y) || !inside(whole.z, part.z, size.z))
      continue;
    vec2 sum = sampled(whole, part, size);
    if (sum.y < kLeastWeight) continue;
    float v = slope * (sum.x / sum.y);
    if (count == 0.0) {
      first = v;
      result = mode == 2 ? 0.0 : v;
    } else {
      result = mode == 0 ? max(result, v) : mode == 1 ? min(result, v) : result + (v - first);
    }
    count += 1.0;
  }
  if (count == 0.0) discard;
  accumulated = vec4(mode == 2 ? first + result / count : result, 0.0, 0.0, 1.0);
}
