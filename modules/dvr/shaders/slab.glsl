// A slab of the volume: some of its slices as a 3-D texture, or two of them as 2-D textures (STRIPS). Places are scaled
// and biased into it; both slices at its ends belong to it, one of them to the neighbour too, so that nothing outside
// takes part in an interpolation (SGI, Volume Rendering Primer).
uniform float firstSlice;
#ifdef STRIPS
uniform sampler2D lower0;
uniform sampler2D upper0;
bool meanAt(vec3 p, out vec4 mean) {
  return betweenPlanes(lower0, upper0, clamp(p.z - firstSlice, 0.0, 1.0), p.xy, mean);
}
#else
uniform sampler3D volume;
bool meanAt(vec3 p, out vec4 mean) {
  p.z -= firstSlice;
  ivec3 last = textureSize(volume, 0) - 1;
  beginCorners();
#if defined(FIXED)
  takeFiltered(textureLod(volume, (p + 0.5) / vec3(textureSize(volume, 0)), 0.0).r, 1.0);
#elif defined(NEAREST)
  takeTexel(texelFetch(volume, clamp(ivec3(floor(p + 0.5)), ivec3(0), last), 0), 1.0);
#else
  ivec3 a = clamp(ivec3(floor(p)), ivec3(0), last);
  ivec3 b = min(a + 1, last);
  vec3 t = p - vec3(a);
  vec3 q = 1.0 - t;
  takeTexel(texelFetch(volume, a, 0), q.x * q.y * q.z);
  takeTexel(texelFetch(volume, ivec3(b.x, a.yz), 0), t.x * q.y * q.z);
  takeTexel(texelFetch(volume, ivec3(a.x, b.y, a.z), 0), q.x * t.y * q.z);
  takeTexel(texelFetch(volume, ivec3(b.xy, a.z), 0), t.x * t.y * q.z);
  takeTexel(texelFetch(volume, ivec3(a.xy, b.z), 0), q.x * q.y * t.z);
  takeTexel(texelFetch(volume, ivec3(b.x, a.y, b.z), 0), t.x * q.y * t.z);
  takeTexel(texelFetch(volume, ivec3(a.x, b.yz), 0), q.x * t.y * t.z);
  takeTexel(texelFetch(volume, b, 0), t.x * t.y * t.z);
#endif
  return endCorners(mean);
}
#endif
