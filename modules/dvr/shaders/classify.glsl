// From values to colour, not multiplied by opacity, and the opacity of one step of the table.
uniform sampler2D table;
uniform vec2 entryOfValue;  // entry = x * value + y

#ifdef PRE
uniform float preLengths;  // steps in terms of the length that the opacities of voxels are given for
#endif

vec4 lookedUp(float value) {
  float last = float(textureSize(table, 0).x - 1);
  float entry = clamp(value * entryOfValue.x + entryOfValue.y, 0.0, last);
  float below = min(floor(entry), last - 1.0);
  return mix(texelFetch(table, ivec2(int(below), 0), 0), texelFetch(table, ivec2(int(below) + 1, 0), 0), entry - below);
}

#ifdef PREINTEGRATED
uniform sampler2D preIntegrated;
uniform vec2 endOfValue;

// Colour times opacity, and opacity, between two values.
vec4 integrated(float front, float back) {
  float last = float(textureSize(preIntegrated, 0).x - 1);
  vec2 entry = clamp(vec2(front, back) * endOfValue.x + endOfValue.y, 0.0, last);
  vec2 below = min(floor(entry), last - 1.0);
  vec2 t = entry - below;
  ivec2 at = ivec2(below);
  return mix(mix(texelFetch(preIntegrated, at, 0), texelFetch(preIntegrated, at + ivec2(1, 0), 0), t.x),
             mix(texelFetch(preIntegrated, at + ivec2(0, 1), 0), texelFetch(preIntegrated, at + ivec2(1, 1), 0), t.x), t.y);
}
#endif

// 1 - (1 - a)^t. Software renderers have powers of 16 bits: small opacities go by their binomial series.
float opacityOver(float a, float t) {
  if (abs(t - 1.0) < 1.0e-6) return a;
  if (a >= 1.0) return t > 0.0 ? 1.0 : 0.0;
  if (a * max(t, 1.0) > 0.2) return 1.0 - pow(1.0 - a, t);
  float term = t * a;
  float sum = term;
  for (int k = 2; k <= 7; ++k) {
    term *= -(t - float(k - 1)) * a / float(k);
    sum += term;
  }
  return sum;
}

// The opacity of `lengths` steps of the table.
float opacityOfLengths(float a, float lengths) {
#ifdef LINEAR_OPACITY
  return clamp(a * lengths, 0.0, 1.0);
#else
  return opacityOver(a, lengths);
#endif
}
