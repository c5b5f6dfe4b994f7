#ifdef RGBA
uniform vec4 gains;
#endif

// What stands at a place between texels, as a sum over corners with their weight.
vec4 cornerSum;  // RGBA: colour; PRE: colour times opacity, opacity; else gradient, value
float cornerWeight;

void beginCorners() {
  cornerSum = vec4(0.0);
  cornerWeight = 0.0;
}

void takeTexel(vec4 t, float w) {
#if !defined(RGBA)
#ifdef GRADIENTS
  float v = t.a;
#else
  float v = decoded(t.r);
  t = vec4(0.0, 0.0, 0.0, v);
#endif
  if (!isData(v)) return;
#ifdef PRE
  vec4 c = lookedUp(v);
  t = vec4(c.rgb * c.a, c.a);
#endif
#endif
  cornerSum += w * t;
  cornerWeight += w;
}

void takeFiltered(float texel, float w) {
  cornerSum += w * vec4(0.0, 0.0, 0.0, texel * texelScale - texelBias);
  cornerWeight += w;
}

// False where there is no data.
bool endCorners(out vec4 mean) {
  mean = cornerWeight < kLeastWeight ? vec4(0.0) : cornerSum / cornerWeight;
  return cornerWeight >= kLeastWeight;
}
