// From accumulated values to the picture: mean of what was added, then the window (PS3.3 C.11.2) and the inversion.
uniform sampler2D accumulator;  // value, remainder, -, number of samples (negative: minimum)
uniform int sigmoid;
uniform int invert;
uniform float low;       // of the ramp, or centre of the sigmoid
uniform float high;
uniform float perWidth;  // 1 / (high - low), or 4 / width
uniform vec3 background;
layout(location = 0) out vec4 colour;
layout(location = 1) out float value;

const float kNoData = 3.0e38;

float windowed(float v) {
  if (sigmoid != 0) return 1.0 / (1.0 + exp(-(v - low) * perWidth));
  if (v <= low) return 0.0;
  if (v > high) return 1.0;
  return clamp((v - low) * perWidth, 0.0, 1.0);
}

void main() {
  vec4 a = texelFetch(accumulator, ivec2(gl_FragCoord.xy), 0);
  float count = abs(a.a);
  if (count < 0.5) {
    colour = vec4(background, 1.0);
    value = kNoData;
    return;
  }
  value = (a.r + a.g) / count;
  float grey = windowed(value);
  colour = vec4(vec3(invert != 0 ? 1.0 - grey : grey), 1.0);
}
