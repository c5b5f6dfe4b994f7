// One strip exactly as the paper draws it: both textures by the card's bilinear filter, blended by the alpha that is
// interpolated between the vertices (figure 12: A = texture 0, B = inverted alpha, C = texture 1, D = alpha).
in float gouraudAlpha;
in vec2 uv0;
in vec2 uv1;
uniform sampler2D slice0;
uniform sampler2D slice1;
uniform int mode;
uniform float quantum;
layout(location = 0) out vec4 accumulated;

void main() {
  float blended = textureLod(slice0, uv0, 0.0).r * (1.0 - gouraudAlpha) + textureLod(slice1, uv1, 0.0).r * gouraudAlpha;
  float v = slope * (blended * texelScale - texelBias);
  if (mode == 2) {
    float most = floor(v / quantum + 0.5) * quantum;
    accumulated = vec4(most, v - most, 0.0, 1.0);
  } else {
    accumulated = vec4(v, 0.0, 0.0, mode == 1 ? -1.0 : 1.0);
  }
}
