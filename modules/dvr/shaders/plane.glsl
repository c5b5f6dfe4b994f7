// Slices as 2-D textures: what stands at a place in one, and between two of them (Rezk-Salama 2000, section 5:
// S = (1 - alpha) S_i + alpha S_i+1).
void takePlane(sampler2D plane, vec2 q, float w) {
  if (w <= 0.0) return;
  ivec2 last = textureSize(plane, 0) - 1;
#if defined(FIXED)
  takeFiltered(textureLod(plane, (q + 0.5) / vec2(textureSize(plane, 0)), 0.0).r, w);
#elif defined(NEAREST)
  takeTexel(texelFetch(plane, clamp(ivec2(floor(q + 0.5)), ivec2(0), last), 0), w);
#else
  ivec2 a = clamp(ivec2(floor(q)), ivec2(0), last);
  ivec2 b = min(a + 1, last);
  vec2 t = q - vec2(a);
  takeTexel(texelFetch(plane, a, 0), w * (1.0 - t.x) * (1.0 - t.y));
  takeTexel(texelFetch(plane, ivec2(b.x, a.y), 0), w * t.x * (1.0 - t.y));
  takeTexel(texelFetch(plane, ivec2(a.x, b.y), 0), w * (1.0 - t.x) * t.y);
  takeTexel(texelFetch(plane, b, 0), w * t.x * t.y);
#endif
}

// False where there is no data.
bool betweenPlanes(sampler2D lower, sampler2D upper, float alpha, vec2 q, out vec4 mean) {
  beginCorners();
#ifdef NEAREST
  alpha = floor(alpha + 0.5);
#endif
  takePlane(lower, q, 1.0 - alpha);
  takePlane(upper, q, alpha);
  return endCorners(mean);
}
