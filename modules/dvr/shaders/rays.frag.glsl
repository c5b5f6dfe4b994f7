// One part of each ray, sample by sample on the view's lattice.
uniform float enough;  // no more samples when less light than this is left
layout(location = 0) out vec4 seen;   // colour, what is left of light from behind
layout(location = 1) out vec4 found;  // mm from the entry (-1: nothing), samples, value, cells

#ifdef SHADED
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
vec3 shaded(vec3 own, vec3 p, float value, vec3 eye) {
  vec3 n = normalOf(gradientAt(p, value), eye, flat_perMm);
#if SHADED == 1
  return lit(ambientColour, diffuseColour, n, eye);
#else
  return lit(own, own, n, eye);
#endif
}
#endif

#ifdef PREINTEGRATED
// Between the values at both ends of the step around s.
vec4 stepAt(vec4 start, vec3 along, float s, inout vec2 front) {
  vec2 back = fieldAt(positionAt(start, along, s + 0.5 * step_mm));
  vec2 a = front.y > 0.0 ? front : back;
  vec2 b = back.y > 0.0 ? back : front;
  front = back;
  return b.y > 0.0 ? integrated(a.x, b.x) : vec4(0.0);
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  int steps = int(lattice.z + 0.5);
  if (steps < 1) discard;
  vec3 along = alongRay();
#ifdef SHADED
  vec3 eye = towardsEye();
#endif
  vec3 sum = vec3(0.0);
  float left = 1.0, depth = -1.0, samples = 0.0;
#ifdef PREINTEGRATED
  vec2 front = fieldAt(positionAt(start, along, (lattice.x - 0.5) * step_mm));
  samples += 1.0;
#endif
  for (int n = 0; n < steps; ++n) {
    float s = (lattice.x + float(n)) * step_mm;
    float share = shareOf(s - 0.5 * step_mm, s + 0.5 * step_mm, start.w);
    if (n > 0 && n < steps - 1) share = 1.0;
    samples += 1.0;
    float value;
    vec3 p = positionAt(start, along, s);
#ifdef PREINTEGRATED
    vec4 c = stepAt(start, along, s, front);
    if (c.a > 0.0) c.rgb /= c.a;
#else
    vec4 c = classifiedAt(p, value);
#endif
    float a = opacityOver(c.a, share);
    if (!(a > 0.0)) continue;
#ifdef SHADED
#ifdef PREINTEGRATED
    vec2 own = fieldAt(p);
    value = own.x;
    samples += 1.0;
#endif
    c.rgb = shaded(c.rgb, p, value, eye);
    samples += 6.0;
#endif
    sum += left * a * c.rgb;
    left *= 1.0 - a;
    if (depth < 0.0 && lattice.w * left <= 0.5) depth = clamp(s, 0.0, start.w);
    if (lattice.w * left < enough) break;
  }
  seen = vec4(sum, left);
  found = vec4(depth, samples, 0.0, 0.0);
}
