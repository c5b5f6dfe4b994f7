// From what slices hold at a place to colour, not multiplied, and the opacity of one step of the table.
#ifdef SHADED
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
#endif

vec4 appearance(vec4 mean, vec3 eye) {
#if defined(RGBA)
  vec4 c = clamp(mean * gains, 0.0, 1.0);
  return vec4(c.rgb, opacityOfLengths(c.a, rgbaLengths));
#elif defined(PRE)
  return mean.a > 0.0 ? vec4(mean.rgb / mean.a, opacityOfLengths(mean.a, preLengths)) : vec4(0.0);
#else
  vec4 c = lookedUp(mean.a);
#ifdef SHADED
  if (c.a > 0.0) {
    vec3 n = normalOf(mean.rgb, eye, flat_perMm);
#if SHADED == 1
    c.rgb = lit(ambientColour, diffuseColour, n, eye);
#else
    c.rgb = lit(c.rgb, c.rgb, n, eye);
#endif
  }
#endif
  return c;
#endif
}
