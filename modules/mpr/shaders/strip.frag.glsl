// One strip between two texture slices, interpolated in float: figure 12's blend of both textures by alpha, with the
// alpha that the paper interpolates between the vertices computed once more from the pixel's exact position, since the
// rasteriser's own lies off by up to 1/256 pixel. A strip's polygon is drawn a little too wide; the exact position says
// which strip a pixel belongs to, so that there are neither holes nor overlaps.
uniform sampler2D slice0;
uniform sampler2D slice1;
uniform vec2 shift0Whole;  // in-plane origin of the slices
uniform vec2 shift0Part;
uniform vec2 shift1Whole;
uniform vec2 shift1Part;
uniform vec2 lower;  // of the strip along k: whole, part
uniform vec2 upper;
uniform float perStep;  // 1 / distance of the slices, 0 where one slice is held
uniform int nearest;
uniform int mode;       // 0 maximum, 1 minimum, 2 mean
uniform float quantum;  // mean: sums of its multiples are exact
layout(location = 0) out vec4 accumulated;

vec2 nearestIn(sampler2D slice, vec2 whole, vec2 part) {
  ivec2 at = clamp(ivec2(whole + floor(part + 0.5)), ivec2(0), textureSize(slice, 0) - 1);
  return weighed(texelFetch(slice, at, 0).r, 1.0);
}

vec2 bilinearIn(sampler2D slice, vec2 whole, vec2 part) {
  ivec2 last = textureSize(slice, 0) - 1;
  ivec2 a = clamp(ivec2(whole), ivec2(0), last);
  ivec2 b = clamp(ivec2(whole) + 1, ivec2(0), last);
  return weighed(texelFetch(slice, a, 0).r, (1.0 - part.x) * (1.0 - part.y)) +
         weighed(texelFetch(slice, ivec2(b.x, a.y), 0).r, part.x * (1.0 - part.y)) +
         weighed(texelFetch(slice, ivec2(a.x, b.y), 0).r, (1.0 - part.x) * part.y) +
         weighed(texelFetch(slice, b, 0).r, part.x * part.y);
}

vec2 sampled(sampler2D slice, vec2 whole, vec2 part, vec2 shiftWhole, vec2 shiftPart) {
  vec2 p = part - shiftPart;
  vec2 w = whole - shiftWhole + floor(p);
  p -= floor(p);
  vec2 size = vec2(textureSize(slice, 0));
  if (!inside(w.x, p.x, size.x) || !inside(w.y, p.y, size.y)) return vec2(0.0);
  return nearest != 0 ? nearestIn(slice, w, p) : bilinearIn(slice, w, p);
}

void main() {
  vec3 whole, part;
  position(0.0, whole, part);
  float above = (whole.z - lower.x) + (part.z - lower.y);
  float below = (whole.z - upper.x) + (part.z - upper.y);
  if (above < 0.0 || below >= 0.0) discard;
  float alpha = clamp(above * perStep, 0.0, 1.0);
  if (nearest != 0) alpha = alpha >= 0.5 ? 1.0 : 0.0;
  vec2 sum = vec2(0.0);
  if (alpha < 1.0) sum += sampled(slice0, whole.xy, part.xy, shift0Whole, shift0Part) * (1.0 - alpha);
  if (alpha > 0.0) sum += sampled(slice1, whole.xy, part.xy, shift1Whole, shift1Part) * alpha;
  if (sum.y < kLeastWeight) discard;
  float v = slope * (sum.x / sum.y);
  if (mode == 2) {
    float most = floor(v / quantum + 0.5) * quantum;
    accumulated = vec4(most, v - most, 0.0, 1.0);
  } else {
    accumulated = vec4(v, 0.0, 0.0, mode == 1 ? -1.0 : 1.0);
  }
}
