// Slices as 2-D textures: what stands at a place in one, and between two of them (Rezk-Salama 2000, section 5:
// S = (1 - alpha) S_i + alpha S_i+1). Sums over corners, with their weight.
vec4 cornerSum;  // RGBA: colour; PRE: colour times opacity, opacity; else gradient, value
float cornerWeight;

void takeCorner(sampler2D plane, ivec2 at, float w) {
  vec4 t = texelFetch(plane, at, 0);
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

void takePlane(sampler2D plane, vec2 q, float w) {
  if (w <= 0.0) return;
  ivec2 last = textureSize(plane, 0) - 1;
#if defined(FIXED)
  float v = textureLod(plane, (q + 0.5) / vec2(textureSize(plane, 0)), 0.0).r * texelScale - texelBias;
  cornerSum += w * vec4(0.0, 0.0, 0.0, v);
  cornerWeight += w;
#elif defined(NEAREST)
  takeCorner(plane, clamp(ivec2(floor(q + 0.5)), ivec2(0), last), w);
#else
  ivec2 a = clamp(ivec2(floor(q)), ivec2(0), last);
  ivec2 b = min(a + 1, last);
  vec2 t = q - vec2(a);
  takeCorner(plane, a, w * (1.0 - t.x) * (1.0 - t.y));
  takeCorner(plane, ivec2(b.x, a.y), w * t.x * (1.0 - t.y));
  takeCorner(plane, ivec2(a.x, b.y), w * (1.0 - t.x) * t.y);
  takeCorner(plane, b, w * t.x * t.y);
#endif
}

// False where there is no data.
bool betweenPlanes(sampler2D lower, sampler2D upper, float alpha, vec2 q, out vec4 mean) {
  cornerSum = vec4(0.0);
  cornerWeight = 0.0;
#ifdef NEAREST
  alpha = floor(alpha + 0.5);
#endif
  takePlane(lower, q, 1.0 - alpha);
  takePlane(upper, q, alpha);
  mean = cornerWeight < kLeastWeight ? vec4(0.0) : cornerSum / cornerWeight;
  return cornerWeight >= kLeastWeight;
}
