// Texels to values. 16-bit texels are whole numbers again after rounding, so that nothing is lost; values count from
// the volume's least value, which keeps their bits for the differences that matter. No-data is a range.
uniform float texelScale;  // 65535 for 16-bit textures, 0 for float ones
uniform float texelBias;
uniform float noDataFirst;
uniform float noDataLast;
uniform float slope;  // modality value = slope * value + a constant that the CPU adds

float decoded(float texel) {
  return texelScale > 0.0 ? floor(texel * texelScale + 0.5) - texelBias : texel;
}

// .x: weighted value, .y: weight, 0 for no-data.
vec2 weighed(float texel, float weight) {
  float v = decoded(texel);
  return v >= noDataFirst && v <= noDataLast ? vec2(0.0) : vec2(v * weight, weight);
}

// Less weight than this comes from rounding only.
const float kLeastWeight = 1.0e-6;
