// One view-aligned slice inside one slab. The slice stands for the step around it; a ray has of it the opacity of its
// way through the step, between its ends.
uniform float plane;     // number of the slice on the lattice
uniform vec2 slabRange;  // places along z that belong to this slab: from, below
uniform float sign_;
#ifdef ISO
uniform float level;
uniform vec3 ambientColour;
uniform vec3 diffuseColour;
#endif
layout(location = 0) out vec4 seen;
layout(location = 1) out vec4 found;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 start = texelFetch(rayStart, at, 0);
  vec4 lattice = texelFetch(rayLattice, at, 0);
  float n = plane - lattice.y;
  if (n < 0.0 || n > lattice.z - 0.5) discard;
  float lengths = perDepth();
  float d = step_mm * lengths;
  float s = (lattice.x + n) * d;
  vec3 along = alongRay();
  vec3 p = positionAt(start, along, s);
  if (p.z < slabRange.x || p.z >= slabRange.y) discard;
#if defined(ISO) || defined(EXTREME)
  // A slice is a surface here: it counts where the ray meets it.
  if (!(s >= 0.0 && s <= start.w)) discard;
#endif
#ifdef PREINTEGRATED
  vec4 front;
  vec4 back;
  bool a = meanAt(positionAt(start, along, s - 0.5 * d), front);
  bool b = meanAt(positionAt(start, along, s + 0.5 * d), back);
  if (!a && !b) discard;
  vec4 c = integrated(a ? front.a : back.a, b ? back.a : front.a);
  if (c.a > 0.0) c.rgb /= c.a;
#else
  vec4 mean;
  if (!meanAt(p, mean)) discard;
#endif
#if defined(ISO)
  if (sign_ * mean.a < sign_ * level) discard;
  vec3 eye = towardsEye();
  seen = vec4(lit(ambientColour, diffuseColour, normalOf(mean.rgb, eye, flat_perMm), eye), 0.0);
  found = vec4(s, 0.0, 0.0, 1.0);
#elif defined(EXTREME)
#ifdef RGBA
  seen = vec4(sign_ * clamp(mean * gains, 0.0, 1.0).rgb, 1.0);
#else
  seen = vec4(vec3(sign_ * mean.a), 1.0);
#endif
  found = vec4(-s, 0.0, 0.0, 1.0);
#else
#ifndef PREINTEGRATED
#ifdef SHADED
  vec4 c = appearance(mean, towardsEye());
#else
  vec4 c = appearance(mean, vec3(0.0));
#endif
#endif
  float share = shareOf(s - 0.5 * d, s + 0.5 * d, start.w);
  if (n > 0.0 && n < lattice.z - 1.5) share = 1.0;
#ifdef LINEAR_OPACITY
  float opacity = opacityOver(opacityOfLengths(c.a, lengths), share);
#else
  float opacity = opacityOver(c.a, lengths * share);
#endif
  if (!(opacity > 0.0)) discard;
  seen = vec4(opacity * c.rgb, 1.0 - opacity);
  found = vec4(opacity * s, 0.0, 0.0, 1.0 - opacity);
#endif
}
