// Where a ray meets the slices of a stack. Each slice stands for the slab around it.
uniform int axis;        // 0 x, 1 y, 2 z: across the slices
uniform vec4 places;     // of the slices along the axis, ascending
uniform vec4 alphas;     // between the two textures of each slice
uniform float halfSlab;  // voxels
uniform float table_mm;
uniform float sign_;

vec2 inPlane(vec3 p) { return axis == 0 ? p.yz : axis == 1 ? p.xz : p.xy; }

// Where the ray is inside the box of voxel centres.
vec2 boxOf(vec3 start, vec3 along) {
  vec2 inside = vec2(-1.0e30, 1.0e30);
  for (int i = 0; i < 3; ++i) {
    if (abs(along[i]) < 1.0e-9) continue;
    float a = -start[i] / along[i];
    float b = (last_vox[i] - start[i]) / along[i];
    inside = vec2(max(inside.x, min(a, b)), min(inside.y, max(a, b)));
  }
  return inside;
}

// The way through a slab, mm from the entry.
vec2 slabOf(float place, float begin, float along) {
  if (abs(along) < 1.0e-7) return abs(begin - place) <= halfSlab ? vec2(-1.0e30, 1.0e30) : vec2(1.0, 0.0);
  float middle = (place - begin) / along;
  float reach = halfSlab / abs(along);
  return vec2(middle - reach, middle + reach);
}
