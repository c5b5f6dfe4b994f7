// The field of a 3-D texture that holds the slices from `firstSlice` on.
uniform sampler3D volume;
uniform float firstSlice;

#ifdef RGBA
uniform vec4 gains;
vec4 rgbaAt(vec3 p) {
  p.z -= firstSlice;
  ivec3 last = textureSize(volume, 0) - 1;
  vec4 c;
#ifdef NEAREST
  c = texelFetch(volume, clamp(ivec3(floor(p + 0.5)), ivec3(0), last), 0);
#else
  ivec3 a = clamp(ivec3(floor(p)), ivec3(0), last);
  ivec3 b = min(a + 1, last);
  vec3 t = p - vec3(a);
  c = mix(mix(mix(texelFetch(volume, a, 0), texelFetch(volume, ivec3(b.x, a.yz), 0), t.x),
              mix(texelFetch(volume, ivec3(a.x, b.y, a.z), 0), texelFetch(volume, ivec3(b.xy, a.z), 0), t.x), t.y),
          mix(mix(texelFetch(volume, ivec3(a.xy, b.z), 0), texelFetch(volume, ivec3(b.x, a.y, b.z), 0), t.x),
              mix(texelFetch(volume, ivec3(a.x, b.yz), 0), texelFetch(volume, b, 0), t.x), t.y), t.z);
#endif
  return clamp(c * gains, 0.0, 1.0);
}
#else
// One corner of a cell with its weight; what is summed is .x the value (PRE: the colour), .y the weight.
#ifdef PRE
#define SUM vec4
float preWeight;
vec4 corner(ivec3 at, float w) {
  float v = decoded(texelFetch(volume, at, 0).r);
  if (!isData(v)) return vec4(0.0);
  preWeight += w;
  vec4 c = lookedUp(v);
  return w * vec4(c.rgb * c.a, c.a);
}
#else
#define SUM vec2
vec2 corner(ivec3 at, float w) {
  float v = decoded(texelFetch(volume, at, 0).r);
  return isData(v) ? vec2(v * w, w) : vec2(0.0);
}
#endif

SUM cornersAt(vec3 p) {
  p.z -= firstSlice;
  ivec3 last = textureSize(volume, 0) - 1;
#ifdef NEAREST
  return corner(clamp(ivec3(floor(p + 0.5)), ivec3(0), last), 1.0);
#else
  ivec3 a = clamp(ivec3(floor(p)), ivec3(0), last);
  ivec3 b = min(a + 1, last);
  vec3 t = p - vec3(a);
  vec3 q = 1.0 - t;
  return corner(a, q.x * q.y * q.z) + corner(ivec3(b.x, a.yz), t.x * q.y * q.z) +
         corner(ivec3(a.x, b.y, a.z), q.x * t.y * q.z) + corner(ivec3(b.xy, a.z), t.x * t.y * q.z) +
         corner(ivec3(a.xy, b.z), q.x * q.y * t.z) + corner(ivec3(b.x, a.y, b.z), t.x * q.y * t.z) +
         corner(ivec3(a.x, b.yz), q.x * t.y * t.z) + corner(b, t.x * t.y * t.z);
#endif
}

#ifndef PRE
// .x the value, .y 0 where there is no data.
vec2 fieldAt(vec3 p) {
#ifdef FIXED
  vec3 size = vec3(textureSize(volume, 0));
  return vec2(textureLod(volume, (p - vec3(0.0, 0.0, firstSlice) + 0.5) / size, 0.0).r * texelScale - texelBias, 1.0);
#else
  vec2 sum = cornersAt(p);
  return sum.y < kLeastWeight ? vec2(0.0) : vec2(sum.x / sum.y, 1.0);
#endif
}
#endif
#endif

#ifdef CLASSIFY
// Colour, not multiplied, and the opacity of one step; `value` for who needs it too.
vec4 classifiedAt(vec3 p, out float value) {
  value = 0.0;
#if defined(RGBA)
  vec4 c = rgbaAt(p);
  return vec4(c.rgb, opacityOfLengths(c.a, rgbaLengths));
#elif defined(PRE)
  preWeight = 0.0;
  vec4 sum = cornersAt(p);
  if (preWeight < kLeastWeight || sum.a <= 0.0) return vec4(0.0);
  return vec4(sum.rgb / sum.a, opacityOfLengths(sum.a / preWeight, preLengths));
#else
  vec2 v = fieldAt(p);
  value = v.x;
  return v.y > 0.0 ? lookedUp(v.x) : vec4(0.0);
#endif
}
#endif
